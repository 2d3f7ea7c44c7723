//! The work that one call may take: so much that a tick of a 1 kHz loop ends in time, counted and not timed, so that the
//! answer does not depend on the machine.

/// Multiplications of one call for more than one contact: about half a millisecond of one core.
const MOST: usize = 500_000;

/// What is left of it.
#[derive(Debug, Clone)]
pub(super) struct Work {
    left: usize,
    refused: bool,
}

impl Work {
    pub fn new() -> Self {
        Self { left: MOST, refused: false }
    }

    /// Starts a call.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// Whether something was left undone for want of it.
    pub fn was_refused(&self) -> bool {
        self.refused
    }

    pub fn left(&self) -> usize {
        self.left
    }

    /// Takes so many multiplications; false, and none taken, where fewer are left.
    #[must_use]
    pub fn spend(&mut self, multiplications: usize) -> bool {
        let enough = multiplications <= self.left;
        if enough {
            self.left -= multiplications;
        }
        self.refused |= !enough;
        enough
    }
}
