//! The answer.

use super::features::{Features, FEATURES};
use super::weights::{INTENDED, SHARES};

/// What one contact is.
///
/// ```
/// use contactsense::classification::ContactClass;
///
/// let unknown = ContactClass::default();
/// assert!(unknown.running && unknown.id.is_none());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactClass {
    /// Of [`Track`](crate::isolation::Track); none where the contact is not followed.
    pub id: Option<u64>,
    /// False in the one tick that says that it has ended.
    pub running: bool,
    /// Time of its first tick, as the report's (s).
    pub since: f64,
    /// From its first tick to its last so far (s).
    pub duration: f64,
    /// Probability that it is held between the robot and something fixed.
    pub clamped: f64,
    /// Probability that it ends by itself shortly.
    pub transient: f64,
    /// Probability that it lasts with something that follows or yields.
    pub sustained: f64,
    /// Probability that it is intended.
    pub intended: f64,
    /// What was measured of it.
    pub features: Features,
    /// What each feature adds to the logits of clamped, transient, sustained and intended.
    pub contributions: [[f64; FEATURES]; 4],
}

/// The three kinds of contacts.
///
/// ```
/// use contactsense::classification::{ContactClass, Kind};
///
/// let hit = ContactClass { clamped: 0.1, transient: 0.8, sustained: 0.1, ..ContactClass::default() };
/// assert_eq!(hit.kind(), Kind::Transient);
/// assert_eq!(hit.kind().name(), "transient");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Held between the robot and something fixed.
    Clamped,
    /// Ends by itself shortly.
    Transient,
    /// Lasts with something that follows or yields.
    Sustained,
}

impl Kind {
    /// In lower case.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Clamped => "clamped",
            Kind::Transient => "transient",
            Kind::Sustained => "sustained",
        }
    }
}

impl ContactClass {
    /// The likeliest kind.
    pub fn kind(&self) -> Kind {
        if self.clamped >= self.transient.max(self.sustained) {
            Kind::Clamped
        } else if self.transient >= self.sustained {
            Kind::Transient
        } else {
            Kind::Sustained
        }
    }
}

impl Default for ContactClass {
    fn default() -> Self {
        let [clamped, transient, sustained] = SHARES;
        Self {
            id: None,
            running: true,
            since: 0.0,
            duration: 0.0,
            clamped,
            transient,
            sustained,
            intended: INTENDED,
            features: Features::default(),
            contributions: [[0.0; FEATURES]; 4],
        }
    }
}
