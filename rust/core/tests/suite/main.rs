//! The library as its users call it. One program, since each is linked for half a minute in a release build; the count of
//! allocations is of a whole process and has its own.

#[path = "../common/mod.rs"]
mod common;

mod dynamics;
mod errors;
mod golden;
mod mutated_files;
mod noise_model;
mod particle_filter;
#[cfg(feature = "serde")]
mod plain_data;
mod properties;
