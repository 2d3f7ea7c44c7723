//! One obstacle that stays in the world, fitted to a window of poses.
//!
//! At each pose the contact is the point of the link's surface nearest to the obstacle's centre, and its force is the one
//! that explains the torques best (variable projection). So only the centre is searched for, by least squares
//! (Levenberg-Marquardt). Whatever torques a single pose may show, few but those of a push have one such centre for
//! all poses.

use nalgebra::{Matrix3, Vector3};

use super::contacts::{Contact, Contacts, Task};
use super::window::{Sample, POSES};

/// Step of the numerical derivatives, well above rounding and below the size of any facet that counts [m].
const STEP: f64 = 5e-5;
/// The centre is moved no farther at once [m].
const FARTHEST: f64 = 0.05;
/// Damping of the steps, as a share of the mean curvature: at the start, least and greatest, and its change.
const DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-7;
const MOST_DAMPING: f64 = 1e3;
const DAMPING_FACTOR: f64 = 5.0;
/// From here on steps are so short that another start does better.
const HOPELESS: f64 = 1.0;
/// A step that leaves more than this share of the misfit has arrived.
const SETTLED: f64 = 0.999;

/// Residuals at a pose: with the centre where it is, and moved along each axis.
#[derive(Debug, Clone)]
pub(super) struct Residuals([Vec<f64>; 4]);

impl Residuals {
    /// For as many joints.
    pub fn new(joints: usize) -> Self {
        // Two more for the force across the normal.
        Residuals(std::array::from_fn(|_| vec![0.0; joints + 2]))
    }
}

/// An obstacle's centre, and what is known of the contacts with it.
#[derive(Debug, Clone)]
pub(super) struct Obstacle {
    /// World frame [m].
    centre: Vector3<f64>,
    damping: f64,
    /// One a pose: where the nearest point was; -1 where not known.
    triangles: [Option<u32>; POSES],
    contacts: Contacts,
}

impl Obstacle {
    /// About a centre, in the world frame [m].
    pub fn at(centre: Vector3<f64>) -> Self {
        Obstacle { centre, damping: DAMPING, triangles: [None; POSES], contacts: Contacts::default() }
    }

    /// The contacts as last fitted.
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// At a pose that follows on another, the contact is looked for near where it was there.
    pub fn follow(&mut self, pose: usize, before: usize) {
        self.triangles[pose] = self.triangles[before];
    }

    /// Takes one step towards the best centre; returns whether it gained next to nothing, so that another will not either.
    pub fn improve(&mut self, task: &Task<'_>, residuals: &mut Residuals) -> bool {
        let (gram, slope) = self.linearise(task, residuals);
        let curvature = gram.trace() / 3.0;
        let damped = gram + Matrix3::identity() * (curvature * self.damping);
        let Some(mut step) = damped.cholesky().map(|factor| -factor.solve(&slope)) else {
            return true;
        };
        let length = step.norm();
        if !length.is_finite() {
            return true;
        }
        if length > FARTHEST {
            step *= FARTHEST / length;
        }
        let mut moved = Obstacle { centre: self.centre + step, ..self.clone() };
        moved.evaluate(task, residuals);
        let before = self.contacts.misfit;
        if moved.contacts.misfit < before {
            *self = moved;
            self.damping = (self.damping / DAMPING_FACTOR).max(LEAST_DAMPING);
            self.contacts.misfit > SETTLED * before
        } else {
            self.damping = (self.damping * DAMPING_FACTOR).min(MOST_DAMPING);
            self.damping > HOPELESS
        }
    }

    /// Sets the contacts with the centre where it is.
    fn evaluate(&mut self, task: &Task<'_>, residuals: &mut Residuals) {
        (self.contacts.misfit, self.contacts.others) = (0.0, 0.0);
        for (k, sample) in task.window.samples().iter().enumerate() {
            self.touch(task, k, sample, &mut residuals.0[0]);
        }
    }

    /// Sets the contact at a pose, and adds what it leaves over.
    fn touch(&mut self, task: &Task<'_>, k: usize, sample: &Sample, residual: &mut [f64]) {
        let contact = Contact::of(task, sample, &self.centre, self.triangles[k], residual);
        self.triangles[k] = contact.triangle;
        self.contacts.force[k] = contact.force;
        self.contacts.variance[k] = contact.variance;
        self.contacts.distance[k] = contact.distance;
        if k == task.window.newest() {
            self.contacts.point = contact.point;
        }
        self.contacts.misfit += contact.misfit;
        self.contacts.others += contact.others;
    }

    /// Sets the contacts; returns the normal equations of a step: the Gram matrix of the residuals' derivatives, and
    /// their product with the residuals.
    fn linearise(&mut self, task: &Task<'_>, residuals: &mut Residuals) -> (Matrix3<f64>, Vector3<f64>) {
        let (mut gram, mut slope) = (Matrix3::zeros(), Vector3::zeros());
        (self.contacts.misfit, self.contacts.others) = (0.0, 0.0);
        for (k, sample) in task.window.samples().iter().enumerate() {
            let [here, moved @ ..] = &mut residuals.0;
            self.touch(task, k, sample, here);
            for (axis, moved) in moved.iter_mut().enumerate() {
                let mut centre = self.centre;
                centre[axis] += STEP;
                Contact::of(task, sample, &centre, self.triangles[k], moved);
            }
            let used = sample.links[task.link].rows().len() + 2;
            for (i, &here) in here[..used].iter().enumerate() {
                let derivative = Vector3::from_fn(|axis, _| (moved[axis][i] - here) / STEP);
                gram += derivative * derivative.transpose();
                slope += derivative * here;
            }
        }
        (gram, slope)
    }
}

#[cfg(test)]
mod tests;
