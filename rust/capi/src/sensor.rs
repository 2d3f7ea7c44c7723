//! Force/torque sensors of a robot.

use std::ffi::c_char;

use contactsense::nalgebra::{Matrix3, Vector3};
use contactsense::sensor::{Convention, ForceTorqueSensor};
use contactsense::spatial::Pose;
use contactsense::Result;

use crate::guard::text;

/// A force/torque sensor where a link joins its parent: the link and all behind it load it.
/// `cs_sensor_default` has the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cs_sensor {
    /// A name that no other sensor has.
    pub name: *const c_char,
    /// The link.
    pub link: *const c_char,
    /// The sensor's axes in the link's frame: rows of a rotation matrix.
    pub rotation: [f64; 9],
    /// The sensor's origin in the link's frame (m).
    pub translation: [f64; 3],
    /// Whether a reading is what holds the load, not the load itself.
    pub reads_support: bool,
    /// Whether contacts behind it are meant, as those of feet and hands are, and no collision.
    pub wanted: bool,
    /// What it reads without load (N, Nm).
    pub offset: [f64; 6],
}

/// A sensor in the link's frame that reads the load. The texts must live until a monitor is made.
#[no_mangle]
pub extern "C" fn cs_sensor_default(name: *const c_char, link: *const c_char) -> cs_sensor {
    cs_sensor {
        name,
        link,
        rotation: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        translation: [0.0; 3],
        reads_support: false,
        wanted: false,
        offset: [0.0; 6],
    }
}

impl cs_sensor {
    /// As the core has it.
    ///
    /// # Safety
    /// The texts are null or end with NUL.
    pub(crate) unsafe fn wanted(&self) -> Result<ForceTorqueSensor> {
        // SAFETY: the caller's promise.
        let (name, link) = unsafe { (text(self.name, "sensors: name")?, text(self.link, "sensors: link")?) };
        Ok(ForceTorqueSensor {
            pose: Pose {
                rotation: Matrix3::from_row_slice(&self.rotation),
                translation: Vector3::from(self.translation),
            },
            convention: if self.reads_support { Convention::Support } else { Convention::Load },
            offset: self.offset,
            ..ForceTorqueSensor::new(name, link)
        })
    }
}
