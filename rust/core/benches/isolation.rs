//! One single contact from an external torque: link, point and force.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::sync::Arc;

use contactsense::isolation::{ContactIsolator, IsolatorOptions};
use contactsense::robot::Robot;
use criterion::{criterion_group, criterion_main, Criterion};

/// A push on the side of the last link: where, and the external torque.
fn push(robot: &Robot, q: &[f64]) -> Vec<f64> {
    let link = *robot.touchable_links().last().expect("links with a surface");
    let pose = robot.link_pose(q, link).expect("a valid link");
    let surface = robot[link].surface.as_ref().expect("a surface");
    let sample = surface.sample(1, 5)[0];
    let point = pose.transform_point(&sample.point);
    let tilt = nalgebra::Vector3::new(0.2, -0.1, 0.15);
    common::torque_of(robot, q, link, point.into(), (tilt - pose.rotation * sample.normal) * 20.0)
}

fn single_contact(c: &mut Criterion) {
    let mut group = c.benchmark_group("isolation, one contact");
    let robots: [(&str, Arc<Robot>); 2] =
        [("arm, 7 joints", common::arm()), ("humanoid, nv 30", common::humanoid())];
    for (name, robot) in robots {
        let q = common::configuration(&robot, 0.4);
        let tau_ext = push(&robot, &q);
        let mut isolator = ContactIsolator::new(robot, &IsolatorOptions::default()).expect("valid settings");
        let found = isolator.isolate(&q, &tau_ext).expect("valid input");
        assert!(found.contacts.len() == 1 && found.contacts[0].located, "{found:?}");
        group.bench_function(name, |b| {
            b.iter(|| black_box(isolator.isolate(&q, &tau_ext).expect("valid input")).residual)
        });
    }
    group.finish();
}

/// A threshold of three standard deviations of the noise, which decides how many explanations are tried.
fn noisy_torques(c: &mut Criterion) {
    const NOISE: f64 = 0.1; // [Nm]
    const KINDS: [(&str, f64, f64); 3] =
        [("one contact", 1.0, NOISE), ("a weak one", 0.1, NOISE), ("none", 0.0, 30.0)];
    const DRAWS: usize = 64;
    let mut group = c.benchmark_group("isolation, noisy torques");
    let robots: [(&str, Arc<Robot>); 2] =
        [("arm, 7 joints", common::arm()), ("humanoid, nv 30", common::humanoid())];
    for (name, robot) in robots {
        let q = common::configuration(&robot, 0.4);
        let tau_ext = push(&robot, &q);
        for (kind, share, noise) in KINDS {
            let pushed: Vec<f64> = tau_ext.iter().map(|torque| share * torque).collect();
            let drawn: Vec<_> = (0..DRAWS).map(|k| common::noisy(&pushed, noise, k as f64)).collect();
            let options = IsolatorOptions { torque_threshold: Some(vec![3.0 * NOISE]), ..Default::default() };
            let mut isolator = ContactIsolator::new(robot.clone(), &options).expect("valid settings");
            let mut next = 0;
            group.bench_function(format!("{name}, {kind}"), |b| {
                b.iter(|| {
                    next = (next + 1) % DRAWS;
                    black_box(isolator.isolate(&q, &drawn[next]).expect("valid input")).residual
                })
            });
        }
    }
    group.finish();
}

criterion_group!(benches, single_contact, noisy_torques);
criterion_main!(benches);
