//! Assembly of a, of constant coefficients and of a modulus by an expression, and of other forms: cells a second, with
//! the scatter into the block matrix.
//!
//! `cargo bench -p amontons-core --bench assembly` prints a row per element, on one thread (`RAYON_NUM_THREADS=1`) or
//! on all.
#![allow(clippy::expect_used, clippy::print_stdout, reason = "a program for developers")]

use std::sync::Arc;
use std::time::Instant;

use amontons::expression::Expression;
use amontons::field::Law;
use amontons::forms::{self, Dilatation};
use amontons::linalg::Graph;
use amontons::material::{Isotropic, StressState, TensorLaw};
use amontons::mesh::{Diagonal, Elements, Mesh};
use amontons::tensor::Sym;

fn main() {
    let meshes = [
        Mesh::rectangle([1.0, 1.0], [256, 256], Diagonal::Right),
        Mesh::rectangle_of(Elements::Q1, [1.0, 1.0], [256, 256], Diagonal::Right),
        Mesh::box_([1.0; 3], [40; 3], Elements::P1),
        Mesh::box_([1.0; 3], [20; 3], Elements::P2),
        Mesh::box_([1.0; 3], [40; 3], Elements::Q1),
        Mesh::box_([1.0; 3], [16; 3], Elements::Q2),
    ];
    println!(
        "{:<20} {:>9} {:>12} {:>12} {:>12} {:>12} {:>12}   cells a second (median of 5)",
        "element", "cells", "graph", "a", "a graded", "inner_h", "m"
    );
    for mesh in meshes {
        let mesh = mesh.expect("a mesh");
        let law: Law<dyn TensorLaw> = Isotropic::elastic(mesh.dim, 2.0, 0.3, StressState::PlaneStrain).into();
        let (dim, young) = (mesh.dim, Expression::parse("2 + x*y").expect("an expression"));
        let graded = Law::<dyn TensorLaw>::in_space(&mesh.points, move |x| {
            Arc::new(Isotropic::elastic(dim, young.value(x, 0.0), 0.3, StressState::PlaneStrain))
        });
        let graph = Arc::new(Graph::of_mesh(&mesh));
        let rate = |run: &dyn Fn()| {
            let mut seconds: Vec<f64> = (0..5)
                .map(|_| {
                    let begin = Instant::now();
                    run();
                    begin.elapsed().as_secs_f64()
                })
                .collect();
            seconds.sort_by(f64::total_cmp);
            mesh.cell_count() as f64 / seconds[2]
        };
        let [a, b, h, m, g] = [
            rate(&|| drop(forms::a(&mesh, &graph, &[&law]))),
            rate(&|| drop(forms::a(&mesh, &graph, &[&graded]))),
            rate(&|| drop(forms::inner_h(&mesh, &graph))),
            rate(&|| drop(forms::m(&mesh, &graph, &[&Sym::identity(mesh.dim)], &[Dilatation::Full]))),
            rate(&|| drop(Graph::of_mesh(&mesh))),
        ];
        println!(
            "{:<20} {:>9} {g:>12.3e} {a:>12.3e} {b:>12.3e} {h:>12.3e} {m:>12.3e}",
            mesh.blocks[0].element.name,
            mesh.cell_count()
        );
    }
}
