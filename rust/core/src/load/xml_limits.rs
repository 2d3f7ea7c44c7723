//! What the XML parser needs limited: it descends one call an element, compares each attribute of an element with all
//! others, and copies the namespaces in scope.

/// Far beyond any URDF, plugins included.
const DEEPEST: usize = 200;
/// Attributes of one element.
const MOST_ATTRIBUTES: usize = 256;
/// Namespaces declared by an element and those around it.
const MOST_NAMESPACES: usize = 64;

/// Refuses text beyond these limits, or that declares a document type, whose entities could nest unseen.
///
/// Follows well-formed text exactly; where it is not well-formed the parser stops.
pub(crate) fn check(text: &str) -> Result<(), String> {
    let mut rest = text;
    // How many namespaces are in scope in each of the open elements.
    let mut scopes: Vec<usize> = Vec::new();
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
            scopes.pop();
            closing
        } else {
            let tag = Tag::new(rest);
            let namespaces = scopes.last().unwrap_or(&0) + tag.namespaces;
            if !tag.empty {
                scopes.push(namespaces);
            }
            if scopes.len() > DEEPEST {
                return Err(format!("its elements are nested deeper than {DEEPEST}"));
            }
            if tag.attributes > MOST_ATTRIBUTES {
                return Err(format!("an element has more than {MOST_ATTRIBUTES} attributes"));
            }
            if namespaces > MOST_NAMESPACES {
                return Err(format!("more than {MOST_NAMESPACES} namespaces are declared at once"));
            }
            tag.behind
        };
    }
    Ok(())
}

fn after<'a>(text: &'a str, end: &str) -> &'a str {
    text.split_once(end).map_or("", |(_, behind)| behind)
}

/// An opening tag.
struct Tag<'a> {
    /// `<a/>`.
    empty: bool,
    attributes: usize,
    /// Of the attributes, those that declare one.
    namespaces: usize,
    /// What follows it.
    behind: &'a str,
}

impl<'a> Tag<'a> {
    fn new(text: &'a str) -> Self {
        let mut tag = Tag { empty: false, attributes: 0, namespaces: 0, behind: "" };
        let mut quote = None;
        let mut previous = b' ';
        for (index, byte) in text.bytes().enumerate() {
            match (quote, byte) {
                (Some(open), _) if open == byte => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'>') => {
                    tag.empty = previous == b'/';
                    tag.behind = &text[index + 1..];
                    break;
                }
                (None, b'=') => tag.attributes += 1,
                (None, b'x') if previous.is_ascii_whitespace() || matches!(previous, b'"' | b'\'') => {
                    tag.namespaces += usize::from(text[index..].starts_with("xmlns"));
                }
                (None, _) => {}
            }
            previous = byte;
        }
        tag
    }
}

#[cfg(test)]
mod tests {
    use super::check;

    fn many(what: impl Fn(usize) -> String, count: usize) -> String {
        (0..count).map(what).collect()
    }

    #[test]
    fn attributes_and_namespaces_are_limited() {
        let attributes = |count| format!("<a{}/>", many(|i| format!(" a{i}='>=x xmlns='"), count));
        let nested = |count| many(|i| format!("<a xmlns:b{i} = \"c\">"), count) + &"</a>".repeat(count);
        let beside = "<a xmlns='b'/>".repeat(1000);
        for good in [attributes(200), nested(60), format!("<a>{beside}</a>")] {
            assert_eq!(check(&good), Ok(()));
            roxmltree::Document::parse(&good).unwrap();
        }
        assert!(check(&attributes(300)).unwrap_err().contains("attributes"));
        assert!(check(&nested(70)).unwrap_err().contains("namespaces"));
    }
}
