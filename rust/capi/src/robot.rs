//! Robots.

use std::ffi::{c_char, CString};
use std::ptr;
use std::sync::Arc;

use contactsense::load::UrdfOptions;
use contactsense::robot::Robot;

use crate::guard::{guarded, object, text};
use crate::status::cs_status;

/// A robot. It does not change: any number of threads may use it, and monitors share it.
pub struct cs_robot {
    pub(crate) robot: Arc<Robot>,
    joints: Vec<CString>,
    links: Vec<CString>,
    warnings: Vec<CString>,
}

/// How a URDF is read.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cs_urdf_options {
    /// Folders that `package://` names and mesh files may come from, besides the URDF's own; NULL for none.
    pub package_dirs: *const *const c_char,
    pub package_dir_count: usize,
    /// Whether the root link moves freely.
    pub floating_base: bool,
}

/// Reads a robot from a URDF file.
///
/// `options` may be NULL. The robot belongs to the caller, who frees it with `cs_robot_free`.
///
/// # Safety
/// `path` and the folders end with NUL; `robot` can be written to.
#[no_mangle]
pub unsafe extern "C" fn cs_robot_from_urdf(
    path: *const c_char,
    options: *const cs_urdf_options,
    robot: *mut *mut cs_robot,
) -> cs_status {
    guarded(|| {
        // SAFETY: the caller's promise about `robot`.
        let out = unsafe { crate::guard::object_mut(robot, "robot") }?;
        *out = ptr::null_mut();
        // SAFETY: the caller's promise about `path`.
        let path = unsafe { text(path, "path") }?;
        let mut wanted = UrdfOptions::default();
        if !options.is_null() {
            // SAFETY: the caller's promise about `options`.
            let options = unsafe { object(options, "options") }?;
            wanted.floating_base = options.floating_base;
            if !options.package_dirs.is_null() {
                // SAFETY: the caller's promise about the folders.
                let folders =
                    unsafe { std::slice::from_raw_parts(options.package_dirs, options.package_dir_count) };
                for folder in folders {
                    // SAFETY: as above.
                    wanted.package_dirs.push(unsafe { text(*folder, "package_dirs") }?.into());
                }
            }
        }
        let loaded = Robot::from_urdf(path, &wanted)?;
        *out = Box::into_raw(Box::new(cs_robot::new(loaded)));
        Ok(())
    })
}

impl cs_robot {
    fn new(robot: Robot) -> Self {
        let texts = |names: &[String]| names.iter().map(|name| c_text(name)).collect();
        let links = robot.links().iter().map(|link| c_text(&link.name)).collect();
        cs_robot {
            joints: texts(robot.joint_names()),
            links,
            warnings: texts(robot.warnings()),
            robot: Arc::new(robot),
        }
    }
}

/// Up to the first NUL, which no name of a URDF holds.
fn c_text(text: &str) -> CString {
    CString::new(text.split('\0').next().unwrap_or_default()).unwrap_or_default()
}

/// Frees a robot; NULL is allowed. Monitors of it live on.
///
/// # Safety
/// `robot` is NULL, or was made by `cs_robot_from_urdf` and not freed before.
#[no_mangle]
pub unsafe extern "C" fn cs_robot_free(robot: *mut cs_robot) {
    if !robot.is_null() {
        // SAFETY: it was made by `Box::into_raw`, as the caller promises.
        drop(unsafe { Box::from_raw(robot) });
    }
}

/// Numbers in a configuration `q`.
///
/// # Safety
/// `robot` is NULL, which gives 0, or lives.
#[no_mangle]
pub unsafe extern "C" fn cs_robot_nq(robot: *const cs_robot) -> usize {
    // SAFETY: the caller's promise.
    unsafe { robot.as_ref() }.map_or(0, |robot| robot.robot.nq())
}

/// Numbers in a velocity `v`, and in an external torque.
///
/// # Safety
/// `robot` is NULL, which gives 0, or lives.
#[no_mangle]
pub unsafe extern "C" fn cs_robot_nv(robot: *const cs_robot) -> usize {
    // SAFETY: the caller's promise.
    unsafe { robot.as_ref() }.map_or(0, |robot| robot.robot.nv())
}

/// Numbers in a motor torque `tau`: without those of a floating base.
///
/// # Safety
/// `robot` is NULL, which gives 0, or lives.
#[no_mangle]
pub unsafe extern "C" fn cs_robot_ntau(robot: *const cs_robot) -> usize {
    // SAFETY: the caller's promise.
    unsafe { robot.as_ref() }.map_or(0, |robot| robot.robot.nv() - robot.robot.unactuated())
}

/// The name of a moving joint, in the order of `v`. NULL beyond the last one; lives as long as the robot.
///
/// # Safety
/// `robot` is NULL or lives.
#[no_mangle]
pub unsafe extern "C" fn cs_robot_joint_name(robot: *const cs_robot, index: usize) -> *const c_char {
    // SAFETY: the caller's promise.
    text_at(unsafe { robot.as_ref() }.map(|robot| &robot.joints), index)
}

/// The name of a link, by the index that contacts have. NULL beyond the last one; lives as long as the robot.
///
/// # Safety
/// `robot` is NULL or lives.
#[no_mangle]
pub unsafe extern "C" fn cs_robot_link_name(robot: *const cs_robot, index: usize) -> *const c_char {
    // SAFETY: the caller's promise.
    text_at(unsafe { robot.as_ref() }.map(|robot| &robot.links), index)
}

/// What is unusual about the description. NULL beyond the last one; lives as long as the robot.
///
/// # Safety
/// `robot` is NULL or lives.
#[no_mangle]
pub unsafe extern "C" fn cs_robot_warning(robot: *const cs_robot, index: usize) -> *const c_char {
    // SAFETY: the caller's promise.
    text_at(unsafe { robot.as_ref() }.map(|robot| &robot.warnings), index)
}

fn text_at(texts: Option<&Vec<CString>>, index: usize) -> *const c_char {
    texts.and_then(|texts| texts.get(index)).map_or(ptr::null(), |text| text.as_ptr())
}
