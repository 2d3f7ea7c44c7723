//! The memory as users see it.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::boxes::{boxes, VoxelBox};
use super::options::MemoryOptions;
use super::swept::swept;
use super::voxel::{range, Voxel};
use crate::error::{Error, Result};
use crate::math::random::Stream;
use crate::posterior::Mode;
use crate::robot::{Robot, LARGEST};

/// A place where a contact may be, world frame.
///
/// ```
/// use contactsense::nalgebra::{Matrix3, Vector3};
/// use contactsense::occupancy::PossiblePlace;
///
/// let place = PossiblePlace {
///     point: Vector3::new(0.5, 0.0, 0.5),
///     normal: Vector3::x(),
///     covariance: Matrix3::identity() * 1e-6,
///     probability: 0.7,
/// };
/// let other = PossiblePlace { point: -place.point, probability: 0.3, ..place };
/// assert_eq!(other.normal, place.normal);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PossiblePlace {
    /// On the robot's surface (m).
    pub point: Vector3<f64>,
    /// Outward: the obstacle is on that side.
    pub normal: Vector3<f64>,
    /// Of the point (m^2).
    pub covariance: Matrix3<f64>,
    /// Of this place among all that are given; they need not sum to one.
    pub probability: f64,
}

impl PossiblePlace {
    /// That of a mode, which is spread along the surface.
    pub fn of_mode(mode: &Mode) -> Self {
        let normal = mode.pushed_normal();
        let across = Matrix3::identity() - normal * normal.transpose();
        PossiblePlace {
            point: mode.point,
            normal,
            covariance: across * (0.5 * mode.spread * mode.spread),
            probability: mode.probability,
        }
    }
}

/// Points that stand for the distribution of a place.
const SAMPLES: u64 = 1000;
/// Of a place that is known better than this (m), the standard deviation is this: positions and surfaces of robots err.
const LEAST_DEVIATION: f64 = 2e-3;
/// Log-odds do not go further either way: evidence that is added again and again is not independent.
const MOST_LOG_ODDS: f64 = 9.0;
/// Log-odds of a voxel that is all but sure stay finite.
const SURE: f64 = 1e-4;
/// No sample of a normal distribution is further from its mean than so many standard deviations: random numbers have 53 bits.
const FURTHEST: f64 = 10.0;
/// How much rounding may take from a covariance its symmetry, or make its eigenvalues negative; relative to its size.
const ROUNDING: f64 = 1e-9;

/// Where obstacles are and where none are, fused from contacts and from the space that the robot's body has been in.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::nalgebra::{Matrix3, Vector3};
/// use contactsense::occupancy::{ContactMemory, PossiblePlace, MemoryOptions};
/// use contactsense::robot::Robot;
///
/// let robot = Arc::new(Robot::example_arm());
/// let mut memory = ContactMemory::new(robot, MemoryOptions::default())?;
/// let place = PossiblePlace {
///     point: Vector3::new(0.5, 0.0, 0.5),
///     normal: Vector3::x(),
///     covariance: Matrix3::identity() * 1e-6,
///     probability: 1.0,
/// };
/// memory.add_contact(&[place])?;
/// assert!(memory.probability(&Vector3::new(0.51, 0.001, 0.501)) > 0.5);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactMemory {
    robot: Arc<Robot>,
    options: MemoryOptions,
    /// By voxel of which something is known: logarithm of the odds that it is occupied.
    log_odds: HashMap<Voxel, f64>,
}

impl ContactMemory {
    /// Nothing is known yet.
    ///
    /// # Errors
    /// [`Error::Input`] names the option.
    pub fn new(robot: Arc<Robot>, options: MemoryOptions) -> Result<Self> {
        robot.check_moves()?;
        options.check()?;
        Ok(ContactMemory { robot, options, log_odds: HashMap::new() })
    }

    /// The options.
    pub fn options(&self) -> &MemoryOptions {
        &self.options
    }

    /// How many voxels something is known of.
    pub fn len(&self) -> usize {
        self.log_odds.len()
    }

    /// Whether nothing is known.
    pub fn is_empty(&self) -> bool {
        self.log_odds.is_empty()
    }

    /// The body of the robot was at a configuration `q` `(nq,)` without a contact: no obstacle is where it is. Parts of links that
    /// are not closed have no inside, and say nothing.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument; the memory is unchanged, also where it would be too large (`max_voxels`).
    pub fn add_free(&mut self, q: &[f64]) -> Result<()> {
        self.robot.check_configuration(q)?;
        let mut inside = vec![];
        swept(&self.robot, q, self.options.resolution, |voxel| inside.push(voxel))?;
        inside.sort_unstable();
        inside.dedup();
        self.make_room(inside.iter())?;
        // That the body was there says the same however often: it is not added up.
        let free = logit(self.options.free_error);
        for voxel in inside {
            let log_odds = self.log_odds.entry(voxel).or_insert(free);
            *log_odds = log_odds.min(free);
        }
        Ok(())
    }

    /// There was one contact, at one of these places. To be called once a contact.
    ///
    /// Where a place is held to be free, the contact is more likely at another one. A voxel is occupied where the contact is in it, and
    /// is what it was before where it is not.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument; the memory is unchanged, also where it would be too large (`max_voxels`).
    pub fn add_contact(&mut self, places: &[PossiblePlace]) -> Result<()> {
        let mut shares: BTreeMap<Voxel, f64> = BTreeMap::new();
        for (row, place) in places.iter().enumerate() {
            self.check(place)
                .map_err(|problem| Error::input("contact", format!("place {row}: {problem}")))?;
            self.spread(place, &mut shares);
        }
        // The likelier a voxel was occupied, the likelier the contact is there.
        for (voxel, share) in &mut shares {
            *share *= self.of_voxel(*voxel);
        }
        let total: f64 = shares.values().sum();
        if !(total > 0.0 && total.is_finite()) {
            return Ok(());
        }
        let sure = (1.0 - self.options.contact_error) / total;
        // Far tails of a distribution need no memory.
        shares.retain(|_, share| *share * sure > SURE);
        self.make_room(shares.keys())?;
        for (voxel, share) in shares {
            let share = share * sure;
            let occupied = share + (1.0 - share) * self.of_voxel(voxel);
            let log_odds = logit(occupied.min(1.0 - SURE)).clamp(-MOST_LOG_ODDS, MOST_LOG_ODDS);
            self.log_odds.insert(voxel, log_odds);
        }
        Ok(())
    }

    fn check(&self, place: &PossiblePlace) -> std::result::Result<(), String> {
        let size = place.normal.norm();
        if !(place.point.norm() < LARGEST && size > 0.5 && size < 2.0) {
            return Err("the point must be finite and the normal a unit vector".into());
        }
        check_covariance(&place.covariance)?;
        self.check_reach(place)?;
        if !(place.probability >= 0.0 && place.probability < LARGEST) {
            return Err("the probability must be finite and not negative".into());
        }
        Ok(())
    }

    /// Whether there is a voxel for each point of a distribution.
    fn check_reach(&self, place: &PossiblePlace) -> std::result::Result<(), String> {
        let resolution = self.options.resolution;
        let most = range(resolution);
        let deviation = place.covariance.trace().max(0.0).sqrt().max(LEAST_DEVIATION);
        if place.point.amax() + resolution + FURTHEST * deviation < most {
            return Ok(());
        }
        Err(format!(
            "the point and {FURTHEST} standard deviations around it must be within {most:.3e} m of the origin along \
             each axis, which is how far voxels of {resolution} m reach"
        ))
    }

    /// Adds the probability that the obstacle at a place is in each voxel: half a voxel outward of the surface.
    fn spread(&self, place: &PossiblePlace, shares: &mut BTreeMap<Voxel, f64>) {
        let resolution = self.options.resolution;
        let eigen = place.covariance.symmetric_eigen();
        let deviations = eigen.eigenvalues.map(|variance| variance.max(0.0).sqrt().max(LEAST_DEVIATION));
        let outside = place.point + place.normal.normalize() * (0.5 * resolution);
        let random = Stream::new(0);
        for k in 0..SAMPLES {
            let random = random.fork(k);
            let ([x, y], [z, _]) = (random.normals(0), random.normals(2));
            let offset = eigen.eigenvectors * deviations.component_mul(&Vector3::new(x, y, z));
            let voxel = Voxel::at(&(outside + offset), resolution);
            *shares.entry(voxel).or_insert(0.0) += place.probability / SAMPLES as f64;
        }
    }

    /// Refuses voxels for which there is no room.
    fn make_room<'a>(&mut self, voxels: impl Iterator<Item = &'a Voxel>) -> Result<()> {
        let more = voxels.filter(|voxel| !self.log_odds.contains_key(voxel)).count();
        let most = self.options.max_voxels;
        if self.log_odds.len() + more > most {
            let text =
                format!("{most} are too few: {more} more would be known than {} now", self.log_odds.len());
            return Err(Error::input("max_voxels", text));
        }
        let memory = || Error::Memory(format!("there is no memory for {more} more voxels"));
        self.log_odds.try_reserve(more).map_err(|_| memory())
    }

    fn of_voxel(&self, voxel: Voxel) -> f64 {
        self.log_odds.get(&voxel).map_or(self.options.prior, |log_odds| (1.0 + (-log_odds).exp()).recip())
    }

    /// Probability that the voxel of a world point is occupied; the prior where nothing is known of it.
    pub fn probability(&self, point: &Vector3<f64>) -> f64 {
        self.of_voxel(Voxel::at(point, self.options.resolution))
    }

    /// Whether anything is known of the voxel of a world point.
    pub fn known(&self, point: &Vector3<f64>) -> bool {
        self.log_odds.contains_key(&Voxel::at(point, self.options.resolution))
    }

    /// The voxels of which something is known, in the order of their places: index along each axis, and log-odds.
    pub fn voxels(&self) -> Vec<([i32; 3], f64)> {
        let mut all: Vec<([i32; 3], f64)> =
            self.log_odds.iter().map(|(voxel, log_odds)| (voxel.0, *log_odds)).collect();
        all.sort_unstable_by_key(|entry| entry.0);
        all
    }

    /// Takes on what [`voxels`](Self::voxels) gave, in place of all that is known.
    ///
    /// # Errors
    /// [`Error::Input`] names `voxels`; the memory is unchanged.
    pub fn set_voxels(&mut self, voxels: &[([i32; 3], f64)]) -> Result<()> {
        if voxels.len() > self.options.max_voxels {
            return Err(Error::input("max_voxels", format!("must be at least {}", voxels.len())));
        }
        if voxels.iter().any(|(_, log_odds)| !log_odds.is_finite()) {
            return Err(Error::input("voxels", "log-odds must be finite"));
        }
        self.log_odds = voxels.iter().map(|(index, log_odds)| (Voxel(*index), *log_odds)).collect();
        Ok(())
    }

    /// Boxes that hold exactly the voxels whose probability is from `least` to `most`, each once.
    pub fn boxes(&self, least: f64, most: f64) -> Vec<VoxelBox> {
        let wanted = self.log_odds.keys().filter(|voxel| (least..=most).contains(&self.of_voxel(**voxel)));
        boxes(wanted.copied(), self.options.resolution)
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.log_odds.clear();
    }
}

fn check_covariance(covariance: &Matrix3<f64>) -> std::result::Result<(), String> {
    let size = covariance.norm();
    if !(0.0..LARGEST).contains(&size) {
        return Err("the covariance must be finite".into());
    }
    if (covariance - covariance.transpose()).norm() > ROUNDING * size {
        return Err("the covariance must be symmetric".into());
    }
    if covariance.symmetric_eigenvalues().min() < -ROUNDING * size {
        return Err("the covariance must have no negative eigenvalue".into());
    }
    Ok(())
}

fn logit(probability: f64) -> f64 {
    (probability / (1.0 - probability)).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(point: [f64; 3], probability: f64) -> PossiblePlace {
        let covariance = Matrix3::identity() * 1e-6;
        PossiblePlace { point: point.into(), normal: Vector3::x(), covariance, probability }
    }

    fn memory(options: MemoryOptions) -> ContactMemory {
        ContactMemory::new(Robot::example_arm().into(), options).expect("valid options")
    }

    #[test]
    fn a_contact_of_two_places_shares_its_evidence() {
        let mut memory =
            memory(MemoryOptions { prior: 0.1, contact_error: 1e-9, ..MemoryOptions::default() });
        let (a, b) = ([0.5, 0.01, 0.01], [0.9, 0.01, 0.01]);
        memory.add_contact(&[place(a, 0.75), place(b, 0.25)]).expect("two places");
        let at = |point: [f64; 3]| memory.probability(&(Vector3::from(point) + Vector3::x() * 0.01));
        // Bayes: occupied where the contact is, else as before.
        assert!((at(a) - (0.75 + 0.25 * 0.1)).abs() < 0.02, "{}", at(a));
        assert!((at(b) - (0.25 + 0.75 * 0.1)).abs() < 0.02, "{}", at(b));
    }

    #[test]
    fn a_contact_is_not_where_the_body_has_been() {
        let mut memory =
            memory(MemoryOptions { prior: 0.3, contact_error: 1e-9, ..MemoryOptions::default() });
        let (a, b) = ([0.5, 0.01, 0.01], [0.9, 0.01, 0.01]);
        let outside = |point: [f64; 3]| Vector3::from(point) + Vector3::x() * 0.01;
        let swept = Voxel::at(&outside(a), 0.02).0;
        memory.set_voxels(&[(swept, logit(0.01))]).expect("one voxel");
        memory.add_contact(&[place(a, 0.5), place(b, 0.5)]).expect("two places");
        assert!(memory.probability(&outside(a)) < 0.06, "{}", memory.probability(&outside(a)));
        assert!(memory.probability(&outside(b)) > 0.94, "{}", memory.probability(&outside(b)));
    }

    #[test]
    fn what_is_too_much_is_refused_and_changes_nothing() {
        let mut memory = memory(MemoryOptions { max_voxels: 5, ..MemoryOptions::default() });
        let error = memory.add_free(&[0.0; 7]).expect_err("too many");
        assert!(matches!(error, Error::Input { argument, .. } if argument == "max_voxels"));
        assert!(memory.is_empty());
    }

    #[test]
    fn places_that_voxels_do_not_reach_are_refused() {
        let mut memory = memory(MemoryOptions::default());
        let most = range(memory.options().resolution);
        for far in [1.0001 * most, -1.0001 * most, 1e30] {
            let error = memory.add_contact(&[place([0.1, far, 0.1], 1.0)]).expect_err("too far");
            assert!(matches!(error, Error::Input { argument, .. } if argument == "contact"));
        }
        let wide = Matrix3::identity() * most.powi(2);
        let unknown = PossiblePlace { covariance: wide, ..place([0.1; 3], 1.0) };
        memory.add_contact(&[unknown]).expect_err("too wide");
        assert!(memory.is_empty());
        let near = Vector3::new(0.1, 0.9999 * most, 0.1);
        memory.add_contact(&[place(near.into(), 1.0)]).expect("voxels reach there");
        assert!(memory.known(&(near + Vector3::x() * 0.01)));
    }

    #[test]
    fn a_covariance_may_be_off_by_rounding_only() {
        let mut memory = memory(MemoryOptions::default());
        let mut add = |covariance: Matrix3<f64>| {
            memory.add_contact(&[PossiblePlace { covariance, ..place([0.5, 0.0, 0.5], 1.0) }])
        };
        let mut askew = Matrix3::identity() * 1e-4;
        askew[(0, 1)] = 1e-5;
        add(askew).expect_err("not symmetric");
        add(Matrix3::from_diagonal(&Vector3::new(1e-4, -1e-6, 1e-4))).expect_err("a negative variance");
        add(Matrix3::from_diagonal(&Vector3::new(1e-4, -1e-20, 1e-4))).expect("rounding");
        add(Matrix3::zeros()).expect("a point that is known");
    }
}
