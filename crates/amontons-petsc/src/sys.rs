//! The C part of this crate, `shim.c`, behind safe types. All `unsafe` code of the crate is here.
//!
//! Calls are collective: all processes make them in the same order. Each type owns an object of the C part and frees it
//! when it is dropped. The C part is used by one thread at a time: [`crate::session::Session`] sees to that.
#![allow(unsafe_code, reason = "calls of C")]

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{self, NonNull};

use amontons::linalg::SolveError;

#[repr(C)]
struct RawMatrix {
    _private: [u8; 0],
}

#[repr(C)]
struct RawSolver {
    _private: [u8; 0],
}

type Operator = extern "C" fn(*mut c_void, *const f64, *mut f64) -> c_int;

#[repr(C)]
struct Callbacks {
    context: *mut c_void,
    product: Operator,
    precondition: Operator,
    norm: Operator,
    goes_on: extern "C" fn(*mut c_void) -> c_int,
    goal: f64,
    limit: c_int,
    is_symmetric: c_int,
}

// SAFETY: as declared in `shim.h`.
unsafe extern "C" {
    fn am_start(rank: *mut c_int, size: *mut c_int) -> c_int;
    fn am_finish() -> c_int;
    fn am_abort(code: c_int);
    fn am_mute();
    fn am_unmute();
    fn am_say(text: *const c_char);
    fn am_error() -> *const c_char;
    fn am_largest(values: *mut u64, count: c_int) -> c_int;
    fn am_share(bytes: *mut c_void, count: c_int) -> c_int;
    fn am_sum(values: *mut f64, count: c_int) -> c_int;
    fn am_gather(own: *const f64, count: c_int, all: *mut f64, counts: *const c_int, starts: *const c_int) -> c_int;
    fn am_matrix_new(
        nodes: c_int,
        size: c_int,
        kind: c_int,
        inside: *const c_int,
        outside: *const c_int,
        out: *mut *mut RawMatrix,
    ) -> c_int;
    fn am_matrix_clear(matrix: *mut RawMatrix) -> c_int;
    fn am_matrix_add(
        matrix: *mut RawMatrix,
        node: c_int,
        count: c_int,
        nodes: *const c_int,
        blocks: *const f64,
    ) -> c_int;
    fn am_matrix_ready(matrix: *mut RawMatrix) -> c_int;
    fn am_matrix_product(matrix: *mut RawMatrix, x: *const f64, y: *mut f64) -> c_int;
    fn am_matrix_modes(matrix: *mut RawMatrix, count: c_int, modes: *const f64) -> c_int;
    fn am_matrix_free(matrix: *mut RawMatrix);
    fn am_solver_new(rows: c_int, out: *mut *mut RawSolver) -> c_int;
    fn am_levels(solver: *mut RawSolver, matrix: *mut RawMatrix, kind: c_int) -> c_int;
    fn am_cycle(solver: *mut RawSolver, r: *const f64, x: *mut f64) -> c_int;
    fn am_solve(
        solver: *mut RawSolver,
        callbacks: *const Callbacks,
        b: *const f64,
        x: *mut f64,
        made: *mut c_int,
    ) -> c_int;
    fn am_solver_free(solver: *mut RawSolver);
}

/// What PETSc or MPI says of a call that failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure(pub String);

/// The result of a call from its code.
fn done(code: c_int) -> Result<(), Failure> {
    if code == 0 {
        return Ok(());
    }
    // SAFETY: am_error returns a text that ends with 0 and lives as long as the program.
    let message = unsafe { CStr::from_ptr(am_error()) };
    Err(Failure(message.to_string_lossy().into_owned()))
}

/// Starts MPI and PETSc; returns the number of this process and that of all.
pub fn start() -> Result<(usize, usize), Failure> {
    let (mut rank, mut size) = (0, 1);
    // SAFETY: both are places for a number.
    done(unsafe { am_start(&raw mut rank, &raw mut size) })?;
    Ok((rank as usize, size as usize))
}

/// Ends MPI and PETSc.
pub fn finish() -> Result<(), Failure> {
    // SAFETY: no arguments.
    done(unsafe { am_finish() })
}

/// Ends all processes with an exit code.
pub fn abort(code: u8) -> ! {
    // SAFETY: a plain number.
    unsafe { am_abort(c_int::from(code)) };
    std::process::exit(i32::from(code))
}

/// Leads standard output of this process nowhere, and standard error to memory.
pub fn mute() {
    // SAFETY: no arguments.
    unsafe { am_mute() };
}

/// Writes to standard error what was written there while it was muted.
pub fn unmute() {
    // SAFETY: no arguments.
    unsafe { am_unmute() };
}

/// Writes a text to standard error, muted or not.
pub fn say(text: &str) {
    let Ok(text) = CString::new(text) else { return };
    // SAFETY: the text ends with 0.
    unsafe { am_say(text.as_ptr()) };
}

/// The largest of the values of all processes, each by itself.
pub fn largest(values: &mut [u64]) -> Result<(), Failure> {
    // SAFETY: the count is that of the values.
    done(unsafe { am_largest(values.as_mut_ptr(), values.len() as c_int) })
}

/// The bytes of the first process; all pass as many.
pub fn share(bytes: &mut [u8]) -> Result<(), Failure> {
    // SAFETY: the count is that of the bytes.
    done(unsafe { am_share(bytes.as_mut_ptr().cast(), bytes.len() as c_int) })
}

/// Sums of the values of all processes, each by itself.
pub fn sum(values: &mut [f64]) -> Result<(), Failure> {
    // SAFETY: the count is that of the values.
    done(unsafe { am_sum(values.as_mut_ptr(), values.len() as c_int) })
}

/// The values of all processes, one after the other: `counts` has their numbers per process, and `starts` their places.
pub fn gather(own: &[f64], counts: &[i32], starts: &[i32]) -> Result<Vec<f64>, Failure> {
    let mut all = vec![0.0; counts.iter().map(|count| *count as usize).sum()];
    // SAFETY: `all` has room for the values of all processes; counts and starts have one number per process.
    done(unsafe { am_gather(own.as_ptr(), own.len() as c_int, all.as_mut_ptr(), counts.as_ptr(), starts.as_ptr()) })?;
    Ok(all)
}

/// A matrix whose rows are distributed, in blocks of size × size per pair of nodes.
#[derive(Debug)]
pub struct Matrix {
    raw: NonNull<RawMatrix>,
    nodes: usize,
    size: usize,
}

// SAFETY: the C part is used by one thread at a time, whichever that is.
unsafe impl Send for Matrix {}
// SAFETY: calls with a shared matrix are made by one thread at a time.
unsafe impl Sync for Matrix {}

impl Matrix {
    /// A matrix for a preconditioner, or else for products, with these numbers of blocks per own node among the own
    /// columns and among those of other processes.
    pub fn new(size: usize, kind: Option<LevelKind>, [inside, outside]: [&[i32]; 2]) -> Result<Matrix, Failure> {
        let mut raw = ptr::null_mut();
        let (nodes, kind) = (inside.len(), kind.map_or(-1, |kind| kind as c_int));
        // SAFETY: both lists have one number per own node.
        let code = unsafe {
            am_matrix_new(nodes as c_int, size as c_int, kind, inside.as_ptr(), outside.as_ptr(), &raw mut raw)
        };
        let made = NonNull::new(raw).map(|raw| Matrix { raw, nodes, size });
        done(code)?;
        made.ok_or_else(|| Failure("no memory for a matrix".to_owned()))
    }

    /// Sets all entries to zero and keeps their places.
    pub fn clear(&mut self) -> Result<(), Failure> {
        // SAFETY: the matrix is alive.
        done(unsafe { am_matrix_clear(self.raw.as_ptr()) })
    }

    /// Adds blocks to the row of an own node: `blocks` has the first rows of all of them, then the second rows.
    pub fn add(&mut self, node: usize, nodes: &[i32], blocks: &[f64]) -> Result<(), Failure> {
        if node >= self.nodes || blocks.len() != nodes.len() * self.size * self.size {
            return Err(Failure("a row of a matrix does not fit it".to_owned()));
        }
        // SAFETY: the row is that of an own node, and there are as many blocks as columns.
        done(unsafe {
            am_matrix_add(self.raw.as_ptr(), node as c_int, nodes.len() as c_int, nodes.as_ptr(), blocks.as_ptr())
        })
    }

    /// Makes the matrix ready for use once all blocks are added.
    pub fn ready(&mut self) -> Result<(), Failure> {
        // SAFETY: the matrix is alive.
        done(unsafe { am_matrix_ready(self.raw.as_ptr()) })
    }

    /// Own entries of the product with a vector, given by its own entries.
    pub fn product(&self, x: &[f64], y: &mut [f64]) -> Result<(), Failure> {
        self.fits(x, y)?;
        // SAFETY: both vectors have the own rows.
        done(unsafe { am_matrix_product(self.raw.as_ptr(), x.as_ptr(), y.as_mut_ptr()) })
    }

    /// Declares motions of nearly zero energy, the own entries of one after those of the other.
    pub fn modes(&mut self, count: usize, modes: &[f64]) -> Result<(), Failure> {
        if modes.len() != count * self.nodes * self.size {
            return Err(Failure("modes that do not fit the matrix".to_owned()));
        }
        // SAFETY: every mode has the own rows.
        done(unsafe { am_matrix_modes(self.raw.as_ptr(), count as c_int, modes.as_ptr()) })
    }

    fn fits(&self, x: &[f64], y: &[f64]) -> Result<(), Failure> {
        let rows = self.nodes * self.size;
        let fits = x.len() == rows && y.len() == rows;
        if fits { Ok(()) } else { Err(Failure("vectors that do not fit the matrix".to_owned())) }
    }
}

impl Drop for Matrix {
    fn drop(&mut self) {
        // SAFETY: the matrix is alive and not used afterwards.
        unsafe { am_matrix_free(self.raw.as_ptr()) };
    }
}

/// What a Krylov method needs; vectors have the own rows.
pub trait Operators {
    /// The operator times a vector.
    fn product(&self, x: &[f64], y: &mut [f64]) -> Result<(), SolveError>;
    /// An approximate solution.
    fn precondition(&self, r: &[f64], x: &mut [f64]) -> Result<(), SolveError>;
    /// Norm of a residual of conjugate gradients.
    fn norm(&self, r: &[f64]) -> Result<f64, SolveError>;
    /// True if the iteration is to go on.
    fn goes_on(&self) -> Result<bool, SolveError>;
}

/// How far and in which way an iteration goes.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// True for conjugate gradients, false for flexible GMRES.
    pub is_symmetric: bool,
    /// Norm of the residual at which the iteration ends.
    pub goal: f64,
    /// Number of products at most.
    pub limit: usize,
}

/// The preconditioner that is made of a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LevelKind {
    /// Smoothed aggregation.
    Levels = 0,
    /// A factor that every process has.
    Copies = 1,
    /// A distributed factor.
    Factor = 2,
}

/// How an iteration ended.
#[derive(Clone, Debug, Default)]
pub struct Iterated {
    /// Own entries of the solution found.
    pub x: Vec<f64>,
    /// Number of products.
    pub products: usize,
    /// True if it broke down, as conjugate gradients do with a matrix that is not definite.
    pub has_broken: bool,
}

/// `AM_FAILED` of `shim.h`.
const BROKEN: c_int = 3;

/// Krylov methods of PETSc with the levels of a multigrid method.
#[derive(Debug)]
pub struct Solver {
    raw: NonNull<RawSolver>,
    rows: usize,
}

// SAFETY: the C part is used by one thread at a time, whichever that is.
unsafe impl Send for Solver {}
// SAFETY: calls with a shared solver are made by one thread at a time.
unsafe impl Sync for Solver {}

/// The context of the callbacks of one call of `am_solve`.
struct Call<'a> {
    operators: &'a dyn Operators,
    rows: usize,
    /// Error of a callback, which ends the iteration.
    error: RefCell<Option<SolveError>>,
}

impl Call<'_> {
    /// The code of a result, whose error is kept.
    fn code(&self, result: Result<(), SolveError>) -> c_int {
        let Err(error) = result else { return 0 };
        self.error.borrow_mut().get_or_insert(error);
        1
    }
}

/// The context that [`Solver::solve`] has passed.
///
/// # Safety
/// `context` must be the context of the present call of `am_solve`, which outlives the callbacks.
unsafe fn call<'a>(context: *mut c_void) -> &'a Call<'a> {
    // SAFETY: see above.
    unsafe { &*context.cast::<Call<'a>>() }
}

extern "C" fn product(context: *mut c_void, x: *const f64, y: *mut f64) -> c_int {
    // SAFETY: the C part passes the context, and vectors of own rows that do not overlap.
    let (call, x, y) = unsafe { parts(context, x, y) };
    call.code(call.operators.product(x, y))
}

extern "C" fn precondition(context: *mut c_void, r: *const f64, x: *mut f64) -> c_int {
    // SAFETY: as for products.
    let (call, r, x) = unsafe { parts(context, r, x) };
    call.code(call.operators.precondition(r, x))
}

extern "C" fn norm(context: *mut c_void, r: *const f64, out: *mut f64) -> c_int {
    // SAFETY: the C part passes the context, a vector of own rows, and the place of a number.
    let (call, r, out) = unsafe {
        let call = call(context);
        (call, slice(r, call.rows), &mut *out)
    };
    call.code(call.operators.norm(r).map(|norm| *out = norm))
}

extern "C" fn goes_on(context: *mut c_void) -> c_int {
    // SAFETY: the C part passes the context.
    let call = unsafe { call(context) };
    match call.operators.goes_on() {
        Ok(goes_on) => c_int::from(goes_on),
        Err(error) => {
            call.code(Err(error));
            0
        }
    }
}

/// A vector of own rows, which may be empty.
///
/// # Safety
/// As [`std::slice::from_raw_parts`], if there is a row.
unsafe fn slice<'a>(x: *const f64, rows: usize) -> &'a [f64] {
    // SAFETY: see above.
    if rows == 0 { &[] } else { unsafe { std::slice::from_raw_parts(x, rows) } }
}

/// Context and vectors of an operator.
///
/// # Safety
/// As [`call`] and [`slice`]; the second vector overlaps nothing.
unsafe fn parts<'a>(context: *mut c_void, x: *const f64, y: *mut f64) -> (&'a Call<'a>, &'a [f64], &'a mut [f64]) {
    // SAFETY: see above.
    unsafe {
        let call = call(context);
        let y: &mut [f64] = if call.rows == 0 { &mut [] } else { std::slice::from_raw_parts_mut(y, call.rows) };
        (call, slice(x, call.rows), y)
    }
}

impl Solver {
    /// A solver of so many own rows.
    pub fn new(rows: usize) -> Result<Solver, Failure> {
        let mut raw = ptr::null_mut();
        // SAFETY: the place of a pointer.
        let code = unsafe { am_solver_new(rows as c_int, &raw mut raw) };
        let made = NonNull::new(raw).map(|raw| Solver { raw, rows });
        done(code)?;
        made.ok_or_else(|| Failure("no memory for a solver".to_owned()))
    }

    /// Makes the preconditioner from a matrix. The same matrix with other entries keeps its interpolations.
    pub fn levels(&mut self, matrix: &Matrix, kind: LevelKind) -> Result<(), Failure> {
        // SAFETY: both are alive; PETSc counts the references to the matrix.
        done(unsafe { am_levels(self.raw.as_ptr(), matrix.raw.as_ptr(), kind as c_int) })
    }

    /// An approximate solution by the levels.
    pub fn cycle(&self, r: &[f64], x: &mut [f64]) -> Result<(), Failure> {
        if r.len() != self.rows || x.len() != self.rows {
            return Err(Failure("vectors that do not fit the solver".to_owned()));
        }
        // SAFETY: both vectors have the own rows.
        done(unsafe { am_cycle(self.raw.as_ptr(), r.as_ptr(), x.as_mut_ptr()) })
    }

    /// Iterates from zero.
    pub fn solve(&self, operators: &dyn Operators, b: &[f64], way: Way) -> Result<Iterated, Broken> {
        if b.len() != self.rows {
            return Err(Broken::Library(Failure("a vector that does not fit the solver".to_owned())));
        }
        let call = Call { operators, rows: self.rows, error: RefCell::new(None) };
        let callbacks = Callbacks {
            context: ptr::from_ref(&call).cast_mut().cast(),
            product,
            precondition,
            norm,
            goes_on,
            goal: way.goal,
            limit: way.limit as c_int,
            is_symmetric: c_int::from(way.is_symmetric),
        };
        let (mut x, mut made) = (vec![0.0; self.rows], 0);
        // SAFETY: both vectors have the own rows, and the callbacks with their context live until the call returns.
        let ended =
            unsafe { am_solve(self.raw.as_ptr(), &raw const callbacks, b.as_ptr(), x.as_mut_ptr(), &raw mut made) };
        if let Some(error) = call.error.into_inner() {
            return Err(Broken::Program(error));
        }
        if ended < 0 {
            done(ended).map_err(Broken::Library)?;
        }
        Ok(Iterated { x, products: made as usize, has_broken: ended == BROKEN })
    }
}

impl Drop for Solver {
    fn drop(&mut self) {
        // SAFETY: the solver is alive and not used afterwards.
        unsafe { am_solver_free(self.raw.as_ptr()) };
    }
}

/// Reason why an iteration broke off.
#[derive(Clone, Debug)]
pub enum Broken {
    /// A call of PETSc failed.
    Library(Failure),
    /// A callback failed.
    Program(SolveError),
}
