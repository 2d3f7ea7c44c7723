//! Force/torque sensors along the structure (Vorndamme 2017, section III).

mod distal_parts;
mod exclusion;
mod force_torque_sensor;
mod load_compensator;
mod sensor_tree;
mod wrench_observer;

pub use exclusion::sensor_torque;
pub use force_torque_sensor::{Convention, ForceTorqueSensor};
pub(crate) use load_compensator::check_readings;
pub use load_compensator::LoadCompensator;
pub use sensor_tree::{SensorTree, JOINT_TORQUES};
pub(crate) use wrench_observer::{is_known, WrenchObserver};
