//! The one error type; each kind has its exception in Python.

use std::borrow::Cow;

/// What went wrong. The message names the thing and says what would be right.
///
/// ```
/// use contactsense::{robot::Robot, Error};
///
/// match Robot::example_arm().check_configuration(&[0.0; 6]) {
///     Err(Error::Input { argument, problem, .. }) => {
///         assert_eq!((argument.as_ref(), problem.as_str()), ("q", "expected 7 numbers, got 6"));
///     }
///     other => panic!("{other:?}"),
/// }
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The robot's description cannot be used.
    #[error("{0}")]
    Model(String),
    /// A mesh or a primitive cannot be used.
    #[error("{0}")]
    Geometry(String),
    /// An argument of a call cannot be used; the object is unchanged.
    #[error("{argument}: {problem}")]
    #[non_exhaustive]
    Input {
        /// Name of the argument or option.
        argument: Cow<'static, str>,
        /// What is wrong with it, and what would be right.
        problem: String,
    },
    /// There is not enough memory for what was asked for.
    #[error("{0}")]
    Memory(String),
    /// A call was stopped from another thread.
    #[error("the call was stopped")]
    Stopped,
}

impl Error {
    /// An argument that cannot be used, and why.
    pub fn input(argument: impl Into<Cow<'static, str>>, problem: impl Into<String>) -> Self {
        Error::Input { argument: argument.into(), problem: problem.into() }
    }
}

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;
