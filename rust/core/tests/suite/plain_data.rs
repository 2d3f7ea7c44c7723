//! Plain data survives the way through a file.

use std::sync::Arc;

use contactsense::isolation::{ContactIsolator, IsolatorOptions};
use contactsense::load::{UrdfGeometry, UrdfOptions};
use contactsense::map::{ContactMap, MapEstimate, MapOptions};
use contactsense::monitor::{ContactMonitor, ContactReport, MonitorOptions};
use contactsense::particle::{FilterOptions, ForceModel};
use contactsense::robot::{Robot, RobotDescription};
use contactsense::sensor::{Convention, ForceTorqueSensor};
use contactsense::Sample;
use nalgebra::Vector3;
use serde::de::DeserializeOwned;
use serde::Serialize;

/// By values, whose numbers keep all their digits.
fn there_and_back<T: Serialize + DeserializeOwned>(data: &T) -> T {
    let value = serde_json::to_value(data).expect("plain data");
    serde_json::from_value(value).expect("what was written")
}

fn wrist() -> ForceTorqueSensor {
    ForceTorqueSensor {
        convention: Convention::Support,
        offset: [1.0, 0.0, -2.0, 0.0, 0.1, 0.0],
        ..ForceTorqueSensor::new("wrist", "link_6")
    }
}

#[test]
fn a_description_gives_the_same_robot() {
    let description = RobotDescription::example_arm();
    let read = there_and_back(&description);
    assert_eq!(read, description);
    let text = serde_json::to_string(&description).expect("plain data");
    assert!(text.contains(r#""kind":"revolute""#) && text.contains(r#""capsule":{"#), "{text}");
    let [given, read] = [description, read].map(|description| Robot::new(description).expect("a valid arm"));
    let mass = |robot: &Robot| robot.mass_matrix(&[0.4; 7]).expect("valid input");
    assert_eq!(mass(&given), mass(&read));
}

#[test]
fn options_are_as_they_were_written() {
    let read: UrdfOptions = serde_json::from_str(r#"{"geometry": "visual"}"#).expect("the rest has defaults");
    assert_eq!(read, UrdfOptions { geometry: UrdfGeometry::Visual, ..UrdfOptions::default() });
    let wrong = serde_json::from_str::<UrdfOptions>(r#"{"geometri": "visual"}"#);
    assert!(wrong.expect_err("a slip").to_string().contains("geometri"));
    let text = r#"{"particles": 500, "force_model": {"friction_cone": 0.5}}"#;
    let read: FilterOptions = serde_json::from_str(text).expect("the rest has defaults");
    let force_model = ForceModel::FrictionCone(0.5);
    assert_eq!(read, FilterOptions { particles: 500, force_model, ..FilterOptions::default() });
    let read: MapOptions =
        serde_json::from_str(r#"{"samples": 500, "links": ["link_7"]}"#).expect("the rest has defaults");
    let links = Some(vec!["link_7".into()]);
    assert_eq!(read, MapOptions { samples: 500, links, ..MapOptions::default() });
    let wrong = serde_json::from_str::<MapOptions>(r#"{"sample": 500}"#);
    assert!(wrong.expect_err("a slip").to_string().contains("sample"));
    // The defaults of thresholds are another matter in a monitor, so that none may be left out.
    let partial = serde_json::from_str::<IsolatorOptions>(r#"{"max_contacts": 2}"#);
    assert!(partial.expect_err("no thresholds").to_string().contains("torque_threshold"));

    let mut options = MonitorOptions { bias_time_constant: Some(2.0), ..MonitorOptions::new(1e-3) };
    options.isolation.sensors.push(wrist());
    assert_eq!(there_and_back(&options), options);
}

#[test]
fn reports_keep_what_is_not_known() {
    let robot = Arc::new(Robot::example_arm());
    let mut options = MonitorOptions::new(1e-3);
    options.isolation.sensors.push(wrist());
    let mut monitor = ContactMonitor::new(robot, &options).expect("valid options");
    let (q, v) = ([0.4; 7], [0.0; 7]);
    let report = monitor.update(&Sample::new(&q, &v, &v).wrenches(&[None])).expect("valid input");
    let read: ContactReport = there_and_back(report);
    assert_eq!((&read, read.wrenches[0]), (report, None));
}

#[test]
fn contacts_are_the_same() {
    let robot = Arc::new(Robot::example_arm());
    let link = robot.link("link_7").expect("a link of the arm");
    let q = [0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0];
    let pose = robot.link_pose(&q, link).expect("valid input");
    let point = pose.transform_point(&Vector3::new(0.05, 0.0, 0.1));
    let jacobian = robot.jacobian(&q, link, Some(point.into())).expect("valid input");
    let force = pose.rotation * Vector3::new(-20.0, 0.0, 0.0);
    let torque = jacobian.rows(0, 3).transpose() * force;
    let mut isolator = ContactIsolator::new(robot, &IsolatorOptions::default()).expect("valid options");
    for torque in [torque.as_slice(), &[1.0, 2.0, 0.5, 0.0, 0.0, 0.0, 0.0]] {
        let isolation = isolator.isolate(&q, torque).expect("valid input");
        assert!(!isolation.contacts.is_empty());
        assert_eq!(&there_and_back(isolation), isolation);
    }
}

#[test]
fn a_posterior_is_the_same() {
    let robot = Arc::new(Robot::example_arm());
    let mut map =
        ContactMap::new(robot, &MapOptions { samples: 500, ..MapOptions::default() }).expect("valid options");
    let found = map.evaluate(&[0.4; 7], &[1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]).expect("valid input");
    let read: MapEstimate = there_and_back(found);
    assert_eq!(
        serde_json::to_string(&read).expect("plain data"),
        serde_json::to_string(found).expect("plain data")
    );
}
