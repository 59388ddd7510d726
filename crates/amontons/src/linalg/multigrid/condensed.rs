//! The operator S = K, without elimination, and the solution of systems with it by a Krylov iteration.

use std::sync::Arc;

use rayon::prelude::*;

use super::kept::KeptMatrix;
use super::limits::{LEFT, LOOKS, NEARLY, NUMBERS, PRODUCTS, SEEN};
use super::local::ContactBlocks;
use super::precondition::Preconditioner;
use super::relieved::Relieved;
use crate::linalg::condensed::Condensed;
use crate::linalg::error::SolveError;
use crate::linalg::krylov::{Definite, conjugate_gradients, gmres};
use crate::linalg::relief::Account;
use crate::linalg::sparse::BlockMatrix;
use crate::linalg::stop::StopFlag;
use crate::linalg::tangent::Tangent;
use crate::linalg::turn::Turn;
use crate::linalg::unknowns::Unknowns;
use crate::linalg::vectors::{add_combination, copy, dot, max_abs, zeros};

/// The operator, with the preconditioner of the last tangent.
#[derive(Debug)]
pub(super) struct Iterative {
    kept: KeptMatrix,
    /// Turned bases by unknown, and by degree of freedom.
    turns: Vec<Turn>,
    turns_by_degree: Vec<Turn>,
    preconditioner: Option<Preconditioner>,
    /// Tangent in the preconditioner, or `None` if that is in other bases.
    tangent: Option<Tangent>,
    iterations: usize,
    /// Work so far, the factor that replaces the iteration, and true if it could not be made.
    account: Account,
    relieved: Option<Relieved>,
    has_no_factor: bool,
    stop: StopFlag,
}

impl Iterative {
    pub fn new(matrix: &Arc<BlockMatrix>, unknowns: &Unknowns, stop: StopFlag) -> Iterative {
        Iterative {
            kept: KeptMatrix::new(matrix, unknowns),
            turns: Vec::new(),
            turns_by_degree: Vec::new(),
            preconditioner: None,
            tangent: None,
            iterations: 0,
            account: Account::default(),
            relieved: None,
            has_no_factor: false,
            stop,
        }
    }

    /// (S + J) x.
    fn sum(&self, tangent: &Tangent, x: &[f64]) -> Vec<f64> {
        let mut y = self.product(x);
        tangent.add_product(1.0, x, &mut y);
        y
    }

    fn product(&self, x: &[f64]) -> Vec<f64> {
        let mut straight = self.kept.spread(x);
        self.turns_by_degree.iter().for_each(|turn| turn.back(&mut straight));
        let mut y = self.kept.unknowns().pick(&self.kept.matrix().apply(&straight));
        self.turns.iter().for_each(|turn| turn.forward(&mut y));
        y
    }

    /// Builds the preconditioner, or updates it for another tangent.
    fn prepare(&mut self, tangent: &Tangent) -> Result<(), SolveError> {
        let is_same = self.tangent.as_ref().is_some_and(|taken| taken.is_same(tangent));
        if is_same && self.preconditioner.is_some() {
            return Ok(());
        }
        let preconditioner = self.preconditioner.take();
        if let (None, Some(relief)) = (&preconditioner, &self.kept.unknowns().relief) {
            relief.count_matrix(&mut self.account);
        }
        let body = self.kept.masked();
        let mut preconditioner = match preconditioner {
            Some(preconditioner) => preconditioner,
            None => Preconditioner::new(&body, &self.stop)?,
        };
        let by_degree = self.kept.spread_springs(tangent);
        preconditioner.add(&body, &by_degree, &self.turns_by_degree)?;
        (self.preconditioner, self.tangent) = (Some(preconditioner), Some(tangent.clone()));
        Ok(())
    }

    /// An approximate solution of (S + J) x = r, r over all degrees of freedom.
    fn precondition(&self, r: Vec<f64>) -> Vec<f64> {
        match &self.preconditioner {
            Some(preconditioner) => self.kept.unknowns().pick(&preconditioner.apply(&self.kept.masked(), r)),
            None => self.kept.unknowns().pick(&r),
        }
    }

    /// Blocks at the degrees of freedom that contact touches, or `None` if there are none.
    fn touched(&self) -> Option<&ContactBlocks> {
        self.preconditioner.as_ref().and_then(Preconditioner::local)
    }

    /// L r by unknown, on the degrees of freedom where contact acts.
    fn solution(&self, r: &[f64]) -> Vec<(usize, f64)> {
        let position = |dof: u32| self.kept.positions()[dof as usize].map(|at| at as usize);
        let Some(local) = self.touched() else { return Vec::new() };
        let solution = local.solution(|dof| position(dof).map_or(0.0, |at| r[at]));
        solution.into_iter().filter_map(|(dof, value)| Some((position(dof)?, value))).collect()
    }

    /// Weighs a residual: where contact acts, by the displacement that it means, times the stiffness of K.
    fn weigh(&self, r: &mut [f64]) {
        for (unknown, x) in self.solution(r) {
            r[unknown] = self.kept.scale()[unknown] * x;
        }
    }

    /// Norm of the weighed residual.
    fn weight(&self, r: &[f64]) -> f64 {
        let mut weighed = copy(r);
        self.weigh(&mut weighed);
        norm(&weighed)
    }

    /// Inverse of the weighing: the residual over all degrees of freedom.
    fn unweighed(&self, weighed: &[f64]) -> Vec<f64> {
        let mut r = self.kept.spread(weighed);
        if let Some(local) = self.touched() {
            let scale = |dof: u32| self.kept.positions()[dof as usize].map_or(1.0, |at| self.kept.scale()[at as usize]);
            for (dof, load) in local.load(|dof| r[dof as usize] / scale(dof)) {
                r[dof as usize] = load;
            }
        }
        r
    }

    /// Corrects x once more by the remaining residual where contact acts.
    fn settle(&self, rest: &[f64], x: &mut [f64]) {
        for (unknown, change) in self.solution(rest) {
            x[unknown] += change;
        }
    }

    /// Writes the residual b − (S + J) x to `rest`.
    fn leave(&self, tangent: &Tangent, b: &[f64], x: &[f64], rest: &mut [f64]) {
        rest.par_iter_mut().zip(b).zip(&self.sum(tangent, x)).for_each(|((rest, b), sum)| *rest = b - sum);
    }

    /// Flexible GMRES, for a preconditioner that is not quite linear, as one in single precision: the preconditioned
    /// vectors are stored (Saad, SIAM J. Sci. Comput. 14 (1993) 461). Returns the approximate solution and the number
    /// of products.
    fn flexible(
        &self,
        product: impl Fn(&[f64]) -> Result<Vec<f64>, SolveError>,
        rest: &[f64],
        goal: f64,
        limit: usize,
    ) -> Result<(Vec<f64>, usize), SolveError> {
        let mut kept: Vec<Vec<f64>> = Vec::new();
        let apply = |v: &[f64]| -> Result<Vec<f64>, SolveError> {
            let made = self.precondition(self.unweighed(v));
            let mut image = product(&made)?;
            self.weigh(&mut image);
            kept.push(made);
            Ok(image)
        };
        let mut weighed = copy(rest);
        self.weigh(&mut weighed);
        let solved = gmres(apply, &weighed, goal, limit)?;
        let mut x = zeros(rest.len());
        add_combination(&mut x, &solved.components, &kept);
        Ok((x, solved.iterations))
    }

    /// Counts products.
    fn count(&mut self, products: usize) {
        self.iterations += products;
        if let Some(relief) = &self.kept.unknowns().relief {
            relief.count_products(&mut self.account, products);
        }
    }

    /// True if a system with this tangent may be solved by a factor instead: the factor keeps the unknowns of Γ_C and
    /// cannot represent a term elsewhere, as that of a proximal step.
    fn may_be_relieved_of(&self, tangent: &Tangent) -> bool {
        let (components, _) = self.kept.matrix().block_shape();
        let node =
            |unknown: u32| self.kept.unknowns().dofs.get(unknown as usize).map(|dof| dof / components.max(1) as u32);
        self.kept.unknowns().relief.as_ref().is_some_and(|relief| {
            let is_kept = |node: u32| relief.contact.binary_search(&node).is_ok();
            !self.has_no_factor && tangent.unknowns().all(|unknown| node(unknown).is_some_and(is_kept))
        })
    }

    /// True if systems with this tangent are now solved by the factor.
    fn is_relieved_of(&self, tangent: &Tangent) -> bool {
        self.account.is_left && self.may_be_relieved_of(tangent)
    }

    /// Number of products after which the iteration is replaced by the factor.
    fn products_left(&self, tangent: &Tangent) -> usize {
        match &self.kept.unknowns().relief {
            Some(relief) if self.may_be_relieved_of(tangent) => relief.products_left(&self.account),
            _ => usize::MAX,
        }
    }

    /// The factor that replaces the iteration, made once, or `None` if it cannot be made.
    fn factor(&mut self) -> Result<Option<&mut Relieved>, SolveError> {
        if let (None, Some(relief)) = (&self.relieved, &self.kept.unknowns().relief) {
            self.preconditioner = None;
            match Relieved::new(self.kept.matrix(), self.kept.unknowns(), self.kept.free(), relief, &self.stop) {
                Ok(made) => self.relieved = Some(made),
                Err(SolveError::Interrupted) => return Err(SolveError::Interrupted),
                Err(_) => self.has_no_factor = true,
            }
        }
        Ok(self.relieved.as_mut())
    }

    /// Solution of (S + J) x = b by the factor, or `None` if the iteration is not replaced by it.
    fn by_factor(&mut self, tangent: &Tangent, b: &[f64]) -> Result<Option<Vec<f64>>, SolveError> {
        if !self.is_relieved_of(tangent) {
            return Ok(None);
        }
        let mut straight = self.kept.spread(b);
        self.turns_by_degree.iter().for_each(|turn| turn.back(&mut straight));
        let (turns, by_degree) = (self.turns_by_degree.clone(), self.kept.by_degree(tangent));
        let Some(factor) = self.factor()? else { return Ok(None) };
        let mut x = factor.solve(&by_degree, &turns, &straight)?;
        for turn in &turns {
            turn.forward(&mut x);
        }
        Ok(Some(self.kept.unknowns().pick(&x)))
    }

    /// True if S + J is positive definite, by the factor, or `None` if the iteration is not replaced by it.
    fn definite_by_factor(&mut self, tangent: &Tangent) -> Result<Option<bool>, SolveError> {
        if !self.is_relieved_of(tangent) {
            return Ok(None);
        }
        let (turns, by_degree) = (self.turns_by_degree.clone(), self.kept.by_degree(tangent));
        let Some(factor) = self.factor()? else { return Ok(None) };
        factor.is_positive_definite(&by_degree, &turns).map(Some)
    }

    /// Iterates from x = 0 until the residual is `wanted` of b, and returns the solution and its relative residual. It
    /// uses conjugate gradients if J is symmetric, as long as they meet no energy that is not positive, otherwise
    /// GMRES.
    fn iterate(&mut self, tangent: &Tangent, b: &[f64], wanted: f64) -> Result<(Vec<f64>, f64), SolveError> {
        let mut has_energy = tangent.is_symmetric();
        let (mut x, mut rest, mut left) = (zeros(b.len()), copy(b), 1.0);
        let whole = self.weight(b);
        let most = (NUMBERS / b.len()).clamp(PRODUCTS[0], PRODUCTS[1]);
        for _ in 0..LOOKS {
            let goal = (wanted / left).min(0.1);
            let product = |v: &[f64]| self.stop.go_on().map(|()| self.sum(tangent, v));
            let (had_energy, products) = (has_energy, most.min(self.products_left(tangent)));
            let mut meets_none = false;
            let (change, made) = if has_energy {
                let solved = conjugate_gradients(
                    product,
                    |r| self.precondition(self.kept.spread(r)),
                    &rest,
                    |r| self.weight(r),
                    goal,
                    products,
                )?;
                meets_none = solved.definite == Definite::No;
                (solved.x, solved.iterations)
            } else {
                self.flexible(product, &rest, goal, products)?
            };
            self.count(made);
            add_combination(&mut x, &[1.0], &[change]);
            self.leave(tangent, b, &x, &mut rest);
            self.settle(&rest, &mut x);
            self.leave(tangent, b, &x, &mut rest);
            let now = self.weight(&rest) / whole;
            // Close to the solution a nonpositive energy is round-off.
            has_energy &= !(meets_none && now > wanted.sqrt());
            let stalls = (now > 0.5 * left || now.is_nan()) && has_energy == had_energy;
            left = now;
            // The recurrence and the true residual differ a little.
            if left <= NEARLY * wanted || stalls || self.is_relieved_of(tangent) {
                break;
            }
        }
        Ok((x, left))
    }
}

impl Condensed for Iterative {
    fn scale(&self) -> &[f64] {
        self.kept.scale()
    }

    fn apply(&self, x: &[f64]) -> Result<Vec<f64>, SolveError> {
        Ok(self.product(x))
    }

    fn magnitude(&self, x: &[f64]) -> Result<f64, SolveError> {
        Ok(max_abs(&self.kept.unknowns().pick(&self.kept.matrix().magnitude(&self.kept.spread(x)))))
    }

    fn solve(&mut self, tangent: &Tangent, b: &mut [f64], enough: f64) -> Result<(), SolveError> {
        if b.iter().all(|b| *b == 0.0) {
            return Ok(());
        }
        if let Some(x) = self.by_factor(tangent, b)? {
            b.copy_from_slice(&x);
            return Ok(());
        }
        self.prepare(tangent)?;
        if let Some(relief) = &self.kept.unknowns().relief {
            relief.count_system(&mut self.account);
        }
        let (x, left) = self.iterate(tangent, b, enough)?;
        if left > NEARLY * enough
            && let Some(x) = self.by_factor(tangent, b)?
        {
            b.copy_from_slice(&x);
            return Ok(());
        }
        b.copy_from_slice(&x);
        // Half of the requested digits suffice for a stalled iteration.
        if left <= enough.sqrt() {
            Ok(())
        } else if left > LEFT || left.is_nan() {
            Err(SolveError::Singular { size: b.len() })
        } else {
            Err(SolveError::NotConverged { size: b.len(), iterations: self.iterations, residual: left })
        }
    }

    fn is_positive_definite(&mut self, tangent: &Tangent) -> Result<bool, SolveError> {
        if self.is_empty() {
            return Ok(true);
        }
        if let Some(found) = self.definite_by_factor(tangent)? {
            return Ok(found);
        }
        // A preconditioner that contains the indefinite part of K + J would hide it: with it the product is near the
        // identity, and no energy that conjugate gradients meet is negative.
        self.prepare(&tangent.resisting())?;
        // Fractional parts of multiples of the golden ratio: no eigenvector is orthogonal to them by symmetry.
        let b: Vec<f64> = (1..=self.len()).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract() - 0.5).collect();
        let product = |v: &[f64]| self.stop.go_on().map(|()| self.sum(tangent, v));
        let precondition = |r: &[f64]| self.precondition(self.kept.spread(r));
        let solved = conjugate_gradients(product, precondition, &b, norm, SEEN, PRODUCTS[0] * LOOKS)?;
        self.count(solved.iterations);
        match solved.definite {
            Definite::No => Ok(false),
            Definite::Seen if solved.residual <= SEEN => Ok(true),
            Definite::Seen => Err(SolveError::NotConverged {
                size: self.len(),
                iterations: solved.iterations,
                residual: solved.residual,
            }),
        }
    }

    fn turn(&mut self, turns: &[Turn]) {
        if self.turns != turns {
            self.turns = turns.to_vec();
            self.turns_by_degree = self.kept.turns_by_degree(turns);
            self.tangent = None;
        }
    }

    fn turns(&self) -> &[Turn] {
        &self.turns
    }

    fn account(&self) -> Account {
        self.account
    }

    fn go_on_from(&mut self, account: Account) {
        self.account = account;
    }

    fn iterations(&self) -> usize {
        self.iterations
    }
}

fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}
