//! Arguments at which declared constants are tested; they are the same in every run.

use crate::problem::Problem;
use crate::tensor::{Point, Sym, mandel_len};

/// Numbers in [−1, 1) by xorshift (Marsaglia, 2003).
pub(crate) struct Samples(u64);

impl Default for Samples {
    fn default() -> Samples {
        Samples(0x2545_F491_4F6C_DD1D)
    }
}

impl Samples {
    pub(crate) fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A tensor of 𝕊^d with Mandel components below `size`.
    pub(crate) fn sym(&mut self, dim: usize, size: f64) -> Sym {
        let mut sym = Sym::ZERO;
        for m in 0..mandel_len(dim) {
            sym.0[m] = size * self.number();
        }
        sym
    }

    /// A number of either sign whose magnitude is spread over `decades` below `largest`, since the scale on which a law
    /// bends is not known.
    pub(crate) fn spread(&mut self, largest: f64, decades: f64) -> f64 {
        let size = largest * 10f64.powf(-decades * 0.5 * (1.0 + self.number()));
        if self.number() < 0.0 { -size } else { size }
    }
}

/// Diagonal of the bounding box of the body, m.
pub(super) fn diameter(problem: &Problem) -> f64 {
    let points = &problem.mesh.points;
    let extent = |d: usize| {
        let bounds =
            points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[d]), high.max(p[d])));
        (bounds.1 - bounds.0).max(0.0)
    };
    crate::tensor::length(&[extent(0), extent(1), extent(2)])
}

/// At most `count` of the points, spread evenly over the list.
pub(super) fn some(points: &[Point], count: usize) -> impl Iterator<Item = &Point> {
    points.iter().step_by(points.len().div_ceil(count).max(1))
}

/// The times t_n, at most about `count` of them, the first and the last among them.
pub(super) fn times(problem: &Problem, count: usize) -> Vec<f64> {
    problem.timeline.spread(count)
}
