//! Contacts with an obstacle that stays where it is, sampled from all that was measured of them (algorithm C3).
//!
//! A hypothesis is the link, the place on it where it touched first, and the radius of the obstacle: these fix the obstacle's centre
//! in the world for good, and with it the place and the depth of the contact at every later pose. Other models of a contact, of which
//! the place is all there is, are weighed beside it. Force and stiffness, which the torques are linear in, are integrated out (`sums.rs`). The kernel that takes hypotheses from one measurement to the next
//! is in `posterior/tempering.rs`, the model it is given is in `path.rs`.

mod hypothesis;
mod measurements;
mod options;
mod particle;
mod path;
mod static_obstacle;
mod sums;

pub use hypothesis::ContactModel;
pub use options::SamplerOptions;
pub use particle::Particle;
pub use static_obstacle::StaticObstacleSampler;
