//! Names of links, joints and sensors, which results carry so that they need no robot.

use std::sync::Arc;

use contactsense::robot::{LinkIndex, Robot};
use serde::{Deserialize, Serialize};

/// In the order of the core's indices.
#[derive(Serialize, Deserialize)]
pub struct Names {
    pub links: Vec<String>,
    pub joints: Vec<String>,
    pub sensors: Vec<String>,
}

impl Names {
    pub fn new(robot: &Robot, sensors: &[String]) -> Arc<Self> {
        let links = robot.links().iter().map(|link| link.name.clone()).collect();
        Arc::new(Names { links, joints: robot.joint_names().to_vec(), sensors: sensors.to_vec() })
    }

    pub fn link(&self, link: LinkIndex) -> &str {
        &self.links[link.get()]
    }
}
