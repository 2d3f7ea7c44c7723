//! Isolation and identification: where a contact is and how hard (Vorndamme 2017, section IV).

mod body_set;
mod caster;
mod conics;
mod contact_evidence;
mod determined_wrench;
mod force;
mod found;
mod from_torques;
mod isolator;
mod likely;
mod line;
mod number;
mod one_more;
mod open_part;
mod options;
mod pair;
mod posterior;
mod region;
mod report;
mod result;
mod rivals;
mod rows;
mod sensed;
mod several;
mod single;
mod stacked;
mod surface_contact;
mod surface_search;
mod tips;
mod together;
mod work;
mod wrench;
mod wrench_rows;

pub(crate) use contact_evidence::{ContactEvidence, WithoutWanted, LEFT_OUT};
pub use determined_wrench::DeterminedWrench;
pub use isolator::ContactIsolator;
#[cfg(feature = "serde")]
pub(crate) use options::samples;
pub use options::IsolatorOptions;
pub(crate) use options::SAMPLES;
pub use posterior::{ContactPosterior, LinkProbability, PathPoint, Track};
pub use result::{Candidate, Contact, ContactPlace, Isolation};
pub(crate) use surface_contact::{SurfaceContact, TorqueNow};
