use nalgebra::{Matrix3, Vector3};

use super::super::{ForceTorqueSensor, SensorTree};
use crate::robot::{test_tree, JointDescription, Kinematics, LinkDescription, Robot};
use crate::spatial::Pose;
use crate::Error;

fn at(x: f64) -> Pose {
    Pose { translation: Vector3::new(x, 0.0, 0.0), ..Pose::identity() }
}

/// base - j1 - a - (fixed) - b - j2 - c, and d on a joint at a; links listed backwards.
fn robot() -> Robot {
    let joint = |name, parent| JointDescription { placement: at(1.0), ..test_tree::joint(name, parent) };
    let link =
        |name, joint, x, parent| LinkDescription { placement: at(x), ..test_tree::link(name, joint, parent) };
    let links = vec![
        link("d", 3, 0.0, Some(3)),
        link("c", 2, 0.0, Some(2)),
        link("b", 1, 0.2, Some(3)),
        link("a", 1, 0.0, Some(4)),
        link("base", 0, 0.0, None),
    ];
    test_tree::robot(vec![joint("j1", 0), joint("j2", 1), joint("j3", 1)], links)
}

fn sensor(name: &str, link: &str) -> ForceTorqueSensor {
    ForceTorqueSensor { pose: at(0.1), ..ForceTorqueSensor::new(name, link) }
}

#[test]
fn loads_pass_on_towards_the_base() {
    let robot = robot();
    let mut tree =
        SensorTree::new(&robot, &[sensor("A", "a"), sensor("B", "b"), sensor("C", "c")]).expect("valid");
    assert_eq!(tree.distal_first(), [2, 1, 0]);
    assert_eq!([0, 1, 2].map(|s| tree.parent(s)), [None, Some(0), Some(1)]);
    assert_eq!([0, 1, 2, 3, 4].map(|link| tree.of_link(link)), [Some(0), Some(2), Some(1), Some(0), None]);
    assert_eq!([0, 1, 2].map(|s| tree.body(s)), [1, 1, 2]);
    tree.set_active(&[true, false, true]);
    assert_eq!(tree.parent(2), Some(0));
    assert_eq!([1, 2].map(|link| tree.of_link(link)), [Some(2), Some(0)]);
    tree.set_active(&[false, false, true]);
    assert_eq!((tree.parent(2), tree.of_link(2)), (None, None));
    tree.set_active(&[true; 3]);
    assert_eq!((tree.parent(2), tree.of_link(2)), (Some(1), Some(1)));
    let mut kinematics = Kinematics::new(&robot);
    kinematics.set_configuration(&robot, &[0.0; 3]);
    let world = kinematics.origin + tree.position(&kinematics, 1);
    assert!((world - Vector3::new(1.3, 0.0, 0.0)).norm() < 1e-15);
    let turn = tree.rotation(&kinematics, 1);
    assert!((turn - Matrix3::identity()).norm() < 1e-15, "{turn}");
}

#[test]
fn bad_sensors_are_named() {
    let skewed = Pose { rotation: Matrix3::identity() * 2.0, translation: Vector3::zeros() };
    let far = Pose { rotation: Matrix3::identity(), translation: Vector3::repeat(f64::NAN) };
    let endless = [0.0, 0.0, f64::INFINITY, 0.0, 0.0, 0.0];
    let cases = [
        (vec![sensor("A", "x")], "'x'"),
        (vec![sensor("A", "base")], "fixed to the world"),
        (vec![sensor("A", "a"), sensor("A", "b")], "named 'A'"),
        (vec![sensor("A", "a"), sensor("B", "a")], "both sit at link 'a'"),
        (vec![ForceTorqueSensor { pose: skewed, ..sensor("A", "a") }], "the pose of 'A' must be a rotation"),
        (vec![ForceTorqueSensor { pose: far, ..sensor("A", "a") }], "the pose of 'A' is not finite"),
        (vec![ForceTorqueSensor { offset: endless, ..sensor("A", "a") }], "the offset of 'A' must be finite"),
    ];
    for (sensors, part) in cases {
        match SensorTree::new(&robot(), &sensors) {
            Err(error @ Error::Input { .. }) => assert!(error.to_string().contains(part), "{error}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn joints_lie_behind_sensors() {
    let mut tree =
        SensorTree::new(&robot(), &[sensor("A", "a"), sensor("B", "b"), sensor("C", "c")]).expect("valid");
    assert_eq!([1, 2, 3].map(|body| tree.joint_link(body)), [Some(3), Some(1), Some(0)]);
    assert_eq!([1, 2, 3].map(|body| tree.at_joint(body)), [Some(0), Some(2), Some(0)]);
    assert_eq!([1, 2, 3].map(|body| tree.before_joint(body)), [None, Some(1), Some(0)]);
    let behind = |sensor| [0, 1, 2].map(|other| tree.is_behind(sensor, other));
    assert_eq!([0, 1, 2].map(behind), [[true, false, false], [true, true, false], [true, true, true]]);
    tree.set_active(&[true, false, true]);
    assert_eq!(tree.before_joint(2), Some(0));
}

#[test]
fn long_chains_without_links_need_no_deep_stack() {
    let joints = (0..3000).map(|index| test_tree::joint(&format!("j{index}"), index)).collect();
    let robot = test_tree::robot(joints, vec![]);
    let last = robot.body_count() - 1;
    let make = std::thread::Builder::new()
        .stack_size(64 * 1024)
        .spawn(move || SensorTree::new(&robot, &[]).unwrap());
    assert_eq!(make.unwrap().join().unwrap().at_joint(last), None);
}
