//! Dynamics against each other and against finite differences; Pinocchio checks them from Python.

use crate::common;
use contactsense::robot::{Kinematics, MomentumPass, Robot};
use nalgebra::DVector;

fn robots() -> [std::sync::Arc<Robot>; 2] {
    [common::arm(), common::humanoid()]
}

/// `M v` and `C^T v - g` by the momentum pass.
fn momentum(robot: &Robot, q: &[f64], v: &[f64]) -> (DVector<f64>, DVector<f64>) {
    let mut kinematics = Kinematics::new(robot);
    kinematics.set_configuration(robot, q);
    kinematics.set_velocity(robot, v);
    let (mut p, mut rate) = (vec![0.0; robot.nv()], vec![0.0; robot.nv()]);
    MomentumPass::new(robot).evaluate(robot, &kinematics, v, &mut p, &mut rate);
    (DVector::from_vec(p), DVector::from_vec(rate))
}

/// `q` after moving with `v` for `dt`; first order, enough for central differences.
fn moved(robot: &Robot, q: &[f64], v: &[f64], dt: f64) -> Vec<f64> {
    use contactsense::robot::JointKind;
    use nalgebra::{Quaternion, UnitQuaternion, Vector3};
    let mut q = q.to_vec();
    let (mut i, mut k) = (0, 0);
    for kind in robot.joint_kinds() {
        match kind {
            JointKind::FreeFlyer => {
                let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[6], q[3], q[4], q[5]));
                let step = turn * Vector3::new(v[0], v[1], v[2]) * dt;
                q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q += step);
                let turn = turn * UnitQuaternion::from_scaled_axis(Vector3::new(v[3], v[4], v[5]) * dt);
                q[3..7].copy_from_slice(turn.coords.as_slice());
            }
            JointKind::Continuous => {
                let angle = q[i + 1].atan2(q[i]) + v[k] * dt;
                (q[i], q[i + 1]) = (angle.cos(), angle.sin());
            }
            _ => q[i] += v[k] * dt,
        }
        i += kind.nq();
        k += kind.nv();
    }
    q
}

#[test]
fn momentum_is_mass_matrix_times_velocity() {
    for robot in robots() {
        for seed in 0..20 {
            let q = common::configuration(&robot, seed.into());
            let v = common::numbers(robot.nv(), 0.3 * f64::from(seed));
            let expected = robot.mass_matrix(&q).unwrap() * DVector::from_vec(v.clone());
            assert!((momentum(&robot, &q, &v).0 - &expected).norm() < 1e-12 * expected.norm());
        }
    }
}

/// `C^T v - g = dM/dt v - (C v + g)`, with `dM/dt v` by central differences of `M` along the motion.
#[test]
fn known_rate_follows_from_the_change_of_the_mass_matrix() {
    for robot in robots() {
        for seed in 0..5 {
            let q = common::configuration(&robot, seed.into());
            let v = common::numbers(robot.nv(), 0.3 * f64::from(seed));
            let still = vec![0.0; robot.nv()];
            let dt = 1e-6;
            let [before, after] = [-dt, dt].map(|dt| robot.mass_matrix(&moved(&robot, &q, &v, dt)).unwrap());
            let change = (after - before) / (2.0 * dt) * DVector::from_vec(v.clone());
            let bias = DVector::from_vec(robot.inverse_dynamics(&q, &v, &still).unwrap());
            let expected = change - bias;
            let error = (momentum(&robot, &q, &v).1 - &expected).norm();
            assert!(error < 1e-6 * expected.norm().max(1.0), "{}: {error:e}", robot.name());
        }
    }
}

#[test]
fn forward_dynamics_undoes_inverse_dynamics() {
    for robot in robots() {
        for seed in 0..20 {
            let q = common::configuration(&robot, seed.into());
            let v = common::numbers(robot.nv(), 0.3 * f64::from(seed));
            let a = common::numbers(robot.nv(), 5.0 + f64::from(seed));
            let tau = robot.inverse_dynamics(&q, &v, &a).unwrap();
            let found = robot.forward_dynamics(&q, &v, &tau, None).unwrap();
            let error = DVector::from_vec(found) - DVector::from_vec(a);
            assert!(error.amax() < 1e-9, "{}: {:e}", robot.name(), error.amax());
        }
    }
}

#[test]
fn a_joint_that_moves_nothing_stands_still() {
    use contactsense::robot::RobotDescription;
    let description = RobotDescription {
        name: "massless".into(),
        joints: vec![contactsense::robot::JointDescription {
            name: "joint".into(),
            parent: contactsense::robot::BodyIndex::WORLD,
            kind: contactsense::robot::JointKind::Revolute,
            axis: nalgebra::Vector3::z(),
            placement: contactsense::spatial::Pose::identity(),
            mass: 0.0,
            com: nalgebra::Vector3::zeros(),
            inertia: nalgebra::Matrix3::zeros(),
            armature: 0.0,
            lower: None,
            upper: None,
            effort: None,
            velocity: None,
        }],
        links: vec![],
        gravity: nalgebra::Vector3::zeros(),
        warnings: vec![],
    };
    let robot = Robot::new(description).unwrap();
    assert_eq!(robot.forward_dynamics(&[0.1], &[0.2], &[3.0], None).unwrap(), [0.0]);
}
