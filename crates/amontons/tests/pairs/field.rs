//! Pairs as people of the trade pose them (`reference/field`): the right value and its source are in the head of each
//! file. Each is tried with the contact points on either side, and changed in ways that must not matter.

use amontons::contact::PointOnBoundary;
use amontons::inclusion::PointState;
use amontons::output::Memory;
use amontons::run::{self, Settings};

use crate::common;

/// What the contact of a case does in its last step.
struct Last {
    force: [f64; 3],
    /// The points with their states, those that face nothing left out.
    points: Vec<(PointOnBoundary, PointState)>,
    /// Largest displacement.
    moved: f64,
}

impl Last {
    fn largest_pressure(&self) -> f64 {
        self.points.iter().map(|(_, state)| state.pressure).fold(0.0, f64::max)
    }

    /// Σ ω p of the points that are told.
    fn normal_force(&self, of: impl Fn(&PointOnBoundary) -> bool) -> f64 {
        let points = self.points.iter().filter(|(point, _)| of(point));
        points.map(|(point, state)| point.weight * state.pressure).sum()
    }
}

fn last(name: &str, overrides: &[&str]) -> Last {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let case = common::case(&format!("crates/amontons/tests/reference/field/{name}.toml"), &overrides);
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(&case.problem, &settings, &mut [&mut memory]).unwrap_or_else(|why| panic!("{name}, {overrides:?}: {why}"));
    let contact = &memory.reports.last().expect("a step").contact;
    let boundary = contact.boundary.clone().map_or_else(|| case.problem.contact_boundary(), |made| (*made).clone());
    let points = boundary.points.iter().zip(&contact.states).filter(|(point, _)| point.weight > 0.0);
    Last {
        force: contact.force,
        points: points.map(|(point, state)| (point.clone(), *state)).collect(),
        moved: common::largest(&memory.states.last().expect("a state").u),
    }
}

/// The contact points on either side.
fn on_each_side(sides: [&str; 2]) -> [String; 2] {
    sides.map(|side| format!("contact.nonmortar=\"{side}\""))
}

#[test]
fn bodies_that_only_touch_at_a_corner_have_no_force() {
    for side in on_each_side(["bed_face", "shoe_face"]) {
        let found = last("corner-touching", &[&side]);
        // Young's modulus is 3e4.
        assert!(found.normal_force(|_| true) < 1e-9, "{side}: {}", found.normal_force(|_| true));
    }
}

/// A small coarse body on a finer one: 0.561, within 3 % by the default side and 6 % by the other, pressures as they
/// are beside an edge; and wherever the foot stands.
#[test]
fn a_foot_has_its_force_wherever_it_stands() {
    let force = |sets: &[&str]| {
        let found = last("foot-plane", sets);
        assert!(found.largest_pressure() < 2.5, "{sets:?}: {}", found.largest_pressure());
        found.force[1]
    };
    let mut random = common::Random(3);
    let places: Vec<f64> = (0..12).map(|_| 0.3 + 0.7 * random.number().abs()).chain([0.5, 0.5 + 1e-7, 0.6]).collect();
    for (side, most) in [("foot_bottom", 0.03), ("table_top", 0.06)] {
        let side = format!("contact.nonmortar=\"{side}\"");
        for x in &places {
            let at = format!("mesh.blocks[1].origin=[{x}, 1.0]");
            let found = force(&[&side, &at]);
            assert!((found / 0.561 - 1.0).abs() < most, "{side}, {at}: {found}");
        }
        let [here, there] = [0.5, 0.5001].map(|x| force(&[&side, &format!("mesh.blocks[1].origin=[{x}, 1.0]")]));
        assert!((here - there).abs() < 1e-3, "{side}: {here}, {there}");
    }
    assert!((force(&[]) / 0.561 - 1.0).abs() < 0.03);
}

/// Coulomb's force to round-off on any mesh, however the pushed body is held.
#[test]
fn nodes_that_are_held_bear_pressure_and_friction() {
    for side in on_each_side(["block_bottom", "base_top"]) {
        for n in ["[4, 2]", "[9, 2]"] {
            let [along, across, _] = last("k1-pushed-block", &[&side, &format!("mesh.blocks[1].n={n}")]).force;
            assert!((across - 1e5).abs() < 1e-6 && (along + 3e4).abs() < 1e-6, "{side}, {n}: {along}, {across}");
        }
    }
    for side in on_each_side(["inner_right", "outer_left"]) {
        for n in ["[4, 4]", "[4, 7]"] {
            let [across, along, _] = last("k1-held-shaft", &[&side, &format!("mesh.blocks[0].n={n}")]).force;
            assert!((along / across - 0.1).abs() < 1e-9, "{side}, {n}: {along}, {across}");
            // Lamé: 1546 N.
            assert!((along.abs() / 1546.0 - 1.0).abs() < 0.02, "{side}, {n}: {along}");
        }
    }
}

/// In space between planes of symmetry along which a slice slides.
#[test]
fn a_slice_between_planes_of_symmetry_rubs() {
    for side in on_each_side(["b_bottom", "a_top"]) {
        let [along, across, out] = last("t7-slice", &[&side]).force;
        assert!((along / across + 0.4).abs() < 1e-9 && out.abs() < 1e-9 * across, "{side}: {along}, {across}, {out}");
    }
}

/// A shaft that nothing keeps from turning stays within its clearance.
#[test]
fn a_shaft_that_may_turn_does_not() {
    let found = last("k2-shaft-in-bore", &[]);
    assert!(found.moved < 17e-6, "{}", found.moved);
    assert!((found.largest_pressure() / 45.1e6 - 1.0).abs() < 0.005, "{}", found.largest_pressure());
}

/// A block slides off the end of its base, every step with another sliver: the force falls to 63.9 kN/m, and no
/// pressure is far above the mean.
#[test]
fn a_block_that_slides_off_has_no_pressures_of_slivers() {
    for side in on_each_side(["base_top", "block_bottom"]) {
        let found = last("k6-slide-off", &[&side]);
        assert!((found.force[1] / 63.9e3 - 1.0).abs() < 0.01, "{side}: {:?}", found.force);
        let area: f64 = found.points.iter().map(|(point, _)| point.weight).sum();
        let mean = found.normal_force(|_| true) / area;
        assert!(found.largest_pressure() < 3.0 * mean, "{side}: {} of {mean}", found.largest_pressure());
    }
}

/// Flanks with a gap in front and another body behind their own touch nothing.
#[test]
fn a_comb_does_not_pair_through_its_own_body() {
    for side in on_each_side(["A_RIGHT", "B_LEFT"]) {
        assert!(last("k8-comb", &[&side]).normal_force(|_| true).abs() < 1e-6, "{side}");
    }
}

/// Each flank of a V bears W/√2.
#[test]
fn a_kink_parts_a_side() {
    let exact = 2e4 / 2f64.sqrt();
    for side in on_each_side(["wedge", "v"]) {
        let found = last("k16-v-block", &[&side]);
        for sign in [-1.0, 1.0] {
            let flank = found.normal_force(|point| sign * point.normal[0] > 0.0);
            assert!((flank / exact - 1.0).abs() < 1e-9, "{side}: {flank}, expected {exact}");
        }
    }
}

/// Lamé's pressure at every point of a press fit of sectors: the two polygons are as far apart as the datum says.
#[test]
fn a_press_fit_of_sectors_has_one_pressure() {
    for side in on_each_side(["i_outer", "o_inner"]) {
        let found = last("t5-sector-press-fit", &[&side]);
        for (point, state) in &found.points {
            assert!((state.pressure / 5.859_375e6 - 1.0).abs() < 0.004, "{side}, {:?}: {}", point.x, state.pressure);
        }
    }
}
