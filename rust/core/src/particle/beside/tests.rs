use nalgebra::{DMatrix, DVector, Vector3};

use super::*;
use crate::robot::Robot;
use crate::spatial::vector::stack;
use crate::torque::directions;
use crate::torque::{ForceModel, NoiseModel};

const POSE: [f64; 7] = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2];

fn instant(robot: &Robot, torque: &[f64]) -> Instant {
    let noise = NoiseModel::short(vec![0.05], 0.03).of(robot).expect("noise").without_coupling();
    let wanted = robot.touchable_links().iter().map(|link| link.get()).collect();
    let mut instant = Instant::new(robot, noise, wanted);
    instant.update(robot, &POSE, torque, true);
    instant
}

fn known(link: usize, force: f64) -> Known {
    let normal = Vector3::new(0.2, 0.9, -0.4).normalize();
    Known {
        link,
        point: Vector3::new(0.03, 0.05, 0.1),
        normal,
        force,
        spread: 0.01,
        sure: false,
        obstacle: None,
    }
}

/// Torques of wrenches at the origin of a link, each row over its noise.
fn torques(instant: &Instant, link: usize, wrenches: &[Vector6<f64>]) -> DMatrix<f64> {
    let frame = &instant.frames.links[link];
    let mut torques = DMatrix::zeros(instant.measured.len(), wrenches.len());
    for (axis, &row) in frame.rows().iter().enumerate() {
        for (column, wrench) in wrenches.iter().enumerate() {
            torques[(row, column)] = frame.column(axis).dot(wrench);
        }
    }
    torques
}

#[test]
fn what_others_may_do_is_integrated_out_as_a_covariance_would() {
    let robot = Robot::example_arm();
    let mut instant = instant(&robot, &[1.0, 12.0, -3.0, 4.0, 0.7, -0.4, 0.1]);
    let model = ResponseModel { force_model: ForceModel::FrictionCone(0.5), variance: 2.0 };
    let others = [known(3, 12.0), known(6, 4.0)];
    Beside::new(7).take_out(&mut instant, &others, None, &model);

    let mut covariance = DMatrix::<f64>::identity(7, 7);
    let scale = DVector::from_iterator(7, instant.deviation.iter().copied());
    let mut left = DVector::from_column_slice(&instant.measured).component_div(&scale);
    for other in &others {
        let [inward, first, second] = directions(&other.normal);
        let force = |force: Vector3<f64>| stack(&force, &other.point.cross(&force));
        let moment = |along: Vector3<f64>| stack(&Vector3::zeros(), &along.cross(&(inward * other.force)));
        let across = (0.25 * other.force).hypot(0.3 * other.force);
        let wrenches = [
            force(inward * other.force.max(10.0)),
            force(first * across),
            force(second * across),
            moment(first * 0.01),
            moment(second * 0.01),
        ];
        let columns = torques(&instant, other.link, &wrenches);
        covariance += &columns * columns.transpose() / 2.0;
        left -= torques(&instant, other.link, &[force(inward * other.force)]).column(0);
    }
    let inverse = covariance.try_inverse().expect("positive definite");
    let close = |found: f64, wanted: f64| {
        assert!((found - wanted).abs() < 1e-7 * (1.0 + wanted.abs()), "{found} {wanted}")
    };
    close(instant.squared, left.dot(&(&inverse * &left)));
    let axes: Vec<Vector6<f64>> = (0..6).map(|k| Vector6::ith(k, 1.0)).collect();
    for link in [2, 4, 6] {
        let columns = torques(&instant, link, &axes);
        let gram = columns.transpose() * &inverse * &columns;
        let product = columns.transpose() * &inverse * &left;
        for i in 0..6 {
            close(instant.equations[link].product[i], product[i]);
            for j in 0..6 {
                close(instant.equations[link].gram[(i, j)], gram[(i, j)]);
            }
        }
    }
}

#[test]
fn what_others_do_is_subtracted() {
    let robot = Robot::example_arm();
    let model = ResponseModel { force_model: ForceModel::Normal, variance: 1.0 };
    let (own, other) = (known(6, 8.0), known(3, 20.0));
    let mut still = instant(&robot, &[0.0; 7]);
    let pushes = [own, other].map(|known| {
        let mut torque = [0.0; 7];
        let force = known.normal * known.force;
        still.frames.subtract(known.link, &known.point, &force, &still.deviation, &mut torque);
        torque
    });
    let both: Vec<f64> = (0..7).map(|k| pushes[0][k] + pushes[1][k]).collect();
    still.update(&robot, &POSE, &both, true);
    // It was held to be too weak.
    let held = Known { force: 15.0, ..other };
    Beside::new(7).take_out(&mut still, &[held], Some(&own), &model);
    let missed = (0..7).map(|k| (still.torque[k] - pushes[0][k]).powi(2)).sum::<f64>().sqrt();
    let held_wrongly = 0.25 * pushes[1].iter().map(|torque| torque * torque).sum::<f64>().sqrt();
    assert!(missed < 0.3 * held_wrongly, "{missed} of {held_wrongly}");
    assert_eq!(still.measured, both);
}

#[test]
fn alone_all_is_as_measured() {
    let robot = Robot::example_arm();
    let mut alone = instant(&robot, &[1.0, 2.0, 3.0, 4.0, 0.5, 0.2, 0.1]);
    let squared = alone.squared;
    let model = ResponseModel { force_model: ForceModel::Normal, variance: 1.0 };
    Beside::new(7).take_out(&mut alone, &[], None, &model);
    assert_eq!((alone.squared, &alone.torque), (squared, &alone.measured));
    assert_eq!(alone.equations[5].product, alone.target.on(5).product);
}
