//! How a call ended.

use std::cell::RefCell;
use std::ffi::{c_char, CString};

use contactsense::Error;

/// How a call ended.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum cs_status {
    CS_OK = 0,
    /// An argument cannot be used; objects are unchanged, but a refused sample counts as time that passed.
    CS_ERROR_INPUT = 1,
    /// The description of the robot cannot be used.
    CS_ERROR_MODEL = 2,
    /// A mesh or a primitive cannot be used.
    CS_ERROR_GEOMETRY = 3,
    /// There is not enough memory.
    CS_ERROR_MEMORY = 4,
    /// A fault of the library. The object of the call must not be used any more, except to free it.
    CS_ERROR_FAULT = 5,
}

thread_local! {
    /// Of the last call of this thread that failed.
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// What was wrong in the last call of this thread that failed; empty before. Valid until another call of this thread
/// fails.
#[no_mangle]
pub extern "C" fn cs_error_message() -> *const c_char {
    MESSAGE.with(|message| message.borrow().as_ptr())
}

/// The version of the library, such as "0.1.0".
#[no_mangle]
pub extern "C" fn cs_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

#[cold]
pub(crate) fn failed(status: cs_status, text: &str) -> cs_status {
    // A NUL in a name of a file ends the message.
    let text = text.split('\0').next().unwrap_or_default();
    let text = CString::new(text).unwrap_or_default();
    MESSAGE.with(|message| *message.borrow_mut() = text);
    status
}

#[cold]
pub(crate) fn refused(error: &Error) -> cs_status {
    let status = match error {
        Error::Model { .. } => cs_status::CS_ERROR_MODEL,
        Error::Geometry { .. } => cs_status::CS_ERROR_GEOMETRY,
        Error::Input { .. } => cs_status::CS_ERROR_INPUT,
        Error::Memory(_) => cs_status::CS_ERROR_MEMORY,
        _ => cs_status::CS_ERROR_FAULT,
    };
    failed(status, &error.to_string())
}
