//! One update of a particle filter, and its parts: motion, likelihood, resampling, estimate.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use contactsense::particle::{ContactParticleFilter, FilterOptions, Stages};
use criterion::{criterion_group, criterion_main, BatchSize, Criterion, Throughput};

fn update(c: &mut Criterion) {
    let mut group = c.benchmark_group("particle filter, update");
    let robot = common::meshed_arm();
    let run = common::ball_run(&robot, "arm_4", 40);
    for (particles, threads) in [(300, 1), (10_000, 1), (10_000, 2), (100_000, 1)] {
        let options = FilterOptions { particles, threads, ..FilterOptions::default() };
        let mut filter = ContactParticleFilter::new(robot.clone(), options).expect("valid options");
        let mut step = 0;
        group.throughput(Throughput::Elements(particles as u64));
        group.bench_function(format!("{particles} particles, threads: {threads}"), |b| {
            b.iter(|| {
                let k = step % run.poses.len();
                step += 1;
                black_box(filter.update(&run.poses[k], &run.torques[k]).expect("valid input").updates)
            })
        });
    }
    group.finish();
}

fn stages(c: &mut Criterion) {
    let mut group = c.benchmark_group("particle filter, parts");
    let robot = common::meshed_arm();
    let run = common::ball_run(&robot, "arm_4", 2);
    let options = FilterOptions::default();
    group.throughput(Throughput::Elements(options.particles as u64));
    let mut moved = Stages::new(robot, options, &run.poses[0], &run.torques[0]).expect("valid options");
    let mut step = 0;
    group.bench_function("motion", |b| {
        b.iter(|| {
            step += 1;
            moved.motion(&run.poses[step % 2], &run.torques[step % 2]).expect("valid input");
        })
    });
    group.bench_function("likelihood", |b| {
        b.iter_batched_ref(|| moved.clone(), |stages| stages.likelihood(), BatchSize::LargeInput)
    });
    let mut weighed = moved.clone();
    weighed.likelihood();
    group.bench_function("resampling", |b| {
        b.iter_batched_ref(|| weighed.clone(), |stages| stages.resampling(), BatchSize::LargeInput)
    });
    group.bench_function("estimate", |b| b.iter(|| weighed.estimate()));
    group.finish();
}

criterion_group!(benches, update, stages);
criterion_main!(benches);
