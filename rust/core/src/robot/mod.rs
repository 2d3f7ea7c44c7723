//! The robot: description, tree, kinematics and dynamics.

pub(crate) mod configuration;
mod description;
mod forward_dynamics;
mod inertia;
mod inverse_dynamics;
mod jacobian;
mod kinematics;
mod link;
mod mass_matrix;
mod momentum;
pub(crate) mod motion;
mod tree;
mod urdf;

pub use configuration::LARGEST;
pub use description::{JointDescription, JointKind, LinkDescription, RobotDescription};
pub use forward_dynamics::ForwardDynamics;
pub use kinematics::{BodyState, Kinematics};
pub use link::Link;
pub use momentum::MomentumPass;
pub use tree::{Robot, WORLD};
pub use urdf::{from_urdf, UrdfGeometry, UrdfOptions};
