//! Whether a robot is clear of itself and of the ground under its base.

use nalgebra::Vector3;

use super::cover::Cover;
use super::limits::Limits;
use super::motion::{configuration, Move};
use crate::math::random::Stream;
use crate::robot::{JointKind, Kinematics, LinkIndex, Robot, WORLD};
use crate::spatial::Pose;
use crate::surface::{RayHit, Surface};

/// Least distance of a link from others and from the ground (m).
const CLEARANCE: f64 = 0.01;
/// Larger distances need not be known (m).
const FAR: f64 = 0.15;
/// Steps along a motion are at least so long (m), so that their number is bounded.
const SHORTEST_STEP: f64 = 0.003;
/// Random poses that show which links always touch.
const PROBES: u64 = 40;
/// A pair that is too near in more of the poses touches by design.
const ALWAYS: f64 = 0.9;
/// Crossings of a line with a surface that are looked at.
const HITS: usize = 64;

/// A link whose samples are measured against the surface of another one.
#[derive(Debug, Clone, Copy)]
struct Pair {
    sampled: usize,
    other: usize,
}

/// Ground: heights along `up` are to stay above `height` (m).
#[derive(Debug, Clone)]
struct Ground {
    up: Vector3<f64>,
    height: f64,
    links: Vec<usize>,
}

/// What is checked of a robot with a fixed base, and space for it.
#[derive(Debug, Clone)]
pub(super) struct Clearance {
    links: Vec<LinkIndex>,
    covers: Vec<Cover>,
    pairs: Vec<Pair>,
    ground: Option<Ground>,
    /// Pairs that touch by design.
    touching: Vec<(usize, usize)>,
    /// Largest distance of a point from each joint's axis (m; 1 for a sliding joint).
    reach: Vec<f64>,
    kinematics: Kinematics,
    poses: Vec<Pose>,
    q: Vec<f64>,
}

impl Clearance {
    pub fn new(robot: &Robot, limits: &Limits, stream: Stream) -> Self {
        let links = robot.touchable_links().to_vec();
        let covers: Vec<Cover> = links.iter().map(|link| Cover::new(surface(robot, *link))).collect();
        let mut clearance = Clearance {
            poses: vec![Pose::identity(); links.len()],
            pairs: all_pairs(robot, &links),
            ground: ground(robot, &links),
            touching: vec![],
            reach: reach(robot, limits),
            kinematics: Kinematics::new(robot),
            q: vec![],
            links,
            covers,
        };
        clearance.leave_out_what_touches(robot, limits, stream);
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
        self.set(robot, positions);
        self.distance(robot) > 0.0 && !self.pairs.iter().any(|pair| self.is_inside(robot, *pair))
    }

    /// Whether a move is clear that starts where a pose is.
    pub fn allows_move(&mut self, robot: &Robot, part: &Move) -> bool {
        let speeds = (0..robot.nv()).map(|joint| part.peak_speed(joint) * self.reach[joint]);
        let speed: f64 = speeds.sum();
        let mut time = 0.0;
        loop {
            let positions: Vec<f64> = (0..robot.nv()).map(|joint| part.joint(joint, time)[0]).collect();
            self.set(robot, &positions);
            let distance = self.distance(robot);
            if distance <= 0.0 {
                return false;
            }
            if time >= part.duration || speed == 0.0 {
                return true;
            }
            // No two points come nearer to each other than by this.
            time = (time + distance.max(SHORTEST_STEP) / speed).min(part.duration);
        }
    }

    fn set(&mut self, robot: &Robot, positions: &[f64]) {
        configuration(robot, positions.iter().copied(), &mut self.q);
        self.kinematics.set_configuration(robot, &self.q);
        for (pose, link) in self.poses.iter_mut().zip(&self.links) {
            *pose = self.kinematics.link_pose(robot, *link);
        }
    }

    /// What is left of the clearance, at most `FAR` (m).
    fn distance(&self, robot: &Robot) -> f64 {
        let mut least = FAR;
        for pair in &self.pairs {
            least = least.min(self.pair_distance(robot, *pair, least));
            if least <= 0.0 {
                return least;
            }
        }
        if let Some(ground) = &self.ground {
            for &link in &ground.links {
                least = least.min(self.height(ground, link, least));
            }
        }
        least
    }

    /// The same of a pair, or `least` where that is less.
    fn pair_distance(&self, robot: &Robot, pair: Pair, least: f64) -> f64 {
        let cover = &self.covers[pair.sampled];
        let other = surface(robot, self.links[pair.other]);
        let [sampled, beyond] = [pair.sampled, pair.other].map(|link| &self.poses[link]);
        let bounds = |link: usize| {
            let (center, radius) = surface(robot, self.links[link]).bounding_sphere();
            (self.poses[link].transform_point(&center), radius)
        };
        let needed = CLEARANCE + cover.hole;
        let [(a, r), (b, s)] = [pair.sampled, pair.other].map(bounds);
        let mut least = least + needed;
        if (a - b).norm() - r - s > least {
            return least - needed;
        }
        for group in &cover.groups {
            let center = beyond.inverse_transform_point(&sampled.transform_point(&group.center));
            if (center - other.bounding_sphere().0).norm() - s - group.radius > least {
                continue;
            }
            let near = other.closest_point(&center);
            if near.distance - group.radius > least {
                continue;
            }
            let mut triangle = near.triangle;
            for point in &group.points {
                let point = beyond.inverse_transform_point(&sampled.transform_point(point));
                let near = other.closest_point_from(&point, triangle);
                triangle = near.triangle;
                least = least.min(near.distance);
            }
        }
        least - needed
    }

    /// The same of a link and the ground.
    fn height(&self, ground: &Ground, link: usize, least: f64) -> f64 {
        let pose = &self.poses[link];
        let mut least = least + CLEARANCE;
        let above = |point: &Vector3<f64>| ground.up.dot(&pose.transform_point(point)) - ground.height;
        for group in &self.covers[link].groups {
            if above(&group.center) - group.radius < least {
                least = group.points.iter().map(above).fold(least, f64::min);
            }
        }
        least - CLEARANCE
    }

    /// Whether a sample of one link lies inside the other one.
    fn is_inside(&self, robot: &Robot, pair: Pair) -> bool {
        [pair, Pair { sampled: pair.other, other: pair.sampled }].into_iter().any(|pair| {
            let Some(group) = self.covers[pair.sampled].groups.first() else { return false };
            let world = self.poses[pair.sampled].transform_point(&group.center);
            let point = self.poses[pair.other].inverse_transform_point(&world);
            let mut hits: Vec<RayHit> = Vec::with_capacity(HITS);
            surface(robot, self.links[pair.other]).cast_line_into(&point, &Vector3::z(), 0.0, &mut hits);
            hits.first().is_some_and(|hit| !hit.entering)
        })
    }

    /// Links that are too near to each other, or to the ground, in almost all poses are so by design.
    fn leave_out_what_touches(&mut self, robot: &Robot, limits: &Limits, stream: Stream) {
        let all = self.pairs.clone();
        let mut near = vec![0_u64; all.len()];
        let grounded = self.ground.as_ref().map_or(vec![], |ground| ground.links.clone());
        let mut low = vec![0_u64; grounded.len()];
        for probe in 0..PROBES {
            let random = stream.fork(probe);
            let place = |(joint, [lower, upper]): (usize, &[f64; 2])| {
                lower + (upper - lower) * random.uniform(joint as u64)
            };
            let positions: Vec<f64> = limits.range.iter().enumerate().map(place).collect();
            self.set(robot, &positions);
            for (pair, near) in all.iter().zip(&mut near) {
                let touches = self.pair_distance(robot, *pair, FAR) <= 0.0 || self.is_inside(robot, *pair);
                *near += u64::from(touches);
            }
            if let Some(ground) = &self.ground {
                for (link, low) in grounded.iter().zip(&mut low) {
                    *low += u64::from(self.height(ground, *link, FAR) <= 0.0);
                }
            }
        }
        let by_design = |count: u64| count as f64 > ALWAYS * PROBES as f64;
        let split = |keep: bool| {
            let chosen = all.iter().zip(&near).filter(move |(_, count)| by_design(**count) != keep);
            chosen.map(|(pair, _)| *pair)
        };
        self.pairs = split(true).collect();
        self.touching =
            split(false).map(|pair| (pair.sampled.min(pair.other), pair.sampled.max(pair.other))).collect();
        if let Some(ground) = &mut self.ground {
            ground.links = grounded
                .iter()
                .zip(&low)
                .filter(|(_, low)| !by_design(**low))
                .map(|(link, _)| *link)
                .collect();
        }
    }
}

fn surface(robot: &Robot, link: LinkIndex) -> &Surface {
    // Of touchable links only.
    robot[link].surface.as_deref().unwrap_or_else(|| unreachable!("a link without surface"))
}

/// Whether one joint, or none, is between two links.
fn are_neighbours(robot: &Robot, one: LinkIndex, other: LinkIndex) -> bool {
    let (one, other) = (robot[one].body, robot[other].body);
    one != other
        && (robot.parent_body(one) == other && one != WORLD
            || robot.parent_body(other) == one && other != WORLD)
}

/// All pairs of links that can move towards each other and are no neighbours; the smaller one is sampled.
fn all_pairs(robot: &Robot, links: &[LinkIndex]) -> Vec<Pair> {
    let mut pairs = vec![];
    for (one, link) in links.iter().enumerate() {
        for (other, beyond) in links.iter().enumerate().skip(one + 1) {
            if robot[*link].body == robot[*beyond].body || are_neighbours(robot, *link, *beyond) {
                continue;
            }
            let larger = surface(robot, *link).area() > surface(robot, *beyond).area();
            let [sampled, other] = if larger { [other, one] } else { [one, other] };
            pairs.push(Pair { sampled, other });
        }
    }
    pairs
}

/// The plane under the lowest point of what is fixed to the world, across gravity. None where there is no such point or no
/// gravity, or where the robot hangs below it.
fn ground(robot: &Robot, links: &[LinkIndex]) -> Option<Ground> {
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
    let moving = (0..links.len()).filter(|link| robot[links[*link]].body != WORLD).collect();
    (height.is_finite() && !hanging).then_some(Ground { up, height, links: moving })
}

/// For each joint, the largest distance from its origin to a point that it moves (m); 1 for a sliding joint.
fn reach(robot: &Robot, limits: &Limits) -> Vec<f64> {
    let mut beyond = vec![0.0_f64; robot.body_count()];
    for link in robot.links() {
        if let Some(surface) = &link.surface {
            let (center, radius) = surface.bounding_sphere();
            let far = link.placement.transform_point(&center).norm() + radius;
            beyond[link.body] = beyond[link.body].max(far);
        }
    }
    for body in (1..robot.body_count()).rev() {
        let joint = &robot.bodies[body];
        let slides = joint.kind == JointKind::Prismatic;
        let slide = if slides {
            limits.range[joint.idx_v].iter().fold(0.0, |far: f64, x| far.max(x.abs()))
        } else {
            0.0
        };
        let far = beyond[body] + slide + joint.placement.translation.norm();
        beyond[joint.parent] = beyond[joint.parent].max(far);
    }
    robot.bodies[1..]
        .iter()
        .zip(&beyond[1..])
        .map(|(joint, far)| if joint.kind == JointKind::Prismatic { 1.0 } else { *far })
        .collect()
}
