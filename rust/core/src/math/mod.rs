//! Mathematics without robots: bisection, least squares, chi-square, streams of random numbers, QR of few columns.

pub(crate) mod bisection;
pub(crate) mod chi_square;
pub(crate) mod least_squares;
pub(crate) mod random;
pub(crate) mod triangle;
