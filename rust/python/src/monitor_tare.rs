//! `ContactMonitor` at the readings of an untouched robot.

use pyo3::prelude::*;

use crate::errors::to_python;
use crate::monitor::PyContactMonitor;

#[pymethods]
impl PyContactMonitor {
    /// Makes zero of what the robot reads now: it is untouched and at rest.
    ///
    /// The offsets of the sensors and the bias become what the last 0.25 s showed, without following it any longer. A sensor
    /// without readings keeps its offset. `sensors` and `bias` are the new ones; `reset()` forgets the bias, not the offsets.
    /// A contact that has been reported ever since the first call or `reset()` may be a bias or an offset, and ends.
    /// Where a tool is not in the model, see `identify_tool`. Not for the control loop: it allocates.
    ///
    /// Raises:
    ///     InputError: The observers do not know the torque yet (5 time constants of the slowest); there is a contact that
    ///         began after a time without; the bias is beyond `bias_limit`. Nothing is then changed.
    ///
    /// Example:
    ///     >>> import contactsense as cs, numpy as np
    ///     >>> robot = cs.Robot.named("iiwa14")
    ///     >>> q, v = np.full(7, 0.4), np.zeros(7)
    ///     >>> tau = robot.inverse_dynamics(q, v, v) + 0.3
    ///     >>> monitor = cs.ContactMonitor(robot, dt=1e-3)
    ///     >>> for _ in range(200):
    ///     ...     report = monitor.update(q, v, tau)
    ///     >>> monitor.tare()
    ///     >>> bool(abs(monitor.update(q, v, tau).external_torque).max() < 1e-3)
    ///     True
    fn tare(&self, py: Python<'_>) -> PyResult<()> {
        self.sole(py)?.tare().map_err(|error| to_python(py, error))
    }
}
