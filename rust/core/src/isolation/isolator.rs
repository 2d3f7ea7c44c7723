//! From an external torque to a contact: link, point and force (Vorndamme 2017, eqs. 22-26 and 29-30).

use std::sync::Arc;

use nalgebra::Vector6;

use super::body_set::BodySet;
use super::contact_evidence::{ContactEvidence, WithoutWanted};
use super::determined_wrench::WrenchPosterior;
use super::line::LineCast;
use super::options::IsolatorOptions;
use super::region::{Region, Regions};
use super::result::{Candidate, Isolation, CANDIDATES};
use super::rows::TorqueRows;
use super::several::SeveralContacts;
use super::surface_contact::SurfaceContact;
use super::tips::TipSearch;
use crate::detection::check_wrench_threshold;
use crate::error::Result;
use crate::robot::{Kinematics, LinkIndex, Robot};
use crate::sensor::SensorTree;
use crate::torque::TorqueNoise;

/// A located contact explains the torques but for this (root mean square, in thresholds): more is no noise, but a
/// moment, a second contact or a wrong model.
pub(super) const CONTRADICTION: f64 = 1.0;
/// A force is determined if it exceeds so many standard deviations of it. The direction of a weaker one is that of the
/// errors of the torques.
pub(super) const SIGNIFICANCE: f64 = 3.0;
/// A torque or wrench that is a difference of measured ones is none if it is less than this share of them: five
/// standard deviations of sensors that err by a hundredth.
pub(super) const LEFT_OVER: f64 = 0.05;

/// Finds the contact that explains an external torque.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::isolation::{ContactIsolator, IsolatorOptions};
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
/// let mut isolator = ContactIsolator::new(robot, &IsolatorOptions::default())?;
/// let isolation = isolator.isolate(&q, tau_ext.as_slice())?;
/// assert_eq!(isolation.contacts.len(), 1);
/// assert_eq!(isolation.contacts[0].link, link);
/// assert!((isolation.contacts[0].force().unwrap() - force).norm() < 1e-6);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactIsolator {
    pub(super) robot: Arc<Robot>,
    pub(super) threshold: Vec<f64>,
    pub(super) noise: TorqueNoise,
    pub(super) wrench_threshold: Vec<Vector6<f64>>,
    pub(super) max_contacts: usize,
    pub(super) pushing: bool,
    pub(super) locate_within: f64,
    pub(super) kinematics: Kinematics,
    pub(super) regions: Regions,
    /// By velocity variable: its torque says nothing of contacts.
    pub(super) left_out: Vec<bool>,
    /// Whether the noise that grows with the torques is stated and not only assumed.
    pub(super) stated: bool,
    /// Whether it widens the limits in this call.
    pub(super) growing: bool,
    /// The one being worked on; it changes places with its entry in `regions`.
    pub(super) region: Region,
    /// Which sensors have a reading.
    pub(super) active: Vec<bool>,
    pub(super) sensed: Vec<f64>,
    /// What each joint feels of contacts in its region, and the size of what sensors have explained of it.
    pub(super) residual: Vec<f64>,
    pub(super) measured: Vec<f64>,
    /// Three standard deviations of the torques at rest, with the thresholds of the sensors that were subtracted.
    pub(super) limit: Vec<f64>,
    pub(super) tips: TipSearch,
    pub(super) bodies: BodySet,
    pub(super) line: LineCast,
    pub(super) rows: TorqueRows,
    pub(super) several: SeveralContacts,
    /// What is measured, as rows.
    pub(super) evidence: ContactEvidence,
    pub(super) surface: Option<SurfaceContact>,
    pub(super) wrench_posterior: WrenchPosterior,
    pub(super) near: Vec<LinkIndex>,
    /// By body: cannot carry the contact that is being judged.
    pub(super) excluded: Vec<bool>,
    pub(super) displaced: Vec<Candidate>,
    pub(super) unexplained: Vec<f64>,
    pub(super) isolation: Isolation,
}

impl ContactIsolator {
    /// The thresholds on torques `(nv,)` (Nm, N).
    pub fn torque_threshold(&self) -> &[f64] {
        &self.threshold
    }

    /// The thresholds on each sensor's wrench (N, Nm).
    pub fn wrench_threshold(&self) -> &[Vector6<f64>] {
        &self.wrench_threshold
    }

    /// An isolator for a robot.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) names the option.
    pub fn new(robot: Arc<Robot>, options: &IsolatorOptions) -> Result<Self> {
        let (threshold, noise) = options.threshold_and_noise(&robot)?;
        options.check()?;
        let tree = SensorTree::new(&robot, &options.sensors)?;
        let wrench_threshold = check_wrench_threshold(&tree, &options.wrench_threshold)?;
        let wanted = tree.wanted(&options.wanted_contacts)?;
        let evidence = ContactEvidence::new(&robot, &tree, &wanted, &wrench_threshold);
        let surface = options.surface(&robot, (&tree, &evidence), &noise)?;
        let wrench_posterior = WrenchPosterior::new(&robot, &tree, &evidence, &noise);
        let (nv, links) = (robot.nv(), robot.links().len());
        // More than a contact a link cannot be told apart.
        let max_contacts = options.max_contacts.min(links.max(1));
        Ok(Self {
            wrench_threshold,
            max_contacts,
            pushing: options.pushing,
            locate_within: options.locate_within,
            kinematics: Kinematics::new(&robot),
            active: vec![true; tree.len()],
            regions: Regions::new(&robot, tree, wanted),
            region: Region::whole(&robot),
            left_out: vec![false; nv],
            stated: options.noise.is_some(),
            growing: false,
            sensed: vec![0.0; nv],
            residual: vec![0.0; nv],
            measured: vec![0.0; nv],
            limit: noise.threshold(),
            threshold,
            tips: TipSearch::new(&robot),
            bodies: BodySet::new(&robot),
            line: LineCast::new(),
            rows: TorqueRows::new(&robot),
            several: SeveralContacts::new(&robot, max_contacts),
            evidence,
            surface,
            wrench_posterior,
            near: Vec::with_capacity(links),
            excluded: vec![false; robot.body_count()],
            displaced: Vec::with_capacity(CANDIDATES),
            unexplained: vec![0.0; nv],
            isolation: Isolation::with_room(max_contacts, links),
            noise,
            robot,
        })
    }

    /// In the next call, the torque of a joint at a limit is left out that pushes it inward; `inward` `(nv,)` has the signs of
    /// such torques, zero for other joints.
    pub(crate) fn leave_out(&mut self, inward: &[f64], tau_ext: &[f64]) {
        for ((left_out, sign), torque) in self.left_out.iter_mut().zip(inward).zip(tau_ext) {
            *left_out = sign * torque > 0.0;
        }
    }

    /// Takes in the torque of a monitor without wanted contacts `(nv,)`, with its standard deviations, and what its sensors say.
    pub(crate) fn take_in(
        &mut self,
        kinematics: &Kinematics,
        torque: (&[f64], &[f64]),
        sensed: Option<WithoutWanted<'_>>,
    ) {
        let Self { evidence, robot, regions, left_out, .. } = self;
        let sensed = sensed.unwrap_or(WithoutWanted { unwanted: &[], all: &[], blind: &[] });
        evidence.set_without_wanted(robot, kinematics, &regions.tree, torque, &sensed);
        evidence.leave_out(left_out);
    }

    /// What is measured, as rows.
    pub(crate) fn evidence(&self) -> &ContactEvidence {
        &self.evidence
    }

    /// Says what is known of the wrench of a single contact that is not located, from what was taken in.
    pub(crate) fn determine_wrench(&mut self, kinematics: &Kinematics, isolation: &mut Isolation) {
        isolation.determine_wrench(&self.evidence.at(kinematics), &mut self.wrench_posterior);
    }

    /// By velocity variable: left out of the next call.
    pub(crate) fn left_out(&self) -> &[bool] {
        &self.left_out
    }

    /// The answer of the last call.
    pub fn isolation(&self) -> &Isolation {
        &self.isolation
    }

    /// Hands the answer of the last call over, and takes memory for the next.
    pub(crate) fn exchange(&mut self, isolation: &mut Isolation) {
        std::mem::swap(&mut self.isolation, isolation);
    }

    /// An empty answer with room for any.
    pub(crate) fn empty_answer(&self) -> Isolation {
        Isolation::with_room(self.max_contacts, self.robot.links().len())
    }

    /// Names of the sensors, in their order.
    pub fn sensor_names(&self) -> &[String] {
        self.regions.tree.names()
    }
}
