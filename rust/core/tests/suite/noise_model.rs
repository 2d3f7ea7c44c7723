//! Detection, isolation and the particle filter have one meaning of noise: each pair says the same of the same torques.

use std::sync::Arc;

use contactsense::isolation::{ContactIsolator, IsolatorOptions};
use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::particle::{ContactParticleFilter, FilterOptions};
use contactsense::robot::Robot;
use contactsense::{NoiseModel, Sample};

const Q: [f64; 7] = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2];
/// Ticks in which an observer of 50/s at 1 kHz settles.
const SETTLED: usize = 1000;

fn noise() -> NoiseModel {
    NoiseModel {
        torque: vec![0.3, 0.25, 0.2, 0.15, 0.1, 0.05, 0.05],
        model: vec![0.4, 0.4, 0.3, 0.3, 0.1, 0.1, 0.05],
        relative: vec![0.05],
        ..NoiseModel::default()
    }
}

/// Torques of the size of the noise: of some, one joint alone tells them from none.
fn torques() -> impl Iterator<Item = Vec<f64>> {
    let noise = noise();
    let at_rest: Vec<f64> = noise.torque.iter().zip(&noise.model).map(|(t, m)| t.hypot(*m)).collect();
    (0..40).map(move |k| {
        let size = 2.0 + 0.05 * f64::from(k);
        at_rest
            .iter()
            .enumerate()
            .map(|(j, noise)| size * noise * (1.7 * (k as f64) + j as f64).sin())
            .collect()
    })
}

fn felt_by_isolator() -> Vec<bool> {
    let options =
        IsolatorOptions { noise: Some(noise()), torque_threshold: None, ..IsolatorOptions::default() };
    let mut isolator = ContactIsolator::new(Robot::example_arm().into(), &options).expect("valid options");
    let felt = |torque: Vec<f64>| {
        let isolation = isolator.isolate(&Q, &torque).expect("valid arguments");
        !(isolation.contacts.is_empty() && isolation.link_candidates.is_empty())
    };
    torques().map(felt).collect()
}

fn felt_by_filter() -> Vec<bool> {
    let felt = |torque: Vec<f64>| {
        let options = FilterOptions { particles: 50, noise: Some(noise()), ..FilterOptions::default() };
        let mut filter = ContactParticleFilter::new(Robot::example_arm().into(), options).expect("valid");
        filter.update(&Q, &torque).expect("valid arguments").estimate.contact.is_some()
    };
    torques().map(felt).collect()
}

fn felt_by_detection() -> Vec<bool> {
    let robot = Arc::new(Robot::example_arm());
    let mut options = MonitorOptions::new(1e-3);
    options.hold_time = 0.0;
    options.isolation.noise = Some(noise());
    options.isolation.torque_threshold = None;
    let rest = robot.inverse_dynamics(&Q, &[0.0; 7], &[0.0; 7]).expect("valid arguments");
    let felt = |torque: Vec<f64>| {
        let mut monitor = ContactMonitor::new(robot.clone(), &options).expect("valid options");
        let motors: Vec<f64> = rest.iter().zip(&torque).map(|(rest, external)| rest - external).collect();
        let tick = |_| {
            let report = monitor.update(&Sample::new(&Q, &[0.0; 7], &motors)).expect("valid arguments");
            report.collision
        };
        (0..SETTLED).map(tick).last() == Some(true)
    };
    torques().map(felt).collect()
}

#[test]
fn isolation_and_detection_feel_the_same_torques() {
    let felt = felt_by_isolator();
    assert_eq!(felt, felt_by_detection());
    assert!(felt.contains(&true) && felt.contains(&false), "{felt:?}");
}

#[test]
fn the_filter_and_detection_feel_the_same_torques() {
    assert_eq!(felt_by_filter(), felt_by_detection());
}

#[test]
fn the_filter_and_isolation_feel_the_same_torques() {
    assert_eq!(felt_by_filter(), felt_by_isolator());
}

#[test]
fn thresholds_are_a_short_form_of_noise() {
    let short = IsolatorOptions { torque_threshold: Some(vec![0.3]), ..IsolatorOptions::default() };
    let noise = NoiseModel {
        torque: vec![0.3 / 3.0],
        velocity: vec![0.0],
        relative: vec![0.01],
        model: vec![0.0],
        ..NoiseModel::default()
    };
    let long = IsolatorOptions { noise: Some(noise), torque_threshold: None, ..IsolatorOptions::default() };
    let robot = Arc::new(Robot::example_arm());
    let mut isolators =
        [short, long].map(|options| ContactIsolator::new(robot.clone(), &options).expect("valid options"));
    let tau = [1.3, -2.2, 0.4, 1.7, 0.2, -0.6, 0.1];
    let [short, long] = isolators.each_mut().map(|isolator| {
        let isolation = isolator.isolate(&Q, &tau).expect("valid arguments");
        format!("{:?}", isolation.contacts)
    });
    assert_eq!(short, long);
}
