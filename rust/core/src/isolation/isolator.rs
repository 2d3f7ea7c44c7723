//! From an external torque to a contact: link, point and force (Vorndamme 2017, eqs. 22-26 and 29-30).

use std::sync::Arc;

use super::body_set::BodySet;
use super::force::{explain_force, identify_force};
use super::line::{best_first, LineCast};
use super::region::Region;
use super::result::{Candidate, Contact, Isolation};
use super::rows::{TorqueRows, WrenchRows};
use super::several::{Found, Scene, SeveralContacts};
use super::wrench::{estimate_wrench, for_each_column, WrenchEstimate};
use crate::detection::TipSearch;
use crate::error::{Error, Result};
use crate::robot::motion::stack;
use crate::robot::{Kinematics, Robot};

/// Rounds until the contact link stands still; ten, as in Vorndamme 2017.
const ROUNDS: usize = 10;
/// All hits of one instant that are kept.
const CANDIDATES: usize = 512;
/// A located contact explains the torques but for this (root mean square, in thresholds): more is no noise, but a
/// moment, a second contact or a wrong model.
const CONTRADICTION: f64 = 1.0;
/// A misfit that chance brings about once in a thousand times [thresholds].
const EXACT_FIT: f64 = 1e-3;
/// A contact is located if its force exceeds so many standard deviations of it, and its link's bounding radius so
/// many of the point's. A weaker force has the direction of the torques' errors, and feigns a certain point.
const SIGNIFICANCE: f64 = 3.0;
/// Solutions whose points are nearer than this agree [m].
const SAME_POINT: f64 = 0.005;

/// Settings of a [`ContactIsolator`].
#[derive(Debug, Clone)]
pub struct IsolatorOptions {
    /// Per velocity variable, or one for all [Nm, N]. Also the scale of the torques' errors.
    pub torque_threshold: Vec<f64>,
    /// Contacts reported at most.
    pub max_contacts: usize,
    /// Whether forces push on the surface (they may pull otherwise, and the point stays open).
    pub pushing: bool,
}

impl Default for IsolatorOptions {
    fn default() -> Self {
        Self { torque_threshold: vec![1e-3], max_contacts: 5, pushing: true }
    }
}

/// Finds the contact that explains an external torque.
#[derive(Debug, Clone)]
pub struct ContactIsolator {
    robot: Arc<Robot>,
    threshold: Vec<f64>,
    max_contacts: usize,
    pushing: bool,
    kinematics: Kinematics,
    tips: TipSearch,
    bodies: BodySet,
    line: LineCast,
    region: Region,
    rows: TorqueRows,
    several: SeveralContacts,
    near: Vec<usize>,
    displaced: Vec<Candidate>,
    unexplained: Vec<f64>,
    isolation: Isolation,
}

impl ContactIsolator {
    /// An isolator for a robot.
    ///
    /// # Errors
    /// [`Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: &IsolatorOptions) -> Result<Self> {
        let threshold = crate::detection::check_threshold(&robot, &options.torque_threshold)?;
        if options.max_contacts == 0 {
            return Err(Error::Input("max_contacts: must be at least 1".into()));
        }
        let isolation = Isolation {
            contacts: Vec::with_capacity(options.max_contacts),
            candidates: Vec::with_capacity(CANDIDATES),
            link_candidates: Vec::with_capacity(robot.links().len()),
            ..Isolation::default()
        };
        Ok(Self {
            threshold,
            max_contacts: options.max_contacts,
            pushing: options.pushing,
            kinematics: Kinematics::new(&robot),
            tips: TipSearch::new(&robot),
            bodies: BodySet::new(&robot),
            line: LineCast::new(),
            region: Region::whole(&robot),
            rows: TorqueRows::new(&robot),
            several: SeveralContacts::new(&robot, options.max_contacts),
            near: Vec::with_capacity(robot.links().len()),
            displaced: Vec::with_capacity(CANDIDATES),
            unexplained: vec![0.0; robot.nv()],
            isolation,
            robot,
        })
    }

    /// Contacts that explain the external torque `(nv,)` at the configuration `q`.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub fn isolate(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<&Isolation> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
        let mut kinematics = std::mem::replace(&mut self.kinematics, Kinematics::empty());
        kinematics.set_configuration(&self.robot, q);
        self.isolate_at(&kinematics, tau_ext);
        self.kinematics = kinematics;
        Ok(&self.isolation)
    }

    /// The same with poses that are known already.
    pub(crate) fn isolate_at(&mut self, kinematics: &Kinematics, tau_ext: &[f64]) -> &Isolation {
        self.isolation.clear();
        self.unexplained.copy_from_slice(tau_ext);
        let threshold = &self.threshold;
        let tips = self.tips.find(&self.robot, |k| tau_ext[k].abs() > threshold[k]).len();
        match tips {
            0 => {}
            1 if self.is_single(kinematics, self.tips.tips()[0], tau_ext) => {
                self.isolate_single(kinematics, self.tips.tips()[0], tau_ext);
            }
            _ if self.isolate_several(kinematics, tau_ext) => {}
            1 => self.isolate_single(kinematics, self.tips.tips()[0], tau_ext),
            _ => self.name_links(kinematics, tau_ext),
        }
        self.isolation.residual = self.unexplained.iter().map(|x| x * x).sum::<f64>().sqrt();
        &self.isolation
    }

    /// The answer of the last call.
    pub fn isolation(&self) -> &Isolation {
        &self.isolation
    }

    /// Forgets the last answer.
    pub fn clear(&mut self) {
        self.isolation.clear();
    }

    /// Whether one force explains the torques but for rounding; also where too few joints feel it to tell.
    fn is_single(&self, kinematics: &Kinematics, tip: usize, tau_ext: &[f64]) -> bool {
        let wrench = estimate_wrench(&self.robot, kinematics, tip, tau_ext, &self.threshold);
        wrench.rank < 6 || wrench.misfit() <= EXACT_FIT
    }

    /// Several forces that explain the torques; false where none are found, or one force explains them well enough.
    fn isolate_several(&mut self, kinematics: &Kinematics, tau_ext: &[f64]) -> bool {
        let scene = Scene { robot: &self.robot, kinematics, region: &self.region };
        self.rows.set(&self.robot, kinematics, tau_ext, &self.threshold);
        let solved = self.several.solve_exactly(scene, &mut self.rows);
        if !(solved && self.several.verified) {
            self.rows.set(&self.robot, kinematics, tau_ext, &self.threshold);
            if let [tip] = self.tips.tips() {
                let mut rows = WrenchRows::new();
                for joint in self.region.chain(&self.robot, *tip) {
                    self.rows.push_joint(&self.robot, joint, &mut rows);
                }
                if WrenchEstimate::from_rows(rows, nalgebra::Vector3::zeros()).misfit() <= CONTRADICTION {
                    return false;
                }
            }
            if !solved && !self.several.solve_roughly(scene, &self.rows, self.tips.tips()) {
                return false;
            }
        }
        self.rows.set(&self.robot, kinematics, tau_ext, &self.threshold);
        self.several.identify(scene, &self.rows);
        self.report_several(kinematics);
        true
    }

    /// Contacts that were found together, farthest from the base first.
    fn report_several(&mut self, kinematics: &Kinematics) {
        for index in 0..self.several.found.len() {
            let found = self.several.found[index].clone();
            self.report_found(kinematics, &found, true);
        }
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
        self.isolation.rank_deficit = self.several.rank_deficit;
        // Tolerances are wider than the thresholds; what contradicts those is not located.
        if self.unexplained_share() > CONTRADICTION {
            self.isolation.contacts.iter_mut().for_each(|contact| contact.located = false);
        }
    }

    /// Root mean square of what is not explained, in thresholds.
    fn unexplained_share(&self) -> f64 {
        let squares =
            self.unexplained.iter().zip(&self.threshold).map(|(torque, limit)| (torque / limit).powi(2));
        (squares.sum::<f64>() / self.threshold.len() as f64).sqrt()
    }

    fn report_found(&mut self, kinematics: &Kinematics, found: &Found, determined: bool) {
        let (wrench, hit) = (&found.wrench, &found.hit);
        let robot = self.robot.clone();
        let body = robot.links[hit.link].body;
        let at = hit.point - kinematics.origin;
        self.near.clear();
        self.near.extend_from_slice(robot.links_of_body(body));
        let neighbours = (1..robot.body_count())
            .filter(|other| robot.parent_body(*other) == body || *other == robot.parent_body(body));
        self.near.extend(neighbours.flat_map(|other| robot.links_of_body(other)));
        explain_force(&robot, kinematics, body, &at, &found.force, &mut self.unexplained);
        let point_std = self.spread(kinematics, wrench, hit);
        let size = robot.links[hit.link].surface.as_ref().map_or(0.0, |surface| surface.bounding_sphere().1);
        let candidates = self.isolation.contacts.last().map_or(0, |last| last.candidates.end);
        if self.isolation.candidates.len() == candidates {
            self.isolation.candidates.push(*hit);
        }
        let pose = kinematics.link_pose(&robot, hit.link);
        let mut contact = Contact::unlocated(hit.link);
        contact.point = hit.point;
        contact.point_local = pose.inverse_transform_point(&hit.point);
        contact.normal = hit.normal;
        contact.force = found.force;
        contact.wrench = stack(&found.force, &(hit.point - pose.translation).cross(&found.force));
        contact.point_std = point_std;
        contact.candidates = candidates..self.isolation.candidates.len();
        contact.located = determined && self.pushing && SIGNIFICANCE * point_std < size;
        self.isolation.contacts.push(contact);
        self.isolation.link_candidates.push(hit.link);
    }

    /// A force on one branch: steps 1 to 4, repeated with the link that was hit.
    fn isolate_single(&mut self, kinematics: &Kinematics, tip: usize, tau_ext: &[f64]) {
        let mut body = tip;
        for _ in 0..ROUNDS {
            let wrench = estimate_wrench(&self.robot, kinematics, body, tau_ext, &self.threshold);
            self.isolation.rank_deficit = 6 - wrench.rank;
            // Also where the comparison fails for want of a number.
            let significant = SIGNIFICANCE * wrench.force_spread() < 1.0;
            if wrench.rank < 6 || !significant {
                if body == tip && wrench.rank == 5 && self.isolate_behind(kinematics, tip, tau_ext) {
                    return;
                }
                self.name_link(tip);
                self.isolation.candidates.clear();
                // The torques do not exclude the links behind: a line can cross their joints' axes.
                self.bodies.grow_all(&self.robot, tip);
                self.isolation.link_candidates.clear();
                self.isolation.link_candidates.extend(self.bodies.links(&self.robot));
                self.explain(kinematics, body, &wrench);
                return;
            }
            self.bodies.grow(&self.robot, kinematics, tip, &wrench, tau_ext, &self.threshold);
            let hit = self.cast(kinematics, &wrench).or_else(|| {
                self.bodies.grow_all(&self.robot, tip);
                self.cast(kinematics, &wrench)
            });
            let Some(hit) = hit else {
                self.name_link(tip);
                self.report_wrench(kinematics, &wrench);
                self.explain(kinematics, body, &wrench);
                return;
            };
            let hit_body = self.robot.links[hit.link].body;
            if hit_body == body {
                self.report_point(kinematics, &wrench, &hit, tau_ext);
                return;
            }
            body = hit_body;
        }
        // Two links that take turns: the link is open.
        self.name_link(tip);
    }

    /// The torques up to `tip` leave one component of the wrench open. With the silence of the joints behind, a body
    /// there may be determined: a force on it whose line crosses those joints' axes. Only an exact fit tells it from
    /// a force on `tip`, where such a coincidence has no reason (with more components open, it often has).
    fn isolate_behind(&mut self, kinematics: &Kinematics, tip: usize, tau_ext: &[f64]) -> bool {
        for body in tip + 1..self.robot.body_count() {
            if !self.robot.chain(body).contains(&tip) || self.robot.links_of_body(body).is_empty() {
                continue;
            }
            let wrench = estimate_wrench(&self.robot, kinematics, body, tau_ext, &self.threshold);
            if wrench.rank < 6 || wrench.misfit() > EXACT_FIT {
                continue;
            }
            self.bodies.grow(&self.robot, kinematics, body, &wrench, tau_ext, &self.threshold);
            if let Some(hit) = self.cast(kinematics, &wrench) {
                if self.robot.links[hit.link].body == body {
                    self.isolation.rank_deficit = 0;
                    self.report_point(kinematics, &wrench, &hit, tau_ext);
                    return true;
                }
            }
        }
        false
    }

    /// Casts the line of action on the links in question; the first hit where the force enters.
    fn cast(&mut self, kinematics: &Kinematics, wrench: &WrenchEstimate) -> Option<Candidate> {
        let Isolation { candidates, link_candidates, .. } = &mut self.isolation;
        candidates.clear();
        link_candidates.clear();
        link_candidates.extend(self.bodies.links(&self.robot));
        let (start, direction) = wrench.line_of_action()?;
        for &link in link_candidates.iter() {
            self.line.cast(&self.robot, kinematics, link, &start, &direction, candidates);
        }
        best_first(candidates);
        let best = candidates.first().copied().filter(|hit| hit.pushing)?;
        if let Some(position) = link_candidates.iter().position(|link| *link == best.link) {
            link_candidates[..=position].rotate_right(1);
        }
        Some(best)
    }

    /// The contact is at `hit`: identify the force there and judge how far both can be trusted.
    fn report_point(
        &mut self,
        kinematics: &Kinematics,
        wrench: &WrenchEstimate,
        hit: &Candidate,
        tau_ext: &[f64],
    ) {
        let robot = &self.robot;
        let body = robot.links[hit.link].body;
        let at = hit.point - kinematics.origin;
        // A full-rank wrench leaves the force regular; keep the wrench's force should rounding say otherwise.
        let force =
            identify_force(robot, kinematics, body, &at, tau_ext, &self.threshold).unwrap_or(wrench.force);
        explain_force(robot, kinematics, body, &at, &force, &mut self.unexplained);
        let consistent = wrench.misfit() <= CONTRADICTION && self.unexplained_share() <= CONTRADICTION;
        self.near.clone_from(&self.isolation.link_candidates);
        let point_std = self.spread(kinematics, wrench, hit);
        let (robot, link) = (&self.robot, &self.robot.links[hit.link]);
        let size = link.surface.as_ref().map_or(0.0, |surface| surface.bounding_sphere().1);

        let pose = kinematics.link_pose(robot, hit.link);
        let mut contact = Contact::unlocated(hit.link);
        contact.point = hit.point;
        contact.point_local = pose.inverse_transform_point(&hit.point);
        contact.normal = hit.normal;
        contact.force = force;
        contact.wrench = stack(&force, &(hit.point - pose.translation).cross(&force));
        contact.point_std = point_std;
        contact.candidates = 0..self.isolation.candidates.len();
        contact.located = self.pushing && SIGNIFICANCE * point_std < size && consistent;
        self.isolation.contacts.push(contact);
    }

    /// Standard deviation of the point [m]: of the line across the surface, or as far as lines displaced by twice
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
    fn report_wrench(&mut self, kinematics: &Kinematics, wrench: &WrenchEstimate) {
        let all = 0..self.isolation.candidates.len();
        if let Some(contact) = self.isolation.contacts.last_mut() {
            let origin = kinematics.link_pose(&self.robot, contact.link).translation - kinematics.origin;
            contact.force = wrench.force;
            let moment = wrench.moment + (wrench.reference - origin).cross(&wrench.force);
            contact.wrench = stack(&wrench.force, &moment);
            contact.candidates = all;
        }
    }

    /// Forces on several branches: the links are named, the points stay open.
    fn name_links(&mut self, kinematics: &Kinematics, tau_ext: &[f64]) {
        for index in 0..self.tips.tips().len() {
            let tip = self.tips.tips()[index];
            let wrench = estimate_wrench(&self.robot, kinematics, tip, tau_ext, &self.threshold);
            self.isolation.rank_deficit += 6 - wrench.rank;
            self.name_link(tip);
        }
    }

    /// A contact on the body `tip`, its point open.
    fn name_link(&mut self, tip: usize) {
        let links = self.robot.links_of_body(tip);
        for &link in links {
            if !self.isolation.link_candidates.contains(&link) {
                self.isolation.link_candidates.push(link);
            }
        }
        let named = links.first().copied().or_else(|| self.nearest_touchable(tip));
        if let Some(link) = named {
            if self.isolation.contacts.len() < self.max_contacts {
                self.isolation.contacts.push(Contact::unlocated(link));
            }
        }
    }

    /// Of a body without surface: the first touchable link behind it, else before it.
    fn nearest_touchable(&mut self, body: usize) -> Option<usize> {
        self.bodies.grow_all(&self.robot, body);
        let behind = self.bodies.links(&self.robot).next();
        behind.or_else(|| {
            let before = self.robot.chain(body).iter().rev();
            before.flat_map(|body| self.robot.links_of_body(*body)).copied().next()
        })
    }

    /// Takes what a wrench on `body` explains out of the unexplained torque.
    fn explain(&mut self, kinematics: &Kinematics, body: usize, wrench: &WrenchEstimate) {
        let Self { robot, unexplained, .. } = self;
        for_each_column(robot, kinematics, body, &wrench.reference, |k, column| {
            unexplained[k] -= wrench.torque_on(&column);
        });
    }
}
