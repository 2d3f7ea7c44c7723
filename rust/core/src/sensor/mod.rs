//! Force/torque sensors along the structure (Vorndamme 2017, section III).

pub(crate) mod distal_parts;
mod exclusion;
mod force_torque_sensor;
mod gravity_span;
mod ids;
mod load_compensator;
mod sensor_tree;
mod tool_load;

pub(crate) use exclusion::{exclude_wanted, leave_out_blind, sensor_torque};
pub use force_torque_sensor::{Convention, ForceTorqueSensor};
pub use ids::SensorIndex;
pub(crate) use load_compensator::check_readings;
pub use load_compensator::LoadCompensator;
pub(crate) use sensor_tree::SensorTree;
pub use sensor_tree::JOINT_TORQUES;
pub use tool_load::{identify_tool, ToolLoad};
