//! Random moves within limits.

use std::f64::consts::TAU;

use super::limits::Limits;
use super::motion::{Move, Wave, WAVES, WAY_PEAKS, WINDOW_PEAKS};
use crate::math::random::Stream;

/// Shortest and longest time of a move (s): short enough that half a minute has many.
const DURATION: [f64; 2] = [1.0, 5.0];
/// Frequencies of sines (Hz): below what the low-passes of calibration take away.
const FREQUENCY: [f64; 2] = [0.2, 1.2];
/// Smallest and largest share of the largest speed that a slow move has.
const SLOW: [f64; 2] = [0.02, 0.15];
/// Least share of the room for sines that is used.
const LEAST_WAVES: f64 = 0.8;
/// What a joint does in a move; each joint does something of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    /// Far and fast: weights, inertias, viscous friction.
    Far,
    /// On the way, with sines: inertias.
    Waving,
    /// Near one place, with sines: rotor inertias and inertias at high acceleration.
    Shaking,
    /// Slow: bias and Coulomb friction.
    Slow,
    /// Nothing, so that others are seen alone.
    Still,
}

/// How often each purpose is drawn.
const SHARES: [(Purpose, f64); 5] = [
    (Purpose::Far, 0.5),
    (Purpose::Waving, 0.2),
    (Purpose::Shaking, 0.1),
    (Purpose::Slow, 0.1),
    (Purpose::Still, 0.1),
];

impl Purpose {
    /// The purpose of a uniform random number.
    fn of(number: f64) -> Self {
        let mut sum = 0.0;
        let found = SHARES.iter().find(|(_, share)| {
            sum += share;
            number < sum
        });
        found.map_or(Purpose::Still, |(purpose, _)| *purpose)
    }
}

/// Random numbers one after another.
struct Draw {
    stream: Stream,
    counter: u64,
}

impl Draw {
    fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        self.counter += 1;
        low + (high - low) * self.stream.uniform(self.counter)
    }
}

/// A move from a place within the ranges, no longer than `left`; it leaves no time that is too short for another one.
pub(super) fn draw(limits: &Limits, stream: Stream, from: &[f64], left: f64) -> Move {
    let mut random = Draw { stream, counter: 0 };
    let [shortest, longest] = DURATION;
    let mut duration = shortest * (random.between([0.0, 1.0]) * (longest / shortest).ln()).exp();
    if left - duration < shortest {
        duration = left;
    }
    let mut part = Move::rest(from, duration);
    for joint in 0..from.len() {
        random.joint(limits, &mut part, joint);
    }
    part
}

/// The same move, but for one joint, which does something else.
pub(super) fn redraw(limits: &Limits, stream: Stream, part: &Move, joint: usize) -> Move {
    let mut other = part.clone();
    Draw { stream, counter: 0 }.joint(limits, &mut other, joint);
    other
}

impl Draw {
    fn joint(&mut self, limits: &Limits, part: &mut Move, joint: usize) {
        let purpose = Purpose::of(self.between([0.0, 1.0]));
        let (aim, slow) = (self.between(limits.range[joint]), self.between(SLOW));
        if !limits.moves[joint] {
            return;
        }
        // Shares of the limits of velocity and acceleration: of the way, of the sines.
        let [way, waving] = match purpose {
            Purpose::Far => [1.0, 0.0],
            Purpose::Waving => [0.5, 0.5],
            Purpose::Shaking => [slow, 0.8],
            Purpose::Slow => [slow, 0.0],
            Purpose::Still => [0.0, 0.0],
        };
        let far = aim - part.from[joint];
        let most = (limits.velocity[joint] * part.duration / WAY_PEAKS[0])
            .min(limits.acceleration[joint] * part.duration.powi(2) / WAY_PEAKS[1]);
        part.travel[joint] = far.signum() * far.abs().min(way * most);
        part.waves[joint] =
            if waving > 0.0 { self.waves(limits, waving, part, joint) } else { [Wave::NONE; WAVES] };
    }

    /// Sines that keep their share of the limits, within the room that the way leaves at its ends.
    fn waves(&mut self, limits: &Limits, share: f64, part: &Move, joint: usize) -> [Wave; WAVES] {
        let [lower, upper] = limits.range[joint];
        let (from, to) = (part.from[joint], part.from[joint] + part.travel[joint]);
        let room = (from.min(to) - lower).min(upper - from.max(to)).max(0.0);
        let mut weights = [self.between([0.1, 1.0]), self.between([0.1, 1.0])];
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        let mut waves = weights.map(|amplitude| Wave {
            amplitude,
            frequency: TAU * self.between(FREQUENCY),
            phase: self.between([0.0, TAU]),
        });
        let time = part.duration;
        let (mut speed, mut acceleration) = (0.0, 0.0);
        for Wave { amplitude, frequency, .. } in waves {
            speed += amplitude * (WINDOW_PEAKS[0] / time + frequency);
            let bend = WINDOW_PEAKS[1] / (time * time) + 2.0 * WINDOW_PEAKS[0] * frequency / time;
            acceleration += amplitude * (bend + frequency * frequency);
        }
        let largest = room
            .min(share * limits.velocity[joint] / speed)
            .min(share * limits.acceleration[joint] / acceleration);
        let scale = largest * self.between([LEAST_WAVES, 1.0]);
        waves.iter_mut().for_each(|wave| wave.amplitude *= scale);
        waves
    }
}
