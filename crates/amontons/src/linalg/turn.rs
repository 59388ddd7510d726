//! Changes of basis for the unknowns of a node.

use faer::Mat;

use crate::tensor::Point;

/// Orthonormal basis for the unknowns of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Unknowns of the node; those beyond the dimension are not used.
    pub unknowns: [u32; 3],
    /// Vectors of the basis; those beyond the dimension are not used.
    pub basis: [Point; 3],
    /// Dimension d.
    pub dim: usize,
}

impl Turn {
    /// Replaces the components of the node along the axes by those along the basis.
    pub fn forward(&self, x: &mut [f64]) {
        let v: [f64; 3] = std::array::from_fn(|c| if c < self.dim { x[self.unknowns[c] as usize] } else { 0.0 });
        for a in 0..self.dim {
            x[self.unknowns[a] as usize] = (0..self.dim).map(|c| self.basis[a][c] * v[c]).sum();
        }
    }

    /// Replaces the components of the node along the basis by those along the axes.
    pub fn back(&self, x: &mut [f64]) {
        let v: [f64; 3] = std::array::from_fn(|a| if a < self.dim { x[self.unknowns[a] as usize] } else { 0.0 });
        for c in 0..self.dim {
            x[self.unknowns[c] as usize] = (0..self.dim).map(|a| self.basis[a][c] * v[a]).sum();
        }
    }
}

/// Transforms a symmetric matrix into the bases of the nodes.
pub(super) fn turn(s: &mut Mat<f64>, turns: &[Turn]) {
    for j in 0..s.ncols() {
        if let Some(column) = s.col_mut(j).try_as_col_major_mut() {
            let column = column.as_slice_mut();
            for turn in turns {
                turn.forward(column);
            }
        }
    }
    // The rows: combinations of the columns of each node.
    for turn in turns {
        for i in 0..s.nrows() {
            let v: [f64; 3] =
                std::array::from_fn(|c| if c < turn.dim { s[(i, turn.unknowns[c] as usize)] } else { 0.0 });
            for a in 0..turn.dim {
                s[(i, turn.unknowns[a] as usize)] = (0..turn.dim).map(|c| turn.basis[a][c] * v[c]).sum();
            }
        }
    }
    // Symmetric to the bit, as products assume.
    for j in 0..s.ncols() {
        for i in 0..j {
            s[(j, i)] = s[(i, j)];
        }
    }
}
