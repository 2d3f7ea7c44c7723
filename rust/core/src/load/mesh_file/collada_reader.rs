//! References and numbers of a COLLADA document.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::str::FromStr;

use nalgebra::{Matrix4, Rotation3, Unit, Vector3};
use roxmltree::Node;

pub(super) type Result<T> = std::result::Result<T, String>;

/// Most work, one step a number read. Each time that something is referenced counts, so that a short document whose
/// nodes hold each other twice, and those again, does not take for ever.
const MOST_WORK: usize = 50_000_000;

pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    // By local name: documents come with and without the namespace.
    node.children().find(|n| n.tag_name().name() == name)
}

/// Follows references and reads numbers, as long as there is work left.
pub(super) struct Reader<'a, 'i> {
    ids: HashMap<&'a str, Node<'a, 'i>>,
    work_left: usize,
}

impl<'a, 'i> Reader<'a, 'i> {
    pub fn new(root: Node<'a, 'i>) -> Self {
        let ids = root.descendants().filter_map(|n| n.attribute("id").map(|id| (id, n))).collect();
        Reader { ids, work_left: MOST_WORK }
    }

    /// What an element's `url` or `source` names.
    pub fn referenced(&self, node: Node<'a, 'i>) -> Result<Node<'a, 'i>> {
        let url = node.attribute("url").or(node.attribute("source")).unwrap_or("");
        let id = url.strip_prefix('#').unwrap_or(url);
        self.ids
            .get(id)
            .copied()
            .ok_or_else(|| format!("'{url}' in <{}> names nothing", node.tag_name().name()))
    }

    /// Counts `steps` of work.
    pub fn work(&mut self, steps: usize) -> Result<()> {
        let left = self.work_left.checked_sub(steps);
        self.work_left = left.ok_or("has nodes or numbers that are used too many times; simplify it")?;
        Ok(())
    }

    /// All numbers in an element's text.
    pub fn numbers<T: FromStr>(&mut self, node: Node) -> Result<Vec<T>> {
        let mut numbers = Vec::new();
        for word in words(node) {
            self.work(1)?;
            numbers.push(number(word, node)?);
        }
        Ok(numbers)
    }

    /// The numbers in an element's text, which must be `N`.
    fn array<const N: usize>(&mut self, node: Node) -> Result<[f64; N]> {
        self.work(N)?;
        let found: Vec<f64> =
            words(node).take(N + 1).map(|word| number(word, node)).collect::<Result<_>>()?;
        found.try_into().map_err(|_| format!("<{}> needs {N} numbers", node.tag_name().name()))
    }

    /// The transform that an element of a node is.
    pub fn transform(&mut self, element: Node) -> Result<Matrix4<f64>> {
        Ok(match element.tag_name().name() {
            "matrix" => Matrix4::from_row_slice(&self.array::<16>(element)?),
            "translate" => Matrix4::new_translation(&Vector3::from(self.array::<3>(element)?)),
            "scale" => Matrix4::new_nonuniform_scaling(&Vector3::from(self.array::<3>(element)?)),
            "rotate" => {
                let [x, y, z, degrees] = self.array::<4>(element)?;
                match Unit::try_new(Vector3::new(x, y, z), 0.0) {
                    Some(axis) => Rotation3::from_axis_angle(&axis, degrees * PI / 180.0).to_homogeneous(),
                    None => Matrix4::identity(),
                }
            }
            name @ ("lookat" | "skew") => return Err(format!("<{name}> transforms are not supported")),
            _ => Matrix4::identity(),
        })
    }
}

fn words<'a>(node: Node<'a, '_>) -> impl Iterator<Item = &'a str> {
    node.children().filter_map(|n| n.text()).flat_map(str::split_whitespace)
}

fn number<T: FromStr>(word: &str, node: Node) -> Result<T> {
    word.parse().map_err(|_| format!("'{word}' in <{}> is no number", node.tag_name().name()))
}
