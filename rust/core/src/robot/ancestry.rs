//! Which joints move which bodies.

/// One bit a pair of bodies: whether the first is on the way from the base to the second.
#[derive(Debug, Clone)]
pub(super) struct Ancestry {
    /// Words a row.
    stride: usize,
    bits: Vec<u64>,
}

impl Ancestry {
    /// Of the bodies from the base to each body, that body included.
    pub fn new(chains: &[Vec<usize>]) -> Self {
        let stride = chains.len().div_ceil(64);
        let mut bits = vec![0; stride * chains.len()];
        for (body, chain) in chains.iter().enumerate() {
            for above in chain {
                bits[body * stride + above / 64] |= 1 << (above % 64);
            }
        }
        Ancestry { stride, bits }
    }

    #[inline]
    pub fn moves(&self, joint: usize, body: usize) -> bool {
        self.bits[body * self.stride + joint / 64] >> (joint % 64) & 1 == 1
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
                assert_eq!(ancestry.moves(joint, body), chain.contains(&joint), "{joint} {body}");
            }
        }
    }
}
