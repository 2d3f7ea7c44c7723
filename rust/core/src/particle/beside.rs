//! What other contacts may do to the torques beside the one that is looked for (algorithm C1).
//!
//! Their places are held to be known, but for a spread; their forces are not. The torques that they may cause are Gaussian, so that
//! integrating them out takes a few directions out of the normal equations: with torques `A x` of unknowns `x` of unit variance, the
//! noise of the measurement has the covariance `I + A A^T`, whose inverse is `I - U U^T` with `U = A L^-T` and `L L^T = I + A^T A`.

use nalgebra::{Cholesky, Const, SMatrix, SVector, Vector3, Vector6};

use super::instant::Instant;
use super::motion::signed;
use super::response::ResponseModel;
use crate::robot::Robot;
use crate::spatial::vector::stack;
use crate::torque::{directions, NormalEquations};

/// Contacts that there may be at the same time.
pub(super) const MOST_CONTACTS: usize = 4;
/// Unknowns of a contact: its force along the normal and across it; and its place.
const FORCES: usize = 3;
const PLACES: usize = 2;
const UNKNOWNS: usize = (FORCES + PLACES) * (MOST_CONTACTS - 1);
const _: () = assert!(FORCES * MOST_CONTACTS <= UNKNOWNS, "the forces of all contacts are fitted together");
/// A force is known no better than this, or than its own size [N]: another contact may have been taken for a part of it. That of a
/// contact that was sure follows the motion.
const LEAST_DOUBT: f64 = 10.0;
const LEAST_SURE_DOUBT: f64 = 1.0;
const SURE_DOUBT: f64 = 0.2;
/// The normal is known no better than this, as the surface is made of triangles, and within the spread it turns as on a radius of so much;
/// at most to any direction of the half-space [rad, m].
const TILT: [f64; 2] = [0.3, 1.0];
const ROUND: f64 = 0.1;
/// A spread wider than a link is one over several links [m].
const WIDEST: f64 = 0.3;

/// A contact whose place is held to be known, in its link's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known {
    pub link: usize,
    /// On the surface [m].
    pub point: Vector3<f64>,
    /// Outward.
    pub normal: Vector3<f64>,
    /// Along the inward normal [N].
    pub force: f64,
    /// Of the point [m].
    pub spread: f64,
    /// Whether motion has confirmed it, so that its force is known too.
    pub sure: bool,
    /// That it is with; none where nothing is assumed of it.
    pub obstacle: Option<Spring>,
}

/// An obstacle that stays where it is, and springs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spring {
    /// Of curvature, world frame [m].
    pub centre: Vector3<f64>,
    /// From there to the surface, negative inside [m].
    pub distance: f64,
    /// Triangle of the point.
    pub triangle: Option<u32>,
    /// [N/m].
    pub stiffness: f64,
}

/// An unknown: the wrench of one standard deviation of it, and its mean over that.
#[derive(Debug, Clone, Copy)]
struct Unknown {
    wrench: Vector6<f64>,
    mean: f64,
}

impl Known {
    /// Does nothing.
    pub const NOWHERE: Known = Known {
        link: 0,
        point: Vector3::new(0.0, 0.0, 0.0),
        normal: Vector3::new(0.0, 0.0, 1.0),
        force: 0.0,
        spread: 0.0,
        sure: false,
        obstacle: None,
    };

    /// Follows the robot to the present pose (Bimbo 2019, eq. 8).
    pub fn follow(&mut self, robot: &Robot, instant: &Instant) {
        let Some((spring, surface)) = self.obstacle.as_mut().zip(robot.links()[self.link].surface.as_ref())
        else {
            return;
        };
        let local = instant.pose(self.link).inverse_transform_point(&spring.centre);
        let near = surface.closest_point_near(&local, spring.triangle);
        let (distance, normal) = signed(&near, &local);
        self.force = (self.force + (spring.distance - distance) * spring.stiffness).max(0.0);
        (self.point, self.normal) = (near.point, normal);
        (spring.distance, spring.triangle) = (distance, near.triangle);
    }

    /// Standard deviations of the three forces.
    fn deviations(&self, model: &ResponseModel) -> [f64; FORCES] {
        let friction = model.force_model.deviation_across(self.force).unwrap_or(0.0);
        let tilt = (self.spread / ROUND).clamp(TILT[0], TILT[1]);
        let across = friction.hypot(tilt * self.force);
        let along = if self.sure {
            (SURE_DOUBT * self.force).max(LEAST_SURE_DOUBT)
        } else {
            self.force.max(LEAST_DOUBT)
        };
        // Weights are in units of a noise that may be greater than stated.
        [along, across, across].map(|deviation| deviation / model.variance.sqrt())
    }

    fn forces(&self, model: &ResponseModel) -> [Unknown; FORCES] {
        let (directions, deviations) = (directions(&self.normal), self.deviations(model));
        std::array::from_fn(|a| {
            let force = directions[a] * deviations[a];
            let mean = if a == 0 { self.force / deviations[a] } else { 0.0 };
            Unknown { wrench: stack(&force, &self.point.cross(&force)), mean }
        })
    }

    /// To first order, a force that acts somewhere else has another moment.
    fn places(&self, model: &ResponseModel) -> [Unknown; PLACES] {
        let [inward, first, second] = directions(&self.normal);
        let aside = self.spread.min(WIDEST) / model.variance.sqrt();
        [first, second].map(|along| Unknown {
            wrench: stack(&Vector3::zeros(), &(along * aside).cross(&(inward * self.force))),
            mean: 0.0,
        })
    }
}

type Unknowns = SVector<f64, UNKNOWNS>;

/// Torques of unknowns, each row over its noise, by row and unknown; and the measured torques.
#[derive(Debug, Clone)]
pub(super) struct Beside {
    rows: Vec<Unknowns>,
    torque: Vec<f64>,
}

impl Beside {
    /// For so many torques.
    pub fn new(torques: usize) -> Self {
        Beside { rows: vec![Unknowns::zeros(); torques], torque: vec![0.0; torques] }
    }

    /// Takes what other contacts may do out of the normal equations of an instant, and out of its torque what they do in all
    /// likelihood beside a contact of its own.
    pub fn take_out(
        &mut self,
        instant: &mut Instant,
        others: &[Known],
        own: Option<&Known>,
        model: &ResponseModel,
    ) {
        if !others.is_empty() {
            self.integrate_out(instant, others, model);
            self.subtract(instant, others, own, model);
        }
    }

    /// Takes on the torques of an instant, and no unknown.
    fn begin(&mut self, instant: &Instant) {
        self.rows.fill(Unknowns::zeros());
        for ((torque, measured), deviation) in
            self.torque.iter_mut().zip(&instant.measured).zip(&instant.deviation)
        {
            *torque = measured / deviation;
        }
    }

    /// Sets the torques of an unknown.
    fn set(&mut self, instant: &Instant, column: usize, link: usize, unknown: &Unknown) {
        let frame = &instant.frames.links[link];
        for (axis, &row) in frame.rows().iter().enumerate() {
            self.rows[row][column] = frame.column(axis).dot(&unknown.wrench);
        }
    }

    /// `I + A^T A`, factored. None where numbers are not finite.
    fn factor(&self) -> Option<Cholesky<f64, Const<UNKNOWNS>>> {
        let gram: SMatrix<f64, UNKNOWNS, UNKNOWNS> = self.rows.iter().map(|row| row * row.transpose()).sum();
        (gram + SMatrix::identity()).cholesky()
    }

    fn integrate_out(&mut self, instant: &mut Instant, others: &[Known], model: &ResponseModel) {
        self.begin(instant);
        let mut mean = Unknowns::zeros();
        let mut column = 0;
        for other in others.iter().take(MOST_CONTACTS - 1) {
            for unknown in other.forces(model).iter().chain(&other.places(model)) {
                self.set(instant, column, other.link, unknown);
                mean[column] = unknown.mean;
                column += 1;
            }
        }
        let Some(factor) = self.factor() else { return };
        // The torques less the mean of what the others do; the rows become those of U.
        let (mut along, mut squared) = (Unknowns::zeros(), 0.0);
        for (row, torque) in self.rows.iter_mut().zip(&mut self.torque) {
            *torque -= row.dot(&mean);
            factor.l_dirty().solve_lower_triangular_mut(row);
            along += *row * *torque;
            squared += *torque * *torque;
        }
        instant.squared = (squared - along.norm_squared()).max(0.0);
        for &link in &instant.frames.wanted {
            let frame = &instant.frames.links[link];
            let (mut shared, mut product) = (SMatrix::<f64, 6, UNKNOWNS>::zeros(), Vector6::zeros());
            for (axis, &row) in frame.rows().iter().enumerate() {
                let felt = frame.column(axis);
                shared += felt * self.rows[row].transpose();
                product += felt * self.torque[row];
            }
            instant.equations[link] = NormalEquations {
                gram: frame.gram() - shared * shared.transpose(),
                product: product - shared * along,
            };
        }
    }

    /// The forces of all contacts are fitted together, and those of the others are subtracted.
    fn subtract(
        &mut self,
        instant: &mut Instant,
        others: &[Known],
        own: Option<&Known>,
        model: &ResponseModel,
    ) {
        self.begin(instant);
        let mut product = Unknowns::zeros();
        for (contact, known) in others.iter().chain(own).take(MOST_CONTACTS).enumerate() {
            for (a, unknown) in known.forces(model).iter().enumerate() {
                let column = FORCES * contact + a;
                self.set(instant, column, known.link, unknown);
                product[column] = unknown.mean;
            }
        }
        let Some(factor) = self.factor() else { return };
        product += self.rows.iter().zip(&self.torque).map(|(row, torque)| row * *torque).sum::<Unknowns>();
        let found = factor.solve(&product);
        let Instant { frames, target, measured, torque, deviation, .. } = instant;
        torque.copy_from_slice(measured);
        for (contact, known) in others.iter().enumerate() {
            let (directions, deviations) = (directions(&known.normal), known.deviations(model));
            let share = |a: usize| found[FORCES * contact + a];
            if share(0) > 0.0 {
                let force = (0..FORCES).map(|a| directions[a] * (deviations[a] * share(a))).sum();
                frames.subtract(known.link, &known.point, &force, deviation, torque);
            }
        }
        target.set(frames, torque, deviation);
    }
}

#[cfg(test)]
mod tests;
