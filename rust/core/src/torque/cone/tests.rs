use nalgebra::{Matrix3, Matrix5x3, Rotation2, Vector3, Vector5};
use proptest::prelude::*;

use super::{best_cone_force, ConeForce, ConePart};
use crate::math::random::Stream;

const FRICTIONS: [f64; 6] = [0.0, 1e-6, 0.1, 0.5, 1.0, 2.0];
const KINDS: u64 = 8;

#[derive(Debug)]
struct Problem {
    gram: Matrix3<f64>,
    products: Vector3<f64>,
    friction: f64,
}

impl Problem {
    /// Problem `number` of random ones, most of which are degenerate in some way.
    fn random(number: u64) -> Problem {
        let stream = Stream::new(7).fork(number);
        let normal = |k: u64| stream.normals(2 * k)[0];
        let share = |k: u64| stream.uniform(200 + k);
        let friction = FRICTIONS[(share(0) * FRICTIONS.len() as f64) as usize];
        let mut torques = Matrix5x3::from_fn(|i, j| normal((3 * i + j) as u64));
        let mut measured = Vector5::from_fn(|i, _| normal(20 + i as u64));
        let [first, second] = [normal(30), normal(31)];
        match number % KINDS {
            // Of rank two, one and zero.
            1 => torques.set_column(2, &(torques.column(0) * first + torques.column(1) * second)),
            2 => {
                torques.set_column(1, &(torques.column(0) * first));
                torques.set_column(2, &(torques.column(0) * second));
            }
            3 if share(1) < 0.1 => torques.fill(0.0),
            // The normal force is not felt.
            3 => torques.column_mut(0).fill(0.0),
            // Gains that differ by up to 1e10.
            4 => {
                let svd = torques.svd(true, true);
                let values = Vector3::new(1.0, 10_f64.powf(-2.5 * share(1)), 10_f64.powf(-5.0 * share(2)));
                torques = svd.u.unwrap() * Matrix3::from_diagonal(&values) * svd.v_t.unwrap();
            }
            // Of a pull.
            5 => measured = torques * Vector3::new(-1.0, 0.3 * first, 0.3 * second),
            // Whole numbers: exact zeros, ties and borders.
            6 => (torques, measured) = (torques.map(f64::round), measured.map(f64::round)),
            _ => {}
        }
        let mut products = torques.tr_mul(&measured);
        if number % KINDS == 7 {
            // Close to where no force is best.
            let across = products[1].hypot(products[2]);
            products[0] = -friction * across * (1.0 - 10_f64.powf(-12.0 * share(1)));
        }
        Problem { gram: torques.tr_mul(&torques), products, friction }
    }

    fn solve(&self) -> ConeForce {
        best_cone_force(&self.gram, &self.products, self.friction)
    }

    fn objective(&self, force: &Vector3<f64>) -> f64 {
        force.dot(&(self.gram * force * 0.5 - self.products))
    }

    /// The size of the terms of the objective, to which rounding errors compare.
    fn scale(&self, force: &Vector3<f64>) -> f64 {
        let torques = self.gram.diagonal().map(f64::sqrt).component_mul(force).abs().sum();
        torques * torques + self.products.component_mul(force).abs().sum()
    }
}

#[test]
fn forces_are_optimal_by_their_slopes() {
    let mut parts = [0; 3];
    for number in 0..20_000 {
        let problem = Problem::random(number);
        let found = problem.solve();
        let ConeForce { force, objective, part } = found;
        let Problem { gram, products, friction } = &problem;
        parts[part as usize] += 1;
        let across = force[1].hypot(force[2]);
        assert!(across <= friction * force[0] * (1.0 + 1e-12), "{number}: {problem:?} {found:?}");
        // A convex function is least where its slope is in the dual cone and perpendicular to the force.
        let slope = gram * force - products;
        let outside = (friction * slope[1].hypot(slope[2]) - slope[0]).max(0.0);
        let excess = slope.dot(&force).abs() + outside * force[0];
        let scale = problem.scale(&force);
        assert!(excess <= 1e-9 * scale, "{number}: {excess} of {scale}, {problem:?} {found:?}");
        assert!((objective - problem.objective(&force)).abs() <= 1e-12 * scale, "{number}");
        match part {
            ConePart::Apex => {
                assert_eq!(force, Vector3::zeros());
                let torque = products[0] + friction * products[1].hypot(products[2]);
                assert!(torque <= 1e-12 * products.norm(), "{number}: {problem:?}");
            }
            ConePart::Interior => assert!(slope.component_mul(&force).abs().sum() <= 1e-9 * scale),
            ConePart::Boundary => assert!(across >= friction * force[0] * (1.0 - 1e-12)),
        }
    }
    assert!(parts.iter().all(|&count| count > 1_000), "{parts:?}");
}

#[test]
fn no_force_of_a_grid_is_better() {
    const ANGLES: usize = 360;
    const RADII: usize = 24;
    for number in 0..400 {
        let problem = Problem::random(number);
        let ConeForce { force, objective, .. } = problem.solve();
        let mut best = 0.0_f64;
        for k in 0..ANGLES * RADII {
            let (sin, cos) = (std::f64::consts::TAU * (k % ANGLES) as f64 / ANGLES as f64).sin_cos();
            let radius = problem.friction * (k / ANGLES) as f64 / (RADII - 1) as f64;
            let direction = Vector3::new(1.0, radius * cos, radius * sin);
            let (gain, product) =
                (direction.dot(&(problem.gram * direction)), problem.products.dot(&direction));
            // Rays that torques hardly show explain rounding errors.
            if product > 0.0 && gain > 1e-9 * problem.gram.diagonal().max() * direction.norm_squared() {
                best = best.min(-0.5 * product * product / gain);
            }
        }
        let rounding = 1e-9 * problem.scale(&force);
        assert!(objective <= best + rounding, "{number}: {objective}, grid {best}");
        // Where gains are alike, the grid is close.
        if number % KINDS == 0 {
            assert!(objective >= 1.02 * best - rounding, "{number}: {objective}, grid {best}");
        }
    }
}

#[test]
fn of_forces_that_explain_as_much_the_smallest_is_found() {
    for number in 0..2_000 {
        let stream = Stream::new(8).fork(number);
        let [[normal, x], [y, size]] = [stream.normals(0), stream.normals(2)];
        let friction = 2.0 * stream.uniform(4);
        // A joint shows one component, so that all forces with this component explain the same.
        let shown = Vector3::new(normal, x, y);
        let found = best_cone_force(&(shown * shown.transpose()), &(shown * size), friction);
        let smallest = shown * (size / shown.norm_squared());
        let across = smallest[1].hypot(smallest[2]);
        let expected = if across <= friction * smallest[0] {
            (smallest, ConePart::Interior)
        } else {
            // The nearest direction of the cone's surface.
            let share = friction / across;
            let nearest = Vector3::new(1.0, share * smallest[1], share * smallest[2]);
            let component = shown.dot(&nearest) / size;
            if component <= 0.0 {
                (Vector3::zeros(), ConePart::Apex)
            } else {
                (nearest / component, ConePart::Boundary)
            }
        };
        assert_eq!(found.part, expected.1, "{number}: {found:?}");
        assert!(
            (found.force - expected.0).norm() <= 1e-2 * expected.0.norm(),
            "{number}: {found:?} {expected:?}"
        );
    }
}

#[test]
fn units_and_tangents_do_not_matter() {
    for number in 0..2_000 {
        let Problem { gram, products, friction } = Problem::random(KINDS * number);
        let found = best_cone_force(&gram, &products, friction);
        let turn = Rotation2::new(0.1 * number as f64);
        let mut turned = Matrix3::identity();
        turned.fixed_view_mut::<2, 2>(1, 1).copy_from(turn.matrix());
        let other = best_cone_force(
            &(turned * gram * turned.transpose() * 1e20),
            &(turned * products * 1e-8),
            friction,
        );
        let back = Vector3::new(other.force[0], 0.0, 0.0)
            + turned.tr_mul(&Vector3::new(0.0, other.force[1], other.force[2]));
        let size = found.force.norm();
        assert!((back * 1e28 - found.force).norm() <= 1e-6 * size, "{number}: {found:?} {other:?}");
        assert_eq!(other.part, found.part);
    }
}

/// Numbers of any size, now and then no number.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![8 => -10.0..10.0, 1 => proptest::num::f64::ANY, 1 => Just(0.0)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn any_numbers_give_a_force_inside_the_cone(
        numbers in proptest::array::uniform12(any_number()),
        friction in any_number(),
    ) {
        let gram = Matrix3::from_column_slice(&numbers[..9]);
        let products = Vector3::from_column_slice(&numbers[9..]);
        for gram in [gram, gram.tr_mul(&gram)] {
            let ConeForce { force, objective, .. } = best_cone_force(&gram, &products, friction);
            prop_assert!(force.iter().all(|x| x.is_finite()) && objective.is_finite());
            // A sum of squares could be too large for a number.
            let across = force[1].hypot(force[2]);
            let friction = if friction > 0.0 { friction.min(f64::MAX) } else { 0.0 };
            prop_assert!(force[0] >= 0.0 && across <= friction * force[0] * (1.0 + 1e-12));
            prop_assert!(objective <= 0.0);
        }
    }
}

#[test]
fn friction_whose_square_is_no_number_is_none() {
    let gram = Matrix3::from_column_slice(&[
        3.327296706014346,
        0.0,
        0.0,
        0.0,
        -1.1225615763245986,
        0.0,
        0.0,
        7.911837365976271,
        0.4296500539635386,
    ]);
    let products = Vector3::new(1.67163378659871, 0.0, 1.203878670809349);
    for gram in [gram, gram.tr_mul(&gram)] {
        let force = best_cone_force(&gram, &products, 1.857535003398773e-159).force;
        assert!(force[0] > 0.0 && force[1] == 0.0 && force[2] == 0.0, "{force}");
    }
}
