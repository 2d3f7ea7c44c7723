//! The one error type; each kind has its exception in Python.

/// What went wrong. The message names the thing and says what would be right.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The robot's description cannot be used.
    #[error("{0}")]
    Model(String),
    /// A mesh or a primitive cannot be used.
    #[error("{0}")]
    Geometry(String),
    /// An argument of a call cannot be used; the object is unchanged.
    #[error("{0}")]
    Input(String),
    /// There is not enough memory for what was asked for.
    #[error("{0}")]
    Memory(String),
}

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;
