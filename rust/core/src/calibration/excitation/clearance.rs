//! Whether a robot is clear of itself and of the ground under its base.

use nalgebra::Vector3;

use super::cover::{Cover, FINE, USUAL};
use super::gap::{Gap, Kept};
use super::limits::Limits;
use super::motion::{configuration, Move};
use crate::math::random::Stream;
use crate::robot::{JointKind, Kinematics, LinkIndex, Robot, WORLD};
use crate::spatial::Pose;
use crate::surface::Surface;

/// Larger distances need not be known (m).
const FAR: f64 = 0.2;
/// Instants of a move that are looked at first.
const COARSE: u32 = 12;
/// Random poses that show which links always touch.
const PROBES: u64 = 40;
/// What is too near in more of the poses is so by design.
const ALWAYS: f64 = 0.9;

/// What must be far from what.
#[derive(Debug, Clone, Copy)]
enum Between {
    /// Samples of a link and the surface of another one.
    Links { sampled: usize, other: usize, kept: Kept },
    /// Samples of a link and the ground.
    Ground { sampled: usize },
}

impl Between {
    /// Steps along a motion are at least so long (m), so that their number is bounded.
    fn shortest_step(self) -> f64 {
        let kept = match self {
            Between::Links { kept, .. } => kept,
            Between::Ground { .. } => Kept::Clear,
        };
        0.5 * kept.margin()
    }
}

/// A distance to be kept.
#[derive(Debug, Clone)]
struct Check {
    between: Between,
    /// Joints that change it, and by how much at most (m per rad, m per m).
    levers: Vec<(usize, f64)>,
}

/// What is checked of a robot with a fixed base, and space for it.
#[derive(Debug, Clone)]
pub(super) struct Clearance {
    links: Vec<LinkIndex>,
    covers: Vec<Cover>,
    /// For links that are near others by design.
    fine: Vec<Option<Cover>>,
    checks: Vec<Check>,
    /// Pairs that touch by design.
    touching: Vec<(usize, usize)>,
    up: Vector3<f64>,
    ground: f64,
    kinematics: Kinematics,
    poses: Vec<Pose>,
    q: Vec<f64>,
}

impl Clearance {
    pub fn new(robot: &Robot, limits: &Limits, stream: Stream) -> Self {
        let links = robot.touchable_links().to_vec();
        let (up, ground) = ground(robot, &links).unwrap_or((Vector3::z(), f64::NEG_INFINITY));
        let mut clearance = Clearance {
            covers: links.iter().map(|link| Cover::new(surface(robot, *link), USUAL)).collect(),
            fine: vec![None; links.len()],
            poses: vec![Pose::identity(); links.len()],
            checks: checks(robot, limits, &links, ground.is_finite()),
            touching: vec![],
            up,
            ground,
            kinematics: Kinematics::new(robot),
            q: vec![],
            links,
        };
        clearance.adapt_to_design(robot, limits, stream);
        clearance
    }

    /// Names of the links with a surface whose distance is not checked though they are not fixed to each other.
    pub fn unchecked(&self, robot: &Robot) -> Vec<(String, String)> {
        let mut pairs = self.touching.clone();
        for (one, link) in self.links.iter().enumerate() {
            for (other, beyond) in self.links.iter().enumerate().skip(one + 1) {
                if are_neighbours(robot, *link, *beyond) {
                    pairs.push((one, other));
                }
            }
        }
        pairs.sort_unstable();
        let name = |link: usize| robot[self.links[link]].name.clone();
        pairs.into_iter().map(|(one, other)| (name(one), name(other))).collect()
    }

    /// Whether a pose is clear; also where a link is inside another one.
    pub fn allows_pose(&mut self, robot: &Robot, positions: &[f64]) -> bool {
        self.set(robot, positions.iter().copied());
        !self.checks.iter().any(|check| self.violates(robot, check.between))
    }

    /// Whether a move is clear that starts where a pose is.
    pub fn allows_move(&mut self, robot: &Robot, part: &Move) -> bool {
        // Most moves that are not clear are found by these.
        for step in 1..=COARSE {
            self.set_at(robot, part, part.duration * f64::from(step) / f64::from(COARSE));
            if self.checks.iter().any(|check| self.distance(robot, check.between, 0.0) < 0.0) {
                return false;
            }
        }
        let speeds: Vec<f64> = (0..robot.nv()).map(|joint| part.peak_speed(joint)).collect();
        (0..self.checks.len()).all(|check| self.stays_clear(robot, part, &speeds, check))
    }

    /// Whether a distance is kept throughout a move: by steps within which it cannot be used up.
    fn stays_clear(&mut self, robot: &Robot, part: &Move, speeds: &[f64], check: usize) -> bool {
        let Check { between, levers } = &self.checks[check];
        let (between, speed) =
            (*between, levers.iter().map(|(joint, lever)| speeds[*joint] * lever).sum::<f64>());
        let mut time = 0.0;
        while speed > 0.0 && time < part.duration {
            self.set_at(robot, part, time);
            let distance = self.distance(robot, between, FAR);
            if distance < 0.0 {
                return false;
            }
            time += distance.max(between.shortest_step()) / speed;
        }
        true
    }

    fn set_at(&mut self, robot: &Robot, part: &Move, time: f64) {
        self.set(robot, (0..robot.nv()).map(|joint| part.joint(joint, time)[0]));
    }

    fn set(&mut self, robot: &Robot, positions: impl Iterator<Item = f64>) {
        configuration(robot, positions, &mut self.q);
        self.kinematics.set_configuration(robot, &self.q);
        for (pose, link) in self.poses.iter_mut().zip(&self.links) {
            *pose = self.kinematics.link_pose(robot, *link);
        }
    }

    fn violates(&self, robot: &Robot, between: Between) -> bool {
        self.distance(robot, between, 0.0) < 0.0
            || matches!(between, Between::Links { sampled, other, .. } if
                self.gap(robot, [sampled, other]).is_inside() || self.gap(robot, [other, sampled]).is_inside())
    }

    /// What is left of the clearance (m), or less than that where it is more than `enough`.
    fn distance(&self, robot: &Robot, between: Between, enough: f64) -> f64 {
        match between {
            Between::Links { sampled, other, kept } => {
                self.gap(robot, [sampled, other]).left(kept, self.fine[sampled].as_ref(), enough)
            }
            Between::Ground { sampled } => self.height(sampled),
        }
    }

    fn gap<'a>(&'a self, robot: &'a Robot, [sampled, other]: [usize; 2]) -> Gap<'a> {
        Gap {
            cover: &self.covers[sampled],
            surfaces: [sampled, other].map(|link| surface(robot, self.links[link])),
            poses: [&self.poses[sampled], &self.poses[other]],
        }
    }

    fn height(&self, link: usize) -> f64 {
        let pose = &self.poses[link];
        let above = |point: &Vector3<f64>| self.up.dot(&pose.transform_point(point)) - self.ground;
        let mut least = f64::INFINITY;
        for group in &self.covers[link].groups {
            if above(&group.center) - group.radius < least {
                least = group.points.iter().map(above).fold(least, f64::min);
            }
        }
        least - Kept::Clear.margin()
    }

    /// Links that are near each other in almost all poses are so by design, and keep a smaller distance; they are left out only
    /// where they cross each other in almost all poses.
    fn adapt_to_design(&mut self, robot: &Robot, limits: &Limits, stream: Stream) {
        let mut near = std::mem::take(&mut self.checks);
        for kept in [Kept::Clear, Kept::Tight, Kept::Apart] {
            for check in &mut near {
                if let Between::Links { sampled, kept: own, .. } = &mut check.between {
                    *own = kept;
                    if kept == Kept::Tight {
                        let surface = surface(robot, self.links[*sampled]);
                        self.fine[*sampled].get_or_insert_with(|| Cover::new(surface, FINE));
                    }
                }
            }
            let mut counts = self.violations(robot, limits, &near, stream).into_iter();
            near.retain(|check| {
                let kept = counts.next().is_some_and(|count| count as f64 <= ALWAYS * PROBES as f64);
                if kept {
                    self.checks.push(check.clone());
                }
                !kept && matches!(check.between, Between::Links { .. })
            });
        }
        for check in near {
            if let Between::Links { sampled, other, .. } = check.between {
                self.touching.push((sampled.min(other), sampled.max(other)));
            }
        }
    }

    /// In how many random poses distances are too small.
    fn violations(&mut self, robot: &Robot, limits: &Limits, checks: &[Check], stream: Stream) -> Vec<usize> {
        let mut counts = vec![0; checks.len()];
        for probe in 0..PROBES {
            self.set(robot, limits.random(&stream.fork(probe)).into_iter());
            for (check, count) in checks.iter().zip(&mut counts) {
                *count += usize::from(self.violates(robot, check.between));
            }
        }
        counts
    }
}

fn surface(robot: &Robot, link: LinkIndex) -> &Surface {
    // Of touchable links only.
    robot[link].surface.as_deref().unwrap_or_else(|| unreachable!("a link without surface"))
}

/// Whether one joint is between two links.
fn are_neighbours(robot: &Robot, one: LinkIndex, other: LinkIndex) -> bool {
    let (one, other) = (robot[one].body, robot[other].body);
    one != WORLD && robot.parent_body(one) == other || other != WORLD && robot.parent_body(other) == one
}

/// All distances that joints change, but between neighbours; the smaller link is sampled.
fn checks(robot: &Robot, limits: &Limits, links: &[LinkIndex], ground: bool) -> Vec<Check> {
    let mut checks = vec![];
    let levers: Vec<Vec<(usize, f64)>> = links.iter().map(|link| levers(robot, limits, *link)).collect();
    for (one, link) in links.iter().enumerate() {
        for (other, beyond) in links.iter().enumerate().skip(one + 1) {
            if robot[*link].body == robot[*beyond].body || are_neighbours(robot, *link, *beyond) {
                continue;
            }
            let larger = surface(robot, *link).area() > surface(robot, *beyond).area();
            let [sampled, other] = if larger { [other, one] } else { [one, other] };
            // Joints that move both move them alike.
            let [a, b] = [sampled, other].map(|link| &levers[link]);
            let alone = |(joint, _): &&(usize, f64), others: &[(usize, f64)]| {
                !others.iter().any(|(also, _)| also == joint)
            };
            let levers =
                a.iter().filter(|lever| alone(lever, b)).chain(b.iter().filter(|lever| alone(lever, a)));
            checks.push(Check {
                between: Between::Links { sampled, other, kept: Kept::Clear },
                levers: levers.copied().collect(),
            });
        }
        if ground && robot[*link].body != WORLD {
            checks.push(Check { between: Between::Ground { sampled: one }, levers: levers[one].clone() });
        }
    }
    checks
}

/// The joints that move a link, and how far at most from their origin its points are (m; 1 for a sliding joint).
fn levers(robot: &Robot, limits: &Limits, link: LinkIndex) -> Vec<(usize, f64)> {
    let (center, radius) = surface(robot, link).bounding_sphere();
    let mut far = robot[link].placement().transform_point(&center).norm() + radius;
    let mut levers = vec![];
    for &body in robot.chain(robot[link].body).iter().rev() {
        let joint = &robot.bodies[body];
        far += if joint.kind == JointKind::Prismatic {
            levers.push((joint.idx_v, 1.0));
            limits.range[joint.idx_v].iter().fold(0.0, |far: f64, position| far.max(position.abs()))
        } else {
            levers.push((joint.idx_v, far));
            0.0
        };
        far += joint.placement.translation.norm();
    }
    levers
}

/// The direction up, and the height along it (m) of the lowest point of what is fixed to the world: the plane that the robot
/// stands on. None where nothing is fixed to the world, without gravity, or where the robot hangs below it.
fn ground(robot: &Robot, links: &[LinkIndex]) -> Option<(Vector3<f64>, f64)> {
    let up = (-robot.gravity()).try_normalize(1e-6)?;
    let mut kinematics = Kinematics::new(robot);
    kinematics.set_configuration(robot, &robot.neutral());
    let mut height = f64::INFINITY;
    for link in links.iter().filter(|link| robot[**link].body == WORLD) {
        let pose = kinematics.link_pose(robot, *link);
        let heights = surface(robot, *link).vertices().iter();
        height = heights.map(|p| up.dot(&pose.transform_point(&Vector3::from(*p)))).fold(height, f64::min);
    }
    let hangs = |body: usize| up.dot(&(kinematics.bodies[body].position + kinematics.origin)) < height;
    let hanging = (1..robot.body_count()).any(|body| robot.parent_body(body) == WORLD && hangs(body));
    (height.is_finite() && !hanging).then_some((up, height))
}
