//! Particles as columns: one array a quantity.

use nalgebra::Vector3;

use crate::error::Result;
use crate::posterior::memory::filled;
use crate::posterior::parallel::Pieces;
use crate::posterior::{ContactSample, ContactSamples};

macro_rules! columns {
    ($($(#[$doc:meta])* $name:ident: $kind:ty = $empty:expr,)*) => {
        /// All particles; entry k of each column belongs to particle k.
        ///
        /// ```
        /// use std::sync::Arc;
        ///
        /// use contactsense::particle::{ContactParticleFilter, FilterOptions};
        /// use contactsense::robot::Robot;
        ///
        /// let options = FilterOptions { particles: 500, ..FilterOptions::default() };
        /// let mut filter = ContactParticleFilter::new(Arc::new(Robot::example_arm()), options)?;
        /// filter.update(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])?;
        /// let particles = filter.particles();
        /// assert_eq!((particles.link.len(), particles.force.len()), (500, 500));
        /// assert!(particles.normal.iter().all(|normal| (normal.norm() - 1.0).abs() < 1e-9));
        /// # Ok::<(), contactsense::Error>(())
        /// ```
        #[derive(Debug, Clone)]
        pub struct Columns {
            $($(#[$doc])* pub $name: Vec<$kind>,)*
        }

        /// Some neighbouring particles, to be changed.
        #[derive(Debug)]
        pub(super) struct Slice<'a> {
            $(pub $name: &'a mut [$kind],)*
        }

        impl Columns {
            pub(super) fn new(count: usize) -> Result<Self> {
                Ok(Columns { $($name: filled($empty, count)?,)* })
            }

            /// Makes all particles as they were at the start.
            pub(super) fn clear(&mut self) {
                $(self.$name.fill($empty);)*
            }

            /// Memory that one particle takes [bytes].
            pub(super) const SIZE: usize = 0 $(+ std::mem::size_of::<$kind>())*;

            pub(super) fn slice(&mut self) -> Slice<'_> {
                Slice { $($name: &mut self.$name,)* }
            }

            /// Makes particle k a copy of particle `parents[k]` of `source`.
            pub(super) fn gather(&mut self, source: &Columns, parents: &[u32]) {
                $(
                    for (to, &parent) in self.$name.iter_mut().zip(parents) {
                        *to = source.$name[parent as usize];
                    }
                )*
            }
        }

        impl<'a> Pieces for Slice<'a> {
            fn count(&self) -> usize {
                self.len()
            }

            fn split(self, middle: usize) -> (Slice<'a>, Slice<'a>) {
                $(let $name = self.$name.split_at_mut(middle);)*
                (Slice { $($name: $name.0,)* }, Slice { $($name: $name.1,)* })
            }
        }
    };
}

columns! {
    /// Index into the robot's links.
    link: u32 = 0,
    /// Triangle of the link's surface; none on an exact primitive.
    triangle: Option<u32> = None,
    /// Contact point, link frame (m).
    point: Vector3<f64> = Vector3::zeros(),
    /// Outward unit normal of the contact, link frame.
    normal: Vector3<f64> = Vector3::z(),
    /// The obstacle's centre of curvature, which stays put in the world; unused by the baselines (m).
    centre: Vector3<f64> = Vector3::zeros(),
    /// From the centre to the contact point, negative where the centre is inside the link (m).
    distance: f64 = 0.0,
    /// Along the inward normal: the mean of what is believed (N). Below zero there is a gap.
    force: f64 = 0.0,
    /// Mean of what is believed [N/m].
    stiffness: f64 = 1.0,
    /// Variance of the force [N^2].
    force_variance: f64 = 0.0,
    /// Covariance of force and stiffness.
    cross_variance: f64 = 0.0,
    /// Variance of the stiffness.
    stiffness_variance: f64 = 0.0,
    /// Logarithm of the weight, not normalised.
    log_weight: f64 = 0.0,
    /// Squared norm of the torque of a unit force, each joint over its noise [1/N^2].
    gain: f64 = 0.0,
    /// Inner product of that torque with the measured one [1/N].
    product: f64 = 0.0,
    /// Squared norm of the measured torques that the particle's friction does not explain.
    measured: f64 = 0.0,
    /// What the freedom of its friction costs in log-likelihood.
    penalty: f64 = 0.0,
}

impl Columns {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.link.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.link.is_empty()
    }
}

impl Slice<'_> {
    pub fn len(&self) -> usize {
        self.link.len()
    }
}

impl ContactSamples for Columns {
    #[inline]
    fn sample(&self, k: usize) -> ContactSample {
        ContactSample {
            link: self.link[k] as usize,
            point: self.point[k],
            normal: self.normal[k],
            force: self.normal[k] * -self.force[k].max(0.0),
            stiffness: self.stiffness[k],
        }
    }
}
