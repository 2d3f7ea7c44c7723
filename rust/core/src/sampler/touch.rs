//! Where the contacts of a hypothesis are at one pose, and what its torques say of them.

// Rows and columns of matrices: the equations are written with their numbers.
#![allow(clippy::needless_range_loop)]

use nalgebra::{Matrix2, Vector2, Vector3};

use super::friction::Felt;
use super::hypothesis::{Claim, Contact, ContactModel, Forces, Touch};
use super::measurements::Measurement;
use super::path::ContactPath;
use super::sums::Sums;
use crate::particle::signed;
use crate::spatial::vector::stack;
use crate::torque::{directions, AllDirections, ForceModel, NormalFit};

impl<const N: usize> ContactPath<'_, N> {
    /// Contacts at one pose, found from where they were last, and what its torques say of them.
    pub(super) fn touch(&self, contacts: &[Contact; N], measurement: &Measurement) -> ([Touch; N], Felt<N>) {
        let mut touches = contacts.map(|contact| Touch { forces: Forces::default(), ..contact.touch });
        let felt = match contacts[0].claim.model {
            ContactModel::Obstacle => self.obstacles(contacts, measurement, &mut touches),
            ContactModel::Person => {
                Felt::Known(self.person(&contacts[0].claim, measurement, &mut touches[0]))
            }
            ContactModel::Both => Felt::Known(self.both(&contacts[0], measurement, &mut touches[0])),
        };
        (touches, felt)
    }

    fn obstacles(
        &self,
        contacts: &[Contact; N],
        measurement: &Measurement,
        touches: &mut [Touch; N],
    ) -> Felt<N> {
        let mut deeper = [0.0; N];
        for ((contact, touch), deeper) in contacts.iter().zip(touches.iter_mut()).zip(&mut deeper) {
            (*touch, *deeper) = self.place(contact, measurement);
        }
        let links = contacts.map(|contact| contact.claim.link);
        match self.force_model {
            ForceModel::Normal => {
                let pushes = self.forces_in::<1>(&links, measurement, touches).bare();
                Felt::Known(Sums::along(&pushes, &deeper))
            }
            ForceModel::FrictionCone(_) => {
                Felt::WithFriction(self.forces_in::<3>(&links, measurement, touches), deeper)
            }
        }
    }

    /// Where an obstacle touches, and how much deeper than at the first touch (m).
    pub(super) fn place(&self, contact: &Contact, measurement: &Measurement) -> (Touch, f64) {
        let Contact { claim, anchor, touch } = contact;
        let Some(surface) = self.surface(claim.link) else { return (*touch, 0.0) };
        let local = measurement.links[claim.link as usize].pose.inverse_transform_point(anchor);
        // Of all points, wherever it touched before: what is added up is the same in any order.
        let near = surface.closest_point_from(&local, touch.triangle);
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

    /// Of a force that is not tied to others.
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

    /// Inner products of the torques of unit forces in the first `USED` directions: along the normals, and across them.
    pub(super) fn forces_in<const USED: usize>(
        &self,
        links: &[u32; N],
        measurement: &Measurement,
        touches: &[Touch; N],
    ) -> AllDirections<N> {
        let wrenches = touches
            .map(|touch| directions(&touch.normal).map(|force| stack(&force, &touch.point.cross(&force))));
        let mut all = AllDirections {
            gram: [[[[0.0; 3]; 3]; N]; N],
            product: [[0.0; 3]; N],
            target: measurement.target.squared,
        };
        for i in 0..N {
            let link = links[i] as usize;
            for a in 0..USED {
                all.product[i][a] = wrenches[i][a].dot(&measurement.target.on(link).product);
            }
            for j in i..N {
                let between = measurement.gram_of(link, links[j] as usize);
                for b in 0..USED {
                    let felt = between * wrenches[j][b];
                    for a in 0..USED {
                        let inner = wrenches[i][a].dot(&felt);
                        all.gram[i][j][a][b] = inner;
                        all.gram[j][i][b][a] = inner;
                    }
                }
            }
        }
        all
    }
}
