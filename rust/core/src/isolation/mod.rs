//! Isolation and identification: where a contact is and how hard (Vorndamme 2017, section IV).

mod body_set;
mod force;
mod isolator;
mod line;
mod result;
mod wrench;

pub use isolator::{ContactIsolator, IsolatorOptions};
pub use result::{Candidate, Contact, Isolation};
