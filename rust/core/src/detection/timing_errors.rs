//! What a torque that jumps leaves behind an observer because it is sampled: within a step the time of the jump is not known.

use crate::observer::Order;

/// The largest error of the time of a sample, as a share of the step to it.
const OF_STEP: f64 = 0.5;

/// The rate of the torque that moves the robot, as one observer passes it on.
#[derive(Debug, Clone)]
pub(super) struct TimingErrors {
    order: Order,
    /// Of each low-pass (1/s), by velocity variable.
    poles: Vec<f64>,
    /// Behind the first low-pass and behind all, `(nv,)` each (Nm; N).
    first: Vec<f64>,
    last: Vec<f64>,
    /// Largest error of the observer's torque (Nm; N).
    bound: Vec<f64>,
    started: bool,
}

impl TimingErrors {
    /// Behind an observer of a gain each (1/s).
    pub fn new(gain: &[f64], order: Order) -> Self {
        let zeros = vec![0.0; gain.len()];
        TimingErrors {
            order,
            poles: gain.iter().map(|gain| order.pole(*gain)).collect(),
            first: zeros.clone(),
            last: zeros.clone(),
            bound: zeros,
            started: false,
        }
    }

    /// A step of a length (s) with the torque `(nv,)` that moves the robot at its end; none where the observer keeps its own.
    #[inline]
    pub fn advance(&mut self, torque: &[f64], length: Option<f64>) {
        let Some(length) = length.filter(|_| self.started) else {
            self.first.copy_from_slice(torque);
            self.last.copy_from_slice(torque);
            self.bound.fill(0.0);
            self.started = true;
            return;
        };
        let mut decay = 0.0;
        for (j, torque) in torque.iter().enumerate() {
            let pole = self.poles[j];
            if j == 0 || pole != self.poles[j - 1] {
                decay = (-pole * length).exp();
            }
            let first = torque + decay * (self.first[j] - torque);
            let before = match self.order {
                Order::First => *torque,
                Order::Second => first,
            };
            self.first[j] = first;
            self.last[j] = before + decay * (self.last[j] - before);
            self.bound[j] = OF_STEP * length * pole * (before - self.last[j]).abs();
        }
    }

    /// Takes from a torque `(nv,)` what may be an error of time.
    #[inline]
    pub fn take_from(&self, torque: &mut [f64]) {
        for (torque, bound) in torque.iter_mut().zip(&self.bound) {
            *torque = (torque.abs() - bound).max(0.0).copysign(*torque);
        }
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        self.bound.fill(0.0);
        self.started = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observer::ObserverBank;
    use crate::observer::Step;

    const DT: f64 = 1e-3;

    /// The largest torque that a jump within a step leaves behind an observer, as it is and without errors of time.
    fn largest(gain: f64, order: Order, share: f64) -> [f64; 2] {
        let mut bank = ObserverBank::new(1, DT, &[gain], order);
        let mut errors = TimingErrors::new(&[gain], order);
        let mut largest = [0.0_f64; 2];
        let (mut before, mut momentum) = (0.0, 0.0);
        for k in 0..400 {
            // A torque of 8 Nm from a share of the 100th step on moves a mass of 1 kg m^2.
            let torque = if k < 100 { 0.0 } else { 8.0 };
            let moved = match k {
                0..100 => 0.0,
                100 => 8.0 * DT * (1.0 - share),
                _ => 8.0 * DT,
            };
            momentum += moved;
            bank.advance(Some(&[moved / DT - 0.5 * (torque + before)]), Step::Nominal);
            errors.advance(&[torque], Some(DT));
            before = torque;
            let shown = bank.torques()[0][0];
            let mut left = [shown];
            errors.take_from(&mut left);
            largest = [largest[0].max(shown.abs()), largest[1].max(left[0].abs())];
        }
        assert!(momentum > 2.0);
        largest
    }

    #[test]
    fn a_jump_within_a_step_leaves_nothing() {
        for gain in [8.0, 50.0, 200.0] {
            for share in [0.0, 0.2, 0.5, 0.9, 1.0] {
                let [shown, left] = largest(gain, Order::Second, share);
                assert!(left <= 0.02 * 8.0 && left <= shown, "{gain} {share}: {shown} {left}");
            }
        }
        let [shown, left] = largest(200.0, Order::Second, 1.0);
        assert!(shown > 0.5 && left < 0.2 * shown, "{shown} {left}");
    }

    #[test]
    fn a_steady_torque_is_taken_whole_and_a_gap_starts_anew() {
        let mut errors = TimingErrors::new(&[50.0; 2], Order::Second);
        (0..1000).for_each(|_| errors.advance(&[4.0, -2.0], Some(DT)));
        let mut torque = [1.0, -0.5];
        errors.take_from(&mut torque);
        assert!((torque[0] - 1.0).abs() < 1e-9 && (torque[1] + 0.5).abs() < 1e-9);
        errors.advance(&[-40.0, 20.0], None);
        errors.take_from(&mut torque);
        assert!((torque[0] - 1.0).abs() < 1e-9);
        errors.advance(&[0.0, 20.0], Some(DT));
        errors.take_from(&mut torque);
        assert!(torque[0] < 1.0 && torque[1] < -0.49);
    }
}
