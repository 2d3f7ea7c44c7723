//! `ContactIsolator`.

use std::sync::{Arc, Mutex};

use contactsense::isolation::{ContactIsolator, IsolatorOptions};
use contactsense::sensor::ForceTorqueSensor;
use nalgebra::Vector6;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::{pushing, sole, whole, Number};
use crate::arrays::{scalar_or_vector, Readings, Vector};
use crate::calibration::noise_of;
use crate::errors::to_python;
use crate::isolation::PyIsolation;
use crate::names::Names;
use crate::returned::{numbers, wrench_rows};
use crate::robot::PyRobot;
use crate::robot_argument::robot;
use crate::sensor::{sensor_names, sensor_tuple, sensors, wrench_thresholds};

/// Contacts reported at most: an argument, or the default.
pub fn contact_count(object: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
    let count = object.map_or(Ok(5), |object| whole("max_contacts", object, 1000))?;
    Ok(count as usize)
}

/// Finds the contacts that explain an external torque and the wrenches that sensors see: links, points and forces.
///
/// One contact by Vorndamme 2017, eqs. 22-26; several with sensors by eq. 27, without by eqs. 28-31. Where torques leave
/// parts of two wrenches open, it is used that a contact's force has no moment, acts on the surface and pushes; several
/// solutions are candidates. One thread at a time may use it.
///
/// Args:
///     robot: The robot.
///     sensors: Of `ForceTorqueSensor`, in the order of the wrenches.
///     torque_threshold: Scalar or `(nv,)` [Nm; N for sliding joints]. A joint feels a contact above it, and a third of
///         it is the standard deviation of a torque. With `noise` the default is three standard deviations at rest.
///     wrench_threshold: On external wrenches: scalar, `(6,)` or `(n_sensors, 6)` [N, Nm].
///     wanted_contacts: Names of sensors whose contacts are meant and not reported (eq. 20).
///     max_contacts: Contacts reported at most.
///     pushing: Whether forces push on the surface. If False the point cannot be determined: `located` is False.
///     noise: A `NoiseModel` of the torques, in place of what the thresholds say.
///     locate_within: A contact is located if 90 % of the places that explain the torques are within this distance of
///         its point [m].
///     calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.
///     samples: Samples of the surface from which the posterior of a single contact is worked out, as `ContactMap` does, where the
///         standard deviation of a torque is 3 mNm or more; 0 for closed forms only. Wrenches of
///         sensors count as the torques do. Not with `pushing=False`.
///     pull_probability: Probability that a contact pulls on the surface, for this posterior.
///
/// Raises:
///     InputError: Names the argument.
///
/// Example:
///     >>> import contactsense as cs, numpy as np
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> q = np.full(7, 0.4)
///     >>> link = robot.link_names[-1]
///     >>> sample = robot.surface(link).sample(1, seed=2)
///     >>> pose = robot.link_pose(q, link)
///     >>> point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
///     >>> force = -20.0 * pose[:3, :3] @ sample.normals[0]
///     >>> tau_ext = robot.jacobian(q, link, point)[:3].T @ force
///     >>> contact = cs.ContactIsolator(robot).isolate(q, tau_ext).contacts[0]
///     >>> bool(np.allclose(contact.point, point, atol=1e-6)), bool(np.allclose(contact.force, force, atol=1e-6))
///     (True, True)
#[pyclass(frozen, name = "ContactIsolator", module = "contactsense")]
pub struct PyContactIsolator {
    robot: Py<PyRobot>,
    names: Arc<Names>,
    sensors: Vec<ForceTorqueSensor>,
    /// `(nv,)`.
    torque_threshold: Vec<f64>,
    /// One a sensor.
    wrench_threshold: Vec<Option<Vector6<f64>>>,
    state: Mutex<State>,
}

struct State {
    isolator: ContactIsolator,
    wrenches: Vec<Option<Vector6<f64>>>,
}

#[pymethods]
impl PyContactIsolator {
    #[new]
    #[pyo3(signature = (robot, *, sensors=None, torque_threshold=None, wrench_threshold=None, wanted_contacts=None,
                        max_contacts=None, pushing=true, noise=None, locate_within=None, calibration=None,
                        samples=None, pull_probability=None),
           text_signature = "(robot, *, sensors=(), torque_threshold=1e-3, wrench_threshold=1e-3, wanted_contacts=(), \
                             max_contacts=5, pushing=True, noise=None, locate_within=0.05, calibration=None, samples=1000, \
                             pull_probability=0.05)")]
    #[allow(clippy::too_many_arguments)] // the keywords of the Python class
    fn new(
        #[pyo3(from_py_with = robot)] robot: Bound<'_, PyRobot>,
        sensors: Option<&Bound<'_, PyAny>>,
        torque_threshold: Option<&Bound<'_, PyAny>>,
        wrench_threshold: Option<&Bound<'_, PyAny>>,
        wanted_contacts: Option<&Bound<'_, PyAny>>,
        max_contacts: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = pushing)] pushing: bool,
        noise: Option<&Bound<'_, PyAny>>,
        locate_within: Option<Number<'_, '_>>,
        calibration: Option<&Bound<'_, PyAny>>,
        samples: Option<&Bound<'_, PyAny>>,
        pull_probability: Option<Number<'_, '_>>,
    ) -> PyResult<Self> {
        let mut options =
            IsolatorOptions { max_contacts: contact_count(max_contacts)?, pushing, ..Default::default() };
        if let Some(distance) = locate_within {
            options.locate_within = distance.named("locate_within")?;
        }
        if let Some(samples) = samples {
            options.samples = whole("samples", samples, 1_000_000)? as usize;
        }
        if let Some(probability) = pull_probability {
            options.pull_probability = probability.named("pull_probability")?;
        }
        if let Some(sensors) = sensors {
            options.sensors = self::sensors(sensors)?;
        }
        if let Some(noise) = noise_of(&robot, noise, calibration)? {
            // The thresholds follow from it, too.
            (options.noise, options.torque_threshold) = (Some(noise), None);
        }
        if let Some(threshold) = torque_threshold {
            options.torque_threshold = Some(scalar_or_vector("torque_threshold", threshold)?);
        }
        if let Some(threshold) = wrench_threshold {
            options.wrench_threshold = wrench_thresholds(threshold)?;
        }
        if let Some(wanted) = wanted_contacts {
            options.wanted_contacts = sensor_names(wanted)?;
        }
        let isolator = ContactIsolator::new(robot.get().0.clone(), &options);
        let isolator = isolator.map_err(|error| to_python(robot.py(), error))?;
        Ok(Self {
            names: Names::new(&robot.get().0, isolator.sensor_names()),
            robot: robot.unbind(),
            sensors: options.sensors,
            torque_threshold: isolator.torque_threshold().to_vec(),
            wrench_threshold: isolator.wrench_threshold().iter().copied().map(Some).collect(),
            state: Mutex::new(State { isolator, wrenches: vec![] }),
        })
    }

    /// Finds the contacts that explain an external torque.
    ///
    /// Args:
    ///     q: Configuration, `(nq,)`.
    ///     tau_ext: External torque, `(nv,)` [Nm; N for sliding joints and a base's linear part].
    ///     wrenches: The external wrench that each sensor sees, `(n_sensors, 6)` [N, Nm], as `LoadCompensator` gives it:
    ///         (force, moment) at the sensor's origin, world axes. A NaN in a row leaves its sensor out. Needed where
    ///         there are sensors.
    ///
    /// Returns:
    ///     The contacts of this instant.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    #[pyo3(signature = (q, tau_ext, wrenches=None))]
    fn isolate(
        &self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        tau_ext: &Bound<'_, PyAny>,
        wrenches: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyIsolation> {
        let (q, tau_ext) = (Vector::new("q", q)?, Vector::new("tau_ext", tau_ext)?);
        let given = wrenches.map(Readings::new).transpose()?;
        let given = given.as_ref().map_or(&[][..], |given| given.rows());
        let mut state = sole(py, "ContactIsolator", &self.state)?;
        let State { isolator, wrenches } = &mut *state;
        wrenches.clear();
        wrenches.extend(given.iter().map(|row| row.map(Vector6::from)));
        let isolation = isolator.isolate_sensed(q.slice(), tau_ext.slice(), wrenches);
        let isolation = isolation.map_err(|error| to_python(py, error))?.clone();
        Ok(PyIsolation::new(self.names.clone(), isolation))
    }

    /// The robot.
    #[getter]
    fn robot(&self, py: Python<'_>) -> Py<PyRobot> {
        self.robot.clone_ref(py)
    }

    /// The sensors, of `ForceTorqueSensor`, in the order of the wrenches.
    #[getter]
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        sensor_tuple(py, &self.sensors)
    }

    /// Thresholds on the torques, `(nv,)` [Nm; N for sliding joints]; a read-only copy.
    #[getter]
    fn torque_threshold<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        numbers(py, &self.torque_threshold)
    }

    /// Thresholds on the external wrenches, `(n_sensors, 6)` [N, Nm]; a read-only copy.
    #[getter]
    fn wrench_threshold<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        wrench_rows(py, &self.wrench_threshold)
    }

    fn __repr__(&self) -> String {
        let (robot, sensors) = (self.robot.get().0.name(), self.sensors.len());
        format!("ContactIsolator('{robot}', {sensors} sensors)")
    }
}
