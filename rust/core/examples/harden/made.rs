//! Objects and results made from random options.

use std::sync::Arc;

use contactsense::calibration::{
    calibrate, exciting_motion, Calibration, CalibrationOptions, Excitation, Log,
};
use contactsense::diagnosis::{diagnose, Recording};
use contactsense::isolation::{ContactIsolator, IsolatorOptions};
use contactsense::map::{ContactMap, MapOptions};
use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::observer::MomentumObserver;
use contactsense::particle::{ContactParticleFilter, FilterOptions, ForceModel};
use contactsense::robot::Robot;
use contactsense::sensor::{identify_tool, LoadCompensator};
use contactsense::{best_cone_force, NoiseModel, Result};
use nalgebra::{Matrix3, Vector3};

use crate::random::Random;
use crate::robots::{configuration, link, sensor};

/// Most rows of a log: of most, which are then too short, and of one in twenty.
const ROWS: usize = 60;
const LONG_ROWS: usize = 3000;
/// Times of motions that must be refused (s).
const BAD_TIMES: [f64; 6] = [f64::NAN, f64::INFINITY, f64::MAX, -1.0, 0.0, 5e-324];

pub fn monitor_options(robot: &Robot, calibrated: bool) -> MonitorOptions {
    let mut options = MonitorOptions::new(1e-3);
    if calibrated {
        options.calibration = Some(Calibration::of_description(robot));
        options.isolation.torque_threshold = None;
    }
    options
}

fn noise(robot: &Robot, random: &mut Random) -> NoiseModel {
    let mut vector = || random.vector(robot.nv()).into_iter().map(f64::abs).collect();
    NoiseModel { torque: vector(), velocity: vector(), relative: vector(), ..NoiseModel::default() }
}

fn calibration(robot: &Robot, random: &mut Random) -> Calibration {
    let mut calibration = Calibration::of_description(robot);
    for field in [
        &mut calibration.torque_bias,
        &mut calibration.torque_scale,
        &mut calibration.friction.coulomb,
        &mut calibration.friction.viscous,
        &mut calibration.hysteresis,
        &mut calibration.hysteresis_width,
        &mut calibration.armature,
    ] {
        if random.once_in(4) {
            *field = random.vector(robot.nv());
        }
    }
    if random.once_in(3) {
        calibration.noise = noise(robot, random);
    }
    if random.once_in(3) {
        (calibration.velocity_delay, calibration.torque_delay) = (random.number(3), random.number(3));
    }
    if random.once_in(4) {
        calibration.false_alarms_per_hour = random.number(2);
    }
    calibration
}

fn monitor(robot: &Arc<Robot>, random: &mut Random) -> Result<bool> {
    let mut options = monitor_options(robot, random.once_in(2));
    if random.once_in(3) {
        options.calibration = Some(calibration(robot, random));
    }
    options.dt = if random.once_in(2) { 1e-3 } else { random.number(3) };
    if random.once_in(2) {
        options.observer_gain = random.vector(robot.nv());
        options.hysteresis = random.vector(1);
    }
    if random.once_in(2) {
        (options.hold_time, options.bias_limit) = (random.number(3), random.number(3));
        options.bias_time_constant = random.once_in(2).then(|| random.number(3));
        options.bias_settle_time = random.once_in(2).then(|| random.number(3));
        options.wrench_gain = random.once_in(2).then(|| random.number(3));
    }
    if random.once_in(4) {
        let name = random.one_of(&["link_7", "none", ""]).to_string();
        options.wanted_points = vec![(name, random.array())];
    }
    options.isolation = isolation(robot, random);
    options.samples = random.below(100);
    ContactMonitor::new(robot.clone(), &options).map(|_| true)
}

fn isolation(robot: &Robot, random: &mut Random) -> IsolatorOptions {
    let mut sensors = vec![];
    for _ in 0..random.below(3) {
        let mut sensor = sensor(robot);
        sensor.offset = random.array();
        sensor.pose.translation = random.array::<3>().into();
        sensors.push(sensor);
    }
    IsolatorOptions {
        torque_threshold: random.once_in(2).then(|| random.vector(robot.nv())),
        noise: random.once_in(2).then(|| noise(robot, random)),
        max_contacts: random.one_of(&[0, 1, 2, 5, 5, 100]),
        sensors,
        wrench_threshold: random.vector(1),
        wanted_contacts: if random.once_in(6) { vec!["none".into()] } else { vec![] },
        locate_within: if random.once_in(3) { random.number(2) } else { 0.05 },
        samples: random.below(100),
        pull_probability: if random.once_in(3) { random.number(2) } else { 0.05 },
        ..IsolatorOptions::default()
    }
}

fn log(robot: &Robot, random: &mut Random) -> Result<bool> {
    let most = if random.once_in(20) { LONG_ROWS } else { ROWS };
    let rows = random.below(most);
    let step = random.one_of(&[0.001, 0.05, 0.3, 0.0, -1.0, 1e300]);
    let mut columns = |width: usize| -> Vec<f64> {
        let odd = random.one_of(&[usize::MAX, usize::MAX, 50]);
        (0..rows * width).map(|_| random.number(odd)).collect()
    };
    let (v, tau) = (columns(robot.nv()), columns(robot.nv()));
    let q: Vec<f64> = (0..rows).flat_map(|_| configuration(robot, random)).collect();
    let time: Vec<f64> = (0..rows).map(|k| k as f64 * step).collect();
    if random.once_in(2) {
        let time = random.once_in(2).then_some(&time[..]);
        let recording = Recording { time, q: &q, v: &v, tau: &tau, sensors: &[], wrenches: &[] };
        return diagnose(robot, &recording).map(|_| true);
    }
    let options = CalibrationOptions {
        false_alarms_per_hour: if random.once_in(2) { 1.0 } else { random.number(2) },
        payload_link: random.once_in(2).then(|| link(robot, random)),
        torque_is_external: random.once_in(2),
    };
    calibrate(robot, &Log { time: &time, q: &q, v: &v, tau: &tau }, &options).map(|_| true)
}

/// One constructor or function of random options.
pub fn make(robot: &Arc<Robot>, random: &mut Random) -> (&'static str, Result<bool>) {
    match random.below(40) {
        0..=3 => ("ContactMonitor::new", monitor(robot, random)),
        4..=6 => {
            let options = isolation(robot, random);
            ("ContactIsolator::new", ContactIsolator::new(robot.clone(), &options).map(|_| true))
        }
        7 => {
            let options = MapOptions {
                samples: random.one_of(&[0, 1, 50, usize::MAX]),
                friction: random.number(2),
                noise: noise(robot, random),
                links: random.once_in(2).then(|| vec![random.one_of(&["link_7", "none"]).into()]),
                pull_probability: random.number(2),
            };
            ("ContactMap::new", ContactMap::new(robot.clone(), &options).map(|_| true))
        }
        8 => {
            let options = FilterOptions {
                particles: random.one_of(&[0, 1, 50, usize::MAX]),
                force_model: ForceModel::FrictionCone(random.number(2)),
                force_range: random.array(),
                stiffness_range: random.array(),
                radius_range: random.array(),
                torque_noise: random.vector(robot.nv()),
                relative_noise: random.number(2),
                torque_threshold: random.once_in(2).then(|| random.vector(robot.nv())),
                threads: random.one_of(&[0, 1, usize::MAX]),
                max_contacts: random.one_of(&[0, 1, 4, usize::MAX]),
                ..FilterOptions::default()
            };
            ("ContactParticleFilter::new", ContactParticleFilter::new(robot.clone(), options).map(|_| true))
        }
        9 => ("log", log(robot, random)),
        10 => {
            let wanted = Excitation {
                max_velocity: random.vector(robot.nv()),
                ..Excitation::new(random.one_of(&BAD_TIMES))
            };
            ("exciting_motion", exciting_motion(robot, &wanted).map(|_| true))
        }
        11..=13 => {
            let calibration = calibration(robot, random);
            (
                "Calibration::check",
                calibration.check(robot).and_then(|()| calibration.corrected(robot)).map(|_| true),
            )
        }
        14..=15 => {
            let gain = random.vector(robot.nv());
            (
                "MomentumObserver::new",
                MomentumObserver::new(robot.clone(), random.number(2), &gain).map(|_| true),
            )
        }
        16..=17 => {
            let calibration = calibration(robot, random);
            let made = MomentumObserver::calibrated(robot, 1e-3, &random.vector(robot.nv()), &calibration);
            ("MomentumObserver::calibrated", made.map(|_| true))
        }
        18..=20 => {
            let noise = noise(robot, random);
            let (q, gain, dt) = (configuration(robot, random), random.number(3), random.number(3));
            let made = noise
                .covariance(robot, &q, gain, dt)
                .and_then(|_| noise.correlation_time(robot, &q, gain, dt));
            ("NoiseModel", made.map(|_| true))
        }
        21..=22 => {
            let mut sensor = sensor(robot);
            sensor.pose.translation = random.array::<3>().into();
            sensor.pose.rotation =
                Matrix3::from(random.array::<9>().as_chunks::<3>().0.try_into().unwrap_or([[0.0; 3]; 3]));
            sensor.offset = random.array();
            ("LoadCompensator::new", LoadCompensator::new(robot.clone(), &[sensor]).map(|_| true))
        }
        23 => {
            let poses = random.below(8);
            let q: Vec<f64> = (0..poses).flat_map(|_| configuration(robot, random)).collect();
            let wrenches = random.wrenches(poses);
            ("identify_tool", identify_tool(robot, &sensor(robot), &q, &wrenches).map(|_| true))
        }
        24..=25 => {
            let (mass, com) = (random.number(3), Vector3::from(random.array::<3>()));
            let inertia = Matrix3::from_diagonal(&Vector3::from(random.array::<3>()));
            ("Robot::with_payload", robot.with_payload(link(robot, random), mass, com, inertia).map(|_| true))
        }
        _ => {
            let a = Matrix3::from_columns(
                &[random.array::<3>(), random.array(), random.array()].map(Vector3::from),
            );
            let found = best_cone_force(&(a.transpose() * a), &random.array::<3>().into(), random.number(3));
            ("best_cone_force", Ok(found.force.iter().all(|x| x.is_finite())))
        }
    }
}
