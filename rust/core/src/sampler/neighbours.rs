//! Moves of a contact to a link beside its own, at about the same place in the world.
//!
//! Near a joint, a place on the next link explains nearly the same torques. Which of the two it is shows only when both places are as
//! exact, and one that is drawn anywhere hardly ever is.

use nalgebra::Vector3;

use super::hypothesis::Claim;
use crate::math::random::Stream;
use crate::robot::Robot;
use crate::spatial::Pose;

/// How far the place moves: the logarithm of the standard deviation along each axis is uniform between those of these (m).
const ASIDE: [f64; 2] = [2e-3, 5e-2];

/// Links beside each link, of those that are looked on.
#[derive(Debug, Clone)]
pub(super) struct Neighbours(Vec<Vec<u32>>);

impl Neighbours {
    /// Of a robot whose `wanted` links are looked on: with no other of them between.
    pub fn new(robot: &Robot, wanted: &[usize]) -> Self {
        let mut beside = vec![vec![]; robot.links().len()];
        for &link in wanted {
            let above = |link: &usize| robot.links()[*link].parent().map(|parent| parent.get());
            let before = std::iter::successors(above(&link), above).find(|parent| wanted.contains(parent));
            if let Some(before) = before {
                beside[before].push(link as u32);
                beside[link].push(before as u32);
            }
        }
        Neighbours(beside)
    }

    fn beside(&self, link: u32) -> &[u32] {
        &self.0[link as usize]
    }

    /// Another claim on a link beside, of links at their first poses, and the logarithm of how many times as likely the way back is
    /// proposed. The places are taken to be on parallel surfaces: then each leads to the other as easily.
    pub fn claim_beside(
        &self,
        mut claim: Claim,
        robot: &Robot,
        poses: &[Pose],
        random: Stream,
    ) -> Option<(Claim, f64)> {
        let own = self.beside(claim.link);
        let link = *own.get((random.uniform(0) * own.len() as f64) as usize)?;
        let scale = ASIDE[0] * (ASIDE[1] / ASIDE[0]).powf(random.uniform(1));
        let ([x, y], [z, _]) = (random.normals(2), random.normals(4));
        let first = |link: u32| &poses[link as usize];
        let place = first(claim.link).transform_point(&claim.place.point) + Vector3::new(x, y, z) * scale;
        let surface = robot.links()[link as usize].surface.as_deref()?;
        let near = surface.closest_point(&first(link).inverse_transform_point(&place));
        if surface.hides(&near.point, near.triangle) {
            return None;
        }
        claim.link = link;
        claim.place = near.into();
        Some((claim, (own.len() as f64 / self.beside(link).len() as f64).ln()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_that_are_not_looked_on_are_passed_over() {
        let robot = Robot::example_arm();
        let link = |name: &str| robot.link(name).expect("a link").get();
        let wanted = ["link_2", "link_4", "link_5"].map(link);
        let neighbours = Neighbours::new(&robot, &wanted);
        assert_eq!(neighbours.beside(wanted[0] as u32), [wanted[1] as u32]);
        assert_eq!(neighbours.beside(wanted[1] as u32), [wanted[0] as u32, wanted[2] as u32]);
        assert!(neighbours.beside(link("link_3") as u32).is_empty());
    }
}
