//! Arguments of `ContactParticleFilter` that take more than a line to read, and what is said of them.

use contactsense::particle::Schedule;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::arguments::{number_if_any, shown, whole};
use crate::arrays::Vector;
use crate::errors::{input, refused};

/// The argument `schedule` that makes this one.
pub fn used_schedule<'py>(py: Python<'py>, schedule: &Schedule) -> PyResult<Bound<'py, PyAny>> {
    let Schedule::Explicit { sharpness, point_noise, force_noise, stiffness_noise, updates } = schedule
    else {
        return Ok("adaptive".into_pyobject(py)?.into_any());
    };
    let dict = PyDict::new(py);
    for (name, [first, last]) in [
        ("sharpness", sharpness),
        ("point_noise", point_noise),
        ("force_noise", force_noise),
        ("stiffness_noise", stiffness_noise),
    ] {
        dict.set_item(name, (*first, *last))?;
    }
    dict.set_item("updates", updates)?;
    Ok(dict.into_any())
}

/// The name of a choice; of another object what Python prints of it, which is no choice either.
pub struct Choice {
    pub given: String,
    text: bool,
}

impl Choice {
    pub fn of(name: &str) -> Self {
        Choice { given: name.into(), text: true }
    }

    /// The value of that name.
    pub fn among<T: Copy>(&self, py: Python<'_>, argument: &str, choices: &[(&str, T)]) -> PyResult<T> {
        match choices.iter().find(|(name, _)| self.text && *name == self.given) {
            Some((_, value)) => Ok(*value),
            None => {
                let names: Vec<String> = choices.iter().map(|(name, _)| format!("'{name}'")).collect();
                let quote = if self.text { "'" } else { "" };
                let given = &self.given;
                Err(input(
                    py,
                    format!("{argument}: must be one of {}, not {quote}{given}{quote}", names.join(", ")),
                ))
            }
        }
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Choice {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        match object.extract::<String>() {
            Ok(name) => Ok(Choice::of(&name)),
            Err(_) => Ok(Choice { given: object.repr()?.to_string(), text: false }),
        }
    }
}

fn unknown(py: Python<'_>, name: &str, given: &str, choices: &str) -> PyErr {
    input(py, format!("{name}: there is no '{given}'; there are {choices}"))
}

/// The argument `schedule`: `None`, a name, or a mapping of pairs.
pub fn read_schedule(py: Python<'_>, object: Option<&Bound<'_, PyAny>>) -> PyResult<Schedule> {
    let Some(object) = object else { return Ok(Schedule::Adaptive) };
    if let Ok(name) = object.extract::<String>() {
        return match name.as_str() {
            "adaptive" => Ok(Schedule::Adaptive),
            "paper" => Ok(Schedule::paper()),
            _ => Err(unknown(py, "schedule", &name, "'adaptive', 'paper', or a mapping")),
        };
    }
    let Ok(given) = object.cast::<PyMapping>() else {
        let given = shown(object);
        return Err(input(
            py,
            format!("schedule: must be None, 'adaptive', 'paper' or a mapping, not {given}"),
        ));
    };
    let mut schedule = Schedule::paper();
    let Schedule::Explicit { sharpness, point_noise, force_noise, stiffness_noise, updates } = &mut schedule
    else {
        return Ok(schedule);
    };
    let refuse = |cause| refused(py, cause, || format!("schedule: cannot be read: {}", shown(object)));
    for item in given.items().map_err(refuse)? {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let key: String = key.str()?.extract()?;
        let pair = match key.as_str() {
            "sharpness" => &mut *sharpness,
            "point_noise" => &mut *point_noise,
            "force_noise" => &mut *force_noise,
            "stiffness_noise" => &mut *stiffness_noise,
            "updates" => {
                *updates = whole("schedule: updates", &value, 1_000_000_000)? as usize;
                continue;
            }
            _ => {
                let choices = "'sharpness', 'point_noise', 'force_noise', 'stiffness_noise', 'updates'";
                return Err(unknown(py, "schedule", &key, choices));
            }
        };
        let name = format!("schedule: {key}");
        *pair = match number_if_any(&value)? {
            Some(both) => [both, both],
            None => Vector::new(&name, &value)?.fixed::<2>(py, &name)?,
        };
    }
    Ok(schedule)
}
