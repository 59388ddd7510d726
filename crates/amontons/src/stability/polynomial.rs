//! The pencil T(λ) = T₀ + λT₁ + λ²T₂ + Σ λ/(λ + 1/τ) A_τ of a perturbation u′, θ′ ~ exp(λt), on the unknowns that the
//! contact leaves.
//!
//! With M, B, A, C and D of the body at the state, G the derivative of its forces in the temperature, E that of its
//! heat in the displacement, A_τ the springs of its branches, and the contact of [`super::contact`]:
//!
//! ```text
//! λ²M u′ + λB u′ + A u′ + Σ λ/(λ + 1/τ) A_τ u′ − G θ′ + Σ ω Nᵀ(p′ν + q′) = 0
//! λC θ′ + D θ′ − E u′ + Σ ω Nᵀ(q·ν)′ = 0
//! W_p p′ + λ p′/(∂p/∂r) − λ(ν − W_v e)·u′ + W_θ θ′ = 0      at a point that wears
//! λC_F θ_F′ + H θ_F′ − Σ ω (q·ν + q·w_τ)′ = 0      of a foundation with a heat capacity
//! ```
//!
//! In a sector of a cyclic body the unknowns carry phases, and the rows are combined with their conjugates.

use faer::c64;

use super::contact::{PointTerm, SpaceMap};
use super::eliminated::{Basis, ChosenPivots, Elimination, Functional, HeldRow, eliminate};
use super::unknowns::{PerturbedUnknowns, add, merged};
use crate::contact::ContactBoundary;
use crate::linalg::{BlockMatrix, ComplexMatrix, Graph, nested_dissection};
use crate::mesh::Mesh;
use crate::tensor::Point;

/// The forms of the body at the state; none where it has none.
#[derive(Default)]
pub(super) struct Forms {
    /// M, B, A: blocks d × d, or 1 × 1 for each component.
    pub inertia: Option<BlockMatrix>,
    pub damping: Option<BlockMatrix>,
    pub stiffness: Option<BlockMatrix>,
    /// 1/τ and A_τ of each group of branches.
    pub branches: Vec<(f64, BlockMatrix)>,
    /// G: force by temperature, and E: heat by displacement.
    pub force: Option<BlockMatrix>,
    pub heat: Option<BlockMatrix>,
    /// C, and the parts of D.
    pub storage: Option<BlockMatrix>,
    pub conduction: Vec<BlockMatrix>,
    /// H in W/K and C in J/K of each foundation with a heat capacity, by contact.
    pub foundations: Vec<Option<[f64; 2]>>,
}

/// T(λ) on a symmetric pattern.
pub(super) struct Polynomial {
    pattern: ComplexMatrix,
    /// T₀, T₁, T₂, then A_τ by group, on the pattern.
    terms: Vec<Vec<c64>>,
    /// 1/τ of each group.
    pub rates: Vec<f64>,
    /// The unknowns with Z and W.
    pub unknowns: PerturbedUnknowns,
    pub trial: Basis,
    /// Factor of each unknown: x = scale ξ makes entries of one size.
    pub scale: Vec<f64>,
    /// The unknowns that the contact eliminates, and the number of each that is left.
    pivots: ChosenPivots,
    number: Vec<u32>,
}

/// Entries of one term: row, column, value.
type Entries = Vec<(u32, u32, c64)>;

/// The terms while they are assembled, on the unknowns before the contact eliminates some.
struct Assembly<'a> {
    unknowns: &'a PerturbedUnknowns,
    terms: Vec<Entries>,
}

impl Assembly<'_> {
    /// Adds `factor` times a form, with rows and columns of displacement or temperature; blocks 1 × 1 of displacements
    /// act on each component.
    fn add(&mut self, term: usize, factor: f64, form: &BlockMatrix, [rows, columns]: [&[Functional]; 2], dim: usize) {
        let (mut r, mut c) = form.block_shape();
        let is_scalar = r == 1 && c == 1 && dim > 1;
        if is_scalar {
            (r, c) = (dim, dim);
        }
        for i in 0..form.graph().len() {
            for (j, block) in form.row(i) {
                for (a, b) in (0..r).flat_map(|a| (0..c).map(move |b| (a, b))) {
                    let value = if is_scalar { f64::from(u8::from(a == b)) * block[0] } else { block[a * c + b] };
                    if value != 0.0 {
                        self.product(term, factor * value, &rows[i * r + a], &columns[j * c + b]);
                    }
                }
            }
        }
    }

    /// Adds a multiple of the product of the conjugate of a functional and another one.
    fn product(&mut self, term: usize, factor: f64, row: &[(u32, c64)], column: &[(u32, c64)]) {
        let entries = &mut self.terms[term];
        for &(i, a) in row {
            let a = factor * a.conj();
            entries.extend(column.iter().map(|&(j, b)| (i, j, a * b)));
        }
    }

    /// Adds the laws of a contact point, and returns what it holds.
    fn add_point(&mut self, boundary: &ContactBoundary, number: usize, term: &PointTerm) -> Vec<HeldRow> {
        let (point, unknowns) = (&boundary.points[number], self.unknowns);
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let jump = axes.map(|axis| unknowns.jump(boundary, point, &axis));
        let temperatures = unknowns.temperatures(boundary, point);
        let along = |direction: &Point| {
            let mut sum = Functional::new();
            jump.iter().zip(direction).for_each(|(jump, c)| add(&mut sum, c64::new(*c, 0.0), jump));
            merged(sum)
        };
        // Heat out of one side, and into the other, whose values are negative in the jump.
        let tests = [1.0, -1.0].map(|sign| sign * point.weight);
        let maps: [(usize, &SpaceMap, &[Point; 2]); 2] =
            [(0, &term.force_by_jump, &term.heat_by_jump), (1, &term.force_by_rate, &term.heat_by_rate)];
        for (power, force, heat) in maps {
            for c in 0..3 {
                self.product(power, point.weight, &jump[c], &along(&force[c]));
            }
            for side in 0..2 {
                self.product(power, tests[side], &temperatures[side], &along(&heat[side]));
            }
        }
        for (on, temperature) in temperatures.iter().enumerate() {
            self.product(0, point.weight, &along(&term.force_by_temperature[on]), temperature);
            for side in 0..2 {
                let factor = tests[side] * term.heat_by_temperature[side][on];
                self.product(0, factor, &temperatures[side], temperature);
            }
        }
        if let Some((wearing, pressure)) = term.wearing.as_ref().zip(unknowns.pressure(number)) {
            for (power, factor) in [wearing.by_pressure, wearing.compliance].into_iter().enumerate() {
                self.product(power, point.weight * factor, &pressure, &pressure);
            }
            self.product(1, -point.weight, &pressure, &along(&wearing.approach));
            for (on, temperature) in temperatures.iter().enumerate() {
                self.product(0, point.weight * wearing.by_temperature[on], &pressure, temperature);
                self.product(0, tests[on] * wearing.heat[on], temperature, &pressure);
            }
            self.product(0, point.weight, &along(&wearing.force), &pressure);
        }
        let held = |held: &super::contact::HeldComponent| {
            let mut reaction = along(&held.force);
            for side in 0..2 {
                add(&mut reaction, c64::new([1.0, -1.0][side] * held.heat[side], 0.0), &temperatures[side]);
            }
            HeldRow { condition: along(&held.direction), reaction: merged(reaction) }
        };
        term.held.iter().map(held).collect()
    }
}

impl Polynomial {
    /// Assembles the pencil, with the basis, the order and the scale of one `beside` it, if that is given; `None` if
    /// they do not suit.
    pub fn new(
        unknowns: PerturbedUnknowns,
        forms: &Forms,
        (boundary, points): (&ContactBoundary, &[PointTerm]),
        mesh: &Mesh,
        beside: Option<&Polynomial>,
    ) -> Option<Polynomial> {
        if beside.is_some_and(|beside| !beside.has_unknowns(&unknowns, forms)) {
            return None;
        }
        let (held, entries) = Polynomial::assembled(&unknowns, forms, (boundary, points), mesh.dim);
        let may = |unknown: u32| unknowns.moves[unknown as usize];
        let Elimination { left, trial, test, pivots } =
            eliminate(unknowns.size, &held, may, beside.map(|beside| &beside.pivots))?;
        let size = left.len();
        let number = match beside {
            Some(beside) if beside.number.len() == size => beside.number.clone(),
            Some(_) => return None,
            None => order(&unknowns, mesh, &entries, (&left, [&test, &trial])),
        };
        let [trial, test] = [trial, test].map(|basis| basis.renumbered(&number));
        let rates = forms.branches.iter().map(|(rate, _)| *rate).collect();
        let (pattern, terms) = condensed(size, entries, [&test, &trial]);
        let mut made = Polynomial { pattern, terms, rates, unknowns, trial, scale: vec![1.0; size], pivots, number };
        if let Some(beside) = beside {
            made.scale_with(beside.scale.clone());
        }
        Some(made)
    }

    /// True if other unknowns and forms have the same degrees of freedom and as many branches.
    fn has_unknowns(&self, other: &PerturbedUnknowns, forms: &Forms) -> bool {
        let own = &self.unknowns;
        own.moves == other.moves && own.node_of == other.node_of && self.rates.len() == forms.branches.len()
    }

    /// The held components and the terms on all unknowns.
    fn assembled(
        unknowns: &PerturbedUnknowns,
        forms: &Forms,
        (boundary, points): (&ContactBoundary, &[PointTerm]),
        dim: usize,
    ) -> (Vec<HeldRow>, Vec<Entries>) {
        let terms = 3 + forms.branches.len();
        let mut assembly = Assembly { unknowns, terms: vec![Vec::new(); terms] };
        let (u, theta) = (&unknowns.u[..], &unknowns.theta[..]);
        let body = [(0, &forms.stiffness), (1, &forms.damping), (2, &forms.inertia)];
        for (term, form) in body {
            if let Some(form) = form {
                assembly.add(term, 1.0, form, [u, u], dim);
            }
        }
        for (group, (_, form)) in forms.branches.iter().enumerate() {
            assembly.add(3 + group, 1.0, form, [u, u], dim);
        }
        forms.force.iter().for_each(|form| assembly.add(0, -1.0, form, [u, theta], 1));
        forms.heat.iter().for_each(|form| assembly.add(0, -1.0, form, [theta, u], 1));
        forms.storage.iter().for_each(|form| assembly.add(1, 1.0, form, [theta, theta], 1));
        forms.conduction.iter().for_each(|form| assembly.add(0, 1.0, form, [theta, theta], 1));
        for (contact, lumped) in forms.foundations.iter().enumerate() {
            let theta = unknowns.foundation(contact);
            for (power, value) in lumped.iter().flatten().enumerate() {
                assembly.product(power, *value, theta, theta);
            }
        }
        let held = points.iter().enumerate().flat_map(|(i, point)| assembly.add_point(boundary, i, point)).collect();
        (held, assembly.terms)
    }

    /// λ²T₂ + λT₁ + T₀ by the entries of the terms: row, column, value.
    #[cfg(test)]
    pub fn of_terms(size: usize, terms: [Vec<(u32, u32, f64)>; 3]) -> Option<Polynomial> {
        let Elimination { trial, test, pivots, .. } = eliminate(size, &[], |_| true, None)?;
        let complex = |entries: Vec<(u32, u32, f64)>| {
            entries.into_iter().map(|(i, j, value)| (i, j, c64::new(value, 0.0))).collect::<Entries>()
        };
        let (pattern, terms) = condensed(size, terms.map(complex).into_iter().collect(), [&test, &trial]);
        let unknowns = PerturbedUnknowns::plain(size);
        let number = (0..size as u32).collect();
        let scale = vec![1.0; size];
        Some(Polynomial { pattern, terms, rates: Vec::new(), unknowns, trial, scale, pivots, number })
    }

    /// True if T is real at real λ, so that eigenvalues come with their conjugates.
    pub fn is_real(&self) -> bool {
        self.unknowns.waves().is_real()
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.pattern.size()
    }

    /// Number of groups of branches.
    pub fn branches(&self) -> usize {
        self.rates.len()
    }

    /// Sets the scale by the diagonal at a rate in 1/s, and scales the terms.
    pub fn balance(&mut self, rate: f64) {
        let weights: Vec<f64> =
            [1.0, rate, rate * rate].into_iter().chain(self.rates.iter().map(|own| rate / (rate + own))).collect();
        let mut largest = vec![0.0f64; self.size()];
        for j in 0..self.size() {
            for k in self.range(j) {
                if self.pattern.rows[k] as usize == j {
                    largest[j] =
                        self.terms.iter().zip(&weights).map(|(term, weight)| term[k].norm() * weight.abs()).sum();
                }
            }
        }
        let mean = largest.iter().filter(|d| **d > 0.0).map(|d| d.ln()).sum::<f64>();
        let mean = (mean / largest.iter().filter(|d| **d > 0.0).count().max(1) as f64).exp();
        let scale = largest.iter().map(|d| if *d > 0.0 { d.sqrt().recip() } else { mean.sqrt().recip() }).collect();
        self.scale_with(scale);
    }

    /// Scales the terms by the factors of the unknowns.
    pub fn scale_with(&mut self, scale: Vec<f64>) {
        self.scale = scale;
        for j in 0..self.size() {
            for k in self.range(j) {
                let factor = self.scale[j] * self.scale[self.pattern.rows[k] as usize];
                self.terms.iter_mut().for_each(|term| term[k] *= factor);
            }
        }
    }

    fn range(&self, j: usize) -> std::ops::Range<usize> {
        self.pattern.start[j] as usize..self.pattern.start[j + 1] as usize
    }

    /// The factors of T₀, T₁, T₂ and A_τ in T(λ).
    pub fn weights(&self, lambda: c64) -> Vec<c64> {
        let branches = self.rates.iter().map(|rate| lambda / (lambda + rate));
        [c64::new(1.0, 0.0), lambda, lambda * lambda].into_iter().chain(branches).collect()
    }

    /// Their derivatives in λ.
    pub fn slope_weights(&self, lambda: c64) -> Vec<c64> {
        let branches = self.rates.iter().map(|rate| *rate / ((lambda + rate) * (lambda + rate)));
        [c64::default(), c64::new(1.0, 0.0), 2.0 * lambda].into_iter().chain(branches).collect()
    }

    /// The sum of the terms with some factors, times x.
    pub fn combined(&self, weights: &[c64], x: &[c64]) -> Vec<c64> {
        let mut sum = vec![c64::default(); x.len()];
        for (term, weight) in weights.iter().enumerate() {
            self.add_product(term, *weight, x, &mut sum);
        }
        sum
    }

    /// The size of the sum of the terms with some factors, times x, without cancellation: all factors, entries and
    /// values by their sizes.
    pub fn absolute(&self, weights: &[c64], x: &[c64]) -> f64 {
        let mut sum = vec![0.0f64; x.len()];
        for (j, x) in x.iter().enumerate() {
            for k in self.range(j) {
                let entry = |(weight, term): (&c64, &Vec<c64>)| (weight * term[k]).norm();
                let size: f64 = weights.iter().zip(&self.terms).map(entry).sum();
                sum[self.pattern.rows[k] as usize] += size * x.norm();
            }
        }
        sum.iter().map(|size| size * size).sum::<f64>().sqrt()
    }

    /// The adjoint of the sum of the terms with some factors, times y.
    pub fn combined_adjoint(&self, weights: &[c64], y: &[c64]) -> Vec<c64> {
        let of = |j: usize| {
            let own = |k: usize| weights.iter().zip(&self.terms).map(|(weight, term)| weight * term[k]).sum::<c64>();
            self.range(j).map(|k| own(k).conj() * y[self.pattern.rows[k] as usize]).sum()
        };
        (0..self.size()).map(of).collect()
    }

    /// T(λ).
    pub fn at(&self, lambda: c64) -> ComplexMatrix {
        let weights = self.weights(lambda);
        let mut values = vec![c64::default(); self.pattern.rows.len()];
        for (term, weight) in self.terms.iter().zip(weights) {
            values.iter_mut().zip(term).for_each(|(value, entry)| *value += weight * *entry);
        }
        ComplexMatrix { values, ..self.pattern.clone() }
    }

    /// Adds factor T_i x to y: T₀, T₁, T₂, then A_τ.
    pub fn add_product(&self, term: usize, factor: c64, x: &[c64], y: &mut [c64]) {
        for (j, x) in x.iter().enumerate() {
            let x = factor * *x;
            for k in self.range(j) {
                y[self.pattern.rows[k] as usize] += x * self.terms[term][k];
            }
        }
    }

    /// ‖T(λ)x‖ over the sum of the sizes of its terms.
    pub fn residual(&self, lambda: c64, x: &[c64]) -> f64 {
        let (mut sum, mut sizes) = (vec![c64::default(); x.len()], 0.0);
        for (term, weight) in self.weights(lambda).into_iter().enumerate() {
            let mut product = vec![c64::default(); x.len()];
            self.add_product(term, weight, x, &mut product);
            sizes += norm(&product);
            sum.iter_mut().zip(&product).for_each(|(sum, product)| *sum += *product);
        }
        norm(&sum) / sizes
    }

    /// Angle and logarithm of the size of Π (T₀ + λT₁ + Σ λ/(λ + 1/τ) A_τ)_jj over the diagonal: a function with the
    /// poles of det T whose zeros, as those of any chain of springs and dashpots, are on the negative real axis, near
    /// those at which branches relax. Without branches 1.
    pub fn relaxation(&self, lambda: c64) -> [f64; 2] {
        let mut sum = [0.0; 2];
        if self.rates.is_empty() {
            return sum;
        }
        for j in 0..self.size() {
            let Some(k) = self.range(j).find(|k| self.pattern.rows[*k] as usize == j) else { continue };
            let springs = || self.rates.iter().zip(&self.terms[3..]);
            let (stiffness, damping) = (self.terms[0][k].re, self.terms[1][k].re.max(0.0));
            if stiffness > 0.0 && springs().all(|(_, spring)| spring[k].re >= 0.0) {
                let parts: c64 = springs().map(|(rate, spring)| lambda / (lambda + rate) * spring[k].re).sum();
                let all = (lambda * damping + stiffness + parts) / stiffness;
                sum = [sum[0] + all.arg(), sum[1] + all.norm().ln()];
            }
        }
        sum
    }

    /// A rate of the slowest motions in 1/s, from the size of the diagonals and the number of unknowns: 2πf of a body
    /// that swings, or that of the decay of heat. It only says where a search begins.
    pub fn slow_rate(&self, dim: usize) -> f64 {
        let mut sums = [[0.0; 3]; 2];
        let mut count = [0.0f64; 2];
        for j in 0..self.size() {
            for k in self.range(j).filter(|k| self.pattern.rows[*k] as usize == j) {
                let swings = self.terms[2][k].norm() > 0.0;
                count[usize::from(swings)] += 1.0;
                sums[usize::from(swings)].iter_mut().zip(&self.terms).for_each(|(sum, term)| *sum += term[k].norm());
            }
        }
        let [[d, c, _], [a, _, m]] = sums;
        let cells = |count: f64, components: usize| (count / components as f64).max(1.0).powf(1.0 / dim as f64);
        let swing = if m > 0.0 { (a / m).sqrt() / cells(count[1], dim) } else { f64::INFINITY };
        let decay = if c > 0.0 && d > 0.0 { d / c / cells(count[0], 1).powi(2) } else { f64::INFINITY };
        let found = if swing.is_finite() { swing } else { decay };
        if found.is_finite() && found > 0.0 { found } else { 1.0 }
    }
}

/// ‖x‖₂.
pub(super) fn norm(x: &[c64]) -> f64 {
    x.iter().map(c64::norm_sqr).sum::<f64>().sqrt()
}

/// The number of each unknown that is left in the order of elimination: nested dissection of the nodes as T couples
/// them, across pairs of bodies too; the foundations last.
fn order(
    unknowns: &PerturbedUnknowns,
    mesh: &Mesh,
    terms: &[Entries],
    (left, [test, trial]): (&[u32], [&Basis; 2]),
) -> Vec<u32> {
    let node = |k: u32| left.get(k as usize).and_then(|unknown| unknowns.node_of.get(*unknown as usize)).copied();
    let mut pairs: Vec<(u32, u32)> = Vec::new();
    for (i, j, _) in terms.iter().flatten() {
        for (row, _) in test.of(*i as usize) {
            for (column, _) in trial.of(*j as usize) {
                let pair = node(*row).zip(node(*column)).filter(|(a, b)| a != b);
                pairs.extend(pair.filter(|pair| pairs.last() != Some(pair)));
            }
        }
    }
    let nodes = mesh.points.len();
    let mut of_node: Vec<Vec<u32>> = vec![Vec::new(); nodes];
    let mut rest = Vec::new();
    for k in 0..left.len() as u32 {
        node(k).map_or(&mut rest, |node| &mut of_node[node as usize]).push(k);
    }
    let keep: Vec<bool> = of_node.iter().map(|own| !own.is_empty()).collect();
    let nodes = nested_dissection(&Graph::of_pairs(nodes, pairs), &mesh.points, &keep, &[]).order;
    let ordered = nodes.iter().flat_map(|node| of_node[*node as usize].iter()).chain(&rest);
    let mut number = vec![0; left.len()];
    ordered.enumerate().for_each(|(new, old)| number[*old as usize] = new as u32);
    number
}

/// Wᴴ T Z of each term on one symmetric pattern.
fn condensed(size: usize, terms: Vec<Entries>, [test, trial]: [&Basis; 2]) -> (ComplexMatrix, Vec<Vec<c64>>) {
    let count = terms.len();
    // Column, row, term, value; the term `count` marks an entry that the pattern has without a value.
    let mut all: Vec<(u32, u32, u32, c64)> = Vec::new();
    for (term, entries) in terms.into_iter().enumerate() {
        for (i, j, value) in entries {
            for &(row, a) in test.of(i as usize) {
                for &(column, b) in trial.of(j as usize) {
                    all.push((column, row, term as u32, a.conj() * b * value));
                    all.push((row, column, count as u32, c64::default()));
                }
            }
        }
    }
    all.extend((0..size as u32).map(|j| (j, j, count as u32, c64::default())));
    all.sort_by_key(|(column, row, term, _)| (*column, *row, *term));
    let mut pattern = ComplexMatrix { start: vec![0; size + 1], ..ComplexMatrix::default() };
    let mut values: Vec<Vec<c64>> = vec![Vec::new(); count];
    let mut last = None;
    for (column, row, term, value) in all {
        if last != Some((column, row)) {
            last = Some((column, row));
            pattern.rows.push(row);
            pattern.start[column as usize + 1] += 1;
            for values in &mut values {
                values.push(c64::default());
            }
        }
        if let Some(values) = values.get_mut(term as usize).and_then(|values| values.last_mut()) {
            *values += value;
        }
    }
    for j in 0..size {
        pattern.start[j + 1] += pattern.start[j];
    }
    (pattern, values)
}
