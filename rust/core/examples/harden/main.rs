//! Long runs that try to break the core: random arguments, damaged files, millions of ticks.
//!
//! `cargo run --release -p contactsense --example harden -- arguments|files|soak [COUNT] [SEED]`

use std::process::ExitCode;

mod arguments;
mod calls;
mod files;
mod made;
mod mutation;
mod originals;
mod random;
mod robots;
mod soak;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: u64| words.get(k).map_or(Ok(default), |word| word.parse());
    let (kind, count) = match words.first().map(String::as_str) {
        Some("arguments") => ("arguments", 10_000_000),
        Some("files") => ("files", 100_000),
        Some("soak") => ("soak", 10_000_000),
        _ => ("", 0),
    };
    let (Ok(count), Ok(seed)) = (number(1, count), number(2, 1)) else {
        eprintln!("COUNT and SEED must be whole numbers");
        return ExitCode::from(2);
    };
    let held = match kind {
        "arguments" => arguments::run(count, seed),
        "files" => files::run(count, seed),
        "soak" => soak::run(count, seed, true),
        _ => {
            eprintln!("usage: harden arguments|files|soak [COUNT] [SEED]");
            return ExitCode::from(2);
        }
    };
    match held {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
