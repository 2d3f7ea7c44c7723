//! The posterior of one contact over all of a robot's surface (algorithm D4).

mod contact_map;
mod estimate;
mod identifiability;
mod leaves;
mod measurement;
mod measurements;
mod options;
mod summary;
mod surface_posterior;
mod surface_samples;

pub(crate) use measurement::Measurement;
pub(crate) use summary::Summary;
pub(crate) use surface_posterior::SurfacePosterior;

pub use contact_map::ContactMap;
pub use estimate::MapEstimate;
pub use identifiability::Identifiability;
pub use options::MapOptions;
pub(crate) use options::GREATEST_FORCE;
