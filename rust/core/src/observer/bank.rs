//! One momentum observer with several gains: momentum and its known rate are worked out once (algorithm D3).

use super::order::Order;
use super::step::Step;

/// External torques behind low-passes of several gains.
#[derive(Debug, Clone)]
pub(crate) struct ObserverBank {
    dt: f64,
    order: Order,
    /// (1/s).
    gains: Vec<f64>,
    /// Of each low-pass over the nominal `dt`.
    decays: Vec<f64>,
    /// By gain, `(nv,)`; behind the first of two low-passes, and behind all.
    first: Vec<Vec<f64>>,
    torques: Vec<Vec<f64>>,
}

impl ObserverBank {
    /// For a nominal time step `dt` (s) and gains (1/s) that are positive.
    pub fn new(nv: usize, dt: f64, gains: &[f64], order: Order) -> Self {
        let zeros = vec![vec![0.0; nv]; gains.len()];
        ObserverBank {
            dt,
            order,
            decays: gains.iter().map(|gain| (-order.pole(*gain) * dt).exp()).collect(),
            first: if order == Order::Second { zeros.clone() } else { vec![] },
            torques: zeros,
            gains: gains.to_vec(),
        }
    }

    /// A step with an external torque before any low-pass `(nv,)`; none over a gap: the torques are then kept, as an observer
    /// keeps its own.
    #[inline]
    pub fn advance(&mut self, unexplained: Option<&[f64]>, step: Step) {
        let Some(unexplained) = unexplained else { return };
        for (which, torque) in self.torques.iter_mut().enumerate() {
            let decay = match step {
                Step::Nominal => self.decays[which],
                _ => (-self.order.pole(self.gains[which]) * step.length(self.dt)).exp(),
            };
            match self.first.get_mut(which) {
                Some(first) => {
                    low_pass(first, unexplained, decay);
                    low_pass(torque, first, decay);
                }
                None => low_pass(torque, unexplained, decay),
            }
        }
    }

    /// By gain, the external torque `(nv,)`.
    pub fn torques(&self) -> &[Vec<f64>] {
        &self.torques
    }

    /// The torque of one gain becomes that of another.
    pub fn take_over(&mut self, which: usize, of: usize) {
        for torques in [&mut self.first, &mut self.torques] {
            if let Ok([torque, other]) = torques.get_disjoint_mut([which, of]) {
                torque.copy_from_slice(other);
            }
        }
    }

    /// All gains (1/s).
    pub fn gains(&self) -> &[f64] {
        &self.gains
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        self.first.iter_mut().chain(&mut self.torques).for_each(|torque| torque.fill(0.0));
    }
}

fn low_pass(torque: &mut [f64], new: &[f64], decay: f64) {
    torque.iter_mut().zip(new).for_each(|(torque, new)| *torque = new + decay * (*torque - new));
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::observer::MomentumObserver;
    use crate::robot::Robot;
    use crate::Sample;

    const GAINS: [f64; 3] = [8.0, 50.0, 200.0];

    #[test]
    fn each_gain_is_an_observer_of_its_own() {
        let robot = Arc::new(Robot::example_arm());
        let observer = |gain: f64| MomentumObserver::new(robot.clone(), 1e-3, &[gain]).expect("valid");
        let (mut source, mut alone) = (observer(30.0), GAINS.map(observer));
        let mut bank = ObserverBank::new(7, 1e-3, &GAINS, Order::First);
        for tick in 0..300 {
            let phase = 0.01 * f64::from(tick);
            let q: Vec<f64> = (0..7).map(|j| (phase + f64::from(j)).sin()).collect();
            let v: Vec<f64> = (0..7).map(|j| 10.0 * (phase + f64::from(j)).cos()).collect();
            let tau: Vec<f64> = (0..7).map(|j| (3.0 * phase).sin() * f64::from(j)).collect();
            let step = if tick % 7 == 0 { Step::Of(4e-3) } else { Step::Nominal };
            source.advance(&Sample::new(&q, &v, &tau), step);
            bank.advance(source.unexplained(), step);
            for (observer, torque) in alone.iter_mut().zip(bank.torques()) {
                assert_eq!(observer.advance(&Sample::new(&q, &v, &tau), step), torque);
            }
        }
    }

    #[test]
    fn a_constant_torque_rises_as_its_response_says() {
        for order in [Order::First, Order::Second] {
            let mut bank = ObserverBank::new(1, 1e-4, &GAINS, order);
            for tick in 1..=2000 {
                bank.advance(Some(&[3.0]), Step::Nominal);
                for (gain, torque) in GAINS.iter().zip(bank.torques()) {
                    let expected = 3.0 * order.step_response(*gain, 1e-4 * f64::from(tick));
                    assert!((torque[0] - expected).abs() < 0.06, "{order:?} {gain} {tick}: {}", torque[0]);
                }
            }
        }
    }

    #[test]
    fn slow_errors_are_left_as_their_share_says() {
        const DT: f64 = 1e-3;
        let noise = crate::math::random::Stream::new(4);
        for order in [Order::First, Order::Second] {
            let mut bank = ObserverBank::new(1, DT, &[8.0, 50.0], order);
            let (mut error, mut squares, time) = (0.0_f64, [0.0; 2], 0.05_f64);
            let keep = (-DT / time).exp();
            let count = 400_000;
            for tick in 0..count {
                error = keep * error + (1.0 - keep * keep).sqrt() * noise.normals(2 * tick)[0];
                bank.advance(Some(&[error]), Step::Nominal);
                let torques = bank.torques().iter().map(|torque| torque[0]);
                squares.iter_mut().zip(torques).for_each(|(sum, torque)| *sum += torque * torque);
            }
            for (gain, sum) in [8.0, 50.0].into_iter().zip(squares) {
                let share = order.slow_share(gain, time);
                let ratio = sum / count as f64 / share;
                assert!((ratio - 1.0).abs() < 0.12, "{order:?} {gain}: {ratio}");
            }
        }
    }
}
