//! Contacts with obstacles that stay where they are, sampled from all that was measured of them (algorithm C3).
//!
//! A hypothesis is, for each contact, the link, the place on it where it touched first, and the radius of the obstacle: these fix the
//! obstacle's centre in the world for good, and with it the place and the depth of the contact at every later pose (`touch.rs`). Other
//! models of a single contact, of which the place is all there is, are weighed beside it. Forces and stiffnesses, which the torques are
//! linear in, are integrated out (`sums.rs`). The kernel that takes hypotheses from one measurement to the next is in
//! `posterior/tempering.rs`, the model it is given is in `moves.rs`; there is one population of hypotheses for each number of contacts
//! (`population.rs`).

mod all_measurements;
mod between;
mod elsewhere;
mod friction;
mod hypothesis;
mod making;
mod measurements;
mod moves;
mod neighbours;
mod numbers;
mod options;
mod order;
mod particle;
mod path;
mod population;
mod static_obstacle;
mod sums;
mod touch;
mod two_stages;

pub use hypothesis::ContactModel;
pub use options::SamplerOptions;
pub use particle::Particle;
pub use static_obstacle::StaticObstacleSampler;
