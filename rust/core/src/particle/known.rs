//! A contact as the others take it to be: where it is, but for a spread, and what its force may do.

use nalgebra::{Vector3, Vector6};

use super::instant::Instant;
use super::motion::signed;
use super::response::ResponseModel;
use crate::robot::Robot;
use crate::spatial::vector::stack;
use crate::torque::directions;

/// Unknowns of a contact: its force along the normal and across it; and its place.
pub(super) const FORCES: usize = 3;
pub(super) const PLACES: usize = 2;
/// A force is known no better than this, or than its own size [N]: another contact may have been taken for a part of it. That of a
/// contact that was sure follows the motion.
const LEAST_DOUBT: f64 = 10.0;
const LEAST_SURE_DOUBT: f64 = 1.0;
const SURE_DOUBT: f64 = 0.2;
/// The normal is known no better than this, as the surface is made of triangles, and within the spread it turns as on a radius of so much;
/// at most to any direction of the half-space [rad, m].
const TILT: [f64; 2] = [0.3, 1.0];
const ROUND: f64 = 0.1;
/// A spread wider than a link is one over several links [m].
const WIDEST: f64 = 0.3;

/// A contact whose place is held to be known, in its link's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub link: usize,
    /// On the surface [m].
    pub point: Vector3<f64>,
    /// Outward.
    pub normal: Vector3<f64>,
    /// Along the inward normal [N].
    pub force: f64,
    /// Of the point [m].
    pub spread: f64,
    /// Whether motion has confirmed it, so that its force is known too.
    pub sure: bool,
    /// That it is with; none where nothing is assumed of it.
    pub obstacle: Option<Spring>,
}

/// An obstacle that stays where it is, and springs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spring {
    /// Of curvature, world frame [m].
    pub centre: Vector3<f64>,
    /// From there to the surface, negative inside [m].
    pub distance: f64,
    /// Triangle of the point.
    pub triangle: Option<u32>,
    /// [N/m].
    pub stiffness: f64,
}

/// An unknown: the wrench of one standard deviation of it, and its mean over that.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unknown {
    pub wrench: Vector6<f64>,
    pub mean: f64,
}

impl Known {
    /// Does nothing.
    pub const NOWHERE: Known = Known {
        link: 0,
        point: Vector3::new(0.0, 0.0, 0.0),
        normal: Vector3::new(0.0, 0.0, 1.0),
        force: 0.0,
        spread: 0.0,
        sure: false,
        obstacle: None,
    };

    /// Follows the robot to the present pose (Bimbo 2019, eq. 8).
    pub fn follow(&mut self, robot: &Robot, instant: &Instant) {
        let Some((spring, surface)) = self.obstacle.as_mut().zip(robot.links()[self.link].surface.as_ref())
        else {
            return;
        };
        let local = instant.pose(self.link).inverse_transform_point(&spring.centre);
        let near = surface.closest_point_near(&local, spring.triangle);
        let (distance, normal) = signed(&near, &local);
        self.force = (self.force + (spring.distance - distance) * spring.stiffness).max(0.0);
        (self.point, self.normal) = (near.point, normal);
        (spring.distance, spring.triangle) = (distance, near.triangle);
    }

    /// Standard deviations of the three forces.
    fn deviations(&self, model: &ResponseModel) -> [f64; FORCES] {
        let friction = model.force_model.deviation_across(self.force).unwrap_or(0.0);
        let tilt = (self.spread / ROUND).clamp(TILT[0], TILT[1]);
        let across = friction.hypot(tilt * self.force);
        let along = if self.sure {
            (SURE_DOUBT * self.force).max(LEAST_SURE_DOUBT)
        } else {
            self.force.max(LEAST_DOUBT)
        };
        // Weights are in units of a noise that may be greater than stated.
        [along, across, across].map(|deviation| deviation / model.variance.sqrt())
    }

    pub fn forces(&self, model: &ResponseModel) -> [Unknown; FORCES] {
        let (directions, deviations) = (directions(&self.normal), self.deviations(model));
        std::array::from_fn(|a| {
            let force = directions[a] * deviations[a];
            let mean = if a == 0 { self.force / deviations[a] } else { 0.0 };
            Unknown { wrench: stack(&force, &self.point.cross(&force)), mean }
        })
    }

    /// To first order, a force that acts somewhere else has another moment.
    pub fn places(&self, model: &ResponseModel) -> [Unknown; PLACES] {
        let [inward, first, second] = directions(&self.normal);
        let aside = self.spread.min(WIDEST) / model.variance.sqrt();
        [first, second].map(|along| Unknown {
            wrench: stack(&Vector3::zeros(), &(along * aside).cross(&(inward * self.force))),
            mean: 0.0,
        })
    }
}
