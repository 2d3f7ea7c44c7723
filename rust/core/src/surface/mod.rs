//! A link's surface.
