use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::*;
use crate::particle::instant::Instant;
use crate::particle::spring::Slope;
use crate::particle::weight;
use crate::particle::window::Window;
use crate::robot::{
    BodyIndex, JointDescription, JointKind, LinkDescription, LinkIndex, Robot, RobotDescription,
};
use crate::spatial::Pose;
use crate::surface::{Geometry, Part};
use crate::torque::{ForceModel, NoiseModel};

const RADIUS: f64 = 0.05;
const STIFFNESS: f64 = 2500.0;
/// Steps in which a fit must converge.
const STEPS: usize = 12;

/// Six revolute joints about z and y by turns, each with a capsule of 26 cm.
fn arm() -> Robot {
    let (mut joints, mut links) = (vec![], vec![]);
    for k in 0..6 {
        let turn = if k % 2 == 0 { 0.2 } else { FRAC_PI_2 - 0.2 };
        let placement = Pose {
            rotation: Rotation3::from_euler_angles(0.3, turn, -0.2).into_inner(),
            translation: Vector3::new(0.02, 0.03, 0.22),
        };
        let com = Vector3::zeros();
        let inertia = Matrix3::identity() * 0.01;
        joints.push(JointDescription {
            name: format!("joint_{k}"),
            parent: BodyIndex::new(k),
            kind: JointKind::Revolute,
            axis: Vector3::z(),
            placement,
            mass: 1.0,
            com,
            inertia,
            armature: 0.0,
            lower: None,
            upper: None,
            effort: None,
            velocity: None,
        });
        let pose = Pose { rotation: Matrix3::identity(), translation: Vector3::new(0.0, 0.0, 0.1) };
        links.push(LinkDescription {
            name: format!("link_{k}"),
            body: BodyIndex::new(k + 1),
            placement: Pose::identity(),
            parent: None,
            mass: 1.0,
            com,
            inertia,
            geometry: vec![Part { geometry: Geometry::Capsule { radius: 0.05, half_length: 0.08 }, pose }],
        });
    }
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    Robot::new(RobotDescription { name: "arm".into(), joints, links, gravity, warnings: vec![] })
        .expect("a valid description")
}

/// Small motions of the arm, with the torques that `torque` gives at a pose, for the outermost link.
fn window(robot: &Robot, torque: impl Fn(&[f64], &Pose) -> Vec<f64>) -> Window {
    let link = robot.links().len() - 1;
    let noise = NoiseModel::short(vec![0.02], 0.03).of(robot).expect("valid noise");
    let mut instant = Instant::new(robot, noise, vec![link]);
    let mut window = Window::new(&instant);
    for k in 0..POSES {
        let q: Vec<f64> = (0..robot.nv())
            .map(|i| 0.3 * (1.0 + i as f64).sin() + 0.02 * (1.3 * k as f64 + 2.1 * i as f64).sin())
            .collect();
        let torque = torque(&q, &robot.link_pose(&q, LinkIndex::new(link)).expect("a valid link"));
        instant.update(robot, &q, &torque, true);
        window.take_in(&instant, link, 0.0);
    }
    window
}

/// A fit to the outermost link's window.
fn task<'a>(robot: &'a Robot, window: &'a Window, force_model: ForceModel) -> Task<'a> {
    let link = robot.links().len() - 1;
    let surface = robot.links()[link].surface.as_ref().expect("a capsule");
    Task { window, link, surface, force_model, joints: robot.nv() }
}

/// A fit to the outermost link's window from a start in the world.
fn fit(robot: &Robot, window: &Window, force_model: ForceModel, start: Vector3<f64>) -> Obstacle {
    let task = task(robot, window, force_model);
    let mut obstacle = Obstacle::at(start);
    let mut residuals = Residuals::new(robot.nv());
    for _ in 0..STEPS {
        obstacle.improve(&task, &mut residuals);
    }
    obstacle
}

/// Where a ball is that the outermost link touches, and its torques at a pose: of a normal force and one across it.
fn ball(robot: &Robot, friction: f64) -> (Vector3<f64>, impl Fn(&[f64], &Pose) -> Vec<f64> + '_) {
    let link = robot.links().len() - 1;
    let surface = robot.links()[link].surface.as_ref().expect("a capsule");
    let q: Vec<f64> = (0..robot.nv()).map(|i| 0.3 * (1.0 + i as f64).sin()).collect();
    let start = robot.link_pose(&q, LinkIndex::new(link)).expect("a valid link");
    // Pressed in by 12 mm, on the capsule's round end.
    let local = Vector3::new(0.3, 0.5, 0.9).normalize() * (0.05 + RADIUS - 0.012) + Vector3::z() * 0.18;
    let centre = start.transform_point(&local);
    let torque = move |q: &[f64], pose: &Pose| {
        let near = surface.closest_point(&pose.inverse_transform_point(&centre));
        let point = pose.transform_point(&near.point);
        let normal = pose.rotation * near.normal;
        let size = STIFFNESS * (RADIUS - near.distance);
        assert!(size > 0.0, "the motions keep in touch");
        let force = -normal * size + normal.cross(&Vector3::z()).normalize() * (friction * size);
        let jacobian = robot.jacobian(q, LinkIndex::new(link), Some(point.into())).expect("a valid link");
        (jacobian.rows(0, 3).transpose() * force).as_slice().to_vec()
    };
    (centre, torque)
}

#[test]
fn a_ball_that_a_link_rolls_on_is_found_with_its_stiffness() {
    let robot = arm();
    let (centre, torque) = ball(&robot, 0.0);
    let window = window(&robot, torque);
    let found = fit(&robot, &window, ForceModel::Normal, centre + Vector3::new(0.02, -0.03, 0.01));
    assert!((found.centre - centre).norm() < 1e-4, "{}", found.centre - centre);
    assert!(found.contacts().misfit < 1e-3, "{}", found.contacts().misfit);
    let slope = Slope::of(found.contacts(), POSES).expect("many poses");
    assert!((slope.value / STIFFNESS - 1.0).abs() < 1e-3, "{slope:?}");
    assert!(slope.value > 10.0 * slope.error, "{slope:?}");
}

#[test]
fn friction_in_the_cone_is_no_misfit() {
    let robot = arm();
    let (centre, torque) = ball(&robot, 0.2);
    let window = window(&robot, torque);
    let start = centre + Vector3::new(0.01, -0.01, 0.01);
    let bare = fit(&robot, &window, ForceModel::Normal, start);
    let cone = fit(&robot, &window, ForceModel::FrictionCone(0.5), start);
    // About one for the force across at each pose.
    assert!(cone.contacts().misfit < 2.0 * POSES as f64, "{}", cone.contacts().misfit);
    assert!(bare.contacts().misfit > 3.0 * cone.contacts().misfit, "{}", bare.contacts().misfit);
    let slope = Slope::of(cone.contacts(), POSES).expect("many poses");
    // What friction does is in part taken for the normal force.
    assert!((slope.value / STIFFNESS - 1.0).abs() < 0.5 && slope.value > 10.0 * slope.error, "{slope:?}");
}

#[test]
fn a_couple_is_no_obstacle() {
    let robot = arm();
    let link = robot.links().len() - 1;
    let (centre, _) = ball(&robot, 0.0);
    let window = window(&robot, |q, pose| {
        let jacobian = robot.jacobian(q, LinkIndex::new(link), None).expect("a valid link");
        let couple = pose.rotation * Vector3::new(3.0, -2.0, 4.0);
        (jacobian.rows(3, 3).transpose() * couple).as_slice().to_vec()
    });
    for radius in [-0.05, 0.0, 0.05] {
        let found = fit(&robot, &window, ForceModel::Normal, centre + Vector3::repeat(radius));
        let checks = POSES * 5;
        assert!(found.contacts().misfit > 9.0 * 2.0 * checks as f64, "{}", found.contacts().misfit);
    }
}

#[test]
fn a_weight_explains_its_own_torques_and_not_those_of_a_ball() {
    let robot = arm();
    let link = robot.links().len() - 1;
    let (centre, push) = ball(&robot, 0.0);
    let carried = |q: &[f64], pose: &Pose| {
        let place = pose.transform_point(&Vector3::new(0.02, -0.01, 0.2));
        let jacobian = robot.jacobian(q, LinkIndex::new(link), Some(place.into())).expect("a valid link");
        (jacobian.rows(0, 3).transpose() * Vector3::new(0.0, 0.0, -15.0)).as_slice().to_vec()
    };
    let down = -Vector3::z();
    let [carried, pushed] = [window(&robot, carried), window(&robot, push)];
    for (window, as_well) in [(&carried, true), (&pushed, false)] {
        let found = fit(&robot, window, ForceModel::Normal, centre);
        let task = task(&robot, window, ForceModel::Normal);
        let found = Some(found.contacts());
        assert_eq!(weight::explains_as_well(&task, &[link], &down, found), as_well);
    }
}
