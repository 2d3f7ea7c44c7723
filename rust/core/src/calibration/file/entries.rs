//! The entries of a mapping; what is missing, wrong or left over is refused by name.

use std::borrow::Borrow;

use super::layout::Rule;
use super::yaml::{Node, Scalar, Value};

/// Of a value that a message shows (characters).
const SHOWN: usize = 60;

/// What is wrong, and where in the file.
pub(super) type Found<T> = Result<T, String>;

/// A mapping of the file.
pub(super) struct Entries<'a> {
    /// The entries that lead to it, for messages.
    path: String,
    left: Vec<(&'a str, &'a Node)>,
    known: Vec<String>,
}

impl<'a> Entries<'a> {
    pub(super) fn new(path: String, node: &'a Node) -> Found<Self> {
        let Node::Mapping(pairs) = node else {
            return Err(format!("{path}must be a mapping of names to values, not {}", shown(node)));
        };
        let mut left = Vec::with_capacity(pairs.len());
        for (name, value) in pairs {
            if !matches!(name.value(), Value::Text(_)) {
                return Err(format!("{path}the name {} must be a text; put it in quotes", name.shown()));
            }
            left.push((name.text.as_str(), value.borrow()));
        }
        Ok(Entries { path, left, known: vec![] })
    }

    /// What is left.
    pub(super) fn names(&self) -> Vec<&'a str> {
        self.left.iter().map(|(name, _)| *name).collect()
    }

    pub(super) fn is_mapping(&self, name: &str) -> bool {
        self.left.iter().any(|(known, node)| *known == name && matches!(node, Node::Mapping(_)))
    }

    pub(super) fn is_list(&self, name: &str) -> bool {
        self.left.iter().any(|(known, node)| *known == name && matches!(node, Node::List(_)))
    }

    /// Takes an entry where it is null, and says so.
    pub(super) fn take_null(&mut self, name: &str) -> bool {
        let null = |node: &Node| matches!(node, Node::Scalar(it) if matches!(it.value(), Value::Null));
        let found = self.left.iter().position(|(known, node)| *known == name && null(node));
        found.map(|index| self.left.remove(index)).is_some()
    }

    /// The message for something that is not there.
    pub(super) fn missing(&self, what: &str) -> String {
        format!("{}{what} is missing", self.path)
    }

    /// The message for a value of this mapping.
    pub(super) fn wrong(&self, problem: &str, value: &str) -> String {
        let cut = value
            .char_indices()
            .nth(SHOWN)
            .map_or(value.to_owned(), |(end, _)| value[..end].to_owned() + "...");
        format!("{}{problem}, not {cut}", self.path)
    }

    /// The value of an entry.
    pub(super) fn take(&mut self, name: &str, wanted: &str) -> Found<&'a Node> {
        self.known.push(name.to_owned());
        match self.left.iter().position(|(known, _)| *known == name) {
            Some(index) => Ok(self.left.remove(index).1),
            None => Err(self.missing(&format!("{name} ({wanted})"))),
        }
    }

    /// An entry that is a mapping.
    pub(super) fn inner(&mut self, name: &str) -> Found<Entries<'a>> {
        let node = self.take(name, "a mapping of names to values")?;
        Entries::new(format!("{}{name}: ", self.path), node)
    }

    /// An entry that is a text.
    pub(super) fn text(&mut self, name: &str) -> Found<String> {
        let node = self.take(name, "a text")?;
        self.as_text(name, node)
    }

    /// An entry that is true or false.
    pub(super) fn flag(&mut self, name: &str) -> Found<bool> {
        let node = self.take(name, "true or false")?;
        if let Node::Scalar(scalar) = node {
            if let Value::Flag(flag) = scalar.value() {
                return Ok(flag);
            }
        }
        Err(self.wrong(&format!("{name}: must be true or false"), &shown(node)))
    }

    /// An entry that is a number.
    pub(super) fn number(&mut self, name: &str, unit: &str, rule: Rule) -> Found<f64> {
        let node = self.take(name, &format!("{} [{unit}]", rule.wanted()))?;
        self.as_number(name, node, unit, rule)
    }

    /// An entry that is a list of so many numbers.
    pub(super) fn numbers<const N: usize>(&mut self, name: &str, unit: &str, rule: Rule) -> Found<[f64; N]> {
        let node = self.take(name, &format!("a list of {N} numbers [{unit}]"))?;
        self.as_numbers(name, node, unit, rule)
    }

    /// The items of an entry that is a list, each with a name for messages.
    pub(super) fn items(&mut self, name: &str, wanted: &str) -> Found<Vec<(String, &'a Node)>> {
        let node = self.take(name, &format!("a list of {wanted}, or []"))?;
        let Node::List(items) = node else {
            return Err(self.wrong(&format!("{name}: must be a list of {wanted}"), &shown(node)));
        };
        let named = items.iter().enumerate();
        Ok(named.map(|(index, item)| (format!("{name}[{index}]"), item.borrow())).collect())
    }

    /// An entry that is a list of texts.
    pub(super) fn texts(&mut self, name: &str, wanted: &str) -> Found<Vec<String>> {
        let items = self.items(name, wanted)?;
        items.into_iter().map(|(name, node)| self.as_text(&name, node)).collect()
    }

    pub(super) fn as_text(&self, name: &str, node: &Node) -> Found<String> {
        if let Node::Scalar(scalar) = node {
            if let Value::Text(text) = scalar.value() {
                return Ok(text.to_owned());
            }
        }
        Err(self.wrong(&format!("{name}: must be a text, in quotes if need be"), &shown(node)))
    }

    fn as_number(&self, name: &str, node: &Node, unit: &str, rule: Rule) -> Found<f64> {
        if let Node::Scalar(scalar) = node {
            if let Value::Number(number) = scalar.value() {
                if rule.allows(number) {
                    return Ok(number);
                }
            }
        }
        Err(self.wrong(&format!("{name}: must be {} [{unit}]", rule.wanted()), &shown(node)))
    }

    pub(super) fn as_numbers<const N: usize>(
        &self,
        name: &str,
        node: &Node,
        unit: &str,
        rule: Rule,
    ) -> Found<[f64; N]> {
        match node {
            Node::List(items) if items.len() == N => {
                let mut numbers = [0.0; N];
                for (number, item) in numbers.iter_mut().zip(items) {
                    *number = self.as_number(name, item, unit, rule)?;
                }
                Ok(numbers)
            }
            _ => Err(self.wrong(&format!("{name}: must be a list of {N} numbers [{unit}]"), &shown(node))),
        }
    }

    /// Refuses what nobody took.
    pub(super) fn done(self) -> Found<()> {
        match self.left.first() {
            Some((name, _)) => {
                let known = self.known.join(", ");
                Err(format!("{}there is no entry '{name}'; there are {known}", self.path))
            }
            None => Ok(()),
        }
    }
}

/// A value, for messages.
pub(super) fn shown(node: &Node) -> String {
    match node {
        Node::Mapping(_) => "a mapping".into(),
        Node::List(items) => {
            let scalar = |item: &Node| match item {
                Node::Scalar(scalar) => Scalar::shown(scalar),
                _ => "...".into(),
            };
            format!("[{}]", items.iter().take(SHOWN).map(|item| scalar(item)).collect::<Vec<_>>().join(", "))
        }
        Node::Scalar(scalar) => scalar.shown(),
    }
}
