//! How deep a text's elements nest: the XML parser descends one call an element.

/// Far beyond any URDF, plugins included.
const DEEPEST: usize = 200;

/// Refuses text that nests too deep, or that declares a document type, whose entities could nest unseen.
///
/// Follows well-formed text exactly; where it is not well-formed the parser stops.
pub(crate) fn check(text: &str) -> Result<(), String> {
    let mut rest = text;
    let mut depth = 0_usize;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        rest = if let Some(comment) = rest.strip_prefix("!--") {
            after(comment, "-->")
        } else if let Some(characters) = rest.strip_prefix("![CDATA[") {
            after(characters, "]]>")
        } else if rest.starts_with('!') {
            return Err("it declares a document type, which is not supported".into());
        } else if let Some(instruction) = rest.strip_prefix('?') {
            after(instruction, "?>")
        } else if let Some(closing) = rest.strip_prefix('/') {
            depth = depth.saturating_sub(1);
            closing
        } else {
            let (empty, behind) = tag(rest);
            depth += usize::from(!empty);
            if depth > DEEPEST {
                return Err(format!("its elements are nested deeper than {DEEPEST}"));
            }
            behind
        };
    }
    Ok(())
}

fn after<'a>(text: &'a str, end: &str) -> &'a str {
    text.split_once(end).map_or("", |(_, behind)| behind)
}

/// Whether an opening tag is empty (`<a/>`), and what follows it.
fn tag(text: &str) -> (bool, &str) {
    let mut quote = None;
    let mut previous = b' ';
    for (index, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (Some(open), _) if open == byte => quote = None,
            (Some(_), _) => {}
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'>') => return (previous == b'/', &text[index + 1..]),
            (None, _) => {}
        }
        previous = byte;
    }
    (false, "")
}
