//! Mathematics without robots: least squares, limits of chi-square, streams of random numbers.

pub(crate) mod chi_square;
pub(crate) mod least_squares;
pub(crate) mod random;
