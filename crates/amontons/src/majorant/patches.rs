//! Patches of facets at a vertex of a plane body, or at an edge in space, with tractions that keep cells in balance.
//!
//! Two facets of each cell meet at a vertex in the plane and at an edge in space, so that the unknown facets at it form
//! chains and rings. Cells stay in balance if one wrench, of force and moment, goes round a ring, or through a chain
//! that begins and ends at sides that are held; and by tractions without force and moment on each facet alone.

use std::collections::HashMap;

use rayon::prelude::*;

use super::balance::FacetGiven;
use super::dense::{Semidefinite, kernel, product};
use super::modes::{FacetModes, MOST, components, cross, wrench};
use super::shapes::CellShapes;
use super::skeleton::Skeleton;
use crate::mesh::Mesh;
use crate::tensor::Point;

/// A facet of a patch: the wrench about the middle of the patch becomes one about that of the facet.
#[derive(Clone, Copy, Debug)]
struct PatchFacet {
    facet: usize,
    /// ±1 as the wrench goes with the normal of the facet or against it; 0 without one.
    turn: f64,
    /// The middle of the patch from that of the facet over the length of the facet.
    arm: Point,
    /// Length of the patch over that of the facet.
    scale: f64,
}

/// A ring or chain of facets.
#[derive(Debug)]
struct FacetPatch {
    facets: Vec<PatchFacet>,
    /// Components of the traction on each facet.
    count: usize,
    has_wrench: bool,
    factor: usize,
}

/// A facet of a cell in a patch: place in the patch, place in the cell, and sign.
type PatchEntry = (usize, usize, f64);

/// A cell in a patch with its facets there, of which there are at most two.
#[derive(Clone, Copy, Debug)]
struct PatchCell {
    cell: usize,
    facets: [PatchEntry; 2],
    count: usize,
}

impl PatchCell {
    fn facets(&self) -> &[PatchEntry] {
        &self.facets[..self.count]
    }
}

/// The factor of the energy of a patch.
#[derive(Debug)]
struct PatchFactor {
    factor: Semidefinite,
    /// Directions that keep known components of tractions, or none if all do.
    kept: Option<Vec<Vec<f64>>>,
}

/// All patches of a mesh.
#[derive(Debug)]
pub(super) struct Patches {
    dim: usize,
    /// Distance of the components of a facet from those of the next one.
    stride: usize,
    all: Vec<FacetPatch>,
    factors: Vec<PatchFactor>,
}

/// What makes patches: the mesh and what is known of its facets.
pub(super) struct PatchData<'a> {
    pub mesh: &'a Mesh,
    pub skeleton: &'a Skeleton,
    pub given: &'a [FacetGiven],
    pub shapes: &'a CellShapes,
}

impl PatchData<'_> {
    fn dim(&self) -> usize {
        self.mesh.dim
    }

    /// The unknown facets by vertex or edge.
    fn stars(&self) -> Vec<([u32; 2], usize)> {
        let mut all = Vec::new();
        for (facet, of) in self.skeleton.facets.iter().enumerate() {
            if self.dim() < 2 || self.given[facet].is_known() {
                continue;
            }
            // Vertices in the plane, and edges in space.
            for (&a, &next) in of.vertices.iter().zip(of.vertices.iter().cycle().skip(1)) {
                let b = if self.dim() == 2 { a } else { next };
                all.push(([a.min(b), a.max(b)], facet));
            }
        }
        all.par_sort_unstable();
        all
    }

    /// The rings and chains at a vertex or edge, with their cells.
    fn patches(&self, at: [u32; 2], star: &[([u32; 2], usize)]) -> Vec<(FacetPatch, Vec<PatchCell>)> {
        let facets: Vec<usize> = star.iter().map(|(_, facet)| *facet).collect();
        let mut cells: Vec<PatchCell> = Vec::new();
        for (slot, &facet) in facets.iter().enumerate() {
            for &(cell, local) in &self.skeleton.facets[facet].cells {
                let entry = (slot, local, self.skeleton.facets[facet].sign(cell));
                match cells.iter_mut().find(|known| known.cell == cell) {
                    Some(known) => (known.facets[1], known.count) = (entry, 2),
                    None => cells.push(PatchCell { cell, facets: [entry; 2], count: 1 }),
                }
            }
        }
        let mut turns = vec![0.0; facets.len()];
        let mut found = Vec::new();
        for first in 0..facets.len() {
            if turns[first] != 0.0 {
                continue;
            }
            turns[first] = 1.0;
            let mut members = vec![first];
            let mut next = 0;
            while let Some(&slot) = members.get(next) {
                next += 1;
                for cell in &cells {
                    let Some(&(_, _, sign)) = cell.facets().iter().find(|(own, ..)| *own == slot) else { continue };
                    for &(other, _, of_other) in cell.facets().iter().filter(|(other, ..)| *other != slot) {
                        if turns[other] == 0.0 {
                            turns[other] = -turns[slot] * sign * of_other;
                            members.push(other);
                        }
                    }
                }
            }
            members.sort_unstable();
            found.push(self.patch(at, (&facets, &turns, &members), &cells));
        }
        found
    }

    fn patch(
        &self,
        at: [u32; 2],
        (facets, turns, members): (&[usize], &[f64], &[usize]),
        cells: &[PatchCell],
    ) -> (FacetPatch, Vec<PatchCell>) {
        let place = |slot: usize| members.iter().position(|own| *own == slot);
        let of_patch = |cell: &PatchCell| {
            let moved = |(slot, local, sign): PatchEntry| Some((place(slot)?, local, sign));
            // Both facets of a cell are in one patch.
            let [first, second] = cell.facets;
            Some(PatchCell { facets: [moved(first)?, moved(second)?], ..*cell })
        };
        let cells: Vec<PatchCell> = cells.iter().filter_map(of_patch).collect();
        let has_wrench = cells.iter().all(|cell| cell.count == 2);
        let ends = at.map(|node| self.mesh.points[node as usize]);
        let modes = |slot: usize| -> &FacetModes { &self.skeleton.modes[facets[slot]] };
        let size = members.first().map_or(1.0, |&slot| modes(slot).size);
        let of_facet = |&slot: &usize| {
            let FacetModes { centre, size: own, .. } = modes(slot);
            PatchFacet {
                facet: facets[slot],
                turn: if has_wrench { turns[slot] } else { 0.0 },
                arm: std::array::from_fn(|c| (0.5 * (ends[0][c] + ends[1][c]) - centre[c]) / own),
                scale: size / own,
            }
        };
        let vertices = members.first().map_or(0, |&slot| self.skeleton.facets[facets[slot]].vertices.len());
        let count = components(self.dim(), vertices);
        (FacetPatch { facets: members.iter().map(of_facet).collect(), count, has_wrench, factor: 0 }, cells)
    }

    /// What tells factors apart.
    fn key(&self, patch: &FacetPatch, cells: &[PatchCell]) -> Vec<u32> {
        let mut key = vec![patch.facets.len() as u32];
        // Directions in which a part is known, in units of far more than round-off.
        for of in patch.facets.iter().map(|of| &self.given[of.facet]) {
            if !of.is_whole(self.dim()) {
                key.extend(of.free.iter().flatten().map(|x| (x * f64::from(1 << 28)).round() as i32 as u32));
            }
            key.push(u32::MAX);
        }
        for cell in cells {
            key.push(self.shapes.of_cell[cell.cell]);
            let of =
                |&(slot, local, sign): &(usize, usize, f64)| [slot as u32, local as u32 * 2 + u32::from(sign > 0.0)];
            key.extend(cell.facets().iter().flat_map(of));
            key.push(u32::MAX);
        }
        key
    }

    /// The factor of the energy of a patch.
    fn factor(&self, patch: &FacetPatch, cells: &[PatchCell]) -> PatchFactor {
        let d = self.dim();
        let matrix = PatchMatrix { d, patch, size: patch.size(d) }.matrix(self.shapes, cells);
        let partial = patch.facets.iter().any(|of| !self.given[of.facet].is_whole(d));
        if !partial {
            return PatchFactor { factor: Semidefinite::new(&matrix), kept: None };
        }
        let kept = kernel(&self.known_components(patch), patch.size(d));
        let full = |i: usize, j: usize| if j <= i { matrix[i][j] } else { matrix[j][i] };
        let n = matrix.len();
        let images: Vec<Vec<f64>> =
            kept.iter().map(|v| (0..n).map(|i| (0..n).map(|j| full(i, j) * v[j]).sum()).collect()).collect();
        let reduced: Vec<Vec<f64>> =
            kept.iter().map(|v| images.iter().map(|image| product(v, image)).collect()).collect();
        PatchFactor { factor: Semidefinite::new(&reduced), kept: Some(kept) }
    }

    /// Rows whose products with the unknowns of a patch are known components of its tractions.
    fn known_components(&self, patch: &FacetPatch) -> Vec<Vec<f64>> {
        let (d, n) = (self.dim(), patch.size(self.dim()));
        let mut rows = Vec::new();
        for (slot, of) in patch.facets.iter().enumerate() {
            let modes = &self.skeleton.modes[of.facet];
            let columns: Vec<Vec<Point>> = (0..n)
                .map(|k| {
                    let mut x = vec![0.0; n];
                    x[k] = 1.0;
                    let mut y = [0.0; MOST];
                    patch.add_of_facet(d, slot, &x, &mut y[..patch.count]);
                    let force = std::array::from_fn(|c| if c < d { y[c] } else { 0.0 });
                    let couples = modes.couples(&y).into_iter().take(d - 1);
                    std::iter::once(force).chain(couples).chain(modes.further(&y)).collect()
                })
                .collect();
            for kept in self.given[of.facet].kept(d) {
                for part in 0..columns.first().map_or(0, Vec::len) {
                    let row = columns.iter().map(|parts| crate::tensor::dot(&kept, &parts[part])).collect();
                    rows.push(row);
                }
            }
        }
        rows
    }
}

impl FacetPatch {
    /// Number of unknowns: the wrench, and per facet the tractions without one.
    fn size(&self, d: usize) -> usize {
        let of_facets = self.facets.len() * (self.count - wrench(d));
        of_facets + if self.has_wrench { wrench(d) } else { 0 }
    }

    /// First unknown of a facet.
    fn first(&self, d: usize, slot: usize) -> usize {
        slot * (self.count - wrench(d)) + if self.has_wrench { wrench(d) } else { 0 }
    }

    /// Adds the components of a facet from the unknowns of the patch.
    fn add_of_facet(&self, d: usize, slot: usize, x: &[f64], y: &mut [f64]) {
        let (PatchFacet { turn, arm, scale, .. }, w) = (&self.facets[slot], wrench(d));
        if self.has_wrench {
            (0..d).for_each(|c| y[c] += turn * x[c]);
            if d == 2 {
                y[2] += turn * (scale * x[2] + arm[0] * x[1] - arm[1] * x[0]);
            } else {
                let moment = cross(arm, &[x[0], x[1], x[2]]);
                (0..3).for_each(|c| y[3 + c] += turn * (scale * x[3 + c] + moment[c]));
            }
        }
        y[w..].iter_mut().zip(&x[self.first(d, slot)..]).for_each(|(y, x)| *y += x);
    }

    /// Adds the transpose of `add_of_facet` of components of a facet to a vector of the patch.
    fn add_transposed(&self, d: usize, slot: usize, y: &[f64], x: &mut [f64]) {
        let (PatchFacet { turn, arm, scale, .. }, w) = (&self.facets[slot], wrench(d));
        if self.has_wrench {
            let back = if d == 2 { [0.0 - y[2] * arm[1], y[2] * arm[0], 0.0] } else { cross(&[y[3], y[4], y[5]], arm) };
            (0..d).for_each(|c| x[c] += turn * (y[c] + back[c]));
            (d..w).for_each(|c| x[c] += turn * scale * y[c]);
        }
        x[self.first(d, slot)..].iter_mut().zip(&y[w..self.count]).for_each(|(x, y)| *x += y);
    }
}

/// The matrix of the energy of a patch.
struct PatchMatrix<'a> {
    d: usize,
    patch: &'a FacetPatch,
    size: usize,
}

impl PatchMatrix<'_> {
    /// The lower triangle.
    fn matrix(&self, shapes: &CellShapes, cells: &[PatchCell]) -> Vec<Vec<f64>> {
        let mut matrix = vec![vec![0.0; self.size]; self.size];
        for cell in cells {
            let gram = shapes.of(cell.cell).gram();
            let n = (gram.len() as f64).sqrt().round() as usize;
            for &(slot, a, sign) in cell.facets() {
                for &(other, b, of_other) in cell.facets() {
                    self.add((gram, n), (slot, a), (other, b), (sign * of_other, &mut matrix));
                }
            }
        }
        matrix
    }

    /// Adds the block of two facets of a cell.
    fn add(
        &self,
        (gram, n): (&[f64], usize),
        (slot, a): (usize, usize),
        (other, b): (usize, usize),
        (sign, matrix): (f64, &mut [Vec<f64>]),
    ) {
        let (d, k, w) = (self.d, self.patch.count, wrench(self.d));
        let row = |i: usize| &gram[(a * k + i) * n + b * k..][..k];
        let (first, second) = (self.patch.first(d, slot), self.patch.first(d, other));
        if slot >= other {
            for i in w..k {
                for (j, g) in row(i)[w..].iter().enumerate().take(if slot == other { i - w + 1 } else { k - w }) {
                    matrix[first + i - w][second + j] += sign * g;
                }
            }
        }
        if !self.patch.has_wrench {
            return;
        }
        // Rows of the block times the wrench on the other facet.
        let mut images = [[0.0; 6]; MOST];
        for (i, image) in images.iter_mut().enumerate().take(k) {
            let mut y = [0.0; 6];
            y[..w].copy_from_slice(&row(i)[..w]);
            self.patch.add_wrench(d, other, &y, image);
        }
        for i in w..k {
            for (j, x) in images[i].iter().enumerate().take(w) {
                matrix[first + i - w][j] += sign * x;
            }
        }
        for j in 0..w {
            let mut y = [0.0; 6];
            (0..w).for_each(|i| y[i] = images[i][j]);
            let mut column = [0.0; 6];
            self.patch.add_wrench(d, slot, &y, &mut column);
            (j..w).for_each(|i| matrix[i][j] += sign * column[i]);
        }
    }
}

impl FacetPatch {
    /// The part of the wrench of `add_transposed`.
    fn add_wrench(&self, d: usize, slot: usize, y: &[f64; 6], x: &mut [f64; 6]) {
        let PatchFacet { turn, arm, scale, .. } = &self.facets[slot];
        let back = if d == 2 { [0.0 - y[2] * arm[1], y[2] * arm[0], 0.0] } else { cross(&[y[3], y[4], y[5]], arm) };
        (0..d).for_each(|c| x[c] += turn * (y[c] + back[c]));
        (d..wrench(d)).for_each(|c| x[c] += turn * scale * y[c]);
    }
}

impl Patches {
    /// The patches of a mesh with their factors.
    pub fn new(data: &PatchData) -> Patches {
        let stars = data.stars();
        let runs: Vec<&[([u32; 2], usize)]> = stars.chunk_by(|a, b| a.0 == b.0).collect();
        let mut made: Vec<(FacetPatch, Vec<PatchCell>)> =
            runs.into_par_iter().flat_map_iter(|run| data.patches(run[0].0, run)).collect();
        let keys: Vec<Vec<u32>> = made.par_iter().map(|(patch, cells)| data.key(patch, cells)).collect();
        let (mut known, mut first) = (HashMap::new(), Vec::new());
        for (number, ((patch, _), key)) in made.iter_mut().zip(keys).enumerate() {
            let add = || {
                first.push(number);
                first.len() - 1
            };
            patch.factor = *known.entry(key).or_insert_with(add);
        }
        let factor = |number: usize| data.factor(&made[number].0, &made[number].1);
        let factors = first.into_par_iter().map(factor).collect();
        let all = made.into_iter().map(|(patch, _)| patch).collect();
        Patches { dim: data.dim(), stride: data.skeleton.stride, all, factors }
    }

    /// True if there is nothing to lower.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The sum of the solutions of the patches for a residual, by facet and component. `work` is kept between calls.
    pub fn preconditioned(&self, rest: &[f64], work: &mut Vec<f64>) -> Vec<f64> {
        let (d, k) = (self.dim, self.stride);
        let solve = |(patch, x): (&FacetPatch, &mut [f64])| {
            x.fill(0.0);
            for (slot, of) in patch.facets.iter().enumerate() {
                patch.add_transposed(d, slot, &rest[of.facet * k..][..k], x);
            }
            let PatchFactor { factor, kept } = &self.factors[patch.factor];
            let Some(kept) = kept else { return factor.solve_in_place(x) };
            let mut reduced: Vec<f64> = kept.iter().map(|v| product(v, x)).collect();
            factor.solve_in_place(&mut reduced);
            x.fill(0.0);
            for (v, a) in kept.iter().zip(reduced) {
                x.iter_mut().zip(v).for_each(|(x, v)| *x += a * v);
            }
        };
        work.resize(self.all.iter().map(|patch| patch.size(d)).sum(), 0.0);
        let parts = split(work, self.all.iter().map(|patch| patch.size(d)));
        self.all.par_iter().zip(parts).for_each(solve);
        let (mut sum, mut left) = (vec![0.0; rest.len()], &work[..]);
        for patch in &self.all {
            let (x, after) = left.split_at(patch.size(d));
            left = after;
            for (slot, of) in patch.facets.iter().enumerate() {
                patch.add_of_facet(d, slot, x, &mut sum[of.facet * k..][..patch.count]);
            }
        }
        sum
    }
}

/// A vector in parts of these lengths, one after the other.
pub(super) fn split(whole: &mut [f64], lengths: impl Iterator<Item = usize>) -> Vec<&mut [f64]> {
    let (mut parts, mut left) = (Vec::with_capacity(lengths.size_hint().0), whole);
    for length in lengths {
        let (part, after) = left.split_at_mut(length);
        parts.push(part);
        left = after;
    }
    parts
}
