//! Values on the command line that more than one command reads.

use std::fmt::Display;
use std::str::FromStr;

use anyhow::Result;
use lancer_accel::structures::{STRUCTURES, Structure};
use lancer_core::method::Setting;

use crate::chapters::list;
use crate::names::named;

/// Reads whole numbers in a range.
pub fn whole<T: FromStr + PartialOrd + Copy + Display>(
    least: T,
    most: T,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let number = text.parse().ok().filter(|number| (least..=most).contains(number));
        number.ok_or_else(|| format!("write a whole number from {least} to {most}"))
    }
}

/// The index of that name.
///
/// # Errors
/// An unknown name is answered with the known ones.
pub fn structure(name: &str) -> Result<Structure> {
    named("index", name, STRUCTURES, |structure| structure.name)
}

/// The names of all indexes, for a help text.
pub fn indexes() -> String {
    list(&STRUCTURES.map(|structure| structure.name), "or")
}

/// Warns of each flag that is given although `whom` does not use what it sets.
pub fn warn_of_unused(
    flags: impl IntoIterator<Item = (&'static str, Setting, bool)>,
    used: &[Setting],
    whom: &str,
) {
    for (flag, setting, is_given) in flags {
        if is_given && !used.contains(&setting) {
            eprintln!("warning: {flag} changes nothing: {whom} does not use it");
        }
    }
}
