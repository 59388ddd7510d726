//! Parts of the bound of the discretization error: thermal stress, and what is repaired between nodes.

use std::sync::Arc;

use amontons::contact::{Contact, Signorini};
use amontons::mesh::{Diagonal, Elements, Mesh};
use amontons::problem::{BoundaryCondition, Physics};

use super::common::{changed, checked};
use super::majorant::{ROD, bounded, parsed, plane};
use super::majorant_random::compared;

/// The same rod, warmed: E u'' = M θ' − f, and the bound is the error (M θ' − f)²h²/12.
#[test]
fn the_bound_of_a_warm_rod_is_its_error() {
    for n in [4, 8] {
        let problem = changed(&parsed(ROD, &[&format!("mesh.n={n}")]), |data| {
            data.physics = Physics::Warmed;
            data.materials[0].expansion = amontons::tensor::Sym::from_fn(1, |_, _| 0.3).into();
            let field = amontons::field::Field::of_space(|x| 1.0 + 2.0 * x[0]);
            data.temperature = vec![amontons::problem::GivenTemperature { region: None, field, key: String::new() }];
        });
        let found = bounded(&problem);
        let squared = (0.3f64 * 2.0 - 1.0).powi(2) / (12.0 * f64::from(n).powi(2));
        assert!(found.is_guaranteed(), "{:?}", found.estimate);
        assert!((2.0 * found.energy / squared - 1.0).abs() < 1e-9, "{n}: {:e} {squared:e}", 2.0 * found.energy);
    }
}

/// A quadratic side that touches at the middle of its only facet and is open at the ends penetrates between them: that
/// is taken away, and its energy is in the bound.
#[test]
fn a_side_that_penetrates_between_its_nodes_is_repaired() {
    let mut data = plane(Elements::P2);
    data.mesh = Arc::new(Mesh::rectangle_of(Elements::P2, [1.0, 1.0], [1, 1], Diagonal::Right).expect("a mesh"));
    let bent = amontons::field::Field::of_space(|x| 0.4 * (x[0] - 0.5).powi(2) - 0.03);
    data.boundary = vec![BoundaryCondition::on("top").displacement([0.0.into(), bent])];
    data.body_force = Vec::new();
    data.contacts = vec![Contact::new("bottom", Signorini)];
    let (error, found) = compared(&checked(data), 3);
    assert!(found.repair > 1e-3 * found.energy && found.energy >= error, "{found:?} {error:e}");
    let sum = ((found.mesh + found.contact).sqrt() + found.repair.sqrt()).powi(2);
    assert!((found.energy - sum).abs() <= 1e-12 * sum, "{found:?}");
}
