//! What an observer leaves of white noise, step by step: a longer step averages less of it.

use crate::torque::NoiseModel;

/// Variances behind an observer of one gain, as shares of those of a sample, by an exact recursion over the steps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WhiteNoise {
    /// (1/s).
    gain: f64,
    nominal: WhiteShares,
    now: WhiteShares,
    /// Of the newest sample's noise in the output: the next step meets that noise again. Of the torque, and of the momentum (1/s).
    newest_torque: f64,
    newest_momentum: f64,
    nominal_newest: [f64; 2],
    /// Share of the momentum's noise that a sample has.
    moving: f64,
    /// Of the last step, since most are alike (s).
    length: f64,
    decay: f64,
}

/// Shares of a variance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WhiteShares {
    /// Of the torque's white noise.
    pub torque: f64,
    /// Of the momentum's (1/s^2).
    pub velocity: f64,
}

impl WhiteShares {
    /// By how much the variance of any torque can be larger than with shares of before.
    #[inline]
    pub fn growth(self, before: WhiteShares) -> f64 {
        (self.torque / before.torque).max(self.velocity / before.velocity)
    }
}

impl WhiteNoise {
    /// Behind an observer of a `gain` (1/s) that has been called every `dt` (s).
    pub fn new(gain: f64, dt: f64) -> Self {
        let decay = (-gain * dt).exp();
        let nominal = WhiteShares {
            torque: NoiseModel::torque_share(gain, dt),
            velocity: NoiseModel::velocity_share(gain, dt),
        };
        let nominal_newest = [0.5 * (1.0 - decay), (1.0 - decay) / dt];
        let [newest_torque, newest_momentum] = nominal_newest;
        WhiteNoise {
            gain,
            nominal,
            now: nominal,
            newest_torque,
            newest_momentum,
            nominal_newest,
            moving: 1.0,
            length: dt,
            decay,
        }
    }

    /// A step of `length` (s); none where the observer keeps its output. `moving` is the share of the momentum's noise
    /// that the robot's motion allows.
    #[inline]
    pub fn advance(&mut self, length: Option<f64>, moving: f64) {
        self.moving = moving;
        let Some(length) = length else {
            (self.newest_torque, self.newest_momentum) = (0.0, 0.0);
            return;
        };
        if length != self.length {
            (self.length, self.decay) = (length, (-self.gain * length).exp());
        }
        let decay = self.decay;
        // Of a mean of the torques at both ends, and of a difference of momenta.
        let torque = 0.5 * (1.0 - decay);
        let momentum = (1.0 - decay) / length;
        let WhiteShares { torque: of_torque, velocity: of_velocity } = &mut self.now;
        *of_torque = 2.0 * torque * (torque + decay * self.newest_torque) + decay * decay * *of_torque;
        *of_velocity =
            2.0 * momentum * (momentum - decay * self.newest_momentum) + decay * decay * *of_velocity;
        (self.newest_torque, self.newest_momentum) = (torque, momentum);
    }

    /// After the last step.
    #[inline]
    pub fn shares(&self) -> WhiteShares {
        WhiteShares { velocity: self.now.velocity * self.moving, ..self.now }
    }

    /// As after nominal steps.
    pub fn reset(&mut self) {
        self.now = self.nominal;
        self.moving = 1.0;
        [self.newest_torque, self.newest_momentum] = self.nominal_newest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;

    #[test]
    fn steps_of_one_length_leave_what_the_noise_model_says() {
        for (gain, dt) in [(8.0, 1e-3), (200.0, 1e-3), (50.0, 0.02), (1e9, 1e-3)] {
            // From another length to this one.
            let mut noise = WhiteNoise::new(gain, 3.0 * dt);
            (0..20_000).for_each(|_| noise.advance(Some(dt), 1.0));
            let WhiteShares { torque, velocity } = noise.shares();
            assert!((torque / NoiseModel::torque_share(gain, dt) - 1.0).abs() < 1e-9, "{gain} {dt}");
            assert!((velocity / NoiseModel::velocity_share(gain, dt) - 1.0).abs() < 1e-9, "{gain} {dt}");
        }
    }

    #[test]
    fn unequal_steps_leave_what_many_runs_show() {
        const RUNS: usize = 20_000;
        let (gain, stream) = (50.0, Stream::new(3));
        let lengths = [0.02, 1e-3, 0.5e-3, 0.012, 0.03, 2e-3, 0.5e-3, 0.018];
        let mut squares = [[0.0; 2]; 8];
        for run in 0..RUNS {
            let normals = |step: usize| stream.normals(2 * (run * 9 + step) as u64);
            let mut output = [0.0; 2];
            for (step, length) in lengths.iter().enumerate() {
                let (before, now) = (normals(step), normals(step + 1));
                let decay = f64::exp(-gain * length);
                let unexplained = [0.5 * (before[0] + now[0]), (now[1] - before[1]) / length];
                for (output, new) in output.iter_mut().zip(unexplained) {
                    *output = new + decay * (*output - new);
                }
                squares[step].iter_mut().zip(output).for_each(|(sum, x)| *sum += x * x / RUNS as f64);
            }
        }
        let mut noise = WhiteNoise::new(gain, 1e-3);
        noise.now = WhiteShares { torque: 0.0, velocity: 0.0 };
        noise.advance(None, 1.0);
        for (length, [torque, velocity]) in lengths.iter().zip(squares) {
            noise.advance(Some(*length), 1.0);
            let shares = noise.shares();
            assert!((shares.torque / torque - 1.0).abs() < 0.05, "{length} {torque}");
            assert!((shares.velocity / velocity - 1.0).abs() < 0.05, "{length} {velocity}");
        }
    }

    #[test]
    fn after_a_gap_the_noise_before_it_is_not_met_again() {
        let mut noise = WhiteNoise::new(50.0, 1e-3);
        let before = noise.shares();
        noise.advance(None, 1.0);
        assert_eq!(noise.shares(), before);
        noise.advance(Some(1e-3), 1.0);
        assert!(noise.shares().velocity > before.velocity && noise.shares().torque < before.torque);
        noise.reset();
        assert_eq!(noise.shares(), before);
    }
}
