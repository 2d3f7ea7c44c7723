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
    let surface = robot.links()[link].surface.as_ref().expect("a surface");
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

criterion_group!(benches, single_contact);
criterion_main!(benches);
