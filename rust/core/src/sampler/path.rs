//! What a way from the measurements before the newest one to all of them is made of, and what its densities can be.

use nalgebra::Vector3;

use super::hypothesis::{Claim, Contact, ContactModel, Touch};
use super::measurements::{Measurement, Measurements};
use super::neighbours::Neighbours;
use super::sums::{Prior, Sums};
use crate::posterior::tempering::Logs;
use crate::robot::Robot;
use crate::surface::{Surface, SurfacePoint};
use crate::torque::ForceModel;

/// The model of so many contacts.
pub(super) struct ContactPath<'a, const N: usize> {
    pub robot: &'a Robot,
    pub measurements: &'a Measurements,
    pub models: &'a [ContactModel],
    /// Places of the surface, by area.
    pub places: &'a [(u32, SurfacePoint)],
    pub neighbours: &'a Neighbours,
    pub prior: Prior,
    pub force_model: ForceModel,
    pub log_radius: [f64; 2],
    /// Whether the way begins without any measurement.
    pub nothing_before: bool,
}

impl<const N: usize> ContactPath<'_, N> {
    pub fn surface(&self, link: u32) -> Option<&Surface> {
        self.robot.links()[link as usize].surface.as_deref()
    }

    /// A contact by a model at one of the places, with a radius at a share of its range.
    pub fn claim(&self, model: ContactModel, place: usize, of_radius: f64) -> Claim {
        let (link, place) = self.places[place.min(self.places.len() - 1)];
        let [least, greatest] = self.log_radius;
        Claim { model, link, place, log_radius: least + (greatest - least) * of_radius }
    }

    /// Where the claimed contact was first.
    pub fn contact(&self, claim: Claim) -> Contact {
        let place = &claim.place;
        let away = match claim.model {
            ContactModel::Obstacle => place.normal * claim.log_radius.exp(),
            ContactModel::Person | ContactModel::Both => Vector3::zeros(),
        };
        let anchor = self.measurements.first[claim.link as usize].transform_point(&(place.point + away));
        Contact { claim, anchor, touch: Touch::of(&claim) }
    }

    /// Whether friction is in proportion to forces that all measurements tell.
    pub fn sized_by_forces(&self, contacts: &[Contact; N]) -> bool {
        let friction = self.force_model.deviation_of_sliding(1.0).is_some();
        friction && contacts[0].claim.model == ContactModel::Obstacle
    }

    /// How much a measurement counted before the newest one came, and counts now.
    pub fn counts(&self, measurement: &Measurement) -> [f64; 2] {
        [if self.nothing_before { 0.0 } else { measurement.before }, measurement.now]
    }

    /// Torques that tell of the noise, before the newest measurement came and now.
    pub fn rows(&self) -> [f64; 2] {
        let [before, now] = self.measurements.rows;
        [if self.nothing_before { 0.0 } else { before }, now]
    }

    /// What the densities can be at most, whatever other measurements say.
    pub fn most(&self, [before, now]: &[Sums<N>; 2]) -> Logs {
        let [rows_before, rows_now] = self.rows();
        let (start, end) = (self.prior.most(before, rows_before), self.prior.most(now, rows_now));
        Logs { start, added: end - start }
    }
}

/// Densities at the start and at the end of the way.
pub(super) fn logs(start: f64, end: f64) -> Logs {
    // From a density of zero no way leads back.
    Logs { start, added: if start == f64::NEG_INFINITY { 0.0 } else { end - start } }
}
