//! Posteriors over contacts, whatever their samples come from: modes, estimates, resampling.

mod clusters;
mod contact_sample;
mod estimate;
mod evidence;
pub(crate) mod memory;
mod mode;
mod moments;
pub(crate) mod parallel;
pub(crate) mod resampling;
pub(crate) mod tempering;

pub(crate) use clusters::{Clusters, MOST_MODES};
pub(crate) use contact_sample::{ContactSample, ContactSamples};
pub use estimate::ContactEstimate;
pub(crate) use evidence::Evidence;
pub use mode::Mode;
