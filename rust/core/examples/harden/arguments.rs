//! Random arguments for every public call of the core: an answer that is finite, or a typed error.

use std::panic::{catch_unwind, AssertUnwindSafe};

use contactsense::{Error, Result};

use crate::calls::{call, Objects};
use crate::random::Random;

/// After so many calls the objects must still answer what is right.
const PROBE: u64 = 1000;
/// Objects are made anew, with other options, after so many.
const RENEWED: u64 = 100_000;
/// Failures that are printed.
const MOST_PRINTED: u64 = 20;

/// Makes `count` calls; whether none made a panic, and every answer was finite.
pub fn run(count: u64, seed: u64) -> Result<bool> {
    let mut objects = Objects::new(&mut Random::new(seed))?;
    let (mut taken, mut panics, mut wrong) = ([0_u64; 2], 0_u64, 0_u64);
    for case in 0..count {
        let mut random = Random::of_case(seed, case);
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let (name, result) = call(&mut objects, &mut random);
            let probed = if case % PROBE == 0 { objects.probe() } else { Ok(()) };
            (name, result, probed)
        }));
        let problem = match outcome {
            Ok((name, result, probed)) => {
                taken[usize::from(result.is_err())] += 1;
                match (result, probed) {
                    (Ok(false), _) => Some(format!("{name}: an answer that is not finite")),
                    (_, Err(error)) => Some(format!("after {name}: {error}")),
                    (Err(Error::Stopped), _) => Some(format!("{name}: stopped by nobody")),
                    _ => None,
                }
            }
            Err(_) => {
                panics += 1;
                Some("panic".into())
            }
        };
        if let Some(problem) = problem {
            wrong += 1;
            if wrong <= MOST_PRINTED {
                println!("{problem} (seed {seed}, case {case})");
            }
            objects = Objects::new(&mut random)?;
        }
        if case % RENEWED == RENEWED - 1 {
            objects = Objects::new(&mut random)?;
        }
    }
    let [answered, refused] = taken;
    println!("{count} calls: {answered} answered, {refused} refused by a typed error, {panics} panics");
    println!("{} calls with another failure", wrong - panics);
    Ok(wrong == 0)
}
