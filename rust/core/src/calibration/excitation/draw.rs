//! Random moves within limits.

use std::f64::consts::TAU;

use super::limits::Limits;
use super::motion::{Move, Wave, WAVES, WAY_PEAKS, WINDOW_PEAKS};
use crate::math::random::Stream;

/// Shortest and longest time of a move (s): short enough that a minute has many.
const DURATION: [f64; 2] = [1.0, 5.0];
/// Frequencies of sines (Hz): below what the low-passes of calibration take away.
const FREQUENCY: [f64; 2] = [0.2, 1.2];
/// Smallest and largest share of the largest speed that a slow move has.
const SLOW: [f64; 2] = [0.02, 0.15];
/// Least share of the room for sines that is used.
const LEAST_WAVES: f64 = 0.8;
/// Share of joints that stand still in a fast move, so that others are seen alone.
const STILL: f64 = 0.15;

/// What moves are for; they take turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Far and fast: weights, inertias, viscous friction.
    Far,
    /// On the way, with sines: inertias.
    Waving,
    /// Near one place, with sines: rotor inertias and inertias at high acceleration.
    Shaking,
    /// Slow: bias and Coulomb friction.
    Slow,
}

/// Their turns.
pub(super) const TURNS: [Purpose; 4] = [Purpose::Far, Purpose::Waving, Purpose::Shaking, Purpose::Slow];

impl Purpose {
    /// Shares of the limits of velocity and acceleration: of the way, of the sines.
    fn shares(self) -> [f64; 2] {
        match self {
            Purpose::Far => [1.0, 0.0],
            Purpose::Waving => [0.5, 0.5],
            Purpose::Shaking => [0.2, 0.8],
            Purpose::Slow => [SLOW[1], 0.0],
        }
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

/// A move from a place within the ranges.
pub(super) fn draw(limits: &Limits, purpose: Purpose, stream: Stream, from: &[f64]) -> Move {
    let mut random = Draw { stream, counter: 0 };
    let [way, waving] = purpose.shares();
    let mut duration = random.between([0.5 * DURATION[1], DURATION[1]]);
    let travel: Vec<f64> =
        (0..from.len()).map(|joint| random.travel(limits, purpose, duration, from[joint], joint)).collect();
    if purpose == Purpose::Far || purpose == Purpose::Waving {
        duration = shortest(limits, way, &travel).max(DURATION[0]);
    }
    let still = [Wave { amplitude: 0.0, frequency: 0.0, phase: 0.0 }; WAVES];
    let mut part = Move { start: 0.0, duration, from: from.to_vec(), travel, waves: vec![still; from.len()] };
    if duration > DURATION[1] {
        part = part.lasting_less(DURATION[1]);
    }
    if waving > 0.0 {
        for joint in 0..from.len() {
            if limits.moves[joint] {
                part.waves[joint] = random.waves(limits, waving, &part, joint);
            }
        }
    }
    part
}

impl Draw {
    fn travel(&mut self, limits: &Limits, purpose: Purpose, duration: f64, from: f64, joint: usize) -> f64 {
        let (aim, still) = (self.between(limits.range[joint]), self.between([0.0, 1.0]));
        if !limits.moves[joint] {
            return 0.0;
        }
        let far = aim - from;
        match purpose {
            Purpose::Far | Purpose::Waving if still < STILL => 0.0,
            Purpose::Far | Purpose::Waving => far,
            Purpose::Shaking | Purpose::Slow => {
                let share = self.between(SLOW) * limits.velocity[joint];
                far.signum() * far.abs().min(share * duration / WAY_PEAKS[0])
            }
        }
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

/// The least time for a way at a share of the limits (s).
fn shortest(limits: &Limits, share: f64, travel: &[f64]) -> f64 {
    let times = travel.iter().enumerate().map(|(joint, travel)| {
        let speed = WAY_PEAKS[0] * travel.abs() / (share * limits.velocity[joint]);
        let acceleration = WAY_PEAKS[1] * travel.abs() / (share * limits.acceleration[joint]);
        speed.max(acceleration.sqrt())
    });
    times.fold(0.0, f64::max)
}

impl Move {
    /// The same at the same speed in less time.
    fn lasting_less(&self, duration: f64) -> Move {
        Move { duration, ..self.shrunk(duration / self.duration) }
    }
}
