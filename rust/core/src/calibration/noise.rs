//! The noise of a log: white noise of torque and velocity from sample to sample, and slow errors that the fit leaves.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::judged::Judged;
use super::log::Log;
use super::position_step::position_steps;
use crate::detection::{Standstill, LARGEST_STEP};
use crate::error::Result;
use crate::observer::{ObserverBank, Order, Step};
use crate::robot::Robot;
use crate::torque::NoiseModel;

/// Gains of the observers whose outputs are looked at (1/s): slow to fast.
const GAINS: [f64; 4] = [2.0, 8.0, 50.0, 200.0];
/// So many time constants after a start an observer has forgotten it.
const SETTLED: f64 = 4.0;
/// Share of the largest differences that count as motion or contact, not noise.
const TRIMMED: f64 = 0.05;
/// What trimming that share takes from the mean square of Gaussian numbers.
const TRIMMED_SQUARE: f64 = 0.7587;
/// Error in proportion to the contact's own torque: hysteresis and scale of gears, which no free motion shows.
pub(super) const RELATIVE: f64 = 0.05;
/// Steps of coordinate descent; each unknown has its own row in most equations.
const STEPS: usize = 100;
/// Noise of a velocity that was low-passed at 60 Hz is so many times its first differences at 1 kHz.
const MOST_VELOCITY: f64 = 2.0;
/// A joint stands where its velocity is below this share of its noise.
const STANDING: f64 = 0.1;
/// Times over which slow errors may change (s): from friction that turns round to a bias.
const TIMES: [f64; 8] = [0.005, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 10.0];
const ROUNDS: usize = 3;

/// Orders of the differences that tell noise from motion. Motion vanishes as the order grows, white noise does not: the
/// smallest result holds least of the motion.
const ORDERS: std::ops::RangeInclusive<usize> = 2..=6;

/// White noise per sample under a smooth motion, of rows at these times with a usual step (s).
pub(super) fn white(value: impl Fn(usize) -> f64, time: &[f64], step: f64) -> f64 {
    ORDERS.map(|order| differences(&value, |_| true, time, step, order)).fold(f64::INFINITY, f64::min)
}

/// The same of a velocity, and its first differences: low-passed noise is not white, and they hold nearly all of it, and all of
/// the motion. Where a joint stands, its encoder counts the same position again and again, which says nothing of the noise.
fn white_velocity(speed: impl Fn(usize) -> f64, time: &[f64], step: f64) -> [f64; 2] {
    let all = white(&speed, time, step);
    let of_order = |order| differences(&speed, |row| speed(row).abs() >= STANDING * all, time, step, order);
    let moving = ORDERS.map(of_order).fold(f64::INFINITY, f64::min);
    [moving.max(all), MOST_VELOCITY * of_order(1)]
}

/// The root mean square of differences of one order, as a share of what they make of white noise, over rows that count. Those over
/// a gap in time say nothing of it.
fn differences(
    value: &impl Fn(usize) -> f64,
    counts: impl Fn(usize) -> bool,
    time: &[f64],
    step: f64,
    order: usize,
) -> f64 {
    let count = time.len();
    if count < 10 * order {
        return 0.0;
    }
    let mut column: Vec<f64> = (0..count).map(value).collect();
    let mut growth = 1.0;
    for n in 1..=order {
        (0..column.len() - 1).for_each(|k| column[k] = column[k + 1] - column[k]);
        column.pop();
        // The sum of squared binomial coefficients, (2n)! / (n!)^2.
        growth *= 2.0 * (2 * n - 1) as f64 / n as f64;
    }
    let longest = super::LONGEST_STEPS * step;
    let whole = |k: &usize| time[k + order] - time[*k] <= longest && (*k..=k + order).all(&counts);
    let mut squares: Vec<f64> = (0..column.len()).filter(whole).map(|k| column[k] * column[k]).collect();
    if squares.is_empty() {
        return 0.0;
    }
    squares.sort_by(f64::total_cmp);
    let kept = ((1.0 - TRIMMED) * squares.len() as f64).ceil() as usize;
    let mean = squares[..kept].iter().sum::<f64>() / kept as f64;
    (mean / TRIMMED_SQUARE / growth).sqrt()
}

/// The mean squares of the observers' outputs, by gain: `(gain, [by joint])`, and mean squares of the mass matrix.
struct Spread {
    gains: Vec<f64>,
    /// By gain and joint (Nm squared).
    squares: Vec<DVector<f64>>,
    /// Mean squares of the mass matrix's entries.
    mass: DMatrix<f64>,
    /// By gain: the mean share of the velocities' noise that the motion allowed.
    moving: Vec<f64>,
}

/// The noise model that the parts of a log show; `skipped` says which rows have a contact.
pub(super) fn estimate(
    robot: &Arc<Robot>,
    log: &Log<'_>,
    parts: &[Judged],
    skipped: &[bool],
    step: f64,
) -> Result<NoiseModel> {
    let nv = robot.nv();
    let torque: Vec<f64> = (0..nv).map(|j| white(|k| log.tau_of(k)[j], log.time, step)).collect();
    let velocity: Vec<[f64; 2]> =
        (0..nv).map(|j| white_velocity(|k| log.v_of(robot, k)[j], log.time, step)).collect();
    let least: Vec<f64> = velocity.iter().map(|[least, _]| *least).collect();
    let spread = spread(robot, log, parts, skipped, step, Standstill::new(&least))?;
    let noise = split(&spread, torque, &velocity, step);
    Ok(NoiseModel { position_step: position_steps(robot, log), ..noise })
}

fn spread(
    robot: &Arc<Robot>,
    log: &Log<'_>,
    parts: &[Judged],
    skipped: &[bool],
    step: f64,
    mut standstill: Standstill,
) -> Result<Spread> {
    let nv = robot.nv();
    let mut gains: Vec<f64> = GAINS.into_iter().filter(|gain| gain * step <= LARGEST_STEP).collect();
    if gains.is_empty() {
        gains.push(LARGEST_STEP / step);
    }
    let mut squares = vec![DVector::zeros(nv); gains.len()];
    let (mut counts, mut moving) = (vec![0.0; gains.len()], vec![0.0; gains.len()]);
    let (mut mass, mut poses) = (DMatrix::zeros(nv, nv), 0.0);
    for part in parts {
        let mut bank = ObserverBank::new(nv, step, &gains, Order::First);
        let mut since = 0.0;
        part.each_row(robot, log, skipped, step, |row| {
            if row.starts {
                bank.reset();
                standstill.reset();
                since = 0.0;
            }
            bank.advance(row.unexplained, Step::Of(row.dt));
            let share = standstill.advance(row.velocity, row.dt);
            since += row.dt;
            for (which, (gain, external)) in gains.iter().zip(bank.torques()).enumerate() {
                if since > SETTLED / gain {
                    squares[which].iter_mut().zip(external).for_each(|(sum, r)| *sum += r * r);
                    moving[which] += share;
                    counts[which] += 1.0;
                }
            }
        })?;
        // The mass matrix changes slowly: a few poses say enough.
        let Some(corrected) = &part.robot else { continue };
        let stride = (part.rows.len() / 20).max(1);
        for row in part.rows.clone().step_by(stride) {
            mass += corrected.mass_matrix(log.q_of(robot, row))?.map(|m| m * m);
            poses += 1.0;
        }
    }
    for (sum, count) in squares.iter_mut().zip(&counts) {
        *sum /= f64::max(*count, 1.0);
    }
    moving.iter_mut().zip(&counts).for_each(|(moving, count)| *moving /= f64::max(*count, 1.0));
    let known: Vec<usize> = (0..gains.len()).filter(|k| counts[*k] > 0.0).collect();
    Ok(Spread {
        gains: known.iter().map(|k| gains[*k]).collect(),
        squares: known.iter().map(|k| squares[*k].clone()).collect(),
        mass: mass / f64::max(poses, 1.0),
        moving: known.iter().map(|k| moving[*k]).collect(),
    })
}

/// The white noise of the velocity (between limits), and the size and time of slow errors that give the observers' mean
/// squares; none of these comes out smaller than it was.
fn split(spread: &Spread, torque: Vec<f64>, velocity: &[[f64; 2]], step: f64) -> NoiseModel {
    let nv = torque.len();
    let mut times = vec![TIMES[TIMES.len() / 2]; nv];
    let mut parts = Parts::of(velocity);
    for _ in 0..ROUNDS {
        for (j, time) in times.iter_mut().enumerate() {
            let misfit = |time: f64| {
                let mut model = parts.model[j];
                spread.fit_model(&torque, &parts.velocity, time, step, j, &mut model)
            };
            let best = TIMES.into_iter().min_by(|a, b| misfit(*a).total_cmp(&misfit(*b)));
            *time = best.unwrap_or(*time);
        }
        spread.fit(&torque, velocity, &times, step, &mut parts);
    }
    for (j, time) in times.iter().enumerate() {
        let lacking = (0..spread.gains.len()).map(|g| {
            let share = NoiseModel::model_share(spread.gains[g], *time);
            (spread.squares[g][j] - spread.without_model(&torque, &parts.velocity, step, g, j)) / share
        });
        parts.model[j] = lacking.fold(parts.model[j], f64::max);
    }
    let roots = |squares: Vec<f64>| squares.into_iter().map(f64::sqrt).collect::<Vec<f64>>();
    NoiseModel {
        torque,
        velocity: roots(parts.velocity),
        relative: vec![RELATIVE; nv],
        model: roots(parts.model).into_iter().map(|x| x.max(SMALLEST)).collect(),
        model_time: times,
        ..NoiseModel::default()
    }
}

/// Squares of standard deviations.
struct Parts {
    velocity: Vec<f64>,
    model: Vec<f64>,
}

impl Parts {
    fn of(velocity: &[[f64; 2]]) -> Self {
        Parts {
            velocity: velocity.iter().map(|[least, _]| least * least).collect(),
            model: vec![0.0; velocity.len()],
        }
    }
}

impl Spread {
    /// What torque and velocity noise make of a joint's mean square at one of the gains.
    fn without_model(&self, torque: &[f64], velocity: &[f64], step: f64, gain: usize, j: usize) -> f64 {
        let speeds: f64 = velocity.iter().enumerate().map(|(k, square)| self.mass[(j, k)] * square).sum();
        torque[j].powi(2) * NoiseModel::torque_share(self.gains[gain], step)
            + self.velocity_share(gain, step) * speeds
    }

    /// What the motion and the observer of one of the gains leave of the variance of the momentum's noise.
    fn velocity_share(&self, gain: usize, step: f64) -> f64 {
        self.moving[gain] * NoiseModel::velocity_share(self.gains[gain], step)
    }

    /// Sets the slow errors of one joint; returns the misfit, relative to the mean squares.
    fn fit_model(
        &self,
        torque: &[f64],
        velocity: &[f64],
        time: f64,
        step: f64,
        j: usize,
        model: &mut f64,
    ) -> f64 {
        let rows = (0..self.gains.len()).map(|g| {
            let total = self.squares[g][j].max(f64::MIN_POSITIVE);
            let rest = (total - self.without_model(torque, velocity, step, g, j)) / total;
            (NoiseModel::model_share(self.gains[g], time) / total, rest)
        });
        let rows: Vec<(f64, f64)> = rows.collect();
        let norm: f64 = rows.iter().map(|(column, _)| column * column).sum();
        let slope: f64 = rows.iter().map(|(column, rest)| column * rest).sum();
        *model = (slope / norm).max(0.0);
        rows.iter().map(|(column, rest)| (rest - column * *model).powi(2)).sum()
    }

    /// Sets all slow errors and, between their limits, the velocities' noise, by coordinate descent.
    fn fit(&self, torque: &[f64], limits: &[[f64; 2]], times: &[f64], step: f64, parts: &mut Parts) {
        for _ in 0..STEPS {
            for (j, time) in times.iter().enumerate() {
                let mut model = parts.model[j];
                self.fit_model(torque, &parts.velocity, *time, step, j, &mut model);
                parts.model[j] = model;
            }
            for (k, limit) in limits.iter().enumerate() {
                let (mut norm, mut slope) = (0.0, 0.0);
                for g in 0..self.gains.len() {
                    let share = self.velocity_share(g, step);
                    for (j, time) in times.iter().enumerate() {
                        let total = self.squares[g][j].max(f64::MIN_POSITIVE);
                        let column = share * self.mass[(j, k)] / total;
                        let known = self.without_model(torque, &parts.velocity, step, g, j)
                            + NoiseModel::model_share(self.gains[g], *time) * parts.model[j];
                        norm += column * column;
                        slope += column * (total - known) / total;
                    }
                }
                if norm > 0.0 {
                    let [least, most] = limit.map(|limit| limit * limit);
                    parts.velocity[k] = (parts.velocity[k] + slope / norm).clamp(least, most.max(least));
                }
            }
        }
    }
}

/// A joint that nothing is left of has errors of rounding (Nm).
pub(super) const SMALLEST: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    #[test]
    fn white_noise_is_found_under_motion() {
        let noise = Stream::new(3);
        let signal = |k: usize| (k as f64 * 0.006).sin() * 20.0 + 0.05 * noise.normals(2 * k as u64)[0];
        let time: Vec<f64> = (0..20_000).map(|k| 1e-3 * f64::from(k)).collect();
        let found = white(signal, &time, 1e-3);
        assert!((found - 0.05).abs() < 0.001, "{found}");
        // Stretches of 40 rows, each at another place.
        let stretches: Vec<f64> = (0..20_000).map(|k| 1e-3 * f64::from(k) + f64::from(k / 40)).collect();
        let found = white(|k| signal(k) + 5.0 * noise.normals(2 * (k / 40) as u64)[1], &stretches, 1e-3);
        assert!((found - 0.05).abs() < 0.001, "{found}");
    }
}
