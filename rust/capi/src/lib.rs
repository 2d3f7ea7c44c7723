//! The C interface: robots from URDF files, and monitors that are called once a control tick.
//!
//! Objects are made and freed by functions of this library. Functions that can fail return a `cs_status`;
//! `cs_error_message` then says what was wrong. Nothing of Rust crosses the boundary: no panic, no exception.
//! What a call cannot know is NaN.
#![allow(non_camel_case_types)] // the names of C

mod calibration;
mod guard;
mod monitor;
mod options;
mod report;
mod robot;
mod sensor;
mod status;

pub use calibration::{cs_calibration, cs_calibration_free, cs_calibration_load};
pub use monitor::{
    cs_monitor, cs_monitor_clear_payload, cs_monitor_free, cs_monitor_miss, cs_monitor_new, cs_monitor_reset,
    cs_monitor_set_payload, cs_monitor_tare, cs_monitor_update, cs_monitor_update_external, cs_sample,
};
pub use options::{cs_monitor_options, cs_monitor_options_default, cs_wanted_point};
pub use report::{cs_contact, cs_report, CS_MAX_CONTACTS};
pub use robot::{
    cs_robot, cs_robot_free, cs_robot_from_urdf, cs_robot_joint_name, cs_robot_link_name, cs_robot_nq,
    cs_robot_ntau, cs_robot_nv, cs_robot_warning, cs_urdf_options,
};
pub use sensor::{cs_sensor, cs_sensor_default};
pub use status::{cs_error_message, cs_status, cs_version};
