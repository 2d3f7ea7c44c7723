//! The rows of a log as sums of squares, from which every hypothesis is judged without a look at the rows.

use nalgebra::{DMatrix, DVector};

use super::columns::{delayed, gravity_columns};
use super::motion::Motion;
use super::slow_rows::slow_rows;
use super::target::Target;
use super::terms::{Parts, OWN, TERMS};
use crate::calibration::rows::{rows, Filter, Row, Term};
use crate::calibration::Log;
use crate::robot::{Robot, PARAMETERS};

/// Of the low-pass (1/s): slow enough that noise of velocities does not matter, fast enough for the motion of arms.
pub(super) const GAIN: f64 = 8.0;

/// Between rows that are kept (s): a few for each time constant of the low-pass.
const SPACING: f64 = 0.025;

/// Numbers that the rows may take in all; long logs of large robots keep fewer rows.
const LARGEST: usize = 30_000_000;

/// Time over which errors of a model stay alike (s): so long a stretch counts as one independent row.
const CORRELATION_TIME: f64 = 0.4;

/// Rows without time are counted as at most so many independent ones.
const MOST_POSES: f64 = 80.0;

/// Poses of which no joint's differs by as much (rad; m) say the same.
const SAME_POSE: f64 = 0.05;

/// Sums of products over the rows of one joint.
#[derive(Debug, Clone)]
pub(super) struct Sums {
    /// Of unknowns with unknowns; the joint's own terms and gravity's axes come after the inertial ones.
    pub unknowns: DMatrix<f64>,
    /// Of unknowns with parts.
    pub cross: DMatrix<f64>,
    /// Of parts with parts.
    pub parts: DMatrix<f64>,
}

/// All that hypotheses are judged by.
#[derive(Debug, Clone)]
pub(super) struct Evidence {
    pub nv: usize,
    /// Number of inertial unknowns.
    pub inertial: usize,
    pub sums: Vec<Sums>,
    /// Rows counted.
    pub rows: f64,
    /// Independent rows.
    pub effective: f64,
    /// Smallest error that is taken seriously (Nm).
    pub floor: Vec<f64>,
    pub parts: Parts,
    /// Whether accelerations are known.
    pub moving: bool,
    /// Row by row and joint by joint: unknowns, then parts.
    columns: Vec<DMatrix<f64>>,
    /// Of the log's rows.
    pub indices: Vec<usize>,
    kept: Vec<bool>,
}

impl Evidence {
    pub fn new(robot: &Robot, motion: &Motion) -> Evidence {
        let nv = robot.nv();
        let parts = Parts { nv };
        let inertial = PARAMETERS * (robot.body_count() - 1);
        let width = inertial + OWN.len() + 3 + parts.len();
        let most = (LARGEST / (width * nv)).max(50);
        let moving = motion.consecutive;
        let spacing = SPACING.max(motion.duration() / most as f64);
        let filter = Filter { gain: GAIN, spacing, longest_step: (10.0 * motion.step()).max(0.1) };
        let log = Log { time: &motion.time, q: &motion.q, v: &motion.v, tau: &motion.tau };
        let found = if moving { rows(robot, &log, &filter, &TERMS) } else { slow_rows(robot, motion, most) };
        let delayed: Vec<DMatrix<f64>> = if moving { delayed(motion, &filter, &found) } else { vec![] };
        let gravity = gravity_columns(robot, motion, moving.then_some(&filter), &found);
        let mut columns = vec![DMatrix::zeros(found.len(), width); nv];
        for (at, row) in found.iter().enumerate() {
            let place = |term: Term| TERMS.iter().position(|other| *other == term).unwrap_or(0);
            let torque = place(Term::Torque);
            for (k, matrix) in columns.iter_mut().enumerate() {
                let mut out = matrix.row_mut(at);
                for column in 0..inertial {
                    out[column] = row.inertial[(k, column)];
                }
                for (column, term) in OWN.iter().enumerate() {
                    out[inertial + column] = row.terms[(k, place(*term))];
                }
                let first = inertial + OWN.len();
                let parts_from = first + 3;
                for axis in 0..3 {
                    out[first + axis] = gravity[at][(k, axis)];
                    out[parts_from + parts.gravity(axis)] = gravity[at][(k, axis)];
                }
                for joint in 0..nv {
                    out[parts_from + parts.torque(joint)] = row.terms[(joint, torque)];
                }
                out[parts_from + parts.model()] = row.terms[(k, torque)] - row.unexplained[k];
                for (index, values) in delayed.iter().enumerate() {
                    out[parts_from + parts.delayed(index)] = values[(at, k)];
                }
            }
        }
        let poses = distinct_poses(motion, &found) as f64;
        let effective =
            if moving { (motion.duration() / CORRELATION_TIME).min(poses) } else { poses.min(MOST_POSES) };
        let mut evidence = Evidence {
            nv,
            inertial,
            sums: vec![],
            rows: 0.0,
            effective: effective.max(1.0),
            floor: vec![0.0; nv],
            parts,
            moving,
            kept: vec![true; found.len()],
            columns,
            indices: found.iter().map(|row| row.index).collect(),
        };
        evidence.sum_up();
        evidence.floor = (0..nv).map(|k| evidence.smallest_error(motion, k)).collect();
        evidence
    }

    /// Number of unknowns of all joints: inertial, own terms joint by joint, gravity.
    pub fn unknowns(&self) -> usize {
        self.inertial + OWN.len() * self.nv + 3
    }

    /// The place of a joint's own term among all unknowns.
    pub fn own(&self, joint: usize, term: Term) -> usize {
        let place = OWN.iter().position(|other| *other == term).unwrap_or(0);
        self.inertial + OWN.len() * joint + place
    }

    /// The place of a column of `Sums::unknowns` of a joint among all unknowns.
    pub fn global(&self, joint: usize, column: usize) -> usize {
        match column.checked_sub(self.inertial) {
            None => column,
            Some(own) if own < OWN.len() => self.inertial + OWN.len() * joint + own,
            Some(axis) => self.inertial + OWN.len() * self.nv + axis - OWN.len(),
        }
    }

    /// Mean square of a part of a joint.
    pub fn square(&self, joint: usize, part: usize) -> f64 {
        self.sums[joint].parts[(part, part)] / self.rows
    }

    /// What a solution leaves of a target, row by row, `(rows, nv)`.
    pub fn left_over(&self, target: &Target, x: &DVector<f64>) -> DMatrix<f64> {
        let mut left = DMatrix::zeros(self.indices.len(), self.nv);
        let own = self.inertial + OWN.len() + 3;
        for (k, matrix) in self.columns.iter().enumerate() {
            let mut weights = DVector::zeros(matrix.ncols());
            for column in 0..own {
                weights[column] = -x[self.global(k, column)];
            }
            weights.rows_mut(own, self.parts.len()).copy_from(&target.coefficients[k]);
            left.set_column(k, &(matrix * weights));
        }
        left
    }

    /// The measured torque less the model's in every row.
    pub fn unexplained(&self, joint: usize) -> Vec<f64> {
        let from = self.inertial + OWN.len() + 3;
        let columns = &self.columns[joint];
        let torque = columns.column(from + self.parts.torque(joint));
        (torque - columns.column(from + self.parts.model())).iter().copied().collect()
    }

    /// Which rows are counted.
    pub fn kept(&self) -> &[bool] {
        &self.kept
    }

    /// Leaves rows out, and sums up anew.
    pub fn keep(&mut self, kept: Vec<bool>) {
        self.kept = kept;
        self.sum_up();
    }

    fn sum_up(&mut self) {
        let own = self.inertial + OWN.len() + 3;
        let places: Vec<usize> = (0..self.kept.len()).filter(|row| self.kept[*row]).collect();
        self.rows = (places.len() as f64).max(1.0);
        let one = |matrix: &DMatrix<f64>| {
            let matrix = matrix.select_rows(&places);
            let all = matrix.tr_mul(&matrix);
            let parts = self.parts.len();
            Sums {
                unknowns: all.view((0, 0), (own, own)).into_owned(),
                cross: all.view((0, own), (own, parts)).into_owned(),
                parts: all.view((own, own), (parts, parts)).into_owned(),
            }
        };
        self.sums = self.columns.iter().map(one).collect();
    }

    /// Noise of the torque that the low-pass lets through, and a share of the torque that no model of an arm reaches.
    fn smallest_error(&self, motion: &Motion, joint: usize) -> f64 {
        const SHARE: f64 = 0.003;
        const LEAST: f64 = 1e-3;
        let nv = motion.nv;
        let differences: Vec<f64> = (2..motion.len())
            .map(|row| {
                let at = |row: usize| motion.tau[row * nv + joint];
                (at(row) - 2.0 * at(row - 1) + at(row - 2)).abs()
            })
            .collect();
        // Of the second difference of white noise: sqrt(6), and 0.67 of it the median of its size.
        let noise = super::motion::median(differences) / (0.67 * 6.0_f64.sqrt());
        let passed = if self.moving { (0.5 * GAIN * motion.step()).min(1.0).sqrt() } else { 1.0 };
        let noise = if noise.is_finite() { noise } else { 0.0 };
        (noise * passed).hypot(SHARE * self.square(joint, self.parts.torque(joint)).sqrt()).max(LEAST)
    }
}

/// How many poses the rows have.
fn distinct_poses(motion: &Motion, found: &[Row]) -> usize {
    let nv = motion.nv;
    let pose = |row: &Row| -> Vec<i64> {
        motion.angle[row.index * nv..][..nv].iter().map(|angle| (angle / SAME_POSE).round() as i64).collect()
    };
    found.iter().map(pose).collect::<std::collections::HashSet<_>>().len()
}
