//! What obstacles that stay do to the robot at another pose.

use nalgebra::Vector3;

use super::obstacle::Obstacle;
use crate::particle::signed;
use crate::robot::{Kinematics, Robot};
use crate::spatial::Pose;
use crate::surface::{Surface, SurfacePoint};
use crate::torque::Frames;

/// The robot at one pose.
#[derive(Debug, Clone)]
pub(super) struct Prediction<'a> {
    robot: &'a Robot,
    kinematics: Kinematics,
    frames: Frames,
    /// Torques are not weighed here.
    ones: Vec<f64>,
}

/// An obstacle's contact at a pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    /// Link frame.
    point: Vector3<f64>,
    normal: Vector3<f64>,
    pub triangle: Option<u32>,
    /// How much deeper the obstacle is in the link than before the motion (m).
    pub deeper: f64,
}

impl<'a> Prediction<'a> {
    /// At a checked configuration.
    pub fn new(robot: &'a Robot, links: Vec<usize>, q: &[f64]) -> Self {
        let frames = Frames::new(robot, links);
        let mut made =
            Prediction { robot, kinematics: Kinematics::new(robot), frames, ones: vec![1.0; robot.nv()] };
        made.move_to(q);
        made
    }

    /// Takes on a checked configuration.
    pub fn move_to(&mut self, q: &[f64]) {
        self.kinematics.set_configuration(self.robot, q);
        self.frames.update(self.robot, &self.kinematics, &self.ones);
    }

    pub fn pose(&self, link: usize) -> &Pose {
        &self.frames.links[link].pose
    }

    pub fn surface(&self, link: usize) -> Option<&Surface> {
        self.robot.links()[link].surface.as_deref()
    }

    /// Where an obstacle touches; `triangle` is near the point of the link's surface.
    pub fn touch(&self, obstacle: &Obstacle, triangle: Option<u32>) -> Option<Touch> {
        let surface = self.surface(obstacle.link)?;
        let local = self.pose(obstacle.link).inverse_transform_point(&obstacle.centre);
        let near = surface.closest_point_from(&local, triangle);
        let (distance, normal) = signed(&near, &local);
        let deeper = obstacle.distance - distance;
        Some(Touch { point: near.point, normal, triangle: near.triangle, deeper })
    }

    /// Adds the torque of a unit force along the inward normal of a contact (Nm/N).
    pub fn add_unit_torque(&self, link: usize, touch: &Touch, torque: &mut [f64]) {
        self.frames.subtract(link, &touch.point, &touch.normal, &self.ones, torque);
    }

    /// The torque of a force at a point of a link, both in its frame (Nm).
    pub fn torque(&self, link: usize, point: &Vector3<f64>, force: &Vector3<f64>) -> Vec<f64> {
        let mut torque = vec![0.0; self.ones.len()];
        self.frames.subtract(link, point, &-force, &self.ones, &mut torque);
        torque
    }

    /// The force along the inward normal at a place of a link that explains a torque best (N), and the squared norm of what it
    /// leaves over, each joint over its deviation (Bimbo 2019, eq. 7).
    pub fn fit(&self, link: usize, at: &SurfacePoint, torque: &[f64], deviation: &[f64]) -> (f64, f64) {
        let unit = self.torque(link, &at.point, &-at.normal);
        let (mut gain, mut product, mut squared) = (0.0, 0.0, 0.0);
        for ((unit, torque), deviation) in unit.iter().zip(torque).zip(deviation) {
            let (unit, torque) = (unit / deviation, torque / deviation);
            gain += unit * unit;
            product += unit * torque;
            squared += torque * torque;
        }
        let force = if gain > 0.0 { (product / gain).max(0.0) } else { 0.0 };
        (force, (squared - force * (2.0 * product - force * gain)).max(0.0))
    }
}
