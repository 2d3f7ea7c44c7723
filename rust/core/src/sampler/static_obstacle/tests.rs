use nalgebra::Vector3;

use super::super::hypothesis::Hypothesis;
use super::super::path::ContactPath;
use super::*;
use crate::robot::RobotDescription;
use crate::spatial::Pose;
use crate::surface::tests::meshes::cells;
use crate::surface::{Geometry, Part};
use crate::torque::ForceModel;

const RADIUS: f64 = 0.05;
const STIFFNESS: f64 = 1000.0;
const FORCE: f64 = 25.0;
const POSE: [f64; 7] = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2];

/// Small motions of the example arm against a ball that stays, and the torques without errors.
struct Scene {
    robot: Arc<Robot>,
    link: usize,
    centre: Vector3<f64>,
}

impl Scene {
    fn new(link: usize, place: f64) -> Self {
        Self::of(Arc::new(Robot::example_arm()), link, place)
    }

    fn of(robot: Arc<Robot>, link: usize, place: f64) -> Self {
        let surface = robot.links()[link].surface.clone().expect("a surface");
        let points = surface.sample(64, 3);
        let at = points[(64.0 * place) as usize];
        let pose = robot.link_pose(&POSE, crate::robot::LinkIndex::new(link)).expect("a pose");
        Scene { centre: pose.transform_point(&(at.point + at.normal * RADIUS)), link, robot }
    }

    /// The torque at a pose and where the contact is, where there is one of some force.
    fn at(&self, q: &[f64]) -> Option<(Vec<f64>, Vector3<f64>)> {
        self.at_with_friction(q, 0.0, 0.0)
    }

    /// The same with all friction that a coefficient allows, in a direction (rad).
    fn at_with_friction(&self, q: &[f64], friction: f64, direction: f64) -> Option<(Vec<f64>, Vector3<f64>)> {
        let link = crate::robot::LinkIndex::new(self.link);
        let pose = self.robot.link_pose(q, link).expect("a pose");
        let surface = self.robot.links()[self.link].surface.as_ref().expect("a surface");
        let near = surface.closest_point(&pose.inverse_transform_point(&self.centre));
        let force = FORCE + STIFFNESS * (RADIUS - near.distance);
        // Nor where the motion would take the ball's centre into the link.
        if force < 5.0 || near.distance < 0.5 * RADIUS {
            return None;
        }
        let point = pose.transform_point(&near.point);
        let inward = (point - self.centre) / near.distance;
        let [_, along, beside] = crate::torque::directions(&inward);
        let across = (along * direction.cos() + beside * direction.sin()) * friction;
        let push = (inward + across) * force;
        let jacobian = self.robot.jacobian(q, link, Some(point.into())).expect("a Jacobian");
        Some(((jacobian.rows(0, 3).transpose() * push).as_slice().to_vec(), point))
    }

    fn pose(&self, tick: usize) -> Vec<f64> {
        let turn = |j: usize| 0.02 * ((1.0 + 0.37 * j as f64) * tick as f64).sin();
        POSE.iter().enumerate().map(|(j, q)| q + if tick == 0 { 0.0 } else { turn(j) }).collect()
    }
}

fn sampler(scene: &Scene, threads: usize) -> StaticObstacleSampler {
    let options = SamplerOptions {
        particles: 3000,
        force_model: ForceModel::FrictionCone(0.0),
        threads,
        ..SamplerOptions::default()
    };
    StaticObstacleSampler::new(scene.robot.clone(), &options).expect("valid options")
}

#[test]
fn an_obstacle_that_stays_is_found_on_outer_links() {
    for (link, place) in [(3, 0.3), (4, 0.6), (5, 0.2), (6, 0.8)] {
        let scene = Scene::new(link, place);
        let mut sampler = sampler(&scene, 1);
        let mut truth = Vector3::zeros();
        for tick in 0..30 {
            let q = scene.pose(tick);
            let Some((torque, point)) = scene.at(&q) else { continue };
            truth = point;
            sampler.update(&q, &torque, None).expect("valid input");
        }
        let found = sampler.estimate();
        let contact = found.estimate.contact.expect("a contact");
        let error = (contact.point - truth).norm();
        assert!(contact.link.get() == link && error < 0.01, "link {link}: {contact:?} {error}");
        assert!(found.explained && sampler.total_log_evidence() > 0.0, "{found:?}");
        assert!((sampler.weights().iter().sum::<f64>() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn what_ends_is_forgotten_and_bad_input_changes_nothing() {
    let scene = Scene::new(5, 0.2);
    let mut sampler = sampler(&scene, 1);
    let q = scene.pose(0);
    let (torque, _) = scene.at(&q).expect("a contact");
    assert_eq!(sampler.update(&q, &torque, None).expect("valid").event, Event::Started);
    let kept = sampler.estimate().estimate.contact.expect("a contact").point;
    assert!(
        sampler.update(&q[1..], &torque, None).is_err() && sampler.update(&q, &[f64::NAN; 7], None).is_err()
    );
    assert_eq!(sampler.estimate().estimate.contact.expect("a contact").point, kept);
    assert_eq!(sampler.update(&q, &[0.0; 7], None).expect("valid").event, Event::Lost);
    assert!(sampler.estimate().estimate.contact.is_none());
    assert_eq!(sampler.update(&q, &torque, None).expect("valid").event, Event::Started);
}

#[test]
#[cfg(feature = "parallel")]
fn answers_are_the_same_on_any_number_of_threads() {
    let scene = Scene::new(5, 0.2);
    let run = |threads| {
        let mut sampler = sampler(&scene, threads);
        for tick in 0..6 {
            let q = scene.pose(tick);
            let Some((torque, _)) = scene.at(&q) else { continue };
            sampler.update(&q, &torque, None).expect("valid input");
        }
        (sampler.weights().to_vec(), sampler.estimate().estimate.contact.expect("a contact").point)
    };
    assert!(run(1) == run(2));
}

/// The example arm with links that are forks: two prongs of 0.24 m on a foot, 0.02 m apart.
fn forked_arm() -> Arc<Robot> {
    let prongs = [-1, 1].into_iter().flat_map(|x| (0..12).map(move |z| [x, 0, z]));
    let (vertices, triangles) = cells(&prongs.chain([[0, 0, 0]]).collect::<Vec<_>>(), 0.02);
    let mut description = RobotDescription::example_arm();
    for link in &mut description.links {
        let geometry = Geometry::Mesh { vertices: vertices.clone(), triangles: triangles.clone() };
        link.geometry = vec![Part { geometry, pose: Pose::identity() }];
    }
    Arc::new(Robot::new(description).expect("a valid description"))
}

/// Of two contacts at most, with room for five poses.
fn with_a_short_window(robot: Arc<Robot>, friction: f64) -> (Scene, StaticObstacleSampler) {
    let scene = Scene::of(robot, 5, 0.2);
    let options = SamplerOptions {
        particles: 300,
        window: 5,
        max_contacts: 2,
        force_model: ForceModel::FrictionCone(friction),
        ..SamplerOptions::default()
    };
    let sampler = StaticObstacleSampler::new(scene.robot.clone(), &options).expect("valid options");
    (scene, sampler)
}

/// Hypotheses of two contacts here and there.
fn hundred(path: &ContactPath<'_, 2>) -> Vec<Hypothesis<2>> {
    let claims = |k: usize| {
        [k, 7 * k + 3].map(|place| path.claim(ContactModel::Obstacle, place, 0.01 * (place % 100) as f64))
    };
    (0..100).filter_map(|k| path.make(claims(k), None)).collect()
}

#[test]
fn a_window_that_is_full_forgets_the_oldest() {
    forgets_the_oldest(Arc::new(Robot::example_arm()), 1.0);
}

#[test]
fn it_is_forgotten_also_where_a_contact_jumps_from_one_part_of_a_link_to_another() {
    forgets_the_oldest(forked_arm(), 10.0);
}

/// Where motions are so many times as large as those of a scene.
fn forgets_the_oldest(robot: Arc<Robot>, scale: f64) {
    let (scene, mut sampler) = with_a_short_window(robot, 0.0);
    let mut hypotheses = vec![];
    for tick in 0..20 {
        let (small, start) = (scene.pose(tick), scene.pose(0));
        let q: Vec<f64> = small.iter().zip(&start).map(|(q, start)| start + scale * (q - start)).collect();
        // What torques are measured is no matter.
        let (torque, _) = scene.at(&start).expect("a contact");
        sampler.update(&q, &torque, None).expect("valid input");
        assert!(sampler.measurements.len() <= 5);
        let path = path::<2>(&sampler);
        if hypotheses.is_empty() {
            hypotheses = hundred(&path);
        } else {
            hypotheses.iter_mut().for_each(|hypothesis| path.follow(hypothesis));
        }
    }
    // What was added and taken away is what is there.
    assert_eq!(hypotheses.len(), 100);
    for hypothesis in &hypotheses {
        let anew = path(&sampler).make(hypothesis.contacts.map(|contact| contact.claim), None);
        let anew = anew.expect("a surface");
        let error = (anew.marginal.log - hypothesis.marginal.log).abs();
        assert!(error < 1e-6 * (1.0 + anew.marginal.log.abs()), "{error} {}", anew.marginal.log);
    }
}

fn path<const N: usize>(sampler: &StaticObstacleSampler) -> ContactPath<'_, N> {
    let StaticObstacleSampler { robot, measurements, options, models, places, neighbours, .. } = sampler;
    super::Scene { robot, measurements, options, models, places, neighbours }.path()
}

#[test]
fn what_was_known_before_a_measurement_is_known_of_any_hypothesis_with_friction() {
    let (scene, mut sampler) = with_a_short_window(Arc::new(Robot::example_arm()), 0.3);
    let mut known = vec![];
    let mut compared = 0;
    for tick in 0..20 {
        let q = scene.pose(tick);
        let Some((torque, _)) = scene.at(&q) else { continue };
        sampler.update(&q, &torque, None).expect("valid input");
        let path = path::<2>(&sampler);
        if known.is_empty() {
            known = hundred(&path);
            continue;
        }
        for hypothesis in &mut known {
            let before = hypothesis.marginal.log;
            path.follow(hypothesis);
            let anew = path.make(hypothesis.contacts.map(|contact| contact.claim), None).expect("a surface");
            assert_eq!(hypothesis.logs.start, before);
            let error = (anew.logs.start - before).abs();
            assert!(error < 1e-6 * (1.0 + before.abs()), "{error} {before}");
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn friction_is_not_taken_for_one_more_contact() {
    let friction = 0.3;
    let [first, second] = [Scene::new(3, 0.3), Scene::new(6, 0.8)];
    let options = SamplerOptions {
        particles: 1500,
        max_contacts: 3,
        force_model: ForceModel::FrictionCone(friction),
        ..SamplerOptions::default()
    };
    let mut sampler = StaticObstacleSampler::new(first.robot.clone(), &options).expect("valid options");
    let mut truth = [Vector3::zeros(); 2];
    for tick in 0..25 {
        let q = first.pose(tick);
        // It slides to one side, then to another.
        let [one, other] = [(&first, 2.3), (&second, 3.1)]
            .map(|(scene, turn)| scene.at_with_friction(&q, friction, turn * tick as f64));
        let (Some(one), Some(other)) = (one, other) else { continue };
        truth = [one.1, other.1];
        let torque: Vec<f64> = one.0.iter().zip(&other.0).map(|(one, other)| one + other).collect();
        sampler.update(&q, &torque, None).expect("valid input");
    }
    assert!(sampler.number_probabilities()[1] > 0.9, "{:?}", sampler.number_probabilities());
    let found = sampler.estimate();
    assert!(found.residual < 1.2, "{}", found.residual);
    for truth in truth {
        let contacts = [&found.estimate, &found.others[0]].map(|estimate| estimate.contact);
        let errors = contacts.map(|contact| (contact.expect("a contact").point - truth).norm());
        assert!(errors[0].min(errors[1]) < 0.02, "{errors:?}");
    }
}

#[test]
fn two_contacts_are_found_together() {
    let [first, second] = [Scene::new(3, 0.3), Scene::new(6, 0.8)];
    let options = SamplerOptions {
        particles: 3000,
        max_contacts: 2,
        force_model: ForceModel::FrictionCone(0.0),
        ..SamplerOptions::default()
    };
    let mut sampler = StaticObstacleSampler::new(first.robot.clone(), &options).expect("valid options");
    let mut truth = [Vector3::zeros(); 2];
    for tick in 0..60 {
        let q = first.pose(tick);
        let (Some(one), Some(other)) = (first.at(&q), second.at(&q)) else { continue };
        truth = [one.1, other.1];
        let torque: Vec<f64> = one.0.iter().zip(&other.0).map(|(one, other)| one + other).collect();
        sampler.update(&q, &torque, None).expect("valid input");
    }
    let found = sampler.estimate();
    for (link, truth) in [3, 6].into_iter().zip(truth) {
        let of_link =
            [&found.estimate, &found.others[0]].into_iter().filter_map(|estimate| estimate.contact.as_ref());
        let contact =
            of_link.clone().find(|contact| contact.link.get() == link).expect("a contact on the link");
        let error = (contact.point - truth).norm();
        assert!(error < 0.01, "link {link}: {contact:?} {error}");
    }
    assert!(sampler.number_probabilities()[1] > 0.9, "{:?}", sampler.number_probabilities());
    // Once they are lost, the particles are still those of two.
    sampler.update(&first.pose(0), &[0.0; 7], None).expect("valid input");
    assert_eq!((sampler.contacts(), sampler.number_probabilities()), (2, &[0.0; 2][..]));
    sampler.reset();
    assert_eq!(sampler.contacts(), 1);
}

#[test]
fn a_contact_that_begins_later_and_one_that_ends_are_noticed() {
    let [first, second] = [Scene::new(3, 0.3), Scene::new(6, 0.8)];
    let options = SamplerOptions { particles: 2000, max_contacts: 2, ..SamplerOptions::default() };
    let mut sampler = StaticObstacleSampler::new(first.robot.clone(), &options).expect("valid options");
    let mut run = |ticks: std::ops::Range<usize>, touching: [bool; 2]| {
        let (mut changes, mut links) = (0, vec![]);
        for tick in ticks {
            let q = first.pose(tick);
            let (Some(one), Some(other)) = (first.at(&q), second.at(&q)) else { continue };
            let torque: Vec<f64> = (0..7)
                .map(|j| {
                    [one.0[j], other.0[j]].iter().zip(touching).map(|(x, on)| if on { *x } else { 0.0 }).sum()
                })
                .collect();
            let found = sampler.update(&q, &torque, None).expect("valid input");
            changes += usize::from(found.event == Event::Changed);
            let contacts = std::iter::once(&found.estimate).chain(&found.others);
            links = contacts.filter_map(|estimate| Some(estimate.contact?.link.get())).collect();
        }
        (changes, links)
    };
    assert_eq!(run(0..30, [false, true]), (0, vec![6]));
    // What was there stays the first.
    assert_eq!(run(30..60, [true, true]), (1, vec![6, 3]));
    assert_eq!(run(60..90, [true, false]), (1, vec![3]));
}
