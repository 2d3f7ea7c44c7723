//! Calibration files: YAML that people read and edit.

mod entries;
mod layout;
mod read;
mod write;
mod yaml;

#[cfg(test)]
mod tests {
    use crate::calibration::Calibration;
    use crate::robot::Robot;

    #[test]
    fn what_is_written_is_read() {
        let mut calibration = Calibration::of_description(&Robot::example_arm());
        calibration.torque_bias[2] = -0.123_456_789_012_3;
        calibration.notes.push("a: \"b\"\n\u{85}\\".into());
        let text = calibration.to_yaml("a # b", "").unwrap();
        let read = Calibration::from_yaml(&text).unwrap();
        assert!((read.torque_bias[2] - calibration.torque_bias[2]).abs() < 1e-10);
        assert_eq!(read.notes, calibration.notes);
        // Ten digits are kept as they are.
        assert_eq!(read.to_yaml("a # b", "").unwrap(), text);
        assert_eq!(Calibration::from_yaml(&text).unwrap(), read);
    }

    #[test]
    fn a_file_has_at_least_one_joint() {
        let described = Calibration::of_description(&Robot::example_arm());
        let without = Calibration { joints: vec![], ..described };
        let error = without.to_yaml("", "").unwrap_err();
        assert!(error.to_string().contains("joints: a file keeps one entry a joint"), "{error}");
    }
}
