//! One step of the momentum observer, and one tick of the monitor without a contact.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use contactsense::calibration::Calibration;
use contactsense::isolation::IsolatorOptions;
use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::observer::MomentumObserver;
use contactsense::Sample;
use criterion::{criterion_group, criterion_main, Criterion};

fn step(c: &mut Criterion) {
    let mut group = c.benchmark_group("momentum observer");
    for (name, robot) in [("arm, 7 joints", common::arm()), ("humanoid, nv 30", common::humanoid())] {
        let q = common::configuration(&robot, 0.4);
        let v = common::numbers(robot.nv(), 0.7);
        let tau = common::numbers(robot.nv(), 1.1);
        let mut calibration = Calibration::of_description(&robot);
        calibration.friction.coulomb.fill(0.5);
        calibration.hysteresis.fill(0.05);
        calibration.hysteresis_width.fill(1.0);
        (calibration.velocity_delay, calibration.torque_delay) = (0.003, 0.001);
        let mut calibrated =
            MomentumObserver::calibrated(&robot, 1e-3, &[50.0], &calibration).expect("valid settings");
        group.bench_function(format!("{name}, calibrated"), |b| {
            b.iter(|| black_box(calibrated.update(&Sample::new(&q, &v, &tau)).expect("valid input"))[0])
        });
        let mut observer = MomentumObserver::new(robot, 1e-3, &[50.0]).expect("valid settings");
        group.bench_function(name, |b| {
            b.iter(|| black_box(observer.update(&Sample::new(&q, &v, &tau)).expect("valid input"))[0])
        });
        group.bench_function(format!("{name}, with acceleration"), |b| {
            b.iter(|| {
                observer.update(&Sample::new(&q, &v, &tau)).expect("valid input");
                black_box(observer.acceleration())[0]
            })
        });
    }
    group.finish();
}

fn tick(c: &mut Criterion) {
    let mut group = c.benchmark_group("monitor, no contact");
    for (name, robot) in [("arm, 7 joints", common::arm()), ("humanoid, nv 30", common::humanoid())] {
        let q = common::configuration(&robot, 0.4);
        let rest = vec![0.0; robot.nv()];
        let tau = robot.inverse_dynamics(&q, &rest, &rest).expect("valid input");
        let options = MonitorOptions {
            observer_gain: vec![50.0],
            isolation: IsolatorOptions::default(),
            hold_time: 0.02,
            bias_time_constant: None,
            bias_settle_time: None,
            ..MonitorOptions::new(1e-3)
        };
        let mut monitor = ContactMonitor::new(robot, &options).expect("valid settings");
        group.bench_function(name, |b| {
            let sample = Sample::new(&q, &rest, &tau);
            b.iter(|| monitor.update(black_box(&sample)).expect("valid input").collision)
        });
        assert!(!monitor.report().collision);

        let calibration = Some(Calibration::of_description(monitor.robot()));
        let mut options = MonitorOptions { calibration, ..options };
        options.isolation.torque_threshold = None;
        let mut tested = ContactMonitor::new(monitor.robot().clone(), &options).expect("valid settings");
        group.bench_function(format!("{name}, all joints tested at once"), |b| {
            let sample = Sample::new(&q, &rest, &tau);
            b.iter(|| tested.update(black_box(&sample)).expect("valid input").collision)
        });
        assert!(!tested.report().collision && tested.report().significance.is_some());
    }
    group.finish();
}

criterion_group!(benches, step, tick);
criterion_main!(benches);
