//! Isolated points and forces.

use contactsense::isolation::{Contact, ContactIsolator, Isolation, IsolatorOptions};
use nalgebra::Vector3;

use super::data::{read, robot, Contacts, Push};

const ROBOTS: [&str; 3] = ["iiwa14", "atlas", "meshed_arm"];
/// Of a point from exact torques [m].
const EXACT: f64 = 1e-6;
/// A noisy point may be off by this [m] and so many of its standard deviations.
const NEAR: f64 = 0.01;
const SIGMAS: f64 = 4.0;

fn isolator(name: &str, torque_threshold: f64) -> ContactIsolator {
    let options =
        IsolatorOptions { torque_threshold: Some(vec![torque_threshold]), ..IsolatorOptions::default() };
    ContactIsolator::new(robot(name), &options).expect("valid options")
}

fn error(contact: &Contact, push: &Push) -> f64 {
    let place = contact.place.expect("a contact that is located has a place");
    (place.point - Vector3::from(push.point)).norm()
}

/// Whether a candidate of the contact is the true point.
fn offered(isolation: &Isolation, contact: &Contact, push: &Push) -> bool {
    let candidates = &isolation.candidates[contact.candidates.clone()];
    candidates.iter().any(|candidate| (candidate.point - Vector3::from(push.point)).norm() < EXACT)
}

/// Where the joints determine the wrench and its line enters nothing else, point and force are exact; where it enters
/// more, the answer is either exact or open, the true point among the candidates; elsewhere it is exact or open.
#[test]
fn exact_torques_give_link_point_and_force() {
    for name in ROBOTS {
        let robot = robot(name);
        let mut isolator = isolator(name, 1e-3);
        let (mut alone, mut located) = (0, 0);
        for (k, push) in read::<Contacts>(&format!("contacts_{name}")).contacts.iter().enumerate() {
            let isolation = isolator.isolate(&push.q, &push.torque).expect("valid input");
            let what = format!("{name}, push {k}: {push:?}\n{isolation:?}");
            let [contact] = &isolation.contacts[..] else { panic!("one contact expected: {what}") };
            if contact.located {
                located += 1;
                assert_eq!(robot[contact.link].name, push.link, "{what}");
                assert!(error(contact, push) < EXACT, "{what}");
                let force = Vector3::from(push.force);
                let (found, place) = contact.force().zip(contact.place).expect(&what);
                assert!((found - force).norm() < EXACT * force.norm(), "{what}");
                assert!((place.normal - Vector3::from(push.normal)).norm() < EXACT, "{what}");
            } else if push.determined {
                assert!(push.entries != [1, 0], "not located: {what}");
                assert!(offered(isolation, contact, push), "{what}");
            } else {
                assert_eq!(robot[contact.link].name, push.link, "{what}");
            }
            alone += usize::from(push.determined && push.entries == [1, 0]);
        }
        assert!(alone >= 20 && located >= alone, "{name}: {alone} alone, {located} located");
    }
}

/// A point that is reported is near the truth, or its standard deviation says how far it may be.
#[test]
fn noisy_torques_give_no_confident_wrong_point() {
    for name in ROBOTS {
        let data: Contacts = read(&format!("contacts_{name}"));
        let mut isolator = isolator(name, 3.0 * data.noise);
        let mut wrong = vec![];
        for (k, push) in data.contacts.iter().enumerate() {
            let isolation = isolator.isolate(&push.q, &push.noisy_torque).expect("valid input");
            for contact in isolation.contacts.iter().filter(|contact| contact.located) {
                let (error, std) = (error(contact, push), contact.place.map_or(f64::NAN, |place| place.std));
                if error > NEAR + SIGMAS * std || std.is_nan() {
                    wrong.push(format!("push {k} on {}: {error:.3} m off, std {std:.4} m", push.link));
                }
            }
        }
        assert!(wrong.is_empty(), "{name}: {wrong:#?}");
    }
}
