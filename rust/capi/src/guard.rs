//! What every call of C goes through: pointers are checked, and no panic leaves.

use std::ffi::{c_char, CStr};
use std::panic::{catch_unwind, AssertUnwindSafe};

use contactsense::{Error, Result};

use crate::status::{cs_status, failed, refused};

/// Runs a call, and says how it ended.
#[inline]
pub(crate) fn guarded(call: impl FnOnce() -> Result<()>) -> cs_status {
    // An object whose call has panicked is not used again: its caller is told.
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(Ok(())) => cs_status::CS_OK,
        Ok(Err(error)) => refused(&error),
        Err(_) => failed(cs_status::CS_ERROR_FAULT, "a fault of the library; do not use the object any more"),
    }
}

/// An error of an argument.
#[cold]
pub(crate) fn wrong(argument: &'static str, problem: &str) -> Error {
    Error::input(argument, problem)
}

/// The object behind a pointer.
///
/// # Safety
/// The pointer is null, or points to an object that lives and is not written to during `'a`.
pub(crate) unsafe fn object<'a, T>(pointer: *const T, argument: &'static str) -> Result<&'a T> {
    // SAFETY: as the caller promises.
    unsafe { pointer.as_ref() }.ok_or_else(|| wrong(argument, "must not be NULL"))
}

/// The same, to write to.
///
/// # Safety
/// The pointer is null, or points to an object that lives and that nothing else uses during `'a`.
pub(crate) unsafe fn object_mut<'a, T>(pointer: *mut T, argument: &'static str) -> Result<&'a mut T> {
    // SAFETY: as the caller promises.
    unsafe { pointer.as_mut() }.ok_or_else(|| wrong(argument, "must not be NULL"))
}

/// Numbers of C.
///
/// # Safety
/// The pointer is null, or points to `count` numbers that live and are not written to during `'a`.
pub(crate) unsafe fn numbers<'a>(
    pointer: *const f64,
    count: usize,
    argument: &'static str,
) -> Result<&'a [f64]> {
    if pointer.is_null() {
        return Err(wrong(argument, "must not be NULL"));
    }
    // SAFETY: as the caller promises.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// A text of C.
///
/// # Safety
/// The pointer is null, or points to a text that ends with NUL and lives during `'a`.
pub(crate) unsafe fn text<'a>(pointer: *const c_char, argument: &'static str) -> Result<&'a str> {
    if pointer.is_null() {
        return Err(wrong(argument, "must not be NULL"));
    }
    // SAFETY: as the caller promises.
    let text = unsafe { CStr::from_ptr(pointer) };
    text.to_str().map_err(|_| wrong(argument, "must be UTF-8"))
}
