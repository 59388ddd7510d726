//! What a run needs of memory, estimated before anything of it is built.

use super::raw;

/// Unknowns and memory of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Demand {
    /// Nodes of the mesh, as a real because they may not fit an integer.
    pub nodes: f64,
    /// Unknowns of displacement and temperature.
    pub unknowns: f64,
    /// Bytes at the peak.
    pub bytes: f64,
}

impl Demand {
    /// Demand of a run in `dim` dimensions on a mesh with so many nodes, so many of them on Γ_C, with factors.
    ///
    /// The factors of a plane problem hold about 4.8 N log₂ N doubles, N the unknowns of the
    /// displacement, and everything else 4.7 kB per node: together the 400 MB measured for the
    /// square of 256 × 256 cells. In space nested dissection leaves a factor of O(n^{4/3}) blocks for n nodes
    /// (George & Liu, 1981), 9 doubles a block of the displacement and 1 of the temperature: measured 5.6 n^{4/3}
    /// blocks on a box of 9³ nodes, rising to 9.3 n^{4/3} at 21³, so FILL is on the safe side. Everything else has
    /// three times as many neighbours. The condensed operator and its factor are dense.
    pub fn of(dim: usize, nodes: f64, contact_nodes: f64) -> Demand {
        const FILL: f64 = 12.0;
        let components = dim as f64;
        let condensed = components * contact_nodes;
        let displacement = components * nodes;
        let factors = if dim == 3 {
            8.0 * 10.0 * FILL * nodes.powf(4.0 / 3.0)
        } else {
            8.0 * 4.8 * displacement * displacement.log2().max(0.0)
        };
        let rest = if dim == 3 { 1.4e4 } else { 4.7e3 };
        let bytes = factors + rest * nodes + 2.0 * 8.0 * condensed * condensed;
        Demand { nodes, unknowns: (components + 1.0) * nodes, bytes }
    }

    /// The same as systems are solved: by an iteration 12.8 kB per node, measured on cubes of tetrahedra of 36 thousand
    /// nodes, and a fourth more to be on the safe side. A choice that is left to the program fits if either way does.
    pub fn solved_by(self, solver: raw::Backend) -> Demand {
        let iterative = 1.6e4 * self.nodes;
        let bytes = match solver {
            raw::Backend::Auto => self.bytes.min(iterative),
            raw::Backend::Direct => self.bytes,
            raw::Backend::Iterative => iterative,
        };
        Demand { bytes, ..self }
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

    #[test]
    fn the_square_of_256_cells_needs_what_was_measured() {
        let demand = Demand::of(2, 66_049.0, 257.0);
        assert!((demand.bytes / 4e8 - 1.0).abs() < 0.05, "{}", bytes(demand.bytes));
        assert!((demand.unknowns - 3.0 * 66_049.0).abs() < 0.5);
    }

    #[test]
    fn bytes_have_three_digits() {
        assert_eq!(
            [bytes(512.0), bytes(4.004e8), bytes(1.25e10), bytes(3e15)],
            ["0.51 kB", "400 MB", "12.5 GB", "3000 TB"]
        );
    }
}
