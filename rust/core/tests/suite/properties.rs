//! Any input gives an answer or an error: nothing panics, and an error leaves the state as it was.

use crate::common;
use contactsense::isolation::{ContactIsolator, ContactPlace, IsolatorOptions};
use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::observer::MomentumObserver;
use contactsense::sensor::{Convention, ForceTorqueSensor, SensorIndex};
use contactsense::{Error, Sample};
use proptest::prelude::*;

/// Numbers of any size, now and then no number.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -10.0..10.0,
        1 => proptest::num::f64::ANY,
        1 => Just(0.0),
    ]
}

/// A measured time step, or none.
fn any_step() -> impl Strategy<Value = Option<f64>> {
    prop_oneof![4 => Just(None), 4 => (1e-4..0.03).prop_map(Some), 1 => any_number().prop_map(Some)]
}

fn vector(length: usize) -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![
        9 => proptest::collection::vec(any_number(), length),
        1 => proptest::collection::vec(any_number(), 0..length + 3),
    ]
}

fn sensible(values: &[f64], length: usize) -> bool {
    values.len() == length && values.iter().all(|x| x.abs() < 1e60)
}

fn options() -> MonitorOptions {
    MonitorOptions {
        observer_gain: vec![500.0],
        isolation: IsolatorOptions { torque_threshold: Some(vec![0.1]), ..IsolatorOptions::default() },
        hold_time: 0.01,
        bias_time_constant: Some(0.003),
        bias_settle_time: None,
        ..MonitorOptions::new(1e-3)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn the_observer_refuses_or_answers(v in vector(7), tau in vector(7), dt in any_number()) {
        let robot = common::arm();
        let q = common::configuration(&robot, 0.2);
        let mut observer = MomentumObserver::new(robot.clone(), 1e-3, &[100.0]).unwrap();
        let calm = vec![0.1; 7];
        let at_rest = Sample::new(&q, &calm, &calm);
        observer.update(&at_rest).unwrap();
        let before = observer.update(&at_rest).unwrap().to_vec();
        let good = sensible(&v, 7) && sensible(&tau, 7) && (1e-9..=1e9).contains(&dt);
        let outcome = observer.update(&Sample::new(&q, &v, &tau).dt(dt)).map(<[f64]>::to_vec);
        match outcome {
            Ok(torque) => {
                prop_assert!(good);
                prop_assert_eq!(torque.len(), 7);
            }
            Err(error) => {
                prop_assert!(!good && matches!(error, Error::Input { .. }), "{error}");
                prop_assert_eq!(observer.external_torque(), &before[..]);
            }
        }
    }

    #[test]
    fn the_isolator_refuses_or_answers(tau_ext in vector(31), seed in -5.0..5.0) {
        let robot = common::humanoid();
        let q = common::configuration(&robot, seed);
        let nv = robot.nv();
        let mut isolator = ContactIsolator::new(robot.clone(), &IsolatorOptions::default()).unwrap();
        let tau_ext: Vec<f64> = tau_ext.into_iter().chain(std::iter::repeat(0.0)).take(nv).collect();
        let good = sensible(&tau_ext, nv);
        match isolator.isolate(&q, &tau_ext) {
            Ok(isolation) => {
                prop_assert!(good);
                for contact in &isolation.contacts {
                    let finite = |place: ContactPlace| place.point.iter().chain([&place.std]).all(|x| x.is_finite());
                    prop_assert!(!contact.located || contact.place.is_some_and(finite));
                    prop_assert!(contact.place.is_none() || contact.wrench.is_some());
                    prop_assert!(robot.touchable_links().contains(&contact.link));
                }
            }
            Err(error) => prop_assert!(!good && matches!(error, Error::Input { .. }), "{error}"),
        }
    }

    #[test]
    fn the_monitor_refuses_or_answers(ticks in proptest::collection::vec((vector(7), vector(7)), 1..20)) {
        let robot = common::arm();
        let q = common::configuration(&robot, 0.2);
        let mut monitor = ContactMonitor::new(robot.clone(), &options()).unwrap();
        for (v, tau) in ticks {
            let before = monitor.report().clone();
            let good = sensible(&v, 7) && sensible(&tau, 7);
            match monitor.update(&Sample::new(&q, &v, &tau)) {
                Ok(_) => prop_assert!(good),
                Err(error) => {
                    prop_assert!(!good && matches!(error, Error::Input { .. }), "{error}");
                    prop_assert_eq!(monitor.report(), &before);
                }
            }
        }
    }

    #[test]
    fn the_monitor_with_sensors_refuses_or_answers(
        ticks in proptest::collection::vec((vector(7), vector(7), vector(12), any_step()), 1..20)
    ) {
        let robot = common::arm();
        let q = common::configuration(&robot, 0.2);
        let sensor = |name: &str| ForceTorqueSensor {
            convention: Convention::Support,
            ..ForceTorqueSensor::new(name, name)
        };
        let mut options = options();
        options.isolation.sensors = vec![sensor("arm_2"), sensor("arm_5")];
        options.isolation.wanted_contacts = vec!["arm_5".into()];
        let mut monitor = ContactMonitor::new(robot.clone(), &options).unwrap();
        let (mut silent_before, mut ever_silent, mut left_before) = ([false; 2], [false; 2], [false; 2]);
        let mut refused = false;
        for (v, tau, readings, dt) in ticks {
            let before = monitor.report().clone();
            let has_reading = |row: &[f64; 6]| !row.iter().any(|x| x.is_nan());
            let rows: Vec<Option<[f64; 6]>> =
                readings.as_chunks::<6>().0.iter().map(|row| Some(*row).filter(has_reading)).collect();
            let timed = dt.is_none_or(|dt| (1e-9..=1e9).contains(&dt));
            let good = timed
                && sensible(&v, 7)
                && sensible(&tau, 7)
                && rows.len() == 2
                && rows.iter().flatten().flatten().all(|x| x.abs() < 1e60);
            let sample = Sample::new(&q, &v, &tau).wrenches(&rows);
            match monitor.update(&dt.map_or(sample, |dt| sample.dt(dt))) {
                Ok(report) => {
                    prop_assert!(good);
                    // A sensor that comes back is left out for one more tick, and over a gap until the next; the wanted one,
                    // for as long as the observer still knows too little of it.
                    let gap = refused || dt.is_some_and(|dt| dt > 0.05);
                    refused = false;
                    let silent: Vec<bool> = rows.iter().map(Option::is_none).collect();
                    let left_out = |sensor| report.sensors_left_out.contains(&SensorIndex::new(sensor));
                    for sensor in 0..2 {
                        let at_least = silent[sensor] || silent_before[sensor];
                        ever_silent[sensor] |= silent[sensor];
                        prop_assert!(left_out(sensor) || !at_least, "{sensor}");
                        let excused = (sensor == 1 && ever_silent[1]) || (gap && left_before[sensor]);
                        prop_assert!(at_least || !left_out(sensor) || excused, "{sensor}");
                        left_before[sensor] = left_out(sensor);
                    }
                    silent_before.copy_from_slice(&silent);
                    prop_assert!(report.collision_torque.iter().all(|x| x.is_finite()));
                }
                Err(error) => {
                    refused = true;
                    prop_assert!(!good && matches!(error, Error::Input { .. }), "{error}");
                    prop_assert_eq!(monitor.report(), &before);
                }
            }
        }
    }
}
