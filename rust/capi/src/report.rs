//! What a monitor says of a tick.

use contactsense::isolation::Contact;
use contactsense::monitor::ContactReport;
use contactsense::nalgebra::Vector3;

/// Contacts in a report at most.
pub const CS_MAX_CONTACTS: usize = 8;

/// A contact. Numbers that are not known are NaN.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cs_contact {
    /// Index of the link, for `cs_robot_link_name`.
    pub link: usize,
    /// Whether 90 % of the places that explain the torques lie within `locate_within` of the point.
    pub located: bool,
    /// Whether redundant torques agree with the contacts of the report.
    pub verified: bool,
    /// Where it is, world frame (m).
    pub point: [f64; 3],
    /// Outward normal of the surface there, world frame.
    pub normal: [f64; 3],
    /// Force on the robot, world frame (N).
    pub force: [f64; 3],
    /// Force and moment on the robot at the link's origin, world axes (N, Nm).
    pub wrench: [f64; 6],
    /// Standard deviation of the point (m).
    pub point_std: f64,
    /// Probability that the contact is on this link.
    pub probability: f64,
    /// The ball of this radius about the point holds 90 % of the posterior (m).
    pub region_radius: f64,
    /// The same contact has the same number in all ticks, from 0 on; -1 where contacts are not followed.
    pub id: i64,
    /// When it began, since the first call (s).
    pub since: f64,
    /// Its largest force so far (N).
    pub peak_force: f64,
}

/// What a monitor says of a tick. The caller's memory: nothing in it has to be freed.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct cs_report {
    /// Since the first call (s).
    pub time: f64,
    /// How unlikely the torques are without contact, in standard deviations; NaN with thresholds for each joint.
    pub significance: f64,
    /// Whether there is a contact.
    pub collision: bool,
    /// Whether it began with this tick.
    pub onset: bool,
    /// Whether a torque that stood still became the bias.
    pub remainder_learned: bool,
    /// Whether there were more contacts, or explanations, than are reported.
    pub truncated: bool,
    pub contact_count: usize,
    pub contacts: [cs_contact; CS_MAX_CONTACTS],
    /// Room for `nv` numbers that the caller owns, or NULL: the external torque without bias (Nm, N).
    pub external_torque: *mut f64,
    /// The same without wanted contacts and stops of joints.
    pub collision_torque: *mut f64,
    /// Room for 6 numbers for each sensor, or NULL: the external wrench that it sees, world axes, at its origin; NaN where it
    /// is left out (N, Nm).
    pub wrenches: *mut f64,
}

impl cs_report {
    /// Takes on what a monitor reports.
    ///
    /// # Safety
    /// `external_torque` and `collision_torque` are null or have room for `nv` numbers, and `wrenches` is null or has room
    /// for 6 for each sensor.
    pub(crate) unsafe fn fill(&mut self, report: &ContactReport) {
        self.time = report.time;
        self.significance = report.significance.unwrap_or(f64::NAN);
        self.collision = report.collision;
        self.onset = report.onset;
        self.remainder_learned = report.remainder_learned;
        let contacts = &report.isolation.contacts;
        self.truncated = report.isolation.truncated || contacts.len() > CS_MAX_CONTACTS;
        self.contact_count = contacts.len().min(CS_MAX_CONTACTS);
        for (out, contact) in self.contacts.iter_mut().zip(contacts) {
            *out = cs_contact::new(contact);
        }
        for (out, torque) in [
            (self.external_torque, &report.external_torque),
            (self.collision_torque, &report.collision_torque),
        ] {
            if !out.is_null() {
                // SAFETY: there is room for `nv` numbers, as the caller promises, and it is none of ours.
                unsafe { out.copy_from_nonoverlapping(torque.as_ptr(), torque.len()) };
            }
        }
        if !self.wrenches.is_null() {
            for (sensor, wrench) in report.wrenches.iter().enumerate() {
                let wrench: [f64; 6] = wrench.map_or([f64::NAN; 6], Into::into);
                // SAFETY: there is room for 6 numbers for each sensor, as the caller promises.
                unsafe { self.wrenches.add(6 * sensor).copy_from_nonoverlapping(wrench.as_ptr(), 6) };
            }
        }
    }
}

impl cs_contact {
    fn new(contact: &Contact) -> Self {
        let numbers = |vector: Option<Vector3<f64>>| vector.map_or([f64::NAN; 3], Into::into);
        let place = contact.place;
        let posterior = contact.posterior.as_ref();
        let track = contact.track.as_ref();
        cs_contact {
            link: contact.link.get(),
            located: contact.located,
            verified: contact.verified,
            point: numbers(place.map(|place| place.point)),
            normal: numbers(place.map(|place| place.normal)),
            force: numbers(contact.force()),
            wrench: contact.wrench.map_or([f64::NAN; 6], Into::into),
            point_std: place.map_or(f64::NAN, |place| place.std),
            probability: posterior.map_or(f64::NAN, |posterior| posterior.probability),
            region_radius: posterior.map_or(f64::NAN, |posterior| posterior.region_radius),
            id: track.map_or(-1, |track| i64::try_from(track.id).unwrap_or(i64::MAX)),
            since: track.map_or(f64::NAN, |track| track.since),
            peak_force: track.map_or(f64::NAN, |track| track.peak_force),
        }
    }
}
