//! What measurements say of the forces at the first touch and the stiffnesses of contacts, and of the contacts with these integrated out.

// Rows and columns of matrices: the equations are written with their numbers.
#![allow(clippy::needless_range_loop)]

use std::f64::consts::TAU;

use nalgebra::{Matrix2, Vector2};

use crate::particle::MOST_CONTACTS;
use crate::torque::{NormalFit, SeveralPushes};

/// Force and stiffness are not told apart where the determinant of their precision is this share of the product of its diagonal.
const SINGULAR: f64 = 1e-12;
/// Torques of so many standard deviations over the whole range of a number are not felt.
const UNFELT: f64 = 1e-3;
/// A force and a stiffness for each contact.
const MOST_NUMBERS: usize = 2 * MOST_CONTACTS;
/// Rounds of holding numbers at the ends of their ranges, for each contact; they end where letting go of any would lessen the misfit
/// by less than this share of all torques.
const ROUNDS: usize = 4;
const SETTLED: f64 = 1e-6;
/// Share of all torques that rounding can turn a misfit of nothing into.
const ROUNDED: f64 = 1e-6;
/// Sweeps over the contacts where these rounds do not end, and the change of a sweep that ends them, relative to the numbers.
const SWEEPS: usize = 40;
const UNCHANGED: f64 = 1e-5;

/// Sums over measurements, each with a force `F a + K b` of each contact: `F` the force at the first touch, `K` the stiffness, `a` a
/// direction and `b` how far the spring of the contact is pressed in more than then (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sums<const N: usize> {
    /// Inner products of the torques of `a` and `b` of one contact and those of another, each joint over its noise. Symmetric.
    gain: [[Matrix2<f64>; N]; N],
    /// Theirs with the measured torques.
    product: [Vector2<f64>; N],
    /// Of the squared torques.
    target: f64,
    /// What the freedom of forces that are integrated out already costs, twice as a log-likelihood.
    cost: f64,
    /// Torques that tell of the noise.
    pub rows: f64,
}

impl<const N: usize> Sums<N> {
    /// Of no measurement.
    pub const NONE: Self = Sums {
        gain: [[Matrix2::new(0.0, 0.0, 0.0, 0.0); N]; N],
        product: [Vector2::new(0.0, 0.0); N],
        target: 0.0,
        cost: 0.0,
        rows: 0.0,
    };

    /// Of one measurement of a single contact, the first: from the Gram matrix of the torques of `a` and `b`, the products with the
    /// measured ones, and their squared norm.
    pub fn of_two(gain: Matrix2<f64>, product: Vector2<f64>, target: f64) -> Self {
        let mut sums = Sums { target, ..Sums::NONE };
        (sums.gain[0][0], sums.product[0]) = (gain, product);
        sums
    }

    /// Of one measurement of a single contact with a force of its own along the normal, which is integrated out; and the likeliest
    /// one (N).
    pub fn free(fit: &NormalFit, prior: &Prior) -> (Self, f64) {
        let force = prior.force_of(fit);
        let target = (fit.target + force * (force * fit.gain - 2.0 * fit.product)).max(0.0);
        let width = width(force, prior.force);
        let cost = 2.0 * fit.penalty + (1.0 + fit.gain * width * width / TAU).ln();
        (Sums { target, cost, ..Sums::NONE }, force)
    }

    /// Of one measurement with forces along the normals, each `deeper` than at the first touch (m).
    pub fn along(pushes: &SeveralPushes<N>, deeper: &[f64; N]) -> Self {
        let mut sums = Sums { target: pushes.target, cost: 2.0 * pushes.penalty, ..Sums::NONE };
        for i in 0..N {
            sums.product[i] = Vector2::new(1.0, deeper[i]) * pushes.product[i];
            for j in 0..N {
                let (own, other) = (deeper[i], deeper[j]);
                sums.gain[i][j] = Matrix2::new(1.0, other, own, own * other) * pushes.gain[i][j];
            }
        }
        sums
    }

    /// Adds so many times another.
    pub fn add(&mut self, share: f64, other: &Self) {
        for i in 0..N {
            self.product[i] += other.product[i] * share;
            for j in 0..N {
                self.gain[i][j] += other.gain[i][j] * share;
            }
        }
        self.target += share * other.target;
        self.cost += share * other.cost;
        self.rows += share * other.rows;
    }

    /// So many times itself.
    pub fn scale(&mut self, share: f64) {
        let all = *self;
        self.add(share - 1.0, &all);
    }

    /// The contacts in another order.
    pub fn reorder(&mut self, order: &[usize; N]) {
        let before = *self;
        for i in 0..N {
            self.product[i] = before.product[order[i]];
            for j in 0..N {
                self.gain[i][j] = before.gain[order[i]][order[j]];
            }
        }
    }

    /// The squared torques that forces and stiffnesses leave over.
    fn misfit(&self, numbers: &[Vector2<f64>; N]) -> f64 {
        let mut misfit = self.target;
        for i in 0..N {
            misfit -= 2.0 * self.product[i].dot(&numbers[i]);
            for j in 0..N {
                misfit += numbers[i].dot(&(self.gain[i][j] * numbers[j]));
            }
        }
        // Never negative but for rounding. What is more was added and taken away as something else, and tells nothing.
        if misfit >= -ROUNDED * self.target {
            misfit.max(0.0)
        } else {
            f64::INFINITY
        }
    }

    /// What all contacts but one leave to it.
    fn left_to(&self, contact: usize, numbers: &[Vector2<f64>; N]) -> Vector2<f64> {
        let others = (0..N).filter(|j| *j != contact).map(|j| self.gain[contact][j] * numbers[j]);
        others.fold(self.product[contact], |left, other| left - other)
    }

    /// The numbers that explain the torques best while some are held where they are, two a contact.
    ///
    /// # Errors
    /// One that the measurements do not tell from those before it.
    fn best_of_free(
        &self,
        numbers: &[f64; MOST_NUMBERS],
        held: &[bool; MOST_NUMBERS],
    ) -> std::result::Result<[f64; MOST_NUMBERS], usize> {
        let gain = |a: usize, b: usize| self.gain[a / 2][b / 2][(a % 2, b % 2)];
        let mut order = [0; MOST_NUMBERS];
        let mut free = 0;
        for a in 0..2 * N {
            if !held[a] {
                order[free] = a;
                free += 1;
            }
        }
        let mut rows = [[0.0; MOST_NUMBERS + 1]; MOST_NUMBERS];
        for i in 0..free {
            let a = order[i];
            let of_held: f64 = (0..2 * N).filter(|b| held[*b]).map(|b| gain(a, b) * numbers[b]).sum();
            for j in i..free {
                rows[i][j] = gain(a, order[j]);
            }
            rows[i][MOST_NUMBERS] = self.product[a / 2][a % 2] - of_held;
        }
        // Symmetric: what is left of the diagonal is above it.
        for i in 0..free {
            let pivot = rows[i][i];
            if pivot.is_nan() || pivot <= SINGULAR * gain(order[i], order[i]) {
                return Err(order[i]);
            }
            for below in i + 1..free {
                let share = rows[i][below] / pivot;
                for j in below..free {
                    rows[below][j] -= share * rows[i][j];
                }
                rows[below][MOST_NUMBERS] -= share * rows[i][MOST_NUMBERS];
            }
        }
        let mut found = *numbers;
        for i in (0..free).rev() {
            let later: f64 = (i + 1..free).map(|j| rows[i][j] * found[order[j]]).sum();
            found[order[i]] = (rows[i][MOST_NUMBERS] - later) / rows[i][i];
        }
        Ok(found)
    }

    /// Half of what the misfit grows by a number.
    fn slope(&self, numbers: &[f64; MOST_NUMBERS], a: usize) -> f64 {
        let felt: f64 = (0..2 * N).map(|b| self.gain[a / 2][b / 2][(a % 2, b % 2)] * numbers[b]).sum();
        felt - self.product[a / 2][a % 2]
    }

    /// Of one plus the precision in units of the widths of the prior: at least one but for rounding.
    fn determinant(&self, widths: &[Vector2<f64>; N], noise: f64) -> f64 {
        let mut rows = [[0.0; MOST_NUMBERS]; MOST_NUMBERS];
        for a in 0..2 * N {
            for b in 0..2 * N {
                let gain = self.gain[a / 2][b / 2][(a % 2, b % 2)];
                rows[a][b] = gain * widths[a / 2][a % 2] * widths[b / 2][b % 2] / (TAU * noise);
            }
            rows[a][a] += 1.0;
        }
        let mut determinant = 1.0;
        for a in 0..2 * N {
            let pivot = rows[a][a].max(1.0);
            determinant *= pivot;
            for below in a + 1..2 * N {
                let share = rows[below][a] / pivot;
                for b in a + 1..2 * N {
                    rows[below][b] -= share * rows[a][b];
                }
            }
        }
        determinant
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

/// Contacts with forces and stiffnesses integrated out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Marginal<const N: usize> {
    /// Logarithm of the likelihood, but for a constant of the measurements.
    pub log: f64,
    /// Likeliest force at the first touch (N) and stiffness (N/m) of each, and the squared torques that they leave over.
    pub force: [f64; N],
    pub stiffness: [f64; N],
    pub misfit: f64,
}

impl Prior {
    /// Over all by Laplace's method, with the best forces and stiffnesses within their ranges. The volume is at most that of the
    /// prior: what the torques do not show costs nothing.
    pub fn integrate<const N: usize>(&self, sums: &Sums<N>) -> Marginal<N> {
        self.integrate_at(sums, self.best(sums))
    }

    /// The same about other forces and stiffnesses.
    pub fn integrate_at<const N: usize>(&self, sums: &Sums<N>, best: [Vector2<f64>; N]) -> Marginal<N> {
        let misfit = sums.misfit(&best);
        let widths =
            best.map(|number| Vector2::new(width(number[0], self.force), width(number[1], self.stiffness)));
        let determinant = sums.determinant(&widths, self.noise(misfit, sums.rows));
        Marginal {
            log: -0.5 * (self.weighed(misfit, sums.rows) + sums.cost + determinant.ln()),
            force: best.map(|number| number[0]),
            stiffness: best.map(|number| number[1]),
            misfit,
        }
    }

    /// The log-likelihood at most, whatever other measurements say, which have so many rows in all: each can only lessen it.
    pub fn most<const N: usize>(&self, sums: &Sums<N>, rows: f64) -> f64 {
        self.most_at(sums, &self.best(sums), rows)
    }

    /// The same with these forces and stiffnesses.
    pub fn most_at<const N: usize>(&self, sums: &Sums<N>, numbers: &[Vector2<f64>; N], rows: f64) -> f64 {
        -0.5 * (self.weighed(sums.misfit(numbers), rows) + sums.cost)
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
        if misfit.is_infinite() {
            return misfit;
        }
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

    fn contain(&self, number: &Vector2<f64>) -> bool {
        let within = |number: f64, [low, high]: [f64; 2]| (low..=high).contains(&number);
        within(number[0], self.force) && within(number[1], self.stiffness)
    }

    /// The forces and stiffnesses within their ranges that explain the torques best: by holding some at
    /// the ends, or by sweeps over the contacts.
    pub fn best<const N: usize>(&self, sums: &Sums<N>) -> [Vector2<f64>; N] {
        if N > 1 {
            if let Some(found) = self.with_some_held(sums) {
                return found;
            }
        }
        let mut numbers = [Vector2::zeros(); N];
        for _ in 0..if N > 1 { SWEEPS } else { 1 } {
            let mut change: f64 = 0.0;
            for i in 0..N {
                let found = self.best_of_one(&sums.gain[i][i], &sums.left_to(i, &numbers));
                change = change.max((found - numbers[i]).component_div(&found).amax());
                numbers[i] = found;
            }
            if change < UNCHANGED {
                break;
            }
        }
        numbers
    }

    /// By holding numbers at the ends of their ranges (an active-set method); none where it does not end soon.
    fn with_some_held<const N: usize>(&self, sums: &Sums<N>) -> Option<[Vector2<f64>; N]> {
        let range = |a: usize| if a.is_multiple_of(2) { self.force } else { self.stiffness };
        let (mut numbers, mut held) = ([0.0; MOST_NUMBERS], [false; MOST_NUMBERS]);
        for _ in 0..ROUNDS * N {
            match sums.best_of_free(&numbers, &held) {
                Ok(found) => numbers = found,
                Err(open) => {
                    let [low, high] = range(open);
                    let felt = sums.gain[open / 2][open / 2][(open % 2, open % 2)] * (high - low).powi(2);
                    if felt > UNFELT * UNFELT {
                        return None;
                    }
                    // Where nothing shows it, the middle of the range.
                    (numbers[open], held[open]) = ((low * high).sqrt(), true);
                    continue;
                }
            }
            let mut outside = false;
            for a in 0..2 * N {
                let [low, high] = range(a);
                if !(low..=high).contains(&numbers[a]) {
                    (numbers[a], held[a], outside) = (numbers[a].clamp(low, high), true, true);
                }
            }
            if outside {
                continue;
            }
            // Let go of what pulls inward most, in proportion to its range.
            let pull = |a: usize| {
                let ([low, high], slope) = (range(a), sums.slope(&numbers, a));
                (high - low) * if numbers[a] <= low { -slope } else { slope }
            };
            let at_end = |a: &usize| held[*a] && range(*a).contains(&numbers[*a]);
            let most = (0..2 * N).filter(at_end).map(|a| (a, pull(a))).max_by(|a, b| a.1.total_cmp(&b.1));
            match most {
                Some((a, pull)) if pull > SETTLED * sums.target => held[a] = false,
                _ => return Some(std::array::from_fn(|i| Vector2::new(numbers[2 * i], numbers[2 * i + 1]))),
            }
        }
        None
    }

    /// The force and stiffness of one contact, within their ranges: those that explain the torques best anywhere, or the best of an
    /// edge.
    fn best_of_one(&self, gain: &Matrix2<f64>, product: &Vector2<f64>) -> Vector2<f64> {
        let [least, greatest] = self.force;
        let [softest, stiffest] = self.stiffness;
        let (gain_e, gain_ee, product_e) = (gain[(0, 1)], gain[(1, 1)], product[1]);
        let (gain, product) = (gain[(0, 0)], product[0]);
        let determinant = gain * gain_ee - gain_e * gain_e;
        if determinant > SINGULAR * gain * gain_ee {
            let found =
                Vector2::new(gain_ee * product - gain_e * product_e, gain * product_e - gain_e * product)
                    / determinant;
            if self.contain(&found) {
                return found;
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
        let slope = |number: &Vector2<f64>| {
            let (force, stiffness) = (number[0], number[1]);
            force * (force * gain - 2.0 * product)
                + stiffness * (stiffness * gain_ee - 2.0 * product_e)
                + 2.0 * force * stiffness * gain_e
        };
        let edges = [
            Vector2::new(least, stiffness_at(least)),
            Vector2::new(greatest, stiffness_at(greatest)),
            Vector2::new(force_at(softest), softest),
            Vector2::new(force_at(stiffest), stiffest),
        ];
        let better = |best: Vector2<f64>, other: Vector2<f64>| {
            if slope(&other) < slope(&best) {
                other
            } else {
                best
            }
        };
        edges.into_iter().fold(Vector2::new(least, softest), better)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRIOR: Prior = Prior { force: [1.0, 100.0], stiffness: [3e2, 3e4] };

    fn one(fit: &NormalFit) -> SeveralPushes<1> {
        let NormalFit { gain, product, target, penalty } = *fit;
        SeveralPushes { gain: [[gain]], product: [product], target, penalty }
    }

    fn measured(force: f64, stiffness: f64) -> Sums<1> {
        let mut sums = Sums::NONE;
        for k in 0..12 {
            let (deeper, gain) = (2e-3 * (0.9 * f64::from(k)).sin(), 1.0 + 0.1 * f64::from(k));
            let torque = force + stiffness * deeper;
            let fit = NormalFit {
                gain,
                product: gain * torque,
                target: gain * torque * torque + 2.0,
                penalty: 0.0,
            };
            sums.add(1.0, &Sums::along(&one(&fit), &[deeper]));
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
                let misfit = sums.target - 2.0 * (f * sums.product[0][0] + k * sums.product[0][1])
                    + f * f * sums.gain[0][0][(0, 0)]
                    + 2.0 * f * k * sums.gain[0][0][(0, 1)]
                    + k * k * sums.gain[0][0][(1, 1)];
                total += (-0.5 * misfit).exp() / (steps * steps) as f64;
            }
            assert!((found.log - total.ln()).abs() < 0.5, "{found:?} {}", total.ln());
            assert!((found.force[0] / force - 1.0).abs() < 0.05, "{found:?}");
            assert!((found.stiffness[0] / stiffness).ln().abs() < 0.3, "{found:?}");
        }
    }

    #[test]
    fn what_was_added_can_be_taken_away() {
        let fit = NormalFit { gain: 3.0, product: 2.0, target: 7.0, penalty: 0.1 };
        let mut sums = measured(10.0, 1000.0);
        let before = PRIOR.integrate(&sums);
        sums.add(1.0, &Sums::along(&one(&fit), &[1e-3]));
        assert!(PRIOR.integrate(&sums).log < before.log);
        sums.add(-1.0, &Sums::along(&one(&fit), &[1e-3]));
        assert!((PRIOR.integrate(&sums).log - before.log).abs() < 1e-9);
        assert_eq!(PRIOR.integrate(&Sums::<1>::NONE).log, 0.0);
    }

    /// Two contacts that share joints.
    fn of_two_contacts(forces: [f64; 2], stiffnesses: [f64; 2]) -> Sums<2> {
        let mut sums = Sums::NONE;
        for k in 0..12 {
            let deeper = [2e-3 * (0.9 * f64::from(k)).sin(), 3e-3 * (1.7 * f64::from(k)).cos()];
            let gain = [[1.0 + 0.1 * f64::from(k), 0.6], [0.6, 2.0]];
            let torque: [f64; 2] = std::array::from_fn(|i| forces[i] + stiffnesses[i] * deeper[i]);
            let product = std::array::from_fn(|i| gain[i][0] * torque[0] + gain[i][1] * torque[1]);
            let target = product[0] * torque[0] + product[1] * torque[1] + 2.0;
            let pushes = SeveralPushes { gain, product, target, penalty: 0.0 };
            sums.add(1.0, &Sums::along(&pushes, &deeper));
        }
        sums
    }

    #[test]
    fn sums_of_what_was_never_added_tell_nothing() {
        let fit = |gain: f64, product: f64| SeveralPushes {
            gain: [[gain]],
            product: [product],
            target: 100.0,
            penalty: 0.0,
        };
        let mut sums = Sums::<1>::NONE;
        sums.add(1.0, &Sums::along(&fit(1.0, 10.0), &[0.0]));
        sums.add(1.0, &Sums::along(&fit(1.0, 10.0), &[1e-3]));
        assert!(PRIOR.integrate(&sums).log > -20.0);
        // The same measurement, but not as it was added.
        sums.add(-1.0, &Sums::along(&fit(4.0, -5.0), &[2e-3]));
        assert_eq!(PRIOR.integrate(&sums).log, f64::NEG_INFINITY);
        assert_eq!(PRIOR.most(&sums, 14.0), f64::NEG_INFINITY);
    }

    #[test]
    fn forces_and_stiffnesses_of_two_contacts_are_found_also_at_the_ends_of_their_ranges() {
        let found = PRIOR.integrate(&of_two_contacts([12.0, 30.0], [2500.0, 800.0]));
        assert!((found.misfit - 24.0).abs() < 1e-6, "{found:?}");
        assert!(
            (found.force[0] - 12.0).abs() < 1e-6 && (found.stiffness[1] - 800.0).abs() < 1e-4,
            "{found:?}"
        );
        // A stiffness below the least; a force above the greatest.
        assert_eq!(PRIOR.integrate(&of_two_contacts([12.0, 30.0], [100.0, 800.0])).stiffness[0], 300.0);
        let sums = of_two_contacts([12.0, 130.0], [2500.0, 800.0]);
        let found = PRIOR.integrate(&sums);
        assert_eq!(found.force[1], 100.0);
        // Nothing within the ranges explains more.
        let numbers: [Vector2<f64>; 2] =
            std::array::from_fn(|i| Vector2::new(found.force[i], found.stiffness[i]));
        for (i, a, step) in
            [(0, 0, 0.01), (0, 0, -0.01), (0, 1, 5.0), (1, 0, -0.01), (1, 1, 5.0), (1, 1, -5.0)]
        {
            let mut other = numbers;
            other[i][a] += step;
            if PRIOR.contain(&other[i]) {
                assert!(sums.misfit(&other) >= found.misfit - 1e-6, "{i} {a} {step} {found:?}");
            }
        }
        // The order of contacts is no matter.
        let mut turned = sums;
        turned.reorder(&[1, 0]);
        let other = PRIOR.integrate(&turned);
        assert!((other.log - found.log).abs() < 1e-6 && other.force[0] == found.force[1]);
    }

    #[test]
    fn contacts_that_share_no_joints_are_independent() {
        let fit = |k: u32, scale: f64| {
            let (deeper, gain) = (scale * 2e-3 * (0.9 * f64::from(k)).sin(), 1.0 + 0.1 * f64::from(k));
            let product = gain * (10.0 * scale + 2000.0 * deeper);
            (gain, product, deeper)
        };
        let (mut both, mut first, mut second) = (Sums::<2>::NONE, Sums::<1>::NONE, Sums::<1>::NONE);
        for k in 0..12 {
            let [(gain, product, deeper), other] = [fit(k, 1.0), fit(k, 2.0)];
            let target = product * product / gain + other.1 * other.1 / other.0;
            let one = |gain: f64, product: f64| SeveralPushes {
                gain: [[gain]],
                product: [product],
                target: product * product / gain,
                penalty: 0.0,
            };
            first.add(1.0, &Sums::along(&one(gain, product), &[deeper]));
            second.add(1.0, &Sums::along(&one(other.0, other.1), &[other.2]));
            let gain = [[gain, 0.0], [0.0, other.0]];
            let pushes = SeveralPushes { gain, product: [product, other.1], target, penalty: 0.0 };
            both.add(1.0, &Sums::along(&pushes, &[deeper, other.2]));
        }
        let alone = PRIOR.integrate(&first).log + PRIOR.integrate(&second).log;
        assert!((PRIOR.integrate(&both).log - alone).abs() < 1e-6 * alone.abs());
    }
}
