//! Monitors: one call a control tick.

use std::ffi::c_char;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};

use contactsense::monitor::{ContactMonitor, ContactReport};
use contactsense::{ExternalSample, Result, Sample};

use crate::guard::{guarded, numbers, object, object_mut, text, wrong};
use crate::options::cs_monitor_options;
use crate::report::cs_report;
use crate::robot::cs_robot;
use crate::status::cs_status;

/// The sense of touch of one robot. One thread at a time may use it: a call during another one is refused.
pub struct cs_monitor {
    touch: Touch,
    busy: AtomicBool,
}

/// What one thread at a time may use.
struct Touch {
    monitor: ContactMonitor,
    /// Of the sensors, in the newest sample.
    readings: Vec<Option<[f64; 6]>>,
}

/// The measurements of a tick.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cs_sample {
    /// Configuration, `cs_robot_nq` numbers.
    pub q: *const f64,
    /// Velocity, `cs_robot_nv` numbers.
    pub v: *const f64,
    /// Motor torque, `cs_robot_ntau` numbers.
    pub tau: *const f64,
    /// Torque of friction, which is subtracted from `tau`; NULL for none.
    pub friction: *const f64,
    /// Readings of the force/torque sensors, 6 numbers for each, in the sensor's axes (N, Nm); a sensor whose numbers are NaN
    /// is left out, and all are where this is NULL.
    pub wrenches: *const f64,
    /// Time since the last accepted sample (s); 0 for that of the options.
    pub dt: f64,
}

/// Makes a monitor, which belongs to the caller, who frees it with `cs_monitor_free`. All that it is made of may be freed
/// before.
///
/// # Safety
/// `robot` and `options` live, with all that they point to; `monitor` can be written to.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_new(
    robot: *const cs_robot,
    options: *const cs_monitor_options,
    monitor: *mut *mut cs_monitor,
) -> cs_status {
    guarded(|| {
        // SAFETY: the caller's promise.
        let out = unsafe { object_mut(monitor, "monitor") }?;
        *out = ptr::null_mut();
        // SAFETY: as above.
        let robot = unsafe { object(robot, "robot") }?;
        // SAFETY: as above.
        let options = unsafe { object(options, "options")?.wanted() }?;
        let monitor = ContactMonitor::new(robot.robot.clone(), &options)?;
        let readings = vec![None; options.isolation.sensors.len()];
        *out = Box::into_raw(Box::new(cs_monitor {
            touch: Touch { monitor, readings },
            busy: AtomicBool::new(false),
        }));
        Ok(())
    })
}

/// Frees a monitor; NULL is allowed.
///
/// # Safety
/// `monitor` is NULL, or was made by `cs_monitor_new`, not freed before, and no thread uses it.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_free(monitor: *mut cs_monitor) {
    if !monitor.is_null() {
        // SAFETY: it was made by `Box::into_raw`, as the caller promises.
        drop(unsafe { Box::from_raw(monitor) });
    }
}

/// Ends the use of a monitor by a thread.
struct Used<'a>(&'a AtomicBool);

impl Drop for Used<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

/// Runs a call on a monitor that no other thread uses.
///
/// # Safety
/// `monitor` is null or lives.
#[inline]
unsafe fn alone(monitor: *mut cs_monitor, call: impl FnOnce(&mut Touch) -> Result<()>) -> cs_status {
    guarded(|| {
        if monitor.is_null() {
            return Err(wrong("monitor", "must not be NULL"));
        }
        // SAFETY: it lives, as the caller promises, and the flag may be used by several threads.
        let busy = unsafe { &*ptr::addr_of!((*monitor).busy) };
        if busy.swap(true, Ordering::Acquire) {
            return Err(wrong("monitor", "is in use by another thread"));
        }
        let _used = Used(busy);
        // SAFETY: the flag was not set: nothing else uses the monitor until it is cleared.
        call(unsafe { &mut *ptr::addr_of_mut!((*monitor).touch) })
    })
}

/// Gives a sample to a monitor by `take`, and writes what it reports.
///
/// # Safety
/// `monitor` lives; `sample` and its numbers live; `report` can be written to, and has room where it points to some.
#[inline]
unsafe fn reported(
    monitor: *mut cs_monitor,
    sample: *const cs_sample,
    report: *mut cs_report,
    take: impl for<'a> FnOnce(
        &'a mut ContactMonitor,
        &cs_sample,
        &[Option<[f64; 6]>],
    ) -> Result<&'a ContactReport>,
) -> cs_status {
    // SAFETY: the caller's promise.
    unsafe {
        alone(monitor, |touch| {
            let (sample, out) = (object(sample, "sample")?, object_mut(report, "report")?);
            let Touch { monitor, readings } = touch;
            if sample.wrenches.is_null() {
                readings.fill(None);
            } else {
                let wrenches = numbers(sample.wrenches, 6 * readings.len(), "wrenches")?;
                for (reading, wrench) in readings.iter_mut().zip(wrenches.chunks_exact(6)) {
                    let known = !wrench.iter().all(|number| number.is_nan());
                    *reading = wrench.try_into().ok().filter(|_| known);
                }
            }
            out.fill(take(monitor, sample, readings)?);
            Ok(())
        })
    }
}

/// Takes in a tick, and writes what the monitor says of it. Allocates no memory, unless it fails.
///
/// # Safety
/// `monitor` lives; `sample` and its numbers live; `report` can be written to, and has room where it points to some.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_update(
    monitor: *mut cs_monitor,
    sample: *const cs_sample,
    report: *mut cs_report,
) -> cs_status {
    // SAFETY: the caller's promise.
    unsafe {
        reported(monitor, sample, report, |monitor, sample, readings| {
            let robot = monitor.robot();
            let (nq, nv, ntau) = (robot.nq(), robot.nv(), robot.nv() - robot.unactuated());
            let (q, v) = (numbers(sample.q, nq, "q")?, numbers(sample.v, nv, "v")?);
            let mut taken = Sample::new(q, v, numbers(sample.tau, ntau, "tau")?).wrenches(readings);
            if !sample.friction.is_null() {
                taken = taken.friction(numbers(sample.friction, ntau, "friction")?);
            }
            monitor.update(&given_dt(sample).map_or(taken, |dt| taken.dt(dt)))
        })
    }
}

/// Takes in a tick with an external torque that the robot's controller estimates; `tau` of the sample is that torque,
/// `cs_robot_nv` numbers, `v` may be NULL, and `friction` is not read.
///
/// # Safety
/// As of `cs_monitor_update`.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_update_external(
    monitor: *mut cs_monitor,
    sample: *const cs_sample,
    report: *mut cs_report,
) -> cs_status {
    // SAFETY: the caller's promise.
    unsafe {
        reported(monitor, sample, report, |monitor, sample, readings| {
            let (nq, nv) = (monitor.robot().nq(), monitor.robot().nv());
            let (q, torque) = (numbers(sample.q, nq, "q")?, numbers(sample.tau, nv, "tau")?);
            let mut taken = ExternalSample::new(q, torque).wrenches(readings);
            if !sample.v.is_null() {
                taken = taken.velocity(numbers(sample.v, nv, "v")?);
            }
            monitor.update_external(&given_dt(sample).map_or(taken, |dt| taken.dt(dt)))
        })
    }
}

fn given_dt(sample: &cs_sample) -> Option<f64> {
    Some(sample.dt).filter(|dt| *dt != 0.0)
}

/// Says that the sample of a tick is lost; `dt` is the time since the last that was accepted (s), or 0.
///
/// # Safety
/// `monitor` lives.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_miss(monitor: *mut cs_monitor, dt: f64) -> cs_status {
    // SAFETY: the caller's promise.
    unsafe {
        alone(monitor, |touch| {
            touch.monitor.miss(Some(dt).filter(|dt| *dt != 0.0));
            Ok(())
        })
    }
}

/// Takes what is measured now for free of contact: bias and offsets of sensors become so.
///
/// # Safety
/// `monitor` lives.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_tare(monitor: *mut cs_monitor) -> cs_status {
    // SAFETY: the caller's promise.
    unsafe { alone(monitor, |touch| touch.monitor.tare()) }
}

/// From the next tick on, a link carries a payload that the description lacks, with its centre of mass in the link's frame
/// (kg, m); one that was set before is gone. Not for the control loop: it allocates.
///
/// # Safety
/// `monitor` lives; `link` ends with NUL; `com` has three numbers.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_set_payload(
    monitor: *mut cs_monitor,
    link: *const c_char,
    mass: f64,
    com: *const f64,
) -> cs_status {
    // SAFETY: the caller's promise.
    unsafe {
        alone(monitor, |touch| {
            let com = numbers(com, 3, "com")?;
            let link = touch.monitor.robot().link(text(link, "link")?)?;
            touch.monitor.set_payload(link, mass, [com[0], com[1], com[2]])
        })
    }
}

/// From the next tick on, there is no such payload. Not for the control loop: it frees memory.
///
/// # Safety
/// `monitor` lives.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_clear_payload(monitor: *mut cs_monitor) -> cs_status {
    // SAFETY: the caller's promise.
    unsafe {
        alone(monitor, |touch| {
            touch.monitor.clear_payload();
            Ok(())
        })
    }
}

/// Forgets all ticks; the next one is the first.
///
/// # Safety
/// `monitor` lives.
#[no_mangle]
pub unsafe extern "C" fn cs_monitor_reset(monitor: *mut cs_monitor) -> cs_status {
    // SAFETY: the caller's promise.
    unsafe {
        alone(monitor, |touch| {
            touch.monitor.reset();
            Ok(())
        })
    }
}
