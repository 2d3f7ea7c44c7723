//! `ContactMonitor` with a payload that is picked up and put down.

use pyo3::prelude::*;

use crate::arguments::{number, text};
use crate::arrays::Vector;
use crate::errors::to_python;
use crate::monitor::PyContactMonitor;

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
}
