//! Which contact of a tick is which contact of the tick before.

use crate::isolation::{Contact, Track};
use crate::robot::LinkIndex;

/// Contacts that are known at a time.
const MOST: usize = 16;
/// A contact that no tick has shown for so long has ended (s).
const FORGOTTEN: f64 = 0.2;

#[derive(Debug, Clone, Copy)]
struct Known {
    link: LinkIndex,
    track: Track,
    last: f64,
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

    /// Names the contacts of a tick at `time` (s). A single one goes on as a single one, whatever its link is thought to be;
    /// of several, those on the same link go on.
    pub fn name(&mut self, contacts: &mut [Contact], time: f64) {
        self.known.retain(|known| time - known.last <= FORGOTTEN);
        let alone = contacts.len() == 1 && self.known.len() == 1;
        for contact in contacts {
            let force = contact.force().map_or(0.0, |force| force.norm());
            let found =
                self.known.iter().position(|known| alone || known.link == contact.link && known.last < time);
            let known = match found {
                Some(found) => &mut self.known[found],
                None if self.known.len() == MOST => continue,
                None => {
                    let track = Track { id: self.next, since: time, peak_force: 0.0 };
                    self.next += 1;
                    self.known.push(Known { link: contact.link, track, last: time });
                    let newest = self.known.len() - 1;
                    &mut self.known[newest]
                }
            };
            (known.link, known.last) = (contact.link, time);
            known.track.peak_force = known.track.peak_force.max(force);
            contact.track = Some(known.track);
        }
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
