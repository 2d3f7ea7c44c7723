//! What an observer leaves of white noise, step by step: a longer step averages less of it.

use crate::observer::Order;
use crate::torque::ErrorVariances;

/// What a joint that starts within a step of its encoder shows at most of the torque that moves it, as a share of mass times step
/// times the square of the low-passes' gain, is 0.3 to 0.7 (starts of 1 to 5 rad/s^2, steps of 17 bits, low-passes of 100/s).
/// All joints of a robot start together, and the level of seven is at 2.8 standard deviations of each: one is this share.
const HIDDEN: f64 = 0.2;

/// Variances behind an observer of one gain, as shares of those of a sample, by an exact recursion over the steps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WhiteNoise {
    order: Order,
    /// Of each low-pass (1/s).
    pole: f64,
    nominal: [Passed; 2],
    /// What is left of the torque's noise, and of the momentum's.
    now: [Passed; 2],
    /// Share of the momentum's noise that a sample has.
    moving: f64,
    /// What is left of motion that an encoder does not show yet, as a share of the momentum's noise (1/s^2).
    hidden: f64,
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

/// White noise of unit variance behind two low-passes in series.
#[derive(Debug, Clone, Copy)]
struct Passed {
    /// Of the newest sample's noise in both outputs: the next step meets that noise again.
    newest: [f64; 2],
    /// Variance behind the first, covariance of both, and variance behind the second.
    first: f64,
    both: f64,
    second: f64,
}

impl Passed {
    /// A step in which each low-pass forgets all but `decay`; its input is a sum of the noise of the samples at its ends.
    #[inline]
    fn advance(&mut self, decay: f64, [old, new]: [f64; 2]) {
        let new_share = 1.0 - decay;
        let (met, entering) = (new_share * old, new_share * new);
        // Of what does not come from the newest sample: its variance behind the first low-pass, and its covariance with the second.
        let kept = met * met + 2.0 * met * decay * self.newest[0] + decay * decay * self.first;
        let shared = met * self.newest[1] + decay * self.both;
        let entering_twice = new_share * entering;
        self.second = entering_twice * entering_twice
            + new_share * new_share * kept
            + 2.0 * new_share * decay * shared
            + decay * decay * self.second;
        self.both = entering * entering_twice + new_share * kept + decay * shared;
        self.first = entering * entering + kept;
        self.newest = [entering, entering_twice];
    }

    /// What many equal steps lead to.
    fn steady(decay: f64, [old, new]: [f64; 2]) -> Self {
        let new_share = 1.0 - decay;
        let (met, entering) = (new_share * old, new_share * new);
        let entering_twice = new_share * entering;
        let forgotten = new_share * (1.0 + decay);
        let first = (entering * entering + met * met + 2.0 * met * decay * entering) / forgotten;
        let kept = first - entering * entering;
        let both = (entering * entering_twice + new_share * kept + decay * met * entering_twice) / forgotten;
        let shared = met * entering_twice + decay * both;
        let second = (entering_twice * entering_twice
            + new_share * new_share * kept
            + 2.0 * new_share * decay * shared)
            / forgotten;
        Passed { newest: [entering, entering_twice], first, both, second }
    }
}

/// The mean of the torques at both ends of a step of a length (s), and the difference of the momenta over it.
#[inline]
fn inputs(length: f64) -> [[f64; 2]; 2] {
    [[0.5, 0.5], [-1.0 / length, 1.0 / length]]
}

impl ErrorVariances {
    /// White noise behind an observer of a `gain` (1/s) that is called every `dt` (s).
    pub(crate) fn white_noise(&self, gain: f64, dt: f64, order: Order) -> WhiteNoise {
        let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
        let (step, noise) = (norm(&self.position_step), norm(&self.velocity));
        let step = if noise > 0.0 { step / noise } else { 0.0 };
        WhiteNoise::new(gain, dt, order).with_position_step(step)
    }
}

impl WhiteNoise {
    /// Behind an observer of a `gain` (1/s) that has been called every `dt` (s).
    pub fn new(gain: f64, dt: f64, order: Order) -> Self {
        let pole = order.pole(gain);
        let decay = (-pole * dt).exp();
        let nominal = inputs(dt).map(|input| Passed::steady(decay, input));
        WhiteNoise { order, pole, nominal, now: nominal, moving: 1.0, hidden: 0.0, length: dt, decay }
    }

    /// The same of a robot whose encoders count steps, `step` times as large as the noise of the velocities (s).
    pub fn with_position_step(self, step: f64) -> Self {
        let hidden = match self.order {
            // One low-pass passes the whole velocity of a count, as in motion.
            Order::First if step > 0.0 => self.of_order(&self.nominal[1]),
            Order::First => 0.0,
            Order::Second => (HIDDEN * step * self.pole * self.pole).powi(2),
        };
        WhiteNoise { hidden, ..self }
    }

    /// A step of `length` (s); none where the observer keeps its output. `moving` is the share of the momentum's noise
    /// that the robot's motion allows.
    #[inline]
    pub fn advance(&mut self, length: Option<f64>, moving: f64) {
        self.moving = moving;
        let Some(length) = length else {
            self.now.iter_mut().for_each(|passed| passed.newest = [0.0; 2]);
            return;
        };
        if length != self.length {
            (self.length, self.decay) = (length, (-self.pole * length).exp());
        }
        for (passed, input) in self.now.iter_mut().zip(inputs(length)) {
            passed.advance(self.decay, input);
        }
    }

    /// After the last step.
    #[inline]
    pub fn shares(&self) -> WhiteShares {
        let [torque, velocity] = [0, 1].map(|which| self.of_order(&self.now[which]));
        WhiteShares { torque, velocity: self.moving * velocity + (1.0 - self.moving) * self.hidden }
    }

    fn of_order(&self, passed: &Passed) -> f64 {
        match self.order {
            Order::First => passed.first,
            Order::Second => passed.second,
        }
    }

    /// As after nominal steps.
    pub fn reset(&mut self) {
        (self.now, self.moving) = (self.nominal, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::Stream;
    use crate::torque::NoiseModel;

    #[test]
    fn steps_of_one_length_leave_what_the_noise_model_says() {
        for (gain, dt) in [(8.0, 1e-3), (200.0, 1e-3), (50.0, 0.02), (1e9, 1e-3)] {
            // From another length to this one.
            let mut noise = WhiteNoise::new(gain, 3.0 * dt, Order::First);
            (0..20_000).for_each(|_| noise.advance(Some(dt), 1.0));
            let WhiteShares { torque, velocity } = noise.shares();
            assert!((torque / NoiseModel::torque_share(gain, dt) - 1.0).abs() < 1e-9, "{gain} {dt}");
            assert!((velocity / NoiseModel::velocity_share(gain, dt) - 1.0).abs() < 1e-9, "{gain} {dt}");
        }
    }

    #[test]
    fn unequal_steps_leave_what_many_runs_show() {
        [Order::First, Order::Second].into_iter().for_each(compare_with_runs);
    }

    fn compare_with_runs(order: Order) {
        const RUNS: usize = 20_000;
        let (gain, stream) = (50.0, Stream::new(3));
        let lengths = [0.02, 1e-3, 0.5e-3, 0.012, 0.03, 2e-3, 0.5e-3, 0.018];
        let mut squares = [[0.0; 2]; 8];
        for run in 0..RUNS {
            let normals = |step: usize| stream.normals(2 * (run * 9 + step) as u64);
            let mut output = [[0.0; 2]; 2];
            for (step, length) in lengths.iter().enumerate() {
                let (before, now) = (normals(step), normals(step + 1));
                let decay = (-order.pole(gain) * length).exp();
                let unexplained = [0.5 * (before[0] + now[0]), (now[1] - before[1]) / length];
                for ([first, second], new) in output.iter_mut().zip(unexplained) {
                    *first = new + decay * (*first - new);
                    *second = *first + decay * (*second - *first);
                }
                let last = output.map(|[first, second]| if order == Order::First { first } else { second });
                squares[step].iter_mut().zip(last).for_each(|(sum, x)| *sum += x * x / RUNS as f64);
            }
        }
        let mut noise = WhiteNoise::new(gain, 1e-3, order);
        noise.now = [Passed { newest: [0.0; 2], first: 0.0, both: 0.0, second: 0.0 }; 2];
        noise.advance(None, 1.0);
        for (length, [torque, velocity]) in lengths.iter().zip(squares) {
            noise.advance(Some(*length), 1.0);
            let shares = noise.shares();
            assert!((shares.torque / torque - 1.0).abs() < 0.05, "{order:?} {length} {torque}");
            assert!((shares.velocity / velocity - 1.0).abs() < 0.05, "{order:?} {length} {velocity}");
        }
    }

    #[test]
    fn two_low_passes_come_to_their_steady_state() {
        for (gain, dt) in [(8.0, 1e-3), (200.0, 1e-3), (50.0, 0.02)] {
            let steady = WhiteNoise::new(gain, dt, Order::Second).shares();
            let mut noise = WhiteNoise::new(gain, dt, Order::Second);
            noise.advance(Some(7.0 * dt), 1.0);
            (0..20_000).for_each(|_| noise.advance(Some(dt), 1.0));
            assert!((noise.shares().torque / steady.torque - 1.0).abs() < 1e-9, "{gain} {dt}");
            assert!((noise.shares().velocity / steady.velocity - 1.0).abs() < 1e-9, "{gain} {dt}");
        }
        // Of the momentum's noise far less is left than behind one low-pass of the same delay, and of the torque's as much.
        let [one, two] =
            [Order::First, Order::Second].map(|order| WhiteNoise::new(8.0, 1e-3, order).shares());
        assert!(two.velocity < 0.02 * one.velocity && (two.torque / one.torque - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_start_within_a_step_of_the_encoder_is_no_contact_at_any_gain() {
        // A mass of 1 kg m^2 starts with 3 rad/s^2; steps of 17 bits, and the noise of their differences.
        let (step, noise) = (std::f64::consts::TAU / 2f64.powi(17), 6e-3);
        for gain in [8.0, 50.0, 200.0] {
            let mut standing = WhiteNoise::new(gain, 1e-3, Order::Second).with_position_step(step / noise);
            standing.advance(Some(1e-3), 0.0);
            let deviation = noise * standing.shares().velocity.sqrt();
            let hidden = (2.0 * step / 3.0).sqrt();
            let shown = 3.0 * Order::Second.step_response(gain, hidden);
            assert!((0.5..5.0).contains(&(shown / deviation)), "{gain}: {shown} {deviation}");
        }
        let moving = WhiteNoise::new(50.0, 1e-3, Order::First);
        let standing = moving.with_position_step(1e-3);
        assert_eq!(standing.shares(), moving.shares());
        let mut standing = standing;
        standing.advance(Some(1e-3), 0.0);
        assert!((standing.shares().velocity / moving.shares().velocity - 1.0).abs() < 1e-9);
    }

    #[test]
    fn after_a_gap_the_noise_before_it_is_not_met_again() {
        let mut noise = WhiteNoise::new(50.0, 1e-3, Order::First);
        let before = noise.shares();
        noise.advance(None, 1.0);
        assert_eq!(noise.shares(), before);
        noise.advance(Some(1e-3), 1.0);
        assert!(noise.shares().velocity > before.velocity && noise.shares().torque < before.torque);
        noise.reset();
        assert_eq!(noise.shares(), before);
    }
}
