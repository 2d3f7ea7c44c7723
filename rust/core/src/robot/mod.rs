//! The robot: description, tree, kinematics and dynamics.

pub(crate) mod ancestry;
mod by_name;
pub(crate) mod check;
pub(crate) mod configuration;
mod contact_links;
pub(crate) mod description;
mod dynamics;
mod example;
pub(crate) mod ids;
pub(crate) mod inertial_parameters;
pub(crate) mod integrate;
pub(crate) mod jacobian;
pub(crate) mod joint_axis;
mod kinematics;
mod link;
pub(crate) mod lump;
mod numbers;
mod payload;
#[allow(clippy::module_inception)] // the room is called after what is in it
mod robot;
#[cfg(test)]
pub(crate) mod test_tree;

pub use description::{JointDescription, JointKind, LinkDescription, RobotDescription};
pub use dynamics::{ForwardDynamics, MomentumPass};
pub(crate) use dynamics::{MassMatrixPass, MomentumRegressor, PARAMETERS};
pub use ids::{BodyIndex, LinkIndex};
pub use kinematics::{BodyState, Kinematics};
pub use link::Link;
pub use numbers::LARGEST;
pub use robot::Robot;
pub(crate) use robot::WORLD;
