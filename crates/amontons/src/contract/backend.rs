//! The contract of backends of linear systems.

use std::sync::Arc;

use super::{near, samples};
use crate::forms;
use crate::linalg::{Backend, BlockMatrix, EXACT, Graph, Layout, Share, SolveError, System, Tangent, Turn};
use crate::material::{Isotropic, StressState};
use crate::mesh::{Diagonal, Mesh};

/// The slopes of the laws of points that stick, that slide under pressure, and that are open, in turn.
fn slope_of(i: usize) -> [[f64; 3]; 3] {
    match i % 3 {
        0 => [[1e8, 0.0, 0.0], [0.0, 1e8, 0.0], [0.0; 3]],
        1 => [[0.0, 12.0, 0.0], [0.0, 40.0, 0.0], [0.0; 3]],
        _ => [[0.0; 3]; 3],
    }
}

/// A tangent like that of a pair, whose contact points act on a node and, with the opposite sign, on two others: in
/// turn one sticks, one slides under pressure, one is open.
fn pair_tangent(contact: &[u32], position: &[Option<u32>]) -> Tangent {
    let mut tangent = Tangent::new();
    for (i, nodes) in contact.windows(3).enumerate() {
        let row = nodes.iter().zip([1.0, -0.7, -0.3]);
        let unknowns: Vec<Share> = row
            .flat_map(|(&node, on)| [(2 * node as usize, [on, 0.0, 0.0]), (2 * node as usize + 1, [0.0, on, 0.0])])
            .filter_map(|(dof, on)| Some((position[dof]?, on)))
            .collect();
        tangent.add(1.0, &unknowns, &slope_of(i));
    }
    tangent
}

/// Checks that the sweeps around a contact problem without forces solve the system; that the condensed operator is
/// symmetric, has the scale and magnitude that it declares, and is solved with stiff and nonsymmetric entries in any
/// basis; that a body held only by contact is solved with contact and reported as singular without; that a matrix that
/// is not positive definite is refused.
///
/// # Panics
/// Panics if the backend violates the contract, or if the small mesh of the test cannot be made.
pub fn assert_backend(backend: &Arc<dyn Backend>) {
    let Ok(mesh) = Mesh::rectangle([1.0, 0.7], [9, 7], Diagonal::Left) else { panic!("a mesh of 9 × 7 squares") };
    let graph = Arc::new(Graph::of_mesh(&mesh));
    let stiffness =
        Arc::new(forms::a(&mesh, &graph, &[&Isotropic::elastic(2, 2.0, 0.3, StressState::PlaneStrain).into()]));
    let all = vec![true; graph.len() * 2];
    let mut free = all.clone();
    for node in mesh.facets["top"].node_list() {
        free[2 * node as usize] = false;
        free[2 * node as usize + 1] = false;
    }
    let contact = mesh.facets["bottom"].node_list();
    let layout = Layout {
        points: &mesh.points,
        components: 2,
        free: &free,
        frames: &[],
        links: &[],
        rigid: &[],
        contact: &contact,
    };
    let Ok(mut system) = System::new(backend, &stiffness, &layout) else {
        panic!("{backend:?}: a positive definite matrix was refused")
    };
    let on_contact = system.unknowns().positions(free.len());
    assert!(
        contact.iter().all(|&node| on_contact[2 * node as usize].is_some()),
        "{backend:?}: unknowns of contact nodes are not kept"
    );
    assert_sweeps(backend, &mut system, &stiffness, &free);
    assert_condensed(backend, &mut system);
    let tangent = contact_tangent(&contact, &on_contact);
    assert_solutions(backend, &mut system, &tangent);
    assert_bases(backend, &mut system, &tangent, &contact);
    assert_solutions(backend, &mut system, &pair_tangent(&contact, &on_contact));
    // Without its support the body is held only by the entries.
    let loose = Layout { free: &all, ..layout };
    let Ok(mut system) = System::new(backend, &stiffness, &loose) else {
        panic!("{backend:?}: a body that only contact holds was refused")
    };
    let tangent = contact_tangent(&contact, &system.unknowns().positions(all.len()));
    assert_solutions(backend, &mut system, &tangent);
    let mut pushed = vec![1.0; system.condensed().len()];
    assert!(
        system.condensed_mut().solve(&Tangent::new(), &mut pushed, EXACT).is_err(),
        "{backend:?}: a body that nothing holds was pushed and came to rest"
    );
    let mut indefinite = BlockMatrix::clone(&stiffness);
    indefinite.add_scaled(-1e6, &forms::inner_h(&mesh, &graph));
    for (matrix, expected) in [(stiffness, true), (Arc::new(indefinite), false)] {
        assert_eq!(backend.is_positive_definite(&matrix, &layout), Ok(expected), "{backend:?}: definiteness");
    }
}

/// The result of a backend call; panics on an error.
fn given<T>(result: Result<T, SolveError>, what: &str) -> T {
    result.unwrap_or_else(|error| panic!("{what}: {error}"))
}

/// A stiff, nonsymmetric tangent like that of contact points that stick, press and slide in turn.
fn contact_tangent(contact: &[u32], position: &[Option<u32>]) -> Tangent {
    let mut tangent = Tangent::new();
    for (i, &node) in contact.iter().enumerate() {
        let (Some(x), Some(y)) = (position[2 * node as usize], position[2 * node as usize + 1]) else { continue };
        tangent.add(1.0, &[(x, [1.0, 0.0, 0.0]), (y, [0.0, 1.0, 0.0])], &slope_of(i));
    }
    tangent
}

/// Checks the sweeps around the problem on the kept unknowns.
fn assert_sweeps(backend: &Arc<dyn Backend>, system: &mut System, matrix: &BlockMatrix, free: &[bool]) {
    let mut random = samples();
    let solution: Vec<f64> = free.iter().map(|&f| if f { random.number() } else { 0.0 }).collect();
    let right = matrix.apply(&solution);
    // Without forces on Γ_C its unknowns solve S w = r̂; those of the solution must satisfy it.
    let text = format!("{backend:?}: the forward sweep");
    let reduced = given(system.reduce(&right), &text);
    let kept = system.kept_of(&solution);
    let product = given(system.condensed().apply(&kept), &text);
    for (i, (row, reduced)) in product.iter().zip(&reduced[system.unknowns().interior..]).enumerate() {
        near(*row, *reduced, 1e-11, &format!("{text}, row {i}"));
    }
    let text = format!("{backend:?}: the solution");
    let (mut x, zero) = (reduced, vec![0.0; free.len()]);
    given(system.settle(&mut x, &zero, |_, _| Ok::<_, SolveError>((kept.clone(), ()))), &text);
    let found = given(system.expand(x, &zero), &text);
    let plain = given(system.linearised(&Tangent::new(), &right), &text);
    for (dof, exact) in solution.iter().enumerate() {
        near(found[dof], *exact, 1e-11, &format!("{text} at degree of freedom {dof}"));
        near(plain[dof], *exact, 1e-10, &format!("{text} at degree of freedom {dof}, S solved"));
    }
}

/// Checks symmetry, scale and magnitude of the condensed operator.
fn assert_condensed(backend: &Arc<dyn Backend>, system: &mut System) {
    let interior = system.unknowns().interior;
    let nodes: Vec<u32> = system.unknowns().dofs[interior..].iter().map(|dof| dof / 2).collect();
    let s = system.condensed();
    let text = format!("{backend:?}: the condensed operator");
    let columns: Vec<_> = (0..s.len())
        .map(|j| given(s.apply(&(0..s.len()).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>()), &text))
        .collect();
    for i in 0..s.len() {
        for j in 0..i {
            near(columns[i][j], columns[j][i], 1e-12, &format!("{text}, symmetry of row {i}"));
        }
        let own: Vec<f64> = (0..s.len()).filter(|&j| nodes[j] == nodes[i]).map(|j| columns[j][j]).collect();
        near(s.scale()[i], own.iter().sum::<f64>() / own.len() as f64, 1e-12, &format!("{text}, scale {i}"));
        if let Some(dense) = s.dense() {
            for j in 0..s.len() {
                near(dense[(i, j)], columns[j][i], 1e-12, &format!("{text}, entry {i}, {j}"));
            }
        }
    }
    let mut random = samples();
    let x: Vec<f64> = (0..s.len()).map(|_| random.number()).collect();
    let exact = (0..s.len()).map(|i| (0..s.len()).map(|j| (columns[j][i] * x[j]).abs()).sum::<f64>());
    let magnitude = given(s.magnitude(&x), &text);
    near(magnitude, exact.fold(0.0, f64::max), 1e-12, &format!("{text}, magnitude"));
    assert!(magnitude <= s.magnitude_bound(&x), "{text}: the magnitude exceeds its bound");
}

/// Random unknowns; those held by stiff entries are so small that all forces are of similar size.
fn moved(system: &System, tangent: &Tangent) -> Vec<f64> {
    let mut random = samples();
    let mut held = vec![1.0; system.condensed().len()];
    for (i, j, value) in tangent.entries().filter(|(i, j, _)| i == j) {
        held[i as usize] += value / system.condensed().scale()[j as usize];
    }
    held.iter().map(|held| random.number() / held).collect()
}

/// Checks solutions of systems with entries, and their definiteness.
fn assert_solutions(backend: &Arc<dyn Backend>, system: &mut System, tangent: &Tangent) {
    let exact = moved(system, tangent);
    let text = format!("{backend:?}: a system with contact");
    let mut b = given(system.condensed().apply(&exact), &text);
    tangent.add_product(1.0, &exact, &mut b);
    given(system.condensed_mut().solve(tangent, &mut b, EXACT), &text);
    for (i, (found, exact)) in b.iter().zip(&exact).enumerate() {
        near(*found, *exact, 1e-9, &format!("{text}, unknown {i}"));
    }
    let size = system.condensed().len();
    let of = |sign: f64| {
        let mut diagonal = vec![0.0; size];
        tangent.entries().filter(|(i, j, _)| i == j).for_each(|(i, _, value)| diagonal[i as usize] += sign * value);
        let mut alone = Tangent::new();
        alone.add_diagonal(diagonal);
        alone
    };
    for sign in [1.0, -1.0] {
        let found = given(system.condensed_mut().is_positive_definite(&of(sign)), &text);
        assert_eq!(found, sign > 0.0, "{text}: definiteness with the factor {sign}");
    }
}

/// Checks that the same system in other bases has the same solution.
fn assert_bases(backend: &Arc<dyn Backend>, system: &mut System, tangent: &Tangent, contact: &[u32]) {
    let position = system.unknowns().positions(1 + system.unknowns().dofs.iter().fold(0, |m, &d| m.max(d as usize)));
    let (sin, cos) = 0.4f64.sin_cos();
    let turn = |&node: &u32| {
        let [x, y] = [position[2 * node as usize]?, position[2 * node as usize + 1]?];
        Some(Turn { unknowns: [x, y, 0], basis: [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0; 3]], dim: 2 })
    };
    let turns: Vec<Turn> = contact.iter().filter_map(turn).collect();
    let exact = moved(system, tangent);
    let text = format!("{backend:?}: a system in other bases");
    let straight = given(system.condensed().apply(&exact), &text);
    let forward = |x: &[f64]| {
        let mut x = x.to_vec();
        for turn in &turns {
            turn.forward(&mut x);
        }
        x
    };
    system.condensed_mut().turn(&turns);
    assert_eq!(system.condensed().turns(), turns.as_slice(), "{text}");
    let mut b = given(system.condensed().apply(&forward(&exact)), &text);
    for (i, (found, exact)) in b.iter().zip(forward(&straight)).enumerate() {
        near(*found, exact, 1e-11, &format!("{text}: product, unknown {i}"));
    }
    // The entries refer to the bases, and so do the unknowns that they hold.
    let turned = exact;
    b = given(system.condensed().apply(&turned), &text);
    tangent.add_product(1.0, &turned, &mut b);
    given(system.condensed_mut().solve(tangent, &mut b, EXACT), &text);
    for (i, (found, exact)) in b.iter().zip(&turned).enumerate() {
        near(*found, *exact, 1e-9, &format!("{text}, unknown {i}"));
    }
    system.condensed_mut().turn(&[]);
}
