//! Contacts in the making.

use nalgebra::Vector3;

use super::line::farthest_entry;
use super::region::Region;
use super::result::Candidate;
use super::wrench::WrenchEstimate;
use crate::robot::{Kinematics, Link, LinkIndex, Robot};

/// Where the search is.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub robot: &'a Robot,
    pub kinematics: &'a Kinematics,
    pub region: &'a Region,
}

impl Scene<'_> {
    /// The middle of a link's surface, from the kinematics' origin; none where it has no surface.
    pub fn middle(&self, link: LinkIndex) -> Option<Vector3<f64>> {
        let Link { surface, body, placement, .. } = &self.robot[link];
        let (centre, _) = surface.as_ref()?.bounding_sphere();
        let body = &self.kinematics.bodies[*body];
        Some(body.position + body.rotation * (placement.rotation * centre + placement.translation))
    }
}

/// Where a line of action enters a body first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub hit: Candidate,
    /// Distance of the farthest other place where it enters the same body, zero if there is none (m).
    pub apart: f64,
}

impl Entry {
    /// The first of `hits`, which are ordered best first; none if the force enters nowhere.
    pub fn of(hits: &[Candidate]) -> Option<Self> {
        let hit = hits.first().copied().filter(|hit| hit.pushing)?;
        Some(Self { hit, apart: farthest_entry(hits, &hit) })
    }
}

/// A contact that is found.
#[derive(Debug, Clone)]
pub(super) struct Found {
    pub wrench: WrenchEstimate,
    pub hit: Candidate,
    /// Of all torques, with the point known; else that of the wrench.
    pub force: Vector3<f64>,
    /// Distance of the farthest other place where the line enters the body, zero if there is none (m).
    pub apart: f64,
}

impl Found {
    pub fn new(wrench: WrenchEstimate, entry: Entry) -> Self {
        let force = wrench.force;
        Self { wrench, hit: entry.hit, force, apart: entry.apart }
    }
}

/// One way to explain the torques by two forces.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    pub contacts: [Found; 2],
    pub misfit: f64,
    pub steepness: f64,
}
