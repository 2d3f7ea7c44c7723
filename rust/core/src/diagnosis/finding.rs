//! What a diagnosis finds.

use std::fmt;

/// What is wrong.
///
/// ```
/// use contactsense::diagnosis::FaultCode;
///
/// assert_eq!(FaultCode::GravityDirection.name(), "gravity_direction");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FaultCode {
    /// The torque has the wrong sign.
    Sign,
    /// The torque is scaled.
    Scale,
    /// The torque lacks that of gravity.
    GravityFree,
    /// Columns are in another order than the robot's joints.
    Permuted,
    /// The robot carries a mass that the model lacks.
    Payload,
    /// The robot lacks a tool that the model has, or has another one.
    Tool,
    /// The model lacks rotor inertia.
    Armature,
    /// The torque contains friction.
    Friction,
    /// The torque is off by a constant.
    Bias,
    /// The velocity or the torque is late.
    Delay,
    /// The velocity is low-passed.
    Filtered,
    /// A joint is at a position limit.
    Limit,
    /// A force/torque sensor reads a constant too much.
    SensorOffset,
    /// Gravity acts in another direction than in the model.
    GravityDirection,
    /// Numbers are in other units than SI.
    Units,
    /// Something could not be judged, and why.
    NotJudged,
}

impl FaultCode {
    /// The code's name in Python.
    pub fn name(self) -> &'static str {
        match self {
            FaultCode::Sign => "sign",
            FaultCode::Scale => "scale",
            FaultCode::GravityFree => "gravity_free",
            FaultCode::Permuted => "permuted",
            FaultCode::Payload => "payload",
            FaultCode::Tool => "tool",
            FaultCode::Armature => "armature",
            FaultCode::Friction => "friction",
            FaultCode::Bias => "bias",
            FaultCode::Delay => "delay",
            FaultCode::Filtered => "filtered",
            FaultCode::Limit => "limit",
            FaultCode::SensorOffset => "sensor_offset",
            FaultCode::GravityDirection => "gravity_direction",
            FaultCode::Units => "units",
            FaultCode::NotJudged => "not_judged",
        }
    }
}

/// How much a fault matters.
///
/// ```
/// use contactsense::diagnosis::Severity;
///
/// assert!(Severity::Major > Severity::Minor);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Severity {
    /// Visible in the log; contacts can still be detected.
    Minor,
    /// It spoils the detection of contacts.
    Major,
}

impl Severity {
    /// The name in Python.
    pub fn name(self) -> &'static str {
        match self {
            Severity::Minor => "minor",
            Severity::Major => "major",
        }
    }
}

/// One thing that is wrong with a robot's model or measurements.
///
/// ```
/// use contactsense::diagnosis::{Finding, Severity};
///
/// let grave = |findings: &[Finding]| findings.iter().any(|finding| finding.severity == Severity::Major);
/// assert!(!grave(&[]));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Finding {
    /// What is wrong.
    pub code: FaultCode,
    /// Name of the joint, where it is one joint.
    pub joint: Option<String>,
    /// Name of the link that carries a payload or a tool.
    pub link: Option<String>,
    /// Name of the force/torque sensor.
    pub sensor: Option<String>,
    /// How large it is, in `unit`; none where the fault has no size.
    pub value: Option<f64>,
    /// Of the value; empty for a factor.
    pub unit: String,
    /// The centre of mass of a payload in its link's frame (m), or gravity in the world's (m/s^2).
    pub vector: Option<[f64; 3]>,
    /// What is wrong and what to do, in a sentence.
    pub message: String,
    /// Share of the variance, unexplained until then, that it explains (0 to 1).
    pub evidence: f64,
    /// How much it matters.
    pub severity: Severity,
}

impl Finding {
    pub(super) fn new(code: FaultCode, message: String) -> Self {
        Finding {
            code,
            joint: None,
            link: None,
            sensor: None,
            value: None,
            unit: String::new(),
            vector: None,
            message,
            evidence: 0.0,
            severity: Severity::Minor,
        }
    }

    pub(super) fn of_joint(mut self, joint: &str) -> Self {
        self.joint = Some(joint.into());
        self
    }

    pub(super) fn sized(mut self, value: f64, unit: &'static str) -> Self {
        self.value = Some(value);
        self.unit = unit.into();
        self
    }

    pub(super) fn with_vector(mut self, vector: [f64; 3]) -> Self {
        self.vector = Some(vector);
        self
    }

    pub(super) fn explaining(mut self, share: f64) -> Self {
        self.evidence = share.clamp(0.0, 1.0);
        self
    }

    pub(super) fn major_if(mut self, major: bool) -> Self {
        self.severity = if major { Severity::Major } else { Severity::Minor };
        self
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} ({}): {}", self.code.name(), self.severity.name(), self.message)
    }
}
