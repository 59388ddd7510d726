//! Directions of the degrees of freedom at nodes with an oblique prescribed direction.

use std::borrow::Cow;

use crate::tensor::{Point, dot};

/// Directions of the degrees of freedom of a node that differ from the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeFrame {
    /// The node.
    pub node: u32,
    /// Orthonormal directions, one per degree of freedom.
    pub axes: [Point; 3],
}

/// The directions of the degrees of freedom of a node; `frames` are sorted by node.
pub fn directions(frames: &[NodeFrame], node: u32) -> [Point; 3] {
    match frames.binary_search_by_key(&node, |frame| frame.node) {
        Ok(i) => frames[i].axes,
        Err(_) => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    }
}

/// Converts components along the axes to those in the frames.
pub fn enter(frames: &[NodeFrame], components: usize, values: &mut [f64]) {
    for NodeFrame { node, axes } in frames {
        let Some(at) = values.get_mut(*node as usize * components..).and_then(|at| at.get_mut(..components)) else {
            continue;
        };
        let v: Point = std::array::from_fn(|c| at.get(c).copied().unwrap_or_default());
        at.iter_mut().zip(axes).for_each(|(value, axis)| *value = dot(axis, &v));
    }
}

/// Converts a vector without changing the original.
pub fn entered<'v>(frames: &[NodeFrame], components: usize, values: &'v [f64]) -> Cow<'v, [f64]> {
    if frames.is_empty() {
        return Cow::Borrowed(values);
    }
    let mut values = values.to_vec();
    enter(frames, components, &mut values);
    Cow::Owned(values)
}

/// Converts components in the frames to those along the axes.
pub fn leave(frames: &[NodeFrame], components: usize, values: &mut [f64]) {
    for NodeFrame { node, axes } in frames {
        let Some(at) = values.get_mut(*node as usize * components..).and_then(|at| at.get_mut(..components)) else {
            continue;
        };
        let v: Point = std::array::from_fn(|c| at.get(c).copied().unwrap_or_default());
        for (c, value) in at.iter_mut().enumerate() {
            *value = (0..components).map(|a| axes[a][c] * v[a]).sum();
        }
    }
}
