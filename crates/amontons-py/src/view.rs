//! Arrays that numpy reads without a copy.
#![allow(unsafe_code, reason = "numpy borrows memory of Rust through one function, which is unsafe")]

use numpy::ndarray::{ArrayView, Dimension, IntoDimension};
use numpy::{Element, PyArray};
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::errors::wrong;

/// An object whose numbers stay at the same address as long as it lives: it is frozen, and nothing in it is replaced.
pub trait Keeper: pyo3::PyClass<Frozen = pyo3::pyclass::boolean_struct::True> + Sync {}

/// Numbers of a keeper as an array of this shape, which is read-only and keeps the keeper alive.
pub fn array<'py, T: Element, K: Keeper, D: IntoDimension>(
    keeper: &Bound<'py, K>,
    numbers: impl FnOnce(&K) -> &[T],
    shape: D,
) -> PyResult<Bound<'py, PyAny>>
where
    D::Dim: Dimension,
{
    let view = ArrayView::from_shape(shape, numbers(keeper.get())).map_err(|error| wrong(&error))?;
    // SAFETY: the numbers belong to the keeper, which is frozen and never changes or moves them, and the array holds a
    // reference to it. The array is made read-only before anyone else sees it.
    let array: Bound<'py, PyArray<T, D::Dim>> = unsafe { PyArray::borrow_from_array(&view, keeper.clone().into_any()) };
    array.getattr("flags")?.setattr("writeable", false)?;
    Ok(array.into_any())
}
