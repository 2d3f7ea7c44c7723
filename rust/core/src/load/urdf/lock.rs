//! Joints held at a fixed position.

use urdf_rs::JointType;

use super::names::name_list;
use super::tree::Tree;
use crate::error::{Error, Result};

/// The position of each locked joint, in the order given; [`Error::Input`] lists the valid names.
pub(super) fn positions(tree: &Tree, locked: &[(String, Option<f64>)]) -> Result<Vec<(String, f64)>> {
    let mut positions: Vec<(String, f64)> = Vec::new();
    for (name, position) in locked {
        if !tree.moving().any(|joint| joint.name == *name) {
            let valid: Vec<String> = tree.moving().map(|joint| format!("'{}'", joint.name)).collect();
            return Err(Error::input(
                "locked_joints",
                format!("'{name}' is no joint that moves; valid names: {}", valid.join(", ")),
            ));
        }
        let position = position.unwrap_or(0.0);
        if !position.is_finite() {
            return Err(Error::input(
                "locked_joints",
                format!("the position of '{name}' must be a finite number, not {position}"),
            ));
        }
        match positions.iter_mut().find(|(known, _)| known == name) {
            Some((_, known)) => *known = position,
            None => positions.push((name.clone(), position)),
        }
    }
    Ok(positions)
}

/// A warning of positions outside the joints' limits.
pub(super) fn outside_limits(tree: &Tree, locked: &[(String, f64)]) -> Option<String> {
    let is_outside = |name: &str, position: f64| {
        tree.moving().any(|joint| {
            let range = joint.limit.lower..=joint.limit.upper;
            joint.name == name && joint.joint_type != JointType::Continuous && !range.contains(&position)
        })
    };
    let outside = locked.iter().filter(|(name, position)| is_outside(name, *position));
    let outside: Vec<&str> = outside.map(|(name, _)| name.as_str()).collect();
    let text = || format!("These joints are locked outside their limits: {}", name_list(&outside));
    (!outside.is_empty()).then(text)
}
