//! What loads each sensor: parts of bodies, since a sensor at a fixed joint carries only the links behind it.

use nalgebra::{Matrix3, Vector3};

use super::sensor_tree::SensorTree;
use crate::robot::{Robot, WORLD};

/// The part of a body that loads one sensor directly; about the body's origin, in its axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DistalPart {
    pub sensor: usize,
    pub body: usize,
    pub mass: f64,
    /// Mass times centre of mass.
    pub moment: Vector3<f64>,
    /// Rotational inertia about the body's origin.
    pub rotational: Matrix3<f64>,
}

impl DistalPart {
    fn new(mass: f64, com: Vector3<f64>, about_com: Matrix3<f64>) -> Self {
        let shift = Matrix3::from_diagonal_element(com.norm_squared()) - com * com.transpose();
        let rotational = about_com + shift * mass;
        Self { sensor: 0, body: 0, mass, moment: com * mass, rotational }
    }

    fn is_empty(&self) -> bool {
        self.mass == 0.0 && self.moment.amax() == 0.0 && self.rotational.amax() == 0.0
    }
}

/// All parts, bodies near the base first. What a body's links do not add up to goes to the link that its joint moves,
/// so that a body split by no sensor counts as the robot has it.
pub(crate) fn distal_parts(robot: &Robot, tree: &SensorTree) -> Vec<DistalPart> {
    let links = robot.links();
    let mut parts = vec![];
    for index in WORLD + 1..robot.body_count() {
        let body = &robot.bodies[index];
        let first_region = tree.at_joint(index);
        let mut rest = DistalPart::new(body.mass, body.com, body.inertia);
        for (number, link) in links.iter().enumerate().filter(|(_, link)| link.body == index) {
            let region = tree.fixed_of_link(number);
            if region == first_region {
                continue;
            }
            let turn = &link.placement.rotation;
            let about_com = turn * link.inertia * turn.transpose();
            let part = DistalPart::new(link.mass, link.placement.transform_point(&link.com), about_com);
            rest.mass -= part.mass;
            rest.moment -= part.moment;
            rest.rotational -= part.rotational;
            add(&mut parts, region, index, part);
        }
        add(&mut parts, first_region, index, rest);
    }
    parts
}

/// Parts of one body that load one sensor are one.
fn add(parts: &mut Vec<DistalPart>, sensor: Option<usize>, body: usize, part: DistalPart) {
    let Some(sensor) = sensor.filter(|_| !part.is_empty()) else { return };
    match parts.iter_mut().find(|known| known.body == body && known.sensor == sensor) {
        Some(known) => {
            known.mass += part.mass;
            known.moment += part.moment;
            known.rotational += part.rotational;
        }
        None => parts.push(DistalPart { sensor, body, ..part }),
    }
}
