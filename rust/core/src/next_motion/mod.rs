//! The small motion in contact that is expected to tell most about where the contact is.
//!
//! Each hypothesis is a contact with an obstacle that stays in the world, as in the particle filter (Bimbo 2019, eq. 8): it
//! predicts how the external torque changes with a motion. A motion tells much where hypotheses of different places predict
//! changes that differ by more than the noise (Bayesian experimental design; Lindley 1956). Random motions are drawn
//! (`candidates.rs`) and kept where the contact is neither lost nor pressed too hard under the hypotheses (`prediction.rs`);
//! each hypothesis in turn is held to be true, and what is left of the others is averaged (`information.rs`).

mod belief;
mod candidates;
mod information;
mod obstacle;
mod options;
mod planner;
mod prediction;
mod sharpening;

pub use belief::ContactHypothesis;
pub use options::NextMotionOptions;
pub use planner::{next_motion, NextMotion, NothingFound};
