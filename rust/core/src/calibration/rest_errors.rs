//! What detection has to expect of an untouched robot, from blocks of a log that were not fitted: how slow the errors of the
//! model are, what friction does at starts and stops, what the bias may be at the next start, and the tails of the statistic.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::judged::Judged;
use super::log::Log;
use super::noise::SMALLEST;
use crate::detection::{
    gaussian_level, ContactTest, FrictionErrors, Level, Standstill, Tail, WhiteShares, FOLLOW_TIME, GAINS,
    LARGEST_STEP, PEAK_TIME, SLOW,
};
use crate::error::Result;
use crate::observer::{ObserverBank, Order, Step};
use crate::robot::Robot;
use crate::torque::NoiseModel;

/// Time between the samples that are kept (s).
const SPACING: f64 = 0.01;
/// What comes earlier in a block belongs to the start of the observers (s).
const SETTLED: f64 = 1.0;
/// A start or stop shows in the torque for so long (s),
const EVENT_TIME: f64 = 0.15;
/// against what it was this long before (s).
const BEFORE_TIME: f64 = 0.08;
/// A joint that started and stopped less often tells nothing of its friction there.
const FEWEST_EVENTS: usize = 4;
/// Friction at a start or stop is never known better than to this share of it, since joints of a log turn round faster than they stop;
const KNOWN_SHARE: f64 = 0.2;
/// and that of gears, which motor currents contain, to this one: slow, it is another by up to half, and depends on the load.
const KNOWN_GEAR_SHARE: f64 = 0.5;
/// A torque contains that of gears where Coulomb friction of all joints is more than this share of it.
const OF_GEARS: f64 = 0.1;
/// The errors of starts and stops are not Gaussian, and joints stop together: so many root mean squares count as one
/// standard deviation.
const HEAVY_TAIL: f64 = 1.5;
/// Slow errors change over times between these (s).
const TIMES: [f64; 2] = [0.02, 20.0];
/// At least this share of the mean square of slow errors is left after following them.
const SMALLEST_SHARE: f64 = 0.02;
/// Poses of a block at which the noise of velocities is worked out.
const POSES: usize = 20;

/// Torques of one stretch without gap or contact.
#[derive(Default)]
struct Stretch {
    /// Behind the slowest gain, the same less what is followed, and behind the gain for starts and stops.
    slow: Vec<Vec<f64>>,
    followed: Vec<Vec<f64>>,
    fast: Vec<Vec<f64>>,
    velocity: Vec<Vec<f64>>,
    /// Share of the velocities' noise that the motion allowed.
    moving: Vec<f64>,
}

/// Completes a noise model, and finds the tails of the statistic for those gains that the log's step allows. `coulomb` is the
/// friction of each joint, `skipped` says which rows have a contact, `step` is the usual one (s).
pub(super) fn rest_errors(
    robot: &Arc<Robot>,
    log: &Log<'_>,
    parts: &[Judged],
    skipped: &[bool],
    step: f64,
    coulomb: &[f64],
    mut noise: NoiseModel,
) -> Result<(NoiseModel, Vec<Tail>)> {
    // Torques that are given need no observer: a low-pass follows them at any step.
    let external = parts.iter().all(|part| part.robot.is_none());
    let gains: Vec<f64> = GAINS.into_iter().filter(|gain| external || gain * step <= LARGEST_STEP).collect();
    let rms = |j: usize| {
        let squares = (0..log.len()).map(|row| log.tau_of(row)[j].powi(2)).sum::<f64>();
        (squares / log.len() as f64).sqrt()
    };
    let torques: Vec<f64> = (0..robot.nv()).map(rms).collect();
    noise.bias = noise.relative.iter().zip(&torques).map(|(relative, torque)| relative * torque).collect();
    let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
    let of_gears = norm(coulomb) > OF_GEARS * norm(&torques);
    let known = if of_gears { KNOWN_GEAR_SHARE } else { KNOWN_SHARE };
    if gains.is_empty() {
        noise.friction = coulomb.iter().map(|coulomb| known * coulomb).collect();
        return Ok((noise, vec![]));
    }
    let mut stretches = vec![];
    for part in parts {
        let standstill = Standstill::new(&robot.per_velocity("noise.velocity", &noise.velocity)?);
        stretches.extend(part.stretches(robot, log, skipped, step, &gains, standstill)?);
    }
    let shares: Vec<f64> = stretches.iter().flat_map(|stretch| stretch.moving.iter().copied()).collect();
    let moving = shares.iter().sum::<f64>() / f64::max(shares.len() as f64, 1.0);
    let mut passed = noise.variances(robot)?.white_noise(gains[0], step, Order::Second);
    passed.advance(Some(step), moving);
    let white = white_variance(robot, log, parts, &noise, passed.shares())?;
    let spacing = SPACING.max(step);
    let event_gain = gains[1.min(gains.len() - 1)];
    for (j, white) in white.into_iter().enumerate() {
        // Where no stretch is long enough, what the estimate of the noise made of the slow errors stays.
        if let Some((model, time)) = slow_errors(&stretches, j, white, gains[0]) {
            noise.model[j] = model.sqrt().max(SMALLEST);
            noise.model_time[j] = time;
        }
    }
    noise.friction = (0..robot.nv())
        .map(|j| {
            // What only one of the gains shows is no friction: noise of velocities, accelerations.
            let shown = |torque: &dyn Fn(&Stretch) -> &Vec<Vec<f64>>, gain: f64| {
                Some(events(&stretches, torque, j, spacing)? / FrictionErrors::response(gain, Order::Second))
            };
            let slow = shown(&|stretch| &stretch.slow, gains[0]);
            match slow.zip(shown(&|stretch| &stretch.fast, event_gain)) {
                Some((slow, fast)) => (HEAVY_TAIL * slow.min(fast).sqrt()).max(known * coulomb[j]),
                None => known * coulomb[j],
            }
        })
        .collect();
    let mut tails = tails(robot, log, parts, skipped, step, &gains, &noise)?;
    if of_gears {
        // Later motion shows more of their friction than a log does.
        tails.iter_mut().for_each(|tail| *tail = tail.at_least(Tail::gaussian(robot.nv(), tail.gain, step)));
    }
    Ok((noise, tails))
}

impl Judged {
    fn stretches(
        &self,
        robot: &Arc<Robot>,
        log: &Log<'_>,
        skipped: &[bool],
        step: f64,
        gains: &[f64],
        mut standstill: Standstill,
    ) -> Result<Vec<Stretch>> {
        let nv = robot.nv();
        let mut bank = ObserverBank::new(nv, step, gains, Order::Second);
        let event = 1.min(gains.len() - 1);
        let mut bias = vec![0.0; nv];
        let (mut since, mut kept) = (0.0, 0.0);
        let mut stretches: Vec<Stretch> = vec![];
        self.each_row(robot, log, skipped, step, |row| {
            let dt = row.dt;
            if row.starts {
                bank.reset();
                standstill.reset();
                bias.fill(0.0);
                (since, kept) = (0.0, 0.0);
                stretches.push(Stretch::default());
            }
            bank.advance(row.unexplained, Step::Of(dt));
            let moving = standstill.advance(row.velocity, dt);
            since += dt;
            kept += dt;
            let torque = &bank.torques()[0];
            let share = (dt / FOLLOW_TIME).min(1.0);
            bias.iter_mut().zip(torque).for_each(|(bias, torque)| *bias += share * (torque - *bias));
            if let Some(stretch) =
                stretches.last_mut().filter(|_| since > SETTLED && kept >= SPACING - 0.5 * dt)
            {
                kept = 0.0;
                stretch.slow.push(torque.clone());
                stretch.followed.push(torque.iter().zip(&bias).map(|(torque, bias)| torque - bias).collect());
                stretch.fast.push(bank.torques()[event].clone());
                stretch.velocity.push(row.velocity.to_vec());
                stretch.moving.push(moving);
            }
        })?;
        Ok(stretches)
    }
}

/// By velocity variable: what an observer leaves of the white noise of torque and velocity, at the poses of the log.
fn white_variance(
    robot: &Arc<Robot>,
    log: &Log<'_>,
    parts: &[Judged],
    noise: &NoiseModel,
    shares: WhiteShares,
) -> Result<Vec<f64>> {
    let (mut squares, mut poses) = (DMatrix::zeros(robot.nv(), robot.nv()), 0.0);
    for part in parts {
        for row in part.rows.clone().step_by((part.rows.len() / POSES).max(1)) {
            let mass = part.robot.as_ref().unwrap_or(robot).mass_matrix(log.q_of(robot, row))?;
            squares += mass.map(|m| m * m);
            poses += 1.0;
        }
    }
    let velocity = robot.per_velocity("noise.velocity", &noise.velocity)?;
    let velocity = DVector::from_iterator(robot.nv(), velocity.iter().map(|v| v * v));
    let momentum = squares * velocity * (shares.velocity / f64::max(poses, 1.0));
    Ok(noise
        .torque
        .iter()
        .zip(&momentum)
        .map(|(torque, momentum)| torque * torque * shares.torque + momentum)
        .collect())
}

/// The variance of slow errors of a joint and the time over which they change (s), from their mean square before and after a
/// low-pass is subtracted that follows them.
fn slow_errors(stretches: &[Stretch], joint: usize, white: f64, gain: f64) -> Option<(f64, f64)> {
    let mean_square = |of: &dyn Fn(&Stretch) -> &Vec<Vec<f64>>| {
        let values = stretches.iter().flat_map(|stretch| of(stretch).iter().map(|row| row[joint].powi(2)));
        let (sum, count) = values.fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
        (count > 0).then(|| sum / f64::from(count))
    };
    let before = (mean_square(&|stretch| &stretch.slow)? - white).max(0.0);
    let after = (mean_square(&|stretch| &stretch.followed)? - white).max(SMALLEST_SHARE * before);
    if after == 0.0 {
        return Some((0.0, TIMES[0]));
    }
    let time = (FOLLOW_TIME * (before / after - 1.0)).clamp(TIMES[0], TIMES[1]);
    Some((before.max(after) / Order::Second.slow_share(gain, time), time))
}

/// The mean square of what a joint's torque does at starts and stops beyond what it does in motion; none of too few.
fn events(
    stretches: &[Stretch],
    torque: &dyn Fn(&Stretch) -> &Vec<Vec<f64>>,
    joint: usize,
    spacing: f64,
) -> Option<f64> {
    let [event, before] = [EVENT_TIME, BEFORE_TIME].map(|time| (time / spacing).ceil() as usize);
    let (mut at_events, mut in_motion) = (vec![], vec![]);
    for stretch in stretches {
        let slow: Vec<bool> = stretch.velocity.iter().map(|v| v[joint].abs() < SLOW).collect();
        let mut row = before;
        while row + event <= slow.len() {
            let torque = torque(stretch);
            let start = torque[row - before][joint];
            let peak = torque[row..row + event].iter().map(|r| (r[joint] - start).abs()).fold(0.0, f64::max);
            if slow[row] != slow[row - 1] {
                at_events.push(peak * peak);
                row += 1;
            } else if slow[row - before..row + event].iter().any(|slow| *slow) {
                row += 1;
            } else {
                in_motion.push(peak * peak);
                row += event;
            }
        }
    }
    if at_events.len() < FEWEST_EVENTS {
        return None;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    Some((mean(&at_events) - mean(&in_motion)).max(0.0))
}

/// The tails of the statistic for each gain.
fn tails(
    robot: &Arc<Robot>,
    log: &Log<'_>,
    parts: &[Judged],
    skipped: &[bool],
    step: f64,
    gains: &[f64],
    noise: &NoiseModel,
) -> Result<Vec<Tail>> {
    let nv = robot.nv();
    let levels: Vec<Level> = gains
        .iter()
        .map(|gain| {
            let level = gaussian_level(nv, *gain, step, 1.0);
            Level { gain: *gain, level, gaussian: level }
        })
        .collect();
    let mut peaks: Vec<Vec<f64>> = vec![vec![]; gains.len()];
    for part in parts {
        let source = part.robot.as_ref().unwrap_or(robot);
        let variances = noise.variances(source)?;
        let mut test = ContactTest::new(Arc::clone(source), &variances, step, &levels, &[], FOLLOW_TIME);
        let mut largest = vec![0.0_f64; gains.len()];
        let (mut since, mut window) = (0.0, 0.0);
        part.each_row(robot, log, skipped, step, |row| {
            let dt = row.dt;
            if row.starts {
                test.reset();
                largest.fill(0.0);
                (since, window) = (0.0, 0.0);
            }
            test.advance(row.kinematics, row.velocity, row.known_rate, row.unexplained, Step::Of(dt));
            test.evaluate(&[], false, None);
            test.follow(dt, row.starts || test.suspicious());
            since += dt;
            if since < SETTLED {
                return;
            }
            largest.iter_mut().zip(test.statistics()).for_each(|(largest, new)| *largest = largest.max(new));
            window += dt;
            if window >= PEAK_TIME {
                peaks.iter_mut().zip(&largest).for_each(|(peaks, largest)| peaks.push(*largest));
                largest.fill(0.0);
                window = 0.0;
            }
        })?;
    }
    Ok(gains.iter().zip(&mut peaks).filter_map(|(gain, peaks)| Tail::of_peaks(*gain, peaks)).collect())
}
