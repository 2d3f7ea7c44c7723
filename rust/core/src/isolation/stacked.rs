//! The wrenches on any number of bodies from all torques at once (Vorndamme 2017, eq. 28), and the forces at their
//! points of contact (eqs. 29-30).

use nalgebra::{Matrix6, Vector3, Vector6};

use super::found::Scene;
use super::rows::{Root, TorqueRows};
use super::wrench::{WrenchEstimate, RANK_TOLERANCE};
use super::wrench_rows::LEVER;
use crate::math::least_squares::{exceeds, LeastSquares};
use crate::robot::Robot;
use crate::spatial::vector::{split, stack};

/// Share of an open direction that a contact may have and still count as determined.
const UNTOUCHED: f64 = 1e-6;

/// Workspace.
#[derive(Debug, Clone)]
pub(super) struct Stacked {
    pub(super) system: LeastSquares,
    solution: Vec<f64>,
    direction: Vec<f64>,
    /// Six rows of a root of the covariance.
    root_rows: Vec<f64>,
    pub(super) contacts: usize,
    unexplained: f64,
    pub(super) rows: Vec<Row>,
    /// The unit vector of each row, without what the estimated wrenches reach.
    pub(super) projected: Vec<f64>,
    /// Six columns of one more wrench, without that.
    pub(super) columns: Vec<f64>,
}

/// A row of the system.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// The joint whose torque it is; none: a component of a sensor's wrench.
    pub joint: Option<usize>,
    /// What it says of a wrench, weighted, the moment scaled by the lever.
    pub axis: Vector6<f64>,
}

impl Stacked {
    /// Space for so many contacts.
    pub fn new(robot: &Robot, contacts: usize) -> Self {
        let (rows, unknowns) = (robot.nv() + 6, 6 * contacts);
        Self {
            system: LeastSquares::new(rows, unknowns),
            solution: vec![0.0; unknowns],
            direction: vec![0.0; unknowns],
            root_rows: vec![0.0; 6 * unknowns.max(1)],
            contacts: 0,
            unexplained: 0.0,
            rows: Vec::with_capacity(rows),
            projected: vec![0.0; rows * rows],
            columns: vec![0.0; 6 * rows],
        }
    }

    /// Least squares for a wrench on each body; returns the rank deficit (eq. 31).
    pub fn estimate(&mut self, scene: Scene, rows: &TorqueRows, bodies: &[usize]) -> usize {
        self.contacts = bodies.len();
        self.rows.clear();
        self.system.reset(6 * bodies.len());
        if let Some(Root { axes, value, tolerance, .. }) = &rows.root {
            for ((axis, value), tolerance) in axes.iter().zip(value).zip(tolerance) {
                self.add_row(None, axis, *value, 1.0 / tolerance);
                (0..bodies.len()).for_each(|index| self.set_wrench(index));
            }
        }
        for_each_torque(scene, bodies, |joint, k, on| {
            self.add_row(Some(joint), &rows.axes[k], rows.torque[k], 1.0 / rows.tolerance[k]);
            for (index, _) in bodies.iter().enumerate().filter(|(_, body)| on(**body)) {
                self.set_wrench(index);
            }
        });
        self.system.factorise(RANK_TOLERANCE);
        self.unexplained = self.system.solve(&mut self.solution);
        6 * bodies.len() - self.system.rank()
    }

    /// Multiplications of an estimate of so many wrenches.
    pub fn work(&self, contacts: usize) -> usize {
        let columns = 6 * contacts;
        // The factorisation, and six rows of the covariance's root for each contact.
        (self.rows.capacity() + columns) * columns * columns
    }

    fn add_row(&mut self, joint: Option<usize>, axis: &Vector6<f64>, value: f64, weight: f64) {
        let (linear, angular) = split(axis);
        self.rows.push(Row { joint, axis: stack(&(linear * weight), &(angular * (weight / LEVER))) });
        self.system.add_row(value * weight);
    }

    /// The last row's part of a wrench.
    fn set_wrench(&mut self, index: usize) {
        let Some(row) = self.rows.last() else { return };
        (0..6).for_each(|i| self.system.set(6 * index + i, row.axis[i]));
    }

    fn set_force(&mut self, index: usize, axis: &Vector6<f64>, point: &Vector3<f64>, weight: f64) {
        let velocity = axis.fixed_rows::<3>(0) + axis.fixed_rows::<3>(3).cross(point);
        (0..3).for_each(|i| self.system.set(3 * index + i, velocity[i] * weight));
    }

    /// The wrench of one contact, of rank 6 where no open direction touches it.
    pub fn wrench(&mut self, index: usize) -> WrenchEstimate {
        let block = 6 * index..6 * index + 6;
        let deficit = 6 * self.contacts - self.system.rank();
        let mut open = 0;
        for direction in 0..deficit {
            self.system.open_direction(direction, &mut self.direction);
            let size = |x: &[f64]| x.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
            open += usize::from(size(&self.direction[block.clone()]) > UNTOUCHED * size(&self.direction));
        }
        let rank = self.system.rank();
        for (unknown, row) in block.clone().zip(self.root_rows.chunks_exact_mut(rank.max(1))) {
            self.system.covariance_root_row(unknown, row);
        }
        let rows: [&[f64]; 6] = std::array::from_fn(|i| &self.root_rows[i * rank..(i + 1) * rank]);
        let covariance =
            Matrix6::from_fn(|i, j| rows[i].iter().zip(rows[j]).map(|(a, b)| a * b).sum::<f64>());
        let root = covariance
            .cholesky()
            .map_or_else(|| Matrix6::from_diagonal(&covariance.diagonal().map(f64::sqrt)), |c| c.l());
        let solution = Vector6::from_column_slice(&self.solution[block]);
        let redundant = self.redundant();
        WrenchEstimate::new(&solution, root, 6 - open.min(6), self.unexplained, redundant)
    }

    /// Root mean square of what contradicts forces without moments, in tolerances; none above `limit`.
    pub fn misfit(&mut self, limit: f64) -> Option<f64> {
        let checks = (self.redundant() + self.contacts).max(1) as f64;
        let mut squares = self.unexplained;
        for index in 0..self.contacts {
            // Before the costly part.
            if exceeds(squares, limit * limit * checks) {
                return None;
            }
            squares += self.wrench(index).moment_along().powi(2);
        }
        Some((squares / checks).sqrt()).filter(|misfit| *misfit <= limit)
    }

    fn redundant(&self) -> usize {
        self.system.rows() - self.system.rank()
    }

    /// The forces at known points (from the kinematics' origin) on the bodies; false where the torques do not
    /// determine them.
    pub fn identify(&mut self, scene: Scene, rows: &TorqueRows, places: &[(usize, Vector3<f64>)]) -> bool {
        self.system.reset(3 * places.len());
        let bodies = places.iter().map(|(body, _)| *body);
        if let Some(Root { axes, value, tolerance, .. }) = &rows.root {
            for ((axis, value), tolerance) in axes.iter().zip(value).zip(tolerance) {
                self.system.add_row(value / tolerance);
                for (index, (_, point)) in places.iter().enumerate() {
                    self.set_force(index, axis, point, 1.0 / tolerance);
                }
            }
        }
        for_each_torque(scene, bodies, |_, k, on| {
            let weight = 1.0 / rows.tolerance[k];
            self.system.add_row(rows.torque[k] * weight);
            for (index, (_, point)) in places.iter().enumerate().filter(|(_, (body, _))| on(*body)) {
                self.set_force(index, &rows.axes[k], point, weight);
            }
        });
        self.system.factorise(RANK_TOLERANCE);
        self.system.solve(&mut self.solution);
        self.system.rank() == 3 * places.len()
    }

    /// One of the forces identified.
    pub fn force(&self, index: usize) -> Vector3<f64> {
        Vector3::from_column_slice(&self.solution[3 * index..3 * index + 3])
    }
}

/// Calls `each` with every joint and velocity variable whose torque one of the bodies can cause, and whether a body can.
fn for_each_torque(
    scene: Scene,
    bodies: impl IntoIterator<Item = impl std::borrow::Borrow<usize>> + Clone,
    mut each: impl FnMut(usize, usize, &dyn Fn(usize) -> bool),
) {
    let robot = scene.robot;
    for joint in (1..robot.body_count()).filter(|joint| scene.region.joints[*joint]) {
        let on = |body: usize| robot.moves(joint, body);
        if bodies.clone().into_iter().any(|body| on(*body.borrow())) {
            for k in robot.velocity_range(joint) {
                each(joint, k, &on);
            }
        }
    }
}
