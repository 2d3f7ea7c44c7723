//! The wrenches on any number of bodies from all torques at once (Vorndamme 2017, eq. 28), and the forces at their
//! points of contact (eqs. 29-30).

use nalgebra::{Matrix6, Vector3, Vector6};

use super::least_squares::LeastSquares;
use super::rows::{Root, TorqueRows, LEVER};
use super::several::{exceeds, Scene};
use super::wrench::{WrenchEstimate, RANK_TOLERANCE};
use crate::robot::Robot;

/// Share of an open direction that a contact may have and still count as determined.
const UNTOUCHED: f64 = 1e-6;

/// Workspace.
#[derive(Debug, Clone)]
pub(super) struct Stacked {
    system: LeastSquares,
    solution: Vec<f64>,
    direction: Vec<f64>,
    contacts: usize,
    unexplained: f64,
}

impl Stacked {
    /// Space for so many contacts.
    pub fn new(robot: &Robot, contacts: usize) -> Self {
        let unknowns = 6 * contacts;
        Self {
            system: LeastSquares::new(robot.nv() + 6, unknowns),
            solution: vec![0.0; unknowns],
            direction: vec![0.0; unknowns],
            contacts: 0,
            unexplained: 0.0,
        }
    }

    /// Least squares for a wrench on each body; returns the rank deficit (eq. 31).
    pub fn estimate(&mut self, scene: Scene, rows: &TorqueRows, bodies: &[usize]) -> usize {
        self.contacts = bodies.len();
        self.system.reset(6 * bodies.len());
        if let Some(Root { axes, value, tolerance, .. }) = &rows.root {
            for ((axis, value), tolerance) in axes.iter().zip(value).zip(tolerance) {
                self.system.add_row(value / tolerance);
                (0..bodies.len()).for_each(|index| self.set_wrench(index, axis, 1.0 / tolerance));
            }
        }
        for_each_torque(scene, rows, bodies, |k, weight, on| {
            self.system.add_row(rows.torque[k] * weight);
            for (index, _) in bodies.iter().enumerate().filter(|(_, body)| on(**body)) {
                self.set_wrench(index, &rows.axes[k], weight);
            }
        });
        self.system.factorise(RANK_TOLERANCE);
        self.unexplained = self.system.solve(&mut self.solution);
        6 * bodies.len() - self.system.rank()
    }

    fn set_wrench(&mut self, index: usize, axis: &Vector6<f64>, weight: f64) {
        for i in 0..6 {
            let scale = if i < 3 { weight } else { weight / LEVER };
            self.system.set(6 * index + i, axis[i] * scale);
        }
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
        let mut covariance = Matrix6::zeros();
        for column in 0..self.system.rank() {
            self.system.covariance_root(column, &mut self.direction);
            let root = Vector6::from_column_slice(&self.direction[block.clone()]);
            covariance += root * root.transpose();
        }
        let root = covariance
            .cholesky()
            .map_or_else(|| Matrix6::from_diagonal(&covariance.diagonal().map(f64::sqrt)), |c| c.l());
        let solution = Vector6::from_column_slice(&self.solution[block]);
        let redundant = self.redundant();
        WrenchEstimate::new(&solution, root, Vector3::zeros(), 6 - open.min(6), self.unexplained, redundant)
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
        for_each_torque(scene, rows, bodies, |k, weight, on| {
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

/// Calls `each` with every torque that one of the bodies can cause, its weight, and whether a body can.
fn for_each_torque(
    scene: Scene,
    rows: &TorqueRows,
    bodies: impl IntoIterator<Item = impl std::borrow::Borrow<usize>> + Clone,
    mut each: impl FnMut(usize, f64, &dyn Fn(usize) -> bool),
) {
    let robot = scene.robot;
    for joint in (1..robot.body_count()).filter(|joint| scene.region.joints[*joint]) {
        let on = |body: usize| robot.chain(body).contains(&joint);
        if bodies.clone().into_iter().any(|body| on(*body.borrow())) {
            for k in robot.velocity_range(joint) {
                each(k, 1.0 / rows.tolerance[k], &on);
            }
        }
    }
}
