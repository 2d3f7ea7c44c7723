//! Where the contacts of a hypothesis are at one pose, and what its torques say of them.

// Rows and columns of matrices: the equations are written with their numbers.
#![allow(clippy::needless_range_loop)]

use nalgebra::{Matrix2, Vector2, Vector3};

use super::hypothesis::{Claim, Contact, ContactModel, Forces, Touch};
use super::measurements::Measurement;
use super::path::ContactPath;
use super::sums::Sums;
use crate::particle::signed;
use crate::spatial::vector::stack;
use crate::torque::{directions, AllDirections, ForceModel, NormalFit, SeveralPushes};

impl<const N: usize> ContactPath<'_, N> {
    /// Contacts at one pose, found from where they were last, and the sums of its torques.
    pub(super) fn touch(&self, contacts: &[Contact; N], measurement: &Measurement) -> ([Touch; N], Sums<N>) {
        let mut touches = contacts.map(|contact| Touch { forces: Forces::default(), ..contact.touch });
        let mut sums = match contacts[0].claim.model {
            ContactModel::Obstacle => self.obstacles(contacts, measurement, &mut touches),
            ContactModel::Person => self.person(&contacts[0].claim, measurement, &mut touches[0]),
            ContactModel::Both => self.both(&contacts[0], measurement, &mut touches[0]),
        };
        sums.rows = measurement.rows;
        (touches, sums)
    }

    fn obstacles(
        &self,
        contacts: &[Contact; N],
        measurement: &Measurement,
        touches: &mut [Touch; N],
    ) -> Sums<N> {
        let mut deeper = [0.0; N];
        for ((contact, touch), deeper) in contacts.iter().zip(touches.iter_mut()).zip(&mut deeper) {
            (*touch, *deeper) = self.place(contact, measurement);
        }
        let pushes = if N == 1 {
            SeveralPushes::of_one(&self.fit(&contacts[0].claim, measurement, &touches[0]))
        } else {
            self.pushes(contacts, measurement, touches)
        };
        Sums::along(&pushes, &deeper)
    }

    /// Where an obstacle touches, and how much deeper than at the first touch (m).
    pub(super) fn place(&self, contact: &Contact, measurement: &Measurement) -> (Touch, f64) {
        let Contact { claim, anchor, touch } = contact;
        let Some(surface) = self.surface(claim.link) else { return (*touch, 0.0) };
        let local = measurement.links[claim.link as usize].pose.inverse_transform_point(anchor);
        let near = surface.closest_point_near(&local, touch.triangle);
        let (distance, normal) = signed(&near, &local);
        let deeper = claim.log_radius.exp() - distance;
        let forces = Forces { first: -normal, spring: -normal * deeper, ..Forces::default() };
        (Touch { point: near.point, normal, triangle: near.triangle, forces }, deeper)
    }

    fn person(&self, claim: &Claim, measurement: &Measurement, touch: &mut Touch) -> Sums<N> {
        *touch = Touch::of(claim);
        let (sums, force) = Sums::free(&self.fit(claim, measurement, touch), &self.prior);
        touch.forces.known = -touch.normal * force;
        sums
    }

    fn both(&self, contact: &Contact, measurement: &Measurement, touch: &mut Touch) -> Sums<N> {
        let Contact { claim, anchor, .. } = contact;
        *touch = Touch::of(claim);
        let link = claim.link as usize;
        let (frame, target) = (&measurement.links[link], measurement.target.on(link));
        let first = &self.measurements.first[link];
        let inward = -(frame.pose.rotation.transpose() * (first.rotation * touch.normal));
        let stretch = frame.pose.inverse_transform_point(anchor) - touch.point;
        touch.forces = Forces { first: inward, spring: stretch, ..Forces::default() };
        let (gram, products) = frame.responses(&touch.point, &[inward, stretch, Vector3::zeros()], target);
        let gain = Matrix2::new(gram[(0, 0)], gram[(0, 1)], gram[(1, 0)], gram[(1, 1)]);
        Sums::of_two(gain, Vector2::new(products[0], products[1]), measurement.target.squared)
    }

    /// Of a single contact.
    fn fit(&self, claim: &Claim, measurement: &Measurement, touch: &Touch) -> NormalFit {
        let link = claim.link as usize;
        let (frame, target) = (&measurement.links[link], measurement.target.on(link));
        let squared = measurement.target.squared;
        let (gain, product) = frame.response(&touch.point, &touch.normal, target);
        let bare = NormalFit { gain, product, target: squared, penalty: 0.0 };
        match self.force_model.deviation_across(self.prior.force_of(&bare)) {
            Some(deviation) => {
                let (gram, products) = frame.responses(&touch.point, &directions(&touch.normal), target);
                NormalFit::without_friction(&gram, &products, squared, deviation * deviation)
            }
            None => bare,
        }
    }

    /// Of several.
    fn pushes(
        &self,
        contacts: &[Contact; N],
        measurement: &Measurement,
        touches: &[Touch; N],
    ) -> SeveralPushes<N> {
        let Some(between) = &measurement.between else { return SeveralPushes::NONE };
        let wrenches = touches
            .map(|touch| directions(&touch.normal).map(|force| stack(&force, &touch.point.cross(&force))));
        let mut all = AllDirections {
            gram: [[[[0.0; 3]; 3]; N]; N],
            product: [[0.0; 3]; N],
            target: measurement.target.squared,
        };
        // Across the normals only where there is friction.
        let used = if self.force_model == ForceModel::Normal { 1 } else { 3 };
        for i in 0..N {
            let link = contacts[i].claim.link as usize;
            for a in 0..used {
                all.product[i][a] = wrenches[i][a].dot(&measurement.target.on(link).product);
            }
            for j in i..N {
                let between = between.of(link, contacts[j].claim.link as usize);
                for b in 0..used {
                    let felt = between * wrenches[j][b];
                    for a in 0..used {
                        let inner = wrenches[i][a].dot(&felt);
                        all.gram[i][j][a][b] = inner;
                        all.gram[j][i][b][a] = inner;
                    }
                }
            }
        }
        let bare = all.bare();
        if used == 1 {
            return bare;
        }
        let forces = bare.forces(self.prior.force);
        all.without_friction(forces.map(|force| self.force_model.deviation_across(force)))
    }
}
