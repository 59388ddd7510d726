//! The bound of the discretization error beside the run of one step.
//!
//! `cargo bench -p amontons-core --bench bound` prints the seconds of a step with its factorization, of the first bound
//! and of a further one, for plane and cubic blocks on a rigid foundation. "Moved" are meshes of which no two cells are
//! alike. Arguments after `--`: cells per edge in the plane, cells per edge in space, and a part of the name of the
//! bodies that are measured.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a program for developers")]

use std::sync::Arc;
use std::time::Instant;

use amontons::case::{self, Source};
use amontons::discretization::Discretization;
use amontons::majorant::Majorant;
use amontons::mesh::Mesh;
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{Settings, run};

/// Computes, and returns the result with the seconds it took.
fn timed<T>(compute: impl FnOnce() -> T) -> (T, f64) {
    let begin = Instant::now();
    let result = compute();
    (result, begin.elapsed().as_secs_f64())
}

/// A block that is pressed onto a rigid foundation by a load, as the text of a case.
fn block(mesh: &str, axes: usize, elements: &str) -> String {
    let (state, bottom) = if axes == 2 { (", stress_state = \"plane-strain\"", "bottom") } else { ("", "bottom") };
    let load = ["0.02", "-0.3", "0.01"][..axes].join(", ");
    let held = ["0", "-0.01", "0"][..axes].join(", ");
    format!(
        "name = \"block\"\nunits = \"dimensionless\"\n[mesh]\n{mesh}\nelements = \"{elements}\"\n[time]\nend = 1.0\n\
         steps = 1\n[material]\ndensity = 0.0\n\
         elasticity = {{ law = \"isotropic\", young = 1.0, poisson = 0.3{state} }}\n[[boundary]]\non = \"top\"\n\
         displacement = [{held}]\n[load]\nbody_force = [{load}]\n[contact]\non = \"{bottom}\"\n\
         normal = {{ law = \"signorini\" }}\n"
    )
}

/// The mesh with its inner nodes moved by up to a fifth of a cell: no two cells are alike.
fn moved(mut mesh: Mesh, cell: f64) -> Mesh {
    let low: [f64; 3] = std::array::from_fn(|c| mesh.points.iter().map(|p| p[c]).fold(f64::INFINITY, f64::min));
    let high: [f64; 3] = std::array::from_fn(|c| mesh.points.iter().map(|p| p[c]).fold(f64::NEG_INFINITY, f64::max));
    for (n, p) in mesh.points.iter_mut().enumerate() {
        let is_inner = |c: usize| (p[c] - low[c]) * (high[c] - p[c]) > 1e-9 * cell * cell;
        if (0..mesh.dim).all(is_inner) {
            for (c, x) in p.iter_mut().enumerate().take(mesh.dim) {
                *x += 0.2 * cell * (7.1 * n as f64 + 2.3 * c as f64).sin();
            }
        }
    }
    mesh
}

/// The mesh with layers of other thicknesses along each axis: the cells stay boxes, and no two of them are alike.
fn graded(mut mesh: Mesh) -> Mesh {
    for p in &mut mesh.points {
        p.iter_mut().zip([1.3, 1.5, 1.7]).for_each(|(x, power)| *x = x.powf(power));
    }
    mesh
}

fn measure(name: &str, problem: &Problem) {
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    let (_, step) = timed(|| run(problem, &settings, &mut [&mut memory]).expect("a run"));
    let discrete = Discretization::new(problem);
    let last = (memory.states.last().expect("a state"), memory.reports.last().expect("a report"));
    let mut majorant = None;
    let (found, first) = timed(|| {
        let made = majorant.insert(Majorant::new(problem, &discrete).expect("bounds"));
        made.at(problem, &discrete, last).expect("a bound")
    });
    let majorant = majorant.as_mut().expect("bounds");
    let (_, further) = timed(|| majorant.at(problem, &discrete, last).expect("a bound"));
    println!(
        "{name:<24} {:>7} nodes   step {step:.3} s   first bound {first:.3} s   further {further:.3} s   {:.3} %",
        problem.mesh.points.len(),
        100.0 * found.relative()
    );
}

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|a| a.parse::<usize>().ok());
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-') && a.parse::<usize>().is_err());
    let (plane, space) = (numbers.next().unwrap_or(80), numbers.next().unwrap_or(12));
    let bodies = [
        (2, "P1", false),
        (2, "P1", true),
        (2, "P2", false),
        (2, "Q1", false),
        (2, "Q2", false),
        (3, "P1", false),
        (3, "P1", true),
        (3, "P2", false),
        (3, "Q1", false),
        (3, "Q1", true),
        (3, "Q2", false),
        (3, "Q2", true),
    ];
    for (axes, elements, is_moved) in bodies {
        let (name, after) = (["plane", "space"][axes - 2], if is_moved { ", moved" } else { "" });
        let name = format!("{name}, {elements}{after}");
        if only.as_ref().is_some_and(|only| !name.contains(only)) {
            continue;
        }
        let n = match (axes, elements) {
            (2, _) => plane,
            (_, "P2" | "Q2") => space / 2,
            _ => space,
        };
        let mesh = if axes == 2 {
            format!("kind = \"rectangle\"\nsize = [2.0, 1.0]\nn = [{}, {n}]", 2 * n)
        } else {
            format!("kind = \"box\"\nsize = [1.0, 1.0, 1.0]\nn = [{n}, {n}, {n}]")
        };
        let source = Source::new("block.toml", block(&mesh, axes, elements));
        let mut problem = case::parse(&source, &[]).expect("a case").problem;
        if is_moved {
            let mesh = (*problem.mesh).clone();
            let mesh = if (axes, &elements[..1]) == (3, "Q") { graded(mesh) } else { moved(mesh, 1.0 / n as f64) };
            problem = problem.with(|data| data.mesh = Arc::new(mesh)).expect("a problem");
        }
        measure(&name, &problem);
    }
}
