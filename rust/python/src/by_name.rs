//! Values by joint name, and the pose of a floating base, from Python objects.

use nalgebra::{Rotation3, UnitQuaternion};
use pyo3::prelude::*;
use pyo3::types::PyMapping;

use crate::arrays::Vector;
use crate::description::placement;
use crate::errors::input;

/// `{name: value}`.
pub fn by_name(argument: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<(String, f64)>> {
    let wrong = || input(object.py(), format!("{argument}: expected {{joint name: number}}"));
    let mapping = object.cast::<PyMapping>().map_err(|_| wrong())?;
    mapping.items()?.iter().map(|item| item.extract::<(String, f64)>().map_err(|_| wrong())).collect()
}

pub fn pairs(values: &[(String, f64)]) -> Vec<(&str, f64)> {
    values.iter().map(|(name, value)| (name.as_str(), *value)).collect()
}

/// Position and quaternion xyzw, from these or a homogeneous matrix.
pub fn base_pose(object: &Bound<'_, PyAny>) -> PyResult<[f64; 7]> {
    if let Ok(vector) = Vector::new("base", object) {
        return vector.fixed::<7>(object.py(), "base");
    }
    let pose = placement("base", object)?;
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(pose.rotation));
    let ([x, y, z], [i, j, k, w]) = (pose.translation.into(), turn.coords.into());
    Ok([x, y, z, i, j, k, w])
}
