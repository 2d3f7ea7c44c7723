//! Per step and link: pose, and what a force on it does to the joints, all in the link's frame.

use nalgebra::{Matrix3, Matrix4, Vector3, Vector4};

use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, Robot, WORLD};
use crate::spatial::vector::split;
use crate::spatial::Pose;

/// A joint axis in a link's frame, divided by the joint's noise: its torque under a force at a point is
/// `linear . force + angular . (point x force)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Screw {
    linear: Vector3<f64>,
    angular: Vector3<f64>,
    /// Measured torque over its noise.
    torque: f64,
}

/// One link that can be in contact.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub pose: Pose,
    /// At the step before.
    pub before: Pose,
    /// One a velocity variable that moves the link.
    screws: Vec<Screw>,
    /// Sphere around the surface, link frame [m].
    center: Vector3<f64>,
    radius: f64,
}

impl Frame {
    /// Squared norm of the torques of a unit force along the inward normal, and their product with those measured,
    /// each joint over its noise (Bimbo 2019, eqs. 6 and 7).
    #[inline]
    pub fn response(&self, point: &Vector3<f64>, normal: &Vector3<f64>) -> (f64, f64) {
        let moment = point.cross(normal);
        let (mut gain, mut product) = (0.0, 0.0);
        for screw in &self.screws {
            let torque = -(screw.linear.dot(normal) + screw.angular.dot(&moment));
            gain += torque * torque;
            product += torque * screw.torque;
        }
        (gain, product)
    }

    /// As [`response`](Self::response), of unit forces in three directions: the Gram matrix of their torques, and the
    /// products with those measured.
    #[inline]
    pub fn responses(
        &self,
        point: &Vector3<f64>,
        forces: &[Vector3<f64>; 3],
    ) -> (Matrix3<f64>, Vector3<f64>) {
        let moments = forces.map(|force| point.cross(&force));
        let (mut gram, mut products) = (Matrix3::zeros(), Vector3::zeros());
        for screw in &self.screws {
            let torque = |i: usize| screw.linear.dot(&forces[i]) + screw.angular.dot(&moments[i]);
            let torques = Vector3::new(torque(0), torque(1), torque(2));
            gram += torques * torques.transpose();
            products += torques * screw.torque;
        }
        (gram, products)
    }

    /// Adds the normal equations of a weight on the link: of its mass times gravity, and of that times its place.
    pub fn add_weight(&self, down: &Vector3<f64>, gram: &mut Matrix4<f64>, products: &mut Vector4<f64>) {
        let down = self.pose.inverse_transform_vector(down);
        for screw in &self.screws {
            let moment = down.cross(&screw.angular);
            let torques = Vector4::new(screw.linear.dot(&down), moment.x, moment.y, moment.z);
            *gram += torques * torques.transpose();
            *products += torques * screw.torque;
        }
    }

    /// Sets the torques that are left over of those measured without those of a force at a point, each over its noise;
    /// returns the squared norm of those measured, and of those left over.
    #[inline]
    pub fn left_over(&self, point: &Vector3<f64>, force: &Vector3<f64>, left: &mut [f64]) -> (f64, f64) {
        let moment = point.cross(force);
        let mut squares = (0.0, 0.0);
        for (left, screw) in left.iter_mut().zip(&self.screws) {
            *left = screw.torque - (screw.linear.dot(force) + screw.angular.dot(&moment));
            squares.0 += screw.torque * screw.torque;
            squares.1 += *left * *left;
        }
        squares
    }

    /// Takes on the numbers of the same link at another step.
    pub fn copy(&mut self, other: &Frame) {
        self.pose = other.pose;
        self.before = other.before;
        self.screws.copy_from_slice(&other.screws);
    }
}

impl Frame {
    /// How many velocity variables move the link.
    pub fn joints(&self) -> usize {
        self.screws.len()
    }

    /// How far a point of the link moved at most since the step before [m].
    pub fn displacement(&self) -> f64 {
        self.apart(&self.before)
    }

    /// How far a point of the link is at most from where it is at another pose [m].
    pub fn apart(&self, pose: &Pose) -> f64 {
        let centre = self.pose.transform_point(&self.center) - pose.transform_point(&self.center);
        // Chord of the rotation at the rim: |R - R'| by Frobenius is sqrt(2) times that of a unit arm.
        let turned = (self.pose.rotation - pose.rotation).norm() / std::f64::consts::SQRT_2;
        centre.norm() + turned * self.radius
    }
}

/// The links' frames; one a link of the robot, empty where none is looked for.
#[derive(Debug, Clone)]
pub(super) struct Frames {
    kinematics: Kinematics,
    pub links: Vec<Frame>,
    /// Indices of those that can be in contact.
    pub wanted: Vec<usize>,
    /// Squared norm of the measured torques, each over its noise.
    pub measured: f64,
}

impl Frames {
    pub fn new(robot: &Robot, wanted: Vec<usize>) -> Self {
        let links = robot
            .links()
            .iter()
            .map(|link| {
                let (center, radius) = link
                    .surface
                    .as_ref()
                    .map_or((Vector3::zeros(), 0.0), |surface| surface.bounding_sphere());
                let count: usize =
                    robot.chain(link.body).iter().map(|&body| robot.velocity_range(body).len()).sum();
                let still = Screw { linear: Vector3::zeros(), angular: Vector3::zeros(), torque: 0.0 };
                Frame {
                    pose: Pose::identity(),
                    before: Pose::identity(),
                    screws: vec![still; if link.body == WORLD { 0 } else { count }],
                    center,
                    radius,
                }
            })
            .collect();
        Frames { kinematics: Kinematics::new(robot), links, wanted, measured: 0.0 }
    }

    /// Takes on a checked configuration and measured torques with their noise.
    pub fn update(&mut self, robot: &Robot, q: &[f64], torque: &[f64], noise: &[f64]) {
        self.kinematics.set_configuration(robot, q);
        self.measured = torque.iter().zip(noise).map(|(torque, noise)| (torque / noise).powi(2)).sum();
        for &index in &self.wanted {
            let frame = &mut self.links[index];
            frame.before = frame.pose;
            frame.pose = self.kinematics.link_pose(robot, index);
            // From the reference origin of the kinematics to the link's.
            let arm = frame.pose.translation - self.kinematics.origin;
            let mut screws = frame.screws.iter_mut();
            for_each_column(robot, &self.kinematics, robot.links()[index].body, &arm, |k, column| {
                let (linear, angular) = split(&column);
                if let Some(screw) = screws.next() {
                    screw.linear = frame.pose.inverse_transform_vector(&(linear / noise[k]));
                    screw.angular = frame.pose.inverse_transform_vector(&(angular / noise[k]));
                    screw.torque = torque[k] / noise[k];
                }
            });
        }
    }

    /// Takes from torques [Nm] what a force at a point of a link does (all in the link's frame).
    pub fn subtract(
        &self,
        robot: &Robot,
        link: usize,
        point: &Vector3<f64>,
        force: &Vector3<f64>,
        torque: &mut [f64],
    ) {
        let pose = &self.links[link].pose;
        let force = pose.rotation * force;
        // About the reference origin of the kinematics.
        let moment = (pose.transform_point(point) - self.kinematics.origin).cross(&force);
        for_each_column(robot, &self.kinematics, robot.links()[link].body, &Vector3::zeros(), |k, column| {
            let (linear, angular) = split(&column);
            torque[k] -= linear.dot(&force) + angular.dot(&moment);
        });
    }

    /// Forgets the step before: no link has moved.
    pub fn stand(&mut self) {
        for &index in &self.wanted {
            self.links[index].before = self.links[index].pose;
        }
    }

    /// How far a point of the robot moved at most since the step before [m].
    pub fn displacement(&self) -> f64 {
        self.wanted.iter().map(|&link| self.links[link].displacement()).fold(0.0, f64::max)
    }
}
