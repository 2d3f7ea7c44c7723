//! Files that others wrote, read whole.

use std::fs::{metadata, File};
use std::io::Read;
use std::path::Path;

use super::problem::Problem;

/// A regular file's bytes, if there are at most `largest` of them.
///
/// A device or a pipe can have no end, or no beginning, so neither is opened.
pub(crate) fn read(path: &Path, largest: u64) -> Result<Vec<u8>, Problem> {
    let about = metadata(path).map_err(Problem::from_error)?;
    if !about.is_file() {
        return Err("it is not a regular file".into());
    }
    let too_large = |length: u64| format!("it has {length} bytes or more; at most {largest} are read");
    if about.len() > largest {
        return Err(too_large(about.len()).into());
    }
    let mut bytes = Vec::new();
    // A file may grow, or not know its size, as those in /proc.
    File::open(path)
        .and_then(|file| file.take(largest.saturating_add(1)).read_to_end(&mut bytes))
        .map_err(Problem::from_error)?;
    if bytes.len() as u64 > largest {
        return Err(too_large(bytes.len() as u64).into());
    }
    Ok(bytes)
}
