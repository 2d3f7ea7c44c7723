//! Short runs of what `cargo run --release --example harden` does for long.
#![allow(clippy::unwrap_used)]

#[path = "../examples/harden/arguments.rs"]
mod arguments;
#[path = "../examples/harden/calls.rs"]
mod calls;
#[path = "../examples/harden/files.rs"]
mod files;
#[path = "../examples/harden/made.rs"]
mod made;
#[path = "../examples/harden/mutation.rs"]
mod mutation;
#[path = "../examples/harden/originals.rs"]
mod originals;
#[path = "../examples/harden/random.rs"]
mod random;
#[path = "../examples/harden/robots.rs"]
mod robots;
#[path = "../examples/harden/soak.rs"]
mod soak;

/// Other cases than those of the long runs, which begin at seed 1.
const SEED: u64 = 2;

#[test]
fn random_arguments_make_no_panic() {
    assert!(arguments::run(20_000, SEED).unwrap());
}

#[test]
fn damaged_files_make_no_panic() {
    assert!(files::run(2_000, SEED).unwrap());
}

/// Times are those of a busy machine: memory alone is judged.
#[test]
fn ticks_do_not_use_more_and_more_memory() {
    assert!(soak::run(100_000, SEED, false).unwrap());
}
