//! Values on the command line that more than one command reads.

use std::fmt::Display;
use std::str::FromStr;

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
