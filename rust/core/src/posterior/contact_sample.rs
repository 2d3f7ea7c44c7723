//! Weighted samples of a posterior over contacts.

use nalgebra::Vector3;

/// One sample of a posterior: a contact on a link, all in the link's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactSample {
    /// Index into the robot's links.
    pub link: usize,
    /// On the surface (m).
    pub point: Vector3<f64>,
    /// Outward.
    pub normal: Vector3<f64>,
    /// On the link (N).
    pub force: Vector3<f64>,
    /// Of the contact (N/m); zero where nothing is assumed of it.
    pub stiffness: f64,
}

/// What samples of a posterior can be read from.
pub(crate) trait ContactSamples {
    /// ContactSample k.
    fn sample(&self, k: usize) -> ContactSample;
}
