//! Joints and sensors as one tree of signals, and the links between them (Vorndamme 2017, eq. 21 on a tree).

use std::collections::HashMap;

use crate::robot::{LinkIndex, Robot, WORLD};
use crate::sensor::SensorTree;

/// A joint's or a sensor's place in the tree.
#[derive(Debug, Clone)]
struct Node {
    signal: Signal,
    parent: Option<usize>,
    /// Touchable links between this signal and the next ones.
    links: Vec<LinkIndex>,
}

/// What can be over its threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Signal {
    /// Of the joint that moves a body.
    Joint {
        body: usize,
    },
    Sensor(usize),
}

/// Finds the links behind the last signal over its threshold and before the next under it, on every branch.
#[derive(Debug, Clone)]
pub(super) struct SignalTree {
    /// Towards the tips: each after its parent.
    nodes: Vec<Node>,
    felt_behind: Vec<bool>,
    in_region: Vec<bool>,
}

impl SignalTree {
    pub fn new(robot: &Robot, sensors: &SensorTree) -> Self {
        let links = robot.links();
        // The signal that a link hangs behind.
        let signal_of = |link: usize| {
            let body = links[link].body;
            match sensors.fixed_of_link(link) {
                Some(sensor) if sensors.body(sensor) == body => Some(Signal::Sensor(sensor)),
                _ if body == WORLD => None,
                _ => Some(Signal::Joint { body }),
            }
        };
        let parent_of = |signal: Signal| match signal {
            Signal::Joint { body } => match sensors.joint_link(body).and_then(|link| links[link].parent) {
                Some(parent) => signal_of(parent),
                None => Some(robot.parent_body(body))
                    .filter(|body| *body != WORLD)
                    .map(|body| Signal::Joint { body }),
            },
            Signal::Sensor(sensor) => {
                let link = sensors.link(sensor);
                let body = links[link].body;
                match links[link].parent {
                    Some(parent) if links[parent].body == body => signal_of(parent),
                    _ => Some(Signal::Joint { body }),
                }
            }
        };
        let joints = (WORLD + 1..robot.body_count()).map(|body| Signal::Joint { body });
        let mut signals: Vec<Signal> = joints.chain((0..sensors.len()).map(Signal::Sensor)).collect();
        let depth = |signal: Signal| std::iter::successors(Some(signal), |signal| parent_of(*signal)).count();
        signals.sort_by_cached_key(|signal| depth(*signal));
        let places: HashMap<Signal, usize> = signals.iter().copied().zip(0..).collect();
        let place = |signal: Signal| places.get(&signal).copied();
        let mut nodes: Vec<Node> = signals
            .iter()
            .map(|&signal| Node { signal, parent: parent_of(signal).and_then(place), links: vec![] })
            .collect();
        for &link in robot.touchable_links() {
            if let Some(node) = signal_of(link.get()).and_then(place) {
                nodes[node].links.push(link);
            }
        }
        let count = nodes.len();
        Self { nodes, felt_behind: vec![false; count], in_region: vec![false; count] }
    }

    /// Writes the region's links, farthest from the base first. `over` tells whether a signal is over its threshold,
    /// `passes` whether a sensor says nothing, so that a region goes on behind it.
    pub fn region(
        &mut self,
        over: impl Fn(Signal) -> bool,
        passes: impl Fn(usize) -> bool,
        region: &mut Vec<LinkIndex>,
    ) {
        region.clear();
        self.felt_behind.fill(false);
        self.in_region.fill(false);
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let felt = over(node.signal);
            self.in_region[index] = felt && !self.felt_behind[index];
            if let Some(parent) = node.parent.filter(|_| felt || self.felt_behind[index]) {
                self.felt_behind[parent] = true;
            }
        }
        for (index, node) in self.nodes.iter().enumerate() {
            if let (Signal::Sensor(sensor), Some(parent)) = (node.signal, node.parent) {
                // A joint with a sensor at its own link has no link of its own: its signal is about those behind.
                let before = &self.nodes[parent];
                let shares_joint = before.links.is_empty() && matches!(before.signal, Signal::Joint { .. });
                if self.in_region[parent] && !over(node.signal) && (passes(sensor) || shares_joint) {
                    self.in_region[index] = true;
                }
            }
        }
        for (node, _) in self.nodes.iter().zip(&self.in_region).rev().filter(|(_, inside)| **inside) {
            region.extend_from_slice(&node.links);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Signal, SignalTree};
    use crate::robot::{test_tree, LinkDescription, LinkIndex};
    use crate::sensor::SensorTree;
    use crate::spatial::Pose;
    use crate::surface::{Geometry, Part};

    #[test]
    fn a_long_chain_is_put_in_order() {
        // Takes minutes where each comparison of the sort walks down the chain and through all links.
        let count = 2000;
        let joint = |index: usize| test_tree::joint(&format!("j{index}"), index);
        let link = |index: usize| LinkDescription {
            geometry: vec![Part { geometry: Geometry::Sphere { radius: 0.1 }, pose: Pose::identity() }],
            ..test_tree::link(&format!("l{index}"), index, index.checked_sub(1))
        };
        let robot = test_tree::robot((0..count).map(joint).collect(), (0..=count).map(link).collect());
        let mut tree = SignalTree::new(&robot, &SensorTree::new(&robot, &[]).unwrap());
        let mut region = Vec::new();
        tree.region(|signal| signal == Signal::Joint { body: 1500 }, |_| false, &mut region);
        assert_eq!(region, [LinkIndex::new(1500)]);
    }
}
