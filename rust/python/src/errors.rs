//! The package's exceptions, and the core's errors as such.

use std::any::Any;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::sync::mpsc::{channel, RecvTimeoutError};
use std::thread::Builder;
use std::time::Duration;

use contactsense::Error;
use pyo3::exceptions::{PyException, PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};

struct Classes {
    root: Py<PyType>,
    model: Py<PyType>,
    geometry: Py<PyType>,
    input: Py<PyType>,
}

static CLASSES: PyOnceLock<Classes> = PyOnceLock::new();

fn classes(py: Python<'_>) -> PyResult<&Classes> {
    CLASSES.get_or_try_init(py, || {
        let root = class(
            py,
            "ContactSenseError",
            "Root of every error this library raises on purpose.",
            &[py.get_type::<PyException>()],
        )?;
        Ok(Classes {
            model: class(
                py,
                "ModelError",
                "The robot's description (URDF or Pinocchio model) cannot be used; the message names the element.",
                std::slice::from_ref(&root),
            )?
            .unbind(),
            geometry: class(
                py,
                "GeometryError",
                "A mesh or shape of the robot's surface cannot be used; the message names the link or file.",
                std::slice::from_ref(&root),
            )?
            .unbind(),
            input: class(
                py,
                "InputError",
                "An argument of a call is wrong; the message names it and says what would be right.\n\n\
                 The object's state is as it was before the call. Also raised where another thread is using the object.",
                &[root.clone(), py.get_type::<PyValueError>()],
            )?
            .unbind(),
            root: root.unbind(),
        })
    })
}

/// An exception class, made as a `class` statement of Python makes it: one of two bases has no other way.
fn class<'py>(
    py: Python<'py>,
    name: &str,
    doc: &str,
    bases: &[Bound<'py, PyType>],
) -> PyResult<Bound<'py, PyType>> {
    let members = PyDict::new(py);
    // Where users find it, and where unpickling looks for it.
    members.set_item("__module__", "contactsense")?;
    members.set_item("__doc__", doc)?;
    let made = py.get_type::<PyType>().call1((name, PyTuple::new(py, bases)?, members))?;
    Ok(made.cast_into::<PyType>()?)
}

/// Adds the classes to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let Classes { root, model, geometry, input } = classes(module.py())?;
    module.add("ContactSenseError", root)?;
    module.add("ModelError", model)?;
    module.add("GeometryError", geometry)?;
    module.add("InputError", input)
}

/// A Python exception that says what the core said.
pub fn to_python(py: Python<'_>, error: Error) -> PyErr {
    let classes = match classes(py) {
        Ok(classes) => classes,
        Err(error) => return error,
    };
    let class = match error {
        Error::Model { .. } => &classes.model,
        Error::Geometry { .. } => &classes.geometry,
        Error::Input { .. } => &classes.input,
        Error::Memory(text) => return PyMemoryError::new_err(text),
        _ => &classes.root,
    };
    PyErr::from_type(class.bind(py).clone(), error.to_string())
}

/// An `InputError`.
pub fn input(py: Python<'_>, text: String) -> PyErr {
    match classes(py) {
        Ok(classes) => PyErr::from_type(classes.input.bind(py).clone(), text),
        Err(error) => error,
    }
}

/// Whether what reading an argument raised is the argument's fault: no `KeyboardInterrupt` or another exception that is
/// no `Exception`, and no `MemoryError`.
pub fn is_fault(py: Python<'_>, error: &PyErr) -> bool {
    error.is_instance_of::<PyException>(py) && !error.is_instance_of::<PyMemoryError>(py)
}

/// An `InputError` for what reading an argument raised, where that is the argument's fault.
pub fn refused(py: Python<'_>, cause: PyErr, text: impl FnOnce() -> String) -> PyErr {
    if !is_fault(py, &cause) {
        return cause;
    }
    let error = input(py, text());
    error.set_cause(py, Some(cause));
    error
}

/// Runs long work while other Python threads run. A panic in it, a bug of this library, is a `ContactSenseError`.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).map_err(|panic| panicked(py, &*panic))
}

/// The same on a thread of its own, so that Ctrl-C ends the call; the thread then still ends its work, which nobody sees.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (done, mut result) = channel();
    let thread = move || _ = done.send(catch_unwind(AssertUnwindSafe(work)));
    Builder::new().spawn(thread).map_err(|error| PyMemoryError::new_err(format!("no thread: {error}")))?;
    loop {
        let waiting = &mut result;
        match py.detach(move || waiting.recv_timeout(SIGNALS_SEEN_WITHIN)) {
            Ok(found) => return found.map_err(|panic| panicked(py, &*panic)),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => return Err(panicked(py, &"the thread is gone")),
        }
    }
}

/// How long Ctrl-C waits: no person notices.
const SIGNALS_SEEN_WITHIN: Duration = Duration::from_millis(50);

fn panicked(py: Python<'_>, panic: &(dyn Any + Send)) -> PyErr {
    let said = panic.downcast_ref::<String>().map(String::as_str);
    let said = said.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
    let text = format!("internal error of contactsense, please report it: {said}");
    match classes(py) {
        Ok(classes) => PyErr::from_type(classes.root.bind(py).clone(), text),
        Err(error) => error,
    }
}
