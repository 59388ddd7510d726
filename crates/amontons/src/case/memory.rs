//! Memory demand of a run, estimated before anything is built.

use super::raw;

/// Size of a mesh before it is built.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MeshSize {
    /// Dimension.
    pub dim: usize,
    /// Number of nodes, and of those on Γ_C, as reals because they may not fit an integer.
    pub nodes: f64,
    pub contact_nodes: f64,
    /// Mean number of nodes that share a cell with a node, including itself.
    pub neighbours: f64,
}

/// Unknowns and memory of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeshDemand {
    /// Nodes of the mesh, as a real because they may not fit an integer.
    pub nodes: f64,
    /// Unknowns of displacement and temperature.
    pub unknowns: f64,
    /// Bytes at the peak.
    pub bytes: f64,
}

impl MeshDemand {
    /// Upper bound of the memory of a run with its certificate, in addition to some 25 MB for the program. If the
    /// program chooses the solver, the bound is that of the iteration, which is chosen if a factor does not fit.
    ///
    /// Mesh, forms, multigrid levels and vectors are proportional to the nodes and their neighbours. A factor of a
    /// plane problem holds about 4.8 N log₂ N doubles, N the unknowns of the displacement. In space nested dissection
    /// leaves O(n^{4/3}) blocks for n nodes (George & Liu, 1981), of 9 doubles for the displacement and of 1 for the
    /// temperature: measured 5.6 n^{4/3} blocks on a box of 9³ nodes, rising to 9.3 n^{4/3} at 21³. Both are for linear
    /// simplices; more neighbours per node give more fill-in. The certificate has a second factor, and the condensed
    /// operator is dense, with its last factors. Measured runs take 0.5 to 0.95 of this, see the test below.
    pub fn of(size: &MeshSize, solver: raw::Backend) -> MeshDemand {
        /// Blocks of a factor in space over n^{4/3}, on the safe side.
        const FILL: f64 = 12.0;
        let MeshSize { dim, nodes, contact_nodes, neighbours } = *size;
        let components = dim as f64;
        let (condensed, displacement) = (components * contact_nodes, components * nodes);
        let in_space = dim == 3;
        let [of_node, of_neighbour] = if in_space { [8200.0, 545.0] } else { [1700.0, 320.0] };
        let rest = (of_node + of_neighbour * neighbours) * nodes;
        let factor = if in_space {
            8.0 * 10.0 * FILL * nodes.powf(4.0 / 3.0) * (neighbours / 15.0).powf(0.25)
        } else {
            8.0 * 4.8 * displacement * displacement.log2().max(0.0) * (neighbours / 7.0).powf(0.4)
        };
        let dense = if condensed < 2000.0 { 10.0 } else { 3.0 };
        let direct = rest + 2.0 * factor + dense * 8.0 * condensed * condensed;
        let bytes = match solver {
            raw::Backend::Direct => direct,
            raw::Backend::Auto | raw::Backend::Iterative => rest,
        };
        MeshDemand { nodes, unknowns: (components + 1.0) * nodes, bytes }
    }
}

/// A number of bytes with three digits: `1.25 GB`.
pub(super) fn bytes(count: f64) -> String {
    let (unit, name) =
        [(1e12, "TB"), (1e9, "GB"), (1e6, "MB")].into_iter().find(|(unit, _)| count >= *unit).unwrap_or((1e3, "kB"));
    let value = count / unit;
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    if value < 1e4 { format!("{value:.decimals$} {name}") } else { format!("{value:.2e} {name}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Element;
    use crate::quadrature::Shape;

    /// Peaks of two steps with the certificate, less 25 MB for the program, of the paper's square and of the cube of
    /// large systems; the integer is the number of nodes along an edge, less one.
    #[test]
    fn runs_take_no_more_than_is_predicted() {
        use Shape::{Hexahedron, Quadrilateral, Tetrahedron, Triangle};
        use raw::Backend::{Direct, Iterative};
        let measured: [(Shape, usize, usize, raw::Backend, f64); 18] = [
            (Triangle, 1, 256, Direct, 252e6),
            (Triangle, 1, 256, Iterative, 234e6),
            (Triangle, 2, 256, Direct, 473e6),
            (Triangle, 2, 256, Iterative, 306e6),
            (Quadrilateral, 1, 128, Direct, 91e6),
            (Quadrilateral, 1, 128, Iterative, 59e6),
            (Quadrilateral, 2, 256, Direct, 551e6),
            (Quadrilateral, 2, 256, Iterative, 389e6),
            (Tetrahedron, 1, 20, Direct, 465e6),
            (Tetrahedron, 1, 24, Direct, 911e6),
            (Tetrahedron, 1, 40, Iterative, 985e6),
            (Tetrahedron, 1, 69, Iterative, 4869e6),
            (Tetrahedron, 2, 20, Direct, 605e6),
            (Tetrahedron, 2, 32, Iterative, 746e6),
            (Hexahedron, 1, 20, Direct, 537e6),
            (Hexahedron, 1, 32, Iterative, 766e6),
            (Hexahedron, 2, 20, Direct, 782e6),
            (Hexahedron, 2, 32, Iterative, 1351e6),
        ];
        for (shape, degree, n, solver, peak) in measured {
            let (along, dim) = (n as f64 + 1.0, shape.dim());
            let [nodes, contact_nodes] = [dim, dim - 1].map(|power| along.powi(power as i32));
            let neighbours = Element::find(shape, degree).map_or(0.0, |element| element.neighbours);
            let size = MeshSize { dim, nodes, contact_nodes, neighbours };
            let share = peak / MeshDemand::of(&size, solver).bytes;
            assert!((0.5..0.95).contains(&share), "{shape:?}, degree {degree}, n = {n}, {solver:?}: {share:.3}");
        }
    }

    #[test]
    fn bytes_have_three_digits() {
        assert_eq!(
            [bytes(512.0), bytes(4.004e8), bytes(1.25e10), bytes(3e15)],
            ["0.51 kB", "400 MB", "12.5 GB", "3000 TB"]
        );
    }
}
