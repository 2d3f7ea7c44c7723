//! What a force on a link does to the joints and the force/torque sensors at one pose, each row over its noise. What they
//! measured is no part of it.

use nalgebra::{Matrix3, Matrix4, Matrix6, Matrix6x4, Vector3, Vector4, Vector6};

use super::link_target::LinkTarget;
use super::normal_equations::{response, responses, NormalEquations};
use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, LinkIndex, Robot, WORLD};
use crate::spatial::vector::{split, stack};
use crate::spatial::Pose;

/// Rows of a sensor.
pub(crate) const WRENCH: usize = 6;

/// A joint axis, or an axis of a sensor, in a link's frame, divided by its noise: what it feels of a force at a point is
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
    /// One a velocity variable that moves the link, then six a sensor that the link loads.
    axes: Vec<Axis>,
    /// Which rows of a measurement these are.
    rows: Vec<usize>,
    /// Which sensors these are.
    sensors: Vec<usize>,
    /// `J J^T` of the columns (linear, angular) of all axes: the squared norm of a wrench's torques is
    /// `wrench^T gram wrench`, for a wrench at the link's origin in its frame.
    pub(super) gram: Matrix6<f64>,
}

impl Frame {
    /// What a wrench at the link's origin does to one of the rows, over its noise.
    pub fn column(&self, axis: usize) -> Vector6<f64> {
        stack(&self.axes[axis].linear, &self.axes[axis].angular)
    }

    /// `wrench^T gram wrench` is the squared norm of what a wrench at the link's origin does.
    pub fn gram(&self) -> &Matrix6<f64> {
        &self.gram
    }

    /// `wrench^T between other` is the inner product of what a wrench at this link's origin does and what another one does at that of
    /// another link.
    pub fn between(&self, other: &Frame) -> Matrix6<f64> {
        // Links share the joints that both chains begin with.
        let shared = self.rows.iter().zip(&other.rows).take_while(|(own, other)| own == other).count();
        (0..shared).map(|axis| self.column(axis) * other.column(axis).transpose()).sum()
    }

    /// The rows of a measurement that feel the link: the velocity variables that move it, then the components of the wrenches of
    /// sensors that it loads.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Squared norm of the torques of a unit force along the inward normal, and their product with a target, each joint
    /// over its noise (Bimbo 2019, eqs. 6 and 7).
    #[inline]
    pub fn response(&self, point: &Vector3<f64>, normal: &Vector3<f64>, target: &LinkTarget) -> (f64, f64) {
        response(&self.gram, &target.product, point, normal)
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
        responses(&self.gram, &target.product, point, forces)
    }

    /// The normal equations of a wrench at the link's origin.
    pub fn normal_equations(&self, target: &LinkTarget) -> NormalEquations {
        NormalEquations { gram: self.gram, product: target.product }
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

/// A force/torque sensor whose wrench is measured, as (force, moment) at its origin, world axes.
#[derive(Debug, Clone)]
pub(crate) struct SensorMount {
    /// That it is fixed to.
    pub body: usize,
    /// Its origin in the body's frame (m).
    pub origin: Vector3<f64>,
    /// By link: loads the sensor.
    pub loads: Vec<bool>,
}

/// The links' frames; one a link of the robot, empty where none is looked for.
#[derive(Debug, Clone)]
pub(crate) struct Frames {
    pub links: Vec<Frame>,
    /// Indices of those that can be in contact.
    pub wanted: Vec<usize>,
    sensors: Vec<SensorMount>,
}

impl Frames {
    /// Where the external torque is all that is measured: its rows are the velocity variables.
    pub fn new(robot: &Robot, wanted: Vec<usize>) -> Self {
        Self::with_sensors(robot, wanted, &[])
    }

    /// With the wrenches of sensors, whose rows follow the velocity variables, six each.
    pub fn with_sensors(robot: &Robot, wanted: Vec<usize>, sensors: &[SensorMount]) -> Self {
        let still = Axis { linear: Vector3::zeros(), angular: Vector3::zeros() };
        let frame = |link: usize| {
            let body = robot.links()[link].body;
            let chain = if body == WORLD { &[] } else { robot.chain(body) };
            let joints = chain.iter().flat_map(|&body| robot.velocity_range(body));
            let loaded: Vec<usize> = (0..sensors.len()).filter(|k| sensors[*k].loads[link]).collect();
            let components =
                loaded.iter().flat_map(|k| (0..WRENCH).map(move |i| robot.nv() + WRENCH * k + i));
            let rows: Vec<usize> = joints.chain(components).collect();
            Frame {
                pose: Pose::identity(),
                axes: vec![still; rows.len()],
                rows,
                sensors: loaded,
                gram: Matrix6::zeros(),
            }
        };
        Frames { links: (0..robot.links().len()).map(frame).collect(), wanted, sensors: sensors.to_vec() }
    }

    /// Takes on a pose of the robot, and the standard deviation of each row.
    pub fn update(&mut self, robot: &Robot, kinematics: &Kinematics, deviation: &[f64]) {
        let Self { links, wanted, sensors } = self;
        for &index in wanted.iter() {
            let frame = &mut links[index];
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
            for &sensor in &frame.sensors {
                let SensorMount { body, origin, .. } = &sensors[sensor];
                let state = &kinematics.bodies[*body];
                // From the sensor's origin to the link's.
                let arm = arm - (state.position + state.rotation * origin);
                let first = robot.nv() + WRENCH * sensor;
                for (i, axis) in axes.by_ref().take(WRENCH).enumerate() {
                    let along = Vector3::ith(i % 3, 1.0 / deviation[first + i]);
                    let (linear, angular) =
                        if i < 3 { (along, Vector3::zeros()) } else { (along.cross(&arm), along) };
                    axis.linear = frame.pose.inverse_transform_vector(&linear);
                    axis.angular = frame.pose.inverse_transform_vector(&angular);
                    let column = stack(&axis.linear, &axis.angular);
                    frame.gram += column * column.transpose();
                }
            }
        }
    }

    /// Takes on the pose of `plain` frames, whose rows are not weighed, with the standard deviation of each row; for some links.
    pub fn weigh(&mut self, plain: &Frames, deviation: &[f64], links: &[usize]) {
        for &index in links {
            let (frame, plain) = (&mut self.links[index], &plain.links[index]);
            frame.pose = plain.pose;
            frame.gram = Matrix6::zeros();
            for ((axis, plain), &k) in frame.axes.iter_mut().zip(&plain.axes).zip(&frame.rows) {
                axis.linear = plain.linear / deviation[k];
                axis.angular = plain.angular / deviation[k];
                let column = stack(&axis.linear, &axis.angular);
                frame.gram += column * column.transpose();
            }
        }
    }

    /// Takes from the rows of a measurement [Nm, N] what a force at a point of a link does (all in the link's frame).
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
        for (axis, &k) in frame.axes.iter().zip(&frame.rows) {
            torque[k] -= (axis.linear.dot(force) + axis.angular.dot(&moment)) * deviation[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torque::Target;

    #[test]
    fn a_sensor_feels_the_force_and_its_moment_about_the_sensor() {
        let robot = Robot::example_arm();
        let mut kinematics = Kinematics::new(&robot);
        kinematics.set_configuration(&robot, &[0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2]);
        let (link, body, origin) = (6, robot.links()[4].body, Vector3::new(0.01, -0.02, 0.03));
        let loads =
            (0..robot.links().len()).map(|link| robot.chain(robot.links()[link].body).contains(&body));
        let mount = SensorMount { body, origin, loads: loads.collect() };
        let mut frames = Frames::with_sensors(&robot, vec![3, link], &[mount]);
        let deviation: Vec<f64> = (0..13).map(|k| 0.1 + 0.05 * f64::from(k)).collect();
        frames.update(&robot, &kinematics, &deviation);
        assert_eq!((frames.links[3].rows().len(), frames.links[link].rows().len()), (4, 13));

        let (point, force) = (Vector3::new(0.02, 0.05, 0.1), Vector3::new(3.0, -8.0, 5.0));
        let mut measured = vec![0.0; 13];
        frames.subtract(link, &point, &-force, &deviation, &mut measured);
        let pose = frames.links[link].pose;
        let state = &kinematics.bodies[body];
        let sensor = kinematics.origin + state.position + state.rotation * origin;
        let force_in_world = pose.rotation * force;
        let moment = (pose.transform_point(&point) - sensor).cross(&force_in_world);
        for axis in 0..3 {
            assert!((measured[7 + axis] - force_in_world[axis]).abs() < 1e-12);
            assert!((measured[10 + axis] - moment[axis]).abs() < 1e-12);
        }
        // The Gram matrix and the products are those of all rows.
        let mut target = Target::new(&frames);
        target.set(&frames, &measured, &deviation);
        let wrench = stack(&force, &point.cross(&force));
        let squared: f64 = measured.iter().zip(&deviation).map(|(row, noise)| (row / noise).powi(2)).sum();
        assert!((wrench.dot(&(frames.links[link].gram * wrench)) - squared).abs() < 1e-9 * squared);
        assert!((wrench.dot(&target.on(link).product) - squared).abs() < 1e-9 * squared);
    }
}
