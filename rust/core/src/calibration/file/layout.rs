//! Which entries a calibration file has, with their units; a new number of a joint is one line here.

use crate::calibration::{Calibration, Reversal};
use crate::torque::NoiseModel;

/// Files of another format are refused: an entry may mean something else there.
pub(super) const FORMAT: &str = "4";

/// Which numbers can be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rule {
    Any,
    NotNegative,
    Positive,
    NotZero,
}

impl Rule {
    pub(super) fn allows(self, number: f64) -> bool {
        let fits = match self {
            Rule::Any => true,
            Rule::NotNegative => number >= 0.0,
            Rule::Positive => number > 0.0,
            Rule::NotZero => number != 0.0,
        };
        fits && number.is_finite()
    }

    pub(super) fn wanted(self) -> &'static str {
        match self {
            Rule::Any => "a finite number",
            Rule::NotNegative => "a finite number that is not negative",
            Rule::Positive => "a positive number",
            Rule::NotZero => "a finite number other than zero",
        }
    }
}

/// A number, or numbers, of `T`.
pub(super) struct Field<T, V> {
    /// In the file.
    pub(super) name: &'static str,
    /// As the file says it; in parentheses where a joint slides.
    pub(super) unit: &'static str,
    pub(super) rule: Rule,
    pub(super) get: fn(&T) -> &V,
    pub(super) get_mut: fn(&mut T) -> &mut V,
}

macro_rules! field {
    ($name:literal, $unit:literal, $rule:ident, $($path:ident).+) => {
        Field {
            name: $name,
            unit: $unit,
            rule: Rule::$rule,
            get: |it| &it.$($path).+,
            get_mut: |it| &mut it.$($path).+,
        }
    };
}

pub(super) const JOINT_FIELDS: [Field<Calibration, Vec<f64>>; 13] = [
    field!("torque_bias", "Nm (N), constant torque that the measurement adds", Any, torque_bias),
    field!("torque_bias_std", "Nm (N), one standard deviation", NotNegative, torque_bias_std),
    field!("torque_scale", "true torque / measured torque, sign included", NotZero, torque_scale),
    field!("coulomb", "Nm (N), Coulomb friction", NotNegative, friction.coulomb),
    field!("coulomb_std", "Nm (N)", NotNegative, coulomb_std),
    field!("viscous", "Nm s/rad (N s/m), viscous friction", NotNegative, friction.viscous),
    field!("viscous_std", "Nm s/rad (N s/m)", NotNegative, viscous_std),
    field!("hysteresis", "share of a change of torque that gears keep back", NotNegative, hysteresis),
    field!("hysteresis_std", "share", NotNegative, hysteresis_std),
    field!("hysteresis_width", "Nm (N), where it levels off", NotNegative, hysteresis_width),
    field!("armature", "kg m^2 (kg), rotor inertia behind the gear", NotNegative, armature),
    field!("armature_std", "kg m^2 (kg)", NotNegative, armature_std),
    field!("residual", "Nm (N), root mean square on held-out blocks", NotNegative, residual),
];

/// Of these there is one a joint also of a base that is free to move; of all others there is one a velocity variable.
pub(super) const ONE_A_JOINT: [&str; 2] = ["armature", "armature_std"];
/// Velocity variables of a base that is free to move, which is the first joint then: linear, then angular.
pub(super) const BASE_VARIABLES: usize = 6;

/// The entry `reversal` of a joint stands behind this one.
pub(super) const BEFORE_REVERSAL: &str = "viscous_std";

/// Numbers of a joint in a [`ModelError`](crate::calibration::ModelError).
pub(super) const MODEL_ERROR: &str =
    "mass (kg), first moment (kg m), bias (Nm or N), viscous (Nm s/rad or N s/m)";

/// How Coulomb friction changes its sign, and the unit of its width.
pub(super) fn reversal_kind(reversal: Reversal) -> (&'static str, &'static str) {
    match reversal {
        Reversal::Velocity(_) => ("velocity", VELOCITY),
        Reversal::Displacement(_) => ("displacement", DISPLACEMENT),
    }
}
pub(super) const VELOCITY: &str = "rad/s (m/s)";
pub(super) const DISPLACEMENT: &str = "rad (m)";

pub(super) const NOISE_FIELDS: [Field<NoiseModel, Vec<f64>>; 8] = [
    field!("torque", "Nm (N), white, per sample", NotNegative, torque),
    field!("velocity", "rad/s (m/s), white, per sample", NotNegative, velocity),
    field!("relative", "share of the contact's own torque", NotNegative, relative),
    field!("model", "Nm (N), slow errors left over", NotNegative, model),
    field!("model_time", "s, time over which these change", NotNegative, model_time),
    field!("friction", "Nm (N), of friction at starts and stops", NotNegative, friction),
    field!("bias", "Nm (N), from one start to the next", NotNegative, bias),
    field!("position_step", "rad (m), between two positions that are counted", NotNegative, position_step),
];

pub(super) const ROBOT_FIELDS: [Field<Calibration, f64>; 4] = [
    field!("inertial_change", "share by which inertias may differ", NotNegative, inertial_change),
    field!("velocity_delay", "s, of the velocity against the position", NotNegative, velocity_delay),
    field!("torque_delay", "s, of the torque against the position", NotNegative, torque_delay),
    field!("false_alarms_per_hour", "1/h", Positive, false_alarms_per_hour),
];

/// What the inertia behind a joint is called where the joint moves no link with a name.
pub(super) fn nameless(joint: &str) -> String {
    format!("(joint {joint})")
}
