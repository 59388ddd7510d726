//! The sweeps over a factor: subtrees of the elimination tree side by side, panels of dense columns in turn.
//!
//! The loops are compiled for the vector instructions of the machine; every sum has the same order on all machines and
//! with any number of threads.
#![allow(clippy::inline_always, reason = "a loop is compiled for the vector instructions of the function it is in")]

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use super::batches::{Batch, Workspace, batches};
use super::panel::{Panel, Run};

/// A subtree of the elimination tree. Its vector is (own columns, ancestors that it touches).
#[derive(Debug, Default)]
pub(super) struct Task {
    pub children: Vec<Task>,
    /// Columns of the whole subtree that precede the own ones are the children's.
    pub begin: usize,
    pub own: std::ops::Range<usize>,
    pub panels: Vec<Panel>,
    /// The rows below the panels.
    pub rows: Vec<Run>,
    /// Subtrees below the panels.
    pub batches: Vec<Batch>,
    /// Positions in the parent's vector of the ancestors touched.
    pub ancestors: Vec<u32>,
    /// How many ancestors are touched.
    pub touched: usize,
}

impl Task {
    /// Puts subtrees that repeat side by side.
    pub fn batch(&mut self) {
        self.children.par_iter_mut().for_each(Task::batch);
        if self.children.is_empty() {
            self.batches = batches(&mut self.panels, &mut self.rows, self.own.len());
        }
    }

    /// Solves L y = r on the columns of the subtree; returns what is added to the ancestors.
    pub fn forward(&self, values: &[f64], x: &mut [f64]) -> Vec<f64> {
        let (mut inner, own) = x.split_at_mut(self.own.start - self.begin);
        let mut slices = Vec::with_capacity(self.children.len());
        for child in &self.children {
            let (slice, rest) = inner.split_at_mut(child.own.end - child.begin);
            slices.push((child, slice));
            inner = rest;
        }
        let updates: Vec<Vec<f64>> =
            slices.into_par_iter().map(|(child, slice)| child.forward(values, slice)).collect();
        let width = self.own.len();
        let mut vector = vec![0.0; width + self.touched];
        vector[..width].copy_from_slice(own);
        for (child, update) in self.children.iter().zip(&updates) {
            for (&at, &value) in child.ancestors.iter().zip(update) {
                vector[at as usize] += value;
            }
        }
        Arch::new().dispatch(Sweep { task: self, values, vector: &mut vector, is_forward: true });
        own.copy_from_slice(&vector[..width]);
        vector.split_off(width)
    }

    /// Solves Lᵀ x = y on the columns of the subtree with the ancestors known.
    pub fn backward(&self, values: &[f64], x: &mut [f64], ancestors: &[f64]) {
        let (mut inner, own) = x.split_at_mut(self.own.start - self.begin);
        let width = self.own.len();
        let mut vector = Vec::with_capacity(width + ancestors.len());
        vector.extend_from_slice(own);
        vector.extend_from_slice(ancestors);
        Arch::new().dispatch(Sweep { task: self, values, vector: &mut vector, is_forward: false });
        own.copy_from_slice(&vector[..width]);
        let mut slices = Vec::with_capacity(self.children.len());
        for child in &self.children {
            let (slice, rest) = inner.split_at_mut(child.own.end - child.begin);
            slices.push((child, slice));
            inner = rest;
        }
        let vector = &vector;
        slices.into_par_iter().for_each(|(child, slice)| {
            let known: Vec<f64> = child.ancestors.iter().map(|&at| vector[at as usize]).collect();
            child.backward(values, slice, &known);
        });
    }
}

/// A sweep over the panels of a task in turn.
struct Sweep<'a> {
    task: &'a Task,
    values: &'a [f64],
    vector: &'a mut [f64],
    is_forward: bool,
}

impl NullaryFnOnce for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Sweep { task: Task { panels, rows, batches, .. }, values, vector, is_forward } = self;
        let (mut workspace, mut dense) = (Workspace::default(), Vec::new());
        if is_forward {
            for batch in batches {
                batch.forward(values, vector, &mut workspace);
            }
            for panel in panels {
                panel.forward(panel.values_ahead(values, true), rows, vector, &mut dense);
            }
        } else {
            for panel in panels.iter().rev() {
                panel.backward(panel.values_ahead(values, false), rows, vector, &mut dense);
            }
            for batch in batches {
                batch.backward(values, vector, &mut workspace);
            }
        }
    }
}
