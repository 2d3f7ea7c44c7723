//! Which sharpness and noise are asked for, from wide to narrow.

use crate::error::{Error, Result};

/// How sharply torques are weighed and how far particles are moved at random.
///
/// ```
/// use contactsense::particle::Schedule;
///
/// let Schedule::Explicit { point_noise, updates, .. } = Schedule::paper() else { unreachable!() };
/// assert!(point_noise[0] > point_noise[1] && updates == 25);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Schedule {
    /// By what the data show: sharp as far as enough particles keep a say and as the torques left over allow, once
    /// for what a motion tells anew; copies are moved by a share of how far the particles of a place lie apart.
    #[default]
    Adaptive,
    /// Each quantity goes geometrically from its first to its second value in so many updates, and stays there
    /// (Bimbo 2019, section III).
    Explicit {
        /// The likelihood's alpha [1/Nm]; for the Gaussian one over the noise.
        sharpness: [f64; 2],
        /// Standard deviation of the point's noise (m).
        point_noise: [f64; 2],
        /// Standard deviation of the force's noise, relative.
        force_noise: [f64; 2],
        /// Standard deviation of the stiffness' noise, relative.
        stiffness_noise: [f64; 2],
        /// From first to second value.
        updates: usize,
    },
}

impl Schedule {
    /// One that suits the paper's experiments.
    pub fn paper() -> Self {
        Schedule::Explicit {
            sharpness: [1.0, 30.0],
            point_noise: [0.02, 5e-4],
            force_noise: [0.2, 0.01],
            stiffness_noise: [0.3, 0.02],
            updates: 25,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        let Schedule::Explicit { sharpness, point_noise, force_noise, stiffness_noise, .. } = self else {
            return Ok(());
        };
        for (name, pair) in [
            ("sharpness", sharpness),
            ("point_noise", point_noise),
            ("force_noise", force_noise),
            ("stiffness_noise", stiffness_noise),
        ] {
            if !pair.iter().all(|x| *x > 0.0 && *x < 1e9) {
                return Err(Error::input(
                    "schedule",
                    format!("{name} must be two positive numbers, got {} and {}", pair[0], pair[1]),
                ));
            }
        }
        Ok(())
    }
}
