//! What of a contact tells its kind: numbers without dimension, alike for robots of all sizes.

/// Number of features.
pub const FEATURES: usize = 9;

/// Their names, in the order of [`Features::scaled`].
pub const FEATURE_NAMES: [&str; FEATURES] = [
    "rise_time",
    "width",
    "remaining",
    "approach_speed",
    "onset_work",
    "advance",
    "retreat",
    "net_work",
    "at_rest",
];

/// Times at which a rise, and a contact, are neither short nor long (s).
const RISE: f64 = 0.05;
const WIDTH: f64 = 0.1;
/// Added to a width, so that the first tick has a logarithm (s).
const LEAST_WIDTH: f64 = 0.01;
/// Logarithms of times are limited to so much: beyond, no more is learned.
const MOST_LOG: f64 = 3.0;
/// Speed of a robot that runs into something rather than stands (m/s), and of one that stands.
const APPROACH: f64 = 0.05;
const STANDING: f64 = 0.03;
/// Ways along the force that are more than the noise of velocities adds up to (m).
const ADVANCE: f64 = 0.02;
const RETREAT: f64 = 0.005;

/// What was measured of a contact so far. Force and ways are equivalents: the torque of each joint over its greatest lever is a
/// force, and the power of the torque over that force is a speed.
///
/// ```
/// use contactsense::classification::{Features, FEATURES};
///
/// let hit = Features { rise_time: 0.02, width: 0.04, approach_speed: 0.3, ..Features::default() };
/// let scaled = hit.scaled();
/// assert_eq!(scaled.len(), FEATURES);
/// // Short, and against a fast motion.
/// assert!(scaled[0] < 0.0 && scaled[3] > 0.99);
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Features {
    /// Greatest force over its greatest rate (s).
    pub rise_time: f64,
    /// Impulse over the greatest force (s).
    pub width: f64,
    /// Present force as a share of the greatest.
    pub remaining: f64,
    /// Speed at the onset against the force at its greatest, negative along with it (m/s).
    pub approach_speed: f64,
    /// Work of the force on the robot about the onset, as a share of all that was done in both directions, -1 to 1.
    pub onset_work: f64,
    /// Way of the robot against the force since the onset (m).
    pub advance: f64,
    /// Way of the robot along with the force since it was greatest (m).
    pub retreat: f64,
    /// Work of the force on the robot over the greatest force (m).
    pub net_work: f64,
    /// Greatest equivalent force (N).
    pub peak: f64,
}

impl Features {
    /// As the weights take them, each about -3 to 3 at most.
    pub fn scaled(&self) -> [f64; FEATURES] {
        let log = |time: f64, scale: f64| (time.max(1e-4) / scale).ln().clamp(-MOST_LOG, MOST_LOG);
        [
            log(self.rise_time, RISE),
            log(self.width + LEAST_WIDTH, WIDTH),
            self.remaining,
            (self.approach_speed / APPROACH).tanh(),
            self.onset_work,
            (self.advance / ADVANCE).tanh(),
            (1.0 - self.remaining) * (self.retreat / RETREAT).tanh(),
            (self.net_work / RETREAT).tanh(),
            (-(self.approach_speed / STANDING).powi(2)).exp(),
        ]
    }
}
