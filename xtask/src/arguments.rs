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

/// Warns of each setting that is given on the command line and that `whom` does not use.
pub fn warn_of_unused(
    given: impl IntoIterator<Item = (Setting, bool)>,
    used: &[Setting],
    whom: &str,
) {
    for (setting, is_given) in given {
        if is_given && !used.contains(&setting) {
            let flag = match setting {
                Setting::Sampling => "--spp",
                Setting::Adaptive => "--adaptive",
                Setting::MaxDepth => "--depth",
                Setting::Index | Setting::Beams => "--index",
            };
            eprintln!("warning: {flag} changes nothing: {whom} does not use it");
        }
    }
}
