//! The particle filter finds a ball that an arm leans on, the same on any number of threads.

use crate::common;
use contactsense::particle::{
    ContactParticleFilter, ContactParticles, Event, FilterOptions, Likelihood, Motion, Schedule,
};
use contactsense::Error;

fn filter(
    robot: &std::sync::Arc<contactsense::robot::Robot>,
    options: FilterOptions,
) -> ContactParticleFilter {
    ContactParticleFilter::new(robot.clone(), options).expect("valid options")
}

#[test]
fn a_ball_is_found_on_meshes_and_on_primitives() {
    for robot in [common::arm(), common::meshed_arm()] {
        for link in ["arm_3", "arm_5"] {
            let run = common::ball_run(&robot, link, 40);
            let mut filter = filter(&robot, FilterOptions::default());
            for (q, torque) in run.poses.iter().zip(&run.torques) {
                filter.update(q, torque).expect("valid input");
            }
            let found = filter.estimate();
            let estimate = &found.estimate;
            let contact = estimate.contact.expect("a contact");
            let error = (contact.point - run.points[39]).norm();
            assert_eq!(contact.link, run.link, "{} {link}", robot.name());
            assert!(error < 5e-3, "{} {link}: {error}", robot.name());
            assert!(found.explained && !estimate.ambiguous && found.event == Event::Continued);
            let sum: f64 = estimate.link_probabilities.iter().sum();
            assert!((sum - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let robot = common::meshed_arm();
    let run = common::ball_run(&robot, "arm_4", 12);
    for (motion, likelihood, schedule, max_contacts) in [
        (Motion::Curvature, Likelihood::Gaussian, Schedule::Adaptive, 1),
        (Motion::Curvature, Likelihood::Gaussian, Schedule::Adaptive, 3),
        (Motion::FixedInWorld, Likelihood::Gaussian, Schedule::Adaptive, 1),
        (Motion::FixedOnLink, Likelihood::Gaussian, Schedule::Adaptive, 1),
        (Motion::Curvature, Likelihood::Exponential, Schedule::paper(), 1),
    ] {
        let particles = [1, 2, 4].map(|threads| {
            let schedule = schedule.clone();
            let options = FilterOptions {
                particles: 5000,
                seed: 7,
                threads,
                motion,
                likelihood,
                schedule,
                max_contacts,
                ..FilterOptions::default()
            };
            let mut filter = filter(&robot, options);
            for (q, torque) in run.poses.iter().zip(&run.torques) {
                // Of more than one contact: no single push does that.
                let aside = if max_contacts > 1 { 3.0 } else { 0.0 };
                let torque: Vec<f64> = torque.iter().map(|torque| torque + aside).collect();
                filter.update(q, &torque).expect("valid input");
            }
            assert_eq!(filter.contacts().len() > 1, max_contacts > 1);
            let bits = |own: ContactParticles<'_>| {
                let columns = own.columns();
                let of = |k: usize| {
                    let (p, n) = (columns.point[k], columns.normal[k]);
                    let numbers = [p.x, p.y, p.z, n.x, n.y, n.z, columns.force[k], columns.stiffness[k]];
                    (columns.link[k], numbers.map(f64::to_bits), own.weights()[k].to_bits())
                };
                (0..columns.len()).map(of).collect::<Vec<_>>()
            };
            filter.contacts().flat_map(bits).collect::<Vec<_>>()
        });
        assert_eq!(particles[0], particles[1]);
        assert_eq!(particles[0], particles[2]);
    }
}

/// All that shows of a filter's state.
fn snapshot(filter: &ContactParticleFilter) -> (Vec<[u64; 3]>, Vec<u64>, u64, String) {
    let own = filter.contacts().next().expect("one");
    let points = (0..filter.particles().len()).map(|k| <[f64; 3]>::from(own.point(k)).map(f64::to_bits));
    let weights = filter.weights().iter().map(|weight| weight.to_bits());
    let estimate = filter.estimate();
    (points.collect(), weights.collect(), estimate.updates, format!("{estimate:?}"))
}

#[test]
fn bad_input_changes_nothing() {
    let robot = common::meshed_arm();
    let run = common::ball_run(&robot, "arm_4", 3);
    let mut filter = filter(&robot, FilterOptions { particles: 500, ..FilterOptions::default() });
    filter.update(&run.poses[0], &run.torques[0]).expect("valid input");
    let before = snapshot(&filter);
    let mut nan = run.torques[1].clone();
    nan[2] = f64::NAN;
    for (q, torque, name) in [
        (&run.poses[1], &nan, "tau_ext"),
        (&run.torques[1], &run.torques[1], "q"),
        (&run.poses[1], &vec![0.0], "tau_ext"),
    ] {
        let error = filter.update(q, torque).map(|_| ()).expect_err("refused");
        assert!(matches!(&error, Error::Input { argument, .. } if argument == name), "{error}");
        assert_eq!(snapshot(&filter), before);
    }
}
