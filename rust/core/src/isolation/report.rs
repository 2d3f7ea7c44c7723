//! From wrenches and hits to contacts, and how far they can be trusted.

use nalgebra::Vector3;

use super::force::{explain_force, identify_force};
use super::found::Found;
use super::isolator::{ContactIsolator, CONTRADICTION};
use super::result::{Candidate, Contact, ContactPlace};
use super::wrench::{WrenchEstimate, LINE_UNKNOWNS, ORIGIN};
use crate::math::chi_square::upper_limit;
use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, LinkIndex, Robot};
use crate::spatial::vector::stack;

/// One of several contacts is located if its point's standard deviation is less (m).
const SHARP: f64 = 0.01;
/// Radius that holds 90 % of a normal distribution, in standard deviations of the distance: at most this, which is for a
/// distribution along a line (for a circular one it is 1.52).
const RADIUS_90: f64 = 1.645;
/// Root mean square of the distance from one of two equally likely places, as a share of the distance between them.
const EQUALLY_LIKELY: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Solutions whose points are nearer than this agree (m).
const SAME_POINT: f64 = 0.005;

impl ContactIsolator {
    /// Contacts that were found one by one.
    pub(super) fn report_found_alone(&mut self, kinematics: &Kinematics) {
        for index in 0..self.several.found.len() {
            let found = self.several.found[index].clone();
            self.report_found(kinematics, &found, true);
        }
    }

    /// Contacts that were found together, farthest from the base first.
    pub(super) fn report_several(&mut self, kinematics: &Kinematics) {
        let first = self.isolation.contacts.len();
        let verified = self.several.verified && !self.several.open && !self.several.contradicted;
        self.report_found_alone(kinematics);
        for side in [1, 0] {
            let Some(best) = self.several.solutions.first() else { break };
            let found = best.contacts[side].clone();
            let others = self.several.solutions.iter().skip(1).map(|other| other.contacts[side].hit);
            let agree = others.clone().all(|hit| (hit.point - found.hit.point).norm() < SAME_POINT);
            let determined = agree && self.several.verified && !self.several.open;
            if !agree {
                self.isolation.candidates.push(found.hit);
                self.isolation.candidates.extend(others);
            }
            self.report_found(kinematics, &found, determined);
        }
        self.isolation.rank_deficit += self.several.rank_deficit;
        // Several forces share the redundant torques: what is not sharp may as well be the others' doing.
        for contact in &mut self.isolation.contacts[first..] {
            contact.located &= contact.place.is_some_and(|place| place.std < SHARP);
            contact.verified &= verified;
        }
        // Tolerances are wider than the thresholds; what contradicts those is not located.
        if self.several.contradicted || self.unexplained_share() > CONTRADICTION {
            self.isolation.contacts[first..].iter_mut().for_each(|contact| contact.located = false);
        }
    }

    /// Root mean square of what is not explained, in thresholds.
    fn unexplained_share(&self) -> f64 {
        let (mut squares, mut count) = (0.0, 0_u32);
        for body in (1..self.robot.body_count()).filter(|body| self.region.joints[*body]) {
            for k in self.robot.velocity_range(body) {
                squares += (self.unexplained[k] / self.limit[k]).powi(2);
                count += 1;
            }
        }
        (squares / f64::from(count.max(1))).sqrt()
    }

    /// A contact whose candidates beyond `hit` are at the end of the list already.
    pub(super) fn report_found(&mut self, kinematics: &Kinematics, found: &Found, determined: bool) {
        if self.isolation.contacts.len() == self.max_contacts {
            self.isolation.truncated = true;
            return;
        }
        let (wrench, hit) = (&found.wrench, &found.hit);
        let robot = self.robot.clone();
        let body = robot[hit.link].body;
        let at = hit.point - kinematics.origin;
        // Lines displaced by an error hit the same body, or the next.
        self.near.clear();
        let next = |other: &usize| {
            *other == body || robot.parent_body(*other) == body || *other == robot.parent_body(body)
        };
        let next = (1..robot.body_count()).filter(next);
        self.near.extend(next.flat_map(|other| self.region.links_of(&robot, other)));
        explain_force(&robot, kinematics, &self.region, body, &at, &found.force, &mut self.unexplained);
        let point_std = self.spread(kinematics, wrench, hit);
        let point_std = point_std.max(found.apart * EQUALLY_LIKELY);
        let candidates = self.isolation.contacts.last().map_or(0, |last| last.candidates.end);
        if self.isolation.candidates.len() == candidates {
            self.isolation.candidates.push(*hit);
        }
        let mut contact = contact_at(&robot, kinematics, hit, &found.force, point_std);
        contact.candidates = candidates..self.isolation.candidates.len();
        contact.located = determined && self.pushing && wrench.is_force() && self.is_near_enough(point_std);
        contact.verified = determined && wrench.is_redundant();
        self.isolation.contacts.push(contact);
        self.isolation.link_candidates.push(hit.link);
    }

    /// The contact is at `hit`: identify the force there and judge how far both can be trusted.
    pub(super) fn report_point(&mut self, kinematics: &Kinematics, wrench: &WrenchEstimate, hit: &Candidate) {
        let robot = &self.robot;
        let body = robot[hit.link].body;
        let at = hit.point - kinematics.origin;
        // A full-rank wrench leaves the force regular; keep the wrench's force should rounding say otherwise.
        let force =
            identify_force(robot, kinematics, body, &at, &self.residual, &self.limit).unwrap_or(wrench.force);
        explain_force(robot, kinematics, &self.region, body, &at, &force, &mut self.unexplained);
        let (misfit, checks) = wrench.chi_square();
        let outside = self.chi_square_outside(body);
        let torques = self.torque_count();
        let consistent = wrench.is_force()
            && misfit <= upper_limit(checks)
            && misfit + outside <= upper_limit(torques.saturating_sub(LINE_UNKNOWNS));
        self.near.clone_from(&self.isolation.link_candidates);
        let point_std = self.spread(kinematics, wrench, hit);
        let rivals = self.find_rivals(kinematics, wrench, hit);
        let point_std = point_std.max(rivals.distance * EQUALLY_LIKELY);
        let mut contact = contact_at(&self.robot, kinematics, hit, &force, point_std);
        contact.candidates = 0..self.isolation.candidates.len();
        contact.located = self.pushing && consistent && !rivals.open && self.is_near_enough(point_std);
        contact.verified = consistent && wrench.is_redundant();
        self.isolation.contacts.push(contact);
    }

    /// Whether 90 % of the places are within the distance asked for.
    fn is_near_enough(&self, point_std: f64) -> bool {
        RADIUS_90 * point_std <= self.locate_within
    }

    /// Standard deviation of the point (m): of the line across the surface, or as far as lines displaced by twice
    /// theirs hit elsewhere, past an edge or on another link.
    fn spread(&mut self, kinematics: &Kinematics, wrench: &WrenchEstimate, hit: &Candidate) -> f64 {
        let at = hit.point - kinematics.origin;
        let direction = wrench.force / wrench.force.norm();
        let displacements = wrench.displacements(&at);
        let grazing = hit.normal.dot(&direction).abs().max(f64::EPSILON);
        let mut spread = displacements[0].norm().hypot(displacements[1].norm()) / grazing;
        for displacement in displacements.iter().flat_map(|step| [step * 2.0, step * -2.0]) {
            self.displaced.clear();
            let start = at + displacement;
            for &link in &self.near {
                self.line.cast(&self.robot, kinematics, link, &start, &direction, &mut self.displaced);
            }
            let entering = self.displaced.iter().filter(|other| other.pushing);
            if let Some(other) = entering.min_by(|a, b| a.distance.total_cmp(&b.distance)) {
                spread = spread.max(0.5 * (other.point - hit.point).norm());
            }
        }
        spread
    }

    /// The line of action meets no surface where the force could enter: the wrench is known, the point is not.
    pub(super) fn report_wrench(&mut self, kinematics: &Kinematics, wrench: &WrenchEstimate) {
        let end = self.isolation.candidates.len();
        if let Some(contact) = self.isolation.contacts.last_mut() {
            let origin = kinematics.link_pose(&self.robot, contact.link).translation - kinematics.origin;
            let moment = wrench.moment + wrench.force.cross(&origin);
            contact.wrench = Some(stack(&wrench.force, &moment));
            contact.candidates.end = end;
        }
    }

    /// Forces on several branches: the links are named, the points stay open.
    pub(super) fn name_links(&mut self, kinematics: &Kinematics) {
        for index in 0..self.tips.tips().len() {
            let tip = self.tips.tips()[index];
            let wrench = self.estimate(kinematics, tip);
            self.isolation.rank_deficit += 6 - wrench.rank;
            self.name_link(tip);
        }
    }

    /// A contact on the body `tip`, its point open.
    pub(super) fn name_link(&mut self, tip: usize) {
        for link in self.region.links_of(&self.robot, tip) {
            if !self.isolation.link_candidates.contains(&link) {
                self.isolation.link_candidates.push(link);
            }
        }
        let own = self.region.links_of(&self.robot, tip).next();
        let named = own.or_else(|| self.nearest_touchable(tip));
        let Some(link) = named else { return };
        if self.isolation.contacts.len() == self.max_contacts {
            self.isolation.truncated = true;
            return;
        }
        self.isolation.contacts.push(Contact::unlocated(link));
    }

    /// Of a body without surface: the first touchable link behind it, else before it.
    fn nearest_touchable(&mut self, body: usize) -> Option<LinkIndex> {
        self.bodies.grow_all(&self.robot, &self.region, body);
        let behind = self.bodies.links(&self.robot, &self.region).next();
        behind.or_else(|| {
            let before = self.region.chain(&self.robot, body).rev();
            before.flat_map(|body| self.region.links_of(&self.robot, body)).next()
        })
    }

    /// Takes what a wrench on `body` explains out of the unexplained torque.
    pub(super) fn explain(&mut self, kinematics: &Kinematics, body: usize, wrench: &WrenchEstimate) {
        let Self { robot, unexplained, .. } = self;
        for_each_column(robot, kinematics, body, &ORIGIN, |k, column| {
            unexplained[k] -= wrench.torque_on(&column);
        });
    }
}

/// A contact with all that a point and a force there determine.
fn contact_at(
    robot: &Robot,
    kinematics: &Kinematics,
    hit: &Candidate,
    force: &Vector3<f64>,
    point_std: f64,
) -> Contact {
    let pose = kinematics.link_pose(robot, hit.link);
    Contact {
        place: Some(ContactPlace {
            point: hit.point,
            point_local: pose.inverse_transform_point(&hit.point),
            normal: hit.normal,
            std: point_std,
        }),
        wrench: Some(stack(force, &(hit.point - pose.translation).cross(force))),
        ..Contact::unlocated(hit.link)
    }
}
