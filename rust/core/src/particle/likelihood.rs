//! How well a particle explains the measured torque.

use super::columns::{Columns, Slice};
use super::options::Likelihood;

/// What particle k believes: of all particles, or of a slice of them.
macro_rules! belief {
    ($particles:expr, $k:expr) => {
        Belief {
            force: $particles.force[$k],
            variance: $particles.force_variance[$k],
            gain: $particles.gain[$k],
            product: $particles.product[$k],
            measured: $particles.measured[$k],
            penalty: $particles.penalty[$k],
        }
    };
}

/// What a step of weighing needs to know.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighing {
    pub likelihood: Likelihood,
    /// Variance of the torques' error, in units of their noise.
    pub variance: f64,
    pub stiffness_range: [f64; 2],
}

/// A belief about force and stiffness after a measurement, and its weight.
#[derive(Debug, Clone, Copy)]
struct Posterior {
    force: f64,
    log_weight: f64,
    /// Share of the variance that is left.
    left: f64,
}

impl Weighing {
    /// Log-likelihood of a belief, as if nothing else had been measured yet; changes nothing.
    #[inline]
    pub fn log_likelihood(&self, belief: &Belief) -> f64 {
        self.posterior(belief).log_weight - belief.penalty
    }

    /// Weighs all particles and updates what they believe of the force.
    pub fn apply(&self, particles: &mut Slice<'_>) {
        for k in 0..particles.len() {
            let belief = belief!(particles, k);
            let posterior = self.posterior(&belief);
            particles.log_weight[k] += posterior.log_weight - belief.penalty;
            let change = posterior.force - belief.force;
            // Also where the contact has ended, of which the variance and the stiffness learn nothing.
            particles.force[k] = posterior.force;
            if belief.variance > 0.0 && posterior.left < 1.0 {
                let share = particles.cross_variance[k] / belief.variance;
                particles.stiffness[k] = (particles.stiffness[k] + share * change)
                    .clamp(self.stiffness_range[0], self.stiffness_range[1]);
                particles.stiffness_variance[k] -=
                    share * particles.cross_variance[k] * (1.0 - posterior.left);
                particles.force_variance[k] *= posterior.left;
                particles.cross_variance[k] *= posterior.left;
            }
        }
    }

    #[inline]
    fn posterior(&self, belief: &Belief) -> Posterior {
        match self.likelihood {
            Likelihood::Gaussian => self.gaussian(belief),
            Likelihood::Exponential => self.exponential(belief),
        }
    }

    /// The force is linear in the torque, so it is integrated out: a scalar Kalman filter in each particle.
    #[inline]
    fn gaussian(&self, belief: &Belief) -> Posterior {
        let Belief { force, variance, gain, product, measured, .. } = *belief;
        let gap = Posterior { force, log_weight: -0.5 * measured / self.variance, left: 1.0 };
        if gain <= 0.0 {
            return gap;
        }
        let precision = gain / self.variance;
        let left = 1.0 / (1.0 + variance * precision);
        let slope = (product - force * gain) / self.variance;
        let found = force + variance * left * slope;
        if found <= 0.0 {
            // No contact, or one that has just ended.
            let ended = if force > 0.0 { force * force / variance - left.ln() } else { 0.0 };
            let force = if force > 0.0 { 0.0 } else { force };
            return Posterior { force, log_weight: gap.log_weight - 0.5 * ended, ..gap };
        }
        let squared = (measured - force * (2.0 * product - force * gain)).max(0.0) / self.variance;
        let explained = slope * slope * variance * left;
        Posterior { force: found, log_weight: -0.5 * (squared - explained - left.ln()), left }
    }

    /// The paper's (Bimbo 2019, eq. 5), of the predicted force.
    #[inline]
    fn exponential(&self, belief: &Belief) -> Posterior {
        Posterior { force: belief.force, log_weight: -(misfit(belief) / self.variance).sqrt(), left: 1.0 }
    }
}

/// What a particle believes of its force, and what the force would do.
#[derive(Debug, Clone, Copy)]
pub(super) struct Belief {
    pub force: f64,
    pub variance: f64,
    pub gain: f64,
    pub product: f64,
    pub measured: f64,
    pub penalty: f64,
}

impl Belief {
    #[inline]
    pub fn of(particles: &Columns, k: usize) -> Self {
        belief!(particles, k)
    }
}

/// Squared norm of the torque that a belief leaves over, in units of the noise.
pub(super) fn misfit(belief: &Belief) -> f64 {
    let force = belief.force.max(0.0);
    (belief.measured - force * (2.0 * belief.product - force * belief.gain)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_contact_that_has_just_ended_has_no_force() {
        let weighing =
            Weighing { likelihood: Likelihood::Gaussian, variance: 1.0, stiffness_range: [3e2, 3e4] };
        let mut particles = Columns::new(1).expect("memory for one");
        // Pushed with 5 N before; now a torque of the opposite sign, ten times the noise.
        (particles.force[0], particles.force_variance[0]) = (5.0, 1.0);
        (particles.gain[0], particles.product[0], particles.measured[0]) = (4.0, -20.0, 100.0);
        weighing.apply(&mut particles.slice());
        assert_eq!(particles.force[0], 0.0);
        assert!(particles.log_weight[0].is_finite());
        assert_eq!(particles.force_variance[0], 1.0);
        // What is left over is then all of the torque.
        assert_eq!(misfit(&Belief::of(&particles, 0)), 100.0);
    }
}
