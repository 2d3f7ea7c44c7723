//! Joints held at a fixed position.

use std::collections::HashMap;

use urdf_rs::JointType;

use super::name_list;
use super::tree::Tree;
use crate::error::{Error, Result};

/// The position of each locked joint; [`Error::Input`] lists the valid names.
pub(super) fn positions(tree: &Tree, locked: &[(String, Option<f64>)]) -> Result<HashMap<String, f64>> {
    let mut positions = HashMap::new();
    for (name, position) in locked {
        if !tree.moving().any(|joint| joint.name == *name) {
            let valid: Vec<String> = tree.moving().map(|joint| format!("'{}'", joint.name)).collect();
            return Err(Error::Input(format!(
                "locked_joints: '{name}' is no joint that moves; valid names: {}",
                valid.join(", ")
            )));
        }
        let position = position.unwrap_or(0.0);
        if !position.is_finite() {
            return Err(Error::Input(format!(
                "locked_joints: the position of '{name}' must be a finite number, not {position}"
            )));
        }
        positions.insert(name.clone(), position);
    }
    Ok(positions)
}

/// A warning of positions outside the joints' limits.
pub(super) fn outside_limits(tree: &Tree, locked: &HashMap<String, f64>) -> Option<String> {
    let outside: Vec<&str> = tree
        .moving()
        .filter(|joint| joint.joint_type != JointType::Continuous)
        .filter(|joint| {
            let position = locked.get(&joint.name);
            position.is_some_and(|position| !(joint.limit.lower..=joint.limit.upper).contains(position))
        })
        .map(|joint| joint.name.as_str())
        .collect();
    let text = || format!("These joints are locked outside their limits: {}", name_list(&outside));
    (!outside.is_empty()).then(text)
}
