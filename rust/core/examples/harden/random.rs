//! Random numbers and arguments, the same for the same seed.

/// Of splitmix64.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;
/// What arithmetic stumbles over.
const ODD: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    -1e300,
    1e154,
    5e-324,
    -1e-310,
    1e-12,
    -0.0,
    0.0,
    1e9,
    -1e9,
    1e5,
];

pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// That of one case of a run.
    pub fn of_case(seed: u64, case: u64) -> Self {
        let mut first = Random(seed);
        Random(first.bits() ^ case.wrapping_mul(STEP))
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }

    /// Once in `n`.
    pub fn once_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    pub fn one_of<T: Clone>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())].clone()
    }

    /// From minus one to one.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Nearly a standard normal number: the sum of twelve uniform ones.
    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| 0.5 * self.unit()).sum()
    }

    /// Odd once in `rarity`; else of any usual size.
    pub fn number(&mut self, rarity: usize) -> f64 {
        if self.once_in(rarity) {
            return self.one_of(&ODD);
        }
        self.unit() * self.one_of(&[1e-3, 0.1, 1.0, 1.0, 3.0, 50.0])
    }

    /// Often valid, else with odd numbers, or of another length.
    pub fn vector(&mut self, n: usize) -> Vec<f64> {
        let length = match self.below(24) {
            0 => 0,
            1 => n.saturating_sub(1),
            2 => n + 1,
            3 => 3 * n,
            _ => n,
        };
        let rarity = self.one_of(&[2, 8, usize::MAX, usize::MAX, usize::MAX]);
        (0..length).map(|_| self.number(rarity)).collect()
    }

    pub fn array<const N: usize>(&mut self) -> [f64; N] {
        let rarity = self.one_of(&[2, 8, usize::MAX, usize::MAX]);
        std::array::from_fn(|_| self.number(rarity))
    }

    pub fn wrenches(&mut self, n: usize) -> Vec<Option<[f64; 6]>> {
        let length = if self.once_in(8) { self.below(4) } else { n };
        (0..length).map(|_| (!self.once_in(6)).then(|| self.array())).collect()
    }
}
