//! Contacts of a link with an obstacle at the poses of a window.

use nalgebra::Vector3;

use super::motion::signed;
use super::window::{Sample, Window, POSES};
use crate::surface::Surface;
use crate::torque::{BestForce, ForceModel};

/// What an obstacle is fitted to.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub window: &'a Window,
    pub link: usize,
    pub surface: &'a Surface,
    pub force_model: ForceModel,
    /// How many torques are measured.
    pub joints: usize,
}

/// Contacts of a link with an obstacle at the poses of a window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contacts {
    /// Squared norm of the torques that are left over of the joints that move the link, each over its noise.
    pub misfit: f64,
    /// That of all torques of the other joints, which no force on the link explains.
    pub others: f64,
    /// One a pose: normal force [N], its variance by the stated noise [N^2], and the distance from the centre to the
    /// surface, negative inside [m].
    pub force: [f64; POSES],
    pub variance: [f64; POSES],
    pub distance: [f64; POSES],
    /// At the newest pose, in the link's frame [m].
    pub point: Vector3<f64>,
}

impl Default for Contacts {
    fn default() -> Self {
        Contacts {
            misfit: f64::INFINITY,
            others: f64::INFINITY,
            force: [0.0; POSES],
            variance: [0.0; POSES],
            distance: [0.0; POSES],
            point: Vector3::zeros(),
        }
    }
}

/// The contact of a link with an obstacle at one pose.
pub(super) struct Contact {
    pub point: Vector3<f64>,
    pub distance: f64,
    pub triangle: Option<u32>,
    pub force: f64,
    pub variance: f64,
    pub misfit: f64,
    pub others: f64,
}

impl Contact {
    /// Sets the residual: torques of the joints that move the link, and the force across the normal, each over its
    /// standard deviation.
    pub fn of(
        task: &Task<'_>,
        sample: &Sample,
        centre: &Vector3<f64>,
        triangle: Option<u32>,
        residual: &mut [f64],
    ) -> Contact {
        let (frame, target) = (&sample.links[task.link], sample.target.on(task.link));
        let local = frame.pose.inverse_transform_point(centre);
        let near = task.surface.closest_point_near(&local, triangle);
        let (distance, normal) = signed(&near, &local);
        let best = BestForce::of(frame, target, task.force_model, &near.point, &normal);
        let joints = frame.rows().len();
        let (chain, left) = frame.left_over(&near.point, &best.force, target, &mut residual[..joints]);
        residual[joints..joints + 2].copy_from_slice(&best.across);
        let across = best.across[0].powi(2) + best.across[1].powi(2);
        Contact {
            point: near.point,
            distance,
            triangle: near.triangle,
            force: best.normal,
            variance: best.variance,
            misfit: left + across,
            others: (sample.target.squared - chain).max(0.0),
        }
    }
}
