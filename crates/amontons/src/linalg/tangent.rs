//! The tangent J of the boundary term, which is added to S.

use std::ops::Range;

use crate::tensor::Sym;

/// Diagonal stiffness that replaces springs, as a fraction of that of S.
const SPREAD: f64 = 0.1;

/// An entry of J: row, column, value.
pub type Entry = (u32, u32, f64);

/// An entry of N: an unknown with its contribution to the components of a jump along (ν, t₁, t₂).
pub type Share = (u32, [f64; 3]);

/// Asymmetry of a matrix, relative to its largest entry, that counts as round-off.
const ROUND_OFF: f64 = 1e-12;

/// J = Σ ω Nᵀ T N, the derivative of the forces on Γ_C: a sum over contact points, stored as N and T. A point of a pair
/// in space sees forty unknowns, so its contribution to J has fifteen times as many numbers as N and T.
///
/// A backend that needs J up to a factor only, as a preconditioner does, may treat each point by itself: a motion that
/// no point resists is then still one that no point resists.
#[derive(Clone, Debug, Default)]
pub struct Tangent {
    /// Rows of N of all points, one after the other.
    shares: Vec<Share>,
    points: Vec<PointContribution>,
    springs: Vec<Spring>,
}

/// A spring α v vᵀ that resists a motion of many unknowns, each named at most once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spring {
    /// Stiffness α.
    pub stiffness: f64,
    /// Motion v.
    pub vector: Vec<(u32, f64)>,
}

impl Spring {
    /// Component v·x of x along the motion.
    #[must_use]
    pub fn motion(&self, x: &[f64]) -> f64 {
        self.vector.iter().map(|(at, value)| value * x.get(*at as usize).copied().unwrap_or(0.0)).sum()
    }

    /// Adds `factor` times α v to y.
    pub fn add(&self, factor: f64, y: &mut [f64]) {
        for (at, value) in &self.vector {
            if let Some(y) = y.get_mut(*at as usize) {
                *y += self.stiffness * factor * value;
            }
        }
    }
}

/// Contribution ω Fᵀ T N of a point, with F = N except for terms that are not of that form.
#[derive(Clone, Debug, PartialEq)]
struct PointContribution {
    /// Ranges of F and N in [`Tangent::shares`].
    force: Range<usize>,
    jump: Range<usize>,
    weight: f64,
    slope: [[f64; 3]; 3],
}

impl Tangent {
    /// The zero tangent.
    #[must_use]
    pub fn new() -> Tangent {
        Tangent::default()
    }

    /// The zero tangent, with room for `points` contact points that see `shares` unknowns in all.
    #[must_use]
    pub fn with_capacity(points: usize, shares: usize) -> Tangent {
        Tangent { shares: Vec::with_capacity(shares), points: Vec::with_capacity(points), springs: Vec::new() }
    }

    /// Adds ω Nᵀ T N of one contact point, given by its weight ω, its row of N, and T, whose rows are the force.
    pub fn add(&mut self, weight: f64, row: &[Share], slope: &[[f64; 3]; 3]) {
        let counts: [bool; 3] = std::array::from_fn(|a| row.iter().any(|(_, on)| on[a] != 0.0));
        let counted = |a: usize, b: usize| if counts[a] && counts[b] { slope[a][b] } else { 0.0 };
        let slope: [[f64; 3]; 3] = std::array::from_fn(|a| std::array::from_fn(|b| counted(a, b)));
        if slope.iter().flatten().all(|slope| *slope == 0.0) {
            return;
        }
        let place = self.push(row.iter().copied());
        self.points.push(PointContribution { force: place.clone(), jump: place, weight, slope });
    }

    /// Adds f nᵀ times a factor, with f and n given by their entries at some unknowns.
    pub fn add_product_of(&mut self, factor: f64, force: &[(u32, f64)], jump: &[(u32, f64)]) {
        let along = |(unknown, value): &(u32, f64)| (*unknown, [*value, 0.0, 0.0]);
        let (force, jump) = (self.push(force.iter().map(along)), self.push(jump.iter().map(along)));
        let mut slope = [[0.0; 3]; 3];
        slope[0][0] = 1.0;
        self.points.push(PointContribution { force, jump, weight: factor, slope });
    }

    /// Adds values on the diagonal, as one point per unknown.
    pub fn add_diagonal(&mut self, values: impl IntoIterator<Item = f64>) {
        let one = [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        let of = |(i, value): (usize, f64)| self.add(value, &[(i as u32, [1.0, 0.0, 0.0])], &one);
        values.into_iter().enumerate().for_each(of);
    }

    /// Adds a spring, which is not among [`Tangent::entries`].
    pub fn hold(&mut self, spring: Spring) {
        self.springs.push(spring);
    }

    /// The springs.
    pub(super) fn springs(&self) -> &[Spring] {
        &self.springs
    }

    /// The tangent with each spring replaced by stiffness on the diagonal, for a preconditioner. `scale` is the
    /// stiffness of S per unknown.
    #[must_use]
    pub(super) fn spread(&self, scale: &[f64]) -> Tangent {
        let mut tangent = Tangent { springs: Vec::new(), ..self.clone() };
        let mut held: Vec<u32> =
            self.springs.iter().flat_map(|spring| spring.vector.iter().map(|(at, _)| *at)).collect();
        held.sort_unstable();
        held.dedup();
        let one = [[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
        for at in held {
            let stiffness = scale.get(at as usize).map_or(0.0, |scale| SPREAD * scale);
            tangent.add(stiffness, &[(at, [1.0, 0.0, 0.0])], &one);
        }
        tangent
    }

    fn push(&mut self, shares: impl Iterator<Item = Share>) -> Range<usize> {
        let start = self.shares.len();
        self.shares.extend(shares);
        start..self.shares.len()
    }

    /// Nonzero entries of all points: J is their sum.
    pub fn entries(&self) -> impl Iterator<Item = Entry> + Clone + '_ {
        self.points.iter().flat_map(|point| self.of_point(point))
    }

    /// The unknowns that points see, some several times.
    pub fn unknowns(&self) -> impl Iterator<Item = u32> + '_ {
        self.shares.iter().map(|(unknown, _)| *unknown)
    }

    /// The unknowns that points and springs see, some several times.
    pub fn touched(&self) -> impl Iterator<Item = u32> + '_ {
        let of_springs = self.springs.iter().flat_map(|spring| spring.vector.iter().map(|(at, _)| *at));
        self.unknowns().chain(of_springs)
    }

    /// The entries per point, one point after the other.
    pub fn points(&self) -> impl Iterator<Item = Vec<Entry>> + '_ {
        self.points.iter().map(|point| self.of_point(point).collect())
    }

    fn of_point<'a>(&'a self, point: &'a PointContribution) -> impl Iterator<Item = Entry> + Clone + 'a {
        let entries = self.shares[point.force.clone()].iter().flat_map(|(row, on)| {
            self.shares[point.jump.clone()].iter().map(|(column, of)| {
                let force = |a: usize| (0..3).map(|b| point.slope[a][b] * of[b]).sum::<f64>();
                (*row, *column, point.weight * (0..3).map(|a| on[a] * force(a)).sum::<f64>())
            })
        });
        entries.filter(|(.., value)| *value != 0.0)
    }

    /// The tangent with its unknowns renamed.
    #[must_use]
    pub fn renamed(&self, name: impl Fn(u32) -> u32) -> Tangent {
        let shares = self.shares.iter().map(|&(unknown, on)| (name(unknown), on)).collect();
        let named = |spring: &Spring| Spring {
            stiffness: spring.stiffness,
            vector: spring.vector.iter().map(|&(unknown, value)| (name(unknown), value)).collect(),
        };
        Tangent { shares, points: self.points.clone(), springs: self.springs.iter().map(named).collect() }
    }

    /// The part on the unknowns that have a new name, under these names; other unknowns are dropped.
    #[must_use]
    pub fn within(&self, name: impl Fn(u32) -> Option<u32>) -> Tangent {
        let mut part = Tangent::with_capacity(self.points.len(), self.shares.len());
        for point in &self.points {
            let mut named = |range: &Range<usize>| {
                part.push(self.shares[range.clone()].iter().filter_map(|&(unknown, on)| Some((name(unknown)?, on))))
            };
            let force = named(&point.force);
            let jump = if point.jump == point.force { force.clone() } else { named(&point.jump) };
            if !force.is_empty() && !jump.is_empty() {
                part.points.push(PointContribution { force, jump, ..point.clone() });
            }
        }
        part
    }

    /// Jᵀ.
    #[must_use]
    pub fn transposed(&self) -> Tangent {
        let turned = |point: &PointContribution| PointContribution {
            force: point.jump.clone(),
            jump: point.force.clone(),
            weight: point.weight,
            slope: std::array::from_fn(|a| std::array::from_fn(|b| point.slope[b][a])),
        };
        let points = self.points.iter().map(turned).collect();
        Tangent { shares: self.shares.clone(), points, springs: self.springs.clone() }
    }

    /// Adds `factor` times J x to y.
    pub fn add_product(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        for point in &self.points {
            let mut jump = [0.0; 3];
            for (unknown, of) in &self.shares[point.jump.clone()] {
                let x = x[*unknown as usize];
                (0..3).for_each(|b| jump[b] += of[b] * x);
            }
            let scale = factor * point.weight;
            let force = point.slope.map(|row| scale * (row[0] * jump[0] + row[1] * jump[1] + row[2] * jump[2]));
            for (unknown, on) in &self.shares[point.force.clone()] {
                y[*unknown as usize] += on[0] * force[0] + on[1] * force[1] + on[2] * force[2];
            }
        }
        for spring in &self.springs {
            spring.add(factor * spring.motion(x), y);
        }
    }

    /// True if J is zero.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty() && self.springs.is_empty()
    }

    /// True if both tangents are the same to the last bit.
    #[must_use]
    pub fn is_same(&self, other: &Tangent) -> bool {
        self.bits().eq(other.bits())
    }

    /// All bits that identify the tangent.
    pub(super) fn bits(&self) -> impl Iterator<Item = u64> + '_ {
        let of_point = |point: &PointContribution| {
            let places = [point.force.start, point.force.end, point.jump.start, point.jump.end].map(|at| at as u64);
            let numbers = std::iter::once(point.weight).chain(point.slope.into_iter().flatten());
            places.into_iter().chain(numbers.map(f64::to_bits))
        };
        let of_share =
            |&(unknown, on): &Share| std::iter::once(u64::from(unknown)).chain(on.into_iter().map(f64::to_bits));
        let of_spring = |spring: &Spring| {
            let entries: Vec<u64> =
                spring.vector.iter().flat_map(|(at, value)| [u64::from(*at), value.to_bits()]).collect();
            [spring.stiffness.to_bits(), entries.len() as u64].into_iter().chain(entries)
        };
        let points = self.points.iter().flat_map(of_point).chain(self.shares.iter().flat_map(of_share));
        points.chain(self.springs.iter().flat_map(of_spring))
    }

    /// Positive semidefinite part of J: the symmetric part of each T without its negative principal values. K plus this
    /// part is positive definite if K is.
    #[must_use]
    pub fn resisting(&self) -> Tangent {
        let mut part = Tangent::with_capacity(self.points.len(), self.shares.len());
        for point in &self.points {
            let row = self.shares.get(point.jump.clone()).unwrap_or_default();
            if point.force == point.jump && point.weight > 0.0 {
                part.add(point.weight, row, &resisting(&point.slope));
            }
        }
        part
    }

    /// True if the contribution of every point is symmetric to round-off.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        self.points.iter().all(|point| {
            if point.force == point.jump {
                let t = &point.slope;
                let largest = t.iter().flatten().fold(0.0, |largest: f64, t| largest.max(t.abs()));
                [(0, 1), (0, 2), (1, 2)].iter().all(|&(a, b)| (t[a][b] - t[b][a]).abs() <= ROUND_OFF * largest)
            } else {
                are_parallel(&self.shares[point.force.clone()], &self.shares[point.jump.clone()])
            }
        })
    }
}

/// The symmetric part of a slope without its negative principal values.
fn resisting(slope: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let axes = Sym::from_fn(3, |a, b| 0.5 * (slope[a][b] + slope[b][a])).principal_axes();
    let entry = |a: usize, b: usize| axes.iter().map(|(value, v)| value.max(0.0) * v[a] * v[b]).sum();
    std::array::from_fn(|a| std::array::from_fn(|b| entry(a, b)))
}

/// True if two vectors are multiples of one another, as in a symmetric f nᵀ.
fn are_parallel(force: &[Share], jump: &[Share]) -> bool {
    let first = |(_, on): &Share| on[0];
    let place = (0..jump.len()).max_by(|&a, &b| first(&jump[a]).abs().total_cmp(&first(&jump[b]).abs()));
    let Some((f, n)) = place.and_then(|k| Some((first(force.get(k)?), first(jump.get(k)?)))) else {
        return force.is_empty();
    };
    let agree = |(a, b): (&Share, &Share)| {
        a.0 == b.0 && (first(a) * n - first(b) * f).abs() <= ROUND_OFF * (first(a) * n).abs().max((first(b) * f).abs())
    };
    force.len() == jump.len() && force.iter().zip(jump).all(agree)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The product by points equals that by entries, for points of any form.
    #[test]
    fn the_product_is_that_of_the_entries() {
        let mut tangent = Tangent::new();
        let row = |first: u32| [0, 1, 2, 3].map(|k| (first + k, [0.3 * f64::from(k) - 0.4, 0.7, f64::from(k * k)]));
        tangent.add(2.0, &row(0), &[[3.0, 0.1, 0.0], [0.5, 2.0, -1.0], [0.0, 4.0, 1.0]]);
        tangent.add(0.5, &row(3), &[[1e8, 0.0, 0.0], [0.0; 3], [0.0; 3]]);
        tangent.add_product_of(-0.3, &[(1, 2.0), (5, 3.0)], &[(0, 1.0), (6, -2.0), (2, 0.5)]);
        tangent.add_diagonal([0.0, 1.0, 0.0, 4.0]);
        let x: Vec<f64> = (0..8).map(|i| f64::from(i).sin()).collect();
        let (mut by_points, mut by_entries) = (vec![1.0; 8], vec![1.0; 8]);
        tangent.add_product(-1.0, &x, &mut by_points);
        tangent.entries().for_each(|(i, j, value)| by_entries[i as usize] -= value * x[j as usize]);
        let largest = by_entries.iter().fold(0.0, |largest: f64, y| largest.max(y.abs()));
        assert!(by_points.iter().zip(&by_entries).all(|(a, b)| (a - b).abs() <= 1e-14 * largest));
        let all: Vec<Entry> = tangent.points().flatten().collect();
        assert_eq!(all, tangent.entries().collect::<Vec<Entry>>());
    }

    /// The resisting part has no negative principal values, and forces that are no multiples of a jump are left out.
    #[test]
    fn what_resists_has_no_negative_principal_value() {
        let row = [(0, [1.0, 0.0, 0.0]), (1, [0.0, 1.0, 0.0]), (2, [0.0, 0.0, 1.0])];
        let mut tangent = Tangent::new();
        // Principal values 3 along (1, 1, 0)/√2, −1 along (1, −1, 0)/√2, and −2.
        tangent.add(2.0, &row, &[[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, -2.0]]);
        tangent.add_product_of(1.0, &[(0, 1.0)], &[(2, 1.0)]);
        let mut y = [0.0; 3];
        tangent.resisting().add_product(1.0, &[1.0, 0.0, 5.0], &mut y);
        assert!((y[0] - 3.0).abs() < 1e-14 && (y[1] - 3.0).abs() < 1e-14 && y[2].abs() < 1e-14, "{y:?}");
        assert!(Tangent::new().resisting().is_empty());
    }

    /// The part on some unknowns has the entries between them, and none of a point that sees other unknowns only.
    #[test]
    fn a_part_has_the_entries_between_its_unknowns() {
        let slope = [[3.0, 0.1, 0.0], [0.5, 2.0, -1.0], [0.0, 4.0, 1.0]];
        let mut tangent = Tangent::new();
        tangent.add(2.0, &[2, 3, 4, 7].map(|k| (k, [0.3 * f64::from(k) - 0.4, 0.7, f64::from(k * k)])), &slope);
        tangent.add(1.5, &[(7, [1.0, 0.0, 0.0]), (8, [0.0, 1.0, 0.5])], &slope);
        tangent.add_product_of(-0.3, &[(1, 2.0), (4, 3.0)], &[(0, 1.0), (3, -2.0), (2, 0.5)]);
        tangent.add_product_of(0.7, &[(3, 1.0)], &[(8, 1.0)]);
        let name = |unknown: u32| [None, None, Some(5), Some(0), Some(1)].get(unknown as usize).copied().flatten();
        let named = |(i, j, value): Entry| Some((name(i)?, name(j)?, value));
        let (part, expected) = (tangent.within(name), tangent.entries().filter_map(named).collect::<Vec<Entry>>());
        assert!(expected.len() == 11 && part.points().count() == 2);
        assert_eq!(part.entries().collect::<Vec<Entry>>(), expected);
    }

    /// Friction makes a point nonsymmetric, but not by components that no unknown has.
    #[test]
    fn friction_is_not_symmetric() {
        let row = [(0, [1.0, 0.0, 0.0]), (2, [0.0, 1.0, 0.0]), (3, [-0.4, 0.2, 0.0])];
        let sliding = [[2.0, 0.0, 0.0], [0.6, 1.0, 0.0], [0.0; 3]];
        let across = [[2.0, 0.0, 0.9], [0.0, 1.0, 0.0], [0.6, 0.0, 1.0]];
        let of = |slope| {
            let mut tangent = Tangent::new();
            tangent.add(3.0, &row, slope);
            tangent
        };
        assert!(!of(&sliding).is_symmetric());
        assert!(of(&across).is_symmetric());
        assert!(of(&[[0.0; 3], [0.0; 3], [0.0, 0.0, 1.0]]).is_empty());
        let product = |right: [f64; 2]| {
            let mut tangent = Tangent::new();
            tangent.add_product_of(1.0, &[(0, 2.0), (4, -3.0)], &[(0, right[0]), (4, right[1])]);
            tangent
        };
        assert!(product([-4.0, 6.0]).is_symmetric());
        assert!(!product([-4.0, 6.1]).is_symmetric());
    }
}
