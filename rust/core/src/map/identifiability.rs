//! What the joint torques would tell of a contact at each point of the surface.

use nalgebra::{Matrix2, Matrix2x3, Matrix3, Vector3, Vector6};

use super::contact_map::ContactMap;
use super::surface_samples::LinkSamples;
use crate::error::{Error, Result};
use crate::math::chi_square::upper_limit;
use crate::math::triangle::Triangle;
use crate::robot::{LinkIndex, LARGEST};
use crate::spatial::vector::stack;
use crate::torque::{directions, Frame, Frames};

/// A singular value counts towards the rank where it is greater than this share of the largest one.
const RANK_TOLERANCE: f64 = 1e-7;
/// The variance of a point anywhere on a patch of surface, in each direction, as a share of the patch's area.
const PATCH_VARIANCE: f64 = 1.0 / 12.0;

/// What the joint torques would tell of a contact at each sample of a map, at one pose.
///
/// The torque of a contact is linearised in five unknowns: its force, and two coordinates of its point in the tangent plane.
/// Errors of the torque, force and point are Gaussian. The errors have the standard deviations of the noise model at the
/// contact's own torque, the force those of the map's prior, and the point has the covariance of the link's surface: where the
/// torques say nothing of it, it is as uncertain as a point anywhere on the link. Confusion with other links is not in it.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::map::{ContactMap, MapOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let map = ContactMap::new(robot, &MapOptions { samples: 500, ..MapOptions::default() })?;
/// let told = map.identifiability(&[0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0], 20.0)?;
/// let (first, last) = (0, told.points.len() - 1);
/// assert!(told.rank[first] < 5 && told.rank[last] == 5);
/// assert!(told.point_std[last] < 0.5 * told.point_std[first]);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Identifiability {
    /// Normal force of the contacts (N).
    pub force: f64,
    /// By sample: its link.
    pub links: Vec<LinkIndex>,
    /// By sample: its point in the world frame (m).
    pub points: Vec<Vector3<f64>>,
    /// By sample: standard deviation of the point of a contact there (m), the root of its covariance's trace.
    pub point_std: Vec<f64>,
    /// By sample: how many of the five unknowns, the force and the two coordinates of the point, noiseless torques determine.
    pub rank: Vec<u8>,
    /// By sample: norm of the torque of the normal force, each joint over its noise without contact.
    pub significance: Vec<f64>,
    /// By sample: whether this norm is greater than that of the noise without contact is in 99 % of cases.
    pub detectable: Vec<bool>,
}

impl ContactMap {
    /// What the joint torques would tell of a contact with a normal force (N) at each sample, at a configuration `q` `(nq,)`.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub fn identifiability(&self, q: &[f64], force: f64) -> Result<Identifiability> {
        self.robot.check_configuration(q)?;
        if !(force > 0.0 && force < LARGEST) {
            return Err(Error::input("force", format!("must be positive and finite [N], not {force}")));
        }
        let mut kinematics = self.kinematics.clone();
        kinematics.set_configuration(&self.robot, q);
        let mut frames = Frames::new(&self.robot, self.wanted.clone());
        frames.update(&self.robot, &kinematics, &vec![1.0; self.robot.nv()]);
        let count = self.samples();
        let mut found = Identifiability {
            force,
            links: Vec::with_capacity(count),
            points: Vec::with_capacity(count),
            point_std: Vec::with_capacity(count),
            rank: Vec::with_capacity(count),
            significance: Vec::with_capacity(count),
            detectable: Vec::with_capacity(count),
        };
        let limit = upper_limit(self.robot.nv()).sqrt();
        let mut torques = Torques::new(self.robot.nv());
        for samples in &self.posterior.samples.links {
            let (frame, extent) = (&frames.links[samples.link], covariance(samples));
            for place in &samples.places {
                let told = self.told(frame, &extent, &place.point, &place.normal, force, &mut torques);
                found.links.push(LinkIndex::new(samples.link));
                found.points.push(frame.pose.transform_point(&place.point));
                found.point_std.push(told.point_std);
                found.rank.push(told.rank);
                found.significance.push(told.significance);
                found.detectable.push(told.significance > limit);
            }
        }
        Ok(found)
    }

    /// Of a contact at a point of a link (its frame) with an outward normal and a normal force (N). `extent` is the covariance of
    /// the link's surface (m^2).
    fn told(
        &self,
        frame: &Frame,
        extent: &Matrix3<f64>,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
        force: f64,
        torques: &mut Torques,
    ) -> Told {
        let directions = directions(normal);
        let derivatives = Derivatives::new(frame, point, &directions, force);
        torques.set(frame, |axis| force * derivatives.of(axis)[0]);
        self.noise.set_deviations(&torques.torque, &mut torques.deviation);

        let tangents = Matrix2x3::from_rows(&[directions[1].transpose(), directions[2].transpose()]);
        let plane = tangents * extent * tangents.transpose();
        let (root, size) = (root(&plane), extent.trace().sqrt());
        let [along, across] = self.posterior.prior.deviations(force);
        // In units of the prior's deviations; and in units that have nothing to do with what is known beforehand.
        let (mut known, mut free) = (Triangle::identity(), Triangle::empty());
        for (axis, &k) in frame.rows().iter().enumerate() {
            let [a, b, c, d, e] = derivatives.of(axis).map(|torque| torque / torques.deviation[k]);
            let [u, v] = [0, 1].map(|column| d * root[(0, column)] + e * root[(1, column)]);
            known.add([a * along, b * across, c * across, u, v]);
            free.add([a * force, b * force, c * force, d * size, e * size]);
        }
        let spread = (root * known.last_two()).norm_squared();
        // The surface's height above the plane grows with the square of the distance, and is as large as the link where
        // nothing is known.
        let height = normal.dot(&(extent * normal)) * (spread / plane.trace()).powi(2);
        Told {
            point_std: (spread + height).sqrt(),
            rank: free.rank(RANK_TOLERANCE) as u8,
            significance: torques.over(self.noise.at_rest()),
        }
    }
}

/// How the torques of a contact change with its five unknowns: its force along the inward normal and in two directions across
/// it, and its point in these two directions.
struct Derivatives<'a> {
    frame: &'a Frame,
    /// Wrenches at the link's origin, in its frame: of unit forces, and of the force moved by a unit of length.
    wrenches: [Vector6<f64>; 5],
}

impl<'a> Derivatives<'a> {
    /// At a point of a link (its frame), for a normal force (N). A contact that moves takes its force along.
    fn new(frame: &'a Frame, point: &Vector3<f64>, directions: &[Vector3<f64>; 3], force: f64) -> Self {
        let applied = |direction: &Vector3<f64>| stack(direction, &point.cross(direction));
        let moved = |aside: &Vector3<f64>| stack(&Vector3::zeros(), &(aside.cross(&directions[0]) * force));
        let [inward, first, second] = directions;
        Derivatives {
            frame,
            wrenches: [applied(inward), applied(first), applied(second), moved(first), moved(second)],
        }
    }

    /// The derivatives of the torque of one of the joints that move the link.
    #[inline]
    fn of(&self, axis: usize) -> [f64; 5] {
        let column = self.frame.column(axis);
        self.wrenches.map(|wrench| column.dot(&wrench))
    }
}

/// A contact's torque without noise, and its standard deviations (Nm; N for sliding joints), one a velocity variable.
struct Torques {
    torque: Vec<f64>,
    deviation: Vec<f64>,
}

impl Torques {
    fn new(count: usize) -> Self {
        Torques { torque: vec![0.0; count], deviation: vec![0.0; count] }
    }

    /// Sets the torques of the joints that move a link; the others feel nothing.
    fn set(&mut self, frame: &Frame, of_axis: impl Fn(usize) -> f64) {
        self.torque.fill(0.0);
        frame.rows().iter().enumerate().for_each(|(axis, &k)| self.torque[k] = of_axis(axis));
    }

    /// The norm of the torques over deviations.
    fn over(&self, deviations: &[f64]) -> f64 {
        let squares = self.torque.iter().zip(deviations).map(|(torque, noise)| (torque / noise).powi(2));
        squares.sum::<f64>().sqrt()
    }
}

/// Of one sample.
struct Told {
    point_std: f64,
    rank: u8,
    significance: f64,
}

/// The covariance of a point anywhere on a link's surface (m^2).
fn covariance(samples: &LinkSamples) -> Matrix3<f64> {
    let total: f64 = samples.areas.iter().sum();
    let weighed =
        || samples.places.iter().zip(&samples.areas).map(|(place, area)| (place.point, area / total));
    let mean: Vector3<f64> = weighed().map(|(point, share)| point * share).sum();
    let patch = PATCH_VARIANCE * total / samples.places.len() as f64;
    let sum: Matrix3<f64> =
        weighed().map(|(point, share)| (point - mean) * (point - mean).transpose() * share).sum();
    sum + Matrix3::from_diagonal_element(patch)
}

/// The symmetric square root of a covariance.
fn root(covariance: &Matrix2<f64>) -> Matrix2<f64> {
    let eigen = covariance.symmetric_eigen();
    let roots = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
    eigen.eigenvectors * Matrix2::from_diagonal(&roots) * eigen.eigenvectors.transpose()
}
