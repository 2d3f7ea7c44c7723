//! A calibration from a file.

use std::path::Path;

use super::entries::{Entries, Found};
use super::layout::{
    nameless, Field, Rule, BASE_VARIABLES, BEFORE_REVERSAL, DISPLACEMENT, FORMAT, JOINT_FIELDS, MODEL_ERROR,
    NOISE_FIELDS, ONE_A_JOINT, ROBOT_FIELDS, VELOCITY,
};
use super::yaml::parse;
use crate::calibration::calibration::negative_moments;
use crate::calibration::{BodyInertia, Calibration, Friction, ModelError, Payload, Reversal, Tail};
use crate::error::{Error, Result};
use crate::load::read_regular_file;
use crate::torque::NoiseModel;

/// A file of a hundred joints has 100 kB (bytes).
const LARGEST_FILE: u64 = 10_000_000;

impl Calibration {
    /// A calibration from a file that [`Calibration::to_yaml`] wrote, perhaps edited since. No robot is needed: whether it
    /// fits one is known when it is used, or by [`Calibration::check`].
    ///
    /// # Errors
    /// [`Error::Input`] where the file cannot be read, or an entry is missing, unknown or wrong; it names the file, the
    /// joint and the entry.
    ///
    /// ```no_run
    /// use contactsense::calibration::Calibration;
    ///
    /// let calibration = Calibration::load("arm.yaml")?;
    /// println!("{:?}", calibration.torque_bias);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let unread =
            |problem: String| Error::input("path", format!("cannot read {}: {problem}", path.display()));
        let bytes = read_regular_file(path, LARGEST_FILE).map_err(|problem| unread(problem.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|error| unread(format!("it is no UTF-8: {error}")))?;
        Calibration::from_yaml(&text).map_err(|problem| Error::input(path.display().to_string(), problem))
    }

    /// What is wrong is said by the entries that lead there.
    pub(super) fn from_yaml(text: &str) -> Found<Self> {
        let root = parse(text.strip_prefix('\u{feff}').unwrap_or(text))?;
        let mut entries = Entries::new(String::new(), &root)?;
        let format = entries.take("format", FORMAT)?;
        if super::entries::shown(format) != FORMAT {
            return Err(format!(
                "format: this version of contactsense reads format {FORMAT}, not {}; calibrate anew, or use the version \
                 that wrote the file",
                super::entries::shown(format)
            ));
        }
        for name in ["contactsense", "source", "date"] {
            entries.take(name, "a text")?; // for people
        }
        let mut robot = entries.inner("robot")?;
        let joints = robot.texts("joints", "names of joints, in the order of the velocity")?;
        let mut calibration = empty(robot.text("name")?, robot.text("fingerprint")?, joints);
        robot.done()?;
        for (index, joint) in calibration.joints.iter().enumerate() {
            if calibration.joints[..index].contains(joint) {
                return Err(format!("robot: joints: '{joint}' stands there twice"));
            }
        }
        calibration.torque_is_external = entries.flag("torque_is_external")?;
        for field in &ROBOT_FIELDS {
            *(field.get_mut)(&mut calibration) = entries.number(field.name, field.unit, field.rule)?;
        }
        calibration.read_joints(entries.inner("joints")?)?;
        calibration.noise = noise(entries.inner("noise")?, &calibration)?;
        calibration.bodies = bodies(entries.inner("links")?, &calibration.joints)?;
        calibration.payload = match entries.take_null("payload") {
            true => None,
            false => Some(payload(entries.inner("payload")?)?),
        };
        let mut offsets = entries.inner("sensor_offsets")?;
        for sensor in offsets.names() {
            calibration
                .sensor_offsets
                .push((sensor.to_owned(), offsets.numbers(sensor, "N, Nm", Rule::Any)?));
        }
        for (name, item) in entries.items("tails", "triples of gain [1/s], level and scale")? {
            let [gain, level, scale] = entries.as_numbers(&name, item, "1/s, 1, 1", Rule::Any)?;
            calibration.tails.push(Tail { gain, level, scale });
        }
        // Calibrations of before have none.
        if entries.names().contains(&"model_errors") {
            calibration.model_errors = model_errors(entries.inner("model_errors")?, &calibration.joints)?;
        }
        for (name, item) in entries.items("contacts", "pairs of times [s], from when to when")? {
            calibration.contacts.push(entries.as_numbers(&name, item, "s", Rule::Any)?);
        }
        calibration.notes = entries.texts("notes", "texts")?;
        entries.done()?;
        Ok(calibration)
    }

    fn read_joints(&mut self, mut entries: Entries) -> Found<()> {
        for (index, joint) in self.joints.clone().iter().enumerate() {
            let mut entry = entries.inner(joint)?;
            let is_base = index == 0 && entry.is_list(JOINT_FIELDS[0].name);
            for field in &JOINT_FIELDS {
                let several = is_base && !ONE_A_JOINT.contains(&field.name);
                (field.get_mut)(self).extend(one_or_six(&mut entry, field.name, field, several)?);
                if field.name == BEFORE_REVERSAL {
                    let count = if is_base { BASE_VARIABLES } else { 1 };
                    self.friction.reversal.extend(vec![reversal(&mut entry)?; count]);
                }
            }
            entry.done()?;
        }
        entries.done()
    }
}

/// What a joint has of a field, or a base that is free to move.
fn one_or_six<T, V>(entry: &mut Entries, name: &str, field: &Field<T, V>, is_base: bool) -> Found<Vec<f64>> {
    if is_base {
        return Ok(entry.numbers::<BASE_VARIABLES>(name, field.unit, field.rule)?.into());
    }
    Ok(vec![entry.number(name, field.unit, field.rule)?])
}

/// Without numbers: whoever adds a field to the core is told here to read it.
fn empty(robot: String, fingerprint: String, joints: Vec<String>) -> Calibration {
    Calibration {
        robot,
        fingerprint,
        joints,
        torque_bias: vec![],
        torque_bias_std: vec![],
        torque_scale: vec![],
        torque_is_external: false,
        friction: Friction::default(),
        hysteresis: vec![],
        hysteresis_std: vec![],
        hysteresis_width: vec![],
        coulomb_std: vec![],
        viscous_std: vec![],
        armature: vec![],
        armature_std: vec![],
        bodies: vec![],
        payload: None,
        inertial_change: 0.0,
        velocity_delay: 0.0,
        torque_delay: 0.0,
        sensor_offsets: vec![],
        noise: NoiseModel::default(),
        residual: vec![],
        tails: vec![],
        model_errors: vec![],
        false_alarms_per_hour: 1.0,
        contacts: vec![],
        notes: vec![],
    }
}

fn reversal(joint: &mut Entries) -> Found<Reversal> {
    let mut entries = joint.inner("reversal")?;
    let found = match entries.names()[..] {
        ["velocity"] => Reversal::Velocity(entries.number("velocity", VELOCITY, Rule::Positive)?),
        ["displacement"] => {
            Reversal::Displacement(entries.number("displacement", DISPLACEMENT, Rule::Positive)?)
        }
        ref names => {
            let problem = "must be {velocity: number} or {displacement: number}";
            return Err(entries.wrong(problem, &format!("{{{}}}", names.join(", "))));
        }
    };
    entries.done()?;
    Ok(found)
}

/// Of a calibration whose joints are read already.
fn noise(mut entries: Entries, of: &Calibration) -> Found<NoiseModel> {
    let mut noise = NoiseModel::default();
    for field in &NOISE_FIELDS {
        let mut numbers = vec![];
        if entries.is_mapping(field.name) {
            let mut by_joint = entries.inner(field.name)?;
            for (index, joint) in of.joints.iter().enumerate() {
                let is_base = index == 0 && of.base_variables() > 1;
                numbers.extend(one_or_six(&mut by_joint, joint, field, is_base)?);
            }
            by_joint.done()?;
        } else {
            numbers.push(entries.number(field.name, field.unit, field.rule)?);
        }
        *(field.get_mut)(&mut noise) = numbers;
    }
    entries.done()?;
    Ok(noise)
}

fn model_errors(mut entries: Entries, joints: &[String]) -> Found<Vec<ModelError>> {
    let mut errors: Vec<ModelError> = vec![];
    for (index, joint) in joints.iter().enumerate() {
        let items = entries.items(joint, &format!("lists of {MODEL_ERROR}"))?;
        if index == 0 {
            let none = || ModelError { bodies: vec![], bias: vec![], viscous: vec![] };
            errors.resize_with(items.len(), none);
        }
        if items.len() != errors.len() {
            let first = &joints[0];
            return Err(format!(
                "model_errors: {joint}: must have as many lists as {first}: {}, not {}",
                errors.len(),
                items.len()
            ));
        }
        for ((name, item), error) in items.into_iter().zip(&mut errors) {
            let [mass, x, y, z, bias, viscous] = entries.as_numbers(&name, item, MODEL_ERROR, Rule::Any)?;
            error.bodies.push([mass, x, y, z]);
            error.bias.push(bias);
            error.viscous.push(viscous);
        }
    }
    entries.done()?;
    Ok(errors)
}

fn bodies(mut entries: Entries, joints: &[String]) -> Found<Vec<BodyInertia>> {
    let mut found: Vec<Option<BodyInertia>> = joints.iter().map(|_| None).collect();
    for link in entries.names() {
        let mut entry = entries.inner(link)?;
        let joint = entry.text("joint")?;
        let free = joints.iter().zip(&mut found).find(|(known, body)| **known == joint && body.is_none());
        let Some((_, body)) = free else {
            let problem = format!("joint must be another one of {}", joints.join(", "));
            return Err(entry.wrong(&problem, &format!("'{joint}'")));
        };
        let inertia = entry.numbers("inertia", "kg m^2", Rule::Any)?;
        if let Some(moments) = negative_moments(&inertia) {
            let problem = "inertia: its principal moments must not be negative [kg m^2]";
            return Err(entry.wrong(problem, &format!("{moments:.9?}")));
        }
        *body = Some(BodyInertia {
            link: if link == nameless(&joint) { String::new() } else { link.to_owned() },
            mass: entry.number("mass", "kg", Rule::NotNegative)?,
            com: entry.numbers("com", "m", Rule::Any)?,
            inertia,
        });
        entry.done()?;
    }
    let missing = |joint: &String| entries.missing(&format!("the link that joint '{joint}' moves"));
    joints.iter().zip(found).map(|(joint, body)| body.ok_or_else(|| missing(joint))).collect()
}

fn payload(mut entries: Entries) -> Found<Payload> {
    let payload = Payload {
        link: entries.text("link")?,
        mass: entries.number("mass", "kg", Rule::NotNegative)?,
        mass_std: entries.number("mass_std", "kg", Rule::NotNegative)?,
        com: entries.numbers("com", "m", Rule::Any)?,
        com_std: entries.numbers("com_std", "m", Rule::NotNegative)?,
        moment: entries.number("moment", "kg m^2", Rule::NotNegative)?,
    };
    entries.done()?;
    Ok(payload)
}
