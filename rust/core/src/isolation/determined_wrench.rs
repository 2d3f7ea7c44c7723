//! The wrench of a contact whose point the torques do not determine, and how certain each part of it is.

use std::sync::Arc;

use nalgebra::{Cholesky, Matrix3, Matrix6, Vector6};

use super::contact_evidence::ContactEvidence;
use super::torque_now::TorqueNow;
use crate::map::Measurement;
use crate::robot::{LinkIndex, Robot};
use crate::sensor::SensorTree;
use crate::torque::TorqueNoise;

/// Standard deviation of each component of a contact's force before anything is measured (N): contacts of people and obstacles.
const FORCE: f64 = 100.0;

/// What torques and sensors say of the wrench on a link where they do not determine the point of contact.
///
/// Before anything is measured, each component of the force has a standard deviation of 100 N, and each component of the moment one of
/// 100 N times the distance of the link's farthest point from its origin. So a large variance means that a component, or a combination of
/// components, is not determined.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::isolation::{ContactIsolator, IsolatorOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let options = IsolatorOptions { torque_threshold: Some(vec![0.3]), ..IsolatorOptions::default() };
/// let mut isolator = ContactIsolator::new(robot.clone(), &options)?;
/// // Torques of the first three joints say on which link a contact is, and not where.
/// let q = [0.4; 7];
/// let isolation = isolator.isolate(&q, &[1.0, 12.0, 5.0, 0.0, 0.0, 0.0, 0.0])?;
/// let contact = &isolation.contacts[0];
/// let determined = contact.determined.as_ref().expect("its point is not determined");
/// // The wrench explains these torques, and three of its six components are not determined.
/// let torque = robot.jacobian(&q, contact.link, None)?.transpose() * determined.wrench;
/// assert!((torque[1] - 12.0).abs() < 0.3);
/// let spread = determined.covariance.symmetric_eigenvalues();
/// assert!(spread.iter().filter(|variance| variance.sqrt() > 20.0).count() >= 2);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DeterminedWrench {
    /// Force and moment on the robot at the link's origin, world axes (N, Nm).
    pub wrench: Vector6<f64>,
    /// Of its components.
    pub covariance: Matrix6<f64>,
}

/// Finds such wrenches.
#[derive(Debug, Clone)]
pub(super) struct WrenchPosterior {
    robot: Arc<Robot>,
    noise: TorqueNoise,
    now: Measurement,
    in_contact: Vec<f64>,
}

impl WrenchPosterior {
    /// Of measurements with these rows, and the noise of the torques.
    pub fn new(
        robot: &Arc<Robot>,
        tree: &SensorTree,
        evidence: &ContactEvidence,
        noise: &TorqueNoise,
    ) -> Self {
        let links: Vec<usize> = robot.touchable_links().iter().map(|link| link.get()).collect();
        let now = Measurement::new(robot, links, &evidence.mounts(robot, tree));
        WrenchPosterior {
            in_contact: vec![1.0; now.rows()],
            noise: evidence.noise(noise.clone()),
            now,
            robot: Arc::clone(robot),
        }
    }

    /// The wrench on a link alone; none where no row feels it.
    pub fn on(&mut self, link: LinkIndex, measured: &TorqueNow<'_>) -> Option<DeterminedWrench> {
        let Self { robot, noise, now, in_contact } = self;
        let surface = robot[link].surface.as_ref()?;
        noise.set_deviations_beside(measured.deviation, measured.torque, in_contact);
        now.set_on(link.get(), robot, measured.kinematics, measured.torque, in_contact);
        let frame = &now.frames().links[link.get()];
        if frame.rows().is_empty() {
            return None;
        }
        let (centre, radius) = surface.bounding_sphere();
        let (force, moment) = (FORCE.powi(-2), (FORCE * (centre.norm() + radius)).powi(-2));
        let prior = Vector6::new(force, force, force, moment, moment, moment);
        let known = Cholesky::new(frame.gram() + Matrix6::from_diagonal(&prior))?;
        let wrench = known.solve(&now.target().on(link.get()).product);
        let mut turn = Matrix6::zeros();
        for part in [0, 3] {
            turn.fixed_view_mut::<3, 3>(part, part).copy_from(&Matrix3::from(frame.pose.rotation));
        }
        Some(DeterminedWrench {
            wrench: turn * wrench,
            covariance: turn * known.inverse() * turn.transpose(),
        })
    }
}
