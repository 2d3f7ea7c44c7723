//! Numbers as URDF attributes write them.

use roxmltree::Node;

use crate::error::{Error, Result};

/// Far beyond any robot, and small enough that products stay finite.
pub(super) const LARGEST: f64 = 1e12;

/// The kind of error to make of a message.
pub(super) type Kind = fn(String) -> Error;

/// `N` finite numbers separated by white space, or an error that starts with `what`.
pub(super) fn parse<const N: usize>(text: &str, what: &str, kind: Kind, largest: f64) -> Result<[f64; N]> {
    let mut values = [0.0; N];
    let mut count = 0;
    for word in text.split_whitespace() {
        let value = number(word).filter(|value| value.abs() <= largest);
        match (values.get_mut(count), value) {
            (Some(slot), Some(value)) => *slot = value,
            _ => return Err(wrong(text, N, what, kind, largest)),
        }
        count += 1;
    }
    if count == N {
        Ok(values)
    } else {
        Err(wrong(text, N, what, kind, largest))
    }
}

/// An element's attribute as one number; `owner` opens the error message.
pub(super) fn attribute(
    node: Node<'_, '_>,
    name: &str,
    owner: &str,
    kind: Kind,
    default: Option<f64>,
    largest: f64,
) -> Result<f64> {
    let tag = node.tag_name().name();
    match (node.attribute(name), default) {
        (Some(text), _) => {
            let [value] = parse::<1>(text, &format!("{owner}: '{name}' of <{tag}>"), kind, largest)?;
            Ok(value)
        }
        (None, Some(value)) => Ok(value),
        (None, None) => Err(kind(format!("{owner}: <{tag}> needs the attribute '{name}'"))),
    }
}

/// Narrower than `str::parse`, which also reads "nan" and "inf".
fn number(word: &str) -> Option<f64> {
    word.bytes()
        .all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte))
        .then(|| word.parse().ok())
        .flatten()
}

#[cold]
fn wrong(text: &str, count: usize, what: &str, kind: Kind, largest: f64) -> Error {
    let mut wanted = match count {
        1 => "a finite number".to_owned(),
        _ => format!("{count} finite numbers"),
    };
    if largest == LARGEST {
        wanted += " of magnitude up to 1e+12";
    }
    let shown: String = text.chars().take(80).collect();
    kind(format!("{what} must be {wanted}, not '{shown}'"))
}
