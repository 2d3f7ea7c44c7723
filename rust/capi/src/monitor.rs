//! Monitors: one call a control tick.

use std::ptr;
use std::slice;
use std::sync::atomic::{AtomicBool, Ordering};

use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::{ExternalSample, Result, Sample};

use crate::guard::{guarded, numbers, object, object_mut, wrong};
use crate::report::cs_report;
use crate::robot::cs_robot;
use crate::status::cs_status;

/// The sense of touch of one robot. One thread at a time may use it: a call during another one is refused.
pub struct cs_monitor {
    monitor: ContactMonitor,
    busy: AtomicBool,
}

/// How a monitor works; `cs_monitor_options_default` has the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cs_monitor_options {
    /// Time between two calls (s).
    pub dt: f64,
    /// Gain of the momentum observer (1/s).
    pub observer_gain: f64,
    /// Torques that are a contact: one number for all joints, or one for each (Nm; N for sliding joints). NULL: 0.5.
    pub torque_threshold: *const f64,
    /// Number of these: 1, or that of `cs_robot_nv`.
    pub torque_threshold_count: usize,
    /// Time constant of the bias that is tracked without contact (s); 0 for no tracking.
    pub bias_time_constant: f64,
    /// A signal stays on so long after it was last over its threshold (s).
    pub hold_time: f64,
    /// Contacts reported at most.
    pub max_contacts: usize,
    /// A contact is located if 90 % of the places that explain the torques are this near to its point (m).
    pub locate_within: f64,
    /// Samples of the surface for the posterior of a contact; 0 for closed forms only.
    pub samples: usize,
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
    /// Time since the last accepted sample (s); 0 for that of the options.
    pub dt: f64,
}

/// The defaults, for calls every `dt` seconds.
#[no_mangle]
pub extern "C" fn cs_monitor_options_default(dt: f64) -> cs_monitor_options {
    let options = MonitorOptions::new(dt);
    cs_monitor_options {
        dt,
        observer_gain: options.observer_gain[0],
        torque_threshold: ptr::null(),
        torque_threshold_count: 0,
        bias_time_constant: 0.0,
        hold_time: options.hold_time,
        max_contacts: options.isolation.max_contacts,
        locate_within: options.isolation.locate_within,
        samples: options.samples,
    }
}

impl cs_monitor_options {
    /// As the core has them.
    ///
    /// # Safety
    /// `torque_threshold` is null or points to as many numbers as it says.
    unsafe fn wanted(&self) -> Result<MonitorOptions> {
        let mut wanted = MonitorOptions::new(self.dt);
        wanted.observer_gain = vec![self.observer_gain];
        if !self.torque_threshold.is_null() {
            // SAFETY: the caller's promise.
            let threshold =
                unsafe { numbers(self.torque_threshold, self.torque_threshold_count, "torque_threshold") }?;
            wanted.isolation.torque_threshold = Some(threshold.to_vec());
        }
        wanted.bias_time_constant = Some(self.bias_time_constant).filter(|time| *time != 0.0);
        wanted.hold_time = self.hold_time;
        wanted.isolation.max_contacts = self.max_contacts;
        wanted.isolation.locate_within = self.locate_within;
        wanted.samples = self.samples;
        Ok(wanted)
    }
}

/// Makes a monitor, which belongs to the caller, who frees it with `cs_monitor_free`. The robot may be freed before.
///
/// # Safety
/// `robot` and `options` live, with the numbers that they point to; `monitor` can be written to.
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
        *out = Box::into_raw(Box::new(cs_monitor { monitor, busy: AtomicBool::new(false) }));
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
unsafe fn alone(monitor: *mut cs_monitor, call: impl FnOnce(&mut ContactMonitor) -> Result<()>) -> cs_status {
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
        call(unsafe { &mut *ptr::addr_of_mut!((*monitor).monitor) })
    })
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
        alone(monitor, |monitor| {
            let (sample, out) = (object(sample, "sample")?, object_mut(report, "report")?);
            let robot = monitor.robot();
            let (nq, nv) = (robot.nq(), robot.nv());
            let ntau = nv - robot.unactuated();
            let (q, v, tau) =
                (numbers(sample.q, nq, "q")?, numbers(sample.v, nv, "v")?, numbers(sample.tau, ntau, "tau")?);
            let mut taken = Sample::new(q, v, tau);
            if !sample.friction.is_null() {
                taken = taken.friction(slice::from_raw_parts(sample.friction, ntau));
            }
            if sample.dt != 0.0 {
                taken = taken.dt(sample.dt);
            }
            out.fill(monitor.update(&taken)?);
            Ok(())
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
        alone(monitor, |monitor| {
            let (sample, out) = (object(sample, "sample")?, object_mut(report, "report")?);
            let (nq, nv) = (monitor.robot().nq(), monitor.robot().nv());
            let (q, torque) = (numbers(sample.q, nq, "q")?, numbers(sample.tau, nv, "tau")?);
            let mut taken = ExternalSample::new(q, torque);
            if !sample.v.is_null() {
                taken = taken.velocity(slice::from_raw_parts(sample.v, nv));
            }
            if sample.dt != 0.0 {
                taken = taken.dt(sample.dt);
            }
            out.fill(monitor.update_external(&taken)?);
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
        alone(monitor, |monitor| {
            monitor.reset();
            Ok(())
        })
    }
}
