//! The external torque that errors of the model cause while nothing touches the robot.

use super::options::check_time_constant;
use crate::error::Result;

/// The first time constant is divided into so many blocks; the first bias is the median of their means. A median over
/// time alone would need all samples.
const BLOCKS: usize = 32;
/// A median of fewer means is not safe from a single wrong one.
const FEWEST_BLOCKS: usize = 3;

/// Follows the external torque by a low-pass, except during contact.
#[derive(Debug, Clone)]
pub(super) struct BiasTracker {
    time_constant: f64,
    /// Greatest bias of each joint (Nm, N).
    limit: Vec<f64>,
    bias: Vec<f64>,
    free_time: f64,
    /// Means of the finished blocks: [`BLOCKS`] for each joint in turn.
    means: Vec<f64>,
    finished: usize,
    /// Integral over the block that is not finished (Nm s).
    integral: Vec<f64>,
    block_time: f64,
}

impl BiasTracker {
    /// A tracker with a time constant (s) and the greatest bias of each joint (Nm, N).
    ///
    /// # Errors
    /// [`Error::Input`] where the time constant is not positive and finite.
    pub fn new(time_constant: f64, limit: Vec<f64>) -> Result<Self> {
        check_time_constant(time_constant)?;
        let nv = limit.len();
        Ok(Self {
            time_constant,
            limit,
            bias: vec![0.0; nv],
            free_time: 0.0,
            means: vec![0.0; nv * BLOCKS],
            finished: 0,
            integral: vec![0.0; nv],
            block_time: 0.0,
        })
    }

    /// Whether the first estimate is complete, after one time constant.
    pub fn ready(&self) -> bool {
        self.finished == BLOCKS || (self.finished >= FEWEST_BLOCKS && self.free_time >= self.time_constant)
    }

    /// Takes in a torque `(nv,)` of a step of `dt` (s) without contact: a median at first, then a low-pass.
    pub fn follow(&mut self, torque: &[f64], dt: f64) {
        if !self.ready() {
            return self.learn(torque, dt);
        }
        let share = dt / self.time_constant.max(dt);
        for ((bias, torque), limit) in self.bias.iter_mut().zip(torque).zip(&self.limit) {
            *bias = (*bias + share * (torque - *bias)).clamp(-limit, *limit);
        }
    }

    /// A contact or a wrong reading within less than half of the first time constant does not count in the median.
    fn learn(&mut self, torque: &[f64], dt: f64) {
        self.free_time += dt;
        self.block_time += dt;
        self.integral.iter_mut().zip(torque).for_each(|(sum, torque)| *sum += dt * torque);
        if self.block_time < self.time_constant / BLOCKS as f64 {
            return;
        }
        let mut sorted = [0.0; BLOCKS];
        for ((means, sum), (bias, limit)) in self
            .means
            .as_chunks_mut::<BLOCKS>()
            .0
            .iter_mut()
            .zip(&mut self.integral)
            .zip(self.bias.iter_mut().zip(&self.limit))
        {
            means[self.finished] = *sum / self.block_time;
            *sum = 0.0;
            let sorted = &mut sorted[..=self.finished];
            sorted.copy_from_slice(&means[..=self.finished]);
            *bias = median(sorted).clamp(-limit, *limit);
        }
        self.finished += 1;
        self.block_time = 0.0;
    }

    /// Whether a torque may become the bias.
    pub fn allows(&self, torque: &[f64]) -> bool {
        torque.iter().zip(&self.limit).all(|(torque, limit)| torque.abs() <= *limit)
    }

    /// Another greatest bias of each joint (Nm, N); the bias is what it was until it follows a torque again.
    pub fn set_limit(&mut self, limit: Vec<f64>) {
        self.limit = limit;
    }

    /// Takes a torque for the bias at once.
    pub fn set(&mut self, bias: &[f64]) {
        self.bias.copy_from_slice(bias);
    }

    /// Takes the torque of an untouched robot for the bias; no first estimate is needed then.
    pub fn tare(&mut self, torque: &[f64]) {
        self.set(torque);
        self.finished = BLOCKS;
    }

    /// The bias `(nv,)`.
    pub fn bias(&self) -> &[f64] {
        &self.bias
    }

    /// Starts anew.
    pub fn reset(&mut self) {
        self.bias.fill(0.0);
        self.integral.fill(0.0);
        (self.free_time, self.block_time, self.finished) = (0.0, 0.0, 0);
    }
}

/// Sorts a part of its argument; zero for no values.
fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values {
        [] => 0.0,
        _ if values.len() % 2 == 1 => values[values.len() / 2],
        _ => 0.5 * (values[values.len() / 2 - 1] + values[values.len() / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::BiasTracker;

    const DT: f64 = 1e-3;

    /// The first bias with a time constant of 1 s.
    fn learnt(torque: impl Fn(usize) -> f64) -> f64 {
        let mut tracker = BiasTracker::new(1.0, vec![15.0]).expect("a valid time constant");
        let mut tick = 0;
        while !tracker.ready() {
            tracker.follow(&[torque(tick)], DT);
            tick += 1;
        }
        assert!((990..=1001).contains(&tick), "{tick}");
        tracker.bias()[0]
    }

    #[test]
    fn a_push_while_it_learns_leaves_nothing() {
        for start in [0, 300, 799] {
            let push = |tick: usize| 0.3 + if (start..start + 200).contains(&tick) { 6.0 } else { 0.0 };
            assert!((learnt(push) - 0.3).abs() < 1e-12, "{start}");
        }
    }

    #[test]
    fn an_impossible_tick_leaves_nothing() {
        for wrong in [0, 500, 991] {
            assert!((learnt(|tick| if tick == wrong { 1e59 } else { -0.2 }) + 0.2).abs() < 1e-12, "{wrong}");
        }
    }

    #[test]
    fn noise_is_averaged() {
        let bias = learnt(|tick| 0.5 + (1.7 * tick as f64).sin());
        assert!((bias - 0.5).abs() < 0.02, "{bias}");
    }

    #[test]
    fn few_or_long_steps_are_enough_for_a_median() {
        let mut tracker = BiasTracker::new(1.0, vec![15.0]).expect("a valid time constant");
        tracker.follow(&[1e3], 10.0);
        assert!(!tracker.ready());
        tracker.follow(&[0.1], 10.0);
        tracker.follow(&[0.2], 10.0);
        assert!(tracker.ready());
        assert!((tracker.bias()[0] - 0.2).abs() < 1e-12);
    }

    #[test]
    fn the_bias_has_a_limit() {
        assert!((learnt(|_| 60.0) - 15.0).abs() < 1e-12);
        let mut tracker = BiasTracker::new(0.01, vec![1.0, f64::INFINITY]).expect("a valid time constant");
        for tick in 0..10_000 {
            tracker.follow(&[-1e-3 * tick as f64, 5.0], DT);
        }
        assert_eq!(tracker.bias(), [-1.0, 5.0]);
        assert!(tracker.allows(&[0.9, 50.0]) && !tracker.allows(&[1.1, 0.0]));
        tracker.reset();
        assert!(!tracker.ready() && tracker.bias() == [0.0, 0.0]);
    }
}
