//! What explains an external torque: how large its errors are, and what a force at a surface point does to the joints.

mod cone;
mod error_variances;
mod fit;
mod force_model;
mod frames;
mod link_target;
mod model_error;
mod noise_model;
mod normal_equations;
mod place_step;
mod push_likelihood;
mod several_pushes;
mod target;

pub use cone::{best_cone_force, ConeForce, ConePart};
pub(crate) use error_variances::{ErrorVariances, SlowNoise};
pub(crate) use fit::{BestForce, NormalFit};
pub(crate) use force_model::directions;
pub use force_model::ForceModel;
pub(crate) use frames::{Frame, Frames, SensorMount, WRENCH};
pub use model_error::ModelError;
pub use noise_model::NoiseModel;
pub(crate) use noise_model::{largest, TorqueNoise, LEVEL, SENSOR_RELATIVE};
pub(crate) use normal_equations::NormalEquations;
pub(crate) use place_step::PlaceStep;
pub(crate) use push_likelihood::{ForcePrior, PlaceBlock, PushLikelihood, LANES, PIECE};
pub(crate) use several_pushes::{AllDirections, SeveralPushes};
pub(crate) use target::Target;
