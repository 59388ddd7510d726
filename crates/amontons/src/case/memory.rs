//! What a run needs of memory, estimated before anything of it is built.

use crate::mesh::{Diagonal, rectangle_nodes};

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
    /// Demand of a run on a rectangle mesh with `contact_cells` cells along Γ_C.
    ///
    /// The factors of a plane problem hold about 4.8 N log₂ N doubles, N the unknowns of the
    /// displacement, and everything else 4.7 kB a node: together the 400 MB measured for the
    /// square of 256 × 256 cells. The condensed operator and its factor are dense.
    pub fn of_rectangle(cells: [usize; 2], diagonal: Diagonal, contact_cells: usize) -> Demand {
        let nodes = rectangle_nodes(cells, diagonal);
        let displacement = 2.0 * nodes;
        let condensed = 2.0 * (contact_cells as f64 + 1.0);
        let factors = 8.0 * 4.8 * displacement * displacement.log2();
        let bytes = factors + 4.7e3 * nodes + 2.0 * 8.0 * condensed * condensed;
        Demand { nodes, unknowns: 3.0 * nodes, bytes }
    }
}

/// Bytes of memory that are free for use, where the system tells.
pub(super) fn available() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024.0)
}

/// A number of bytes with three digits: `1.25 GB`.
pub(super) fn bytes(count: f64) -> String {
    let (unit, name) = [(1e12, "TB"), (1e9, "GB"), (1e6, "MB")].into_iter().find(|(unit, _)| count >= *unit).unwrap_or((1e3, "kB"));
    let value = count / unit;
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    if value < 1e4 { format!("{value:.decimals$} {name}") } else { format!("{value:.2e} {name}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_of_256_cells_needs_what_was_measured() {
        let demand = Demand::of_rectangle([256, 256], Diagonal::Right, 256);
        assert!((demand.bytes / 4e8 - 1.0).abs() < 0.05, "{}", bytes(demand.bytes));
        assert!((demand.unknowns - 3.0 * 66_049.0).abs() < 0.5);
    }

    #[test]
    fn bytes_have_three_digits() {
        assert_eq!([bytes(512.0), bytes(4.004e8), bytes(1.25e10), bytes(3e15)], ["0.51 kB", "400 MB", "12.5 GB", "3000 TB"]);
    }
}
