//! The argument `robot`.

use pyo3::prelude::*;

use crate::arguments::wrong;
use crate::robot::PyRobot;

/// The argument `robot`.
pub fn robot<'py>(object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyRobot>> {
    let robot = object.cast::<PyRobot>().cloned();
    robot.map_err(|error| wrong("robot", "a contactsense.Robot", object, error.into()))
}
