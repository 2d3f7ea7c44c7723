//! Findings in words and sizes.

use nalgebra::DVector;

use super::evidence::Evidence;
use super::finding::{FaultCode, Finding};
use super::fit::Fit;
use super::hypothesis::{Explained, Fault, OwnFault};
use super::prior::Reference;
use super::terms::{COULOMB, OWN};
use crate::calibration::rows::Term;
use crate::robot::{Robot, PARAMETERS};
use crate::spatial::Pose;

/// Torque that spoils the detection of contacts (Nm), and its share of what a joint is made for: the smaller counts.
const SPOILING_TORQUE: f64 = 0.9;
const SPOILING_SHARE: f64 = 0.045;
/// What is less than this share of it is not worth a word.
const WORTH_A_WORD: f64 = 0.5;

/// A load or a tool can be told from errors of all links' masses where it is so much likelier (nats).
const SURE: f64 = 25.0;

/// Factors nearer to 1 than this are the error of good sensors.
const SPOILING_SCALE: f64 = 0.12;
const SCALE_WORTH_A_WORD: f64 = 0.06;

/// Rotor inertia as a share of the inertia that its joint moves.
const SPOILING_ROTOR: f64 = 0.3;

/// Delays (s).
const SPOILING_DELAY: f64 = 8e-3;
const DELAY_WORTH_A_WORD: f64 = 4e-3;

/// Tilts of gravity (rad).
const SPOILING_TILT: f64 = 0.07;
const TILT_WORTH_A_WORD: f64 = 0.03;

/// What findings are written from.
struct Report<'a> {
    robot: &'a Robot,
    evidence: &'a Evidence,
    reference: &'a Reference,
    best: &'a Explained,
    share: Vec<f64>,
    total: f64,
    /// By how much it is likelier than its absence (nats).
    gain: f64,
}

/// A torque relative to one that spoils the detection of contacts.
pub(super) fn spoils(reference: &Reference, joint: usize, torque: f64) -> f64 {
    torque / SPOILING_TORQUE.min(SPOILING_SHARE * reference.effort[joint])
}

/// The findings of one fault; none where it is too small to matter.
pub(super) fn findings(
    robot: &Robot,
    evidence: &Evidence,
    reference: &Reference,
    plain: &Fit,
    best: &Explained,
) -> Vec<Finding> {
    let left: Vec<f64> = best.fit.sigma.iter().zip(&best.target.factor).map(|(s, f)| s / f).collect();
    let share = plain.sigma.iter().zip(&left).map(|(before, after)| 1.0 - (after / before).powi(2)).collect();
    let weighted = |sigma: &[f64]| -> f64 {
        sigma.iter().zip(&reference.effort).map(|(s, effort)| (s / effort).powi(2)).sum()
    };
    let total = 1.0 - weighted(&left) / weighted(&plain.sigma);
    let report = Report { robot, evidence, reference, best, share, total, gain: best.score - plain.score };
    match &best.fault {
        Fault::Sign(joints) => report.sign(joints),
        Fault::Scale(joint, factor) => report.scale(*joint, *factor),
        Fault::GravityFree => vec![Finding::new(
            FaultCode::GravityFree,
            "the torque does not contain that of gravity, which the model does: add the gravity torque to tau".into(),
        )
        .explaining(report.total)
        .major_if(true)],
        Fault::Gravity(gravity) => report.gravity(gravity),
        Fault::Permuted(order) => report.permuted(order),
        Fault::Load(body) => report.load(*body),
        Fault::Own(own, joints) => report.own(*own, joints),
        Fault::Delay(delay) => report.delay(*delay),
    }
}

impl Report<'_> {
    fn name(&self, joint: usize) -> &str {
        let names = self.robot.joint_names();
        names.get(joint).map_or("", |name| name.as_str())
    }

    fn sign(&self, joints: &[usize]) -> Vec<Finding> {
        if joints.len() == self.evidence.nv {
            let text = "the torque of all joints has the opposite sign: give -tau".to_string();
            return vec![Finding::new(FaultCode::Sign, text)
                .sized(-1.0, "")
                .explaining(self.total)
                .major_if(true)];
        }
        let one = |joint: &usize| {
            let name = self.name(*joint);
            Finding::new(FaultCode::Sign, format!("the torque of '{name}' has the opposite sign"))
                .of_joint(name)
                .sized(-1.0, "")
                .explaining(self.share[*joint])
                .major_if(true)
        };
        joints.iter().map(one).collect()
    }

    fn scale(&self, joint: Option<usize>, factor: f64) -> Vec<Finding> {
        /// Newton millimetres in a newton metre, which a factor is taken for within this share.
        const MILLIMETRES: f64 = 1000.0;
        const NEAR: f64 = 0.25;
        let size = factor.abs().ln().abs();
        if size < SCALE_WORTH_A_WORD {
            return vec![];
        }
        let finding = match joint {
            None if (factor / MILLIMETRES - 1.0).abs() < NEAR => {
                let text =
                    format!("the torque seems to be in Nmm (it is {factor:.4} times the model's): give Nm");
                Finding::new(FaultCode::Units, text)
            }
            None => Finding::new(
                FaultCode::Scale,
                format!("the torque of all joints is {factor:.3} times the model's"),
            ),
            Some(joint) => {
                let name = self.name(joint);
                Finding::new(
                    FaultCode::Scale,
                    format!("the torque of '{name}' is {factor:.3} times the model's"),
                )
                .of_joint(name)
            }
        };
        let share = joint.map_or(self.total, |joint| self.share[joint]);
        vec![finding.sized(factor, "").explaining(share).major_if(size > SPOILING_SCALE)]
    }

    fn gravity(&self, gravity: &[f64; 3]) -> Vec<Finding> {
        let (known, found) = (self.robot.gravity, nalgebra::Vector3::from(*gravity));
        let angle = if known.norm() > 0.0 { known.angle(&found) } else { std::f64::consts::PI };
        if angle < TILT_WORTH_A_WORD {
            return vec![];
        }
        let degrees = angle.to_degrees();
        let text = format!(
            "gravity acts along ({:.2}, {:.2}, {:.2}) m/s^2, {degrees:.0} degrees from the model's: give the robot this gravity, or turn its base",
            found.x, found.y, found.z
        );
        vec![Finding::new(FaultCode::GravityDirection, text)
            .sized(degrees, "deg")
            .with_vector(found.into())
            .explaining(self.total)
            .major_if(angle > SPOILING_TILT)]
    }

    fn permuted(&self, order: &[usize]) -> Vec<Finding> {
        let moved: Vec<String> = order
            .iter()
            .enumerate()
            .filter(|(joint, column)| joint != *column)
            .map(|(joint, column)| format!("that of '{}' is in column {column}", self.name(joint)))
            .collect();
        let text = format!("torques are in another order than the joints: {}", moved.join(", "));
        vec![Finding::new(FaultCode::Permuted, text).explaining(self.total).major_if(true)]
    }

    /// Root mean square of the torque that some unknowns account for, `(nv,)`.
    fn effect(&self, x: &DVector<f64>, counts: impl Fn(usize) -> bool) -> Vec<f64> {
        let one = |k: usize| {
            let sums = &self.evidence.sums[k].unknowns;
            let own = DVector::from_iterator(
                sums.nrows(),
                (0..sums.nrows()).map(|column| {
                    let place = self.evidence.global(k, column);
                    if counts(place) {
                        x[place]
                    } else {
                        0.0
                    }
                }),
            );
            (own.dot(&(sums * &own)).max(0.0) / self.evidence.rows).sqrt()
        };
        (0..self.evidence.nv).map(one).collect()
    }

    fn spoils(&self, joint: usize, torque: f64) -> f64 {
        spoils(self.reference, joint, torque)
    }

    fn load(&self, body: usize) -> Vec<Finding> {
        let at = PARAMETERS * (body - 1);
        let x = &self.best.fit.x;
        let effect = self.effect(x, |place| (at..at + PARAMETERS).contains(&place));
        let worst = (0..self.evidence.nv).map(|k| self.spoils(k, effect[k])).fold(0.0, f64::max);
        if worst < WORTH_A_WORD {
            return vec![];
        }
        let mass = x[at];
        let moment = nalgebra::Vector3::new(x[at + 1], x[at + 2], x[at + 3]);
        let (link, placement) = self.first_link(body);
        /// A centre of mass farther from the last joint than this share of the robot's reach is no load's.
        const FAR: f64 = 0.6;
        let plausible = mass > 0.0 && moment.norm() < FAR * self.reference.reach * mass;
        let mut finding = if plausible {
            let centre = placement.inverse_transform_point(&(moment / mass));
            let text = format!(
                "the robot carries {mass:.2} kg more at '{link}' than the model, centre of mass ({:.3}, {:.3}, {:.3}) m in its frame: use Robot.with_payload",
                centre.x, centre.y, centre.z
            );
            Finding::new(FaultCode::Payload, text).with_vector(centre.into())
        } else {
            let text = format!(
                "the model has another tool at '{link}' than the robot: the robot's mass is {mass:+.2} kg and its first moment of mass {:+.3}, {:+.3}, {:+.3} kg m different there",
                moment.x, moment.y, moment.z
            );
            Finding::new(FaultCode::Tool, text)
        };
        finding.link = Some(link.into());
        vec![finding.sized(mass, "kg").explaining(self.total).major_if(worst > 1.0 && self.gain > SURE)]
    }

    /// The name and placement of the link that a body's joint moves; others are fixed to it.
    fn first_link(&self, body: usize) -> (&str, Pose) {
        let mut of_body = self.robot.links().iter().filter(|link| link.body().get() == body);
        of_body.next().map_or(("", Pose::identity()), |link| (link.name.as_str(), *link.placement()))
    }

    fn own(&self, own: OwnFault, joints: &[usize]) -> Vec<Finding> {
        let x = &self.best.fit.x;
        let size = |joint: usize, term: Term| x[self.evidence.own(joint, term)];
        let effects: Vec<(usize, f64)> = joints
            .iter()
            .map(|&joint| {
                let from = self.evidence.own(joint, OWN[0]);
                let mine =
                    |place: usize| own.terms().iter().any(|term| place == self.evidence.own(joint, *term));
                let effect = self.effect(x, |place| place >= from && mine(place))[joint];
                let ratio = match own {
                    OwnFault::Armature => {
                        let rotor = size(joint, Term::Armature).abs() / self.reference.inertia[joint];
                        // A rotor that cannot be felt is not known either.
                        if effect > 2.0 * self.best.fit.sigma[joint] || self.spoils(joint, effect) > 1.0 {
                            rotor / SPOILING_ROTOR
                        } else {
                            0.0
                        }
                    }
                    _ => self.spoils(joint, effect),
                };
                (joint, ratio)
            })
            .filter(|(_, ratio)| *ratio > WORTH_A_WORD)
            .collect();
        let worst =
            effects.iter().fold((0, 0.0_f64), |worst, one| if one.1 > worst.1 { *one } else { worst });
        if effects.is_empty() {
            return vec![];
        }
        let (code, what, unit) = match own {
            OwnFault::Armature => (FaultCode::Armature, "rotor inertia that the model lacks", "kg m^2"),
            OwnFault::Friction => (FaultCode::Friction, "friction inside the torque", "Nm"),
            OwnFault::Bias => (FaultCode::Bias, "constant torque", "Nm"),
        };
        let of_joint = |joint: usize| match own {
            OwnFault::Armature => format!("{:.3}", size(joint, Term::Armature)),
            OwnFault::Friction => {
                let viscous = size(joint, Term::Viscous);
                let sign = if viscous < 0.0 { '-' } else { '+' };
                format!("{:.2} {sign} {:.2} per rad/s", size(joint, COULOMB), viscous.abs())
            }
            OwnFault::Bias => format!("{:+.2}", size(joint, Term::Bias)),
        };
        let list: Vec<String> = effects
            .iter()
            .map(|(joint, _)| format!("'{}' {}", self.name(*joint), of_joint(*joint)))
            .collect();
        let value = match own {
            OwnFault::Friction => {
                let (coulomb, viscous) = (size(worst.0, COULOMB), size(worst.0, Term::Viscous));
                if coulomb.abs() > viscous.abs() {
                    coulomb
                } else {
                    viscous
                }
            }
            _ => size(worst.0, own.terms()[0]),
        };
        let mut finding = Finding::new(code, format!("{what} [{unit}]: {}", list.join(", ")))
            .sized(value, unit)
            .major_if(worst.1 > 1.0);
        if let [(joint, _)] = effects[..] {
            finding = finding.of_joint(self.name(joint)).explaining(self.share[joint]);
        } else {
            finding = finding.explaining(self.total);
        }
        vec![finding]
    }

    fn delay(&self, delay: f64) -> Vec<Finding> {
        if delay.abs() < DELAY_WORTH_A_WORD {
            return vec![];
        }
        let late = if delay > 0.0 { "the torque is" } else { "position and velocity are" };
        let other = if delay > 0.0 { "position and velocity" } else { "the torque" };
        let text = format!("{late} {:.0} ms later than {other}", 1e3 * delay.abs());
        vec![Finding::new(FaultCode::Delay, text)
            .sized(delay, "s")
            .explaining(self.total)
            .major_if(delay.abs() > SPOILING_DELAY)]
    }
}
