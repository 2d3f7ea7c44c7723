//! What kind of contact it is: clamped, transient or sustained; intended or accidental.

mod class;
mod classifier;
mod features;
mod followed;
mod levers;
mod logits;
mod prior;
mod weights;

pub use class::{ContactClass, Kind};
pub use classifier::ContactClassifier;
pub use features::{Features, FEATURES, FEATURE_NAMES};
pub use prior::ClassifierOptions;
