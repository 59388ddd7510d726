//! Arguments at which declared constants are tested, and how their places are written; they are the same in every run.

use crate::problem::Problem;
use crate::tensor::{Point, Sym, mandel_len};

/// Pairs of arguments per point on which declared constants are tested.
pub(super) const PAIRS: usize = 128;

/// Points of the body or of Γ_C at which they are tested.
pub(super) const PLACES: usize = 8;

/// Fraction by which a sample may exceed a declared constant: round-off of a difference quotient.
pub(super) const SLACK: f64 = 1e-9;

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

/// The text that follows a number attained at a place and a temperature, ` at (0.0, 1.0, 0.0), θ = 20.0`; empty without
/// these.
pub(super) fn attained(x: Option<Point>, theta: Option<f64>) -> String {
    let place = x.map(|x| format!(" at {}", at(&x))).unwrap_or_default();
    place + &theta.map(|theta| format!(", θ = {theta:?}")).unwrap_or_default()
}

/// The coordinates of a point as readable text.
pub(super) fn at(x: &Point) -> String {
    let short = |v: f64| format!("{v:.5e}").parse::<f64>().map_or_else(|_| v.to_string(), |v| format!("{v:?}"));
    format!("({}, {}, {})", short(x[0]), short(x[1]), short(x[2]))
}
