//! Weights of the mass matrix: the density and the heat capacity.

use std::sync::Arc;

use crate::field::Coefficient;
use crate::forms;
use crate::linalg::{BlockMatrix, Graph};
use crate::mesh::Mesh;

/// Weight of (·, ·)_{L²}: one number if it is uniform, otherwise a weighted form of its own.
#[derive(Clone, Debug)]
pub(super) enum Weight {
    Same(f64),
    Varying(BlockMatrix),
}

impl Weight {
    pub fn new(mesh: &Mesh, graph: &Arc<Graph>, values: &[Coefficient<f64>]) -> Weight {
        let constant = |value: &Coefficient<f64>| value.constant();
        match values.iter().map(constant).collect::<Option<Vec<f64>>>().as_deref() {
            Some([first, rest @ ..]) if rest.iter().all(|value| value.to_bits() == first.to_bits()) => {
                Weight::Same(*first)
            }
            _ => Weight::Varying(forms::weighted_inner_h(mesh, graph, values).repeated()),
        }
    }

    /// The number that multiplies the form.
    pub fn factor(&self) -> f64 {
        match self {
            Weight::Same(value) => *value,
            Weight::Varying(_) => 1.0,
        }
    }

    pub fn form<'a>(&'a self, mass: &'a BlockMatrix) -> &'a BlockMatrix {
        match self {
            Weight::Same(_) => mass,
            Weight::Varying(form) => form,
        }
    }
}
