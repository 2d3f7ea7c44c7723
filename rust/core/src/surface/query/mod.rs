//! What is asked of a surface: closest points, all hits of a line.

pub(crate) mod closest;
mod crowded;
pub(crate) mod descent;
mod line;
pub(crate) mod rays;
pub(crate) mod triangle;
mod union;
