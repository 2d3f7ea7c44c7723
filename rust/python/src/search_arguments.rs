//! Arguments that `ContactParticleFilter` and `StaticObstacleSampler` have in common.

use contactsense::particle::{FilterOptions, ForceModel};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::whole;
use crate::arrays::{scalar_or_vector, Vector};
use crate::calibration::noise_of;
use crate::errors::{input, to_python};
use crate::filter_options::Choice;
use crate::noise::{values, PyNoiseModel};
use crate::robot::PyRobot;
use crate::sensor::names;

/// Default of the friction cone's coefficient.
const FRICTION: f64 = 0.5;

/// As given; none for the default.
pub struct SearchArguments<'a, 'py> {
    pub particles: Option<&'a Bound<'py, PyAny>>,
    pub measurement: &'a Choice,
    pub friction: Option<f64>,
    pub links: Option<&'a Bound<'py, PyAny>>,
    pub seed: Option<&'a Bound<'py, PyAny>>,
    pub force_range: Option<&'a Bound<'py, PyAny>>,
    pub stiffness_range: Option<&'a Bound<'py, PyAny>>,
    pub radius_range: Option<&'a Bound<'py, PyAny>>,
    pub threads: Option<&'a Bound<'py, PyAny>>,
    pub torque_noise: Option<&'a Bound<'py, PyAny>>,
    pub relative_noise: Option<f64>,
    pub torque_threshold: Option<&'a Bound<'py, PyAny>>,
    pub noise: Option<&'a Bound<'py, PyAny>>,
    pub calibration: Option<&'a Bound<'py, PyAny>>,
}

impl<'py> SearchArguments<'_, 'py> {
    fn friction(&self) -> f64 {
        self.friction.unwrap_or(FRICTION)
    }

    /// What they say, the rest by default.
    pub fn options(&self, robot: &Bound<'py, PyRobot>) -> PyResult<FilterOptions> {
        let py = robot.py();
        let cone = ForceModel::FrictionCone(self.friction());
        cone.check().map_err(|error| to_python(py, error))?;
        let mut options = FilterOptions {
            force_model: self.measurement.among(
                py,
                "measurement",
                &[("normal", ForceModel::Normal), ("friction_cone", cone)],
            )?,
            links: self.links.map(|links| names("links", "links", links)).transpose()?,
            ..FilterOptions::default()
        };
        if let Some(particles) = self.particles {
            options.particles = whole("particles", particles, 10_000_000)? as usize;
        }
        if let Some(seed) = self.seed {
            options.seed = whole("seed", seed, u64::MAX)?;
        }
        if let Some(threads) = self.threads {
            options.threads = whole("threads", threads, 256)? as usize;
        }
        for (name, object, range) in [
            ("force_range", self.force_range, &mut options.force_range),
            ("stiffness_range", self.stiffness_range, &mut options.stiffness_range),
            ("radius_range", self.radius_range, &mut options.radius_range),
        ] {
            if let Some(object) = object {
                *range = Vector::new(name, object)?.fixed::<2>(py, name)?;
            }
        }
        if (self.noise.is_some() || self.calibration.is_some())
            && (self.torque_noise.is_some() || self.relative_noise.is_some())
        {
            return Err(input(
                py,
                "noise: give it (or calibration) or torque_noise and relative_noise, not both".into(),
            ));
        }
        options.noise = noise_of(robot, self.noise, self.calibration)?;
        if let Some(noise) = self.torque_noise {
            options.torque_noise = scalar_or_vector("torque_noise", noise)?;
        }
        if let Some(noise) = self.relative_noise {
            options.relative_noise = noise;
        }
        if let Some(threshold) = self.torque_threshold {
            options.torque_threshold = Some(scalar_or_vector("torque_threshold", threshold)?);
        }
        Ok(options)
    }

    /// Keyword arguments that say the same as these and the options read from them.
    pub fn used(&self, py: Python<'py>, options: &FilterOptions) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("particles", options.particles)?;
        dict.set_item("measurement", &self.measurement.given)?;
        dict.set_item("friction", self.friction())?;
        dict.set_item("links", options.links.clone())?;
        dict.set_item("seed", options.seed)?;
        for (name, [least, greatest]) in [
            ("force_range", options.force_range),
            ("stiffness_range", options.stiffness_range),
            ("radius_range", options.radius_range),
        ] {
            dict.set_item(name, (least, greatest))?;
        }
        dict.set_item("threads", options.threads)?;
        if let Some(noise) = &options.noise {
            dict.set_item("noise", Bound::new(py, PyNoiseModel(noise.clone()))?)?;
        } else {
            dict.set_item("torque_noise", values(py, &options.torque_noise)?)?;
            dict.set_item("relative_noise", options.relative_noise)?;
        }
        let threshold = options.stated_threshold().map(|threshold| values(py, &threshold)).transpose()?;
        dict.set_item("torque_threshold", threshold)?;
        Ok(dict)
    }
}
