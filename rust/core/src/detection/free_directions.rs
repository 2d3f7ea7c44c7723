//! Torques that are no contact that counts: of contacts wanted at known points (algorithm D5), and of stops at the limits of
//! joints. What is left of a torque beside them is tested.

use nalgebra::Vector3;

use super::whitening::Whitening;
use crate::error::{Error, Result};
use crate::math::chi_square::{quantile, survival};
use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, LinkIndex, Robot, WORLD};

/// A direction that less than this share of it sets apart from the others is none of its own.
const SMALLEST_SHARE: f64 = 1e-6;

/// Columns behind a low-pass.
#[derive(Debug, Clone)]
struct Lagged {
    /// By velocity variable (1/s).
    gain: Vec<f64>,
    columns: Vec<f64>,
}

/// Which torques are free, by pose.
#[derive(Debug, Clone)]
pub(crate) struct FreeDirections {
    nv: usize,
    /// Bodies and points on them, in their frames, where contacts are wanted.
    points: Vec<(usize, Vector3<f64>)>,
    /// Three columns a point, `(nv,)` each.
    columns: Vec<f64>,
    /// The same behind the low-pass of each torque that is looked at: what a force that lasts causes there while the robot
    /// moves. The first is of the torque that is reported.
    lagged: Vec<Lagged>,
    started: bool,
    /// By velocity variable: the sign of a stop's torque where the joint is at a limit, else zero.
    inward: Vec<f64>,
    at_limit: bool,
    /// Orthonormal whitened directions.
    basis: Vec<f64>,
    rank: usize,
}

impl FreeDirections {
    /// With contacts wanted at points of links, in their frames; `gain` `(nv,)` (1/s) is of the torque that is reported,
    /// `bank` (1/s) of those that are tested beside it.
    ///
    /// # Errors
    /// [`Error::Input`] for a link that nothing moves, and a point that is none.
    pub fn new(robot: &Robot, wanted: &[(String, [f64; 3])], gain: &[f64], bank: &[f64]) -> Result<Self> {
        let nv = robot.nv();
        let place = |(link, point): &(String, [f64; 3])| {
            let index: LinkIndex = robot.link(link).map_err(of_wanted)?;
            let link = &robot[index];
            if link.body == WORLD {
                let text = format!("'{}' is fixed to the world: no joint feels contacts there", link.name);
                return Err(Error::input("wanted_contacts", text));
            }
            if !point.iter().all(|x| x.is_finite()) {
                let text = format!("the point on '{}' must be 3 finite numbers [m]", link.name);
                return Err(Error::input("wanted_contacts", text));
            }
            Ok((link.body, link.placement.transform_point(&Vector3::from(*point))))
        };
        let points: Vec<_> = wanted.iter().map(place).collect::<Result<_>>()?;
        let columns = vec![0.0; 3 * points.len() * nv];
        let behind = |gain: Vec<f64>| Lagged { gain, columns: columns.clone() };
        let bank = bank.iter().map(|gain| vec![*gain; nv]);
        Ok(FreeDirections {
            nv,
            lagged: std::iter::once(gain.to_vec()).chain(bank).map(behind).collect(),
            started: false,
            columns,
            points,
            inward: vec![0.0; nv],
            at_limit: false,
            basis: vec![0.0; nv * nv],
            rank: 0,
        })
    }

    /// Takes in a pose after a step of `length` (s), and the signs of stops' torques by velocity variable, zero where no joint
    /// is at a limit; `new` is false where the torques are those of before.
    #[inline]
    pub fn set_pose(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        inward: &[f64],
        length: f64,
        new: bool,
    ) {
        self.at_limit = inward.iter().any(|sign| *sign != 0.0);
        self.inward.copy_from_slice(inward);
        let nv = self.nv;
        for ((body, point), columns) in self.points.iter().zip(self.columns.chunks_exact_mut(3 * nv)) {
            let state = &kinematics.bodies[*body];
            let at = state.position + state.rotation * point;
            for_each_column(robot, kinematics, *body, &at, |k, column| {
                (0..3).for_each(|axis| columns[axis * nv + k] = column[axis]);
            });
        }
        if self.points.is_empty() || (!new && self.started) {
            return;
        }
        for Lagged { gain, columns } in &mut self.lagged {
            for (k, gain) in gain.iter().enumerate() {
                let decay = if self.started { (-gain * length).exp() } else { 0.0 };
                let now = self.columns[k..].iter().step_by(nv);
                columns[k..].iter_mut().step_by(nv).zip(now).for_each(|(column, now)| {
                    *column = now + decay * (*column - now);
                });
            }
        }
        self.started = true;
    }

    /// Another gain of the torque that is reported, by velocity variable (1/s), infinite for no low-pass.
    pub fn set_gain(&mut self, gain: impl Fn(usize) -> f64) {
        if let Some(reported) = self.lagged.first_mut() {
            reported.gain.iter_mut().enumerate().for_each(|(k, value)| *value = gain(k));
        }
    }

    /// Forgets all poses.
    pub fn reset(&mut self) {
        self.started = false;
    }

    /// Whether there are any at this pose.
    #[inline]
    pub fn any(&self) -> bool {
        self.at_limit || !self.points.is_empty()
    }

    /// Itself, if there are any at this pose.
    #[inline]
    pub fn if_any(&mut self) -> Option<&mut Self> {
        self.any().then_some(self)
    }

    /// Whether contacts are wanted at points.
    pub fn has_points(&self) -> bool {
        !self.points.is_empty()
    }

    /// Leaves of a torque `(nv,)`, free of bias, what is not in free directions, by least squares in the metric of a
    /// covariance; returns its `r' S^-1 r` and the number of directions taken away. A stop's torque is free only inward.
    /// `which` torque: 0 for the one that is reported, from 1 on those of the bank.
    pub fn leave(&mut self, which: usize, whitening: &mut Whitening, torque: &mut [f64]) -> (f64, usize) {
        let Self { nv, lagged, inward, basis, rank, .. } = self;
        let nv = *nv;
        whitening.squared_norm(torque);
        *rank = 0;
        for k in 0..nv {
            if inward[k] * torque[k] > 0.0 {
                add(whitening, basis, rank, nv, |j| if j == k { 1.0 } else { 0.0 });
            }
        }
        for column in lagged[which].columns.chunks_exact(nv) {
            add(whitening, basis, rank, nv, |j| column[j]);
        }
        let whitened = whitening.whitened_mut();
        for direction in basis.chunks_exact(nv).take(*rank) {
            let share = dot(direction, whitened);
            whitened.iter_mut().zip(direction).for_each(|(value, along)| *value -= share * along);
        }
        let left = dot(whitened, whitened);
        whitening.unwhiten(torque);
        // Rounding.
        for k in 0..nv {
            if inward[k] * torque[k] > 0.0 {
                torque[k] = 0.0;
            }
        }
        (left, *rank)
    }
}

/// Adds a direction to an orthonormal basis, unless that holds it already.
fn add(whitening: &Whitening, basis: &mut [f64], rank: &mut usize, nv: usize, entry: impl Fn(usize) -> f64) {
    if *rank == nv {
        return;
    }
    let (known, rest) = basis.split_at_mut(*rank * nv);
    let new = &mut rest[..nv];
    whitening.whiten(entry, new);
    let length = dot(new, new).sqrt();
    // Twice, since rounding leaves something of nearly parallel directions.
    for _ in 0..2 {
        for direction in known.chunks_exact(nv) {
            let share = dot(direction, new);
            new.iter_mut().zip(direction).for_each(|(value, along)| *value -= share * along);
        }
    }
    let left = dot(new, new).sqrt();
    if left > SMALLEST_SHARE * length && left.is_normal() {
        new.iter_mut().for_each(|value| *value /= left);
        *rank += 1;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The level of a statistic of fewer degrees, as a share of a level of `degrees` that is as rare; by the number of degrees
/// taken away.
pub(crate) fn level_shares(degrees: usize, level: f64) -> Vec<f64> {
    let probability = survival(degrees, level);
    let share = |taken: usize| (quantile(degrees - taken, probability) / level).min(1.0);
    // Of no degrees nothing is left to compare.
    (0..degrees).map(share).chain([1.0]).collect()
}

fn of_wanted(error: Error) -> Error {
    match error {
        Error::Input { problem, .. } => Error::input("wanted_contacts", problem),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whitening() -> Whitening {
        let mut whitening = Whitening::new(7);
        // A covariance that is none of independent joints.
        whitening.advance(|i, row| {
            row.iter_mut().enumerate().for_each(|(j, value)| {
                *value = 0.3_f64.powi((i - j) as i32) * (1.0 + i as f64) * (1.0 + j as f64) * 0.01;
            });
        });
        whitening
    }

    fn free(robot: &Robot, q: &[f64], wanted: &[(String, [f64; 3])], inward: [f64; 7]) -> FreeDirections {
        let mut kinematics = Kinematics::new(robot);
        kinematics.set_configuration(robot, q);
        let mut free = FreeDirections::new(robot, wanted, &[50.0; 7], &[]).expect("known links");
        free.set_pose(robot, &kinematics, &inward, 1e-3, true);
        free
    }

    #[test]
    fn of_a_wanted_force_nothing_is_left_and_of_another_something() {
        let robot = Robot::example_arm();
        let q = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0];
        let (link, local) = (robot.link("link_7").expect("a link"), [0.02, 0.01, 0.1]);
        let mut free = free(&robot, &q, &[("link_7".into(), local)], [0.0; 7]);
        let torque = |link, local: [f64; 3], force: Vector3<f64>| {
            let point = robot.link_pose(&q, link).expect("a pose").transform_point(&local.into());
            let jacobian = robot.jacobian(&q, link, Some(point.into())).expect("a pose");
            jacobian.rows(0, 3).transpose() * force
        };
        let wanted = torque(link, local, Vector3::new(30.0, -10.0, 5.0));
        let mut whitening = whitening();
        let mut left = wanted.as_slice().to_vec();
        let (statistic, rank) = free.leave(0, &mut whitening, &mut left);
        assert!(statistic < 1e-12 && rank == 3 && left.iter().all(|torque| torque.abs() < 1e-9), "{left:?}");
        let other = torque(robot.link("link_4").expect("a link"), [0.0; 3], Vector3::new(0.0, 0.0, 20.0));
        let mut both = (&wanted + &other).as_slice().to_vec();
        let mut alone = other.as_slice().to_vec();
        let (statistic, _) = free.leave(0, &mut whitening, &mut both);
        let (expected, _) = free.leave(0, &mut whitening, &mut alone);
        assert!(expected > 1.0 && (statistic / expected - 1.0).abs() < 1e-9);
        assert!(both.iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn a_stop_pushes_inward_only() {
        let robot = Robot::example_arm();
        let mut inward = [0.0; 7];
        inward[3] = -1.0;
        let mut free = free(&robot, &[0.4; 7], &[], inward);
        let mut whitening = whitening();
        let mut stop = [0.0, 0.0, 0.0, -9.0, 0.0, 0.0, 0.0];
        assert!(free.leave(0, &mut whitening, &mut stop).0 < 1e-12 && stop[3] == 0.0);
        let mut push = [0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0];
        assert!(free.leave(0, &mut whitening, &mut push).0 > 1.0 && (push[3] - 9.0).abs() < 1e-12);
    }

    #[test]
    fn fewer_degrees_have_a_lower_level() {
        let shares = level_shares(7, 40.0);
        assert_eq!(shares.len(), 8);
        assert!((shares[0] - 1.0).abs() < 1e-9);
        assert!(shares[..7].windows(2).all(|pair| pair[1] < pair[0]));
        assert!((survival(4, shares[3] * 40.0) / survival(7, 40.0) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn points_on_nothing_are_refused() {
        let robot = Robot::example_arm();
        for wanted in [("nothing".to_string(), [0.0; 3]), ("link_7".to_string(), [f64::NAN; 3])] {
            let error = FreeDirections::new(&robot, &[wanted], &[50.0; 7], &[]).unwrap_err().to_string();
            assert!(error.starts_with("wanted_contacts: "), "{error}");
        }
    }
    #[test]
    fn a_force_that_lasts_stays_free_while_the_robot_moves() {
        let robot = Robot::example_arm();
        let wanted = [("link_7".to_string(), [0.02, 0.01, 0.1])];
        let mut free = FreeDirections::new(&robot, &wanted, &[50.0; 7], &[8.0]).expect("known links");
        let mut kinematics = Kinematics::new(&robot);
        let force = Vector3::new(20.0, -10.0, 20.0);
        let mut torques = [[0.0; 7]; 2];
        for tick in 0..500 {
            let phase = 2e-3 * f64::from(tick);
            let q = [0.3 + phase, 0.8, -0.4, 0.9 - phase, 0.5, 0.7, 0.0];
            kinematics.set_configuration(&robot, &q);
            free.set_pose(&robot, &kinematics, &[0.0; 7], 1e-3, true);
            for k in 0..7 {
                let now: f64 = (0..3).map(|axis| free.columns[axis * 7 + k] * force[axis]).sum();
                for (torque, gain) in torques.iter_mut().zip([50.0, 8.0]) {
                    let decay = if tick == 0 { 0.0 } else { f64::exp(-gain * 1e-3) };
                    torque[k] = now + decay * (torque[k] - now);
                }
            }
        }
        let mut whitening = whitening();
        for (which, torque) in torques.iter_mut().enumerate() {
            assert!(torque.iter().any(|torque| torque.abs() > 5.0));
            assert!(free.leave(which, &mut whitening, torque).0 < 1e-12);
        }
        // The torque behind one gain is none of the other's.
        let mut other = torques;
        for (k, torque) in other[1].iter_mut().enumerate() {
            *torque = (0..3).map(|axis| free.columns[axis * 7 + k] * force[axis]).sum();
        }
        assert!(free.leave(1, &mut whitening, &mut other[1]).0 > 1.0);
    }
}
