//! Force/torque sensors along the structure (Vorndamme 2017, section III).

mod distal_parts;
mod exclusion;
mod force_torque_sensor;
mod lagged_torque;
mod load_compensator;
mod sensor_tree;

pub use exclusion::sensor_torque;
pub use force_torque_sensor::{Convention, ForceTorqueSensor};
pub(crate) use lagged_torque::is_known;
pub use lagged_torque::LaggedTorques;
pub use load_compensator::LoadCompensator;
pub use sensor_tree::SensorTree;
