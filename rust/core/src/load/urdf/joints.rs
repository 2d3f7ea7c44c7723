//! What joints must be, and what is odd about them.

use super::xml::Element;
use crate::error::{Error, Result};
use crate::robot::check::list;

const JOINTS: [&str; 5] = ["revolute", "continuous", "prismatic", "fixed", "floating"];

/// Gives a joint that needs no `<limit>` an empty one, in which nothing is limited: `urdf-rs` would read zeros.
pub(super) fn complete(joint: &mut Element) {
    if joint.attribute("type") == "continuous" && joint.child("limit").is_none() {
        joint.children.push(Element { tag: "limit".into(), ..Element::default() });
    }
}

/// Checks a joint, its numbers being checked.
pub(super) fn check(joint: &Element, owner: &str) -> Result<()> {
    if joint.tag != "joint" {
        return Ok(());
    }
    let kind = joint.attribute("type");
    if !JOINTS.contains(&kind) {
        let text =
            format!("{owner} has the type '{kind}'; supported: {} (from the root link)", JOINTS.join(", "));
        return Err(Error::model(text));
    }
    for end in ["parent", "child"] {
        if joint.child(end).is_none_or(|end| end.attribute("link").is_empty()) {
            return Err(Error::model(format!("{owner} needs <{end} link=\"...\"/>")));
        }
    }
    if ["revolute", "prismatic"].contains(&kind) && joint.child("limit").is_none() {
        return Err(Error::model(format!(
            "{owner} is {kind} and needs <limit> (a revolute joint without limits is 'continuous')"
        )));
    }
    if kind == "fixed" {
        return Ok(());
    }
    let length = axis_length(joint);
    if !(length > 1e-6 && length < 1e6) {
        let text =
            format!("{owner}: <axis> must be a direction of about unit length, not of length {length:e}");
        return Err(Error::model(text));
    }
    for name in ["effort", "velocity"] {
        if joint.child("limit").is_some_and(|limit| limit.numbers(name).iter().any(|value| *value < 0.0)) {
            return Err(Error::model(format!("{owner}: '{name}' of <limit> must not be negative")));
        }
    }
    Ok(())
}

/// The length of a joint's axis, which is of unit length where none is given.
fn axis_length(joint: &Element) -> f64 {
    joint.child("axis").map_or(1.0, |axis| axis.numbers("xyz").iter().map(|x| x * x).sum::<f64>().sqrt())
}

/// Warnings that name the joints concerned and say what is done about them.
pub(super) fn oddities(elements: &[Element]) -> Vec<String> {
    let moving =
        || elements.iter().filter(|joint| joint.tag == "joint" && joint.attribute("type") != "fixed");
    let mimic = |joint: &Element| {
        joint.child("mimic").map(|mimic| format!("'{}' ('{}')", joint.name(), mimic.attribute("joint")))
    };
    let mimics: Vec<String> = moving().filter_map(mimic).collect();
    let long: Vec<&str> =
        moving().filter(|joint| (axis_length(joint) - 1.0).abs() > 1e-3).map(Element::name).collect();
    let mut warnings = vec![];
    if !mimics.is_empty() {
        let mimics = mimics.join(", ");
        warnings.push(format!("Joints that mimic another (kept as independent joints): {mimics}"));
    }
    if !long.is_empty() {
        let names = list(&long);
        warnings.push(format!("The axes of these joints are not of unit length (normalised): {names}"));
    }
    warnings
}
