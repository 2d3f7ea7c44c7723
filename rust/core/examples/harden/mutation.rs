//! Damage to the bytes of a file.

use crate::originals::WORDS;
use crate::random::Random;

/// Longest part that is removed or copied (bytes).
const LONGEST: usize = 80;
/// Most copies of it.
const COPIES: usize = 60;

/// One to five changes.
pub fn damage(random: &mut Random, bytes: &mut Vec<u8>) {
    for _ in 0..=random.below(5) {
        change(random, bytes);
    }
}

fn change(random: &mut Random, bytes: &mut Vec<u8>) {
    let at = random.below(bytes.len());
    let end = (at + 1 + random.below(LONGEST)).min(bytes.len());
    let start = at.min(end);
    match random.below(10) {
        0 if !bytes.is_empty() => bytes[at] = random.bits() as u8,
        1 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
        2 => drop(bytes.drain(start..end)),
        3 => {
            let part = bytes[start..end].repeat(2 + random.below(COPIES));
            bytes.splice(start..start, part);
        }
        4 => drop(bytes.splice(start..start, random.one_of(&WORDS).bytes())),
        5 => {
            let (part, to) = (bytes[start..end].to_vec(), random.below(bytes.len()));
            bytes.splice(to..to, part);
        }
        6 if random.once_in(3) => bytes.truncate(at),
        _ => {
            // Another word in place of the number or name that is there; sometimes one of the file's own.
            let (start, end) = word(bytes, at);
            let new = if random.once_in(3) {
                let (from, to) = word(bytes, random.below(bytes.len()));
                bytes[from..to].to_vec()
            } else {
                random.one_of(&WORDS).as_bytes().to_vec()
            };
            bytes.splice(start..end, new);
        }
    }
}

/// Where the first number or name at or behind `at` begins and ends.
fn word(bytes: &[u8], at: usize) -> (usize, usize) {
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b".-_#".contains(byte);
    let at = at.min(bytes.len());
    let start = at + bytes[at..].iter().position(is_word).unwrap_or(0);
    let length = bytes[start..].iter().position(|byte| !is_word(byte)).unwrap_or(bytes.len() - start);
    (start, start + length)
}
