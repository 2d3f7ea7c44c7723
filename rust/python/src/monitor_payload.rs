//! `ContactMonitor` with a payload that is picked up and put down, and `PayloadProposal`.

use contactsense::monitor::PayloadProposal;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{number, text};
use crate::arrays::Vector;
use crate::errors::to_python;
use crate::monitor::PyContactMonitor;
use crate::pickle::{plain_dict, reduced, Reduced};
use crate::returned::numbers;

/// A payload that recent motion shows and the model lacks, as `ContactMonitor.propose_payload` finds it.
///
/// Frozen; equal where all numbers are; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs
///     >>> monitor = cs.ContactMonitor(cs.Robot.named("iiwa14"), dt=1e-3)
///     >>> monitor.propose_payload() is None  # of a robot that has not moved
///     True
#[pyclass(frozen, eq, skip_from_py_object, name = "PayloadProposal", module = "contactsense")]
#[derive(PartialEq, Clone)]
pub struct PyPayloadProposal(pub PayloadProposal);

#[pymethods]
impl PyPayloadProposal {
    /// Name of the link that carries it.
    #[getter]
    fn link(&self) -> &str {
        &self.0.link
    }

    /// Mass in addition to what `monitor.robot` has [kg].
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
    fn com<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.com)
    }

    /// Standard deviation of each coordinate of `com`, `(3,)` [m]; a read-only copy.
    #[getter]
    fn com_std<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.0.com_std)
    }

    /// Share of the time with an external torque in which the payload explains it, from 0 to 1.
    #[getter]
    fn evidence(&self) -> f64 {
        self.0.evidence
    }

    /// Number of poses of the link towards gravity in which it does.
    #[getter]
    fn poses(&self) -> usize {
        self.0.poses
    }

    /// Length of the motion that it was found in, up to now [s].
    #[getter]
    fn seconds(&self) -> f64 {
        self.0.seconds
    }

    /// All attributes by name.
    ///
    /// Returns:
    ///     Plain Python values: numbers, strings, and lists in place of arrays.
    fn to_dict<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyDict>> {
        let names = ["link", "mass", "mass_std", "com", "com_std", "evidence", "poses", "seconds"];
        plain_dict(slf.as_any(), &names)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        reduced(py, "PayloadProposal", &self.0)
    }

    fn __repr__(&self) -> String {
        let PayloadProposal { link, mass, mass_std, com, .. } = &self.0;
        format!("PayloadProposal('{link}', mass={mass:.4} +- {mass_std:.4}, com={com:.4?})")
    }
}

#[pymethods]
impl PyContactMonitor {
    /// Says what the robot carries from the next tick on.
    ///
    /// The payload takes the place of one that was set before; what the description or a calibration has stays, and so does
    /// the payload over `reset()`. External torque, bias and contacts go on. Call it at the tick at which the robot bears the
    /// weight. Where all joints are tested at once (`calibration`), that may be up to half a second later: for so long the
    /// weight counts as unknown, and a contact with the same torques is not seen. A weight that is borne before it is set
    /// is an external torque. Not for the control loop: it allocates.
    ///
    /// Args:
    ///     link: Name of the link that holds it.
    ///     mass: Mass [kg].
    ///     com: Centre of mass in the link's frame, `(3,)` [m].
    ///
    /// Raises:
    ///     InputError: Names the argument; nothing is then changed.
    ///
    /// Example:
    ///     >>> import contactsense as cs
    ///     >>> robot = cs.Robot.named("iiwa14")
    ///     >>> monitor = cs.ContactMonitor(robot, dt=1e-3)
    ///     >>> monitor.set_payload("iiwa_link_7", 1.5, [0.0, 0.0, 0.1])
    ///     >>> round(monitor.robot.mass - robot.mass, 6)
    ///     1.5
    ///     >>> monitor.clear_payload()
    ///     >>> monitor.robot.mass == robot.mass
    ///     True
    fn set_payload(
        &self,
        py: Python<'_>,
        link: &Bound<'_, PyAny>,
        mass: &Bound<'_, PyAny>,
        com: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let (name, mass) = (text("link", link)?, number("mass", mass)?);
        let com = Vector::new("com", com)?.fixed::<3>(py, "com")?;
        let robot = self.unloaded.bind(py);
        let index = robot.get().0.link(name).map_err(|error| to_python(py, error))?;
        let loaded = robot.call_method1("with_payload", (name, mass, com))?.cast_into()?.unbind();
        self.sole(py)?.set_payload(index, mass, com).map_err(|error| to_python(py, error))?;
        self.set_robot(loaded);
        Ok(())
    }

    /// Says that the robot carries nothing from the next tick on but what its description or calibration has.
    ///
    /// As `set_payload`. Not for the control loop: it frees memory.
    fn clear_payload(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.clear_payload();
        self.set_robot(self.unloaded.clone_ref(py));
        Ok(())
    }

    /// The payload that recent motion shows and the model lacks.
    ///
    /// It is a force that turns with gravity, at a link at the end of a chain, in the external torque of the last minute or
    /// less. `set_payload(found.link, found.mass, found.com)` takes it where no payload was set before. A constant force
    /// straight down at one point of the link is a payload, whoever exerts it. Not for the control loop: it takes some
    /// milliseconds and allocates.
    ///
    /// Returns:
    ///     A `PayloadProposal`, or None where recent motion shows none: without an external torque, in fewer than three poses,
    ///     of a contact, and on a floating base. `set_payload`, `clear_payload` and `reset` begin anew.
    ///
    /// Example:
    ///     >>> import contactsense as cs, numpy as np
    ///     >>> robot = cs.Robot.named("iiwa14")
    ///     >>> loaded = robot.with_payload("iiwa_link_7", 0.7, [0.0, 0.0, 0.1])
    ///     >>> monitor = cs.ContactMonitor(robot, dt=0.01)
    ///     >>> for angle in np.arange(0.0, 10.0, 0.01)[:, None] + np.arange(7):
    ///     ...     q, v, a = np.sin(angle), np.cos(angle), -np.sin(angle)
    ///     ...     _ = monitor.update(q, v, loaded.inverse_dynamics(q, v, a))
    ///     >>> found = monitor.propose_payload()
    ///     >>> found.link, round(found.mass, 1), found.com.round(2).tolist()[2]
    ///     ('iiwa_link_7', 0.7, 0.1)
    fn propose_payload(&self, py: Python<'_>) -> PyResult<Option<PyPayloadProposal>> {
        let found = self.sole(py)?.propose_payload().map_err(|error| to_python(py, error))?;
        Ok(found.map(PyPayloadProposal))
    }
}
