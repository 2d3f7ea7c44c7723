//! Whether a weight that a link carries explains the torques too.
//!
//! Its force keeps its size and its direction in the world, and its place on the link. So its torques are linear in the
//! mass and the first moment of mass, as in the identification of inertial parameters, and the best weight over a window
//! of poses is a least-squares solution with four unknowns.

use nalgebra::{Matrix4, Vector3, Vector4};

use super::contacts::{Contacts, Task};
use super::window::Window;

/// Added to the normal equations as a share of their mean: at few poses not all four can be told apart.
const RIDGE: f64 = 1e-9;
/// A weight is ruled out where the torques are so many times as likely under a push: twice the logarithm of a
/// likelihood ratio of a hundred.
const RULED_OUT: f64 = 9.2;

/// Whether a weight on one of these links explains the torques of a window about as well as contacts with an obstacle do.
/// `down` is the direction of gravity in the world frame.
pub(super) fn explains_as_well(
    task: &Task<'_>,
    links: &[usize],
    down: &Vector3<f64>,
    contacts: Option<&Contacts>,
) -> bool {
    let Some(contacts) = contacts else { return true };
    let samples = task.window.samples();
    let push = contacts.misfit + contacts.others;
    let measured: f64 = samples.iter().map(|sample| sample.target.squared).sum();
    let weight = measured - links.iter().map(|&link| explained(task.window, link, down)).fold(0.0, f64::max);
    // Variance of the errors in units of the stated one, as the push leaves them, never smaller than stated.
    let variance = (push / (samples.len() * task.joints) as f64).max(1.0);
    weight <= push + RULED_OUT * variance
}

/// By how much the best weight on a link reduces the squared norm of the torques.
fn explained(window: &Window, link: usize, down: &Vector3<f64>) -> f64 {
    let (mut gram, mut products) = (Matrix4::zeros(), Vector4::zeros());
    for sample in window.samples() {
        let (own_gram, own_products) = sample.links[link].weight(down, sample.target.on(link));
        gram += own_gram;
        products += own_products;
    }
    let ridge = RIDGE * gram.trace();
    (gram + Matrix4::identity() * ridge)
        .cholesky()
        .map_or(0.0, |factor| products.dot(&factor.solve(&products)))
}
