//! The numbers of one element of a URDF, checked, with defaults where readers need them.

use super::xml::Element;
use crate::error::{Error, Result};

/// Elements that may stand in another more than once; of the others the first counts.
const MANY: [&str; 4] = ["link", "joint", "collision", "visual"];
/// Attributes that are no numbers.
const WORDS: [&str; 6] = ["name", "type", "link", "joint", "filename", "version"];
/// Attributes that may be left out though readers need them. The largest number stands for "unlimited".
const DEFAULTS: [(&str, &str, &str); 5] = [
    ("inertia", "ixy", "0"),
    ("inertia", "ixz", "0"),
    ("inertia", "iyz", "0"),
    ("limit", "effort", "1.7976931348623157e308"),
    ("limit", "velocity", "1.7976931348623157e308"),
];
/// Far beyond any robot, and small enough that products stay finite.
const LARGEST: f64 = 1e12;

/// Checks the numbers of an element and all in it, and writes defaults.
pub(super) fn check(element: &mut Element, place: &str, kind: fn(String) -> Error) -> Result<()> {
    let tag = &element.tag;
    for (of, name, value) in DEFAULTS {
        if of == tag && !element.attributes.iter().any(|(known, _)| known == name) {
            element.attributes.push((name.to_owned(), value.to_owned()));
        }
    }
    let largest = if tag == "limit" { f64::MAX } else { LARGEST };
    let is_number = |word: &str| {
        // Narrower than `str::parse`, which also reads "nan" and "inf".
        let digits = word.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
        digits && word.parse().is_ok_and(|value: f64| value.abs() <= largest)
    };
    for (name, value) in element.attributes.iter_mut().filter(|(name, _)| !WORDS.contains(&name.as_str())) {
        let wanted = match name.as_str() {
            "xyz" | "rpy" | "size" | "scale" => 3,
            _ => 1,
        };
        let words: Vec<&str> = value.split_whitespace().collect();
        if words.len() != wanted || !words.iter().all(|word| is_number(word)) {
            let wanted = if wanted == 1 { "a finite number" } else { "3 finite numbers" };
            let shown: String = value.chars().take(80).collect();
            return Err(kind(format!(
                "{place}: '{name}' of <{tag}> must be {wanted} of magnitude up to {largest:e}, not '{shown}'"
            )));
        }
        // As every reader understands them, to the last bit.
        let numbers =
            words.iter().filter_map(|word| word.parse().ok()).map(|number: f64| format!("{number:?}"));
        *value = numbers.collect::<Vec<String>>().join(" ");
    }
    if tag == "mass" && element.numbers("value").iter().any(|mass| *mass < 0.0) {
        return Err(kind(format!(
            "{place}: mass must not be negative, not {} kg",
            element.attribute("value")
        )));
    }
    if tag == "inertial" && (element.child("mass").is_none() || element.child("inertia").is_none()) {
        return Err(kind(format!("{place}: <inertial> needs <mass> and <inertia>")));
    }
    keep_first(element);
    element.children.iter_mut().try_for_each(|child| check(child, place, kind))
}

/// Leaves out what may stand in it only once and is there again.
pub(super) fn keep_first(element: &mut Element) {
    let mut seen: Vec<String> = vec![];
    element.children.retain(|child| {
        let again = seen.contains(&child.tag);
        seen.push(child.tag.clone());
        !again || MANY.contains(&child.tag.as_str())
    });
}
