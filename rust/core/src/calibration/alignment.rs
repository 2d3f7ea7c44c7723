//! Signals of different delays, brought to one time: that of the latest of them.
//!
//! A signal that is late cannot be brought forward where it jumps, as the acceleration of a planned move does: its rate is known too
//! late. The others can be made as late as it is.

/// Makes torques, velocities and positions as late as the latest of them.
#[derive(Debug, Clone)]
pub(crate) struct Alignment {
    /// Of the time that all are brought to (s).
    delay: f64,
    velocity: LowPass,
    torque: LowPass,
}

impl Alignment {
    /// Of `count` velocities and torques that are late by so much (s) against the positions.
    pub fn new(velocity_delay: f64, torque_delay: f64, count: usize) -> Self {
        let delay = velocity_delay.max(torque_delay);
        Alignment {
            delay,
            velocity: LowPass::new(delay - velocity_delay, count),
            torque: LowPass::new(delay - torque_delay, count),
        }
    }

    /// The next step is one over a gap, or the first.
    pub fn reset(&mut self) {
        self.velocity.started = false;
        self.torque.started = false;
    }

    /// A step of `dt` (s): velocities and torques as late as the latest of them.
    #[inline]
    pub fn advance(&mut self, dt: f64, v: &mut [f64], tau: &mut [f64]) {
        self.velocity.advance(dt, v);
        self.torque.advance(dt, tau);
    }

    /// How late all signals now are (s): the positions have to go back by so much.
    pub fn delay(&self) -> f64 {
        self.delay
    }
}

/// A low-pass whose mean delay is the one asked for at any step: what makes a signal late is one itself, most often.
#[derive(Debug, Clone)]
struct LowPass {
    delay: f64,
    low: Vec<f64>,
    started: bool,
}

impl LowPass {
    fn new(delay: f64, count: usize) -> Self {
        LowPass { delay, low: vec![0.0; count], started: false }
    }

    #[inline]
    fn advance(&mut self, dt: f64, signals: &mut [f64]) {
        if self.delay == 0.0 {
            return;
        }
        if !self.started {
            self.low.copy_from_slice(signals);
            self.started = true;
        }
        // Of a change from row to row, the output is late by `kept / (1 - kept)` rows.
        let kept = self.delay / (self.delay + dt);
        for (low, signal) in self.low.iter_mut().zip(signals) {
            *low = *signal + kept * (*low - *signal);
            *signal = *low;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-3;

    #[test]
    fn all_signals_become_as_late_as_the_latest() {
        for [velocity_delay, torque_delay] in [[0.004, 0.001], [0.0, 0.006], [0.003, 0.003], [0.0, 0.0]] {
            let mut alignment = Alignment::new(velocity_delay, torque_delay, 1);
            let delay = alignment.delay();
            assert_eq!(delay, f64::max(velocity_delay, torque_delay));
            for k in 0..2000 {
                let time = f64::from(k) * DT;
                let signal = |time: f64| (6.0 * time).sin();
                let (mut v, mut tau) = ([signal(time - velocity_delay)], [signal(time - torque_delay)]);
                alignment.advance(DT, &mut v, &mut tau);
                if k > 100 {
                    assert!((v[0] - signal(time - delay)).abs() < 1e-3, "{} at {time}", v[0]);
                    assert!((tau[0] - signal(time - delay)).abs() < 1e-3, "{} at {time}", tau[0]);
                }
            }
        }
    }

    #[test]
    fn torques_jump_with_velocities_that_a_low_pass_made_late() {
        // The momentum of an accelerated mass of 1 kg m^2 behind a low-pass, as drives report it.
        let delay = 0.004;
        let mut alignment = Alignment::new(delay, 0.0, 1);
        let (mut late, mut before, mut torque_sum) = (0.0, 0.0, 0.0);
        for k in 0..200 {
            let acceleration = if k < 100 { 0.0 } else { 5.0 };
            let v = 5.0 * DT * f64::from((k - 100).max(0));
            late += DT / (delay + DT) * (v - late);
            let (mut reported, mut tau) = ([late], [acceleration]);
            alignment.advance(DT, &mut reported, &mut tau);
            torque_sum += DT * 0.5 * (tau[0] + before);
            before = tau[0];
            // Of a momentum of 0.5 kg m^2/s, half a step's torque.
            assert!(
                (reported[0] - torque_sum).abs() <= 0.5 * DT * 5.0 + 1e-12,
                "{} {torque_sum}",
                reported[0]
            );
        }
    }

    #[test]
    fn longer_steps_and_starts_are_no_jumps() {
        let mut alignment = Alignment::new(0.004, 0.0, 1);
        let mut tau = [3.0];
        alignment.advance(0.0, &mut [0.0], &mut tau);
        assert_eq!(tau, [3.0]);
        for dt in [1e-3, 0.02, 1e-3, 0.5] {
            let mut tau = [3.0];
            alignment.advance(dt, &mut [0.0], &mut tau);
            assert_eq!(tau, [3.0]);
        }
        alignment.reset();
        let mut tau = [-1.0];
        alignment.advance(0.0, &mut [0.0], &mut tau);
        assert_eq!(tau, [-1.0]);
    }
}
