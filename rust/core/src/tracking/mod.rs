//! Contacts with an identity over time: what the torques of a whole contact say of its place.

mod evidence;
mod identities;
mod path;
mod tracker;

pub(crate) use evidence::TickEvidence;
pub(crate) use tracker::ContactTracker;
