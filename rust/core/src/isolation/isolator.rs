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
use super::sensed::check_wrenches;
use super::several::SeveralContacts;
use super::surface_contact::SurfaceContact;
use super::tips::TipSearch;
use crate::detection::{check_wrench_threshold, is_over};
use crate::error::{Error, Result};
use crate::observer::WrenchObserver;
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
    threshold: Vec<f64>,
    pub(super) noise: TorqueNoise,
    pub(super) wrench_threshold: Vec<Vector6<f64>>,
    pub(super) max_contacts: usize,
    pub(super) pushing: bool,
    pub(super) locate_within: f64,
    kinematics: Kinematics,
    pub(super) regions: Regions,
    /// By velocity variable: its torque says nothing of contacts.
    left_out: Vec<bool>,
    /// Whether the noise that grows with the torques is stated and not only assumed.
    stated: bool,
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
    evidence: ContactEvidence,
    surface: Option<SurfaceContact>,
    wrench_posterior: WrenchPosterior,
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
    /// [`Error::Input`] names the option.
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

    /// Contacts that explain the external torque `(nv,)` at the configuration `q`.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub fn isolate(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<&Isolation> {
        if !self.active.is_empty() {
            return Err(Error::input("wrenches", "missing; there are sensors"));
        }
        self.isolate_sensed(q, tau_ext, &[])
    }

    /// The same with the external wrench that each sensor sees, as [`crate::sensor::LoadCompensator`] gives it: (force,
    /// moment) at the sensor's origin, world axes (N, Nm). A sensor without a wrench is left out.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub fn isolate_sensed(
        &mut self,
        q: &[f64],
        tau_ext: &[f64],
        wrenches: &[Option<Vector6<f64>>],
    ) -> Result<&Isolation> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
        check_wrenches(&self.regions.tree, wrenches)?;
        let mut kinematics = std::mem::replace(&mut self.kinematics, Kinematics::empty());
        kinematics.set_configuration(&self.robot, q);
        // Closed forms tell several contacts apart where a base floats; elsewhere the posterior has its own noise.
        self.growing = self.stated && self.robot.floating_base();
        self.isolate_at(&kinematics, tau_ext, wrenches, None);
        self.growing = false;
        if !self.isolation.contacts.is_empty() {
            let Self { evidence, surface, wrench_posterior, regions, isolation, robot, noise, .. } = self;
            evidence.set(robot, &kinematics, &regions.tree, (tau_ext, noise.at_rest()), wrenches);
            let now = evidence.at(&kinematics);
            if let Some(surface) = surface {
                surface.judge(&now, isolation);
                isolation.name_sources(&regions.tree);
            }
            isolation.determine_wrench(&now, wrench_posterior);
        }
        self.kinematics = kinematics;
        Ok(&self.isolation)
    }

    /// The same with poses that are known already, and with the sensors' torques as an observer knows them.
    pub(crate) fn isolate_at(
        &mut self,
        kinematics: &Kinematics,
        tau_ext: &[f64],
        wrenches: &[Option<Vector6<f64>>],
        lagged: Option<&WrenchObserver>,
    ) -> &Isolation {
        self.isolation.clear();
        self.several.work.reset();
        self.divide(kinematics, tau_ext, wrenches, lagged);
        let masked = self.left_out.contains(&true);
        if masked {
            self.regions.leave_out(&self.robot, &self.left_out);
            for (residual, _) in
                self.residual.iter_mut().zip(&self.left_out).filter(|(_, left_out)| **left_out)
            {
                *residual = 0.0;
            }
        }
        self.unexplained.copy_from_slice(&self.residual);
        // Joints that feel nothing at all do not contradict the sensors: an observer is slower than they are.
        let felt = (0..tau_ext.len()).any(|k| !self.left_out[k] && is_over(tau_ext[k], self.threshold[k]));
        if felt && !self.regions.base.unknown {
            std::mem::swap(&mut self.region, &mut self.regions.base);
            self.isolate_from_torques(kinematics);
            std::mem::swap(&mut self.region, &mut self.regions.base);
        }
        for index in 0..wrenches.len() {
            let sensor = self.regions.tree.distal_first()[index];
            self.isolate_behind_sensor(kinematics, sensor, wrenches);
        }
        if !wrenches.is_empty() {
            let Self { robot, isolation, .. } = self;
            let depth = |link: LinkIndex| robot.chain(robot[link].body).len();
            isolation
                .contacts
                .sort_unstable_by_key(|contact| (std::cmp::Reverse(depth(contact.link)), contact.link));
        }
        let overflow = [self.line.take_overflow(), self.several.caster.take_overflow()];
        self.isolation.truncated |= overflow.contains(&true) || self.several.work.was_refused();
        if masked {
            self.regions.restore(&self.robot);
        }
        self.isolation.residual = self.unexplained.iter().map(|x| x * x).sum::<f64>().sqrt();
        &self.isolation
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
