//! What a force on a link does to the joints at one pose, each joint over its noise. The measured torque is no part of it.

use nalgebra::{Matrix3, Matrix4, Matrix6, Matrix6x3, Matrix6x4, Vector3, Vector4, Vector6};

use super::link_target::LinkTarget;
use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, LinkIndex, Robot, WORLD};
use crate::spatial::vector::{split, stack};
use crate::spatial::Pose;

/// A joint axis in a link's frame, divided by the joint's noise: its torque under a force at a point is
/// `linear . force + angular . (point x force)`.
#[derive(Debug, Clone, Copy)]
struct Axis {
    linear: Vector3<f64>,
    angular: Vector3<f64>,
}

/// One link that can be in contact.
#[derive(Debug, Clone)]
pub(crate) struct Frame {
    pub pose: Pose,
    /// One a velocity variable that moves the link.
    axes: Vec<Axis>,
    /// Which ones these are.
    variables: Vec<usize>,
    /// `J J^T` of the columns (linear, angular) of all axes: the squared norm of a wrench's torques is
    /// `wrench^T gram wrench`, for a wrench at the link's origin in its frame.
    pub(super) gram: Matrix6<f64>,
}

impl Frame {
    /// How many velocity variables move the link.
    pub fn joints(&self) -> usize {
        self.axes.len()
    }

    /// What a wrench at the link's origin does, as the torques of these joints over their noise.
    pub fn column(&self, axis: usize) -> Vector6<f64> {
        stack(&self.axes[axis].linear, &self.axes[axis].angular)
    }

    /// The velocity variables that move the link.
    pub fn variables(&self) -> &[usize] {
        &self.variables
    }

    /// Squared norm of the torques of a unit force along the inward normal, and their product with a target, each joint
    /// over its noise (Bimbo 2019, eqs. 6 and 7).
    #[inline]
    pub fn response(&self, point: &Vector3<f64>, normal: &Vector3<f64>, target: &LinkTarget) -> (f64, f64) {
        let wrench = stack(normal, &point.cross(normal));
        (wrench.dot(&(self.gram * wrench)), -wrench.dot(&target.product))
    }

    /// As [`response`](Self::response), of unit forces in three directions: the Gram matrix of their torques, and the
    /// products with the target.
    #[inline]
    pub fn responses(
        &self,
        point: &Vector3<f64>,
        forces: &[Vector3<f64>; 3],
        target: &LinkTarget,
    ) -> (Matrix3<f64>, Vector3<f64>) {
        let wrenches = Matrix6x3::from_columns(&forces.map(|force| stack(&force, &point.cross(&force))));
        (wrenches.tr_mul(&(self.gram * wrenches)), wrenches.tr_mul(&target.product))
    }

    /// The normal equations of a weight that the link carries: of its mass times gravity, and of that times its place.
    /// `down` is the direction of gravity in the world frame.
    pub fn weight(&self, down: &Vector3<f64>, target: &LinkTarget) -> (Matrix4<f64>, Vector4<f64>) {
        let down = self.pose.inverse_transform_vector(down);
        let mut wrenches = Matrix6x4::zeros();
        wrenches.fixed_view_mut::<3, 1>(0, 0).copy_from(&down);
        // The moment of the place c is c x down.
        wrenches.fixed_view_mut::<3, 3>(3, 1).copy_from(&-down.cross_matrix());
        (wrenches.tr_mul(&(self.gram * wrenches)), wrenches.tr_mul(&target.product))
    }

    /// Sets the torques that a force at a point leaves over of a target; returns the squared norm of the target, and of
    /// those left over.
    #[inline]
    pub fn left_over(
        &self,
        point: &Vector3<f64>,
        force: &Vector3<f64>,
        target: &LinkTarget,
        left: &mut [f64],
    ) -> (f64, f64) {
        let moment = point.cross(force);
        let mut squares = (0.0, 0.0);
        for ((left, axis), target) in left.iter_mut().zip(&self.axes).zip(&target.torque) {
            *left = target - (axis.linear.dot(force) + axis.angular.dot(&moment));
            squares.0 += target * target;
            squares.1 += *left * *left;
        }
        squares
    }

    /// Takes on the numbers of the same link at another pose.
    pub fn copy(&mut self, other: &Frame) {
        self.pose = other.pose;
        self.axes.copy_from_slice(&other.axes);
        self.gram = other.gram;
    }
}

/// The links' frames; one a link of the robot, empty where none is looked for.
#[derive(Debug, Clone)]
pub(crate) struct Frames {
    pub links: Vec<Frame>,
    /// Indices of those that can be in contact.
    pub wanted: Vec<usize>,
}

impl Frames {
    pub fn new(robot: &Robot, wanted: Vec<usize>) -> Self {
        let still = Axis { linear: Vector3::zeros(), angular: Vector3::zeros() };
        let frame = |body: usize| {
            let chain = if body == WORLD { &[] } else { robot.chain(body) };
            let variables: Vec<usize> = chain.iter().flat_map(|&body| robot.velocity_range(body)).collect();
            Frame {
                pose: Pose::identity(),
                axes: vec![still; variables.len()],
                variables,
                gram: Matrix6::zeros(),
            }
        };
        Frames { links: robot.links().iter().map(|link| frame(link.body)).collect(), wanted }
    }

    /// Takes on a pose of the robot, and the standard deviation of each torque.
    pub fn update(&mut self, robot: &Robot, kinematics: &Kinematics, deviation: &[f64]) {
        for &index in &self.wanted {
            let frame = &mut self.links[index];
            frame.pose = kinematics.link_pose(robot, LinkIndex::new(index));
            // From the reference origin of the kinematics to the link's.
            let arm = frame.pose.translation - kinematics.origin;
            frame.gram = Matrix6::zeros();
            let mut axes = frame.axes.iter_mut();
            for_each_column(robot, kinematics, robot.links()[index].body, &arm, |k, column| {
                let (linear, angular) = split(&column);
                if let Some(axis) = axes.next() {
                    axis.linear = frame.pose.inverse_transform_vector(&(linear / deviation[k]));
                    axis.angular = frame.pose.inverse_transform_vector(&(angular / deviation[k]));
                    let column = stack(&axis.linear, &axis.angular);
                    frame.gram += column * column.transpose();
                }
            });
        }
    }

    /// Takes on the pose of `plain` frames, whose torques are not weighed, with the standard deviation of each torque.
    pub fn weigh(&mut self, plain: &Frames, deviation: &[f64]) {
        for &index in &self.wanted {
            let (frame, plain) = (&mut self.links[index], &plain.links[index]);
            frame.pose = plain.pose;
            frame.gram = Matrix6::zeros();
            for ((axis, plain), &k) in frame.axes.iter_mut().zip(&plain.axes).zip(&frame.variables) {
                axis.linear = plain.linear / deviation[k];
                axis.angular = plain.angular / deviation[k];
                let column = stack(&axis.linear, &axis.angular);
                frame.gram += column * column.transpose();
            }
        }
    }

    /// Takes from torques [Nm] what a force at a point of a link does (all in the link's frame).
    pub fn subtract(
        &self,
        link: usize,
        point: &Vector3<f64>,
        force: &Vector3<f64>,
        deviation: &[f64],
        torque: &mut [f64],
    ) {
        let frame = &self.links[link];
        let moment = point.cross(force);
        for (axis, &k) in frame.axes.iter().zip(&frame.variables) {
            torque[k] -= (axis.linear.dot(force) + axis.angular.dot(&moment)) * deviation[k];
        }
    }
}
