//! What a robot can do after a contact, within bounds; no safety function.

mod gravity;
mod limits;
mod motion;

pub use limits::ReactionLimits;
pub use motion::Reaction;
