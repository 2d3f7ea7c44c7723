//! What measurements say of the force at the first touch and the stiffness of a contact, and of the contact with both integrated out.

use std::ops::{AddAssign, SubAssign};

use crate::torque::NormalFit;

/// Force and stiffness are not told apart where the determinant of their precision is this share of the product of its diagonal.
const SINGULAR: f64 = 1e-12;

/// Sums over measurements, each with a force `F + K e`: `F` the force at the first touch, `K` the stiffness, and `e` how much deeper
/// the obstacle is in the link than then (m).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sums {
    /// Of the gain of a unit force, times `e` and its square.
    gain: [f64; 3],
    /// Of the product with the measured torque, times `e`.
    product: [f64; 2],
    /// Of the squared torques, and of twice what the freedom of friction costs.
    target: f64,
    count: f64,
}

impl Sums {
    /// Of one measurement.
    pub fn of(fit: &NormalFit, deeper: f64) -> Self {
        Sums {
            gain: [fit.gain, fit.gain * deeper, fit.gain * deeper * deeper],
            product: [fit.product, fit.product * deeper],
            target: fit.target + 2.0 * fit.penalty,
            count: 1.0,
        }
    }

    fn each(&mut self, other: &Sums, f: impl Fn(&mut f64, f64)) {
        self.gain.iter_mut().zip(other.gain).for_each(|(a, b)| f(a, b));
        self.product.iter_mut().zip(other.product).for_each(|(a, b)| f(a, b));
        f(&mut self.target, other.target);
        f(&mut self.count, other.count);
    }
}

impl AddAssign<&Sums> for Sums {
    fn add_assign(&mut self, other: &Sums) {
        self.each(other, |a, b| *a += b);
    }
}

impl SubAssign<&Sums> for Sums {
    fn sub_assign(&mut self, other: &Sums) {
        self.each(other, |a, b| *a -= b);
    }
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
        if sums.count == 0.0 {
            return Marginal { log: 0.0, ..best };
        }
        let width = |value: f64, [least, greatest]: [f64; 2]| value * (greatest / least).ln();
        let (force, stiffness) = (width(best.force, self.force), width(best.stiffness, self.stiffness));
        let [gain, gain_e, gain_ee] = sums.gain.map(|gain| gain / std::f64::consts::TAU);
        // Of one plus the precision in units of the widths: at least one but for rounding.
        let determinant = (1.0 + gain * force * force) * (1.0 + gain_ee * stiffness * stiffness)
            - (gain_e * force * stiffness).powi(2);
        Marginal { log: -0.5 * (best.misfit + determinant.max(1.0).ln()), ..best }
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
            sums += &Sums::of(&fit, deeper);
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
        sums += &Sums::of(&fit, 1e-3);
        assert!(PRIOR.integrate(&sums).log < before.log);
        sums -= &Sums::of(&fit, 1e-3);
        assert!((PRIOR.integrate(&sums).log - before.log).abs() < 1e-9);
        assert_eq!(PRIOR.integrate(&Sums::default()).log, 0.0);
    }
}
