//! Which masses make the mass matrix singular.

use nalgebra::{DMatrix, SymmetricEigen};

use super::inertia::NO_MOMENT;
use super::list;
use crate::error::{Error, Result};
use crate::robot::description::JointKind;
use crate::robot::Robot;

/// The check takes a time that grows with their cube: seconds for so many.
const MOST_VARIABLES: usize = 1000;
const RANK: f64 = 1e-12;
const INDEFINITE_SHARE: f64 = 1e-6;
/// Entries of a null vector below this are rounding errors.
const TAKES_PART: f64 = 1e-3;

/// A warning that names the joints along which the mass matrix is singular whatever the configuration.
///
/// Kinematics, isolation and inverse dynamics stay valid for such a robot; forward dynamics does not.
/// [`Error::Model`] where the mass matrix has a negative eigenvalue or is not finite.
pub(crate) fn check_mass_matrix(robot: &Robot) -> Result<Option<String>> {
    if robot.nv() == 0 {
        return Ok(None);
    }
    if robot.nv() > MOST_VARIABLES {
        return Ok(Some(format!(
            "The mass matrix of more than {MOST_VARIABLES} velocity variables is not checked"
        )));
    }
    let mut idle = vec![true; robot.nv()];
    for turn in 0..3 {
        let matrix = robot.mass_matrix(&configuration(robot, turn))?;
        if !matrix.iter().all(|x| x.is_finite()) {
            return Err(Error::model(
                "the mass matrix is not finite; check the magnitudes of placements, masses and inertias",
            ));
        }
        for (idle, null) in idle.iter_mut().zip(null_coordinates(&matrix)?) {
            *idle &= null;
        }
    }
    let joints = robot.joint_names().iter().enumerate();
    let names: Vec<&str> = joints
        .filter(|(index, _)| idle[robot.velocity_range(index + 1)].contains(&true))
        .map(|(_, name)| name.as_str())
        .collect();
    let text = || {
        format!(
            "No mass or inertia moves with these joints, so the mass matrix is singular and the \
             acceleration of forward dynamics is not to be relied on: {}",
            list(&names)
        )
    };
    Ok((!names.is_empty()).then(text))
}

/// Neutral at turn 0, else joints spread over (-1, 1) [rad or m] by the golden ratio; the base changes nothing.
fn configuration(robot: &Robot, turn: u32) -> Vec<f64> {
    let mut q = vec![];
    let mut seed = 0.5 * f64::from(turn);
    for kind in robot.joint_kinds() {
        seed = (seed + 0.618_033_988_749_895).fract();
        let position = if turn == 0 { 0.0 } else { 2.0 * seed - 1.0 };
        match kind {
            JointKind::FreeFlyer => q.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
            JointKind::Continuous => q.extend([position.cos(), position.sin()]),
            JointKind::Revolute | JointKind::Prismatic => q.push(position),
        }
    }
    q
}

/// Coordinates that take part in a motion without kinetic energy.
fn null_coordinates(matrix: &DMatrix<f64>) -> Result<Vec<bool>> {
    let indefinite =
        || Error::model("the mass matrix has a negative eigenvalue; check the masses and inertias");
    let n = matrix.nrows();
    let diagonal = matrix.diagonal();
    if diagonal.min() < -NO_MOMENT {
        return Err(indefinite());
    }
    let scaled = DMatrix::from_fn(n, n, |row, column| {
        if diagonal[row] <= NO_MOMENT || diagonal[column] <= NO_MOMENT {
            0.0
        } else {
            matrix[(row, column)] / (diagonal[row].sqrt() * diagonal[column].sqrt())
        }
    });
    let found = SymmetricEigen::try_new(scaled, f64::EPSILON, 1000 + 100 * n)
        .ok_or_else(|| Error::model("the mass matrix has no eigenvalues; check the inertias"))?;
    if found.eigenvalues.min() < -INDEFINITE_SHARE {
        return Err(indefinite());
    }
    let null = |row: usize| {
        let mut pairs = found.eigenvalues.iter().zip(found.eigenvectors.column_iter());
        diagonal[row] <= NO_MOMENT
            || pairs.any(|(value, vector)| *value < RANK && vector[row].abs() > TAKES_PART)
    };
    Ok((0..n).map(null).collect())
}
