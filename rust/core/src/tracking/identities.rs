//! Which contact of a tick is which contact of the tick before.

use super::path::Path;
use crate::isolation::{Contact, Isolation, PathPoint, Track};
use crate::robot::{Kinematics, LinkIndex, Robot};

/// Contacts that are known at a time.
const MOST: usize = 16;
/// A contact that no tick has shown for so long has ended (s).
const FORGOTTEN: f64 = 0.2;
/// A contact that is farther from where a known one is than this is another (m): about the width of a hand, and more than the
/// error of a point that is located.
const NEAR: f64 = 0.15;

#[derive(Debug, Clone, Copy)]
struct Known {
    id: u64,
    since: f64,
    peak_force: f64,
    link: LinkIndex,
    /// The last point, if there was one: it goes along with its link.
    place: Option<PathPoint>,
    path: Path,
    last: f64,
}

impl Known {
    /// How far a contact is from this one (m), in about these units where only links are known; none if it is another.
    fn distance(&self, contact: &Contact, robot: &Robot, kinematics: &Kinematics) -> Option<f64> {
        if let (Some(last), Some(place)) = (self.place, contact.place) {
            let last = kinematics.link_pose(robot, last.link).transform_point(&last.point_local);
            return Some((last - place.point).norm()).filter(|distance| *distance <= NEAR);
        }
        let [one, two] = [self.link, contact.link];
        let parent = |link: LinkIndex| robot[link].parent();
        if one == two {
            Some(NEAR)
        } else if parent(one) == Some(two) || parent(two) == Some(one) {
            Some(2.0 * NEAR)
        } else {
            None
        }
    }
}

/// Contacts with an identity.
#[derive(Debug, Clone)]
pub(super) struct Identities {
    known: Vec<Known>,
    next: u64,
}

impl Identities {
    pub fn new() -> Self {
        Identities { known: Vec::with_capacity(MOST), next: 0 }
    }

    /// Names the contacts of a tick at `time` (s), those first that are nearest to a known one. A single one goes on as a single
    /// one, wherever it is thought to be. `is_elsewhere`: the posterior's contact has moved to another place.
    pub fn name(
        &mut self,
        isolation: &mut Isolation,
        robot: &Robot,
        kinematics: &Kinematics,
        is_elsewhere: bool,
        time: f64,
    ) {
        self.known.retain(|known| time - known.last <= FORGOTTEN);
        let Isolation { contacts, paths, .. } = isolation;
        paths.clear();
        let alone = contacts.len() == 1 && self.known.len() == 1;
        for _ in 0..contacts.len() {
            let Some((which, found)) = self.nearest(contacts, robot, kinematics, alone, time) else { break };
            let contact = &mut contacts[which];
            let found = match found {
                Some(found) => found,
                None if self.known.len() == MOST => break,
                None => self.begin(contact, time),
            };
            let known = &mut self.known[found];
            known.take_in(contact, is_elsewhere, time);
            let first = paths.len();
            paths.extend_from_slice(known.path.points());
            let Known { id, since, peak_force, .. } = *known;
            contact.track = Some(Track { id, since, peak_force, path: first..paths.len() });
        }
    }

    /// The contact without name that is nearest to a known one, and which that is; the first one if all are new.
    fn nearest(
        &self,
        contacts: &[Contact],
        robot: &Robot,
        kinematics: &Kinematics,
        alone: bool,
        time: f64,
    ) -> Option<(usize, Option<usize>)> {
        let mut nearest = (f64::INFINITY, None);
        for (which, contact) in contacts.iter().enumerate().filter(|(_, contact)| contact.track.is_none()) {
            let first = nearest.1.is_none();
            if first {
                nearest.1 = Some((which, None));
            }
            for (found, known) in self.known.iter().enumerate().filter(|(_, known)| known.last < time) {
                let distance = if alone { Some(0.0) } else { known.distance(contact, robot, kinematics) };
                if let Some(distance) = distance.filter(|distance| *distance < nearest.0) {
                    nearest = (distance, Some((which, Some(found))));
                }
            }
        }
        nearest.1
    }

    /// A new contact.
    fn begin(&mut self, contact: &Contact, time: f64) -> usize {
        self.known.push(Known {
            id: self.next,
            since: time,
            peak_force: 0.0,
            link: contact.link,
            place: None,
            path: Path::new(contact),
            last: time,
        });
        self.next += 1;
        self.known.len() - 1
    }

    /// All contacts have ended.
    pub fn end(&mut self) {
        self.known.clear();
    }

    /// As if there had been no contact ever.
    pub fn reset(&mut self) {
        self.end();
        self.next = 0;
    }
}

impl Known {
    /// Takes in the same contact in a tick.
    fn take_in(&mut self, contact: &Contact, is_elsewhere: bool, time: f64) {
        (self.link, self.last) = (contact.link, time);
        self.peak_force = self.peak_force.max(contact.force().map_or(0.0, |force| force.norm()));
        let here = |place: crate::isolation::ContactPlace| PathPoint {
            time,
            link: contact.link,
            point_local: place.point_local,
        };
        self.place = contact.place.map(here);
        self.path.follow(contact, is_elsewhere, time);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::isolation::ContactPlace;

    /// Follows contacts on the example arm at rest, each a link and a point in its frame.
    struct Followed {
        robot: Robot,
        kinematics: Kinematics,
        identities: Identities,
        time: f64,
    }

    impl Followed {
        fn new() -> Self {
            let robot = Robot::example_arm();
            let mut kinematics = Kinematics::new(&robot);
            kinematics.set_configuration(&robot, &[0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0]);
            Followed { robot, kinematics, identities: Identities::new(), time: 0.0 }
        }

        fn ids(&mut self, places: &[(&str, Option<[f64; 3]>)]) -> Vec<u64> {
            let contact = |&(name, point): &(&str, Option<[f64; 3]>)| {
                let link = self.robot.link(name).expect("a link");
                let place = point.map(|point| {
                    let (point_local, pose) = (point.into(), self.kinematics.link_pose(&self.robot, link));
                    let point = pose.transform_point(&point_local);
                    ContactPlace { point, point_local, normal: Vector3::z(), std: 0.01 }
                });
                Contact { place, ..Contact::unlocated(link) }
            };
            let mut isolation =
                Isolation { contacts: places.iter().map(contact).collect(), ..Isolation::default() };
            self.time += 0.01;
            self.identities.name(&mut isolation, &self.robot, &self.kinematics, false, self.time);
            isolation.contacts.iter().map(|contact| contact.track.as_ref().expect("a track").id).collect()
        }
    }

    #[test]
    fn two_contacts_on_one_link_keep_their_names_in_any_order() {
        let mut followed = Followed::new();
        let (low, high) = (("link_3", Some([0.05, 0.0, 0.02])), ("link_3", Some([0.05, 0.0, 0.24])));
        assert_eq!(followed.ids(&[low, high]), [0, 1]);
        assert_eq!(followed.ids(&[high, low]), [1, 0]);
        // Each moves on.
        let (low, high) = (("link_3", Some([0.05, 0.0, 0.05])), ("link_3", Some([0.05, 0.0, 0.20])));
        assert_eq!(followed.ids(&[high, low]), [1, 0]);
        // One ends, and a third one is far from both.
        assert_eq!(followed.ids(&[high]), [1]);
        assert_eq!(followed.ids(&[high, ("link_7", Some([0.0, 0.0, 0.1]))]), [1, 2]);
    }

    #[test]
    fn a_contact_whose_link_is_taken_for_its_neighbour_keeps_its_name() {
        let mut followed = Followed::new();
        let other = ("link_1", Some([0.05, 0.0, 0.1]));
        assert_eq!(followed.ids(&[("link_5", Some([0.05, 0.0, 0.1])), other]), [0, 1]);
        // The same point, seen from the next link.
        let kinematics = &followed.kinematics;
        let pose = |name| kinematics.link_pose(&followed.robot, followed.robot.link(name).expect("a link"));
        let point = pose("link_5").transform_point(&Vector3::new(0.05, 0.0, 0.1));
        let seen = pose("link_6").inverse_transform_point(&point);
        assert_eq!(followed.ids(&[other, ("link_6", Some(seen.into()))]), [1, 0]);
        // Without points, links count.
        assert_eq!(followed.ids(&[("link_5", None), other]), [0, 1]);
        assert_eq!(followed.ids(&[("link_6", None), ("link_1", None)]), [0, 1]);
        assert_eq!(followed.ids(&[("link_1", None), ("link_3", None)]), [1, 2]);
    }

    #[test]
    fn a_single_contact_goes_on_wherever_it_is_thought_to_be() {
        let mut followed = Followed::new();
        assert_eq!(followed.ids(&[("link_2", None)]), [0]);
        assert_eq!(followed.ids(&[("link_7", Some([0.0, 0.0, 0.1]))]), [0]);
        followed.time += 1.0;
        assert_eq!(followed.ids(&[("link_7", Some([0.0, 0.0, 0.1]))]), [1]);
    }
}
