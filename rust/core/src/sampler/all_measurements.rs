//! What all measurements say of contacts together.

use super::friction::NormalForces;
use super::hypothesis::{put, Contact};
use super::path::ContactPath;
use super::sums::Sums;

impl<const N: usize> ContactPath<'_, N> {
    /// The contacts at the newest pose, and the sums of all measurements as they counted before that came and as they count now, with
    /// friction as large as normal forces then and now allow; none where what was added up first shows that it is not taken.
    pub fn add_up(
        &self,
        mut contacts: [Contact; N],
        forces: &[NormalForces<N>; 2],
        takes: impl Fn(&[Sums<N>; 2]) -> bool,
    ) -> Option<([Contact; N], [Sums<N>; 2])> {
        let mut both = [Sums::NONE; 2];
        let mut newest = contacts.map(|contact| contact.touch);
        for (number, measurement) in self.measurements.scattered().enumerate() {
            let (touches, felt) = self.touch(&contacts, measurement);
            put(&mut contacts, touches);
            for ((sums, share), forces) in both.iter_mut().zip(self.counts(measurement)).zip(forces) {
                if share > 0.0 {
                    sums.add(share, &felt.sums(self.force_model, forces, measurement.rows));
                }
            }
            if number == 0 {
                newest = touches;
            }
            // Not each time: to look costs a part of what it saves.
            if (number + 1).is_power_of_two() && !takes(&both) {
                return None;
            }
        }
        put(&mut contacts, newest);
        Some((contacts, both))
    }
}
