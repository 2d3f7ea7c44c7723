//! Friction-cone problems, for tests that solve them in another way.

use contactsense::best_cone_force;
use contactsense::nalgebra::{Matrix3, Vector3};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{rows, Vector};
use crate::errors::input;
use crate::returned::{from_rows, numbers};

type Solved<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Vec<&'static str>);

/// Forces `(n, 3)`, objectives `(n,)` and parts of the cone; a problem a row, of Gram matrices by rows, `(n, 9)`, products
/// `(n, 3)` and friction coefficients `(n,)`.
#[pyfunction]
pub fn _best_cone_forces<'py>(
    py: Python<'py>,
    grams: &Bound<'py, PyAny>,
    products: &Bound<'py, PyAny>,
    frictions: &Bound<'py, PyAny>,
) -> PyResult<Solved<'py>> {
    let grams = rows::<9>("grams", grams)?;
    let products = rows::<3>("products", products)?;
    let frictions = Vector::new("frictions", frictions)?;
    if products.len() != grams.len() || frictions.slice().len() != grams.len() {
        return Err(input(py, format!("products, frictions: expected as many as grams, {}", grams.len())));
    }
    let problems = grams.iter().zip(&products).zip(frictions.slice());
    let solved: Vec<_> = problems
        .map(|((gram, products), friction)| {
            best_cone_force(&Matrix3::from_row_slice(gram), &Vector3::from(*products), *friction)
        })
        .collect();
    let objectives: Vec<f64> = solved.iter().map(|found| found.objective).collect();
    let parts = solved.iter().map(|found| found.part.name()).collect();
    let forces = from_rows(py, solved.iter().map(|found| found.force.into()))?;
    Ok((forces, numbers(py, &objectives), parts))
}
