//! What readers of files say is wrong, before it is known which file it is.

use std::error::Error as StdError;
use std::fmt;
use std::sync::Arc;

use crate::error::Cause;

/// A message, and the error of the system or a parser behind it.
#[derive(Debug)]
pub(crate) struct Problem {
    pub text: String,
    pub cause: Option<Cause>,
}

impl Problem {
    /// What another error says.
    pub fn from_error(cause: impl StdError + Send + Sync + 'static) -> Self {
        Problem { text: cause.to_string(), cause: Some(Arc::new(cause)) }
    }
}

impl<T: Into<String>> From<T> for Problem {
    fn from(text: T) -> Self {
        Problem { text: text.into(), cause: None }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
