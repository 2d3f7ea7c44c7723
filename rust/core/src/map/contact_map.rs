//! A map of a robot: one torque, one posterior.

use std::sync::Arc;

use nalgebra::Vector3;

use super::estimate::MapEstimate;
use super::options::MapOptions;
use super::summary::Summary;
use super::surface_posterior::SurfacePosterior;
use crate::error::Result;
use crate::robot::{Kinematics, Robot};
use crate::surface::SurfacePoint;
use crate::torque::{PushLikelihood, TorqueNoise, LANES};

/// Says where on a robot a contact is, and how certain that is: the posterior over samples of all surface.
///
/// Every sample is a contact of unknown force: along the inward normal with a logarithm that is uniform, across it by friction.
/// Where the posterior is narrower than the samples are apart, they are divided on the true surface.
///
/// An evaluation allocates nothing, and its work is bounded.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::map::{ContactMap, MapOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let q = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0];
/// // The torque of a push of 20 N on the side of the last link.
/// let link = robot.link("link_7")?;
/// let pose = robot.link_pose(&q, link)?;
/// let point = pose.transform_point(&[0.05, 0.0, 0.1].into());
/// let force = pose.rotation * nalgebra::Vector3::new(-20.0, 0.0, 0.0);
/// let jacobian = robot.jacobian(&q, link, Some(point.into()))?;
/// let tau_ext = jacobian.rows(0, 3).transpose() * force;
///
/// let mut map = ContactMap::new(robot, &MapOptions::default())?;
/// let contact = map.evaluate(&q, tau_ext.as_slice())?.estimate.contact.expect("there is one");
/// assert_eq!(contact.link, link);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactMap {
    pub(super) robot: Arc<Robot>,
    pub(super) noise: TorqueNoise,
    pub(super) wanted: Vec<usize>,
    pub(super) kinematics: Kinematics,
    deviation: Vec<f64>,
    pub(super) posterior: SurfacePosterior,
    summary: Summary,
}

impl ContactMap {
    /// A map of a robot.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: &MapOptions) -> Result<Self> {
        let wanted = options.check(&robot)?;
        let posterior = SurfacePosterior::new(robot.clone(), options, &wanted, &[])?;
        Ok(ContactMap {
            noise: options.noise.of(&robot)?,
            kinematics: Kinematics::new(&robot),
            deviation: vec![1.0; robot.nv()],
            summary: Summary::new(robot.nv(), wanted.len(), options.friction, &posterior),
            posterior,
            wanted,
            robot,
        })
    }

    /// The posterior of one contact from a configuration `q` `(nq,)` and the external torque `tau_ext` `(nv,)` there (Nm; N for
    /// sliding joints and a base's linear part).
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument; the map is unchanged.
    pub fn evaluate(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<&MapEstimate> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
        self.kinematics.set_configuration(&self.robot, q);
        self.noise.set_deviations(tau_ext, &mut self.deviation);
        self.posterior.forget();
        self.posterior.measure(&self.kinematics, tau_ext, &self.deviation, true);
        while !self.posterior.step() {}
        self.summary.read(&self.posterior);
        Ok(self.summary.set_forces_at_points(&self.posterior))
    }

    /// What the last evaluation said.
    pub fn estimate(&self) -> &MapEstimate {
        self.summary.estimate()
    }

    /// Indices of the links that are looked on.
    pub fn links(&self) -> &[usize] {
        &self.wanted
    }

    /// How many samples there are.
    pub fn samples(&self) -> usize {
        self.posterior.samples.count
    }

    /// By sample: its point in the world frame at the last evaluation (m), and the logarithm of its share of the posterior.
    pub fn log_posterior(&self) -> impl Iterator<Item = (Vector3<f64>, f64)> + '_ {
        let logs: Vec<f64> = self.log_weights().collect();
        let greatest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shares = logs.iter().map(|log| log - greatest).filter(|log| *log > NO_SHARE);
        let total = greatest + shares.map(f64::exp).sum::<f64>().ln();
        self.places().zip(logs).map(move |((link, place), log)| {
            let pose = &self.posterior.newest().frames().links[link].pose;
            (pose.transform_point(&place.point), log - total)
        })
    }

    /// By sample: its link, and its place in the link's frame.
    fn places(&self) -> impl Iterator<Item = (usize, &SurfacePoint)> + '_ {
        let links = self.posterior.samples.links.iter();
        links.flat_map(|link| link.places.iter().map(|place| (link.link, place)))
    }

    /// By sample: the logarithm of its weight.
    fn log_weights(&self) -> impl Iterator<Item = f64> + '_ {
        let SurfacePosterior { samples, found, .. } = &self.posterior;
        samples.links.iter().flat_map(move |link| {
            let sides = |block: &PushLikelihood| {
                std::array::from_fn::<_, LANES, _>(|k| log_sum(block.log[0][k], block.log[1][k]))
            };
            let logs = found[link.first..].iter().flat_map(sides);
            link.log_priors.iter().zip(logs).map(|(prior, log)| log + prior)
        })
    }
}

/// Shares of the posterior whose logarithm is less do not change a sum of numbers with 53 bits.
const NO_SHARE: f64 = -45.0;

/// `ln(exp(a) + exp(b))`.
fn log_sum(a: f64, b: f64) -> f64 {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    if low - high > NO_SHARE {
        high + (low - high).exp().ln_1p()
    } else {
        high
    }
}
