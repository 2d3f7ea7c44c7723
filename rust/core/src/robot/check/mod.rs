//! What a description must be to be a robot, and what in it is odd: for every loader the same.

mod inertia;
mod link_tree;
mod mass_matrix;

use std::collections::HashSet;

use nalgebra::Matrix3;

use super::description::{JointDescription, JointKind, LinkDescription, RobotDescription};
use super::numbers::LARGEST;
use crate::error::{Error, Result};
use crate::spatial::Pose;

pub(crate) use inertia::principal_moments;
pub(super) use link_tree::check_link_tree;
pub(super) use mass_matrix::check_mass_matrix;

/// Smallest mass (kg) and moment of inertia (kg m^2) that is not zero: computing with less loses its digits.
const LEAST_INERTIA: f64 = 1e-60;

/// Refuses joints and links that cannot be used, and returns warnings of those that are odd.
pub(super) fn check(description: &RobotDescription) -> Result<Vec<String>> {
    let RobotDescription { joints, links, gravity, .. } = description;
    if !gravity.iter().all(|x| x.abs() < LARGEST) {
        return Err(Error::model(format!(
            "gravity must be three finite numbers below {LARGEST:e} m/s^2, not {:e}, {:e}, {:e}",
            gravity.x, gravity.y, gravity.z
        )));
    }
    check_unique("joint", joints.iter().map(|joint| joint.name.as_str()))?;
    check_unique("link", links.iter().map(|link| link.name.as_str()))?;
    for (index, joint) in joints.iter().enumerate() {
        let owner = format!("joint '{}'", joint.name);
        check_joint(&owner, joint, index + 1).map_err(|error| error.of(&owner))?;
    }
    for link in links {
        let owner = format!("link '{}'", link.name);
        check_link(&owner, link, joints.len()).map_err(|error| error.of(&owner))?;
    }
    let mut warnings = inertia::check(description)?;
    let no_range =
        |joint: &&JointDescription| matches!((joint.lower, joint.upper), (Some(a), Some(b)) if a >= b);
    let names: Vec<&str> = joints.iter().filter(no_range).map(|joint| joint.name.as_str()).collect();
    if !names.is_empty() {
        warnings.push(format!("The limits of these joints leave no range (kept as given): {}", list(&names)));
    }
    Ok(warnings)
}

fn check_joint(owner: &str, joint: &JointDescription, number: usize) -> Result<()> {
    if joint.parent.get() >= number {
        return Err(Error::model(format!("{owner}: its parent must come before it")));
    }
    let numbers = joint.com.iter().chain(&joint.inertia).chain(&joint.axis);
    if !numbers.chain([&joint.mass, &joint.armature]).all(|x| x.is_finite()) {
        return Err(Error::model(format!("{owner}: axis, mass and inertia must be finite")));
    }
    check_placement(owner, &joint.placement)?;
    check_size(owner, joint.mass, &joint.inertia)?;
    if joint.armature < 0.0 {
        return Err(Error::model(format!("{owner}: armature must not be negative, not {}", joint.armature)));
    }
    if joint.kind == JointKind::FreeFlyer && number != 1 {
        return Err(Error::model(format!(
            "{owner}: a free flyer is supported as the base only; other joints must be revolute, \
             continuous or prismatic"
        )));
    }
    if joint.kind != JointKind::FreeFlyer && joint.axis.norm() < 1e-9 {
        return Err(Error::model(format!("{owner}: the axis must not be zero")));
    }
    if [joint.lower, joint.upper, joint.effort, joint.velocity].into_iter().flatten().any(f64::is_nan) {
        return Err(Error::model(format!(
            "{owner}: limits must be numbers, or none where there is no limit"
        )));
    }
    Ok(())
}

fn check_link(owner: &str, link: &LinkDescription, joints: usize) -> Result<()> {
    if link.body.get() > joints {
        return Err(Error::model(format!("{owner}: its joint does not exist")));
    }
    if !link.com.iter().chain(&link.inertia).chain([&link.mass]).all(|x| x.is_finite()) {
        return Err(Error::model(format!("{owner}: mass and inertia must be finite")));
    }
    check_placement(owner, &link.placement)?;
    for part in &link.geometry {
        check_placement(owner, &part.pose)?;
    }
    check_size(owner, link.mass, &link.inertia)
}

fn check_placement(owner: &str, placement: &Pose) -> Result<()> {
    placement.check_rigid().map_err(|why| Error::model(format!("{owner}: its placement {why}")))
}

fn check_size(owner: &str, mass: f64, inertia: &Matrix3<f64>) -> Result<()> {
    if mass < 0.0 {
        return Err(Error::model(format!("{owner}: mass must not be negative, not {mass} kg")));
    }
    for (what, unit, size) in [("mass", "kg", mass), ("inertia", "kg m^2", inertia.amax())] {
        if size != 0.0 && !(LEAST_INERTIA..LARGEST).contains(&size) {
            return Err(Error::model(format!(
                "{owner}: {what} must be 0 or from {LEAST_INERTIA:e} to {LARGEST:e} {unit}, not {size:e}"
            )));
        }
    }
    Ok(())
}

pub(crate) fn check_unique<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Result<()> {
    let (mut seen, mut twice) = (HashSet::new(), vec![]);
    for name in names {
        if !seen.insert(name) && !twice.contains(&name) {
            twice.push(name);
        }
    }
    if twice.is_empty() {
        return Ok(());
    }
    Err(Error::model(format!("{what} names must be unique; given more than once: {}", list(&twice)))
        .of(&format!("{what} '{}'", twice[0])))
}

/// Names for a message, quoted; a long list is cut and says by how many.
pub(crate) fn list<S: AsRef<str>>(names: &[S]) -> String {
    const SHOWN: usize = 12;
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| format!("'{}'", name.as_ref())).collect();
    match names.len().checked_sub(SHOWN) {
        None | Some(0) => shown.join(", "),
        Some(more) => format!("{} and {more} more", shown.join(", ")),
    }
}
