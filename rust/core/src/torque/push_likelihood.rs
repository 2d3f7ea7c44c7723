//! How much likelier a torque is under a contact at a point of the surface than without one, whatever the contact's force
//! (algorithm D4): several points at once.

use nalgebra::{Matrix3, Vector3};
use wide::f64x4;

use super::force_model::directions;
use super::frames::Frame;
use super::link_target::LinkTarget;

/// Points that are worked on at once.
pub(crate) const LANES: usize = 4;
/// The standard deviation of the force across the normal depends on the normal force: so often it is set by the force found.
const PASSES: usize = 3;
/// A point that no torque shows has a gain of zero, by which nothing is divided.
const LEAST_GAIN: f64 = 1e-30;
/// Precision of the force across the normal where there is no friction (1/N^2).
const NO_FRICTION: f64 = 1e24;

type Lanes3 = [f64x4; 3];

/// Points of one link's surface, in its frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlaceBlock {
    point: Lanes3,
    /// Inward normal, and two directions across it.
    directions: [Lanes3; 3],
}

impl PlaceBlock {
    /// Of points and outward normals.
    pub fn new(places: &[(Vector3<f64>, Vector3<f64>); LANES]) -> Self {
        let lanes = |value: &dyn Fn(usize) -> f64| f64x4::new(std::array::from_fn(value));
        let directions = places.map(|(_, normal)| directions(&normal));
        PlaceBlock {
            point: std::array::from_fn(|axis| lanes(&|k| places[k].0[axis])),
            directions: std::array::from_fn(|which| {
                std::array::from_fn(|axis| lanes(&|k| directions[k][which][axis]))
            }),
        }
    }
}

/// What is known of a contact's force beforehand.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForcePrior {
    /// Standard deviation of each force across the normal, as a share of the normal force.
    slack: f64,
    /// The normal force lies between these, its logarithm uniform (N).
    range: [f64; 2],
    log_push: f64,
    log_pull: f64,
}

impl ForcePrior {
    /// A coefficient of friction, the least and the greatest force (N), and the probability that a contact pulls.
    pub fn new(friction: f64, range: [f64; 2], pull_probability: f64) -> Self {
        ForcePrior {
            slack: 0.5 * friction,
            range,
            log_push: (1.0 - pull_probability).ln(),
            log_pull: pull_probability.ln(),
        }
    }

    /// Standard deviations of a normal force of this size, and of each force across the normal beside it (N): to first order,
    /// the former is the force times the standard deviation of its logarithm.
    pub fn deviations(&self, force: f64) -> [f64; 2] {
        let [least, greatest] = self.range;
        [force * (greatest / least).ln() / 12.0_f64.sqrt(), force * self.slack]
    }
}

/// What a torque says of contacts at some points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PushLikelihood {
    /// Logarithm of the likelihood with a contact there that pushes, over that without contact; and with one that pulls.
    pub log_push: [f64; LANES],
    pub log_pull: [f64; LANES],
    /// Force into the surface and out of it that explains the torque best (N).
    pub push: [f64; LANES],
    pub pull: [f64; LANES],
}

#[inline]
fn cross_splat(columns: &Matrix3<f64>, arm: &Lanes3) -> [Lanes3; 3] {
    // M [arm]x, row by row: (row x arm), as row . (arm x e) = (row x arm) . e.
    std::array::from_fn(|row| {
        let [x, y, z] = [columns[(row, 0)], columns[(row, 1)], columns[(row, 2)]];
        [arm[2] * y - arm[1] * z, arm[0] * z - arm[2] * x, arm[1] * x - arm[0] * y]
    })
}

#[inline]
fn dot(a: &Lanes3, b: &Lanes3) -> f64x4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl ForcePrior {
    /// For a block of points on one link. The force across the normal is integrated out as a Gaussian; the normal force by
    /// Laplace's method.
    #[inline]
    pub fn likelihood(&self, frame: &Frame, target: &LinkTarget, block: &PlaceBlock) -> PushLikelihood {
        let part = |row, column| frame.gram.fixed_view::<3, 3>(row, column).into_owned();
        let (linear, mixed, angular) = (part(0, 0), part(0, 3), part(3, 3));
        let point = &block.point;
        // K = [1; [p]x]' gram [1; [p]x]: what a force at the point does.
        let mixed = cross_splat(&mixed, point);
        let turned = cross_splat(&angular, point);
        let gram: [Lanes3; 3] = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                // [p]x' M, by columns of M = angular [p]x.
                let [a, b] = [(row + 1) % 3, (row + 2) % 3];
                let moment = point[b] * turned[a][column] - point[a] * turned[b][column];
                mixed[row][column] + mixed[column][row] + moment + linear[(row, column)]
            })
        });
        let [force, moment] = [target.product.fixed_rows::<3>(0), target.product.fixed_rows::<3>(3)];
        let product: Lanes3 = std::array::from_fn(|axis| {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            // moment x point.
            point[b] * moment[a] - point[a] * moment[b] + force[axis]
        });
        let applied = block.directions.map(|direction| gram.map(|row| dot(&row, &direction)));
        let of = |a: usize, b: usize| dot(&block.directions[a], &applied[b]);
        let (gain, first, second) = (of(0, 0), of(1, 0), of(2, 0));
        let (across_1, across_2, across_12) = (of(1, 1), of(2, 2), of(1, 2));
        let [along, beside_1, beside_2] = block.directions.map(|direction| dot(&direction, &product));

        let [least, greatest] = self.range.map(f64x4::splat);
        let bound = |force: f64x4| force.max(least).min(greatest);
        let tiny = f64x4::splat(LEAST_GAIN);
        let mut size = bound((along / (gain + tiny)).abs());
        let (mut precision, mut determinant) = (tiny, tiny);
        let (mut left, mut shown, mut explained) = (gain, along, f64x4::splat(0.0));
        for _ in 0..PASSES {
            let deviation = size * self.slack;
            precision = (f64x4::splat(1.0) / (deviation * deviation + tiny)).min(f64x4::splat(NO_FRICTION));
            let (one, two) = (across_1 + precision, across_2 + precision);
            determinant = one * two - across_12 * across_12;
            let inverse = f64x4::splat(1.0) / determinant;
            let solve = |a: f64x4, b: f64x4| {
                ((two * a - across_12 * b) * inverse, (one * b - across_12 * a) * inverse)
            };
            let (of_unit_1, of_unit_2) = solve(first, second);
            let (of_target_1, of_target_2) = solve(beside_1, beside_2);
            left = (gain - first * of_unit_1 - second * of_unit_2).max(tiny);
            shown = along - first * of_target_1 - second * of_target_2;
            explained = beside_1 * of_target_1 + beside_2 * of_target_2;
            size = bound((shown / left).abs());
        }
        let spread = (greatest / least).ln();
        let freedom = determinant / (precision * precision);
        let best = shown / left;
        let side = |force: f64x4, sign: f64, log_prior: f64| {
            let width = force * spread;
            let turn = f64x4::splat(std::f64::consts::TAU);
            let volume = turn / ((left * width * width + turn) * freedom);
            (explained + force * (shown * (2.0 * sign) - force * left) + volume.ln()) * 0.5 + log_prior
        };
        let (push, pull) = (bound(best), bound(-best));
        PushLikelihood {
            log_push: side(push, 1.0, self.log_push).to_array(),
            log_pull: side(pull, -1.0, self.log_pull).to_array(),
            push: push.to_array(),
            pull: pull.to_array(),
        }
    }
}
