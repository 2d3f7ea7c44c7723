//! Where a line of action enters a body, or one behind it.

use nalgebra::Vector3;

use super::found::{Entry, Scene};
use super::line::{best_first, LineCast};
use super::result::Candidate;
use super::rows::{TorqueRows, SILENT};
use super::wrench::WrenchEstimate;

/// Hits of one line that are looked at.
const HITS: usize = 256;

/// Chi-square of a line that does not enter its body unless it is displaced by three standard deviations.
const MISSED: f64 = 9.0;
/// Parts of the way to the middle of a link that a line is displaced by: its edge may be nearer.
const PARTS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// Workspace.
#[derive(Debug, Clone)]
pub(super) struct Caster {
    line: LineCast,
    hits: Vec<Candidate>,
}

impl Caster {
    pub fn new() -> Self {
        Self { line: LineCast::new(), hits: Vec::with_capacity(HITS) }
    }

    /// Whether hits of a line were lost since this was asked last.
    pub fn take_overflow(&mut self) -> bool {
        self.line.take_overflow()
    }

    /// Where the line of action enters the body.
    pub fn hit_on(&mut self, scene: Scene, body: usize, wrench: &WrenchEstimate) -> Option<Entry> {
        let (start, direction) = wrench.line_of_action()?;
        self.hit_along(scene, body, &start, &direction)
    }

    fn hit_along(
        &mut self,
        scene: Scene,
        body: usize,
        start: &Vector3<f64>,
        direction: &Vector3<f64>,
    ) -> Option<Entry> {
        self.hits.clear();
        for link in scene.region.links_of(scene.robot, body) {
            self.line.cast(scene.robot, scene.kinematics, link, start, direction, &mut self.hits);
        }
        best_first(&mut self.hits);
        Entry::of(&self.hits)
    }

    /// The same for the line, or for one that its errors displace towards the body, and the chi-square of that.
    pub fn hit_displaced(
        &mut self,
        scene: Scene,
        body: usize,
        wrench: &WrenchEstimate,
    ) -> (Option<Entry>, f64) {
        let hit = self.hit_on(scene, body, wrench);
        let Some((start, direction)) = wrench.line_of_action().filter(|_| hit.is_none()) else {
            return (hit, 0.0);
        };
        let mut best = (None, MISSED);
        for link in scene.region.links_of(scene.robot, body) {
            let Some(middle) = scene.middle(link) else { continue };
            let at = start + direction * direction.dot(&(middle - start));
            let [far, near] = wrench.principal_displacements(&at);
            let [along_far, along_near] = [far, near]
                .map(|displacement| displacement.dot(&(middle - at)) / displacement.norm_squared());
            for across in [0.0, 1.0] {
                for part in PARTS {
                    let [far_part, near_part] = [part * along_far, part * across * along_near];
                    let chi_square = far_part * far_part + near_part * near_part;
                    if chi_square >= best.1 || chi_square.is_nan() {
                        continue;
                    }
                    let start = start + far * far_part + near * near_part;
                    let hit = self.hit_along(scene, body, &start, &direction);
                    if hit.is_some() {
                        best = (hit, chi_square);
                    }
                }
            }
        }
        best
    }

    /// The same, or on a body behind whose joints feel what the wrench would cause, but for `limit`.
    pub fn hit_behind(
        &mut self,
        scene: Scene,
        rows: &TorqueRows,
        body: usize,
        wrench: &WrenchEstimate,
        limit: f64,
    ) -> Option<Entry> {
        let hit = self.hit_on(scene, body, wrench);
        if hit.is_some() {
            return hit;
        }
        let robot = scene.robot;
        let agrees = |joint: usize| rows.explains(robot, joint, wrench, limit.max(SILENT));
        let behind = |other: usize| {
            let mut chain = robot.chain(other).iter().skip_while(|joint| **joint != body).skip(1).peekable();
            chain.peek().is_some() && chain.all(|joint| scene.region.joints[*joint] && agrees(*joint))
        };
        let mut best: Option<Entry> = None;
        for other in body + 1..robot.body_count() {
            if behind(other) {
                let hit = self.hit_on(scene, other, wrench);
                best = best.into_iter().chain(hit).min_by(|a, b| a.hit.distance.total_cmp(&b.hit.distance));
            }
        }
        best
    }
}
