//! What one robot measured over time.

use crate::error::{Error, Result};
use crate::robot::Robot;

/// Measurements of one robot over time, row by row: flat arrays of `n` rows each.
///
/// ```
/// use contactsense::calibration::Log;
///
/// let robot = contactsense::robot::Robot::example_arm();
/// let (time, rows) = (vec![0.0, 1e-3], vec![0.0; 14]);
/// let log = Log { time: &time, q: &rows, v: &rows, tau: &rows };
/// assert!(log.check(&robot).is_ok());
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Log<'a> {
    /// `(n,)`, increasing (s).
    pub time: &'a [f64],
    /// `(n, nq)`.
    pub q: &'a [f64],
    /// `(n, nv)`.
    pub v: &'a [f64],
    /// `(n, nv)`, or `(n, nv - 6)` for a floating base (Nm; N for sliding joints).
    pub tau: &'a [f64],
}

impl<'a> Log<'a> {
    /// Whether it has the columns of the robot, finite, over increasing time.
    ///
    /// # Errors
    /// [`Error::Input`] names the column and, where one is at fault, the row.
    pub fn check(&self, robot: &Robot) -> Result<()> {
        let n = self.time.len();
        let actuated = robot.nv() - robot.unactuated();
        let columns = [
            ("q", self.q, robot.nq()),
            ("v", self.v, robot.nv()),
            ("tau", self.tau, if self.has_base_torque(robot) { robot.nv() } else { actuated }),
        ];
        for (name, values, width) in columns {
            if values.len() != n * width {
                let text = format!("must be {n} rows of {width} numbers, not {} numbers", values.len());
                return Err(Error::input(name, text));
            }
        }
        if let Some(row) = self.time.iter().position(|time| !time.is_finite()) {
            return Err(Error::input("time", format!("must be finite [s]; row {row} is not")));
        }
        if let Some(row) = self.time.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(Error::input("time", format!("must increase [s]; row {} does not", row + 1)));
        }
        for row in 0..n {
            let at = |error: Error| match error {
                Error::Input { argument, problem } => {
                    Error::Input { argument, problem: format!("row {row}: {problem}") }
                }
                other => other,
            };
            robot.check_configuration(self.q_of(robot, row)).map_err(at)?;
            robot.check_tangent("v", self.v_of(robot, row)).map_err(at)?;
            robot.check_torque("tau", self.tau_of(row)).map_err(at)?;
        }
        Ok(())
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    fn has_base_torque(&self, robot: &Robot) -> bool {
        self.tau.len() == self.time.len() * robot.nv()
    }

    pub(crate) fn q_of(&self, robot: &Robot, row: usize) -> &'a [f64] {
        &self.q[row * robot.nq()..][..robot.nq()]
    }

    pub(crate) fn v_of(&self, robot: &Robot, row: usize) -> &'a [f64] {
        &self.v[row * robot.nv()..][..robot.nv()]
    }

    pub(crate) fn tau_of(&self, row: usize) -> &'a [f64] {
        let width = self.tau.len() / self.time.len();
        &self.tau[row * width..][..width]
    }
}
