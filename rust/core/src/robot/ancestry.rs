//! Which nodes of a tree lie on the way to which: joints that move bodies, sensors that others load.

/// One bit a pair: whether the first is on the way from the root to the second.
#[derive(Debug, Clone)]
pub(crate) struct Ancestry {
    /// Words a row.
    stride: usize,
    bits: Vec<u64>,
}

impl Ancestry {
    /// Of the nodes from the root to each node, that one included.
    pub fn new(chains: &[Vec<usize>]) -> Self {
        let stride = chains.len().div_ceil(64);
        let mut bits = vec![0; stride * chains.len()];
        for (node, chain) in chains.iter().enumerate() {
            for above in chain {
                bits[node * stride + above / 64] |= 1 << (above % 64);
            }
        }
        Ancestry { stride, bits }
    }

    /// Whether `above` is `node`, or on the way from the root to there.
    #[inline]
    pub fn leads_to(&self, above: usize, node: usize) -> bool {
        self.bits[node * self.stride + above / 64] >> (above % 64) & 1 == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_those_of_the_chains() {
        // A long chain with a branch from its middle, over more than two words.
        let mut chains: Vec<Vec<usize>> = vec![vec![]];
        for body in 1..150 {
            let parent = if body == 100 { 50 } else { body - 1 };
            let mut chain = chains[parent].clone();
            chain.push(body);
            chains.push(chain);
        }
        let ancestry = Ancestry::new(&chains);
        for (body, chain) in chains.iter().enumerate() {
            for joint in 0..150 {
                assert_eq!(ancestry.leads_to(joint, body), chain.contains(&joint), "{joint} {body}");
            }
        }
    }
}
