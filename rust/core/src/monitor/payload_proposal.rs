//! A payload that the model lacks, seen in the last minute's external torque.

use nalgebra::{DMatrix, SMatrix, Vector3};

use super::contact_monitor::ContactMonitor;
use super::payload_fit::{columns, fit, PayloadFit, Spread};
use super::recent_motion::{Block, BLOCK};
use crate::error::Result;
use crate::observer::Step;
use crate::robot::{LinkIndex, Robot};
use crate::torque::NoiseModel;

/// The whole record is looked at first, then its last half and so on: a payload may have been picked up within it. Less than
/// this is too short (s).
const SHORTEST: f64 = 5.0;
/// Errors that are as slow as the moves of an arm are alike for so long (s).
const ALIKE: f64 = 1.0;
/// Share of friction's variance that matters where joints start and stop now and then.
const FRICTION: f64 = 0.25;
/// The smallest error of a mean that is taken seriously (Nm; N).
const SMALLEST: f64 = 0.01;
/// Beyond so many variances (mean over the joints) a torque is none of an untouched robot.
const SEEN: f64 = 3.0;
/// A payload leaves at most so many variances, or this share of what was there without it.
const EXPLAINED: f64 = 1.0;
const LEFT: f64 = 0.1;
/// Directions of gravity in the link's frame that differ by less are one pose (rad).
const POSE: f64 = 0.25;
/// A pose counts if it was held, or passed, for so long (s), and the payload explains the larger part of it.
const HELD: f64 = 0.5;
/// With fewer poses a force that does not turn with gravity would do as well.
const FEWEST_POSES: usize = 3;
/// The payload must explain this share of all torque that is none of an untouched robot ...
const LEAST_EVIDENCE: f64 = 0.6;
/// ... which must be there for this share of the time.
const LEAST_SEEN: f64 = 0.5;
/// The last seconds must not contradict it: what was put down is no payload (s).
const LATEST: f64 = 1.5;
/// A mass of fewer standard deviations is none, and a centre that is not known to this is no place (m).
const SIGNIFICANT: f64 = 5.0;
const CENTRE_KNOWN: f64 = 0.03;

/// A payload that recent motion shows and the model lacks.
///
/// ```
/// use contactsense::monitor::PayloadProposal;
///
/// let heavy = |found: &PayloadProposal| found.mass - 3.0 * found.mass_std > 0.5;
/// # let _ = heavy;
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PayloadProposal {
    /// The link that carries it.
    pub link: String,
    /// Mass in addition to what the monitor's robot has (kg).
    pub mass: f64,
    /// One standard deviation (kg).
    pub mass_std: f64,
    /// Centre of mass in the link's frame (m).
    pub com: [f64; 3],
    /// One standard deviation of each coordinate (m).
    pub com_std: [f64; 3],
    /// Share of the time with an external torque in which the payload explains it (0 to 1).
    pub evidence: f64,
    /// Poses of the link towards gravity in which it does.
    pub poses: usize,
    /// Length of the motion that it was found in, up to now (s).
    pub seconds: f64,
}

impl ContactMonitor {
    /// The payload that the external torque of the last minute or less shows and the robot's model lacks: a force that turns
    /// with gravity, at a link at the end of a chain. None where it shows none: without an external torque, in fewer than
    /// three poses, of a contact, and on a floating base. [`ContactMonitor::set_payload`] takes it, in addition to what was
    /// set before.
    ///
    /// A constant force straight down at one point of the link is a payload, whoever exerts it. Not for the control
    /// loop: it takes some milliseconds and allocates.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use contactsense::monitor::{ContactMonitor, MonitorOptions};
    /// use contactsense::robot::Robot;
    /// use contactsense::Sample;
    /// use nalgebra::{Matrix3, Vector3};
    ///
    /// let robot = Arc::new(Robot::example_arm());
    /// let loaded =
    ///     robot.with_payload(robot.link("link_7")?, 1.2, Vector3::new(0.0, 0.02, 0.1), Matrix3::zeros())?;
    /// let mut monitor = ContactMonitor::new(robot, &MonitorOptions::new(0.01))?;
    /// for tick in 0..1000 {
    ///     let phase = 0.01 * f64::from(tick);
    ///     let angle = |j: u32| phase + f64::from(j);
    ///     let q: Vec<f64> = (0..7).map(|j| angle(j).sin()).collect();
    ///     let v: Vec<f64> = (0..7).map(|j| angle(j).cos()).collect();
    ///     let a: Vec<f64> = (0..7).map(|j| -angle(j).sin()).collect();
    ///     monitor.update(&Sample::new(&q, &v, &loaded.inverse_dynamics(&q, &v, &a)?))?;
    /// }
    /// let found = monitor.propose_payload()?.expect("a payload");
    /// assert!(found.link == "link_7" && (found.mass - 1.2).abs() < 0.05 && (found.com[2] - 0.1).abs() < 0.01);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    ///
    /// # Errors
    /// None of a monitor that was made.
    pub fn propose_payload(&self) -> Result<Option<PayloadProposal>> {
        if self.robot.floating_base() || self.robot.gravity.norm() == 0.0 {
            return Ok(None);
        }
        let calibrated = self.options.calibration.as_ref().map(|calibration| &calibration.noise);
        let default = NoiseModel::default();
        let noise = calibrated.or(self.options.isolation.noise.as_ref()).unwrap_or(&default);
        let spread = spread(&self.robot, noise)?;
        // Scales of torques do not average out.
        let relative = noise.relative.iter().sum::<f64>() / noise.relative.len().max(1) as f64;
        let blocks: Vec<Block<'_>> = self.recent.blocks().collect();
        let mut best: Option<PayloadProposal> = None;
        for link in tips(&self.robot) {
            let columns = columns(&self.robot, link, &blocks)?;
            let gravity = directions(&self.robot, link, &blocks)?;
            let mut count = blocks.len();
            while count as f64 * BLOCK >= SHORTEST {
                let from = blocks.len() - count;
                let window =
                    Window { blocks: &blocks[from..], columns: &columns[from..], gravity: &gravity[from..] };
                if let Some(found) = window.proposal(&self.robot, link, &spread, relative) {
                    if best.as_ref().is_none_or(|best| found.evidence > best.evidence) {
                        best = Some(found);
                    }
                    break;
                }
                count /= 2;
            }
        }
        Ok(best)
    }
}

impl ContactMonitor {
    /// Keeps a step to a configuration for [`ContactMonitor::propose_payload`].
    #[inline]
    pub(super) fn note_motion(&mut self, q: &[f64], step: Step) {
        let Self { recent, observer, clock, .. } = self;
        recent.advance(q, observer.velocity(), observer.unexplained(), step.length(clock.dt()));
    }
}

/// The first link of each body that moves nothing else.
fn tips(robot: &Robot) -> Vec<LinkIndex> {
    let bodies = robot.body_count();
    let is_tip = |body: &usize| (1..bodies).all(|other| robot.parent_body(other) != *body);
    let first = |body: usize| robot.links().iter().position(|link| link.body().get() == body);
    (1..bodies).filter(is_tip).filter_map(first).map(LinkIndex::new).collect()
}

fn spread(robot: &Robot, noise: &NoiseModel) -> Result<Spread> {
    let variances = noise.variances(robot)?;
    let floor = SMALLEST * SMALLEST;
    let slow = &variances.slow;
    let error = slow.model.iter().zip(&variances.friction);
    Ok(Spread {
        error: error.map(|(model, friction)| model + FRICTION * friction + floor).collect(),
        bias: slow.model.iter().zip(&slow.bias).map(|(model, bias)| model + bias + floor).collect(),
        alike: ALIKE / BLOCK,
    })
}

/// By block, the direction of gravity in the link's frame.
fn directions(robot: &Robot, link: LinkIndex, blocks: &[Block<'_>]) -> Result<Vec<Vector3<f64>>> {
    let down = robot.gravity.normalize();
    blocks.iter().map(|block| Ok(robot.link_pose(block.q, link)?.rotation.tr_mul(&down))).collect()
}

/// The latest blocks.
struct Window<'a> {
    blocks: &'a [Block<'a>],
    columns: &'a [DMatrix<f64>],
    gravity: &'a [Vector3<f64>],
}

impl Window<'_> {
    fn proposal(
        &self,
        robot: &Robot,
        link: LinkIndex,
        spread: &Spread,
        relative: f64,
    ) -> Option<PayloadProposal> {
        let without = fit(self.blocks, None, robot.mass(), spread)?;
        let seen: Vec<bool> = without.left.iter().map(|left| *left > SEEN).collect();
        if share(&seen) < LEAST_SEEN {
            return None;
        }
        let with = fit(self.blocks, Some(self.columns), robot.mass(), spread)?;
        let pairs = || with.left.iter().zip(&without.left);
        let explained: Vec<bool> =
            pairs().map(|(left, all)| *all > SEEN && *left < EXPLAINED.max(LEFT * all)).collect();
        // Before it was picked up, a payload would leave more than there was.
        let against: Vec<bool> = pairs().map(|(left, all)| *left > SEEN.max(*all)).collect();
        let told: Vec<bool> = seen.iter().zip(&against).map(|(seen, against)| *seen || *against).collect();
        let evidence = share(&explained) / share(&told);
        let latest = told.len() - told.len().min((LATEST / BLOCK) as usize);
        let poses = self.poses(&explained);
        if evidence < LEAST_EVIDENCE || share(&against[latest..]) > 0.5 || poses < FEWEST_POSES {
            return None;
        }
        let (mass, mass_std, com, com_std) = centre(&with)?;
        let known = mass > SIGNIFICANT * mass_std && com_std.iter().all(|std| *std < CENTRE_KNOWN);
        known.then(|| PayloadProposal {
            link: robot[link].name.clone(),
            mass,
            mass_std: mass_std.hypot(relative * mass),
            com: com.into(),
            com_std: com_std.map(|std| std.hypot(relative * com.norm())),
            evidence,
            poses,
            seconds: self.blocks.len() as f64 * BLOCK,
        })
    }

    /// In how many poses the payload explains the torque.
    fn poses(&self, explained: &[bool]) -> usize {
        // Direction, blocks, and how many of them are explained.
        let mut poses: Vec<(Vector3<f64>, usize, usize)> = vec![];
        let near = POSE.cos();
        for (direction, explained) in self.gravity.iter().zip(explained) {
            let explained = usize::from(*explained);
            match poses.iter_mut().find(|(of, ..)| of.dot(direction) > near) {
                Some((_, blocks, good)) => (*blocks, *good) = (*blocks + 1, *good + explained),
                None => poses.push((*direction, 1, explained)),
            }
        }
        let held = |(_, blocks, good): &&(Vector3<f64>, usize, usize)| {
            *blocks as f64 * BLOCK >= HELD && 2 * good > *blocks
        };
        poses.iter().filter(held).count()
    }
}

fn share(of: &[bool]) -> f64 {
    of.iter().filter(|it| **it).count() as f64 / of.len().max(1) as f64
}

/// Mass and centre with their standard deviations; none without mass.
fn centre(fit: &PayloadFit) -> Option<(f64, f64, Vector3<f64>, [f64; 3])> {
    let mass = fit.load[0];
    if mass <= 0.0 {
        return None;
    }
    let com = fit.load.fixed_rows::<3>(1) / mass;
    let mut slope = SMatrix::<f64, 3, 4>::zeros();
    slope.set_column(0, &(-com / mass));
    (0..3).for_each(|axis| slope[(axis, 1 + axis)] = 1.0 / mass);
    let covariance = slope * fit.covariance * slope.transpose();
    let std = std::array::from_fn(|axis| covariance[(axis, axis)].max(0.0).sqrt());
    Some((mass, fit.covariance[(0, 0)].max(0.0).sqrt(), com, std))
}
