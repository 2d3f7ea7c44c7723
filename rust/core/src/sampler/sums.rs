//! What measurements say of the force at the first touch and the stiffness of a contact, and of the contact with both integrated out.

use std::f64::consts::TAU;

use crate::torque::NormalFit;

/// Force and stiffness are not told apart where the determinant of their precision is this share of the product of its diagonal.
const SINGULAR: f64 = 1e-12;

/// Sums over measurements, each with a force `F a + K b`: `F` the force at the first touch, `K` the stiffness, `a` a direction and `b`
/// how far the spring of the contact is pressed in more than then (m).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sums {
    /// Inner products of the torques of `a` and `b`, each joint over its noise: `aa`, `ab`, `bb`.
    gain: [f64; 3],
    /// Theirs with the measured torques.
    product: [f64; 2],
    /// Of the squared torques.
    target: f64,
    /// What the freedom of forces that are integrated out already costs, twice as a log-likelihood.
    cost: f64,
    /// Torques that tell of the noise.
    pub rows: f64,
}

impl Sums {
    /// Of one measurement with a force along the normal, which is `deeper` than at the first touch (m).
    pub fn along(fit: &NormalFit, deeper: f64) -> Self {
        Sums {
            gain: [fit.gain, fit.gain * deeper, fit.gain * deeper * deeper],
            product: [fit.product, fit.product * deeper],
            target: fit.target,
            cost: 2.0 * fit.penalty,
            rows: 0.0,
        }
    }

    /// Of one measurement, from the Gram matrix of the torques of `a` and `b`, the products with the measured ones, and their
    /// squared norm.
    pub fn of_two(gain: [f64; 3], product: [f64; 2], target: f64) -> Self {
        Sums { gain, product, target, cost: 0.0, rows: 0.0 }
    }

    /// Of one measurement with a force of its own along the normal, which is integrated out; and the likeliest one (N).
    pub fn free(fit: &NormalFit, prior: &Prior) -> (Self, f64) {
        let force = prior.force_of(fit);
        let target = (fit.target + force * (force * fit.gain - 2.0 * fit.product)).max(0.0);
        let width = width(force, prior.force);
        let cost = 2.0 * fit.penalty + (1.0 + fit.gain * width * width / TAU).ln();
        (Sums { target, cost, rows: 0.0, ..Sums::default() }, force)
    }

    /// Adds so many times another.
    pub fn add(&mut self, share: f64, other: &Sums) {
        self.gain.iter_mut().zip(other.gain).for_each(|(sum, x)| *sum += share * x);
        self.product.iter_mut().zip(other.product).for_each(|(sum, x)| *sum += share * x);
        self.target += share * other.target;
        self.cost += share * other.cost;
        self.rows += share * other.rows;
    }

    /// So many times itself.
    pub fn scale(&mut self, share: f64) {
        let all = *self;
        self.add(share - 1.0, &all);
    }
}

/// Of a number in a range with a uniform logarithm: one over its density.
fn width(value: f64, [least, greatest]: [f64; 2]) -> f64 {
    value * (greatest / least).ln()
}

/// What is known beforehand of a contact: its force at the first touch (N) and its stiffness (N/m), each with a uniform logarithm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    pub force: [f64; 2],
    pub stiffness: [f64; 2],
}

/// A contact with force and stiffness integrated out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Marginal {
    /// Logarithm of the likelihood, but for a constant of the measurements.
    pub log: f64,
    /// Likeliest force at the first touch (N) and stiffness (N/m), and the squared torques that they leave over.
    pub force: f64,
    pub stiffness: f64,
    pub misfit: f64,
}

impl Prior {
    /// Over both by Laplace's method, with the best force and stiffness within their ranges. The volume is at most that of the
    /// prior: what the torques do not show costs nothing.
    pub fn integrate(&self, sums: &Sums) -> Marginal {
        let best = self.best(sums);
        let (force, stiffness) = (width(best.force, self.force), width(best.stiffness, self.stiffness));
        let noise = self.noise(best.misfit, sums.rows);
        let [gain, gain_e, gain_ee] = sums.gain.map(|gain| gain / (TAU * noise));
        // Of one plus the precision in units of the widths: at least one but for rounding.
        let determinant = (1.0 + gain * force * force) * (1.0 + gain_ee * stiffness * stiffness)
            - (gain_e * force * stiffness).powi(2);
        Marginal {
            log: -0.5 * (self.weighed(best.misfit, sums.rows) + sums.cost + determinant.max(1.0).ln()),
            ..best
        }
    }

    /// The log-likelihood at most, whatever other measurements say, which have so many rows in all: each can only lessen it.
    pub fn most(&self, sums: &Sums, rows: f64) -> f64 {
        -0.5 * (self.weighed(self.best(sums).misfit, rows) + sums.cost)
    }

    /// By how much the variance of the torques' noise is greater than stated: what explains the misfit best, and never less than one.
    fn noise(&self, misfit: f64, rows: f64) -> f64 {
        if rows > 0.0 {
            (misfit / rows).max(1.0)
        } else {
            1.0
        }
    }

    /// The misfit with noise of that variance, twice as a log-likelihood with its sign turned.
    fn weighed(&self, misfit: f64, rows: f64) -> f64 {
        let noise = self.noise(misfit, rows);
        misfit / noise + rows * noise.ln()
    }

    /// The force within its range that explains one measurement best (N).
    pub fn force_of(&self, fit: &NormalFit) -> f64 {
        let [least, greatest] = self.force;
        if fit.gain > 0.0 {
            (fit.product / fit.gain).clamp(least, greatest)
        } else {
            least
        }
    }

    /// The force and stiffness within their ranges that explain the torques best: those that do anywhere, or the best of an edge.
    fn best(&self, sums: &Sums) -> Marginal {
        let [gain, gain_e, gain_ee] = sums.gain;
        let [product, product_e] = sums.product;
        let [least, greatest] = self.force;
        let [softest, stiffest] = self.stiffness;
        let of = |force: f64, stiffness: f64| {
            let slope =
                force * (force * gain - 2.0 * product) + stiffness * (stiffness * gain_ee - 2.0 * product_e);
            // Never negative but for rounding.
            let misfit = (sums.target + slope + 2.0 * force * stiffness * gain_e).max(0.0);
            Marginal { log: f64::NEG_INFINITY, force, stiffness, misfit }
        };
        let determinant = gain * gain_ee - gain_e * gain_e;
        if determinant > SINGULAR * gain * gain_ee {
            let force = (gain_ee * product - gain_e * product_e) / determinant;
            let stiffness = (gain * product_e - gain_e * product) / determinant;
            if (least..=greatest).contains(&force) && (softest..=stiffest).contains(&stiffness) {
                return of(force, stiffness);
            }
        }
        let ratio = |above: f64, below: f64, [low, high]: [f64; 2]| {
            // Where nothing shows it, the middle of the range.
            if below > 0.0 {
                (above / below).clamp(low, high)
            } else {
                (low * high).sqrt()
            }
        };
        let force_at = |stiffness: f64| ratio(product - stiffness * gain_e, gain, self.force);
        let stiffness_at = |force: f64| ratio(product_e - force * gain_e, gain_ee, self.stiffness);
        [
            of(least, stiffness_at(least)),
            of(greatest, stiffness_at(greatest)),
            of(force_at(softest), softest),
            of(force_at(stiffest), stiffest),
        ]
        .into_iter()
        .fold(of(least, softest), |best, other| if other.misfit < best.misfit { other } else { best })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRIOR: Prior = Prior { force: [1.0, 100.0], stiffness: [3e2, 3e4] };

    fn measured(force: f64, stiffness: f64) -> Sums {
        let mut sums = Sums::default();
        for k in 0..12 {
            let (deeper, gain) = (2e-3 * (0.9 * f64::from(k)).sin(), 1.0 + 0.1 * f64::from(k));
            let torque = force + stiffness * deeper;
            let fit = NormalFit {
                gain,
                product: gain * torque,
                target: gain * torque * torque + 2.0,
                penalty: 0.0,
            };
            sums.add(1.0, &Sums::along(&fit, deeper));
        }
        sums
    }

    #[test]
    fn the_integral_is_that_over_force_and_stiffness() {
        for (force, stiffness) in [(12.0, 2500.0), (5.0, 800.0), (60.0, 9000.0)] {
            let sums = measured(force, stiffness);
            let found = PRIOR.integrate(&sums);
            // On a fine grid of logarithms.
            let (steps, mut total) = (600, 0.0);
            let at =
                |[low, high]: [f64; 2], k: usize| low * (high / low).powf((k as f64 + 0.5) / steps as f64);
            for (a, b) in (0..steps).flat_map(|a| (0..steps).map(move |b| (a, b))) {
                let (f, k) = (at(PRIOR.force, a), at(PRIOR.stiffness, b));
                let misfit = sums.target - 2.0 * (f * sums.product[0] + k * sums.product[1])
                    + f * f * sums.gain[0]
                    + 2.0 * f * k * sums.gain[1]
                    + k * k * sums.gain[2];
                total += (-0.5 * misfit).exp() / (steps * steps) as f64;
            }
            assert!((found.log - total.ln()).abs() < 0.5, "{found:?} {}", total.ln());
            assert!((found.force / force - 1.0).abs() < 0.05, "{found:?}");
            assert!((found.stiffness / stiffness).ln().abs() < 0.3, "{found:?}");
        }
    }

    #[test]
    fn what_was_added_can_be_taken_away() {
        let fit = NormalFit { gain: 3.0, product: 2.0, target: 7.0, penalty: 0.1 };
        let mut sums = measured(10.0, 1000.0);
        let before = PRIOR.integrate(&sums);
        sums.add(1.0, &Sums::along(&fit, 1e-3));
        assert!(PRIOR.integrate(&sums).log < before.log);
        sums.add(-1.0, &Sums::along(&fit, 1e-3));
        assert!((PRIOR.integrate(&sums).log - before.log).abs() < 1e-9);
        assert_eq!(PRIOR.integrate(&Sums::default()).log, 0.0);
    }
}
