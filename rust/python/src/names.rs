//! Names that results refer to.

use std::sync::Arc;

use contactsense::robot::{LinkIndex, Robot};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde::{Deserialize, Serialize};

/// The names of a robot's links and joints and of its sensors, shared by all results of one object: a result needs no
/// robot, and can be pickled without one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Names {
    pub links: Vec<String>,
    pub joints: Vec<String>,
    pub sensors: Vec<String>,
}

impl Names {
    pub fn new(robot: &Robot, sensors: &[String]) -> Arc<Self> {
        Arc::new(Self {
            links: robot.links().iter().map(|link| link.name.clone()).collect(),
            joints: robot.joint_names().iter().map(ToString::to_string).collect(),
            sensors: sensors.to_vec(),
        })
    }

    /// The name of a link.
    pub fn link(&self, link: LinkIndex) -> &str {
        &self.links[link.get()]
    }

    /// The names of links.
    pub fn of_links<'py>(&self, py: Python<'py>, links: &[LinkIndex]) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, links.iter().map(|link| self.link(*link)))
    }
}
