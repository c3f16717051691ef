//! Choosing by name, with help for the wrong one.

use anyhow::{Result, bail};

/// The position of `given` among the `known` names of a `kind` of thing.
///
/// # Errors
/// An unknown name is answered with the known ones, the nearest first.
pub fn choose(kind: &str, given: &str, known: &[&str]) -> Result<usize> {
    if let Some(index) = known.iter().position(|name| name.eq_ignore_ascii_case(given)) {
        return Ok(index);
    }
    bail!("unknown {kind} `{given}`; known: {}", nearest_first(given, known).join(", "))
}

/// The one of that name among things of a `kind`.
///
/// # Errors
/// As [`choose`].
pub fn named<T>(
    kind: &str,
    given: &str,
    things: impl IntoIterator<Item = T>,
    name: impl Fn(&T) -> &'static str,
) -> Result<T> {
    let mut things: Vec<T> = things.into_iter().collect();
    let names: Vec<&str> = things.iter().map(name).collect();
    let index = choose(kind, given, &names)?;
    Ok(things.swap_remove(index))
}

fn nearest_first<'a>(given: &str, known: &[&'a str]) -> Vec<&'a str> {
    let given = given.to_lowercase();
    let mut names = known.to_vec();
    // Stable: equally near names stay in their own order.
    names.sort_by_key(|name| {
        let contains = name.to_lowercase().contains(&given) && !given.is_empty();
        (!contains, strsim::damerau_levenshtein(&given, &name.to_lowercase()))
    });
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_name_lists_the_nearest_first() {
        let known = ["linear", "obvhs-bvh2"];
        assert_eq!(choose("index", "Linear", &known).unwrap(), 0);
        let message = choose("index", "obvhs_bvh2", &known).unwrap_err().to_string();
        assert_eq!(message, "unknown index `obvhs_bvh2`; known: obvhs-bvh2, linear");
        let message = choose("index", "bvh", &known).unwrap_err().to_string();
        assert_eq!(message, "unknown index `bvh`; known: obvhs-bvh2, linear");
    }
}
