//! A calibration as the text of a file.

use std::fmt::Write;

use super::layout::{
    nameless, reversal_kind, Field, BASE_VARIABLES, BEFORE_REVERSAL, FORMAT, JOINT_FIELDS, MODEL_ERROR,
    NOISE_FIELDS, ONE_A_JOINT, ROBOT_FIELDS,
};
use crate::calibration::{Calibration, Payload, Reversal};
use crate::error::{Error, Result};

/// Of written numbers: more than any of them is known to, and what is read differs by less than 1e-9 of them.
const DIGITS: usize = 10;
/// Plain texts that readers of YAML 1.1 or 1.2 take for something else.
const WORDS: [&str; 7] = ["null", "true", "false", "yes", "no", "on", "off"];

const HEADER: &str = "\
# What contact-free motion taught of one robot, by contactsense. May be edited by hand.
# Units stand behind each entry, in parentheses those of sliding joints. \"std\" is one standard deviation.
";

impl Calibration {
    /// The text of a file, for people to read and edit, that [`Calibration::load`] reads: YAML keyed by the names of joints
    /// and links, with units. Numbers have ten digits.
    ///
    /// `source` says where the calibration is from, such as the name of the log, and `date` when it was written; both are
    /// kept in the file only.
    ///
    /// # Errors
    /// [`Error::Input`] where a number is not finite, or there is not one of each kind for every joint, and six for a base
    /// that is free to move.
    ///
    /// ```
    /// use contactsense::calibration::Calibration;
    /// use contactsense::robot::Robot;
    ///
    /// let calibration = Calibration::of_description(&Robot::example_arm());
    /// let text = calibration.to_yaml("motion.mcap", "2026-01-31")?;
    /// assert!(text.contains("torque_bias: 0.0  # Nm (N)"));
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    pub fn to_yaml(&self, source: &str, date: &str) -> Result<String> {
        if self.joints.is_empty() {
            return Err(Error::input(
                "calibration",
                "joints: a file keeps one entry a joint, and there is none",
            ));
        }
        let mut file = Text(HEADER.into());
        file.line(0, &format!("format: {FORMAT}"));
        file.line(0, &format!("contactsense: {}", text(env!("CARGO_PKG_VERSION"))));
        file.line(0, &format!("source: {}", text(source)));
        file.line(0, &format!("date: {}", text(date)));
        file.line(0, "robot:  # the only one that this file fits");
        file.line(1, &format!("name: {}", text(&self.robot)));
        file.line(1, &format!("fingerprint: {}  # of its joints and inertias", text(&self.fingerprint)));
        file.line(1, "joints:  # in the order of the velocity");
        for joint in &self.joints {
            file.line(2, &format!("- {}", text(joint)));
        }
        file.line(
            0,
            &format!("torque_is_external: {}  # whether a vendor estimates it", self.torque_is_external),
        );
        for Field { name, unit, get, .. } in &ROBOT_FIELDS {
            file.line(0, &format!("{name}: {}  # {unit}", number(*get(self))?));
        }
        self.write_joints(&mut file)?;
        self.write_noise(&mut file)?;
        self.write_links(&mut file)?;
        write_payload(self.payload.as_ref(), &mut file)?;
        self.write_rest(&mut file)?;
        Ok(file.0)
    }

    fn write_joints(&self, file: &mut Text) -> Result<()> {
        file.line(0, "joints:");
        for (index, joint) in self.joints.iter().enumerate() {
            let is_base = index == 0 && self.base_variables() > 1;
            let about = if is_base {
                "  # free to move: of six numbers, three are linear, three angular"
            } else {
                ""
            };
            file.line(1, &format!("{}:{about}", text(joint)));
            for Field { name, unit, get, .. } in &JOINT_FIELDS {
                let values = self.of_joint(name, get(self), index)?;
                file.line(2, &format!("{name}: {}  # {unit}", number_or_numbers(values)?));
                if *name == BEFORE_REVERSAL {
                    let reversal = one_for_all(self.of_joint("reversal", &self.friction.reversal, index)?)?;
                    let (kind, unit) = reversal_kind(reversal);
                    let width = number(reversal.width())?;
                    file.line(2, &format!("reversal: {{{kind}: {width}}}  # {unit}, of coulomb"));
                }
            }
        }
        Ok(())
    }

    fn write_noise(&self, file: &mut Text) -> Result<()> {
        file.line(0, "noise:  # of the external torque, one standard deviation: a number, or one a joint");
        for Field { name, unit, get, .. } in &NOISE_FIELDS {
            if let [value] = get(&self.noise)[..] {
                file.line(1, &format!("{name}: {}  # {unit}", number(value)?));
                continue;
            }
            file.line(1, &format!("{name}:  # {unit}"));
            for (index, joint) in self.joints.iter().enumerate() {
                let values = self.of_joint(name, get(&self.noise), index)?;
                file.line(2, &format!("{}: {}", text(joint), number_or_numbers(values)?));
            }
        }
        Ok(())
    }

    fn write_links(&self, file: &mut Text) -> Result<()> {
        file.line(
            0,
            "links:  # inertias of all that moves with a joint, in the frame of the link that it moves",
        );
        for (joint, body) in self.joints.iter().zip(self.one_a_joint("bodies", &self.bodies)?) {
            let link = if body.link.is_empty() { nameless(joint) } else { body.link.clone() };
            file.line(1, &format!("{}:", text(&link)));
            file.line(2, &format!("joint: {}", text(joint)));
            file.line(2, &format!("mass: {}  # kg", number(body.mass)?));
            file.line(2, &format!("com: {}  # m", numbers(&body.com)?));
            let inertia = numbers(&body.inertia)?;
            file.line(2, &format!("inertia: {inertia}  # kg m^2, about com: xx, xy, yy, xz, yz, zz"));
        }
        Ok(())
    }

    fn write_rest(&self, file: &mut Text) -> Result<()> {
        let offsets =
            self.sensor_offsets.iter().map(|(name, it)| Ok(format!("{}: {}", text(name), numbers(it)?)));
        file.list("sensor_offsets", "{}", "N and Nm, what a sensor reads without load", offsets)?;
        let tails = self.tails.iter().map(|it| Ok(format!("- {}", numbers(&[it.gain, it.level, it.scale])?)));
        file.list("tails", "[]", "of detection's statistic: gain (1/s), level, scale", tails)?;
        self.write_model_errors(file)?;
        let contacts = self.contacts.iter().map(|times| Ok(format!("- {}", numbers(times)?)));
        file.list("contacts", "[]", "s, from when to when contacts were left out of the log", contacts)?;
        let notes = self.notes.iter().map(|note| Ok(format!("- {}", text(note))));
        file.list("notes", "[]", "what the motion could not tell", notes)
    }

    fn write_model_errors(&self, file: &mut Text) -> Result<()> {
        if self.model_errors.is_empty() {
            return Ok(());
        }
        let mut errors = Vec::with_capacity(self.model_errors.len());
        for error in &self.model_errors {
            self.one_a_joint("model_errors", &error.bodies)?;
            self.one_a_joint("model_errors", &error.bias)?;
            self.one_a_joint("model_errors", &error.viscous)?;
            errors.push(error.by_joint().collect::<Vec<_>>());
        }
        let what = "one standard deviation of each error that the motion left possible";
        file.line(0, &format!("model_errors:  # {what}: {MODEL_ERROR}"));
        for (index, joint) in self.joints.iter().enumerate() {
            file.line(1, &format!("{}:", text(joint)));
            for error in &errors {
                file.line(2, &format!("- {}", numbers(&error[index])?));
            }
        }
        Ok(())
    }

    /// Of the first joint, which may be a base that is free to move.
    pub(super) fn base_variables(&self) -> usize {
        let is_free = self.torque_bias.len() + 1 == self.joints.len() + BASE_VARIABLES;
        if is_free {
            BASE_VARIABLES
        } else {
            1
        }
    }

    /// What a joint has of numbers by velocity variable, or by joint.
    fn of_joint<'a, T>(&self, name: &str, values: &'a [T], index: usize) -> Result<&'a [T]> {
        if ONE_A_JOINT.contains(&name) {
            return Ok(&self.one_a_joint(name, values)?[index..=index]);
        }
        let base = self.base_variables();
        if base == 1 {
            return Ok(&self.one_a_joint(name, values)?[index..=index]);
        }
        let wanted = self.joints.len() + base - 1;
        if values.len() != wanted {
            let problem = format!("{name}: must be {wanted}, one a velocity variable, not {}", values.len());
            return Err(Error::input("calibration", problem));
        }
        let (of_base, others) = values.split_at(base);
        Ok(if index == 0 { of_base } else { &others[index - 1..index] })
    }

    fn one_a_joint<'a, T>(&self, name: &str, values: &'a [T]) -> Result<&'a [T]> {
        if values.len() == self.joints.len() {
            return Ok(values);
        }
        let (count, joints) = (values.len(), self.joints.len());
        let problem = format!("{name}: a file keeps one a joint, which are {joints}, not {count}");
        Err(Error::input("calibration", problem))
    }
}

/// How friction of all directions of a joint changes its sign.
fn one_for_all(reversals: &[Reversal]) -> Result<Reversal> {
    match reversals {
        [first, others @ ..] if others.iter().all(|other| other == first) => Ok(*first),
        _ => Err(Error::input(
            "calibration",
            "friction.reversal: a file keeps one for all of a base's directions",
        )),
    }
}

fn write_payload(payload: Option<&Payload>, file: &mut Text) -> Result<()> {
    let Some(payload) = payload else {
        file.line(0, "payload: null  # what the description lacks on a link");
        return Ok(());
    };
    file.line(0, "payload:  # what the description lacks on a link");
    file.line(1, &format!("link: {}", text(&payload.link)));
    file.line(1, &format!("mass: {}  # kg", number(payload.mass)?));
    file.line(1, &format!("mass_std: {}  # kg", number(payload.mass_std)?));
    file.line(1, &format!("com: {}  # m, in the link's frame", numbers(&payload.com)?));
    file.line(1, &format!("com_std: {}  # m", numbers(&payload.com_std)?));
    file.line(
        1,
        &format!("moment: {}  # kg m^2, about com, the same about all axes", number(payload.moment)?),
    );
    Ok(())
}

struct Text(String);

impl Text {
    fn line(&mut self, depth: usize, content: &str) {
        let margin = 2 * depth;
        // Writing to a text cannot fail.
        let _ = writeln!(self.0, "{:margin$}{content}", "");
    }

    fn list(
        &mut self,
        name: &str,
        none: &str,
        about: &str,
        items: impl Iterator<Item = Result<String>>,
    ) -> Result<()> {
        let items = items.collect::<Result<Vec<_>>>()?;
        let none = if items.is_empty() { format!(" {none}") } else { String::new() };
        self.line(0, &format!("{name}:{none}  # {about}"));
        items.iter().for_each(|item| self.line(1, item));
        Ok(())
    }
}

/// A number of so many digits, with a point, without which YAML 1.1 takes 1e-05 for a text.
fn number(value: f64) -> Result<String> {
    if !value.is_finite() {
        return Err(Error::input("calibration", "holds a number that is not finite, which no file can keep"));
    }
    let scientific = format!("{value:.*e}", DIGITS - 1);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let whole = |digits: &str| match digits.trim_end_matches('0') {
        digits if digits.ends_with('.') => format!("{digits}0"),
        digits => digits.to_owned(),
    };
    // As C's %g: so that usual numbers have no exponent.
    let decimals = DIGITS as i32 - 1 - exponent;
    Ok(match exponent {
        -4..=8 => whole(&format!("{value:.*}", decimals as usize)),
        9 => format!("{value:.1}"),
        _ => format!("{}e{}{:02}", whole(mantissa), if exponent < 0 { '-' } else { '+' }, exponent.abs()),
    })
}

fn number_or_numbers(values: &[f64]) -> Result<String> {
    match values {
        [value] => number(*value),
        _ => numbers(values),
    }
}

fn numbers(values: &[f64]) -> Result<String> {
    let texts = values.iter().map(|value| number(*value)).collect::<Result<Vec<_>>>()?;
    Ok(format!("[{}]", texts.join(", ")))
}

/// A text, in quotes where YAML needs them.
fn text(value: &str) -> String {
    let inner = |c: char| c.is_ascii_alphanumeric() || "_./-".contains(c);
    let starts = value.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    if starts && value.chars().all(inner) && !WORDS.contains(&value.to_ascii_lowercase().as_str()) {
        return value.to_owned();
    }
    let mut quoted = String::from("\"");
    for c in value.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            '\n' => quoted.push_str("\\n"),
            '\t' => quoted.push_str("\\t"),
            // What is a line break to YAML 1.1, or has no shape.
            c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}') => {
                let _ = write!(quoted, "\\u{:04x}", u32::from(c));
            }
            c => quoted.push(c),
        }
    }
    quoted + "\""
}
