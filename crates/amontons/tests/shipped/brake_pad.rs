//! The worked case `cases/brake-pad`: two materials in space on a mesh from a file, loads from a table.

use std::f64::consts::PI;

use crate::common::case;
use amontons::contact::Status;
use amontons::element::ShapeTable;
use amontons::mesh::{CellMap, FacetMap, Mesh};
use amontons::output::Memory;
use amontons::problem::Problem;
use amontons::run::{Settings, run};

/// Area of a side, by the geometry of its curved facets.
fn area(mesh: &Mesh, side: &str) -> f64 {
    let facets = mesh.facets.get(side).expect("the side");
    let mut sum = 0.0;
    for (element, nodes) in facets.facets() {
        let table = ShapeTable::new(element, 6);
        let mut map = FacetMap::new(mesh, &table);
        for (q, weight) in table.weights.iter().enumerate() {
            map.at(nodes, q);
            sum += weight * map.area;
        }
    }
    sum
}

/// Volume of each region.
fn volumes(mesh: &Mesh) -> Vec<f64> {
    let mut volumes = vec![0.0; mesh.regions.len()];
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, 6);
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(cell, q);
                volumes[block.region] += weight * map.measure;
            }
        }
    }
    volumes
}

/// A ring sector with rounded corners has the area of the sector less that of its corners, each the gap between a
/// circle of radius f and the two sides that it touches.
fn plate_area() -> f64 {
    let (inner, outer, half, f) = (0.095f64, 0.145f64, PI / 6.0, 0.006f64);
    // A corner between an end and the circle of radius R, the centre of the small circle on the radius c from the axis.
    let corner = |circle: f64, c: f64| {
        let angle = (f / c).asin();
        let along = (c * c - f * f).sqrt();
        let triangle = 0.5 * along * f;
        let (sector, turn) = (0.5 * circle * circle * angle, 0.5 * PI + if circle > c { angle } else { -angle });
        let piece = 0.5 * f * f * turn;
        if circle > c { sector - triangle - piece } else { triangle - sector - piece }
    };
    half * (outer * outer - inner * inner) - 2.0 * corner(outer, outer - f) - 2.0 * corner(inner, inner + f)
}

fn sums(problem: &Problem) -> (f64, f64) {
    let area = area(&problem.mesh, "piston");
    let mass = volumes(&problem.mesh).iter().zip(&problem.materials).map(|(v, m)| v * m.density.at(&[0.0; 3])).sum();
    (area, mass)
}

/// Sides and regions of the file are those of the drawing, in m.
#[test]
fn the_mesh_is_that_of_the_drawing() {
    let case = case("cases/brake-pad/pad.toml", &[]);
    let mesh = &case.problem.mesh;
    assert_eq!(mesh.dim, 3);
    // A parabola through three points of an arc of angle φ encloses φ⁴/480 less than the sector: 2.8e-5 with edges of
    // 7.5 mm on the piston of 22 mm.
    let piston = area(mesh, "piston");
    let short = |angle: f64| angle.powi(4) / 480.0;
    assert!((piston / (PI * 0.022 * 0.022) - 1.0).abs() < short(7.5 / 22.0), "{piston}");
    // On the plate the corners, 2 % of its area, have two edges of 45° each.
    let plate = plate_area();
    let back = area(mesh, "back");
    let allowed = 0.02 * short(0.25 * PI) + short(7.5 / 95.0);
    assert!(((back + piston) / plate - 1.0).abs() < 2.0 * allowed, "{} {plate}", back + piston);
    let index = mesh.regions.iter().position(|r| r == "plate").expect("the plate");
    assert!((volumes(mesh)[index] / (0.005 * plate) - 1.0).abs() < 2.0 * allowed);
}

/// While it is pressed, warmed and moved: the contact force is the force of the piston but for the inertia of the pad,
/// both identities close, and friction keeps to Coulomb's law.
#[test]
fn the_pad_is_in_balance() {
    let case = case("cases/brake-pad/pad.toml", &["time.end=9".to_owned(), "time.steps=3".to_owned()]);
    let problem = &case.problem;
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    let summary = run(problem, &settings, &mut [&mut memory]).expect("a run");
    let (area, mass) = sums(problem);
    let k = 3.0;
    for (n, report) in memory.reports.iter().enumerate() {
        let t = k * (n + 1) as f64;
        let pressure = 3e6 * (t / 5.0).min(1.0);
        let [w, last] = [n + 1, n].map(|i| &memory.states[i].w);
        let jump = w.iter().zip(last).skip(2).step_by(3).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let [x, y, z] = report.contact.force;
        // A step satisfies its equations to 1e-10 of the largest term; the sum over the nodes of Γ_C is that of the
        // equations of all nodes.
        let allowed = mass * jump / k + 1e-9 * pressure * area;
        assert!(
            (z - pressure * area).abs() <= allowed,
            "t = {t}: {z}, expected {}, allowed {allowed:e}",
            pressure * area
        );
        assert!(x.hypot(y) <= 0.4 * z * (1.0 + 1e-12), "t = {t}: more friction than Coulomb's law allows");
        for state in &report.contact.states {
            let friction = state.q.iter().map(|q| q * q).sum::<f64>().sqrt();
            assert!(
                friction <= 0.4 * state.pressure + 1e-10 * 0.4 * pressure,
                "{friction} at the pressure {}",
                state.pressure
            );
        }
    }
    let count =
        |status| memory.reports.last().expect("a report").contact.states.iter().filter(|s| s.status == status).count();
    assert!(
        count(Status::Stick) > 0 && count(Status::Slip) > 0 && count(Status::Open) > 0,
        "all three states occur while the pad starts to slide"
    );
    let ledger = &memory.states.last().expect("a state").ledger;
    assert!(ledger.relative_closing_error().abs() < 1e-12, "{:e}", ledger.relative_closing_error());
    assert!(ledger.relative_heat_closing_error().abs() < 1e-12, "{:e}", ledger.relative_heat_closing_error());
    assert!(summary.unknowns.contact > 1500);
}
