//! Dynamics of the tree of bodies.

mod forward;
mod inertia;
mod inverse;
mod mass_matrix;
mod momentum;
mod regressor;

pub use forward::ForwardDynamics;
pub(crate) use mass_matrix::MassMatrixPass;
pub use momentum::MomentumPass;
pub(crate) use regressor::{MomentumRegressor, MOMENTS, PARAMETERS};
