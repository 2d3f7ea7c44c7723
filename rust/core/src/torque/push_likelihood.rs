//! How much likelier a torque is under a contact at a point of the surface than without one, whatever the contact's force
//! (algorithm D4): several points at once.

use nalgebra::{Matrix3, Vector3};
use wide::f64x4;

use super::force_model::{directions, ForceModel, NO_FRICTION};
use super::frames::Frame;
use super::link_target::LinkTarget;
use super::place_step::PlaceStep;

/// Points that are worked on at once.
pub(crate) const LANES: usize = 4;
/// The standard deviation of the force across the normal depends on the normal force: so often it is set by the force found.
const PASSES: usize = 2;
/// A point that no torque shows has a gain of zero, by which nothing is divided.
const LEAST_GAIN: f64 = 1e-30;

type Lanes3 = [f64x4; 3];

/// Pieces of one link's surface, in its frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlaceBlock {
    point: Lanes3,
    /// Inward normal, and two directions across it.
    directions: [Lanes3; 3],
    /// Of a contact's distance from the point along each of these two (m^2).
    variance: f64x4,
}

/// A contact anywhere on a piece of surface of edge s is taken as a normal distribution about its middle with this times s as
/// standard deviation in each direction: such distributions a distance s apart sum up to an even one but for a tenth.
pub(crate) const PIECE: f64 = 0.45;

impl PlaceBlock {
    /// Of points, outward normals, and areas (m^2).
    pub fn new(pieces: &[(Vector3<f64>, Vector3<f64>, f64); LANES]) -> Self {
        let lanes = |value: &dyn Fn(usize) -> f64| f64x4::new(std::array::from_fn(value));
        let directions = pieces.map(|(_, normal, _)| directions(&normal));
        PlaceBlock {
            point: std::array::from_fn(|axis| lanes(&|k| pieces[k].0[axis])),
            directions: std::array::from_fn(|which| {
                std::array::from_fn(|axis| lanes(&|k| directions[k][which][axis]))
            }),
            variance: lanes(&|k| PIECE * PIECE * pieces[k].2),
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

    /// The same friction as a cone.
    pub fn force_model(&self) -> ForceModel {
        ForceModel::FrictionCone(2.0 * self.slack)
    }

    /// Standard deviations of a normal force of this size, and of each force across the normal beside it (N): to first order,
    /// the former is the force times the standard deviation of its logarithm.
    pub fn deviations(&self, force: f64) -> [f64; 2] {
        let [least, greatest] = self.range;
        [force * (greatest / least).ln() / 12.0_f64.sqrt(), force * self.slack]
    }
}

/// What a torque says of contacts on some pieces: of one that pushes there, and of one that pulls.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PushLikelihood {
    /// Logarithm of the likelihood with a contact there, over that without contact.
    pub log: [[f64; LANES]; 2],
    /// Size of the normal force that explains the torque best (N).
    pub force: [[f64; LANES]; 2],
}

impl PushLikelihood {
    /// The same logarithm everywhere, and no force.
    pub fn none(log: f64) -> Self {
        PushLikelihood { log: [[log; LANES]; 2], force: [[0.0; LANES]; 2] }
    }
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
    /// What a torque says of how far a contact moves that pushes or pulls at a point of a link: takes it into `step`, as `share`
    /// of a measurement.
    #[inline]
    pub fn add_to(&self, step: &mut PlaceStep, frame: &Frame, target: &LinkTarget, pulls: bool, share: f64) {
        step.take_in(frame, target, if pulls { -1.0 } else { 1.0 }, self.slack, share);
    }

    /// For a block of pieces on one link. The force across the normal and the place on the piece are integrated out as Gaussians,
    /// the latter for the force that is likeliest in the middle; the normal force by Laplace's method.
    #[inline]
    pub fn likelihood(&self, frame: &Frame, target: &LinkTarget, block: &PlaceBlock) -> PushLikelihood {
        let part = |row, column| frame.gram.fixed_view::<3, 3>(row, column).into_owned();
        let (linear, mixed, angular) = (part(0, 0), part(0, 3), part(3, 3));
        let point = &block.point;
        // K = [1; [p]x]' gram [1; [p]x]: what a force at the point does.
        let beside = cross_splat(&mixed, point);
        let turned = cross_splat(&angular, point);
        let gram: [Lanes3; 3] = std::array::from_fn(|row| {
            std::array::from_fn(|column| {
                // [p]x' M, by columns of M = angular [p]x.
                let [a, b] = [(row + 1) % 3, (row + 2) % 3];
                let moment = point[b] * turned[a][column] - point[a] * turned[b][column];
                beside[row][column] + beside[column][row] + moment + linear[(row, column)]
            })
        });
        let [force, moment] = [target.product.fixed_rows::<3>(0), target.product.fixed_rows::<3>(3)];
        let product: Lanes3 = std::array::from_fn(|axis| {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            // moment x point.
            point[b] * moment[a] - point[a] * moment[b] + force[axis]
        });
        let applied = block.directions.map(|direction| gram.map(|row| dot(&row, &direction)));
        let mut forces = Forces {
            gram: std::array::from_fn(|a| std::array::from_fn(|b| dot(&block.directions[a], &applied[b]))),
            product: block.directions.map(|direction| dot(&direction, &product)),
        };
        let alone = forces.product[0] / (forces.gram[0][0] + f64x4::splat(LEAST_GAIN));
        let best = self.best_force(&forces, alone);
        let [first, second] = moments(&block.directions, &best.force);
        // What these moments do, and together with a force at the point.
        let alone = [first, second].map(|moment| times(&angular, &moment));
        let with_force = [first, second].map(|moment| -> Lanes3 {
            std::array::from_fn(|row| {
                let mixed =
                    moment[0] * mixed[(row, 0)] + moment[1] * mixed[(row, 1)] + moment[2] * mixed[(row, 2)];
                mixed + turned[0][row] * moment[0] + turned[1][row] * moment[1] + turned[2][row] * moment[2]
            })
        });
        let one = f64x4::splat(1.0);
        // In standard deviations of the displacement.
        let scale = block.variance.sqrt();
        let (g11, g22) =
            (dot(&first, &alone[0]) * block.variance + one, dot(&second, &alone[1]) * block.variance + one);
        let g12 = dot(&first, &alone[1]) * block.variance;
        let [h1, h2] =
            [first, second].map(|m| (m[0] * moment[0] + m[1] * moment[1] + m[2] * moment[2]) * scale);
        let [c1, c2] = with_force.map(|row| block.directions.map(|direction| dot(&direction, &row) * scale));
        // At least one, and nothing explains more than all, but for rounding.
        let determinant = (g11 * g22 - g12 * g12).max(one);
        let all = f64x4::splat(target.squared);
        let inverse = one / determinant;
        let solve = |a: f64x4, b: f64x4| ((g22 * a - g12 * b) * inverse, (g11 * b - g12 * a) * inverse);
        let by_place = solve(h1, h2);
        let place_explains = h1 * by_place.0 + h2 * by_place.1;
        for a in 0..3 {
            let share = solve(c1[a], c2[a]);
            for b in a..3 {
                let left = forces.gram[a][b] - c1[b] * share.0 - c2[b] * share.1;
                (forces.gram[a][b], forces.gram[b][a]) = (left, left);
            }
            forces.product[a] = forces.product[a] - c1[a] * by_place.0 - c2[a] * by_place.1;
        }
        let found = self.best_force(&forces, best.size);
        let [least, greatest] = self.range;
        let spread = (greatest / least).ln();
        let side = |force: f64x4, sign: f64, log_prior: f64| {
            let width = force * spread;
            let turn = f64x4::splat(std::f64::consts::TAU);
            let volume = turn / ((found.left * width * width + turn) * found.freedom * determinant);
            let explained =
                place_explains + found.explained + force * (found.shown * (2.0 * sign) - force * found.left);
            (explained.min(all) + volume.ln()) * 0.5 + log_prior
        };
        let force = found.shown / found.left;
        let (push, pull) = (self.bound(force), self.bound(-force));
        PushLikelihood {
            log: [side(push, 1.0, self.log_push).to_array(), side(pull, -1.0, self.log_pull).to_array()],
            force: [push.to_array(), pull.to_array()],
        }
    }

    fn bound(&self, force: f64x4) -> f64x4 {
        let [least, greatest] = self.range.map(f64x4::splat);
        force.max(least).min(greatest)
    }

    /// The likeliest force along the inward normal, and across it: its standard deviation there follows from the normal force,
    /// which is `rough` to begin with (N).
    #[inline(always)]
    fn best_force(&self, forces: &Forces, rough: f64x4) -> Best {
        let Forces { gram, product: [along, beside_1, beside_2] } = *forces;
        let tiny = f64x4::splat(LEAST_GAIN);
        let mut size = self.bound(rough.abs());
        let mut best = Best::none();
        for _ in 0..PASSES {
            let deviation = size * self.slack;
            let precision =
                (f64x4::splat(1.0) / (deviation * deviation + tiny)).min(f64x4::splat(NO_FRICTION));
            let (one, two, both) = (gram[1][1] + precision, gram[2][2] + precision, gram[1][2]);
            let determinant = one * two - both * both;
            let inverse = f64x4::splat(1.0) / determinant;
            let solve = |a: f64x4, b: f64x4| ((two * a - both * b) * inverse, (one * b - both * a) * inverse);
            let of_unit = solve(gram[0][1], gram[0][2]);
            let of_target = solve(beside_1, beside_2);
            best.left = (gram[0][0] - gram[0][1] * of_unit.0 - gram[0][2] * of_unit.1).max(tiny);
            best.shown = along - gram[0][1] * of_target.0 - gram[0][2] * of_target.1;
            best.explained = beside_1 * of_target.0 + beside_2 * of_target.1;
            best.freedom = determinant / (precision * precision);
            // Where next to no torque shows a force it would be without bound.
            let greatest = f64x4::splat(self.range[1]);
            let normal = (best.shown / best.left).max(-greatest).min(greatest);
            best.force = [normal, of_target.0 - of_unit.0 * normal, of_target.1 - of_unit.1 * normal];
            size = self.bound(normal.abs());
        }
        best.size = size;
        best
    }
}

/// What forces along a piece's three directions do: products of their torques with each other and with the target's.
#[derive(Clone, Copy)]
struct Forces {
    gram: [Lanes3; 3],
    product: Lanes3,
}

/// A normal force, with the force across the normal integrated out.
#[derive(Clone, Copy)]
struct Best {
    /// Along the three directions (N).
    force: Lanes3,
    /// Of the normal force, between the prior's limits (N).
    size: f64x4,
    /// Squared norm of the torque of a unit of normal force, and its product with the target, but for what friction explains.
    left: f64x4,
    shown: f64x4,
    /// By friction, of the target's squared norm.
    explained: f64x4,
    /// What the freedom of friction costs: the square of a factor of the likelihood.
    freedom: f64x4,
}

impl Best {
    fn none() -> Self {
        let zero = f64x4::splat(0.0);
        Best { force: [zero; 3], size: zero, left: zero, shown: zero, explained: zero, freedom: zero }
    }
}

/// The moments, in the link's frame, by which a force along three directions changes where its point moves by a metre along the
/// second and the third.
#[inline]
fn moments(directions: &[Lanes3; 3], force: &Lanes3) -> [Lanes3; 2] {
    let [inward, first, second] = directions;
    // second x inward = -first, inward x first = -second, first x second = -inward.
    let along = |axis: &Lanes3, other: &Lanes3, of_axis: f64x4, of_other: f64x4| -> Lanes3 {
        std::array::from_fn(|k| axis[k] * of_axis + other[k] * of_other)
    };
    [along(second, inward, force[0], -force[2]), along(first, inward, -force[0], force[1])]
}

#[inline]
fn times(matrix: &Matrix3<f64>, vector: &Lanes3) -> Lanes3 {
    std::array::from_fn(|row| {
        vector[0] * matrix[(row, 0)] + vector[1] * matrix[(row, 1)] + vector[2] * matrix[(row, 2)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Kinematics, Robot};
    use crate::torque::{Frames, PlaceStep, Target};

    const LINK: usize = 6;
    const Q: [f64; 7] = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0];
    const DEVIATION: [f64; 7] = [0.05; 7];
    const PRIOR: [f64; 2] = [2.0, 300.0];

    fn measured(force: &Vector3<f64>, point: &Vector3<f64>) -> (Frames, Target) {
        let robot = Robot::example_arm();
        let mut kinematics = Kinematics::new(&robot);
        kinematics.set_configuration(&robot, &Q);
        let mut frames = Frames::new(&robot, vec![LINK]);
        frames.update(&robot, &kinematics, &DEVIATION);
        let mut torque = [0.0; 7];
        frames.subtract(LINK, point, &-force, &DEVIATION, &mut torque);
        // Errors of about one standard deviation.
        torque.iter_mut().enumerate().for_each(|(k, torque)| *torque += 0.05 * (1.7 * k as f64).sin());
        let mut target = Target::new(&frames);
        target.set(&frames, &torque, &DEVIATION);
        (frames, target)
    }

    /// A flat piece of surface, its outward normal, and a point off its middle where the contact is.
    fn piece() -> (Vector3<f64>, Vector3<f64>, Vector3<f64>) {
        let (middle, normal) = (Vector3::new(0.05, 0.01, 0.1), Vector3::new(1.0, 0.2, -0.1).normalize());
        let [_, first, second] = directions(&normal);
        (middle, normal, middle + first * 0.006 - second * 0.004)
    }

    #[test]
    fn a_piece_is_as_likely_as_the_points_on_it_together() {
        let (middle, normal, contact) = piece();
        let (frames, target) = measured(&(normal * -20.0 + directions(&normal)[1] * 3.0), &contact);
        let prior = ForcePrior::new(0.5, PRIOR, 0.05);
        let of = |point: Vector3<f64>, area: f64| {
            let block = PlaceBlock::new(&[(point, normal, area); LANES]);
            prior.likelihood(&frames.links[LINK], target.on(LINK), &block)
        };
        for edge in [0.005, 0.02, 0.04] {
            let found = of(middle, edge * edge);
            // Points on a grid, weighed as the piece's normal distribution.
            let [_, first, second] = directions(&normal);
            let (steps, reach) = (60, 4.0);
            let offset = |k: i32| reach * f64::from(2 * k - steps) / f64::from(steps);
            let (mut sum, mut total) = (0.0, 0.0);
            for (i, j) in (0..=steps).flat_map(|i| (0..=steps).map(move |j| (i, j))) {
                let (a, b) = (offset(i), offset(j));
                let weight = (-0.5 * (a * a + b * b)).exp();
                let point = middle + (first * a + second * b) * (PIECE * edge);
                sum += weight * (of(point, 0.0).log[0][0] - found.log[0][0]).exp();
                total += weight;
            }
            let error = (sum / total).ln();
            assert!(error.abs() < 0.15, "edge {edge}: {error}");
        }
    }

    /// All normals of a capsule pass its axis: but for rounding no torque shows a force along them.
    #[test]
    fn no_contact_explains_more_than_the_torques_there_are() {
        let robot = Robot::example_arm();
        let mut kinematics = Kinematics::new(&robot);
        kinematics.set_configuration(&robot, &[8e-4, 6e-4, 0.6, -2.3, -0.4, -0.7, 0.5]);
        let (mut frames, deviation) = (Frames::new(&robot, (0..7).collect()), [0.1; 7]);
        frames.update(&robot, &kinematics, &deviation);
        let mut target = Target::new(&frames);
        target.set(&frames, &[22.6, 0.35, -1.2, -0.1, -0.2, 0.3, 0.5], &deviation);
        let prior = ForcePrior::new(0.0, PRIOR, 0.05);
        for (link, k) in (0..7).flat_map(|link| (0..200).map(move |k| (link, f64::from(k)))) {
            let normal = Vector3::new((0.1 * k).cos(), (0.1 * k).sin(), 0.0);
            let point = normal * 0.05 + Vector3::z() * (0.0015 * k);
            let block = PlaceBlock::new(&[(point, normal, 1e-4); LANES]);
            let found = prior.likelihood(&frames.links[link], target.on(link), &block);
            let most = 0.5 * target.on(link).squared;
            assert!(found.log.iter().flatten().all(|log| log.is_finite() && *log <= most), "{:?}", found.log);
            assert!(found.force.iter().flatten().all(|force| (PRIOR[0]..=PRIOR[1]).contains(force)));
        }
    }

    #[test]
    fn a_step_leads_to_where_the_torques_are_likeliest() {
        let (middle, normal, contact) = piece();
        let (frames, target) = measured(&(normal * -20.0), &contact);
        let prior = ForcePrior::new(0.5, PRIOR, 0.05);
        let at = |point: &Vector3<f64>| {
            let block = PlaceBlock::new(&[(*point, normal, 0.0); LANES]);
            prior.likelihood(&frames.links[LINK], target.on(LINK), &block).log[0][0]
        };
        let mut point = middle;
        for _ in 0..3 {
            let mut step = PlaceStep::at(&point, &normal);
            prior.add_to(&mut step, &frames.links[LINK], target.on(LINK), false, 1.0);
            point += step.displacement(1.0).expect("a number");
        }
        let [_, first, second] = directions(&normal);
        assert!(at(&point) > at(&middle));
        for aside in [first, -first, second, -second] {
            assert!(at(&point) > at(&(point + aside * 0.01)));
        }
        // Nothing pulls there.
        let mut step = PlaceStep::at(&point, &normal);
        prior.add_to(&mut step, &frames.links[LINK], target.on(LINK), true, 1.0);
        assert_eq!(step.displacement(1.0), Some(Vector3::zeros()));
        assert!((step.spread(0.01) - 0.01 * 2f64.sqrt()).abs() < 1e-12);
    }
}
