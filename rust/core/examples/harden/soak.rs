//! Millions of ticks of a calibrated monitor on a moving arm: no drift in time or memory.

use std::sync::Arc;
use std::time::Instant;

use contactsense::calibration::Calibration;
use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::robot::{LinkIndex, Robot};
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
/// How much longer the median tick may be than a new monitor's (share), and how much memory may grow (bytes).
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

/// What a part of the run took: the median tick over that of a monitor made for the part, and memory (bytes).
struct Part {
    ratio: f64,
    memory: i64,
}

/// Median of what it sorts (ns).
fn median(times: &mut [u32]) -> f64 {
    times.sort_unstable();
    times.get(times.len() / 2).map_or(f64::NAN, |&time| f64::from(time))
}

/// The 99.9th percentile of sorted times (ns).
fn p999(sorted: &[u32]) -> f64 {
    sorted.get(sorted.len() * 999 / 1000).map_or(f64::NAN, |&time| f64::from(time))
}

/// A monitor, its tick times (ns), and what it said.
struct Timed {
    monitor: ContactMonitor,
    times: Vec<u32>,
    collisions: u64,
    bad: u64,
}

impl Timed {
    fn new(robot: &Arc<Robot>, size: usize) -> Result<Self> {
        let mut options = MonitorOptions::new(DT);
        options.calibration = Some(Calibration::of_description(robot));
        options.isolation.torque_threshold = None;
        let monitor = ContactMonitor::new(robot.clone(), &options)?;
        Ok(Timed { monitor, times: Vec::with_capacity(size), collisions: 0, bad: 0 })
    }

    /// Sets the payload that is held now, if any.
    fn hold(&mut self, payload: Option<LinkIndex>) -> Result<()> {
        match payload {
            Some(link) => self.monitor.set_payload(link, PAYLOAD, [0.0, 0.0, 0.05]),
            None => {
                self.monitor.clear_payload();
                Ok(())
            }
        }
    }

    fn tick(&mut self, sample: Option<&Sample>) -> Result<()> {
        let start = Instant::now();
        if let Some(sample) = sample {
            let report = self.monitor.update(sample)?;
            self.collisions += u64::from(report.collision);
            self.bad += u64::from(!report.external_torque.iter().all(|torque| torque.is_finite()));
        } else {
            self.monitor.miss(None);
        }
        self.times.push(u32::try_from(start.elapsed().as_nanos()).unwrap_or(u32::MAX));
        Ok(())
    }
}

/// Runs `count` ticks in ten parts; whether neither time nor memory drifted, where `strict` asks for the time too.
pub fn run(count: u64, seed: u64, strict: bool) -> Result<bool> {
    let robot = Arc::new(Robot::example_arm());
    let motion = motion(&robot)?;
    let link = robot.touchable_links()[robot.touchable_links().len() - 1];
    let mut random = Random::new(seed);
    let size = (count / 10).max(1);
    let mut lasting = Timed::new(&robot, size as usize)?;
    let mut parts = Vec::with_capacity(11);
    // A control loop's own values, which lie in the cache: the whole motion does not.
    let mut tau = vec![0.0; robot.nv()];
    let (mut q, mut v) = (tau.clone(), tau.clone());
    let (mut touched, mut payload, mut ticks, mut start_tick) = (0_usize, None, 0_u64, 1_u64);
    let mut largest_off = 0.0_f64;
    for _ in 0..10 {
        // Beside it, as the machine's speed changes by more than what is looked for.
        let mut made_now = Timed::new(&robot, size as usize)?;
        made_now.hold(payload)?;
        for _ in 0..size {
            let at = &motion[(ticks % PERIOD as u64) as usize];
            touched = touched.saturating_sub(1);
            if random.once_in(CONTACTS[0]) {
                touched = random.below(CONTACTS[1]);
            }
            let share = if touched > 0 { 1.0 } else { 0.0 };
            for (tau, (free, contact)) in tau.iter_mut().zip(at.tau.iter().zip(&at.contact)) {
                *tau = free - share * contact + NOISE * random.normal();
            }
            q.copy_from_slice(&at.q);
            v.copy_from_slice(&at.v);
            ticks += 1;
            // One after the other in turns: the second finds the robot in the cache.
            let mut pair = [&mut lasting, &mut made_now];
            if ticks % 2 == 0 {
                pair.reverse();
            }
            if ticks % RESET_TICKS == 0 {
                pair.iter_mut().for_each(|timed| timed.monitor.reset());
                start_tick = ticks;
            }
            if ticks % PAYLOAD_TICKS == 0 {
                payload = if payload.is_some() { None } else { Some(link) };
                pair.iter_mut().try_for_each(|timed| timed.hold(payload))?;
            }
            let sample = Sample::new(&q, &v, &tau);
            let sample = (!random.once_in(LOST)).then_some(&sample);
            pair.iter_mut().try_for_each(|timed| timed.tick(sample))?;
        }
        let (tick, of_new) = (median(&mut lasting.times), median(&mut made_now.times));
        let off = lasting.monitor.time() - (ticks - start_tick) as f64 * DT;
        let part = Part { ratio: tick / of_new, memory: memory() };
        println!(
            "{ticks:>9} ticks: median {:.2} us ({:.3} of a new monitor's), p99.9 {:.2} us ({:.2}), {:.2} MB, collision in {:.1} % so far, time off by {:.1e} s",
            tick / 1e3,
            part.ratio,
            p999(&lasting.times) / 1e3,
            p999(&lasting.times) / p999(&made_now.times),
            part.memory as f64 / 1e6,
            100.0 * lasting.collisions as f64 / ticks as f64,
            off,
        );
        largest_off = off.abs().max(largest_off);
        parts.push(part);
        lasting.times.clear();
    }
    // The first part warms up caches and the allocator.
    let (second, last) = (&parts[1], &parts[parts.len() - 1]);
    let (growth, grown) = (last.ratio - 1.0, last.memory - second.memory);
    println!("the last median is {:+.1} % of a new monitor's; memory {grown:+} bytes", 100.0 * growth);
    println!("{} reports were not finite", lasting.bad);
    Ok(lasting.bad == 0
        && lasting.collisions > 0
        && largest_off < LARGEST_OFF
        && grown < MOST_MEMORY
        && (!strict || growth.abs() < LARGEST_GROWTH))
}
