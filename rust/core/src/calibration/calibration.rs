//! What contact-free motion teaches of one robot.

use nalgebra::{Matrix3, Vector3};

use super::fingerprint::fingerprint;
use super::friction::{Friction, REVERSALS};
use super::{ModelError, Tail};
use crate::error::{Error, Result};
use crate::robot::check::principal_moments;
use crate::robot::inertial_parameters::{moment_matrix, of_inertia, to_inertia, Parameters};
use crate::robot::{LinkIndex, Robot, LARGEST};
use crate::sensor::ForceTorqueSensor;
use crate::spatial::Pose;
use crate::torque::NoiseModel;

/// What contact-free motion teaches of one robot; vectors by velocity variable.
///
/// ```
/// use contactsense::calibration::Calibration;
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let mut calibration = Calibration::of_description(&robot);
/// calibration.bodies[6].mass += 0.5;
/// assert!((calibration.corrected(&robot)?.mass() - robot.mass() - 0.5).abs() < 1e-12);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Calibration {
    /// Name of the robot that it is of.
    pub robot: String,
    /// Of that robot's joints and inertias; another robot's is refused.
    pub fingerprint: String,
    /// Names of its joints.
    pub joints: Vec<String>,
    /// Constant torque that the measurement adds (Nm; N for sliding joints).
    pub torque_bias: Vec<f64>,
    /// One standard deviation.
    pub torque_bias_std: Vec<f64>,
    /// Factor from measured to true torque, its sign included.
    pub torque_scale: Vec<f64>,
    /// Whether the torques are external torques of the vendor: then only bias, scale and noise are corrected.
    pub torque_is_external: bool,
    /// Friction inside the measured torque.
    pub friction: Friction,
    /// Share of a change of the torque that gears keep back: three times this share while the torque has changed by at most
    /// two widths since it turned round, twice up to six, once up to eighteen, none beyond.
    pub hysteresis: Vec<f64>,
    /// One standard deviation.
    pub hysteresis_std: Vec<f64>,
    /// The width (Nm; N).
    pub hysteresis_width: Vec<f64>,
    /// One standard deviation of each Coulomb friction (Nm; N).
    pub coulomb_std: Vec<f64>,
    /// One standard deviation of each viscous friction (Nm s/rad; N s/m).
    pub viscous_std: Vec<f64>,
    /// Rotor inertia, reflected through the gear (kg m^2; kg), by joint.
    pub armature: Vec<f64>,
    /// One standard deviation.
    pub armature_std: Vec<f64>,
    /// Inertias of all that moves with each joint, without the payload.
    pub bodies: Vec<BodyInertia>,
    /// What the description lacks on one link, where it was asked for.
    pub payload: Option<Payload>,
    /// The share by which inertias may differ from the description, as held-out blocks of the log chose it.
    pub inertial_change: f64,
    /// How late the velocity is against the position (s).
    pub velocity_delay: f64,
    /// How late the torque is against the position (s).
    pub torque_delay: f64,
    /// What force/torque sensors read without load, by name (N, Nm).
    pub sensor_offsets: Vec<(String, [f64; 6])>,
    /// Errors of the external torque that are left.
    pub noise: NoiseModel,
    /// What is left of the low-passed torque, on blocks of the log that were not fitted (Nm; N).
    pub residual: Vec<f64>,
    /// How large the errors made the statistic of detection on those blocks, by gain of the observer; where the torques contain
    /// the friction of gears, no less than Gaussian errors make it.
    pub tails: Vec<Tail>,
    /// Errors of the model that the motion of the log leaves possible and did not show: what poses and speeds may show that it
    /// never had.
    #[cfg_attr(feature = "serde", serde(default))]
    pub model_errors: Vec<ModelError>,
    /// The rate of false alarms that thresholds are set for (1/h).
    pub false_alarms_per_hour: f64,
    /// From when to when contacts were found in the log and left out (s).
    pub contacts: Vec<[f64; 2]>,
    /// What the motion could not tell, and which motion would.
    pub notes: Vec<String>,
}

/// The inertia of all that moves with one joint, in the frame of the link that the joint moves.
///
/// ```
/// use contactsense::calibration::{BodyInertia, Calibration};
///
/// let calibration = Calibration::of_description(&contactsense::robot::Robot::example_arm());
/// let BodyInertia { link, mass, .. } = &calibration.bodies[0];
/// assert!(!link.is_empty() && *mass > 0.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BodyInertia {
    /// That link.
    pub link: String,
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass (m).
    pub com: [f64; 3],
    /// About the centre of mass: `xx, xy, yy, xz, yz, zz` (kg m^2).
    pub inertia: [f64; 6],
}

/// A payload at a link.
///
/// ```
/// use contactsense::calibration::{Calibration, Payload};
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let payload = Payload {
///     link: "link_7".into(),
///     mass: 1.0,
///     mass_std: 0.02,
///     com: [0.0, 0.0, 0.1],
///     com_std: [0.005; 3],
///     moment: 1e-3,
/// };
/// let calibration = Calibration { payload: Some(payload), ..Calibration::of_description(&robot) };
/// assert!((calibration.corrected(&robot)?.mass() - robot.mass() - 1.0).abs() < 1e-12);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Payload {
    /// The link that holds it.
    pub link: String,
    /// Mass (kg).
    pub mass: f64,
    /// One standard deviation (kg).
    pub mass_std: f64,
    /// Centre of mass in the link's frame (m).
    pub com: [f64; 3],
    /// One standard deviation of each coordinate (m).
    pub com_std: [f64; 3],
    /// Moment of inertia about the centre of mass, taken to be the same about all axes (kg m^2).
    pub moment: f64,
}

/// How to calibrate.
///
/// ```
/// use contactsense::calibration::CalibrationOptions;
///
/// let options = CalibrationOptions { false_alarms_per_hour: 0.1, ..CalibrationOptions::default() };
/// assert!(options.payload_link.is_none());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationOptions {
    /// The rate of false alarms that thresholds are set for (1/h).
    pub false_alarms_per_hour: f64,
    /// The link that holds a payload which the description lacks.
    pub payload_link: Option<LinkIndex>,
    /// Whether the log's torques are external torques of the vendor: then bias, friction left in them and noise are learnt.
    pub torque_is_external: bool,
}

impl Default for CalibrationOptions {
    fn default() -> Self {
        CalibrationOptions { false_alarms_per_hour: 1.0, payload_link: None, torque_is_external: false }
    }
}

impl CalibrationOptions {
    pub(super) fn check(&self, robot: &Robot) -> Result<()> {
        robot.check_moves()?;
        if !(self.false_alarms_per_hour > 0.0 && self.false_alarms_per_hour.is_finite()) {
            let text = format!("must be positive [1/h], not {}", self.false_alarms_per_hour);
            return Err(Error::input("false_alarms_per_hour", text));
        }
        if let Some(link) = self.payload_link {
            robot.check_link("payload_link", link)?;
        }
        match self.payload_link {
            Some(_) if self.torque_is_external => {
                let text = "needs the torques of the motors: an external torque says nothing of weights";
                Err(Error::input("payload_link", text))
            }
            Some(link) if robot[link].body == 0 => {
                let text = format!("'{}' is fixed to the world: no joint carries its load", robot[link].name);
                Err(Error::input("payload_link", text))
            }
            _ => Ok(()),
        }
    }
}

impl Calibration {
    /// The description as it is: nothing to correct.
    pub fn of_description(robot: &Robot) -> Self {
        let zeros = vec![0.0; robot.nv()];
        let reversal = vec![REVERSALS[0]; robot.nv()];
        Calibration {
            robot: robot.name().into(),
            fingerprint: fingerprint(robot),
            joints: robot.joint_names().to_vec(),
            torque_bias: zeros.clone(),
            torque_bias_std: zeros.clone(),
            torque_scale: vec![1.0; robot.nv()],
            torque_is_external: false,
            friction: Friction { coulomb: zeros.clone(), viscous: zeros.clone(), reversal },
            hysteresis: zeros.clone(),
            hysteresis_std: zeros.clone(),
            hysteresis_width: zeros.clone(),
            coulomb_std: zeros.clone(),
            viscous_std: zeros.clone(),
            armature: armature(robot),
            armature_std: vec![0.0; robot.joint_names().len()],
            bodies: robot
                .inertial_parameters()
                .iter()
                .enumerate()
                .map(|(k, x)| body_inertia(robot, k, x))
                .collect(),
            payload: None,
            inertial_change: 0.0,
            velocity_delay: 0.0,
            torque_delay: 0.0,
            sensor_offsets: vec![],
            noise: NoiseModel::default(),
            residual: zeros,
            tails: vec![],
            model_errors: vec![],
            false_alarms_per_hour: 1.0,
            contacts: vec![],
            notes: vec![],
        }
    }

    /// Whether it is of this robot and each number can be used.
    ///
    /// # Errors
    /// [`Error::Input`] says what differs.
    pub fn check(&self, robot: &Robot) -> Result<()> {
        robot.check_moves()?;
        if self.joints != robot.joint_names() {
            let text = format!("is of '{}', whose joints are {}", self.robot, self.joints.join(", "));
            return Err(Error::input("calibration", text));
        }
        if self.fingerprint != fingerprint(robot) {
            let text = format!(
                "is of another description of '{}': joints or inertias differ; calibrate this robot",
                self.robot
            );
            return Err(Error::input("calibration", text));
        }
        let positive = |values: &[f64]| values.iter().all(|x| *x >= 0.0);
        let columns = [
            ("torque_bias", &self.torque_bias, true),
            ("torque_bias_std", &self.torque_bias_std, positive(&self.torque_bias_std)),
            ("coulomb_std", &self.coulomb_std, positive(&self.coulomb_std)),
            ("viscous_std", &self.viscous_std, positive(&self.viscous_std)),
            ("residual", &self.residual, positive(&self.residual)),
            ("hysteresis", &self.hysteresis, self.hysteresis.iter().all(|x| (0.0..1.0).contains(x))),
            ("hysteresis_std", &self.hysteresis_std, positive(&self.hysteresis_std)),
            ("hysteresis_width", &self.hysteresis_width, positive(&self.hysteresis_width)),
            ("torque_scale", &self.torque_scale, !self.torque_scale.contains(&0.0)),
            ("friction.coulomb", &self.friction.coulomb, positive(&self.friction.coulomb)),
            ("friction.viscous", &self.friction.viscous, positive(&self.friction.viscous)),
        ];
        for (name, values, is_right) in columns {
            if values.len() != robot.nv() || !is_right || !values.iter().all(|x| x.abs() < LARGEST) {
                let text = format!("{name}: must be {} finite numbers, none with a wrong sign", robot.nv());
                return Err(Error::input("calibration", text));
            }
        }
        let widths = self.friction.reversal.iter().map(|reversal| reversal.width());
        if widths.len() != robot.nv() || !widths.into_iter().all(|width| width > 0.0 && width.is_finite()) {
            let text = format!("friction.reversal: must be {} positive numbers", robot.nv());
            return Err(Error::input("calibration", text));
        }
        if self.bodies.len() != robot.body_count() - 1 {
            let text = format!("bodies: must be {}, one a joint", robot.body_count() - 1);
            return Err(Error::input("calibration", text));
        }
        for (name, values) in [("armature", &self.armature), ("armature_std", &self.armature_std)] {
            let joints = robot.joint_names().len();
            if values.len() != joints || !values.iter().all(|x| (0.0..LARGEST).contains(x)) {
                let text = format!("{name}: must be {joints} finite numbers, none negative");
                return Err(Error::input("calibration", text));
            }
        }
        for body in &self.bodies {
            let numbers = body.com.iter().chain(&body.inertia).chain([&body.mass]);
            let is_body = numbers.clone().all(|x| x.abs() < LARGEST) && body.mass >= 0.0;
            if !is_body || negative_moments(&body.inertia).is_some() {
                let text = format!("bodies: mass and inertia of '{}' must be those of a body", body.link);
                return Err(Error::input("calibration", text));
            }
        }
        let offsets = self.sensor_offsets.iter().flat_map(|(_, offset)| offset);
        if !offsets.into_iter().all(|x| x.abs() < LARGEST) {
            return Err(Error::input("calibration", "sensor_offsets: must be finite"));
        }
        if self.payload.as_ref().is_some_and(|payload| !(payload.mass >= 0.0 && payload.moment >= 0.0)) {
            return Err(Error::input("calibration", "payload: mass and moment must not be negative"));
        }
        for Tail { gain, level, scale } in &self.tails {
            let is_right = [gain, level, scale].into_iter().all(|x| (0.0..LARGEST).contains(x));
            if !is_right || *gain == 0.0 {
                let text = "tails: gain must be positive, level and scale not negative, all finite";
                return Err(Error::input("calibration", text));
            }
        }
        let fits = |error: &ModelError| {
            let lengths = [error.bodies.len() + 1, error.bias.len(), error.viscous.len()];
            let numbers = error.bodies.iter().flatten().chain(&error.bias).chain(&error.viscous);
            lengths == [robot.body_count(), robot.nv(), robot.nv()]
                && numbers.into_iter().all(|x| x.abs() < LARGEST)
        };
        if !self.model_errors.iter().all(fits) {
            let text = "model_errors: each must have finite numbers, one set a joint";
            return Err(Error::input("calibration", text));
        }
        if !(self.false_alarms_per_hour > 0.0 && self.false_alarms_per_hour.is_finite()) {
            return Err(Error::input("calibration", "false_alarms_per_hour: must be positive"));
        }
        for (name, delay) in [("velocity_delay", self.velocity_delay), ("torque_delay", self.torque_delay)] {
            if !(0.0..LONGEST_DELAY).contains(&delay) {
                let text = format!("{name}: must lie between 0 and {LONGEST_DELAY} s, not {delay}");
                return Err(Error::input("calibration", text));
            }
        }
        self.noise.of(robot).map(|_| ())
    }

    /// The robot with the inertias that the motion shows, the payload included.
    ///
    /// # Errors
    /// [`Error::Input`] where the calibration is of another robot.
    pub fn corrected(&self, robot: &Robot) -> Result<Robot> {
        self.check(robot)?;
        let bodies = self.bodies.iter().enumerate().map(|(index, body)| {
            let placement = moved_link(robot, index).map_or_else(Pose::identity, |(_, placement)| placement);
            let com = placement.transform_point(&Vector3::from(body.com));
            let inertia = moment_matrix(&body.inertia);
            of_inertia(body.mass, &com, &(placement.rotation * inertia * placement.rotation.transpose()))
        });
        let corrected = robot.with_inertial_parameters(&bodies.collect::<Vec<_>>(), &self.armature);
        match &self.payload {
            Some(payload) => {
                let inertia = Matrix3::from_diagonal_element(payload.moment);
                corrected.with_payload(robot.link(&payload.link)?, payload.mass, payload.com.into(), inertia)
            }
            None => Ok(corrected),
        }
    }

    /// The sensors with the calibrated offsets; a sensor that the calibration does not know keeps its own.
    pub fn sensors_with_offsets(&self, sensors: &[ForceTorqueSensor]) -> Vec<ForceTorqueSensor> {
        let of = |sensor: &ForceTorqueSensor| {
            let known = self.sensor_offsets.iter().find(|(name, _)| *name == sensor.name);
            ForceTorqueSensor { offset: known.map_or(sensor.offset, |(_, offset)| *offset), ..sensor.clone() }
        };
        sensors.iter().map(of).collect()
    }
}

/// Rounding, and published inertias that are a little off, make moments this negative (share of the largest).
const NEGATIVE: f64 = 0.5;

/// The principal moments of an inertia (`xx, xy, yy, xz, yz, zz`) that no body has.
pub(super) fn negative_moments(inertia: &[f64; 6]) -> Option<[f64; 3]> {
    let moments = principal_moments(&moment_matrix(inertia));
    moments.ok().filter(|moments| moments[0] < -NEGATIVE * moments[2].abs())
}

/// A longer delay is another fault (s).
const LONGEST_DELAY: f64 = 1.0;

/// Rotor inertias, by joint.
pub(super) fn armature(robot: &Robot) -> Vec<f64> {
    robot.bodies[1..].iter().map(|body| body.armature).collect()
}

/// The link that the joint of a body (the world left out) moves, and its pose in the body.
fn moved_link(robot: &Robot, body: usize) -> Option<(&str, Pose)> {
    robot.links().iter().find(|link| link.body == body + 1).map(|link| (link.name.as_str(), link.placement))
}

/// The inertia of a body (the world left out) from its parameters.
pub(super) fn body_inertia(robot: &Robot, body: usize, parameters: &Parameters) -> BodyInertia {
    let (link, placement) = moved_link(robot, body).unwrap_or(("", Pose::identity()));
    let (mass, com, inertia) = to_inertia(parameters);
    let inertia = placement.rotation.transpose() * inertia * placement.rotation;
    let parameters = of_inertia(0.0, &Vector3::zeros(), &inertia);
    BodyInertia {
        link: link.into(),
        mass,
        com: placement.inverse_transform_point(&com).into(),
        inertia: std::array::from_fn(|k| parameters[4 + k]),
    }
}
