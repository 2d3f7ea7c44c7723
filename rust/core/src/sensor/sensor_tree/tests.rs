use nalgebra::{Matrix3, Vector3};

use super::super::{Convention, ForceTorqueSensor, SensorTree};
use crate::robot::{JointDescription, JointKind, Kinematics, LinkDescription, Robot, RobotDescription};
use crate::spatial::Pose;
use crate::Error;

fn at(x: f64) -> Pose {
    Pose { translation: Vector3::new(x, 0.0, 0.0), ..Pose::identity() }
}

fn joint(name: &str, parent: usize) -> JointDescription {
    JointDescription {
        name: name.into(),
        parent,
        kind: JointKind::Revolute,
        axis: Vector3::y(),
        placement: at(1.0),
        mass: 1.0,
        com: Vector3::zeros(),
        inertia: Matrix3::identity(),
        armature: 0.0,
    }
}

/// base - j1 - a - (fixed) - b - j2 - c, and d on a joint at a; links listed backwards.
fn robot() -> Robot {
    let link = |name: &str, joint, x, parent| LinkDescription {
        name: name.into(),
        joint,
        placement: at(x),
        parent,
        mass: 0.5,
        com: Vector3::zeros(),
        inertia: Matrix3::identity(),
        geometry: vec![],
    };
    Robot::new(RobotDescription {
        name: "tree".into(),
        joints: vec![joint("j1", 0), joint("j2", 1), joint("j3", 1)],
        links: vec![
            link("d", 3, 0.0, Some(3)),
            link("c", 2, 0.0, Some(2)),
            link("b", 1, 0.2, Some(3)),
            link("a", 1, 0.0, Some(4)),
            link("base", 0, 0.0, None),
        ],
        gravity: Vector3::zeros(),
        warnings: vec![],
    })
    .expect("a valid description")
}

fn sensor(name: &str, link: &str) -> ForceTorqueSensor {
    ForceTorqueSensor { name: name.into(), link: link.into(), pose: at(0.1), convention: Convention::Load }
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
    let cases = [
        (vec![sensor("A", "x")], "'x'"),
        (vec![sensor("A", "base")], "fixed to the world"),
        (vec![sensor("A", "a"), sensor("A", "b")], "named 'A'"),
        (vec![sensor("A", "a"), sensor("B", "a")], "both sit at link 'a'"),
        (vec![ForceTorqueSensor { pose: skewed, ..sensor("A", "a") }], "rigid"),
        (vec![ForceTorqueSensor { pose: far, ..sensor("A", "a") }], "rigid"),
    ];
    for (sensors, part) in cases {
        match SensorTree::new(&robot(), &sensors) {
            Err(error @ Error::Input { .. }) => assert!(error.to_string().contains(part), "{error}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn long_chains_without_links_need_no_deep_stack() {
    let joint = |index: usize| joint(&format!("j{index}"), index);
    let robot = Robot::new(RobotDescription {
        name: "chain".into(),
        joints: (0..3000).map(joint).collect(),
        links: vec![],
        gravity: Vector3::zeros(),
        warnings: vec![],
    })
    .unwrap();
    let tree = SensorTree::new(&robot, &[]).unwrap();
    let last = robot.body_count() - 1;
    let search = std::thread::Builder::new().stack_size(64 * 1024);
    assert_eq!(search.spawn(move || tree.at_joint(last)).unwrap().join().unwrap(), None);
}
