//! Contacts in the making.

use nalgebra::Vector3;

use super::region::Region;
use super::result::Candidate;
use super::wrench::WrenchEstimate;
use crate::robot::{Kinematics, Robot};

/// Where the search is.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub robot: &'a Robot,
    pub kinematics: &'a Kinematics,
    pub region: &'a Region,
}

/// A contact that is found.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub wrench: WrenchEstimate,
    pub hit: Candidate,
    /// Of all torques, with the point known; else that of the wrench.
    pub force: Vector3<f64>,
}

impl Found {
    pub fn new(wrench: WrenchEstimate, hit: Candidate) -> Self {
        let force = wrench.force;
        Self { wrench, hit, force }
    }
}

/// One way to explain the torques by two forces.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    pub contacts: [Found; 2],
    pub misfit: f64,
    pub steepness: f64,
}
