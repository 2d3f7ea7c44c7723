//! Files that others wrote, read whole.

use std::fs::{metadata, File};
use std::io::Read;
use std::path::Path;

/// A regular file's bytes, if there are at most `largest` of them.
///
/// A device or a pipe can have no end, or no beginning, so neither is opened.
pub(crate) fn read(path: &Path, largest: u64) -> Result<Vec<u8>, String> {
    let about = metadata(path).map_err(|cause| cause.to_string())?;
    if !about.is_file() {
        return Err("it is not a regular file".into());
    }
    let too_large = |length: u64| format!("it has {length} bytes or more; at most {largest} are read");
    if about.len() > largest {
        return Err(too_large(about.len()));
    }
    let mut bytes = Vec::new();
    // A file may grow, or not know its size, as those in /proc.
    File::open(path)
        .and_then(|file| file.take(largest.saturating_add(1)).read_to_end(&mut bytes))
        .map_err(|cause| cause.to_string())?;
    if bytes.len() as u64 > largest {
        return Err(too_large(bytes.len() as u64));
    }
    Ok(bytes)
}
