//! The operator S = K with its rows distributed over the processes, and the solution of systems with it by PETSc.
//!
//! Every process passes the same vectors and gets the same solution. In between it works on its own rows. What contact
//! touches is known to all processes: these few values are sent around, and the local solutions with them are made by
//! every process, so that all have the same bits.

use std::collections::BTreeSet;
use std::sync::Arc;

use amontons::linalg::limits::{LEFT, LOOKS, NEARLY, NUMBERS, PRODUCTS, SEEN};
use amontons::linalg::{Condensed, ContactBlocks, ContactParts, KeptMatrix, SolveError, Tangent, Turn};

use crate::operators::{Jump, Local, Running};
use crate::rows::{Rows, Seen};
use crate::session::{Session, Step, mark};
use crate::sys::{Broken, Iterated, LevelKind, Matrix, Solver, Way};

/// Number of rows up to which the preconditioner is a factor that every process has, and number up to which it becomes
/// a distributed factor once a system has taken [`MANY`] products with levels.
const SMALL: usize = 3000;
const MIDDLE: usize = 300_000;
const MANY: usize = 200;
/// Products that cost as much as to fill the levels anew.
const FILLING: usize = 10;

/// A matrix whose rows are distributed: the same for every operator made of it.
#[derive(Debug)]
pub struct Shared {
    pub session: Arc<Session>,
    pub kept: KeptMatrix,
    pub rows: Rows,
    /// K, for products.
    pub product: Matrix,
}

impl Shared {
    /// Distributes the rows of a matrix.
    pub fn new(session: &Arc<Session>, kept: KeptMatrix) -> Result<Shared, SolveError> {
        let rows = Rows::new(session, kept.matrix(), &kept.unknowns().points);
        let mut product = session.given(shaped(&kept, &rows, None, &BTreeSet::new()))?;
        session.given(filled(&mut product, &kept, &rows, (false, &[], &BTreeSet::new())))?;
        Ok(Shared { session: Arc::clone(session), kept, rows, product })
    }

    /// Own entries of a vector of unknowns.
    fn own(&self, x: &[f64]) -> Vec<f64> {
        self.rows.take(&self.kept.spread(x))
    }

    /// A vector of unknowns from the own entries of all processes.
    fn whole(&self, own: &[f64]) -> Result<Vec<f64>, SolveError> {
        Ok(self.kept.unknowns().pick(&self.rows.gather(&self.session, own)?))
    }
}

/// Blocks beside those of K: row and column in the order of the processes.
type Beside = BTreeSet<(i32, i32)>;

/// A matrix with room for the blocks of K and for some beside them, for a preconditioner or else for products.
fn shaped(
    kept: &KeptMatrix,
    rows: &Rows,
    kind: Option<LevelKind>,
    beside: &Beside,
) -> Result<Matrix, crate::sys::Failure> {
    let mut counts = [vec![0; rows.own.len()], vec![0; rows.own.len()]];
    for (k, &node) in rows.own.iter().enumerate() {
        let mut count = |column: i32| counts[usize::from(!rows.has(column))][k] += 1;
        kept.level_row(node as usize, kind.is_some(), |j, _| count(rows.number[j]));
        let row = rows.number[node as usize];
        beside.range((row, i32::MIN)..=(row, i32::MAX)).for_each(|&(_, column)| count(column));
    }
    Matrix::new(rows.size, kind, [&counts[0], &counts[1]])
}

/// Fills a matrix with the own rows of K, for products or for levels, with blocks of contact, and with zeros beside.
fn filled(
    matrix: &mut Matrix,
    kept: &KeptMatrix,
    rows: &Rows,
    (is_for_levels, joints, beside): (bool, &[Joint], &Beside),
) -> Result<(), crate::sys::Failure> {
    let n = rows.size;
    let mean = mean_diagonal(kept);
    let (mut columns, mut blocks, mut sorted) = (Vec::new(), Vec::new(), Vec::new());
    for (k, &node) in rows.own.iter().enumerate() {
        columns.clear();
        blocks.clear();
        kept.level_row(node as usize, is_for_levels, |j, block| {
            columns.push(rows.number[j]);
            blocks.extend_from_slice(block);
            if j == node as usize {
                // A degree of freedom without stiffness, as that of a following node, would scale the row badly.
                let own = blocks.len() - n * n;
                for c in (0..n).map(|c| own + c * n + c) {
                    if blocks[c].abs() <= f64::MIN_POSITIVE {
                        blocks[c] = mean;
                    }
                }
            }
        });
        let row = rows.number[node as usize];
        for &(_, column) in beside.range((row, i32::MIN)..=(row, i32::MAX)) {
            columns.push(column);
            blocks.extend(std::iter::repeat_n(0.0, n * n));
        }
        let from = joints.partition_point(|(i, ..)| *i < node);
        for (_, j, block) in joints[from..].iter().take_while(|(i, ..)| *i == node) {
            columns.push(rows.number[*j as usize]);
            blocks.extend_from_slice(&block[..n * n]);
        }
        // The first rows of all blocks, then the second rows.
        sorted.clear();
        for r in 0..n {
            blocks.chunks_exact(n * n).for_each(|block| sorted.extend_from_slice(&block[r * n..(r + 1) * n]));
        }
        matrix.add(k, &columns, &sorted)?;
    }
    matrix.ready()
}

/// A block of contact, by nodes.
type Joint = (u32, u32, [f64; 9]);

/// Mean of the positive entries on the diagonal of the unknowns.
fn mean_diagonal(kept: &KeptMatrix) -> f64 {
    let scale = kept.scale();
    scale.iter().sum::<f64>() / scale.len().max(1) as f64
}

/// The operator, with the preconditioner of the last tangent.
#[derive(Debug)]
pub struct Distributed {
    shared: Arc<Shared>,
    turns: Vec<Turn>,
    /// Bases by degree of freedom, and those of own nodes by own row.
    turns_by_degree: Vec<Turn>,
    own_turns: Vec<Turn>,
    /// Tangent in the preconditioner, or `None` if that is in other bases; and its local part.
    tangent: Option<Tangent>,
    local: Option<Local>,
    kind: LevelKind,
    levels: Option<Levels>,
    iterations: usize,
}

/// What an iteration has found so far.
#[derive(Debug)]
struct Found {
    /// Own entries of the solution.
    x: Vec<f64>,
    /// Norm of the weighed residual relative to that of x = 0.
    left: f64,
    products: usize,
    /// True as long as conjugate gradients may solve.
    has_energy: bool,
}

/// The matrix of the levels, K plus what contact adds, with the solver that has them.
#[derive(Debug)]
struct Levels {
    matrix: Matrix,
    beside: Beside,
    joints: Vec<Joint>,
    solver: Solver,
    /// Products of the first system after the levels were filled, or `None` before it; and contact that they lack.
    products: Option<usize>,
    newer: Option<Vec<Joint>>,
}

impl Levels {
    /// Products that a system may take before the levels follow the contact.
    /// Where contact acts, the local solutions follow it in any case.
    fn patience(&self) -> Option<usize> {
        self.products.map(|products| products + FILLING)
    }
}

impl Distributed {
    pub fn new(shared: &Arc<Shared>) -> Distributed {
        Distributed {
            shared: Arc::clone(shared),
            turns: Vec::new(),
            turns_by_degree: Vec::new(),
            own_turns: Vec::new(),
            tangent: None,
            local: None,
            kind: if shared.rows.all() <= SMALL { LevelKind::Copies } else { LevelKind::Levels },
            levels: None,
            iterations: 0,
        }
    }

    /// Builds the preconditioner, or updates it for another tangent.
    fn prepare(&mut self, tangent: &Tangent) -> Result<(), SolveError> {
        if self.tangent.as_ref().is_some_and(|taken| taken.is_same(tangent)) {
            return Ok(());
        }
        let shared = Arc::clone(&self.shared);
        let before = self.local.take();
        let before = before.as_ref().map(|local| &local.blocks);
        let in_bases = (tangent, &self.turns_by_degree[..]);
        let ContactParts { local, joints } = shared.kept.contact(in_bases, self.kind == LevelKind::Levels, before)?;
        self.local = local.map(|blocks| self.local(blocks));
        self.add_levels(joints)?;
        self.tangent = Some(tangent.clone());
        Ok(())
    }

    /// The local solver with the places of its values.
    fn local(&self, blocks: ContactBlocks) -> Local {
        let Shared { session, kept, rows, .. } = &*self.shared;
        let of_dof = |dof: &u32| kept.positions()[*dof as usize].map_or(1.0, |at| kept.scale()[at as usize]);
        let scale = blocks.dofs().iter().map(of_dof).collect();
        Local { seen: Seen::new(session, rows, blocks.dofs()), scale, blocks }
    }

    /// Builds the levels of K with these blocks of contact, or notes that those that are there lack them.
    fn add_levels(&mut self, joints: Vec<Joint>) -> Result<(), SolveError> {
        match &mut self.levels {
            Some(levels) if levels.joints == joints => levels.newer = None,
            Some(levels) if self.kind == LevelKind::Levels && levels.products.is_some() => levels.newer = Some(joints),
            _ => return self.fill_levels(joints),
        }
        Ok(())
    }

    /// Lets the levels follow the contact, if they lack it; true if they did.
    fn renew_levels(&mut self) -> Result<bool, SolveError> {
        let newer = self.levels.as_mut().and_then(|levels| levels.newer.take());
        newer.map_or(Ok(false), |joints| self.fill_levels(joints).map(|()| true))
    }

    /// Builds the levels of K with these blocks of contact, or fills those that are there anew.
    fn fill_levels(&mut self, joints: Vec<Joint>) -> Result<(), SolveError> {
        let Shared { session, kept, rows, .. } = &*self.shared;
        let new: Beside = joints
            .iter()
            .filter(|(i, j, _)| kept.matrix().graph().row(*i as usize).binary_search(j).is_err())
            .map(|(i, j, _)| (rows.number[*i as usize], rows.number[*j as usize]))
            .collect();
        let before = self.levels.take();
        let fits = before.as_ref().is_some_and(|levels| new.is_subset(&levels.beside));
        let mut levels = match before {
            Some(levels) if fits => levels,
            before => {
                let beside: Beside =
                    before.map(|levels| levels.beside).unwrap_or_default().union(&new).copied().collect();
                let mut matrix = session.given(shaped(kept, rows, Some(self.kind), &beside))?;
                if self.kind == LevelKind::Levels {
                    session.given(with_modes(&mut matrix, kept, rows))?;
                }
                let solver = session.given(Solver::new(rows.len()))?;
                Levels { matrix, beside, joints: Vec::new(), solver, products: None, newer: None }
            }
        };
        session.given(levels.matrix.clear())?;
        session.given(filled(&mut levels.matrix, kept, rows, (true, &joints, &levels.beside)))?;
        session.given(levels.solver.levels(&levels.matrix, self.kind))?;
        (levels.joints, levels.products, levels.newer) = (joints, None, None);
        self.levels = Some(levels);
        Ok(())
    }

    /// The operators of an iteration with S + J.
    fn running<'a>(&'a self, jump: Option<&'a Jump>) -> Running<'a> {
        let cycle = self.levels.as_ref().map(|levels| &levels.solver);
        Running::new(&self.shared, &self.own_turns, (self.local.as_ref(), jump), cycle)
    }

    /// J with the places of its values, or `None` if it is zero.
    fn jump(&self, tangent: &Tangent) -> Option<Jump> {
        if tangent.is_empty() {
            return None;
        }
        let Shared { session, kept, rows, .. } = &*self.shared;
        Some(Jump::new(session, rows, &kept.by_degree(tangent)))
    }

    /// Iterates with the present preconditioner.
    fn krylov(&self, running: &Running, rest: &[f64], way: Way) -> Result<Iterated, SolveError> {
        let Some(levels) = &self.levels else { return Ok(Iterated::default()) };
        match levels.solver.solve(running, rest, way) {
            Ok(found) => Ok(found),
            Err(Broken::Program(error)) => Err(error),
            Err(Broken::Library(failure)) => self.shared.session.given(Err(failure)),
        }
    }

    /// Iterates from x = 0 until the residual is `wanted` of b, and returns own entries of the solution, its relative
    /// residual, and the number of products. Levels that turn out to lack the contact follow it in between.
    fn iterate(&mut self, tangent: &Tangent, b: &[f64], wanted: f64) -> Result<Found, SolveError> {
        let jump = self.jump(tangent);
        let mut found = Found { x: vec![0.0; b.len()], left: 1.0, products: 0, has_energy: tangent.is_symmetric() };
        let whole = self.running(jump.as_ref()).weight(b)?;
        let share = (self.shared.rows.all() / self.shared.session.size()).max(1);
        let most = (NUMBERS / share).clamp(PRODUCTS[0], PRODUCTS[1]);
        for _ in 0..LOOKS {
            let is_behind = self.levels.as_ref().is_some_and(|levels| levels.newer.is_some());
            let patience = self.levels.as_ref().and_then(Levels::patience).filter(|_| is_behind);
            let before = found;
            found = self.look(jump.as_ref(), (b, whole, wanted), (&before, patience.unwrap_or(most)))?;
            let is_reached = found.left <= NEARLY * wanted;
            if is_behind && !is_reached && self.renew_levels()? {
                continue;
            }
            // Energies that are not positive lead to another method, which begins with the next look.
            let stalls =
                (found.left > 0.5 * before.left || found.left.is_nan()) && found.has_energy == before.has_energy;
            if is_reached || stalls || self.is_slow(found.products) {
                break;
            }
        }
        self.iterations += found.products;
        if let Some(levels) = &mut self.levels {
            levels.products.get_or_insert(found.products);
        }
        Ok(found)
    }

    /// Iterates on the residual of what is found, by conjugate gradients if J is symmetric, as long as they meet no
    /// energy that is not positive, otherwise by GMRES.
    fn look(
        &self,
        jump: Option<&Jump>,
        (b, whole, wanted): (&[f64], f64, f64),
        (found, limit): (&Found, usize),
    ) -> Result<Found, SolveError> {
        let (running, has_energy) = (self.running(jump), found.has_energy);
        let (mut x, mut rest) = (found.x.clone(), b.to_vec());
        if found.products > 0 {
            running.leave(b, &x, &mut rest)?;
        }
        let goal = (wanted / found.left).min(0.1) * running.weight(&rest)?;
        let way = Way { is_symmetric: has_energy, goal, limit };
        let weighed = if has_energy { rest.clone() } else { running.weighed(&rest)? };
        running.begin(has_energy);
        let Iterated { x: change, products, has_broken } = self.krylov(&running, &weighed, way)?;
        x.iter_mut().zip(&change).for_each(|(x, change)| *x += change);
        running.leave(b, &x, &mut rest)?;
        running.settle(&rest, &mut x)?;
        running.leave(b, &x, &mut rest)?;
        let left = running.weight(&rest)? / whole;
        // Close to the solution a nonpositive energy is round-off.
        let meets_none = (running.meets_none() || has_broken) && left > wanted.sqrt();
        let has_energy = has_energy && !meets_none;
        Ok(Found { x, left, products: found.products + products, has_energy })
    }

    /// Leaves the levels for a factor if they have taken many products; true if so.
    fn is_relieved(&mut self, products: usize) -> bool {
        let is_slow = self.is_slow(products);
        if is_slow {
            (self.kind, self.levels, self.tangent) = (LevelKind::Factor, None, None);
        }
        is_slow
    }

    fn is_slow(&self, products: usize) -> bool {
        self.kind == LevelKind::Levels && products > MANY && self.shared.rows.all() <= MIDDLE
    }
}

/// Declares the rigid motions of the body to the levels.
fn with_modes(matrix: &mut Matrix, kept: &KeptMatrix, rows: &Rows) -> Result<(), crate::sys::Failure> {
    let ((all, count), n) = (kept.modes(), rows.size);
    let of_mode = |k: usize| {
        let of_node = move |node: u32| (0..n).map(move |c| (node as usize * n + c) * count + k);
        rows.own.iter().copied().flat_map(of_node)
    };
    let own: Vec<f64> = (0..count).flat_map(of_mode).map(|at| all[at]).collect();
    matrix.modes(count, &own)
}

impl Condensed for Distributed {
    fn scale(&self) -> &[f64] {
        self.shared.kept.scale()
    }

    fn apply(&self, x: &[f64]) -> Result<Vec<f64>, SolveError> {
        let session = &self.shared.session;
        let _held = session.hold();
        session.agree(Step::Product, mark(&[x]))?;
        let own = self.shared.own(x);
        let mut y = vec![0.0; own.len()];
        self.running(None).apply(&own, &mut y)?;
        self.shared.whole(&y)
    }

    fn magnitude(&self, x: &[f64]) -> Result<f64, SolveError> {
        let Shared { session, kept, rows, .. } = &*self.shared;
        let _held = session.hold();
        session.agree(Step::Product, mark(&[x]))?;
        let (full, n) = (kept.spread(x), rows.size);
        let mut largest = 0.0f64;
        for &node in &rows.own {
            for r in (0..n).filter(|r| kept.free()[node as usize * n + r]) {
                let of = |(j, block): (usize, &[f64])| {
                    (0..n).map(|c| (block[r * n + c] * full[j * n + c]).abs()).sum::<f64>()
                };
                largest = largest.max(kept.matrix().row(node as usize).map(of).sum());
            }
        }
        // The bits of numbers that are not negative have the order of the numbers.
        let mut bits = [largest.to_bits()];
        session.given(crate::sys::largest(&mut bits))?;
        Ok(f64::from_bits(bits[0]))
    }

    fn solve(&mut self, tangent: &Tangent, b: &mut [f64], enough: f64) -> Result<(), SolveError> {
        let shared = Arc::clone(&self.shared);
        let _held = shared.session.hold();
        shared.session.agree(Step::Solve, mark(&[b, &[enough]]))?;
        if b.iter().all(|b| *b == 0.0) {
            return Ok(());
        }
        self.prepare(tangent)?;
        let own = shared.own(b);
        let mut found = self.iterate(tangent, &own, enough)?;
        if self.is_relieved(found.products) && found.left > NEARLY * enough {
            self.prepare(tangent)?;
            found = self.iterate(tangent, &own, enough)?;
        }
        let left = found.left;
        b.copy_from_slice(&shared.whole(&found.x)?);
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
        let shared = Arc::clone(&self.shared);
        let _held = shared.session.hold();
        shared.session.agree(Step::Definite, 0)?;
        if self.is_empty() {
            return Ok(true);
        }
        // A preconditioner that contains the indefinite part of K + J would hide it: with it the product is near the
        // identity, and no energy that conjugate gradients meet is negative.
        self.prepare(&tangent.resisting())?;
        // Fractional parts of multiples of the golden ratio: no eigenvector is orthogonal to them by symmetry.
        let b: Vec<f64> = (1..=self.len()).map(|i| (i as f64 * 0.618_033_988_749_894_9).fract() - 0.5).collect();
        // What is judged is the matrix, with levels that have its contact.
        self.renew_levels()?;
        let (own, jump) = (shared.own(&b), self.jump(tangent));
        let running = self.running(jump.as_ref());
        running.begin_plain();
        let goal = SEEN * running.length(&own)?;
        let way = Way { is_symmetric: true, goal, limit: PRODUCTS[0] * LOOKS };
        let Iterated { products: made, has_broken, .. } = self.krylov(&running, &own, way)?;
        let (is_met, residual) = (running.meets_none() || has_broken, running.last() / running.length(&own)?);
        self.iterations += made;
        if is_met {
            Ok(false)
        } else if residual <= SEEN {
            Ok(true)
        } else {
            Err(SolveError::NotConverged { size: self.len(), iterations: made, residual })
        }
    }

    fn turn(&mut self, turns: &[Turn]) {
        if self.turns != turns {
            self.turns = turns.to_vec();
            self.turns_by_degree = self.shared.kept.turns_by_degree(turns);
            let rows = &self.shared.rows;
            let own = |turn: &Turn| {
                let mut own = *turn;
                for (own, dof) in own.unknowns.iter_mut().zip(turn.unknowns).take(turn.dim) {
                    *own = rows.place(dof)? as u32;
                }
                Some(own)
            };
            self.own_turns = self.turns_by_degree.iter().filter_map(own).collect();
            self.tangent = None;
        }
    }

    fn turns(&self) -> &[Turn] {
        &self.turns
    }

    fn iterations(&self) -> usize {
        self.iterations
    }
}
