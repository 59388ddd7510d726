//! Motions in words: "body `shaft` turns about (0, 0)".

use std::collections::BTreeSet;

use super::Motion;
use crate::mesh::defects::{Component, components};
use crate::mesh::{Block, Mesh, cross};
use crate::tensor::{Point, dot, length};

/// Fraction of the largest speed of a motion that counts as zero.
const NOTHING: f64 = 1e-6;
/// Relative precision of positions and directions in words.
const DIGITS: f64 = 1e-4;

/// Motions of the parts of a mesh in words. Each motion is a weighted sum of motions of single parts. Motions are
/// recombined within their span so that each moves as few parts as possible.
#[must_use]
pub fn described(mesh: &Mesh, motions: &[Motion], sums: &[Vec<f64>]) -> Vec<String> {
    if sums.is_empty() {
        return Vec::new();
    }
    let parts = components(mesh);
    let bounds = |low: bool, d: usize| {
        let at = mesh.points.iter().map(|x| x[d]);
        if low { at.fold(f64::INFINITY, f64::min) } else { at.fold(f64::NEG_INFINITY, f64::max) }
    };
    let size = (0..mesh.dim).map(|d| bounds(false, d) - bounds(true, d)).fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    let mut rows: Vec<Vec<f64>> = sums.iter().map(|sum| coordinates(motions, sum, parts.len(), size)).collect();
    reduce(&mut rows);
    let teller = Teller { mesh, parts: &parts, size };
    rows.iter().map(|row| teller.sentence(row)).collect()
}

/// s at the origin and ω times the size, part by part.
fn coordinates(motions: &[Motion], sum: &[f64], parts: usize, size: f64) -> Vec<f64> {
    let mut row = vec![0.0; 6 * parts];
    for (motion, factor) in motions.iter().zip(sum) {
        let shift = motion.at(&[0.0; 3]);
        let Some(own) = row.get_mut(6 * motion.part..6 * motion.part + 6) else { continue };
        for c in 0..3 {
            own[c] += factor * shift[c];
            own[3 + c] += factor * motion.turn[c] * size;
        }
    }
    row
}

/// Gauss–Jordan elimination with the largest pivot.
fn reduce(rows: &mut [Vec<f64>]) {
    let mut done = vec![false; rows.len()];
    for _ in 0..rows.len() {
        let open = (0..rows.len()).filter(|&i| !done[i]);
        let entries = open.flat_map(|i| rows[i].iter().enumerate().map(move |(j, value)| (i, j, value.abs())));
        // The first of several entries that are equal up to round-off is chosen.
        let best = entries.fold(None, |best: Option<(usize, usize, f64)>, next| match best {
            Some(best) if next.2 <= best.2 * (1.0 + NOTHING) => Some(best),
            _ => Some(next),
        });
        let Some((pivot, column, largest)) = best.filter(|best| best.2 > 0.0) else { return };
        let own: Vec<f64> = rows[pivot].iter().map(|value| value / rows[pivot][column]).collect();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != pivot) {
            let factor = row[column];
            row.iter_mut().zip(&own).for_each(|(value, own)| *value -= factor * own);
            row.iter_mut().filter(|value| value.abs() <= NOTHING * largest).for_each(|value| *value = 0.0);
        }
        rows[pivot] = own;
        done[pivot] = true;
    }
}

/// The data from which words are made.
struct Teller<'a> {
    mesh: &'a Mesh,
    parts: &'a [Component],
    size: f64,
}

impl Teller<'_> {
    /// Describes a motion of all parts.
    fn sentence(&self, row: &[f64]) -> String {
        let most = row.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let moves = |own: &[f64]| own.iter().any(|value| value.abs() > NOTHING * most);
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= DIGITS * most);
        let mut groups: Vec<(Vec<usize>, &[f64])> = Vec::new();
        for (part, own) in row.chunks_exact(6).enumerate().filter(|(_, own)| moves(own)) {
            match groups.iter_mut().find(|(_, of)| same(of, own)) {
                Some((parts, _)) => parts.push(part),
                None => groups.push((vec![part], own)),
            }
        }
        let told: Vec<String> = groups.iter().map(|(parts, own)| self.group(parts, own, most)).collect();
        told.join(" while ")
    }

    /// Describes a motion that some parts have in common.
    fn group(&self, parts: &[usize], own: &[f64], most: f64) -> String {
        let names: Vec<String> = parts.iter().map(|&part| self.name(part)).collect();
        let (subject, together) = match names.as_slice() {
            [one] => (one.clone(), ""),
            [others @ .., last] => (format!("{} and {last}", others.join(", ")), " together"),
            [] => (String::new(), ""),
        };
        let is_one = parts.len() == 1;
        let verb = |one: &str, more: &str| format!("{subject} {}{together}", if is_one { one } else { more });
        let (shift, turn): (Point, Point) =
            (std::array::from_fn(|c| own[c]), std::array::from_fn(|c| own[3 + c] / self.size));
        if self.mesh.axisymmetric {
            return format!("{} along the axis of revolution", verb("moves", "move"));
        }
        let rate = length(&turn);
        if rate * self.size <= DIGITS * most {
            return format!("{} along {}", verb("moves", "move"), self.direction(&shift));
        }
        let (verb, axis) = (verb("turns", "turn"), turn.map(|c| c / rate));
        // The point of the axis nearest to the part.
        let centre = parts.first().and_then(|&part| self.parts.get(part)).map_or([0.0; 3], |part| {
            let [low, high] = part.bounds(self.mesh);
            std::array::from_fn(|c| if c < self.mesh.dim { 0.5 * (low[c] + high[c]) } else { 0.0 })
        });
        let at_centre = cross(&turn, &centre);
        let at_centre: Point = std::array::from_fn(|c| shift[c] + at_centre[c]);
        let arm = cross(&turn, &at_centre).map(|c| c / (rate * rate));
        let place = self.place(&std::array::from_fn(|c| centre[c] + arm[c]));
        if self.mesh.dim < 3 {
            return format!("{verb} about {place}");
        }
        let along = dot(&shift, &axis);
        let screw = if along.abs() > DIGITS * most { ", and moves along it" } else { "" };
        format!("{verb} about the axis through {place} along {}{screw}", self.direction(&axis))
    }

    /// Name of a part: its region, if the part is all of it.
    fn name(&self, part: usize) -> String {
        if self.parts.len() == 1 {
            return "the body".to_owned();
        }
        let Some(own) = self.parts.get(part) else { return format!("part {} of the body", part + 1) };
        let is_own = |cell: &[u32]| cell.first().is_some_and(|node| own.nodes.binary_search(node).is_ok());
        let of = |inside: bool| -> BTreeSet<usize> {
            let has = |block: &&Block| block.cells().any(|cell| is_own(cell) == inside);
            self.mesh.blocks.iter().filter(has).map(|block| block.region).collect()
        };
        let (inside, outside) = (of(true), of(false));
        let region = inside.first().filter(|region| inside.len() == 1 && !outside.contains(region));
        if let Some(name) = region.and_then(|region| self.mesh.regions.get(*region)) {
            return format!("body `{name}`");
        }
        let [low, high] = own.bounds(self.mesh);
        format!("part {} of the body, from {} to {},", part + 1, self.place(&low), self.place(&high))
    }

    /// A position with as many digits as are useful.
    fn place(&self, x: &Point) -> String {
        let digits = -(DIGITS * self.size).log10().floor();
        let words: Vec<String> = x.iter().take(self.mesh.dim).map(|c| number(*c, digits)).collect();
        format!("({})", words.join(", "))
    }

    /// A direction with its largest component positive.
    fn direction(&self, v: &Point) -> String {
        let size = length(v);
        let largest = v.iter().fold(0.0, |most: f64, c| if c.abs() > most.abs() * (1.0 + NOTHING) { *c } else { most });
        let words: Vec<String> =
            v.iter().take(self.mesh.dim).map(|c| number(c / (size * largest.signum()), 4.0)).collect();
        format!("({})", words.join(", "))
    }
}

/// A number with at most `digits` decimals.
fn number(value: f64, digits: f64) -> String {
    let rounded = format!("{value:.*}", digits.clamp(0.0, 12.0) as usize);
    let short = if rounded.contains('.') { rounded.trim_end_matches('0').trim_end_matches('.') } else { &rounded };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}
