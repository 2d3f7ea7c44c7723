//! The posterior of one contact over a robot's surface, from noisy torques; and what torques would tell without a measurement.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::sync::Arc;

use contactsense::map::{ContactMap, MapOptions};
use contactsense::robot::Robot;
use contactsense::NoiseModel;
use criterion::{criterion_group, criterion_main, Criterion};

const NOISE: f64 = 0.1; // [Nm]
const SAMPLES: [usize; 2] = [1_000, 5_000];
/// Contacts that are evaluated in turn, each on a link of its own.
const CONTACTS: usize = 64;

fn robots() -> [(&'static str, Arc<Robot>); 3] {
    [
        ("example arm, 7 joints", Arc::new(Robot::example_arm())),
        ("meshed arm, 7 joints", common::meshed_arm()),
        ("humanoid, nv 30", common::humanoid()),
    ]
}

fn map(robot: &Arc<Robot>, samples: usize) -> ContactMap {
    let noise = NoiseModel { torque: vec![NOISE], model: vec![0.0], ..NoiseModel::default() };
    ContactMap::new(robot.clone(), &MapOptions { samples, noise, ..MapOptions::default() })
        .expect("valid options")
}

/// A pose, and the torque of a force of 10 to 60 N inside the friction cone somewhere on a link that moves.
fn contact(robot: &Robot, map: &ContactMap, number: usize) -> (Vec<f64>, Vec<f64>) {
    let seed = number as f64;
    let q = common::configuration(robot, seed);
    let link = contactsense::robot::LinkIndex::new(map.links()[number % map.links().len()]);
    let pose = robot.link_pose(&q, link).expect("a valid link");
    let sample = robot[link].surface.as_ref().expect("a surface").sample(1, number as u64)[0];
    let tilt = nalgebra::Vector3::from_column_slice(&common::numbers(3, seed)) * 0.1;
    let force = (tilt - pose.rotation * sample.normal) * (35.0 + 25.0 * seed.sin());
    let point = pose.transform_point(&sample.point);
    let torque = common::torque_of(robot, &q, link, point.into(), force);
    (q, common::noisy(&torque, NOISE, seed))
}

fn evaluate(c: &mut Criterion) {
    let mut group = c.benchmark_group("contact map, one contact");
    for (name, robot) in robots() {
        for samples in SAMPLES {
            let mut map = map(&robot, samples);
            let contacts: Vec<_> = (0..CONTACTS).map(|number| contact(&robot, &map, number)).collect();
            let mut next = 0;
            group.bench_function(format!("{name}, {samples} samples"), |b| {
                b.iter(|| {
                    next = (next + 1) % CONTACTS;
                    let (q, torque) = &contacts[next];
                    black_box(map.evaluate(q, torque).expect("valid input")).log_evidence
                })
            });
        }
    }
    group.finish();
}

/// Torques that no contact explains.
fn without_cause(c: &mut Criterion) {
    const SIZE: f64 = 10.0; // [Nm]
    let mut group = c.benchmark_group("contact map, random torques");
    for (name, robot) in robots() {
        for samples in SAMPLES {
            let mut map = map(&robot, samples);
            let still = vec![0.0; robot.nv()];
            let drawn: Vec<_> = (0..CONTACTS)
                .map(|k| (common::configuration(&robot, k as f64), common::noisy(&still, SIZE, k as f64)))
                .collect();
            let mut next = 0;
            group.bench_function(format!("{name}, {samples} samples"), |b| {
                b.iter(|| {
                    next = (next + 1) % CONTACTS;
                    let (q, torque) = &drawn[next];
                    black_box(map.evaluate(q, torque).expect("valid input")).log_evidence
                })
            });
        }
    }
    group.finish();
}

fn identifiability(c: &mut Criterion) {
    const FORCE: f64 = 10.0; // [N]
    let mut group = c.benchmark_group("contact map, identifiability");
    for (name, robot) in robots() {
        for samples in SAMPLES {
            let map = map(&robot, samples);
            let q = common::configuration(&robot, 0.4);
            group.bench_function(format!("{name}, {samples} samples"), |b| {
                b.iter(|| black_box(map.identifiability(&q, FORCE).expect("valid input")))
            });
        }
    }
    group.finish();
}

criterion_group!(benches, evaluate, without_cause, identifiability);
criterion_main!(benches);
