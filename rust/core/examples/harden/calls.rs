//! The public calls of the core, each with random arguments.

use std::sync::Arc;

use contactsense::isolation::{ContactIsolator, Isolation, IsolatorOptions};
use contactsense::map::{ContactMap, MapOptions};
use contactsense::monitor::{ContactMonitor, ContactReport};
use contactsense::observer::MomentumObserver;
use contactsense::particle::{ContactParticleFilter, FilterOptions};
use contactsense::robot::Robot;
use contactsense::sensor::LoadCompensator;
use contactsense::surface::RayHit;
use contactsense::{Error, ExternalSample, Result, Sample};
use nalgebra::{Vector3, Vector6};

use crate::made::{make, monitor_options};
use crate::random::Random;
use crate::robots::{any_robot, configuration, link, sensor};

/// Of a monitor (s).
const DT: f64 = 1e-3;
/// Points of maps, and particles: few, for many calls.
const SAMPLES: usize = 200;
const PARTICLES: usize = 30;
/// Room for the crossings of a line.
const CROSSINGS: usize = 32;

/// What calls are made on.
pub struct Objects {
    pub robot: Arc<Robot>,
    monitor: ContactMonitor,
    isolator: ContactIsolator,
    observer: MomentumObserver,
    compensator: LoadCompensator,
    map: ContactMap,
    filter: ContactParticleFilter,
    hits: Vec<RayHit>,
}

impl Objects {
    /// Valid ones, with options that differ.
    pub fn new(random: &mut Random) -> Result<Self> {
        let robot = Arc::new(any_robot(random)?);
        let sensors = if random.once_in(2) { vec![sensor(&robot)] } else { vec![] };
        let mut options = monitor_options(&robot, random.once_in(2));
        options.dt = DT;
        options.samples = SAMPLES * random.below(2);
        options.isolation.sensors.clone_from(&sensors);
        let isolation = IsolatorOptions {
            sensors: sensors.clone(),
            torque_threshold: Some(vec![0.5]),
            samples: SAMPLES * random.below(2),
            ..IsolatorOptions::default()
        };
        let filter = FilterOptions {
            particles: PARTICLES,
            seed: random.bits(),
            max_contacts: random.one_of(&[1, 3]),
            ..FilterOptions::default()
        };
        Ok(Objects {
            monitor: ContactMonitor::new(robot.clone(), &options)?,
            isolator: ContactIsolator::new(robot.clone(), &isolation)?,
            observer: MomentumObserver::new(robot.clone(), DT, &[50.0])?,
            compensator: LoadCompensator::new(robot.clone(), &[sensor(&robot)])?,
            map: ContactMap::new(robot.clone(), &MapOptions { samples: SAMPLES, ..MapOptions::default() })?,
            filter: ContactParticleFilter::new(robot.clone(), filter)?,
            hits: Vec::with_capacity(CROSSINGS),
            robot,
        })
    }

    /// Gives every object what is right: each must answer.
    pub fn probe(&mut self) -> Result<()> {
        let (q, zeros) = (self.robot.neutral(), vec![0.0; self.robot.nv()]);
        let tau = self.robot.inverse_dynamics(&q, &zeros, &zeros)?;
        let wrenches = [Some([0.1; 6])];
        let of_monitor = &wrenches[..self.monitor.sensors().len()];
        let exerted = vec![Some(Vector6::repeat(0.1)); self.isolator.sensor_names().len()];
        // It may have run on external torques.
        self.monitor.reset();
        let finite = [
            finite_report(self.monitor.update(&Sample::new(&q, &zeros, &tau).wrenches(of_monitor))?),
            finite_isolation(self.isolator.isolate_sensed(&q, &tau, &exerted)?),
            all(self.observer.update(&Sample::new(&q, &zeros, &tau))?),
            wrenches_finite(self.compensator.update(&q, &zeros, &zeros, &wrenches)?),
            self.map.evaluate(&q, &tau)?.log_evidence.is_finite(),
        ];
        self.filter.update(&q, &tau)?;
        match finite.iter().position(|finite| !finite) {
            None => Ok(()),
            Some(k) => Err(Error::input("probe", format!("{k} is not finite"))),
        }
    }
}

fn all(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

fn wrenches_finite(wrenches: &[Option<Vector6<f64>>]) -> bool {
    wrenches.iter().flatten().all(|wrench| all(wrench.as_slice()))
}

fn finite_isolation(isolation: &Isolation) -> bool {
    isolation.contacts.iter().all(|contact| {
        contact.force().is_none_or(|force| all(force.as_slice()))
            && contact.place.is_none_or(|place| all(place.point.as_slice()) && all(place.normal.as_slice()))
    })
}

fn finite_report(report: &ContactReport) -> bool {
    all(&report.external_torque)
        && all(&report.collision_torque)
        && wrenches_finite(&report.wrenches)
        && finite_isolation(&report.isolation)
}

/// One call: its name, and whether the answer is finite.
pub fn call(objects: &mut Objects, random: &mut Random) -> (&'static str, Result<bool>) {
    match random.below(400) {
        0 => make(&objects.robot, random),
        1 => ("ContactMap", map(objects, random)),
        2 => ("ContactParticleFilter", filter(objects, random)),
        3..=99 => monitor(objects, random),
        100..=149 => ("ContactIsolator", isolator(objects, random)),
        150..=199 => ("MomentumObserver", observer(objects, random)),
        200..=239 => ("LoadCompensator", compensator(objects, random)),
        240..=309 => ("Surface", Ok(surface(objects, random))),
        _ => ("Robot", robot(objects, random)),
    }
}

fn monitor(objects: &mut Objects, random: &mut Random) -> (&'static str, Result<bool>) {
    match random.below(40) {
        0..=11 => ("ContactMonitor's settings", settings(objects, random)),
        12..=19 => ("ContactMonitor::update_external", update_external(objects, random)),
        _ => ("ContactMonitor::update", update(objects, random)),
    }
}

fn update(objects: &mut Objects, random: &mut Random) -> Result<bool> {
    let (robot, monitor) = (&objects.robot, &mut objects.monitor);
    let (q, v, tau) = (configuration(robot, random), random.vector(robot.nv()), random.vector(robot.nv()));
    let (friction, wrenches) = (random.vector(robot.nv()), random.wrenches(monitor.sensors().len()));
    let mut sample = Sample::new(&q, &v, &tau).wrenches(&wrenches);
    if random.once_in(4) {
        sample = sample.friction(&friction);
    }
    if random.once_in(4) {
        sample = sample.dt(random.number(4));
    }
    monitor.update(&sample).map(finite_report)
}

fn update_external(objects: &mut Objects, random: &mut Random) -> Result<bool> {
    let (robot, monitor) = (&objects.robot, &mut objects.monitor);
    let (q, v, torque) = (configuration(robot, random), random.vector(robot.nv()), random.vector(robot.nv()));
    let wrenches = random.wrenches(monitor.sensors().len());
    let mut sample = ExternalSample::new(&q, &torque).wrenches(&wrenches);
    if random.once_in(2) {
        sample = sample.velocity(&v);
    }
    if random.once_in(4) {
        sample = sample.dt(random.number(4));
    }
    monitor.update_external(&sample).map(finite_report)
}

fn settings(objects: &mut Objects, random: &mut Random) -> Result<bool> {
    let (robot, monitor) = (&objects.robot, &mut objects.monitor);
    let nv = robot.nv();
    match random.below(12) {
        0 => monitor.tare()?,
        1 => monitor.set_payload(link(robot, random), random.number(4), random.array())?,
        2 => monitor.clear_payload(),
        3 => monitor.set_torque_threshold(&random.vector(nv))?,
        4 => monitor.set_wrench_threshold(&random.vector(6))?,
        5 => monitor.set_observer_gain(&random.vector(nv))?,
        6 => monitor.set_wrench_gain((!random.once_in(3)).then(|| random.number(4)))?,
        7 => monitor.miss((!random.once_in(3)).then(|| random.number(4))),
        8 => monitor.reset(),
        9 => drop(monitor.propose_payload()?),
        10 => {
            // It is not known, and says so, behind external torques without velocities.
            let unknown = monitor.acceleration().iter().all(|value| value.is_nan());
            return Ok((unknown || all(monitor.acceleration())) && monitor.bias().is_none_or(all));
        }
        _ => return Ok(finite_report(monitor.report()) && monitor.time().is_finite()),
    }
    Ok(true)
}

fn isolator(objects: &mut Objects, random: &mut Random) -> Result<bool> {
    let robot = &objects.robot;
    let (q, torque) = (configuration(robot, random), random.vector(robot.nv()));
    if random.once_in(3) {
        let wrenches: Vec<_> = random.wrenches(objects.isolator.sensor_names().len());
        let wrenches: Vec<_> = wrenches.into_iter().map(|wrench| wrench.map(Vector6::from)).collect();
        return objects.isolator.isolate_sensed(&q, &torque, &wrenches).map(finite_isolation);
    }
    objects.isolator.isolate(&q, &torque).map(finite_isolation)
}

fn observer(objects: &mut Objects, random: &mut Random) -> Result<bool> {
    let (robot, observer) = (&objects.robot, &mut objects.observer);
    let (q, v, tau) = (configuration(robot, random), random.vector(robot.nv()), random.vector(robot.nv()));
    match random.below(12) {
        0 => observer.set_gain(&random.vector(robot.nv())).map(|()| true),
        1 => {
            observer.reset();
            Ok(true)
        }
        2 => Ok(all(observer.acceleration())),
        3 => observer.update(&Sample::new(&q, &v, &tau).dt(random.number(2))).map(all),
        _ => observer.update(&Sample::new(&q, &v, &tau)).map(all),
    }
}

fn compensator(objects: &mut Objects, random: &mut Random) -> Result<bool> {
    let (robot, compensator) = (&objects.robot, &mut objects.compensator);
    let (q, v, a) = (configuration(robot, random), random.vector(robot.nv()), random.vector(robot.nv()));
    let wrenches = random.wrenches(1);
    match random.below(8) {
        0 => compensator.tare(&q, &wrenches).map(|()| true),
        1 => {
            let offsets: Vec<[f64; 6]> = (0..random.below(3)).map(|_| random.array()).collect();
            compensator.set_offsets(&offsets).map(|()| true)
        }
        2 => compensator.check_readings(&wrenches).map(|()| true),
        _ => compensator.update(&q, &v, &a, &wrenches).map(wrenches_finite),
    }
}

fn map(objects: &mut Objects, random: &mut Random) -> Result<bool> {
    let robot = &objects.robot;
    if random.once_in(8) {
        let q = configuration(robot, random);
        return objects.map.identifiability(&q, random.number(3)).map(|_| true);
    }
    let estimate = objects.map.evaluate(&configuration(robot, random), &random.vector(robot.nv()))?;
    Ok(estimate.log_evidence.is_finite())
}

fn filter(objects: &mut Objects, random: &mut Random) -> Result<bool> {
    let robot = &objects.robot;
    if random.once_in(20) {
        objects.filter.reset();
    }
    objects.filter.update(&configuration(robot, random), &random.vector(robot.nv()))?;
    Ok(objects.filter.contacts().all(|contact| all(contact.weights())))
}

fn surface(objects: &mut Objects, random: &mut Random) -> bool {
    let links = objects.robot.touchable_links();
    let link = links[random.below(links.len())];
    let Some(surface) = objects.robot[link].surface.as_ref() else { return false };
    let (p, d) = (Vector3::from(random.array::<3>()), Vector3::from(random.array::<3>()));
    let triangle = random.once_in(2).then(|| random.bits() as u32 >> random.below(32));
    match random.below(6) {
        0 => drop(surface.closest_point(&p)),
        1 => drop(surface.closest_point_from(&p, triangle)),
        2 => drop(surface.closest_point_near(&p, triangle)),
        3 => drop(surface.hides(&p, triangle)),
        4 => drop(surface.sample(random.below(5), random.bits())),
        _ => {
            objects.hits.clear();
            surface.cast_line_into(&p, &d, random.number(3), &mut objects.hits);
            return objects.hits.iter().all(|hit| hit.distance.is_finite());
        }
    }
    true
}

fn robot(objects: &Objects, random: &mut Random) -> Result<bool> {
    let robot = &objects.robot;
    let nv = robot.nv();
    let (q, v, a) = (configuration(robot, random), random.vector(nv), random.vector(nv));
    let ok = |values: Vec<f64>| all(&values);
    match random.below(9) {
        0 => robot.inverse_dynamics(&q, &v, &a).map(ok),
        1 => robot.forward_dynamics(&q, &v, &a, random.once_in(2).then_some(&v)).map(ok),
        2 => robot.mass_matrix(&q).map(|matrix| all(matrix.as_slice())),
        3 => robot
            .jacobian(&q, link(robot, random), random.once_in(2).then(|| random.array()))
            .map(|j| all(j.as_slice())),
        4 => robot.link_pose(&q, link(robot, random)).map(|pose| all(pose.translation.as_slice())),
        5 => robot.integrate(&q, &v).map(ok),
        6 => robot
            .configuration(
                &[("joint_5", random.number(3)), (random.one_of(&["", "joint_6", "none"]), 1.0)],
                None,
            )
            .map(ok),
        7 => robot
            .velocity(&[("joint_5", random.number(3))], random.once_in(4).then(|| random.array()).as_ref())
            .map(ok),
        _ => robot.torque(&[("joint_5", random.number(3))]).map(ok),
    }
}
