//! Force/torque sensors along the structure (Vorndamme 2017, section III).

mod force_torque_sensor;
mod sensor_tree;

pub use force_torque_sensor::{Convention, ForceTorqueSensor};
pub use sensor_tree::SensorTree;
