//! The one error type; each kind has its exception in Python.

use std::borrow::Cow;
use std::error::Error as StdError;
use std::fmt;
#[cfg(feature = "mesh-files")]
use std::path::Path;
use std::path::PathBuf;
use std::sync::Arc;

/// What went wrong. The message names the thing and says what would be right.
///
/// ```
/// use contactsense::robot::{Robot, RobotDescription};
/// use contactsense::Error;
///
/// match Robot::example_arm().check_configuration(&[0.0; 6]) {
///     Err(Error::Input { argument, problem, .. }) => {
///         assert_eq!((argument.as_ref(), problem.as_str()), ("q", "expected 7 numbers, got 6"));
///     }
///     other => panic!("{other:?}"),
/// }
///
/// let mut description = RobotDescription::example_arm();
/// description.joints[2].mass = -1.0;
/// match Robot::new(description) {
///     Err(Error::Model { element, problem, .. }) => {
///         assert_eq!(element.as_deref(), Some("joint 'joint_3'"));
///         assert_eq!(problem, "joint 'joint_3': mass must not be negative, not -1 kg");
///     }
///     other => panic!("{other:?}"),
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Error {
    /// The robot's description cannot be used.
    #[non_exhaustive]
    Model {
        /// The link or joint that is wrong, as `joint 'wrist'`; none where it is no single one.
        element: Option<String>,
        /// The file with the description, if it is from a file.
        path: Option<PathBuf>,
        /// What is wrong where, and what would be right: the whole message.
        problem: String,
        /// What the system or a parser said.
        source: Option<Cause>,
    },
    /// A mesh or a primitive cannot be used.
    #[non_exhaustive]
    Geometry {
        /// The link that it belongs to, as `link 'hand'`; or the part of a surface that belongs to none yet, as `part 2`.
        element: Option<String>,
        /// The mesh file, or the file with the description of the shape, if it is from a file.
        path: Option<PathBuf>,
        /// What is wrong where, and what would be right: the whole message.
        problem: String,
        /// What the system or a parser said.
        source: Option<Cause>,
    },
    /// An argument of a call cannot be used; the object is unchanged.
    #[non_exhaustive]
    Input {
        /// Name of the argument or option.
        argument: Cow<'static, str>,
        /// What is wrong with it, and what would be right.
        problem: String,
    },
    /// There is not enough memory for what was asked for.
    Memory(String),
    /// A call was stopped from another thread.
    Stopped,
}

/// The error of the system or a parser that an error of this crate stems from.
pub type Cause = Arc<dyn StdError + Send + Sync>;

impl Error {
    /// A description that cannot be used, and why.
    pub fn model(problem: impl Into<String>) -> Self {
        Error::Model { element: None, path: None, problem: problem.into(), source: None }
    }

    /// A mesh or primitive that cannot be used, and why.
    pub fn geometry(problem: impl Into<String>) -> Self {
        Error::Geometry { element: None, path: None, problem: problem.into(), source: None }
    }

    /// An argument that cannot be used, and why.
    pub fn input(argument: impl Into<Cow<'static, str>>, problem: impl Into<String>) -> Self {
        Error::Input { argument: argument.into(), problem: problem.into() }
    }

    /// The same of an element that the message names already, where no element is known yet.
    #[must_use]
    pub(crate) fn of(mut self, owner: &str) -> Self {
        if let Error::Model { element, .. } | Error::Geometry { element, .. } = &mut self {
            element.get_or_insert_with(|| owner.to_owned());
        }
        self
    }

    /// The same of a shape of `owner`, which the message does not name yet.
    #[must_use]
    pub fn within(mut self, owner: &str) -> Self {
        if let Error::Geometry { element, problem, .. } = &mut self {
            *problem = format!("{owner}: {problem}");
            *element = Some(owner.to_owned());
        }
        self
    }

    /// The same in a file, where no file is known yet.
    #[cfg(feature = "mesh-files")]
    #[must_use]
    pub(crate) fn in_file(mut self, file: &Path) -> Self {
        if let Error::Model { path, .. } | Error::Geometry { path, .. } = &mut self {
            path.get_or_insert_with(|| file.to_owned());
        }
        self
    }

    /// The same with its source.
    #[cfg(feature = "mesh-files")]
    #[must_use]
    pub(crate) fn because(mut self, cause: Option<Cause>) -> Self {
        if let Error::Model { source, .. } | Error::Geometry { source, .. } = &mut self {
            *source = cause;
        }
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Model { problem, .. } | Error::Geometry { problem, .. } | Error::Memory(problem) => {
                f.write_str(problem)
            }
            Error::Input { argument, problem } => write!(f, "{argument}: {problem}"),
            Error::Stopped => f.write_str("the call was stopped"),
        }
    }
}

impl StdError for Error {
    fn source(&self) -> Option<&(dyn StdError + 'static)> {
        match self {
            Error::Model { source, .. } | Error::Geometry { source, .. } => {
                source.as_deref().map(|cause| cause as &(dyn StdError + 'static))
            }
            _ => None,
        }
    }
}

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;
