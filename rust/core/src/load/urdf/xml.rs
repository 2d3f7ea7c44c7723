//! XML as a small tree of what is used of it.

use quick_xml::events::{BytesStart, Event};
use quick_xml::Reader;

use crate::error::{Error, Result};
use crate::load::problem::Problem;

/// An element; text between elements is not kept.
#[derive(Clone, Default)]
pub(super) struct Element {
    pub tag: String,
    pub attributes: Vec<(String, String)>,
    pub children: Vec<Element>,
}

fn not_xml(what: impl Into<Problem>) -> Error {
    let Problem { text, cause } = what.into();
    Error::model(format!("it is not XML: {text}")).because(cause)
}

fn broken(cause: impl std::error::Error + Send + Sync + 'static) -> Error {
    not_xml(Problem::from_error(cause))
}

impl Element {
    /// The root element, without the descendants for which `is_read(parent's tag, tag)` does not hold.
    ///
    /// Namespaces mean nothing, as in urdfdom; a prefix is part of the tag.
    pub fn parse(text: &str, is_read: impl Fn(&str, &str) -> bool) -> Result<Element> {
        let mut reader = Reader::from_str(text.trim_start());
        // The root's parent, the root, and what is open in it.
        let mut open = vec![Element::default()];
        loop {
            let (start, is_empty) = match reader.read_event().map_err(broken)? {
                Event::Start(start) => (start, false),
                Event::Empty(start) => (start, true),
                Event::End(_) => {
                    close(&mut open);
                    continue;
                }
                Event::DocType(_) => {
                    return Err(not_xml("it declares a document type, which is not supported"));
                }
                Event::Eof if open.len() > 1 => return Err(not_xml("it is cut short")),
                Event::Eof => {
                    let root = open.pop().and_then(|mut outside| outside.children.pop());
                    return root.ok_or_else(|| not_xml("it has no elements"));
                }
                _ => continue,
            };
            let element = Element::new(&start)?;
            if open.len() > 1 && !is_read(&open[open.len() - 1].tag, &element.tag) {
                if !is_empty {
                    reader.read_to_end(start.name()).map_err(broken)?;
                }
                continue;
            }
            open.push(element);
            if is_empty {
                close(&mut open);
            }
        }
    }

    fn new(start: &BytesStart<'_>) -> Result<Element> {
        let mut attributes = vec![];
        for attribute in start.attributes().with_checks(false) {
            let attribute = attribute.map_err(broken)?;
            let value = attribute.decode_and_unescape_value(start.decoder()).map_err(broken)?;
            let name = String::from_utf8_lossy(attribute.key.as_ref()).into_owned();
            attributes.push((name, value.into_owned()));
        }
        let tag = String::from_utf8_lossy(start.name().as_ref()).into_owned();
        Ok(Element { tag, attributes, children: vec![] })
    }

    /// A URDF's root element.
    pub fn robot(name: &str, children: Vec<Element>) -> Element {
        Element { tag: "robot".into(), attributes: vec![("name".into(), name.to_owned())], children }
    }

    /// An attribute's value, empty where there is none.
    pub fn attribute(&self, name: &str) -> &str {
        self.attributes.iter().find(|(known, _)| known == name).map_or("", |(_, value)| value)
    }

    pub fn name(&self) -> &str {
        self.attribute("name")
    }

    /// A link or joint as messages name it.
    pub fn owner(&self) -> String {
        format!("{} '{}'", self.tag, self.name())
    }

    /// The numbers in an attribute that was checked.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        self.attribute(name).split_whitespace().filter_map(|word| word.parse().ok()).collect()
    }

    /// The first child of a tag.
    pub fn child(&self, tag: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.tag == tag)
    }

    /// The element as text.
    pub fn text(&self) -> String {
        let mut text = String::new();
        self.write(&mut text);
        text
    }

    fn write(&self, text: &mut String) {
        *text += &format!("<{}", self.tag);
        for (name, value) in &self.attributes {
            // Line ends in an attribute are read as blanks unless they are written as characters.
            let value = quick_xml::escape::escape(value.as_str());
            let value = value.replace('\n', "&#10;").replace('\r', "&#13;").replace('\t', "&#9;");
            *text += &format!(" {name}=\"{value}\"");
        }
        text.push('>');
        self.children.iter().for_each(|child| child.write(text));
        *text += &format!("</{}>", self.tag);
    }
}

fn close(open: &mut Vec<Element>) {
    if let (Some(closed), Some(parent)) = (open.pop(), open.last_mut()) {
        parent.children.push(closed);
    }
}
