//! Mass and first moment of a payload, from means of the external torque that also hold biases and contacts.

use nalgebra::{DMatrix, DVector, Matrix4, SMatrix, Vector3, Vector4};

use super::recent_motion::Block;
use crate::error::Result;
use crate::robot::{LinkIndex, Robot};

/// Mass and first moment.
const UNKNOWNS: usize = 4;
/// What arms carry, of their own mass, and how far from the link, of their mass too: one standard deviation of each
/// (kg, m).
const LOAD: f64 = 0.15;
const LEVER: f64 = 0.15;
/// A contact counts less the farther it is beyond so many variances (mean over the joints).
const OUTLYING: f64 = 9.0;
/// The weights have settled after so many rounds.
const ROUNDS: usize = 20;
/// First moments are found by loads at this distance (m); what they cause is linear in it.
const DISTANCE: f64 = 0.1;

/// Variances of the errors of a mean, by velocity variable.
#[derive(Debug, Clone)]
pub(super) struct Spread {
    /// From mean to mean (Nm squared).
    pub error: Vec<f64>,
    /// Of what stays (Nm squared).
    pub bias: Vec<f64>,
    /// Means that are alike count as one.
    pub alike: f64,
}

/// What is found.
#[derive(Debug, Clone)]
pub(super) struct PayloadFit {
    /// Mass (kg) and first moment in the link's frame (kg m).
    pub load: Vector4<f64>,
    pub covariance: Matrix4<f64>,
    /// What is left of each block, in variances (mean over the joints).
    pub left: Vec<f64>,
}

/// By block: external torques of 1 kg at the link's origin, and of first moments of 1 kg m, `(nv, 4)`.
pub(super) fn columns(robot: &Robot, link: LinkIndex, blocks: &[Block<'_>]) -> Result<Vec<DMatrix<f64>>> {
    let loaded = |at: Vector3<f64>| robot.with_payload(link, 1.0, at, nalgebra::Matrix3::zeros());
    let origin = loaded(Vector3::zeros())?;
    let mut beside = vec![];
    for axis in 0..3 {
        let mut at = Vector3::zeros();
        at[axis] = DISTANCE;
        // Of the difference of both, moments of inertia are no part.
        beside.push([loaded(at)?, loaded(-at)?]);
    }
    let column = |block: &Block<'_>| -> Result<DMatrix<f64>> {
        let Block { q, v, a, .. } = *block;
        let torque = |robot: &Robot| robot.inverse_dynamics(q, v, a).map(DVector::from_vec);
        let mut columns = DMatrix::zeros(robot.nv(), UNKNOWNS);
        // A weight pulls, the motors' torque holds it.
        columns.set_column(0, &(torque(robot)? - torque(&origin)?));
        for (axis, [one, other]) in beside.iter().enumerate() {
            columns.set_column(1 + axis, &((torque(other)? - torque(one)?) / (2.0 * DISTANCE)));
        }
        Ok(columns)
    };
    blocks.iter().map(column).collect()
}

/// The likeliest payload and biases, contacts being rare; without `columns`, the biases alone.
pub(super) fn fit(
    blocks: &[Block<'_>],
    columns: Option<&[DMatrix<f64>]>,
    robot_mass: f64,
    spread: &Spread,
) -> Option<PayloadFit> {
    let nv = spread.error.len();
    let width = UNKNOWNS + nv;
    let row = |at: usize, joint: usize, row: &mut DVector<f64>| {
        row.fill(0.0);
        if let Some(columns) = columns {
            (0..UNKNOWNS).for_each(|k| row[k] = columns[at][(joint, k)]);
        }
        row[UNKNOWNS + joint] = 1.0;
    };
    let mass = LOAD * robot_mass;
    let mut prior = DVector::zeros(width);
    prior[0] = mass.powi(-2);
    (1..UNKNOWNS).for_each(|k| prior[k] = (mass * LEVER).powi(-2));
    (0..nv).for_each(|joint| prior[UNKNOWNS + joint] = 1.0 / spread.bias[joint]);
    let mut weights = vec![1.0; blocks.len()];
    let mut left = vec![0.0; blocks.len()];
    let (mut solution, mut covariance) = (DVector::zeros(width), DMatrix::zeros(width, width));
    let mut entries = DVector::zeros(width);
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = (DMatrix::from_diagonal(&prior), DVector::zeros(width));
        for (at, block) in blocks.iter().enumerate() {
            for (joint, error) in spread.error.iter().enumerate() {
                row(at, joint, &mut entries);
                let weight = weights[at] / (error * spread.alike);
                normal.ger(weight, &entries, &entries, 1.0);
                right.axpy(weight * block.torque[joint], &entries, 1.0);
            }
        }
        let factor = normal.cholesky()?;
        (solution, covariance) = (factor.solve(&right), factor.inverse());
        for (at, block) in blocks.iter().enumerate() {
            let square = |joint: usize| {
                row(at, joint, &mut entries);
                (block.torque[joint] - entries.dot(&solution)).powi(2) / spread.error[joint]
            };
            left[at] = (0..nv).map(square).sum::<f64>() / nv as f64;
            weights[at] = 1.0 / (1.0 + left[at] / OUTLYING);
        }
    }
    let load = solution.fixed_rows::<UNKNOWNS>(0).into_owned();
    let covariance: SMatrix<f64, UNKNOWNS, UNKNOWNS> =
        covariance.fixed_view::<UNKNOWNS, UNKNOWNS>(0, 0).into_owned();
    Some(PayloadFit { load, covariance, left })
}
