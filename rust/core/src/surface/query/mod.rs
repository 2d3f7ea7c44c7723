//! What is asked of a surface: closest points, all hits of a line.

pub(crate) mod cast;
pub(crate) mod closest;
mod crowded;
mod descent;
mod inside;
mod line;
mod rays;
mod side;
pub(crate) mod triangle;
mod union;
