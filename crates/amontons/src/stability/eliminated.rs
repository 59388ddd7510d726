//! Unknowns that conditions of the contact eliminate, and test functions on which its reactions do no work.
//!
//! A point that is held (a closed gap on a rigid foundation, a point that sticks) gives one condition c·x = 0 on the
//! perturbation, and one reaction that acts on the equations by a column r. The perturbations that satisfy all
//! conditions are x = Z ξ, and the tests on which no reaction acts are the columns of W, rᵀW = 0, so that the reactions
//! drop out of Wᵀ T Z ξ = 0. With friction r has a part along the slip and is not c, so that W is not Z. In a sector of
//! a cyclic body both are complex; a reaction is given by the functional whose conjugate it acts by, and it is Wᴴ T Z.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use faer::c64;

/// A linear function of the unknowns: their numbers and factors, each number once.
pub(super) type Functional = Vec<(u32, c64)>;

/// Part of a condition, relative to what it was, that is left when it follows from others.
const NOTHING: f64 = 1e-9;

/// A held component of a contact point: the condition on the unknowns, and the column of its reaction in the equations.
#[derive(Clone, Debug, Default)]
pub(super) struct HeldRow {
    pub condition: Functional,
    pub reaction: Functional,
}

/// A basis of the vectors on which some functionals vanish: each unknown as a combination of those that are left.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Basis(Vec<Functional>);

impl Basis {
    /// An unknown as a combination of those that are left.
    pub fn of(&self, unknown: usize) -> &[(u32, c64)] {
        self.0.get(unknown).map_or(&[], Vec::as_slice)
    }

    /// The same with the unknowns that are left by other numbers.
    pub fn renumbered(mut self, number: &[u32]) -> Basis {
        for (at, _) in self.0.iter_mut().flatten() {
            *at = number[*at as usize];
        }
        self
    }

    /// The unknowns of a vector on those that are left.
    pub fn expand(&self, x: &[c64]) -> Vec<c64> {
        self.0.iter().map(|row| row.iter().map(|&(at, factor)| x[at as usize] * factor).sum()).collect()
    }
}

/// The conditions and reactions that are eliminated, in reduced form: each has an unknown of its own that no other has.
#[derive(Default)]
struct ReducedRows {
    rows: Vec<ReducedRow>,
    /// Row by its own unknown.
    pivots: BTreeMap<u32, usize>,
    /// The rows that have, or once had, an unknown that is not their own.
    with: BTreeMap<u32, Vec<usize>>,
}

/// The factors of a row by unknown.
type ReducedRow = BTreeMap<u32, c64>;

impl ReducedRows {
    /// A functional without the unknowns of the rows, and its largest entry among those that may be eliminated, or the
    /// one that is `given`; `None` if nothing is left of it.
    fn rest(
        &self,
        functional: &Functional,
        may: &impl Fn(u32) -> bool,
        given: Option<u32>,
    ) -> Option<(ReducedRow, u32)> {
        let (mut rest, mut size) = (ReducedRow::new(), 0.0f64);
        for &(unknown, factor) in functional {
            *rest.entry(unknown).or_default() += factor;
            if may(unknown) {
                size = size.max(factor.norm());
            }
        }
        let known: Vec<(u32, c64)> =
            rest.iter().filter(|(unknown, _)| self.pivots.contains_key(unknown)).map(|(u, f)| (*u, *f)).collect();
        for (unknown, factor) in known {
            if let Some(row) = self.pivots.get(&unknown).and_then(|row| self.rows.get(*row)) {
                for (other, value) in row {
                    *rest.entry(*other).or_default() -= factor * value;
                }
            }
            rest.remove(&unknown);
        }
        let largest =
            rest.iter().filter(|(unknown, _)| may(**unknown)).max_by(|a, b| a.1.norm().total_cmp(&b.1.norm()));
        let largest = largest.map(|(unknown, value)| (*unknown, *value));
        let (pivot, value) = given.map_or(largest, |given| Some((given, *rest.get(&given)?)))?;
        if value.norm() <= NOTHING * size {
            return None;
        }
        for factor in rest.values_mut() {
            *factor /= value;
        }
        Some((rest, pivot))
    }

    /// Adds a row that was reduced, with its own unknown.
    fn add(&mut self, (new, pivot): (ReducedRow, u32)) {
        let others = || new.iter().filter(|(unknown, _)| **unknown != pivot);
        for number in self.with.remove(&pivot).unwrap_or_default() {
            let Some(row) = self.rows.get_mut(number) else { continue };
            let Some(factor) = row.remove(&pivot) else { continue };
            for (unknown, value) in others() {
                match row.entry(*unknown) {
                    Entry::Occupied(mut known) => *known.get_mut() -= factor * value,
                    Entry::Vacant(none) => {
                        none.insert(-factor * value);
                        self.with.entry(*unknown).or_default().push(number);
                    }
                }
            }
        }
        for (unknown, _) in others() {
            self.with.entry(*unknown).or_default().push(self.rows.len());
        }
        self.pivots.insert(pivot, self.rows.len());
        self.rows.push(new);
    }
}

/// The unknowns that the condition and the reaction of each held component eliminate; `None` of one that is left out.
pub(super) type ChosenPivots = Vec<Option<[u32; 2]>>;

/// What is left of the unknowns.
pub(super) struct Elimination {
    /// The unknowns that are left.
    pub left: Vec<u32>,
    /// Z and W.
    pub trial: Basis,
    pub test: Basis,
    pub pivots: ChosenPivots,
}

/// Z and W for held components: `may` tells the unknowns that may be eliminated. A component that others hold already,
/// or whose reaction does no work, is left out. Unknown and test of the same number belong to the same degree of
/// freedom wherever that is possible. With `given` pivots the basis is that of a state nearby, and follows from it
/// without a jump; `None` if they do not suit.
pub(super) fn eliminate(
    size: usize,
    held: &[HeldRow],
    may: impl Fn(u32) -> bool,
    given: Option<&ChosenPivots>,
) -> Option<Elimination> {
    let (mut conditions, mut reactions) = (ReducedRows::default(), ReducedRows::default());
    let mut pivots = ChosenPivots::with_capacity(held.len());
    for (i, HeldRow { condition, reaction }) in held.iter().enumerate() {
        let own = given.map(|given| given.get(i).copied());
        if own == Some(Some(None)) {
            pivots.push(None);
            continue;
        }
        let own = match own {
            None => [None; 2],
            Some(own) => own.flatten()?.map(Some),
        };
        let rests = (conditions.rest(condition, &may, own[0]), reactions.rest(reaction, &may, own[1]));
        let (Some(condition), Some(reaction)) = rests else {
            if given.is_some() {
                return None;
            }
            pivots.push(None);
            continue;
        };
        pivots.push(Some([condition.1, reaction.1]));
        conditions.add(condition);
        reactions.add(reaction);
    }
    let (left, trial, test) = bases(size, [&conditions, &reactions]);
    Some(Elimination { left, trial, test, pivots })
}

/// The unknowns that are left, Z and W.
fn bases(size: usize, [conditions, reactions]: [&ReducedRows; 2]) -> (Vec<u32>, Basis, Basis) {
    let [gone, untested] = [conditions, reactions].map(|reduced| &reduced.pivots);
    let left: Vec<u32> = (0..size as u32).filter(|unknown| !gone.contains_key(unknown)).collect();
    let mut number = vec![u32::MAX; size];
    left.iter().enumerate().for_each(|(k, unknown)| number[*unknown as usize] = k as u32);
    let mut tests = number.clone();
    // Where a test is left of a degree of freedom that is eliminated, it takes the place of one that is not tested.
    let mut places = untested.keys().filter(|unknown| !gone.contains_key(unknown));
    for unknown in gone.keys().filter(|unknown| !untested.contains_key(unknown)) {
        tests[*unknown as usize] = places.next().map_or(u32::MAX, |place| number[*place as usize]);
    }
    let basis = |reduced: &ReducedRows, number: &[u32]| {
        let of = |unknown: u32| match reduced.pivots.get(&unknown).and_then(|row| reduced.rows.get(*row)) {
            None => vec![(number[unknown as usize], c64::new(1.0, 0.0))],
            Some(row) => {
                let others = row.iter().filter(|(other, value)| **other != unknown && value.norm() > 0.0);
                others.map(|(other, value)| (number[*other as usize], -value)).collect()
            }
        };
        Basis((0..size as u32).map(of).collect())
    };
    let (trial, test) = (basis(conditions, &number), basis(reactions, &tests));
    (left, trial, test)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Conditions vanish on Z, reactions on W, also where a condition is given twice and where tests take other places.
    #[test]
    fn conditions_and_reactions_vanish() -> Result<(), &'static str> {
        let of = |real: &[(u32, f64)]| {
            real.iter().map(|&(unknown, factor)| (unknown, c64::from_polar(factor, f64::from(unknown)))).collect()
        };
        let held = |condition: &[(u32, f64)], reaction: &[(u32, f64)]| HeldRow {
            condition: of(condition),
            reaction: of(reaction),
        };
        let all = [
            held(&[(0, 1.0), (1, 0.2)], &[(0, 0.1), (1, 1.0)]),
            held(&[(2, 1.0), (3, -0.5), (0, 0.3)], &[(3, 1.0), (1, 0.5), (5, 2.0)]),
            held(&[(2, 2.0), (3, -1.0), (0, 0.6)], &[(3, 1.0), (1, 0.4)]),
        ];
        let Elimination { left, trial: z, test: w, pivots } =
            eliminate(6, &all, |unknown| unknown < 5, None).ok_or("no basis")?;
        assert_eq!(left.len(), 4);
        // The same rows with the same pivots have the same basis; other pivots are refused.
        let again = eliminate(6, &all, |unknown| unknown < 5, Some(&pivots)).ok_or("no basis")?;
        assert_eq!((again.left, again.trial, again.test), (left, z.clone(), w.clone()));
        assert!(eliminate(6, &all, |unknown| unknown < 5, Some(&vec![Some([5, 5]); 3])).is_none());
        for k in 0..4 {
            let unit: Vec<c64> = (0..4).map(|j| c64::new(f64::from(u8::from(j == k)), 0.0)).collect();
            let [x, y] = [&z, &w].map(|basis| basis.expand(&unit));
            for HeldRow { condition, reaction } in &all[..2] {
                let on = |f: &Functional, v: &[c64]| f.iter().map(|(u, c)| c * v[*u as usize]).sum::<c64>();
                assert!(on(condition, &x).norm() < 1e-15 && on(reaction, &y).norm() < 1e-15, "{k}");
            }
            assert!(x.iter().any(|x| x.norm() > 0.5) && y.iter().any(|y| y.norm() > 0.5));
        }
        Ok(())
    }
}
