//! Dynamics of the tree of bodies.

mod forward;
mod inertia;
mod inverse;
mod mass_matrix;
mod momentum;

pub use forward::ForwardDynamics;
pub use momentum::MomentumPass;
