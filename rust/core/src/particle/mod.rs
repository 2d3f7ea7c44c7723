//! Contacts anywhere on a robot by a particle filter (Bimbo 2019).
//!
//! A particle is a hypothesis: the link, the point on its surface, the obstacle's centre of curvature, the force and
//! the stiffness of the contact. Its geometry moves with the robot (`motion.rs`), its force is weighed against the
//! measured torque (`likelihood.rs`), and particles are drawn anew by their weights (`resampling.rs`).

mod adaptation;
mod beside;
mod birth;
mod check;
mod clock;
mod cloud;
mod columns;
mod contacts;
mod estimate;
mod filter;
mod instant;
mod known;
mod left_over;
mod likelihood;
mod motion;
mod obstacle;
mod options;
mod push;
mod rejuvenation;
mod response;
mod schedule;
mod search;
mod sets;
mod spring;
mod stages;
mod state;
mod step_noise;
mod weight;
mod window;

pub(crate) use birth::exposed_places;
pub use columns::Columns;
pub use estimate::{Event, FilterEstimate};
pub use filter::{ContactParticleFilter, ContactParticles};
pub(crate) use instant::Instant;
pub(crate) use motion::signed;
pub(crate) use options::{whole, MOST_CONTACTS};
pub use options::{FilterOptions, Likelihood, Motion};
pub(crate) use rejuvenation::tangent;
pub use schedule::Schedule;
pub use stages::Stages;
pub(crate) use step_noise::NEW_POSE;

pub use crate::posterior::{ContactEstimate, Mode};
pub use crate::torque::ForceModel;
