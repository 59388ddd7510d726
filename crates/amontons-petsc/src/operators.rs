//! The operators of an iteration on the own rows: S + J, the preconditioner, and the weighed residual.
//!
//! They are those of the iterative solver of the library (`linalg/multigrid/local.rs` there says why), with its levels
//! replaced by those of PETSc and with the values that contact touches sent to all processes.

use std::cell::Cell;

use amontons::linalg::{ContactBlocks, SolveError, Tangent, Turn};

use crate::distributed::Shared;
use crate::rows::{Rows, Seen};
use crate::session::{Session, Step};
use crate::sys::{self, Operators, Solver};

/// Iterations between two looks at the flags by which processes are asked to end.
const LOOK: usize = 16;

/// The solver where contact acts, with the places of its values and the stiffness of K there.
#[derive(Debug)]
pub struct Local {
    pub blocks: ContactBlocks,
    pub seen: Seen,
    pub scale: Vec<f64>,
}

impl Local {
    /// The stiffness of K at a degree of freedom.
    fn stiffness(&self, dof: u32) -> f64 {
        let place = self.blocks.dofs().binary_search(&dof);
        place.ok().and_then(|place| self.scale.get(place)).copied().unwrap_or(1.0)
    }
}

/// J on the degrees of freedom that it touches.
#[derive(Debug)]
pub struct Jump {
    tangent: Tangent,
    seen: Seen,
    count: usize,
}

impl Jump {
    /// J from a tangent by degree of freedom.
    pub fn new(session: &Session, rows: &Rows, by_degree: &Tangent) -> Jump {
        let mut dofs: Vec<u32> = by_degree.touched().collect();
        dofs.sort_unstable();
        dofs.dedup();
        let place = |dof: u32| dofs.binary_search(&dof).unwrap_or_default() as u32;
        Jump { tangent: by_degree.renamed(place), seen: Seen::new(session, rows, &dofs), count: dofs.len() }
    }

    /// Adds J x.
    fn add(&self, session: &Session, x: &[f64], y: &mut [f64]) -> Result<(), SolveError> {
        let (x, mut forces) = (self.seen.gather(session, x)?, vec![0.0; self.count]);
        self.tangent.add_product(1.0, &x, &mut forces);
        self.seen.add(&forces, y);
        Ok(())
    }
}

/// How residuals are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Measure {
    /// By conjugate gradients, whose residuals are weighed for their norm alone.
    Weighed,
    /// By GMRES, which works with weighed residuals.
    Throughout,
    /// As they are.
    Plain,
}

/// The operators of one iteration.
pub struct Running<'a> {
    shared: &'a Shared,
    own_turns: &'a [Turn],
    local: Option<&'a Local>,
    jump: Option<&'a Jump>,
    cycle: Option<&'a Solver>,
    measure: Cell<Measure>,
    /// True if an energy was not positive.
    meets_none: Cell<bool>,
    looks: Cell<usize>,
    last: Cell<f64>,
}

impl<'a> Running<'a> {
    pub fn new(
        shared: &'a Shared,
        own_turns: &'a [Turn],
        (local, jump): (Option<&'a Local>, Option<&'a Jump>),
        cycle: Option<&'a Solver>,
    ) -> Running<'a> {
        let (measure, meets_none) = (Cell::new(Measure::Weighed), Cell::new(false));
        Running {
            shared,
            own_turns,
            local,
            jump,
            cycle,
            measure,
            meets_none,
            looks: Cell::new(0),
            last: Cell::new(1.0),
        }
    }

    /// Begins an iteration by conjugate gradients, or by GMRES on weighed residuals.
    pub fn begin(&self, is_symmetric: bool) {
        self.measure.set(if is_symmetric { Measure::Weighed } else { Measure::Throughout });
        self.meets_none.set(false);
    }

    /// Begins conjugate gradients on residuals as they are.
    pub fn begin_plain(&self) {
        self.measure.set(Measure::Plain);
        self.meets_none.set(false);
    }

    /// True if conjugate gradients met an energy that was not positive.
    pub fn meets_none(&self) -> bool {
        self.meets_none.get()
    }

    /// Norm of the last residual of conjugate gradients.
    pub fn last(&self) -> f64 {
        self.last.get()
    }

    /// (S + J) x.
    pub fn apply(&self, x: &[f64], y: &mut [f64]) -> Result<(), SolveError> {
        let Shared { session, product, .. } = self.shared;
        if self.own_turns.is_empty() {
            session.given(product.product(x, y))?;
        } else {
            let mut straight = x.to_vec();
            self.own_turns.iter().for_each(|turn| turn.back(&mut straight));
            session.given(product.product(&straight, y))?;
            self.own_turns.iter().for_each(|turn| turn.forward(y));
        }
        match self.jump {
            Some(jump) => jump.add(session, x, y),
            None => Ok(()),
        }
    }

    /// Writes the residual b − (S + J) x to `rest`.
    pub fn leave(&self, b: &[f64], x: &[f64], rest: &mut [f64]) -> Result<(), SolveError> {
        self.apply(x, rest)?;
        rest.iter_mut().zip(b).for_each(|(rest, b)| *rest = b - *rest);
        Ok(())
    }

    /// Corrects x once more by the remaining residual where contact acts.
    pub fn settle(&self, rest: &[f64], x: &mut [f64]) -> Result<(), SolveError> {
        let Some(local) = self.local else { return Ok(()) };
        let here = local.seen.gather(&self.shared.session, rest)?;
        local.seen.add(&local.blocks.solved(&here), x);
        Ok(())
    }

    /// Euclidean norm.
    pub fn length(&self, r: &[f64]) -> Result<f64, SolveError> {
        Ok(self.product_of(r, r)?.sqrt())
    }

    fn product_of(&self, a: &[f64], b: &[f64]) -> Result<f64, SolveError> {
        let mut sum = [a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()];
        self.shared.session.given(sys::sum(&mut sum))?;
        Ok(sum[0])
    }

    /// The residual weighed: where contact acts by the displacement that it means, times the stiffness of K.
    pub fn weighed(&self, r: &[f64]) -> Result<Vec<f64>, SolveError> {
        let mut weighed = r.to_vec();
        self.weigh(&mut weighed)?;
        Ok(weighed)
    }

    fn weigh(&self, r: &mut [f64]) -> Result<(), SolveError> {
        let Some(local) = self.local else { return Ok(()) };
        let mut here = local.seen.gather(&self.shared.session, r)?;
        local.blocks.weigh(&mut here, |dof| local.stiffness(dof));
        local.seen.put(&here, r);
        Ok(())
    }

    fn unweigh(&self, r: &mut [f64]) -> Result<(), SolveError> {
        let Some(local) = self.local else { return Ok(()) };
        let mut here = local.seen.gather(&self.shared.session, r)?;
        local.blocks.unweigh(&mut here, |dof| local.stiffness(dof));
        local.seen.put(&here, r);
        Ok(())
    }

    /// Norm of the weighed residual.
    pub fn weight(&self, r: &[f64]) -> Result<f64, SolveError> {
        self.length(&self.weighed(r)?)
    }

    /// Approximate solution by the levels, in the axes of space.
    fn cycle(&self, r: &[f64], x: &mut [f64]) -> Result<(), SolveError> {
        if let Some(solver) = self.cycle {
            return self.shared.session.given(solver.cycle(r, x));
        }
        x.copy_from_slice(r);
        Ok(())
    }

    /// Approximate solution of (K + J) x = r by the levels, between two local solutions where contact acts: a symmetric
    /// operator if J is symmetric. `r` is changed.
    fn around(&self, local: &Local, r: &mut [f64], x: &mut [f64]) -> Result<(), SolveError> {
        let Shared { session, product, .. } = self.shared;
        let (blocks, seen) = (&local.blocks, &local.seen);
        let own = seen.gather(session, r)?;
        let before = blocks.solved(&own);
        seen.put(&blocks.straight(blocks.without_forces(&own, &before)), r);
        let (mut moved, mut forces) = (vec![0.0; r.len()], vec![0.0; r.len()]);
        seen.put(&blocks.straight(before.clone()), &mut moved);
        session.given(product.product(&moved, &mut forces))?;
        r.iter_mut().zip(&forces).for_each(|(r, force)| *r -= force);
        self.cycle(r, x)?;
        let mut here = blocks.turned(seen.gather(session, x)?);
        here.iter_mut().zip(&before).for_each(|(here, before)| *here += before);
        seen.put(&blocks.straight(here.clone()), x);
        let mut rest = blocks.without_forces(&own, &here);
        session.given(product.product(x, &mut forces))?;
        let forces = blocks.turned(seen.gather(session, &forces)?);
        rest.iter_mut().zip(&forces).for_each(|(rest, force)| *rest -= force);
        here.iter_mut().zip(blocks.solved(&rest)).for_each(|(here, change)| *here += change);
        seen.put(&here, x);
        Ok(())
    }
}

impl Operators for Running<'_> {
    fn product(&self, x: &[f64], y: &mut [f64]) -> Result<(), SolveError> {
        self.apply(x, y)?;
        if self.measure.get() == Measure::Throughout {
            return self.weigh(y);
        }
        let energy = self.product_of(x, y)?;
        if energy.is_nan() || energy <= 0.0 {
            self.meets_none.set(true);
        }
        Ok(())
    }

    fn precondition(&self, r: &[f64], x: &mut [f64]) -> Result<(), SolveError> {
        let mut r = r.to_vec();
        if self.measure.get() == Measure::Throughout {
            self.unweigh(&mut r)?;
        }
        match self.local {
            Some(local) => self.around(local, &mut r, x),
            None => self.cycle(&r, x),
        }
    }

    fn norm(&self, r: &[f64]) -> Result<f64, SolveError> {
        let norm = if self.measure.get() == Measure::Plain { self.length(r)? } else { self.weight(r)? };
        self.last.set(norm);
        Ok(norm)
    }

    fn goes_on(&self) -> Result<bool, SolveError> {
        let looks = self.looks.get();
        self.looks.set(looks + 1);
        if looks % LOOK == LOOK - 1 {
            self.shared.session.agree(Step::Iteration, 0)?;
        }
        Ok(!self.meets_none.get())
    }
}
