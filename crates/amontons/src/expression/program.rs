//! The graph of an expression, and the register program that evaluates it.

use std::collections::HashMap;

use super::derivative::{Partials, partials};
use super::ops::{Op, Operands, apply, integer_power, small_integer};
use super::{Derivatives, Variable};

/// Number of points evaluated together: enough to make the decoding of an instruction negligible, few enough for the
/// registers of a typical expression to stay in the first-level cache.
const LANES: usize = 128;

/// Number of slots up to which a scalar evaluation uses the stack.
const STACK_SLOTS: usize = 64;

/// Number of points up to which evaluation point by point is faster than evaluation of a block.
const FEW_POINTS: usize = 2;

type OperandBlock = [f64; LANES];

/// Replaces a NaN by one fixed bit pattern: its sign and payload depend on the compiler, unlike all other results.
#[inline]
fn canonical(value: f64) -> f64 {
    if value.is_nan() { f64::NAN } else { value }
}

/// A node of the graph under construction; operands are earlier nodes. Operations with fewer than three operands repeat
/// the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Operation {
    Constant(u64),
    Variable(Variable),
    Apply(Op, [usize; 3]),
}

/// A handle to a node of an [`OperationGraph`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NodeId(usize);

/// The distinct operations of an expression, with constants folded.
#[derive(Debug, Default)]
pub(super) struct OperationGraph {
    nodes: Vec<Operation>,
    known: HashMap<Operation, usize>,
}

impl OperationGraph {
    pub(super) fn constant(&mut self, value: f64) -> NodeId {
        self.insert(Operation::Constant(value.to_bits()))
    }

    pub(super) fn variable(&mut self, variable: Variable) -> NodeId {
        self.insert(Operation::Variable(variable))
    }

    pub(super) fn unary(&mut self, op: Op, a: NodeId) -> NodeId {
        self.apply(op, [a, a, a])
    }

    pub(super) fn binary(&mut self, op: Op, a: NodeId, b: NodeId) -> NodeId {
        if op == Op::Power
            && let Operation::Constant(bits) = self.nodes[b.0]
            && let Some(n) = small_integer(f64::from_bits(bits))
        {
            return self.integer_power(a, n);
        }
        self.apply(op, [a, b, b])
    }

    pub(super) fn ternary(&mut self, op: Op, a: NodeId, b: NodeId, c: NodeId) -> NodeId {
        self.apply(op, [a, b, c])
    }

    fn integer_power(&mut self, base: NodeId, n: i32) -> NodeId {
        if n == 0 {
            return self.constant(1.0);
        }
        let product = integer_power(base, n.unsigned_abs(), |a, b| self.binary(Op::Multiply, a, b));
        if n < 0 {
            let one = self.constant(1.0);
            self.binary(Op::Divide, one, product)
        } else {
            product
        }
    }

    fn apply(&mut self, op: Op, operands: [NodeId; 3]) -> NodeId {
        let nodes = operands.map(|operand| operand.0);
        let constants = nodes.map(|node| match self.nodes[node] {
            Operation::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        });
        if let [Some(a), Some(b), Some(c)] = constants {
            let file = [a, b, c];
            return self.constant(apply(op, PointOperands { file: &file, operands: [0, 1, 2] }));
        }
        self.insert(Operation::Apply(op, nodes))
    }

    fn insert(&mut self, node: Operation) -> NodeId {
        NodeId(*self.known.entry(node).or_insert_with(|| {
            self.nodes.push(node);
            self.nodes.len() - 1
        }))
    }
}

/// The inputs on which the value of a node depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Dependence {
    Constant,
    Time,
    Space,
}

/// `slot := op(operands)`
#[derive(Clone, Copy, Debug)]
struct Instruction {
    op: Op,
    slot: usize,
    operands: [usize; 3],
}

/// A compiled expression.
///
/// Values are kept in numbered slots. The first ones are uniform, with one value for all points: the constants, then
/// the time and values derived from it. The others differ per point and are reused as soon as their value is no longer
/// needed.
#[derive(Clone, Debug)]
pub(super) struct Program {
    constants: Vec<f64>,
    uniform: usize,
    slots: usize,
    time: Option<usize>,
    /// The axes that are read, each with its slot.
    axes: Vec<(usize, usize)>,
    prologue: Vec<Instruction>,
    body: Vec<Instruction>,
    result: usize,
}

/// The instructions evaluated at every point. Slots are allocated as needed and reused.
fn body(
    nodes: &[Operation],
    stages: &[Dependence],
    last_use: &[Option<usize>],
    slot: &mut [usize],
    slots: &mut usize,
) -> Vec<Instruction> {
    let mut body = Vec::new();
    let mut free = Vec::new();
    for (i, node) in nodes.iter().enumerate() {
        let Operation::Apply(op, operands) = *node else {
            continue;
        };
        if stages[i] != Dependence::Space || last_use[i].is_none() {
            continue;
        }
        // The result takes its slot before the operands release theirs: an instruction never writes what it reads, so
        // the blocks can be borrowed together.
        slot[i] = free.pop().unwrap_or_else(|| {
            *slots += 1;
            *slots - 1
        });
        let [a, b, c] = operands;
        body.push(Instruction { op, slot: slot[i], operands: operands.map(|o| slot[o]) });
        for (operand, first) in [(a, true), (b, b != a), (c, c != a && c != b)] {
            if first && stages[operand] == Dependence::Space && last_use[operand] == Some(i) {
                free.push(slot[operand]);
            }
        }
    }
    body
}

impl Program {
    pub(super) fn new(graph: &OperationGraph, root: NodeId) -> Program {
        let nodes = &graph.nodes;
        let last_use = last_uses(nodes, root.0);
        let live = |node: usize| last_use[node].is_some();
        let stages = stages(nodes);

        let mut slot = vec![0; nodes.len()];
        let mut constants = Vec::new();
        for (i, node) in nodes.iter().enumerate() {
            if let Operation::Constant(bits) = node
                && live(i)
            {
                slot[i] = constants.len();
                constants.push(f64::from_bits(*bits));
            }
        }

        let mut uniform = constants.len();
        let mut time = None;
        let mut prologue = Vec::new();
        for (i, node) in nodes.iter().enumerate() {
            if stages[i] != Dependence::Time || !live(i) {
                continue;
            }
            slot[i] = uniform;
            uniform += 1;
            match *node {
                Operation::Apply(op, operands) => {
                    let operands = operands.map(|operand| slot[operand]);
                    prologue.push(Instruction { op, slot: slot[i], operands });
                }
                _ => time = Some(slot[i]),
            }
        }

        let mut slots = uniform;
        let mut axes = Vec::new();
        for (i, node) in nodes.iter().enumerate() {
            if let Operation::Variable(variable) = node
                && let Some(axis) = variable.axis()
                && live(i)
            {
                slot[i] = slots;
                axes.push((axis, slots));
                slots += 1;
            }
        }
        let body = body(nodes, &stages, &last_use, &mut slot, &mut slots);
        let result = slot[root.0];
        Program { constants, uniform, slots, time, axes, prologue, body, result }
    }

    pub(super) fn value(&self, x: &[f64; 3], t: f64) -> f64 {
        with_slots(self.slots, |file: &mut [f64]| {
            self.start(file, t);
            for &(axis, slot) in &self.axes {
                file[slot] = x[axis];
            }
            run(&self.body, file);
            canonical(file[self.result])
        })
    }

    /// The partial derivatives have their own slots, numbered as those of the values.
    pub(super) fn derivatives(&self, x: &[f64; 3], t: f64) -> Derivatives {
        with_slots(self.slots, |file: &mut [f64]| {
            with_slots(self.slots, |slopes: &mut [Partials]| {
                file[..self.constants.len()].copy_from_slice(&self.constants);
                if let Some(time) = self.time {
                    file[time] = t;
                    slopes[time][3] = 1.0;
                }
                for &(axis, slot) in &self.axes {
                    file[slot] = x[axis];
                    slopes[slot][axis] = 1.0;
                }
                for &Instruction { op, slot, operands } in self.prologue.iter().chain(&self.body) {
                    let value = apply(op, PointOperands { file, operands });
                    slopes[slot] = partials(op, operands.map(|o| file[o]), operands.map(|o| &slopes[o]), value);
                    file[slot] = value;
                }
                let value = canonical(file[self.result]);
                let [x, y, z, t] =
                    slopes[self.result].map(|slope| if value.is_nan() { value } else { canonical(slope) });
                Derivatives { value, by_x: [x, y, z], by_t: t }
            })
        })
    }

    pub(super) fn values(&self, points: &[[f64; 3]], t: f64, out: &mut [f64]) {
        if points.len() <= FEW_POINTS {
            for (point, out) in points.iter().zip(out) {
                *out = self.value(point, t);
            }
            return;
        }
        with_slots(self.uniform, |uniform: &mut [f64]| {
            self.start(uniform, t);
            if self.result < self.uniform {
                let value = canonical(uniform[self.result]);
                for (out, _) in out.iter_mut().zip(points) {
                    *out = value;
                }
            } else {
                self.blocks(points, uniform, out);
            }
        });
    }

    fn blocks(&self, points: &[[f64; 3]], uniform: &[f64], out: &mut [f64]) {
        let mut blocks: Vec<OperandBlock> = vec![[0.0; LANES]; self.slots - self.uniform];
        for (points, out) in points.chunks(LANES).zip(out.chunks_mut(LANES)) {
            for &(axis, slot) in &self.axes {
                for (lane, point) in blocks[slot - self.uniform].iter_mut().zip(points) {
                    *lane = point[axis];
                }
            }
            for &Instruction { op, slot, operands } in &self.body {
                let (before, rest) = blocks.split_at_mut(slot - self.uniform);
                let Some((result, after)) = rest.split_first_mut() else {
                    continue;
                };
                let result = &mut result[..points.len()];
                apply(op, BlockOperands { uniform, before, after, operands, result });
            }
            for (out, &value) in out.iter_mut().zip(&blocks[self.result - self.uniform]) {
                *out = canonical(value);
            }
        }
    }

    /// Fills the uniform slots.
    fn start(&self, file: &mut [f64], t: f64) {
        file[..self.constants.len()].copy_from_slice(&self.constants);
        if let Some(time) = self.time {
            file[time] = t;
        }
        run(&self.prologue, file);
    }
}

/// Runs `run` with `count` slots, on the stack if they are few.
fn with_slots<S: Copy + Default + Send + 'static, T>(count: usize, run: impl FnOnce(&mut [S]) -> T) -> T {
    if count <= STACK_SLOTS {
        run(&mut [S::default(); STACK_SLOTS][..count])
    } else {
        run(&mut vec![S::default(); count])
    }
}

fn run(instructions: &[Instruction], file: &mut [f64]) {
    for &Instruction { op, slot, operands } in instructions {
        file[slot] = apply(op, PointOperands { file, operands });
    }
}

/// For every node the last node that reads it; `None` if the root does not depend on it.
fn last_uses(nodes: &[Operation], root: usize) -> Vec<Option<usize>> {
    let mut last_use = vec![None; nodes.len()];
    last_use[root] = Some(nodes.len());
    for (i, node) in nodes.iter().enumerate().rev() {
        if let Operation::Apply(_, operands) = node
            && last_use[i].is_some()
        {
            for &operand in operands {
                last_use[operand] = last_use[operand].max(Some(i));
            }
        }
    }
    last_use
}

fn stages(nodes: &[Operation]) -> Vec<Dependence> {
    let mut stages = Vec::with_capacity(nodes.len());
    for node in nodes {
        stages.push(match node {
            Operation::Constant(_) => Dependence::Constant,
            Operation::Variable(Variable::T) => Dependence::Time,
            Operation::Variable(_) => Dependence::Space,
            Operation::Apply(_, [a, b, c]) => {
                let [a, b, c]: [Dependence; 3] = [stages[*a], stages[*b], stages[*c]];
                a.max(b).max(c)
            }
        });
    }
    stages
}

/// Operands at one point.
struct PointOperands<'a> {
    file: &'a [f64],
    operands: [usize; 3],
}

impl Operands for PointOperands<'_> {
    type Output = f64;

    #[inline]
    fn unary(self, function: impl Fn(f64) -> f64) -> f64 {
        function(self.file[self.operands[0]])
    }

    #[inline]
    fn binary(self, function: impl Fn(f64, f64) -> f64) -> f64 {
        let [a, b, _] = self.operands;
        function(self.file[a], self.file[b])
    }

    #[inline]
    fn ternary(self, function: impl Fn(f64, f64, f64) -> f64) -> f64 {
        let [a, b, c] = self.operands;
        function(self.file[a], self.file[b], self.file[c])
    }
}

/// Operands at a block of points; the length of `result` is their number.
struct BlockOperands<'a> {
    uniform: &'a [f64],
    before: &'a [OperandBlock],
    after: &'a [OperandBlock],
    operands: [usize; 3],
    result: &'a mut [f64],
}

enum Operand<'a> {
    Uniform(f64),
    Lanes(&'a OperandBlock),
}

impl<'a> BlockOperands<'a> {
    #[inline]
    fn source(&self, operand: usize) -> Operand<'a> {
        let slot = self.operands[operand];
        let Some(block) = slot.checked_sub(self.uniform.len()) else {
            return Operand::Uniform(self.uniform[slot]);
        };
        Operand::Lanes(match block.checked_sub(self.before.len() + 1) {
            Some(block) => &self.after[block],
            None => &self.before[block],
        })
    }

    /// The operand as a block, for operations too rare to have a loop per kind of operand.
    fn block(&self, operand: usize) -> OperandBlock {
        match self.source(operand) {
            Operand::Uniform(value) => [value; LANES],
            Operand::Lanes(lanes) => *lanes,
        }
    }
}

impl Operands for BlockOperands<'_> {
    type Output = ();

    #[inline]
    fn unary(self, function: impl Fn(f64) -> f64) {
        match self.source(0) {
            Operand::Uniform(a) => self.result.fill(function(a)),
            Operand::Lanes(a) => {
                for (result, &a) in self.result.iter_mut().zip(a) {
                    *result = function(a);
                }
            }
        }
    }

    #[inline]
    fn binary(self, function: impl Fn(f64, f64) -> f64) {
        match (self.source(0), self.source(1)) {
            (Operand::Lanes(a), Operand::Lanes(b)) => {
                for ((result, &a), &b) in self.result.iter_mut().zip(a).zip(b) {
                    *result = function(a, b);
                }
            }
            (Operand::Lanes(a), Operand::Uniform(b)) => {
                for (result, &a) in self.result.iter_mut().zip(a) {
                    *result = function(a, b);
                }
            }
            (Operand::Uniform(a), Operand::Lanes(b)) => {
                for (result, &b) in self.result.iter_mut().zip(b) {
                    *result = function(a, b);
                }
            }
            (Operand::Uniform(a), Operand::Uniform(b)) => self.result.fill(function(a, b)),
        }
    }

    #[inline]
    fn ternary(self, function: impl Fn(f64, f64, f64) -> f64) {
        let (a, b, c) = (self.block(0), self.block(1), self.block(2));
        for (((result, &a), &b), &c) in self.result.iter_mut().zip(&a).zip(&b).zip(&c) {
            *result = function(a, b, c);
        }
    }
}
