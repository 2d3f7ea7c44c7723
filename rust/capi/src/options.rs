//! How a monitor works.

use std::ffi::c_char;
use std::ptr;
use std::slice;

use contactsense::monitor::MonitorOptions;
use contactsense::Result;

use crate::calibration::cs_calibration;
use crate::guard::{numbers, text, wrong};
use crate::sensor::cs_sensor;

/// A point at which contacts are meant that no sensor measures, such as that of a tool.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cs_wanted_point {
    /// Name of the link.
    pub link: *const c_char,
    /// The point in the link's frame (m).
    pub point: [f64; 3],
}

/// How a monitor works; `cs_monitor_options_default` has the defaults, with which programs begin.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cs_monitor_options {
    /// Time between two calls (s).
    pub dt: f64,
    /// Gain of the momentum observer (1/s).
    pub observer_gain: f64,
    /// Of this robot, or NULL: corrects measurements and inertias, and gives thresholds and noise.
    pub calibration: *const cs_calibration,
    /// Torques that are a contact: one number for all joints, or one for each (Nm; N for sliding joints). NULL: 0.5, or, with
    /// a calibration, a test of all joints at once for the calibration's rate of false alarms.
    pub torque_threshold: *const f64,
    /// Number of these: 1, or that of `cs_robot_nv`.
    pub torque_threshold_count: usize,
    /// Force/torque sensors, in the order of the readings; NULL for none.
    pub sensors: *const cs_sensor,
    pub sensor_count: usize,
    /// Wrenches of sensors that are a contact: one number, or 6, or 6 for each sensor (N, Nm). NULL: 2.
    pub wrench_threshold: *const f64,
    pub wrench_threshold_count: usize,
    /// Points at which contacts are meant; NULL for none.
    pub wanted_points: *const cs_wanted_point,
    pub wanted_point_count: usize,
    /// Time constant of the bias that is tracked without contact (s); 0 for none, or 3 s where all joints are tested at once.
    pub bias_time_constant: f64,
    /// Greatest bias of each joint, in its thresholds.
    pub bias_limit: f64,
    /// A torque that stands still for so long becomes the bias (s); 0: a contact may last for ever.
    pub bias_settle_time: f64,
    /// Share of its greatest torque in a contact that a joint's gear or sensor may keep after it.
    pub hysteresis: f64,
    /// A signal stays on so long after it was last over its threshold (s).
    pub hold_time: f64,
    /// Contacts reported at most.
    pub max_contacts: usize,
    /// A contact is located if 90 % of the places that explain the torques are this near to its point (m).
    pub locate_within: f64,
    /// Samples of the surface for the posterior of a contact; 0 for closed forms only.
    pub samples: usize,
}

/// The defaults, for calls every `dt` seconds.
#[no_mangle]
pub extern "C" fn cs_monitor_options_default(dt: f64) -> cs_monitor_options {
    let options = MonitorOptions::new(dt);
    cs_monitor_options {
        dt,
        observer_gain: options.observer_gain[0],
        calibration: ptr::null(),
        torque_threshold: ptr::null(),
        torque_threshold_count: 0,
        sensors: ptr::null(),
        sensor_count: 0,
        wrench_threshold: ptr::null(),
        wrench_threshold_count: 0,
        wanted_points: ptr::null(),
        wanted_point_count: 0,
        bias_time_constant: 0.0,
        bias_limit: options.bias_limit,
        bias_settle_time: 0.0,
        hysteresis: options.hysteresis[0],
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
    /// Each pointer is null or points to as many objects as its count says.
    pub(crate) unsafe fn wanted(&self) -> Result<MonitorOptions> {
        let given = |time: f64| Some(time).filter(|time| *time != 0.0);
        let mut wanted = MonitorOptions {
            observer_gain: vec![self.observer_gain],
            bias_time_constant: given(self.bias_time_constant),
            bias_limit: self.bias_limit,
            bias_settle_time: given(self.bias_settle_time),
            hysteresis: vec![self.hysteresis],
            hold_time: self.hold_time,
            samples: self.samples,
            ..MonitorOptions::new(self.dt)
        };
        let isolation = &mut wanted.isolation;
        isolation.max_contacts = self.max_contacts;
        isolation.locate_within = self.locate_within;
        // SAFETY: the caller's promises.
        unsafe {
            if let Some(known) = self.calibration.as_ref() {
                wanted.calibration = Some(known.calibration.clone());
                isolation.torque_threshold = None;
            }
            let (thresholds, count) = (self.torque_threshold, self.torque_threshold_count);
            if !thresholds.is_null() {
                isolation.torque_threshold = Some(numbers(thresholds, count, "torque_threshold")?.to_vec());
            }
            let (thresholds, count) = (self.wrench_threshold, self.wrench_threshold_count);
            if !thresholds.is_null() {
                isolation.wrench_threshold = numbers(thresholds, count, "wrench_threshold")?.to_vec();
            }
            for sensor in objects(self.sensors, self.sensor_count, "sensors")? {
                let taken = sensor.wanted()?;
                if sensor.wanted {
                    isolation.wanted_contacts.push(taken.name.clone());
                }
                isolation.sensors.push(taken);
            }
            for place in objects(self.wanted_points, self.wanted_point_count, "wanted_points")? {
                let link = text(place.link, "wanted_points: link")?;
                wanted.wanted_points.push((link.to_owned(), place.point));
            }
        }
        Ok(wanted)
    }
}

/// Objects of an array; none where the pointer is null.
///
/// # Safety
/// The pointer is null, or points to `count` objects that live during `'a`.
unsafe fn objects<'a, T>(pointer: *const T, count: usize, argument: &'static str) -> Result<&'a [T]> {
    if pointer.is_null() {
        return match count {
            0 => Ok(&[]),
            _ => Err(wrong(argument, "must not be NULL where there is a count")),
        };
    }
    // SAFETY: as the caller promises.
    Ok(unsafe { slice::from_raw_parts(pointer, count) })
}
