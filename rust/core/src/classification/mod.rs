//! What kind of contact it is: clamped, transient or sustained; intended or accidental.

mod classifier;
mod features;
mod followed;
mod weights;

pub use classifier::{ClassifierOptions, ContactClass, ContactClassifier};
pub use features::{Features, FEATURES, FEATURE_NAMES};
