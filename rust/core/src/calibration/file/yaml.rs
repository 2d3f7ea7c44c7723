//! A YAML file as a tree, of which nothing is lost or taken for something else.

use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use saphyr_parser::{Event, Parser, ScalarStyle, Span};

/// Mappings and lists in each other at most; a calibration has four.
const DEEPEST: usize = 20;

pub(super) enum Node {
    Mapping(Vec<(Scalar, Rc<Node>)>),
    List(Vec<Rc<Node>>),
    Scalar(Scalar),
}

/// A text, a number, true or false, or nothing.
#[derive(Clone)]
pub(super) struct Scalar {
    pub(super) text: String,
    /// In quotes, it is a text whatever it holds.
    quoted: bool,
}

/// What a scalar says.
pub(super) enum Value<'a> {
    Null,
    Flag(bool),
    Number(f64),
    Text(&'a str),
}

impl Scalar {
    /// By the core schema of YAML 1.2.
    pub(super) fn value(&self) -> Value<'_> {
        let text = self.text.as_str();
        if self.quoted {
            return Value::Text(text);
        }
        match text {
            "" | "~" | "null" | "Null" | "NULL" => Value::Null,
            "true" | "True" | "TRUE" => Value::Flag(true),
            "false" | "False" | "FALSE" => Value::Flag(false),
            ".nan" | ".NaN" | ".NAN" => Value::Number(f64::NAN),
            _ => match text.strip_prefix(['+', '-']).unwrap_or(text) {
                ".inf" | ".Inf" | ".INF" => Value::Number(f64::INFINITY),
                unsigned if unsigned.starts_with(|c: char| c.is_ascii_digit() || c == '.') => {
                    text.parse().map_or(Value::Text(text), Value::Number)
                }
                _ => Value::Text(text),
            },
        }
    }

    /// As it stands in the file.
    pub(super) fn shown(&self) -> String {
        match self.quoted {
            true => format!("'{}'", self.text),
            false if self.text.is_empty() => "nothing".into(),
            false => self.text.clone(),
        }
    }
}

/// A mapping or a list whose end has not come yet.
struct Open {
    line: usize,
    anchor: usize,
    node: Node,
    /// Of a mapping, those so far.
    names: HashSet<String>,
    /// The name whose value comes next.
    name: Option<Scalar>,
}

#[derive(Default)]
struct Tree {
    open: Vec<Open>,
    anchors: HashMap<usize, Rc<Node>>,
    root: Option<Rc<Node>>,
}

/// The tree of the only document, or what is wrong with it.
pub(super) fn parse(text: &str) -> Result<Rc<Node>, String> {
    let mut tree = Tree::default();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| format!("is no YAML: {error}"))?;
        tree.take(event, span)?;
    }
    let nothing = || Rc::new(Node::Scalar(Scalar { text: String::new(), quoted: false }));
    Ok(tree.root.unwrap_or_else(nothing))
}

impl Tree {
    fn take(&mut self, event: Event, span: Span) -> Result<(), String> {
        let line = span.start.line();
        match event {
            Event::Scalar(_, _, _, Some(_))
            | Event::SequenceStart(_, Some(_))
            | Event::MappingStart(_, Some(_)) => {
                Err(format!("line {line}: tags (what begins with !) are not read"))
            }
            Event::Scalar(text, style, anchor, None) => {
                let scalar = Scalar { text: text.into_owned(), quoted: style != ScalarStyle::Plain };
                match self.open.last_mut() {
                    Some(Open { node: Node::Mapping(_), names, name: name @ None, line, .. }) => {
                        if !names.insert(scalar.text.clone()) {
                            return Err(format!(
                                "'{}' stands twice in the mapping at line {line}",
                                scalar.text
                            ));
                        }
                        *name = Some(scalar);
                        Ok(())
                    }
                    _ => self.put(Rc::new(Node::Scalar(scalar)), anchor, line),
                }
            }
            Event::SequenceStart(anchor, None) => self.begin(Node::List(vec![]), anchor, line),
            Event::MappingStart(anchor, None) => self.begin(Node::Mapping(vec![]), anchor, line),
            Event::SequenceEnd | Event::MappingEnd => match self.open.pop() {
                Some(ended) => self.put(Rc::new(ended.node), ended.anchor, ended.line),
                None => Ok(()),
            },
            Event::Alias(anchor) => match self.anchors.get(&anchor) {
                Some(node) => self.put(node.clone(), 0, line),
                None => Err(format!("line {line}: an alias stands inside what it is for")),
            },
            Event::DocumentStart(_) if self.root.is_some() => {
                Err(format!("line {line}: a second document begins; there must be one"))
            }
            _ => Ok(()),
        }
    }

    fn begin(&mut self, node: Node, anchor: usize, line: usize) -> Result<(), String> {
        if self.open.len() == DEEPEST {
            return Err(format!("line {line}: cannot be read: more than {DEEPEST} lists in lists"));
        }
        if let Some(Open { node: Node::Mapping(_), name: None, .. }) = self.open.last() {
            return Err(format!("line {line}: a name must be a text"));
        }
        self.open.push(Open { line, anchor, node, names: HashSet::new(), name: None });
        Ok(())
    }

    fn put(&mut self, node: Rc<Node>, anchor: usize, line: usize) -> Result<(), String> {
        if anchor > 0 {
            self.anchors.insert(anchor, node.clone());
        }
        match self.open.last_mut() {
            None => self.root = Some(node),
            Some(Open { node: Node::List(items), .. }) => items.push(node),
            Some(Open { node: Node::Mapping(pairs), name, .. }) => match name.take() {
                Some(name) => pairs.push((name, node)),
                None => return Err(format!("line {line}: a name must be a text")),
            },
            Some(Open { node: Node::Scalar(_), .. }) => {}
        }
        Ok(())
    }
}
