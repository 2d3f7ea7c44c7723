//! Friction of joints, and how it turns round with the motion.

/// Friction of the joints, by velocity variable.
///
/// ```
/// use contactsense::calibration::{Friction, Reversal};
///
/// let reversal = vec![Reversal::Velocity(0.01)];
/// let friction = Friction { coulomb: vec![0.5], viscous: vec![0.1], reversal };
/// assert_eq!(friction.reversal[0].width(), 0.01);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Friction {
    /// Torque against the motion, whatever its speed (Nm; N for sliding joints).
    pub coulomb: Vec<f64>,
    /// Torque in proportion to the velocity (Nm s/rad; N s/m).
    pub viscous: Vec<f64>,
    /// How Coulomb friction turns round.
    pub reversal: Vec<Reversal>,
}

/// How Coulomb friction goes from one direction to the other.
///
/// ```
/// use contactsense::calibration::Reversal;
///
/// assert_eq!(Reversal::Displacement(0.003).width(), 0.003);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Reversal {
    /// With the velocity, as `tanh(v / v_s)` of this `v_s` (rad/s; m/s): none at rest.
    Velocity(f64),
    /// With the displacement since the motion last turned round, whole after twice this length (rad; m): a joint at rest
    /// keeps its friction (Dahl 1968, piecewise linear).
    Displacement(f64),
}

/// The ways of turning round among which a log chooses, the usual one first: from abrupt to smooth.
pub(crate) const REVERSALS: [Reversal; 8] = [
    Reversal::Velocity(0.03),
    Reversal::Velocity(0.003),
    Reversal::Velocity(0.01),
    Reversal::Velocity(0.1),
    Reversal::Displacement(0.003),
    Reversal::Displacement(0.01),
    Reversal::Displacement(0.03),
    Reversal::Displacement(0.1),
];

impl Reversal {
    /// The velocity (rad/s; m/s) or length (rad; m).
    pub fn width(self) -> f64 {
        match self {
            Reversal::Velocity(width) | Reversal::Displacement(width) => width,
        }
    }

    /// The share of Coulomb friction at velocity `v` after a step of `dt` (s), from -1 to 1; `last` is that of before.
    #[inline]
    pub(crate) fn share(self, last: f64, v: f64, dt: f64) -> f64 {
        match self {
            Reversal::Velocity(slow) => sliding(v / slow),
            Reversal::Displacement(length) => (last + v * dt / length).clamp(-1.0, 1.0),
        }
    }
}

/// Beyond this argument the quotient below exceeds one.
const SATURATED: f64 = 4.97;

/// The hyperbolic tangent to 2e-4 (its continued fraction to the seventh order): friction is not known better, and no
/// library call is needed every tick.
#[inline]
fn sliding(x: f64) -> f64 {
    let x = x.clamp(-SATURATED, SATURATED);
    let y = x * x;
    x * (135_135.0 + y * (17_325.0 + y * (378.0 + y)))
        / (135_135.0 + y * (62_370.0 + y * (3_150.0 + y * 28.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quotient_is_the_hyperbolic_tangent() {
        for k in -2000..=2000 {
            let x = f64::from(k) * 0.01;
            assert!((sliding(x) - x.tanh()).abs() < 2e-4, "{x}");
            assert!(sliding(x).abs() <= 1.0);
        }
    }
}
