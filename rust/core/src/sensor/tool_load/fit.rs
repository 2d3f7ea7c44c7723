//! Least squares for mass, centre of mass and offset.
//!
//! Gravity `g`, in the sensor's axes, differs from pose to pose. What the model does not explain of a reading is
//! `offset + (m g, c x m g)`: the forces give the mass, the moments then the centre of mass.

use nalgebra::{Matrix3, SMatrix, Vector3, Vector6};

use super::ToolLoad;
use crate::sensor::ForceTorqueSensor;
use crate::spatial::vector::{split, stack};

/// How far the centre of mass of a tool lies from its sensor along each axis, one standard deviation (m): all that is
/// known of it where the mass is too small to tell more.
const TOOL_SIZE: f64 = 0.3;
/// No sensor reads finer (N, Nm).
const FINEST: f64 = 1e-6;

/// Mass, centre of mass, and offsets of force and moment among the unknowns.
const MASS: usize = 0;
const COM: usize = 1;
const OFFSETS: [usize; 2] = [4, 7];
type Covariance = SMatrix<f64, 10, 10>;

/// The mean of a sensor's readings at rest, as what the distal side exerts.
pub(super) struct StaticPose {
    /// What the model does not explain.
    reading: Vector6<f64>,
    /// Squared standard errors of force and moment, from the scatter of the readings; zeros of a single one.
    scatter: [f64; 2],
    /// In the sensor's axes (m/s^2).
    pub gravity: Vector3<f64>,
}

impl StaticPose {
    /// Of readings, of which the model explains `free`, in a convention with this sign; none of none.
    pub fn new<'a>(
        readings: impl Iterator<Item = &'a [f64; 6]> + Clone,
        free: &Vector6<f64>,
        gravity: Vector3<f64>,
        sign: f64,
    ) -> Option<Self> {
        let count = readings.clone().count() as f64;
        let mean = readings.clone().map(|reading| Vector6::from(*reading) / count).sum::<Vector6<f64>>();
        let mut scatter = [0.0; 2];
        if count > 1.0 {
            for reading in readings {
                let (force, moment) = split(&(Vector6::from(*reading) - mean));
                scatter[0] += force.norm_squared() / (3.0 * count * (count - 1.0));
                scatter[1] += moment.norm_squared() / (3.0 * count * (count - 1.0));
            }
        }
        (count > 0.0).then(|| StaticPose { reading: (mean - free) * sign, scatter, gravity })
    }
}

/// Poses about their means, in which the offsets are no more, and the mass that fits the forces.
pub(super) struct Fit<'a> {
    poses: &'a [StaticPose],
    mean_reading: Vector6<f64>,
    mean_gravity: Vector3<f64>,
    /// Not bounded (kg).
    pub mass: f64,
    pub mass_std: f64,
    /// One standard deviation of a pose's force and moment.
    noise: [f64; 2],
}

impl<'a> Fit<'a> {
    /// Of four or more poses whose directions of gravity differ about two axes.
    pub fn new(poses: &'a [StaticPose]) -> Self {
        let count = poses.len() as f64;
        let mut fit = Fit {
            poses,
            mean_reading: poses.iter().map(|pose| pose.reading).sum::<Vector6<f64>>() / count,
            mean_gravity: poses.iter().map(|pose| pose.gravity).sum::<Vector3<f64>>() / count,
            mass: 0.0,
            mass_std: 0.0,
            noise: [FINEST; 2],
        };
        let (mut seen, mut spread) = (0.0, 0.0);
        let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (force, moment, gravity) in fit.centred() {
            seen += force.dot(&gravity);
            spread += gravity.norm_squared();
            // c x g = -[g] c.
            let turn = -gravity.cross_matrix();
            matrix += turn.tr_mul(&turn);
            right += turn.tr_mul(&moment);
        }
        fit.mass = seen / spread;
        // First moments fit freely here: the noise must not depend on bounds and assumptions.
        let first_moments = matrix.cholesky().map_or_else(Vector3::zeros, |solved| solved.solve(&right));
        let (mut left, mut scatter) = ([0.0; 2], [0.0; 2]);
        for ((force, moment, gravity), pose) in fit.centred().zip(poses) {
            left[0] += (force - gravity * fit.mass).norm_squared();
            left[1] += (moment - first_moments.cross(&gravity)).norm_squared();
            (0..2).for_each(|half| scatter[half] += pose.scatter[half] / count);
        }
        // Three numbers a pose, less the offset and the mass or the first moments.
        let spare = [3.0 * count - 4.0, 3.0 * count - 6.0];
        fit.noise = [0, 1].map(|half| (left[half] / spare[half]).max(scatter[half]).sqrt().max(FINEST));
        fit.mass_std = fit.noise[0] / spread.sqrt();
        fit
    }

    /// Force, moment and gravity of each pose less their means.
    fn centred(&self) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>, Vector3<f64>)> + '_ {
        self.poses.iter().map(|pose| {
            let (force, moment) = split(&(pose.reading - self.mean_reading));
            (force, moment, pose.gravity - self.mean_gravity)
        })
    }

    /// The load with a mass that is not negative, and the centre of mass that fits it.
    pub fn load(&self) -> SensedLoad {
        let mass = self.mass.max(0.0);
        let mut matrix = Matrix3::from_diagonal_element((self.noise[1] / TOOL_SIZE).powi(2));
        let mut right = Vector3::zeros();
        for (_, moment, gravity) in self.centred() {
            let turn = gravity.cross_matrix() * -mass;
            matrix += turn.tr_mul(&turn);
            right += turn.tr_mul(&moment);
        }
        // The diagonal makes it positive definite.
        let com = matrix.cholesky().map_or_else(Vector3::zeros, |solved| solved.solve(&right));
        let weight = |gravity: &Vector3<f64>| stack(&(gravity * mass), &(com.cross(gravity) * mass));
        let offset = self.mean_reading - weight(&self.mean_gravity);
        let mut squares = Vector6::zeros();
        for pose in self.poses {
            let left = pose.reading - offset - weight(&pose.gravity);
            squares += left.component_mul(&left) / self.poses.len() as f64;
        }
        SensedLoad {
            mass,
            com,
            offset,
            covariance: self.covariance(mass, &com),
            residual: squares.map(f64::sqrt),
        }
    }

    /// The inverse of the information that forces, moments and the size of tools give.
    fn covariance(&self, mass: f64, com: &Vector3<f64>) -> Covariance {
        let mut information = Covariance::zeros();
        for axis in 0..3 {
            information[(COM + axis, COM + axis)] = TOOL_SIZE.powi(-2);
        }
        for pose in self.poses {
            let turn = pose.gravity.cross_matrix() * -mass;
            for (half, by_mass) in [pose.gravity, com.cross(&pose.gravity)].iter().enumerate() {
                let mut columns = SMatrix::<f64, 3, 10>::zeros();
                columns.set_column(MASS, by_mass);
                columns.fixed_view_mut::<3, 3>(0, OFFSETS[half]).fill_with_identity();
                if half == 1 {
                    columns.fixed_view_mut::<3, 3>(0, COM).copy_from(&turn);
                }
                information += columns.tr_mul(&columns) / self.noise[half].powi(2);
            }
        }
        // Scaled to ones on the diagonal: a micronewton beside a metre would cost all digits.
        let size = information.diagonal().map(f64::sqrt);
        let scaled = Covariance::from_fn(|i, j| information[(i, j)] / (size[i] * size[j]));
        let inverse = scaled.try_inverse().unwrap_or_else(|| Covariance::repeat(f64::INFINITY));
        Covariance::from_fn(|i, j| inverse[(i, j)] / (size[i] * size[j]))
    }
}

/// A load in the sensor's axes, as what the distal side exerts.
pub(super) struct SensedLoad {
    mass: f64,
    /// From the sensor's origin (m).
    pub com: Vector3<f64>,
    offset: Vector6<f64>,
    covariance: Covariance,
    residual: Vector6<f64>,
}

impl SensedLoad {
    /// The largest standard deviation of the centre of mass (m), or more.
    pub fn com_std(&self) -> f64 {
        (0..3).map(|axis| self.covariance[(COM + axis, COM + axis)]).sum::<f64>().sqrt()
    }

    /// In the frame of the sensor's link, and in the sensor's convention.
    pub fn at(&self, sensor: &ForceTorqueSensor) -> ToolLoad {
        let mut change = Covariance::identity();
        change.fixed_view_mut::<3, 3>(COM, COM).copy_from(&sensor.pose.rotation);
        for k in OFFSETS[0]..10 {
            change[(k, k)] = sensor.convention.sign();
        }
        let covariance = change * self.covariance * change.transpose();
        ToolLoad {
            link: sensor.link.clone(),
            mass: self.mass,
            com: sensor.pose.transform_point(&self.com).into(),
            offset: (self.offset * sensor.convention.sign()).into(),
            covariance: std::array::from_fn(|i| std::array::from_fn(|j| covariance[(i, j)])),
            residual: self.residual.into(),
        }
    }
}
