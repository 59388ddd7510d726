//! Predicted time and memory of systems with a matrix, by a factor and by an iteration, from the pattern of the matrix
//! alone: nothing of the size of a factor is allocated.

use serde::Serialize;

use super::graph::Graph;
use super::ordering::{Ordering, column_lengths};

/// Operations per second of a factorization, and bytes per second that sweeps and products read, measured on one core
/// of 2026. Only their ratio decides.
const FACTORIZATION: f64 = 4e10;
const READING: f64 = 1e10;
/// Growth of a factor over its pattern by merged supernodes: measured 0.04 to 0.13.
const RELAXED: f64 = 1.15;
/// Bytes per entry of K: held by an iteration while its levels are built, and read by a product with the
/// preconditioner. Measured on cubes of 14 thousand to a million unknowns.
const LEVELS: f64 = 60.0;
const CYCLE: f64 = 25.0;
/// Products per step with contact, the growth with friction, and the cost of building the levels, in products.
const PRODUCTS: f64 = 60.0;
const RUBBING: f64 = 1.5;
const MAKING: f64 = 35.0;
/// Power of the slenderness of the cells with which the products grow: measured on plates of 5 to 47 thousand unknowns,
/// whose cells are 8 and 50 times as wide as high, 1.3 and 1.4 times the products of a cube for linear tetrahedra, 2.2
/// and 5.2 times for linear hexahedra, 1.6 and 2.2 times, and 1.3 and 2.7 times for quadratic ones.
const SLENDER: f64 = 0.25;
/// Cost that contact adds to a product if its points join nodes, with its share of the work per tangent, in bytes that
/// could be read meanwhile per unknown on Γ_C: measured 7e4 on pairs of 8 thousand to a million unknowns.
const JOINING: f64 = 7e4;
/// Contact patterns per step, for each of which S + J is factorized; unknowns on Γ_C from which on it is not
/// factorized, and products with S per step in that case.
pub const PATTERNS: f64 = 3.0;
const DENSE: f64 = 2000.0;
const DENSE_PRODUCTS: f64 = 800.0;
/// Bytes per number.
const NUMBER: f64 = 8.0;

/// Expected work of a run: number of factorizations, number of steps, and properties of contact and mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Workload {
    /// Number of factorizations.
    pub factorizations: f64,
    /// Number of steps: per step a pair of sweeps with the contact solved between them.
    pub steps: f64,
    /// True if there is friction.
    pub rubs: bool,
    /// True if a contact point joins nodes, as those of a pair do.
    pub joins: bool,
    /// Slenderness of the cells: [`Mesh::slenderness`](crate::mesh::Mesh::slenderness), 1 for regular ones.
    pub slenderness: f64,
    /// True if the body lies in the plane or on a line, where a factor takes less time than an iteration at every size.
    pub is_plane: bool,
}

impl Default for Workload {
    /// Default workload: one matrix, a hundred steps, contact without friction, regular cells in space.
    fn default() -> Workload {
        Workload { factorizations: 1.0, steps: 100.0, rubs: false, joins: false, slenderness: 1.0, is_plane: false }
    }
}

/// Predicted time and memory of a solver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Demand {
    /// Seconds on a core of 2026.
    pub seconds: f64,
    /// Peak memory in bytes.
    pub bytes: f64,
}

/// Size counts of a matrix and its factor, from their patterns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Estimate {
    /// Number of unknowns, those on Γ_C included.
    pub unknowns: usize,
    /// Number of unknowns on Γ_C.
    pub contact: usize,
    /// Number of entries of K.
    pub entries: f64,
    /// Number of entries of the factor.
    pub stored: f64,
    /// Operations of the factorization: additions and multiplications.
    pub flops: f64,
}

impl Estimate {
    /// Counts for nodes in this elimination order, with `components` degrees of freedom per node, some of them free. A
    /// column of the factor with c entries takes c² operations.
    #[must_use]
    pub fn of(graph: &Graph, free: &[bool], components: usize, ordering: &Ordering) -> Estimate {
        let weights: Vec<u32> =
            free.chunks_exact(components.max(1)).map(|node| node.iter().map(|free| u32::from(*free)).sum()).collect();
        let of_pair = |i: usize, j: &u32| f64::from(weights[i]) * f64::from(weights[*j as usize]);
        let entries = (0..graph.len()).map(|i| graph.row(i).iter().map(|j| of_pair(i, j)).sum::<f64>()).sum();
        let (mut stored, mut flops) = (0.0, 0.0);
        for (&node, length) in ordering.order.iter().zip(column_lengths(graph, ordering, &weights)) {
            for own in 0..weights[node as usize] {
                let c = length - f64::from(own);
                stored += c;
                flops += c * c;
            }
        }
        let count = |nodes: &[u32]| nodes.iter().map(|&node| weights[node as usize] as usize).sum();
        let contact = count(&ordering.order[ordering.interior..]);
        Estimate { unknowns: count(&ordering.order), contact, entries, stored, flops }
    }

    /// Predicts time and memory with a factor, contact unknowns last, S dense.
    #[must_use]
    pub fn direct(&self, work: &Workload) -> Demand {
        let n = self.contact as f64;
        let patterns = if n < DENSE { PATTERNS } else { 1.0 };
        let step = self.sweeps() + patterns * self.on_contact();
        let seconds = work.factorizations * self.factor() + work.steps * step;
        // Memory: the entries of K with their rows, by columns; S with its factor, and the last contact patterns.
        let condensed = if n < DENSE { 10.0 } else { 3.0 };
        Demand { seconds, bytes: NUMBER * (RELAXED * self.stored + condensed * n * n) + 6.0 * self.entries }
    }

    /// Time of a factorization, s.
    fn factor(&self) -> f64 {
        (self.flops + (self.contact as f64).powi(3) / 3.0) / FACTORIZATION
    }

    /// Time of a pair of sweeps, s.
    fn sweeps(&self) -> f64 {
        2.0 * NUMBER * self.stored / READING
    }

    /// Time on Γ_C, s: the factor per contact pattern, or the products that replace it.
    fn on_contact(&self) -> f64 {
        let n = self.contact as f64;
        if n < DENSE { 2.0 / 3.0 * n.powi(3) / FACTORIZATION } else { DENSE_PRODUCTS * NUMBER * n * n / READING }
    }

    /// Times in s of a factorization, and of one system with a new contact pattern, solved with the factor.
    #[must_use]
    pub fn factor_and_system(&self) -> [f64; 2] {
        [self.factor(), self.sweeps() + self.on_contact()]
    }

    /// Times in s of building the levels of an iteration, and of one of its products; `joins` as in [`Workload`].
    #[must_use]
    pub fn levels_and_product(&self, joins: bool) -> [f64; 2] {
        let cycle = CYCLE * self.entries / READING;
        [MAKING * cycle, cycle + if joins { JOINING * self.contact as f64 / READING } else { 0.0 }]
    }

    /// Predicts time and memory with conjugate gradients or GMRES and smoothed aggregation.
    #[must_use]
    pub fn iterative(&self, work: &Workload) -> Demand {
        let [levels, product] = self.levels_and_product(work.joins);
        let products = work.slenderness.max(1.0).powf(SLENDER) * if work.rubs { RUBBING * PRODUCTS } else { PRODUCTS };
        let seconds = levels * work.factorizations + product * products * work.steps;
        Demand { seconds, bytes: LEVELS * self.entries }
    }

    /// Operations per step and bytes that it reads, with a factor: two sweeps and two solutions on Γ_C.
    #[must_use]
    pub fn direct_step(&self) -> [f64; 2] {
        let read = 2.0 * self.stored + 2.0 * (self.contact as f64).powi(2);
        [2.0 * read, NUMBER * read]
    }

    /// Operations per step and bytes that it reads, with an iteration, whose cycles are in single precision.
    #[must_use]
    pub fn iterative_step(&self) -> [f64; 2] {
        let read = PRODUCTS * CYCLE * self.entries;
        [0.5 * read, read]
    }
}

/// Fraction of the free memory that the systems of a run may take.
const SHARE: f64 = 0.85;

/// Solver of a system, with the reason and the predicted costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Choice {
    /// `direct` or `iterative`.
    pub solver: &'static str,
    /// Reason in words.
    pub why: String,
    /// Predicted cost with a factor.
    pub direct: Demand,
    /// Predicted cost with an iteration.
    pub iterative: Demand,
    /// True if an iteration is replaced by a factor, which fits into memory, when it takes more work than that.
    #[serde(skip)]
    pub may_change: bool,
}

/// Solver that a run used for systems with `components` per node before it was interrupted. The run continues with it,
/// whatever memory is free then, so that its results keep their bits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, serde::Deserialize)]
pub struct Decided {
    /// Components per node.
    pub components: usize,
    /// True if systems were solved with a factor.
    pub direct: bool,
    /// Reason of the choice, in words.
    pub why: String,
    /// True if an iteration may be replaced by a factor, which had room in memory.
    #[serde(default)]
    pub may_change: bool,
}

impl Choice {
    /// Repeats an earlier choice.
    #[must_use]
    pub fn again(decided: &Decided, estimate: &Estimate, work: &Workload) -> Choice {
        let (direct, iterative) = (estimate.direct(work), estimate.iterative(work));
        let solver = if decided.direct { "direct" } else { "iterative" };
        Choice { solver, why: decided.why.clone(), direct, iterative, may_change: decided.may_change }
    }

    /// Chooses the faster solver that fits into `free` bytes, or the smaller one if neither does. In the plane a factor
    /// that fits is chosen, since its work grows hardly faster than the number of unknowns.
    #[must_use]
    pub fn new(estimate: &Estimate, work: &Workload, free: Option<f64>) -> Choice {
        let (direct, iterative) = (estimate.direct(work), estimate.iterative(work));
        let fits = |demand: &Demand| free.is_none_or(|free| demand.bytes <= SHARE * free);
        let is_direct = match (fits(&direct), fits(&iterative)) {
            (true, false) => true,
            (false, true) => false,
            (true, true) => work.is_plane || direct.seconds <= iterative.seconds,
            (false, false) => direct.bytes <= iterative.bytes,
        };
        let write = |Demand { seconds, bytes }: &Demand| format!("{} and {}", duration(*seconds), size(*bytes));
        let mut why = format!("predicted {} with a factor, {} with an iteration", write(&direct), write(&iterative));
        if let Some(free) = free.filter(|_| !fits(&direct) || !fits(&iterative)) {
            why += &format!("; {} are free", size(free));
        }
        if work.is_plane && is_direct && direct.seconds > iterative.seconds {
            why += "; in the plane a factor that fits is taken";
        }
        let may_change = !is_direct && fits(&direct);
        Choice { solver: if is_direct { "direct" } else { "iterative" }, why, direct, iterative, may_change }
    }

    /// Reason of a solver that the case sets.
    pub const ASKED: &str = "set by solver.solver";

    /// The solver that the case asks for.
    #[must_use]
    pub fn asked(solver: &'static str, estimate: &Estimate) -> Choice {
        let work = Workload::default();
        let (direct, iterative) = (estimate.direct(&work), estimate.iterative(&work));
        Choice { solver, why: Choice::ASKED.to_owned(), direct, iterative, may_change: false }
    }

    /// Predicted cost of the chosen solver.
    #[must_use]
    pub fn demand(&self) -> Demand {
        if self.is_direct() { self.direct } else { self.iterative }
    }

    /// True if the chosen solver is a factor.
    #[must_use]
    pub fn is_direct(&self) -> bool {
        self.solver == "direct"
    }
}

/// A time with two digits.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.0095 => format!("{:.1} ms", 1e3 * s),
        s if s < 0.095 => format!("{:.0} ms", 1e3 * s),
        s if s < 9.5 => format!("{s:.1} s"),
        s if s < 600.0 => format!("{s:.0} s"),
        s if s < 36_000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

/// A number of bytes with two digits.
fn size(bytes: f64) -> String {
    let (unit, name) =
        [(1e12, "TB"), (1e9, "GB"), (1e6, "MB")].into_iter().find(|(unit, _)| bytes >= *unit).unwrap_or((1e3, "kB"));
    let value = bytes / unit;
    format!("{value:.*} {name}", usize::from(value < 9.95))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In the plane the factor is taken wherever it fits; in space very slender cells make it the faster one.
    #[test]
    fn the_cells_decide() {
        let belt = Estimate { unknowns: 1800, contact: 602, entries: 4.2e4, stored: 6e4, flops: 2e8 };
        let work = |slenderness: f64, is_plane| Workload {
            steps: 1.0,
            rubs: true,
            slenderness,
            is_plane,
            ..Workload::default()
        };
        let chosen = |estimate: &Estimate, free, work| Choice::new(estimate, &work, free).solver;
        assert_eq!(chosen(&belt, Some(1e9), work(1.0, false)), "iterative");
        assert_eq!(chosen(&belt, Some(1e9), work(1.0, true)), "direct");
        assert_eq!(chosen(&belt, Some(5e6), work(10.0, true)), "iterative");
        let cube = Estimate { unknowns: 45_000, contact: 1875, entries: 3.4e6, stored: 3e7, flops: 6e10 };
        assert_eq!([1.0, 8.0, 1e3].map(|s| chosen(&cube, None, work(s, false))), ["iterative", "iterative", "direct"]);
    }

    /// Times and memories that lie far apart decide, memory first.
    #[test]
    fn the_faster_one_that_fits_is_chosen() {
        let plane = Estimate { unknowns: 130_000, contact: 514, entries: 1.8e6, stored: 1.1e7, flops: 4e9 };
        let space = Estimate { unknowns: 105_000, contact: 3267, entries: 4.6e6, stored: 1.6e8, flops: 5e11 };
        let work = Workload { steps: 4.0, ..Workload::default() };
        let solver = |estimate: &Estimate, free: Option<f64>| Choice::new(estimate, &work, free).solver;
        for free in [None, Some(1e12)] {
            assert_eq!([solver(&plane, free), solver(&space, free)], ["direct", "iterative"]);
        }
        // 1.1e7 numbers of 8 bytes and more do not fit beside an iteration's 1.1e8 bytes the other way round.
        assert_eq!(solver(&Estimate { stored: 1e9, flops: 0.0, ..plane }, Some(1e9)), "iterative");
        assert_eq!(solver(&Estimate { entries: 4e9, ..space }, Some(4e9)), "direct");
        // Both fit: what is chosen for its speed may change, what is chosen for its memory not.
        let may_change = |estimate: &Estimate, free: f64| Choice::new(estimate, &work, Some(free)).may_change;
        assert!(may_change(&space, 1e12) && !may_change(&plane, 1e12) && !may_change(&space, 1.2e9));
        let none = Choice::new(&space, &work, Some(1e6));
        assert_eq!(none.solver, "iterative");
        assert!(none.why.ends_with("; 1.0 MB are free"), "{}", none.why);
    }
}
