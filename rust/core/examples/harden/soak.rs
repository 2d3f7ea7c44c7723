//! Millions of ticks of a calibrated monitor on a moving arm: no drift in time or memory.

use std::sync::Arc;
use std::time::Instant;

use contactsense::calibration::Calibration;
use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::robot::Robot;
use contactsense::{Result, Sample};
use nalgebra::Vector3;

use crate::random::Random;

/// Time step (s).
const DT: f64 = 1e-3;
/// Ticks after which the motion repeats.
const PERIOD: usize = 8192;
/// Noise of the torques (Nm).
const NOISE: f64 = 0.05;
/// Force of the contacts (N).
const FORCE: [f64; 3] = [12.0, -9.0, 6.0];
/// A contact begins once in so many ticks, and lasts at most so long (ticks).
const CONTACTS: [usize; 2] = [2000, 600];
/// A sample is lost once in so many.
const LOST: usize = 5000;
/// A payload is set, or cleared, every so many ticks; it is light (kg).
const PAYLOAD_TICKS: u64 = 90_000;
const PAYLOAD: f64 = 0.02;
/// The monitor is reset every so many ticks.
const RESET_TICKS: u64 = 370_000;
/// How much longer the median may become (share), and how much memory may grow (bytes).
const LARGEST_GROWTH: f64 = 0.1;
const MOST_MEMORY: i64 = 1 << 20;
/// How far the monitor's clock may go wrong (s).
const LARGEST_OFF: f64 = 1e-6;
/// Of what Linux counts memory in (bytes).
const PAGE: i64 = 4096;

/// One instant of the motion: position, velocity, torque without and of a contact.
struct Instance {
    q: Vec<f64>,
    v: Vec<f64>,
    tau: Vec<f64>,
    contact: Vec<f64>,
}

fn motion(robot: &Robot) -> Result<Vec<Instance>> {
    let link = robot.touchable_links()[robot.touchable_links().len() - 1];
    let turn = std::f64::consts::TAU / (PERIOD as f64 * DT);
    let instance = |k: usize| {
        let of = |f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            let joints = 0..robot.nv();
            joints
                .map(|j| f((1 + j % 3) as f64 * turn, (1 + j % 3) as f64 * turn * k as f64 * DT + j as f64))
                .collect()
        };
        let (q, v) = (of(&|_, phase| 0.4 * phase.sin() + 0.3), of(&|rate, phase| 0.4 * rate * phase.cos()));
        let a = of(&|rate, phase| -0.4 * rate * rate * phase.sin());
        let tau = robot.inverse_dynamics(&q, &v, &a)?;
        let contact = robot.jacobian(&q, link, None)?.rows(0, 3).transpose() * Vector3::from(FORCE);
        Ok(Instance { q, v, tau, contact: contact.as_slice().to_vec() })
    };
    (0..PERIOD).map(instance).collect()
}

/// Resident memory (bytes); 0 where the system does not say.
fn memory() -> i64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split_whitespace().nth(1).and_then(|pages| pages.parse::<i64>().ok()).unwrap_or(0) * PAGE
}

/// What a part of the run took.
struct Part {
    median: u32,
    memory: i64,
}

fn monitor(robot: &Arc<Robot>) -> Result<ContactMonitor> {
    let mut options = MonitorOptions::new(DT);
    options.calibration = Some(Calibration::of_description(robot));
    options.isolation.torque_threshold = None;
    ContactMonitor::new(robot.clone(), &options)
}

/// Runs `count` ticks in ten parts; whether neither time nor memory drifted, where `strict` asks for the time too.
pub fn run(count: u64, seed: u64, strict: bool) -> Result<bool> {
    let robot = Arc::new(Robot::example_arm());
    let (motion, mut monitor) = (motion(&robot)?, monitor(&robot)?);
    let link = robot.touchable_links()[robot.touchable_links().len() - 1];
    let mut random = Random::new(seed);
    let size = (count / 10).max(1);
    let mut times: Vec<u32> = Vec::with_capacity(size as usize);
    let (mut parts, mut tau) = (Vec::with_capacity(11), vec![0.0; robot.nv()]);
    let (mut touched, mut loaded, mut ticks, mut collisions, mut start_tick) =
        (0_usize, false, 0_u64, 0_u64, 1_u64);
    let (mut bad, mut largest_off) = (0_u64, 0.0_f64);
    while ticks < size * 10 {
        let at = &motion[(ticks % PERIOD as u64) as usize];
        touched = touched.saturating_sub(1);
        if random.once_in(CONTACTS[0]) {
            touched = random.below(CONTACTS[1]);
        }
        let share = if touched > 0 { 1.0 } else { 0.0 };
        for (tau, (free, contact)) in tau.iter_mut().zip(at.tau.iter().zip(&at.contact)) {
            *tau = free - share * contact + NOISE * random.normal();
        }
        ticks += 1;
        if ticks % RESET_TICKS == 0 {
            monitor.reset();
            start_tick = ticks;
        }
        if ticks % PAYLOAD_TICKS == 0 {
            loaded = !loaded;
            if loaded {
                monitor.set_payload(link, PAYLOAD, [0.0, 0.0, 0.05])?;
            } else {
                monitor.clear_payload();
            }
        }
        let start = Instant::now();
        if random.once_in(LOST) {
            monitor.miss(None);
        } else {
            let report = monitor.update(&Sample::new(&at.q, &at.v, &tau))?;
            collisions += u64::from(report.collision);
            bad += u64::from(!report.external_torque.iter().all(|torque| torque.is_finite()));
        }
        times.push(u32::try_from(start.elapsed().as_nanos()).unwrap_or(u32::MAX));
        if times.len() as u64 == size {
            times.sort_unstable();
            let off = monitor.time() - (ticks - start_tick) as f64 * DT;
            let part = Part { median: times[times.len() / 2], memory: memory() };
            println!(
                "{ticks:>9} ticks: median {:.2} us, p99.9 {:.2} us, {:.2} MB, collision in {:.1} % so far, time off by {:.1e} s",
                f64::from(part.median) / 1e3,
                f64::from(times[times.len() * 999 / 1000]) / 1e3,
                part.memory as f64 / 1e6,
                100.0 * collisions as f64 / ticks as f64,
                off,
            );
            largest_off = off.abs().max(largest_off);
            parts.push(part);
            times.clear();
        }
    }
    // The first part warms up caches and the allocator.
    let (second, last) = (&parts[1], &parts[parts.len() - 1]);
    let growth = f64::from(last.median) / f64::from(second.median) - 1.0;
    let grown = last.memory - second.memory;
    println!("from the second to the last part: median {:+.1} %, memory {:+} bytes", 100.0 * growth, grown);
    println!("{bad} reports were not finite");
    Ok(bad == 0
        && collisions > 0
        && largest_off < LARGEST_OFF
        && grown < MOST_MEMORY
        && (!strict || growth.abs() < LARGEST_GROWTH))
}
