//! A URDF file's text.

use std::path::Path;

use crate::error::{Error, Result};
use crate::load::problem::Problem;
use crate::load::regular_file;

/// Larger files are not read [bytes]: 20 times the largest URDF published.
const LARGEST_FILE: u64 = 1 << 24;

/// The file's text, decoded as its byte order mark or XML declaration says.
pub(super) fn read(path: &Path) -> Result<String> {
    let shown = path.display();
    let bytes = regular_file::read(path, LARGEST_FILE).map_err(|said| {
        Error::model(format!("cannot read the URDF file '{shown}': {said}")).because(said.cause)
    })?;
    decode(bytes).map_err(|said| Error::model(format!("'{shown}' is not XML: {said}")).because(said.cause))
}

fn decode(bytes: Vec<u8>) -> std::result::Result<String, Problem> {
    let utf16 = |unit: fn([u8; 2]) -> u16| {
        let (units, rest) = bytes[2..].as_chunks::<2>();
        let text = String::from_utf16(&units.iter().map(|&pair| unit(pair)).collect::<Vec<u16>>());
        text.ok().filter(|_| rest.is_empty()).ok_or_else(|| Problem::from("it is not valid UTF-16"))
    };
    if bytes.starts_with(&[0xff, 0xfe]) {
        return utf16(u16::from_le_bytes);
    }
    if bytes.starts_with(&[0xfe, 0xff]) {
        return utf16(u16::from_be_bytes);
    }
    match encoding(&bytes).as_deref() {
        None | Some("utf-8" | "utf8" | "us-ascii" | "ascii") => {
            let text = String::from_utf8(bytes).map_err(Problem::from_error)?;
            Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
        }
        // Latin-1 is the first 256 characters of Unicode.
        Some("iso-8859-1" | "latin-1" | "latin1") => Ok(bytes.into_iter().map(char::from).collect()),
        Some(other) => {
            Err(format!("unknown encoding '{other}'; supported: UTF-8, UTF-16, ISO-8859-1").into())
        }
    }
}

/// The encoding that the XML declaration names, in lower case.
fn encoding(bytes: &[u8]) -> Option<String> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).into_owned();
    let (declaration, _) = head.trim_start_matches('\u{feff}').strip_prefix("<?xml")?.split_once("?>")?;
    let (_, rest) = declaration.split_once("encoding")?;
    let rest = rest.trim_start().strip_prefix('=')?.trim_start();
    let quote = rest.chars().next().filter(|quote| "\"'".contains(*quote))?;
    Some(rest[1..].split(quote).next()?.to_ascii_lowercase())
}
