//! What a `Calibration` consists of: `JointFriction`, `BodyInertia`, `Payload`.

use contactsense::calibration::{BodyInertia, Friction, Payload, Reversal};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::{from_rows, numbers, read_only};

type Array<'py> = Bound<'py, PyArray1<f64>>;

/// Friction of the joints inside the measured torque.
///
/// At a velocity `v` it is `coulomb * share + viscous * v`, where the share is between -1 and 1 and `reversal` says how it
/// changes its sign. Frozen; equal where all numbers are; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs
///     >>> friction = cs.Calibration.of_description(cs.Robot.named("iiwa14")).friction
///     >>> friction.coulomb.shape, friction.reversal[0]
///     ((7,), ('velocity', 0.03))
#[pyclass(frozen, eq, skip_from_py_object, name = "JointFriction", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyJointFriction {
    pub friction: Friction,
    pub coulomb_std: Vec<f64>,
    pub viscous_std: Vec<f64>,
}

impl PyJointFriction {
    pub fn from_content((friction, coulomb_std, viscous_std): (Friction, Vec<f64>, Vec<f64>)) -> Self {
        Self { friction, coulomb_std, viscous_std }
    }
}

#[pymethods]
impl PyJointFriction {
    /// Coulomb friction, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    #[getter]
    fn coulomb<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.friction.coulomb)
    }

    /// Standard deviation of `coulomb`, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    #[getter]
    fn coulomb_std<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.coulomb_std)
    }

    /// Viscous friction, `(nv,)` [Nm s/rad; N s/m for sliding joints]; a read-only copy.
    #[getter]
    fn viscous<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.friction.viscous)
    }

    /// Standard deviation of `viscous`, `(nv,)` [Nm s/rad; N s/m for sliding joints]; a read-only copy.
    #[getter]
    fn viscous_std<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.viscous_std)
    }

    /// How Coulomb friction changes its sign: pairs, one a joint.
    ///
    /// `("velocity", s)`: with the velocity as `tanh(v / s)` [rad/s, m/s]. `("displacement", s)`: with the path since the
    /// joint turned round, and whole after `2 s` [rad, m].
    #[getter]
    fn reversal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let pair = |reversal: &Reversal| match reversal {
            Reversal::Velocity(slow) => ("velocity", *slow),
            Reversal::Displacement(length) => ("displacement", *length),
        };
        PyTuple::new(py, self.friction.reversal.iter().map(pair))
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), &["coulomb", "coulomb_std", "viscous", "viscous_std", "reversal"])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "JointFriction", &(&self.friction, &self.coulomb_std, &self.viscous_std))
    }

    fn __repr__(&self) -> String {
        let [coulomb, viscous] = [&self.friction.coulomb, &self.friction.viscous].map(|x| rounded(x));
        format!("JointFriction(coulomb={coulomb}, viscous={viscous})")
    }
}

/// The inertia of all that moves with one joint, in the frame of the link that the joint moves.
///
/// Frozen; equal where all numbers are; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs
///     >>> body = cs.Calibration.of_description(cs.Robot.named("iiwa14")).bodies[0]
///     >>> body.link, round(body.mass, 3)
///     ('iiwa_link_1', 5.76)
#[pyclass(frozen, eq, skip_from_py_object, name = "BodyInertia", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyBodyInertia(pub BodyInertia);

#[pymethods]
impl PyBodyInertia {
    /// Name of that link.
    #[getter]
    fn link(&self) -> &str {
        &self.0.link
    }

    /// Mass [kg].
    #[getter]
    fn mass(&self) -> f64 {
        self.0.mass
    }

    /// Centre of mass, `(3,)`, link frame [m]; a read-only copy.
    #[getter]
    fn com<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.com)
    }

    /// Inertia about the centre of mass, `(3, 3)`, in the link's axes [kg m^2]; a read-only copy.
    #[getter]
    fn inertia<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let [xx, xy, yy, xz, yz, zz] = self.0.inertia;
        Ok(read_only(from_rows(py, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].into_iter())?))
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), &["link", "mass", "com", "inertia"])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "BodyInertia", &self.0)
    }

    fn __repr__(&self) -> String {
        format!("BodyInertia('{}', mass={:.4}, com={})", self.0.link, self.0.mass, rounded(&self.0.com))
    }
}

/// A payload at a link.
///
/// Frozen; equal where all numbers are; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs
///     >>> cs.Calibration.of_description(cs.Robot.named("iiwa14")).payload is None
///     True
#[pyclass(frozen, eq, skip_from_py_object, name = "Payload", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyPayload(pub Payload);

#[pymethods]
impl PyPayload {
    /// Name of the link that holds it.
    #[getter]
    fn link(&self) -> &str {
        &self.0.link
    }

    /// Mass [kg].
    #[getter]
    fn mass(&self) -> f64 {
        self.0.mass
    }

    /// Standard deviation of `mass` [kg].
    #[getter]
    fn mass_std(&self) -> f64 {
        self.0.mass_std
    }

    /// Centre of mass, `(3,)`, link frame [m]; a read-only copy.
    #[getter]
    fn com<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.com)
    }

    /// Standard deviation of each coordinate of `com`, `(3,)` [m]; a read-only copy.
    #[getter]
    fn com_std<'py>(&self, py: Python<'py>) -> Array<'py> {
        numbers(py, &self.0.com_std)
    }

    /// Moment of inertia about the centre of mass, taken to be the same about all axes [kg m^2].
    #[getter]
    fn moment(&self) -> f64 {
        self.0.moment
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        plain_dict(slf.as_any(), &["link", "mass", "mass_std", "com", "com_std", "moment"])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "Payload", &self.0)
    }

    fn __repr__(&self) -> String {
        let Payload { link, mass, mass_std, com, .. } = &self.0;
        format!("Payload('{link}', mass={mass:.4} +- {mass_std:.4}, com={})", rounded(com))
    }
}

/// Numbers as `repr` shows them: to four decimal places.
fn rounded(numbers: &[f64]) -> String {
    format!("{numbers:.4?}")
}
