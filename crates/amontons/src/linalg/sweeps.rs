//! The sweeps over a factor: subtrees of the elimination tree in parallel, panels of dense columns in sequence.
//!
//! The loops are compiled for the vector instructions of the machine; every sum has the same order on all machines and
//! with any number of threads.
#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use std::cell::Cell;

use pulp::{Arch, NullaryFnOnce};

use super::panel::{Panel, PositionRange};

thread_local! {
    /// Memory for the vectors of the sweeps that a thread begins, and work space for the panels of a task. Both are
    /// taken out while they are used: a thread that waits for another may begin a sweep of its own.
    static VECTORS: Cell<Vec<f64>> = const { Cell::new(Vec::new()) };
    static WORKSPACE: Cell<Vec<f64>> = const { Cell::new(Vec::new()) };
}

/// A subtree of the elimination tree as a task. Its vector is (own columns, ancestors in its rows).
#[derive(Debug, Default)]
pub(super) struct Task {
    pub children: Vec<Task>,
    /// First column of the whole subtree; those before the own ones are the children's.
    pub begin: usize,
    pub own: std::ops::Range<usize>,
    pub panels: Vec<Panel>,
    /// Rows below the panels.
    pub rows: Vec<PositionRange>,
    /// Positions of these ancestors in the parent's vector; for the root they are the unknowns of Γ_C.
    pub ancestors: Vec<u32>,
}

impl Task {
    /// Solves L y = r on the columns of the tree, and adds their contribution to the unknowns of Γ_C.
    pub fn forward(&self, values: &[f64], x: &mut [f64], contact: &mut [f64]) {
        self.with_vectors(|vectors| {
            self.forward_in(values, x, vectors);
            self.add_to_ancestors(vectors, contact);
        });
    }

    /// Solves Lᵀ x = y on the columns of the tree with the unknowns of Γ_C known.
    pub fn backward(&self, values: &[f64], x: &mut [f64], contact: &[f64]) {
        self.with_vectors(|vectors| self.backward_in(values, x, contact, vectors));
    }

    /// Number of columns of the subtree.
    fn columns(&self) -> usize {
        self.own.end - self.begin
    }

    /// Length of the vector of the task.
    fn length(&self) -> usize {
        self.own.len() + self.ancestors.len()
    }

    /// Length of the vectors of all tasks of the subtree: its own first, then those of the children.
    fn all_lengths(&self) -> usize {
        self.length() + self.children.iter().map(Task::all_lengths).sum::<usize>()
    }

    /// Runs `work` with the thread's memory for all vectors of the subtree.
    fn with_vectors(&self, work: impl FnOnce(&mut [f64])) {
        let (mut memory, length) = (VECTORS.take(), self.all_lengths());
        if memory.len() < length {
            memory.resize(length, 0.0);
        }
        work(&mut memory[..length]);
        VECTORS.set(memory);
    }

    /// Solves L y = r on the columns of the subtree. The contribution to the ancestors is left in its vector.
    fn forward_in(&self, values: &[f64], x: &mut [f64], vectors: &mut [f64]) {
        let (inner, own) = x.split_at_mut(self.own.start - self.begin);
        let (vector, vectors) = vectors.split_at_mut(self.length());
        side_by_side(&self.children, inner, vectors, &|child, x, vectors| child.forward_in(values, x, vectors));
        let (at_own, at_ancestors) = vector.split_at_mut(own.len());
        at_own.copy_from_slice(own);
        at_ancestors.fill(0.0);
        let mut of_children = &*vectors;
        for child in &self.children {
            child.add_to_ancestors(of_children, vector);
            of_children = &of_children[child.all_lengths()..];
        }
        self.sweep(values, vector, true);
        own.copy_from_slice(&vector[..own.len()]);
    }

    /// Adds the ancestor entries of the task's vector, the first of `vectors`, to the parent's vector.
    fn add_to_ancestors(&self, vectors: &[f64], parent: &mut [f64]) {
        for (&at, value) in self.ancestors.iter().zip(&vectors[self.own.len()..]) {
            parent[at as usize] += value;
        }
    }

    /// Solves Lᵀ x = y on the columns of the subtree with the ancestors known, in the parent's vector.
    fn backward_in(&self, values: &[f64], x: &mut [f64], parent: &[f64], vectors: &mut [f64]) {
        let (inner, own) = x.split_at_mut(self.own.start - self.begin);
        let (vector, vectors) = vectors.split_at_mut(self.length());
        let (at_own, at_ancestors) = vector.split_at_mut(own.len());
        at_own.copy_from_slice(own);
        for (entry, &at) in at_ancestors.iter_mut().zip(&self.ancestors) {
            *entry = parent[at as usize];
        }
        self.sweep(values, vector, false);
        own.copy_from_slice(&vector[..own.len()]);
        let vector = &*vector;
        side_by_side(&self.children, inner, vectors, &|child, x, vectors| {
            child.backward_in(values, x, vector, vectors);
        });
    }

    /// Sweeps over the panels of the task.
    fn sweep(&self, values: &[f64], vector: &mut [f64], is_forward: bool) {
        let mut workspace = WORKSPACE.take();
        Arch::new().dispatch(Sweep { task: self, values, vector, workspace: &mut workspace, is_forward });
        WORKSPACE.set(workspace);
    }
}

/// Applies `work` to subtrees in parallel, each with its columns of `x` and its vectors.
fn side_by_side(
    tasks: &[Task],
    x: &mut [f64],
    vectors: &mut [f64],
    work: &(impl Fn(&Task, &mut [f64], &mut [f64]) + Sync),
) {
    match tasks {
        [] => {}
        [task] => work(task, x, vectors),
        _ => {
            let (some, others) = tasks.split_at(tasks.len() / 2);
            let (x, x_of_others) = x.split_at_mut(some.iter().map(Task::columns).sum());
            let (vectors, vectors_of_others) = vectors.split_at_mut(some.iter().map(Task::all_lengths).sum());
            rayon::join(
                || side_by_side(some, x, vectors, work),
                || side_by_side(others, x_of_others, vectors_of_others, work),
            );
        }
    }
}

/// A sweep over the panels of a task, one after the other.
struct Sweep<'a> {
    task: &'a Task,
    values: &'a [f64],
    vector: &'a mut [f64],
    workspace: &'a mut Vec<f64>,
    is_forward: bool,
}

impl NullaryFnOnce for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Sweep { task: Task { panels, rows, .. }, values, vector, workspace, is_forward } = self;
        if is_forward {
            for panel in panels {
                panel.forward(panel.values_ahead(values, true), rows, vector, workspace);
            }
        } else {
            for panel in panels.iter().rev() {
                panel.backward(panel.values_ahead(values, false), rows, vector, workspace);
            }
        }
    }
}
