//! Calibrations: what motion without contact taught of one robot.

use std::ffi::c_char;
use std::ptr;

use contactsense::calibration::Calibration;

use crate::guard::{guarded, object_mut, text};
use crate::status::cs_status;

/// What motion without contact taught of one robot. It does not change: any number of threads may use it.
pub struct cs_calibration {
    pub(crate) calibration: Calibration,
}

/// Reads the YAML file that `contactsense calibrate` or `Calibration.save` of Python wrote.
///
/// The calibration belongs to the caller, who frees it with `cs_calibration_free`. Whether it fits a robot is known when a
/// monitor is made with it.
///
/// # Safety
/// `path` ends with NUL; `calibration` can be written to.
#[no_mangle]
pub unsafe extern "C" fn cs_calibration_load(
    path: *const c_char,
    calibration: *mut *mut cs_calibration,
) -> cs_status {
    guarded(|| {
        // SAFETY: the caller's promise.
        let out = unsafe { object_mut(calibration, "calibration") }?;
        *out = ptr::null_mut();
        // SAFETY: the caller's promise.
        let path = unsafe { text(path, "path") }?;
        *out = Box::into_raw(Box::new(cs_calibration { calibration: Calibration::load(path)? }));
        Ok(())
    })
}

/// Frees a calibration; NULL is allowed. Monitors that were made with it live on.
///
/// # Safety
/// `calibration` is NULL, or was made by `cs_calibration_load` and not freed before.
#[no_mangle]
pub unsafe extern "C" fn cs_calibration_free(calibration: *mut cs_calibration) {
    if !calibration.is_null() {
        // SAFETY: it was made by `Box::into_raw`, as the caller promises.
        drop(unsafe { Box::from_raw(calibration) });
    }
}
