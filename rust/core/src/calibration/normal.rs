//! Normal equations of a set of rows.

use nalgebra::{DMatrix, DVector};

use super::friction::REVERSALS;
use super::hysteresis::WIDTHS;
use super::rows::{Row, Term};
use super::unknowns::{Unknowns, ARMATURE, BIAS, COULOMB, HYSTERESIS, TERMS, VISCOUS};

const FIRST_FRICTION: usize = 1;
const AFTER_FRICTION: usize = FIRST_FRICTION + REVERSALS.len();
const TORQUE: usize = AFTER_FRICTION + 3;
const FIRST_HYSTERESIS: usize = TORQUE + 1;

/// The terms of each row: bias, Coulomb friction of each reversal, viscous friction, rotor inertia, rate of the torque, the
/// torque, hysteresis of each width.
pub(super) fn terms() -> Vec<Term> {
    let mut terms = vec![Term::Bias];
    terms.extend(REVERSALS.map(Term::Coulomb));
    terms.extend([Term::Viscous, Term::Armature, Term::TorqueRate, Term::Torque]);
    terms.extend(WIDTHS.map(Term::Hysteresis));
    terms
}

/// The shape of one joint's own terms: indices of [`REVERSALS`], and of [`WIDTHS`] where it has hysteresis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    pub friction: usize,
    pub hysteresis: Option<usize>,
}

/// How joints count: the weight of each (one over Nm squared), and the shape of its terms.
#[derive(Debug, Clone)]
pub(super) struct Joints {
    pub weights: Vec<f64>,
    pub shapes: Vec<Shape>,
}

/// `H x = g`, the least squares of the rows' unexplained torque by the columns of the regression.
#[derive(Debug, Clone)]
pub(super) struct Normal {
    pub h: DMatrix<f64>,
    pub g: DVector<f64>,
}

impl Normal {
    /// Of some rows.
    pub fn of<'a>(unknowns: &Unknowns, joints: &Joints, rows: impl Iterator<Item = &'a Row>) -> Self {
        let size = unknowns.columns();
        let mut normal = Normal { h: DMatrix::zeros(size, size), g: DVector::zeros(size) };
        let mut entries = vec![];
        for row in rows {
            for (joint, weight) in joints.weights.iter().enumerate() {
                entries.clear();
                columns(unknowns, joints, row, joint, &mut entries);
                for (k, &(column, value)) in entries.iter().enumerate() {
                    let weighted = weight * value;
                    normal.g[column] += weighted * row.unexplained[joint];
                    for &(other, with) in &entries[..=k] {
                        normal.h[(column, other)] += weighted * with;
                    }
                }
            }
        }
        normal.h.fill_upper_triangle_with_lower_triangle();
        normal
    }

    /// Adds the rows of another set.
    pub fn add(&mut self, other: &Normal) {
        self.h += &other.h;
        self.g += &other.g;
    }
}

/// What a correction leaves of a row's unexplained torque, on one joint (Nm).
pub(super) fn residual(
    unknowns: &Unknowns,
    joints: &Joints,
    row: &Row,
    joint: usize,
    correction: &DVector<f64>,
) -> f64 {
    let mut entries = Vec::with_capacity(unknowns.columns());
    columns(unknowns, joints, row, joint, &mut entries);
    row.unexplained[joint] - entries.iter().map(|&(column, value)| value * correction[column]).sum::<f64>()
}

/// A joint's own terms in a row, with a choice of their shape.
pub(super) fn own_terms(row: &Row, joint: usize, shape: Shape) -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    terms[BIAS] = row.terms[(joint, 0)];
    terms[COULOMB] = row.terms[(joint, FIRST_FRICTION + shape.friction)];
    terms[VISCOUS] = row.terms[(joint, AFTER_FRICTION)];
    terms[ARMATURE] = row.terms[(joint, AFTER_FRICTION + 1)];
    terms[HYSTERESIS] = shape.hysteresis.map_or(0.0, |width| kept_back(row, joint, width));
    terms
}

/// A row whose torques are external ones: no model, no rotor, no delay and no gear is between them and zero.
pub(super) fn of_external(mut row: Row) -> Row {
    for joint in 0..row.unexplained.len() {
        row.unexplained[joint] = torque(&row, joint);
    }
    row.inertial.fill(0.0);
    row.terms.columns_range_mut(AFTER_FRICTION + 1..).fill(0.0);
    row
}

/// A row as it would be if the measured torques were so many times larger.
pub(super) fn scaled(row: &Row, scales: &[f64]) -> Row {
    let mut row = row.clone();
    for (joint, scale) in scales.iter().enumerate() {
        row.unexplained[joint] += (scale - 1.0) * torque(&row, joint);
        for column in (TORQUE - 1..=TORQUE).chain(FIRST_HYSTERESIS..FIRST_HYSTERESIS + WIDTHS.len()) {
            row.terms[(joint, column)] *= scale;
        }
    }
    row
}

/// What hysteresis of one width keeps back in a row, for a share of one.
pub(super) fn kept_back(row: &Row, joint: usize, width: usize) -> f64 {
    row.terms[(joint, FIRST_HYSTERESIS + width)]
}

/// The measured torque of a row.
pub(super) fn torque(row: &Row, joint: usize) -> f64 {
    row.terms[(joint, TORQUE)]
}

/// The columns that are not zero, with their values.
pub(super) fn columns(
    unknowns: &Unknowns,
    joints: &Joints,
    row: &Row,
    joint: usize,
    entries: &mut Vec<(usize, f64)>,
) {
    let inertial = row.inertial.row(joint);
    entries.extend(inertial.iter().enumerate().filter(|(_, value)| **value != 0.0).map(|(k, v)| (k, *v)));
    let terms = own_terms(row, joint, joints.shapes[joint]);
    entries.extend(terms.iter().enumerate().map(|(term, v)| (unknowns.term_column(joint, term), *v)));
    // What a late torque lacks.
    entries.push((unknowns.delay_column(), -row.terms[(joint, AFTER_FRICTION + 2)]));
}
