//! `ContactMonitor` with a vendor's external torque.

use contactsense::ExternalSample;
use pyo3::prelude::*;

use crate::arguments::Number;
use crate::arrays::{Readings, Vector};
use crate::errors::to_python;
use crate::monitor::PyContactMonitor;
use crate::report::PyContactReport;

#[pymethods]
impl PyContactMonitor {
    /// Takes in one tick with an external torque that the robot's controller estimates, as those of Franka, KUKA and Doosan do.
    ///
    /// It takes the place of the observer's: masses and friction of the model do not matter, and `observer_gain` filters
    /// nothing. With a `calibration` of such torques (`torque_is_external`) all joints are tested at once. A monitor takes
    /// torques of one source: `update` after `update_external`, or the other way round, is refused until `reset()`.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     tau_ext: External torque of forces on the robot, `(nv,)` [Nm; N for sliding joints].
    ///     wrenches: The sensors' readings, as in `update`.
    ///     v: Velocity, `(nv,)` [rad/s; m/s for sliding joints]; None: not known, and taken to be slow. It says where friction is
    ///         uncertain, and what inertia does to the sensors.
    ///     dt: Time since the last accepted sample [s], as in `update`; the torque after a gap is known at once.
    ///
    /// Returns:
    ///     What the monitor says of this tick: `external_torque` is `tau_ext` less its bias, `acceleration` NaN.
    ///
    /// Raises:
    ///     InputError: Names the argument; the state is then unchanged but for the time that passed.
    #[pyo3(signature = (q, tau_ext, wrenches=None, *, v=None, dt=None))]
    fn update_external(
        &self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        tau_ext: &Bound<'_, PyAny>,
        wrenches: Option<&Bound<'_, PyAny>>,
        v: Option<&Bound<'_, PyAny>>,
        dt: Option<Number<'_, '_>>,
    ) -> PyResult<PyContactReport> {
        let step = dt.and_then(|dt| (!dt.0.is_nan()).then_some(dt.0));
        let converted = (|| {
            let dt = dt.map(|dt| dt.named("dt")).transpose()?;
            let (q, tau_ext) = (Vector::new("q", q)?, Vector::new("tau_ext", tau_ext)?);
            let v = Vector::optional("v", v)?;
            Ok((q, tau_ext, v, wrenches.map(Readings::new).transpose()?, dt))
        })();
        // An array that cannot be read is a sample refused, too.
        let (q, tau_ext, v, wrenches, dt) = match converted {
            Ok(converted) => converted,
            Err(error) => {
                let error: PyErr = error;
                self.sole(py)?.miss(step);
                return Err(error);
            }
        };
        let mut sample = ExternalSample::new(q.slice(), tau_ext.slice());
        if let Some(v) = &v {
            sample = sample.velocity(v.slice());
        }
        if let Some(wrenches) = &wrenches {
            sample = sample.wrenches(wrenches.rows());
        }
        if let Some(dt) = dt {
            sample = sample.dt(dt);
        }
        let mut monitor = self.sole(py)?;
        let report = monitor.update_external(&sample).map_err(|error| to_python(py, error))?.clone();
        let acceleration = monitor.acceleration().to_vec();
        Ok(PyContactReport::new(self.names.clone(), report, acceleration))
    }
}
