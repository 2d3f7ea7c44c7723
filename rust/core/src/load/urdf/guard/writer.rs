//! XML text, element by element.

use std::fmt::Write;

/// Elements in the order they are written; the caller closes what it opens.
#[derive(Default)]
pub(super) struct Writer {
    pub text: String,
}

impl Writer {
    pub fn open(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.start(tag, attributes);
        self.text.push('>');
    }

    pub fn empty(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.start(tag, attributes);
        self.text.push_str("/>");
    }

    pub fn close(&mut self, tag: &str) {
        // Writing to a String cannot fail.
        let _ = write!(self.text, "</{tag}>");
    }

    fn start(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        let _ = write!(self.text, "<{tag}");
        for (key, value) in attributes {
            let _ = write!(self.text, " {key}=\"");
            for character in value.chars() {
                match character {
                    '&' => self.text.push_str("&amp;"),
                    '<' => self.text.push_str("&lt;"),
                    '>' => self.text.push_str("&gt;"),
                    '"' => self.text.push_str("&quot;"),
                    '\'' => self.text.push_str("&apos;"),
                    other => self.text.push(other),
                }
            }
            self.text.push('"');
        }
    }
}

/// Numbers as an attribute's value; reading them back gives the same bits.
pub(super) fn row(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    words.join(" ")
}
