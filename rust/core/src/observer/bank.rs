//! One momentum observer with several gains: momentum and its known rate are worked out once (algorithm D3).

use super::step::Step;

/// External torques behind low-passes of several gains.
#[derive(Debug, Clone)]
pub(crate) struct ObserverBank {
    dt: f64,
    /// (1/s).
    gains: Vec<f64>,
    /// `exp(-gain dt)` for the nominal `dt`.
    decays: Vec<f64>,
    /// By gain, `(nv,)`.
    torques: Vec<Vec<f64>>,
}

impl ObserverBank {
    /// For a nominal time step `dt` (s) and gains (1/s) that are positive.
    pub fn new(nv: usize, dt: f64, gains: &[f64]) -> Self {
        ObserverBank {
            dt,
            decays: gains.iter().map(|gain| (-gain * dt).exp()).collect(),
            torques: vec![vec![0.0; nv]; gains.len()],
            gains: gains.to_vec(),
        }
    }

    /// A step with an external torque before any low-pass `(nv,)`; none over a gap: the torques are then kept, as an observer
    /// keeps its own.
    #[inline]
    pub fn advance(&mut self, unexplained: Option<&[f64]>, step: Step) {
        let Some(unexplained) = unexplained else { return };
        for ((torque, gain), nominal) in self.torques.iter_mut().zip(&self.gains).zip(&self.decays) {
            let decay = match step {
                Step::Nominal => *nominal,
                _ => (-gain * step.length(self.dt)).exp(),
            };
            torque
                .iter_mut()
                .zip(unexplained)
                .for_each(|(torque, new)| *torque = new + decay * (*torque - new));
        }
    }

    /// By gain, the external torque `(nv,)`.
    pub fn torques(&self) -> &[Vec<f64>] {
        &self.torques
    }

    /// The torque of one gain becomes that of another.
    pub fn take_over(&mut self, which: usize, of: usize) {
        if let Ok([torque, other]) = self.torques.get_disjoint_mut([which, of]) {
            torque.copy_from_slice(other);
        }
    }

    /// All gains (1/s).
    pub fn gains(&self) -> &[f64] {
        &self.gains
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        self.torques.iter_mut().for_each(|torque| torque.fill(0.0));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::observer::MomentumObserver;
    use crate::robot::Robot;
    use crate::Sample;

    #[test]
    fn each_gain_is_an_observer_of_its_own() {
        let robot = Arc::new(Robot::example_arm());
        let gains = [8.0, 50.0, 200.0];
        let observer = |gain: f64| MomentumObserver::new(robot.clone(), 1e-3, &[gain]).expect("valid");
        let (mut source, mut alone) = (observer(30.0), gains.map(observer));
        let mut bank = ObserverBank::new(7, 1e-3, &gains);
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
}
