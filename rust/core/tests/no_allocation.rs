//! `update` and `isolate` allocate nothing after the first call.

use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

use contactsense::calibration::Calibration;
use contactsense::classification::{ClassifierOptions, ContactClassifier};
use contactsense::isolation::{ContactIsolator, IsolatorOptions};
use contactsense::map::{ContactMap, MapOptions};
use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::observer::MomentumObserver;
use contactsense::particle::{ContactParticleFilter, FilterOptions, ForceModel};
use contactsense::reaction::{Reaction, ReactionLimits};
use contactsense::robot::Robot;
use contactsense::sampler::{ContactModel, SamplerOptions, StaticObstacleSampler};
use contactsense::sensor::{ForceTorqueSensor, LoadCompensator};
use contactsense::{ExternalSample, Sample};
use nalgebra::Vector3;

mod common;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);
/// The counter is the process's: one test at a time.
static ALONE: Mutex<()> = Mutex::new(());

struct Counting;

// SAFETY: every call is handed on to the system's allocator unchanged; the counter is atomic.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations of `work`; the least of three runs, since the test harness has threads of its own.
fn allocations(mut work: impl FnMut()) -> usize {
    (0..3)
        .map(|_| {
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            work();
            ALLOCATIONS.load(Ordering::Relaxed) - before
        })
        .min()
        .expect("three runs")
}

/// External torques of touches on every link, and of several at once.
fn touches(robot: &Robot, q: &[f64]) -> Vec<Vec<f64>> {
    let mut torques = vec![];
    for &link in robot.touchable_links() {
        let surface = robot[link].surface.as_ref().expect("a touchable link");
        for sample in surface.sample(5, 1) {
            let pose = robot.link_pose(q, link).expect("a valid link");
            let point = pose.transform_point(&sample.point);
            let force = pose.rotation * (-20.0 * sample.normal + Vector3::new(3.0, -2.0, 1.0));
            torques.push(common::torque_of(robot, q, link, point.into(), force));
        }
    }
    // Two, three and four at once, exact and not.
    let count = torques.len();
    for apart in 1..count {
        for parts in 2..5 {
            let mut sum = vec![0.0; robot.nv()];
            for part in 0..parts {
                let other = &torques[(part * apart) % count];
                sum.iter_mut().zip(other).for_each(|(sum, torque)| *sum += torque);
            }
            let noisy =
                sum.iter().enumerate().map(|(k, torque)| torque * (1.0 + 0.02 * (7.0 * k as f64).sin()));
            torques.extend([noisy.collect(), sum]);
        }
    }
    torques
}

#[test]
fn a_tick_allocates_nothing() {
    let _alone = ALONE.lock().expect("the other test has not failed");
    assert!(allocations(|| drop(black_box(Vec::<u8>::with_capacity(100)))) > 0, "the counter is dead");

    for robot in [common::arm(), common::humanoid()] {
        let q = common::configuration(&robot, 0.4);
        let v = common::numbers(robot.nv(), 0.1);
        let still = vec![0.0; robot.nv()];
        let tau = common::numbers(robot.nv() - robot.unactuated(), 0.7);

        let mut calibration = Calibration::of_description(&robot);
        calibration.friction.coulomb.fill(0.5);
        (calibration.velocity_delay, calibration.torque_delay) = (0.003, 0.001);
        let mut calibrated =
            MomentumObserver::calibrated(&robot, 1e-3, &[100.0], &calibration).expect("valid options");
        let made = allocations(|| {
            for _ in 0..100 {
                let sample = Sample::new(&q, &v, &tau);
                black_box(calibrated.update(&sample).expect("valid input"));
            }
        });
        assert_eq!(made, 0, "calibrated observer of {}", robot.name());

        let mut observer = MomentumObserver::new(robot.clone(), 1e-3, &[100.0]).expect("valid options");
        let work = || {
            for _ in 0..50 {
                let sample = Sample::new(&q, &v, &tau).friction(&tau);
                black_box(observer.update(&sample).expect("valid input"));
                black_box(observer.acceleration());
            }
            assert!(observer.update(&Sample::new(&q[1..], &v, &tau)).is_err());
        };
        // The message of an error may allocate; that is no tick of the control loop.
        let made = allocations(work);
        assert!(made <= 1, "observer of {}: {made} allocations", robot.name());

        let torques = touches(&robot, &q);
        let mut isolator =
            ContactIsolator::new(robot.clone(), &IsolatorOptions::default()).expect("valid options");
        let (mut located, mut open) = (0, 0);
        let work = || {
            for torque in &torques {
                let isolation = isolator.isolate(&q, torque).expect("valid input");
                located += isolation.contacts.iter().filter(|contact| contact.located).count();
                open += isolation.contacts.iter().filter(|contact| !contact.located).count();
            }
        };
        assert_eq!(allocations(work), 0, "isolator of {}", robot.name());
        assert!(located > 0 && open > 0, "both branches are run: {located}, {open}");

        let options = IsolatorOptions { torque_threshold: Some(vec![0.3]), ..IsolatorOptions::default() };
        let mut isolator = ContactIsolator::new(robot.clone(), &options).expect("valid options");
        let noisy: Vec<_> = (0..torques.len()).map(|k| common::noisy(&torques[k], 0.1, k as f64)).collect();
        let causeless: Vec<_> = (0..50).map(|k| common::noisy(&still, 30.0, f64::from(k))).collect();
        let work = || {
            for torque in noisy.iter().chain(&causeless) {
                black_box(isolator.isolate(&q, torque).expect("valid input"));
            }
        };
        assert_eq!(allocations(work), 0, "isolator of {}, noisy torques", robot.name());

        let options = MonitorOptions {
            observer_gain: vec![500.0],
            isolation: IsolatorOptions { torque_threshold: Some(vec![0.01]), ..IsolatorOptions::default() },
            hold_time: 0.01,
            bias_time_constant: Some(0.02),
            bias_settle_time: Some(5.0),
            ..MonitorOptions::new(1e-3)
        };
        let mut monitor = ContactMonitor::new(robot.clone(), &options).expect("valid options");
        let weight = robot.inverse_dynamics(&q, &still, &still).expect("valid input");
        let mut seen = 0;
        let mut ticks = 0;
        let mut tick = |monitor: &mut ContactMonitor, torque: Option<&Vec<f64>>| {
            ticks += 1;
            // Now and then the step is measured.
            let timed = ticks % 3 == 0;
            let mut tau = weight.clone();
            if let Some(torque) = torque {
                tau.iter_mut().zip(torque).for_each(|(tau, ext)| *tau -= ext);
            }
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            let sample = Sample::new(&q, &still, &tau);
            let sample = if timed { sample.dt(1.5e-3) } else { sample };
            let report = monitor.update(&sample).expect("valid input");
            let after = ALLOCATIONS.load(Ordering::Relaxed);
            seen += usize::from(!report.isolation.contacts.is_empty());
            after - before
        };
        for _ in 0..30 {
            tick(&mut monitor, None);
        }
        let contact = allocations(|| ()) + (0..40).map(|_| tick(&mut monitor, torques.last())).sum::<usize>();
        let free = (0..40).map(|_| tick(&mut monitor, None)).sum::<usize>();
        assert_eq!((contact, free), (0, 0), "monitor of {}", robot.name());

        let mut options = MonitorOptions { calibration: Some(calibration), ..MonitorOptions::new(1e-3) };
        options.isolation.torque_threshold = None;
        let mut tested = ContactMonitor::new(robot.clone(), &options).expect("valid options");
        for _ in 0..30 {
            tick(&mut tested, None);
        }
        let contact = (0..100).map(|_| tick(&mut tested, torques.last())).sum::<usize>();
        assert!(tested.report().collision, "the test of all joints saw the contact");
        let free = (0..1000).map(|_| tick(&mut tested, None)).sum::<usize>();
        assert_eq!((contact, free), (0, 0), "monitor of {}, all joints tested at once", robot.name());
        assert!(tested.report().significance.is_some());
        assert!(seen > 30, "the monitor saw the contact: {seen}");

        let mut given = Calibration::of_description(&robot);
        given.torque_is_external = true;
        let thresholds = MonitorOptions { bias_time_constant: Some(0.02), ..MonitorOptions::new(1e-3) };
        let isolation = IsolatorOptions { torque_threshold: None, ..thresholds.isolation.clone() };
        let tested = MonitorOptions { calibration: Some(given), isolation, ..MonitorOptions::new(1e-3) };
        for options in [thresholds, tested] {
            let mut monitor = ContactMonitor::new(robot.clone(), &options).expect("valid options");
            let work = || {
                for k in 0..120 {
                    let torque = if k / 40 == 1 { &torques[0] } else { &still };
                    let sample = ExternalSample::new(&q, torque);
                    let sample = [sample, sample.velocity(&v), sample.dt(1.0)][k % 3];
                    black_box(monitor.update_external(&sample).expect("valid input"));
                }
            };
            assert_eq!(allocations(work), 0, "monitor of {} with external torques", robot.name());
        }

        let sensors = sensors_of(&robot);
        let readings = vec![Some([1.0, -2.0, 3.0, 0.1, 0.2, -0.3]); sensors.len()];
        let mut silent = readings.clone();
        silent[0] = None;
        let mut compensator = LoadCompensator::new(robot.clone(), &sensors).expect("valid sensors");
        let work = || {
            for row in [&readings, &silent] {
                black_box(compensator.update(&q, &v, &v, row).expect("valid input"));
            }
        };
        assert_eq!(allocations(work), 0, "compensator of {}", robot.name());

        let isolation = IsolatorOptions {
            wanted_contacts: vec![sensors[0].name.clone()],
            sensors,
            ..IsolatorOptions::default()
        };
        let options =
            MonitorOptions { isolation, bias_time_constant: Some(0.02), ..MonitorOptions::new(1e-3) };
        let mut monitor = ContactMonitor::new(robot.clone(), &options).expect("valid options");
        let sample = Sample::new(&q, &v, &tau);
        monitor.update(&sample.wrenches(&readings)).expect("valid input");
        let work = || {
            for k in 0..40 {
                let row = if k % 10 == 9 { &silent } else { &readings };
                // Nominal, another and far too long for a step.
                let sample = sample.wrenches(row);
                let sample = [sample, sample.dt(2e-3), sample.dt(1.0)][k % 3];
                black_box(monitor.update(&sample).expect("valid input"));
            }
        };
        assert_eq!(allocations(work), 0, "monitor of {} with sensors", robot.name());
        let report = monitor.report();
        assert_eq!((report.sensors_left_out.len(), report.wrenches.len()), (1, readings.len()));
    }
}

#[test]
fn classes_and_reactions_allocate_nothing() {
    let _alone = ALONE.lock().expect("the other test has not failed");
    let robot = std::sync::Arc::new(Robot::example_arm());
    let (q, v) = ([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.1], [0.05; 7]);
    let still = [0.0; 7];
    let weight = robot.inverse_dynamics(&q, &still, &still).expect("valid input");
    let mut monitor = ContactMonitor::new(robot.clone(), &MonitorOptions::new(1e-3)).expect("valid options");
    let mut classifier =
        ContactClassifier::new(robot.clone(), &ClassifierOptions::default()).expect("valid options");
    let limits = ReactionLimits::of(&robot);
    let mut reaction = Reaction::new(robot, 1e-3, limits).expect("valid limits");
    let (mut seen, mut counted) = (0, 0);
    for tick in 0..600 {
        let push = if tick % 250 > 80 { 6.0 } else { 0.0 };
        let tau: Vec<f64> = weight.iter().map(|tau| tau - push).collect();
        let report = monitor.update(&Sample::new(&q, &still, &tau)).expect("valid input").clone();
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        seen += classifier.update(&q, &v, &report).expect("valid input").len();
        black_box(reaction.retract(&v, &report.collision_torque, 0.02).expect("valid input"));
        black_box(reaction.gravity_compensation(&q, &v, 1.0).expect("valid input"));
        // The test harness has threads of its own, which allocate now and then.
        counted += usize::from(ALLOCATIONS.load(Ordering::Relaxed) > before);
    }
    assert!(seen > 200, "contacts were followed: {seen}");
    assert!(counted <= 5, "{counted} of 600 ticks");
}

#[test]
fn an_evaluation_of_a_map_allocates_nothing() {
    let _alone = ALONE.lock().expect("the other tests have not failed");
    for robot in [common::arm(), common::humanoid()] {
        let q = common::configuration(&robot, 0.4);
        let torques = touches(&robot, &q);
        let still = vec![0.0; robot.nv()];
        let noisy = (0..20).map(|k| common::noisy(&torques[k % torques.len()], 0.1, k as f64));
        let causeless = [0.1, 30.0, 1e6].into_iter().map(|size| common::noisy(&still, size, size));
        let inputs: Vec<_> = noisy.chain(causeless).chain([still.clone(), torques[0].clone()]).collect();
        let mut map = ContactMap::new(robot.clone(), &MapOptions::default()).expect("valid options");
        let mut contacts = 0;
        let work = || {
            for torque in &inputs {
                contacts += usize::from(map.evaluate(&q, torque).expect("valid input").log_evidence > 0.0);
            }
        };
        assert_eq!(allocations(work), 0, "map of {}", robot.name());
        assert!(contacts > 0, "no torque was taken for a contact");
    }
}

#[test]
fn an_update_of_particles_allocates_nothing_on_one_thread() {
    let _alone = ALONE.lock().expect("the other test has not failed");
    let robot = common::meshed_arm();
    let run = common::ball_run(&robot, "arm_4", 40);
    let idle = vec![0.0; robot.nv()];
    for (threads, max_contacts) in [(1, 1), (1, 3), (2, 1)] {
        let options = FilterOptions { particles: 3000, threads, max_contacts, ..FilterOptions::default() };
        // No single push adds the same torque to all joints.
        let aside = if max_contacts > 1 { 3.0 } else { 0.0 };
        let torques: Vec<Vec<f64>> =
            run.torques.iter().map(|torque| torque.iter().map(|torque| torque + aside).collect()).collect();
        let mut most = 0;
        let mut filter = ContactParticleFilter::new(robot.clone(), options).expect("valid options");
        filter.update(&run.poses[0], &run.torques[0]).expect("valid input");
        let mut felt = 0;
        let work = || {
            for (q, torque) in run.poses.iter().zip(&torques) {
                felt +=
                    usize::from(filter.update(q, torque).expect("valid input").estimate.contact.is_some());
                most = most.max(filter.contacts().len());
            }
            // The contact ends, and another search begins.
            filter.update(&run.poses[0], &idle).expect("valid input");
        };
        // The queue of the threads takes a block of memory every sixty updates or so.
        let allowed = if threads == 1 { 0 } else { 2 };
        let made = allocations(work);
        assert!(made <= allowed, "{threads} threads: {made} allocations");
        assert!(felt > 30, "the contact was felt: {felt}");
        assert_eq!(most > 1, max_contacts > 1, "contacts were added");
    }
}

#[test]
fn an_update_of_a_sampler_allocates_nothing_on_one_thread() {
    let _alone = ALONE.lock().expect("the other test has not failed");
    let robot = common::meshed_arm();
    let run = common::ball_run(&robot, "arm_4", 40);
    let idle = vec![0.0; robot.nv()];
    for threads in [1, 2] {
        let models = ContactModel::ALL.to_vec();
        let options =
            SamplerOptions { particles: 2000, window: 10, models, threads, ..SamplerOptions::default() };
        let mut sampler = StaticObstacleSampler::new(robot.clone(), &options).expect("valid options");
        sampler.update(&run.poses[0], &run.torques[0], None).expect("valid input");
        let mut felt = 0;
        let work = || {
            for (q, torque) in run.poses.iter().zip(&run.torques) {
                let found = sampler.update(q, torque, None).expect("valid input");
                felt += usize::from(found.estimate.contact.is_some());
            }
            sampler.update(&run.poses[0], &idle, None).expect("valid input");
        };
        let made = allocations(work);
        // The queue of the threads takes a block of memory every sixty times or so that work is shared.
        assert!(made <= if threads == 1 { 0 } else { 20 }, "{threads} threads: {made} allocations");
        assert!(felt > 30, "the contact was felt: {felt}");
    }
}

#[test]
fn an_update_of_a_sampler_of_several_contacts_with_friction_allocates_nothing() {
    let _alone = ALONE.lock().expect("the other tests have not failed");
    let robot = common::meshed_arm();
    let run = common::ball_run(&robot, "arm_4", 8);
    let options = SamplerOptions {
        particles: 200,
        window: 6,
        max_contacts: 3,
        force_model: ForceModel::FrictionCone(0.3),
        ..SamplerOptions::default()
    };
    let mut sampler = StaticObstacleSampler::new(robot, &options).expect("valid options");
    sampler.update(&run.poses[0], &run.torques[0], None).expect("valid input");
    let mut felt = 0;
    let made = allocations(|| {
        for (q, torque) in run.poses.iter().zip(&run.torques) {
            let found = sampler.update(q, torque, None).expect("valid input");
            felt += usize::from(found.estimate.contact.is_some());
        }
    });
    assert_eq!(made, 0);
    assert!(felt > 15, "the contact was felt: {felt}");
}

/// At the second and the last link of the arm, and of each limb.
fn sensors_of(robot: &Robot) -> Vec<ForceTorqueSensor> {
    let is_end = |name: &str| name.ends_with("_1") || name.ends_with("_5");
    let links = robot.links().iter().filter(|link| is_end(&link.name));
    links.map(|link| ForceTorqueSensor::new(link.name.clone(), link.name.clone())).collect()
}
