//! Values that options give to joints by name.

use urdf_rs::{JointType, Robot};

use super::tree::moving;
use crate::error::{Error, Result};
use crate::robot::check::list;

/// The value of each joint of the option `argument`, of a joint named twice the last.
///
/// [`Error::Input`] lists the valid names.
pub(super) fn by_joint(
    robot: &Robot,
    argument: &'static str,
    given: &[(String, f64)],
) -> Result<Vec<(String, f64)>> {
    let mut values: Vec<(String, f64)> = vec![];
    for (name, value) in given {
        let valid = || moving(robot).filter(|joint| joint.joint_type != JointType::Floating);
        if !valid().any(|joint| joint.name == *name) {
            let names: Vec<String> = valid().map(|joint| format!("'{}'", joint.name)).collect();
            let text = format!("'{name}' is no joint that moves; valid names: {}", names.join(", "));
            return Err(Error::input(argument, text));
        }
        if !value.is_finite() {
            let text = format!("the value of '{name}' must be a finite number, not {value}");
            return Err(Error::input(argument, text));
        }
        values.retain(|(known, _)| known != name);
        values.push((name.clone(), *value));
    }
    Ok(values)
}

/// A warning of positions outside the joints' limits.
pub(super) fn outside_limits(robot: &Robot, locked: &[(String, f64)]) -> Option<String> {
    let is_outside = |(name, position): &&(String, f64)| {
        moving(robot).any(|joint| {
            let range = joint.limit.lower..=joint.limit.upper;
            joint.name == *name && joint.joint_type != JointType::Continuous && !range.contains(position)
        })
    };
    let outside: Vec<&str> = locked.iter().filter(is_outside).map(|(name, _)| name.as_str()).collect();
    (!outside.is_empty()).then(|| format!("These joints are locked outside their limits: {}", list(&outside)))
}
