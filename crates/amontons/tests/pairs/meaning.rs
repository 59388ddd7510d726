//! What a law takes of a side is said relative to `on` and `with`: neither the mesh nor the side that bears the contact
//! points changes what a pair means.

use amontons::case::{self, Case, Source};
use amontons::output::{Memory, OutputError, ProbeSet, Sink, Snapshot, Summary};
use amontons::run::{self, Settings};
use amontons::state::State;

fn case(text: &str) -> Case {
    case::parse(&Source::new("pair.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn made(text: &str) -> Memory {
    let (case, mut memory) = (case(text), Memory::new().states_every(1).reports());
    let settings = Settings { certificate: false, ..Settings::default() };
    run::run(&case.problem, &settings, &mut [&mut memory]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    memory
}

/// A block of 100 K on a base of 0 K, nothing conducts between them; the base has so many cells along. In space the
/// bodies are as deep as a cell.
fn hot_block(dim: usize, n: usize, top: &str, contact: &str) -> String {
    let (base, block, flat, held) = if dim == 3 {
        (
            format!("size = [1.0, 0.5, 0.25], n = [{n}, {}, {}], origin = [0, -0.5, 0]", n / 2, n / 4),
            "size = [0.5, 0.3, 0.25], n = [4, 3, 2], origin = [0.2, 0.0, 0.0]",
            "",
            "[0, 0, 0]",
        )
    } else {
        (
            format!("size = [1.0, 0.5], n = [{n}, {}], origin = [0, -0.5]", n / 2),
            "size = [0.5, 0.3], n = [4, 3], origin = [0.2, 0.0]",
            ", stress_state = \"plane-strain\"",
            "[0, 0]",
        )
    };
    format!(
        r#"name = "hot-block"
        units = "dimensionless"
        [mesh]
        kind = "blocks"
        blocks = [{{ name = "base", {base} }}, {{ name = "block", {block} }}]
        [time]
        end = 1.0
        steps = 4
        [material]
        density = 0
        elasticity = {{ law = "isotropic", young = 100.0, poisson = 0.3{flat} }}
        heat_capacity = 0
        conductivity = 1.0
        [[boundary]]
        on = "block_top"
        displacement = {top}
        temperature = 100
        [[boundary]]
        on = "base_bottom"
        displacement = {held}
        temperature = 0
        [contact]
        normal = {{ law = "signorini" }}
        {contact}
        "#
    )
}

/// Names of the sides `on` and `with`, and the side that bears the points.
fn ways() -> impl Iterator<Item = ([&'static str; 2], String)> {
    [["block_bottom", "base_top"], ["base_top", "block_bottom"]]
        .into_iter()
        .flat_map(|sides| sides.map(|bearing| (sides, bearing)))
        .map(|(sides, bearing)| {
            (sides, format!("on = \"{}\"\nwith = \"{}\"\nnonmortar = \"{bearing}\"\n", sides[0], sides[1]))
        })
}

/// μ is 0.2 at 0 K and 0.6 at 100 K, and κ 1e-6 and 1e-4: with `on` the hot block it is the second, with `on` the cold
/// base the first, on every mesh and with either side bearing the points. Where μ and κ are the same everywhere the
/// worn volume is κ/μ times the work of friction.
#[test]
fn friction_and_wear_see_the_temperature_of_on() {
    let laws = "friction = { law = \"temperature\", temperature = [0, 100], coefficient = [0.2, 0.6] }\n\
                wear = { law = \"archard-temperature\", temperature = [0, 100], coefficient = [1e-6, 1e-4] }\n";
    for (dim, n) in [(2, 8), (2, 32), (3, 8)] {
        let top =
            if dim == 3 { "[\"0.05*t\", \"-1e-3*min(1, 10*t)\", 0]" } else { "[\"0.05*t\", \"-1e-3*min(1, 10*t)\"]" };
        for coupling in ["staggered", "monolithic"] {
            for ([on, _], sides) in ways() {
                let more = format!("{sides}{laws}[scheme]\ncoupling = \"{coupling}\"\n");
                let memory = made(&hot_block(dim, n, top, &more));
                let [mu, kappa] = if on == "block_bottom" { [0.6, 1e-4] } else { [0.2, 1e-6] };
                let force = memory.reports.last().expect("a step").contact.force;
                let ratio = (force[0] / force[1]).abs();
                // In space some points slip a little across.
                let sharp = if dim == 2 { 1e-9 } else { 1e-6 };
                assert!((ratio - mu).abs() < sharp, "{dim} {n} {coupling} {sides}: T/N {ratio}");
                // The first step of the staggered scheme sees the temperature at the start.
                let change = |of: &dyn Fn(&State) -> f64| of(&memory.states[4]) - of(&memory.states[1]);
                let worn = change(&|state| state.surface.worn.volumes[0].iter().sum());
                let expected = kappa / mu * change(&|state| state.ledger.friction_dissipation);
                assert!(expected > 0.0 && (worn / expected - 1.0).abs() < 1e-9, "{dim} {n} {sides}: {worn:e}");
                if coupling == "monolithic" {
                    let passes = memory.reports.iter().map(|report| report.coupling.passes).max();
                    assert!(passes <= Some(4), "{passes:?} passes");
                }
            }
        }
    }
}

/// A belt on `with` runs along x under a block at rest: the block is dragged along x by μ N. Named the other way round
/// the block runs along x over the base, and drags the base along x.
#[test]
fn the_foundation_velocity_is_that_of_with() {
    for n in [8, 32] {
        for ([on, _], sides) in ways() {
            let more = format!(
                "{sides}friction = {{ law = \"coulomb\", coefficient = 0.4 }}\nfoundation_velocity = [1.0, 0]\n\
                 frictional_heat = 0.3\n"
            );
            let memory = made(&hot_block(2, n, "[0, \"-1e-3*min(1, 10*t)\"]", &more));
            let [along, across, _] = memory.reports.last().expect("a step").contact.force;
            let pressing = if on == "block_bottom" { across } else { 0.0 - across };
            assert!(pressing > 0.0 && (along / pressing - 0.4).abs() < 1e-9, "{n} {sides}: {along} {across}");
            // Of the heat that friction makes 0.3 enters `on`.
            let last = memory.states.last().expect("a state");
            let (entered, made) = (0.0 - last.surface.passed[0].by_name()["friction"], last.ledger.heat_pairs);
            assert!(made > 0.0 && (entered / made - 0.3).abs() < 1e-9, "{n} {sides}: {entered} of {made}");
        }
    }
}

/// Under a body of revolution `with` turns about the axis, v = ω r out of the plane: the moment on `on` is
/// ∫ μ p r over the side, against the turn where the pair is named the other way round.
#[test]
fn the_turn_of_a_pair_of_revolution_is_that_of_with() {
    let moment = |sides: &str| {
        let text = hot_block(2, 8, "[0, \"-1e-3*min(1, 10*t)\"]", "").replace("[mesh]", "[mesh]\naxisymmetric = true");
        let laws = "friction = { law = \"coulomb\", coefficient = 0.4 }\nfoundation_velocity = [0, 0, \"2*x\"]\n";
        let text = text.replace(", stress_state = \"plane-strain\"", "") + sides + laws;
        let (case, mut memory) = (case(&text), Memory::new().reports());
        let summary = run::run(&case.problem, &Settings::default(), &mut [&mut memory]).expect("a run");
        let points = case.problem.contact_boundary().points;
        let states = &memory.reports.last().expect("a step").contact.states;
        let expected = points.iter().zip(states).map(|(at, s)| 0.4 * at.weight * s.pressure * at.x[0]).sum::<f64>();
        (summary.last.contact.expect("contact").moment.expect("a moment"), expected)
    };
    // The third axis is −φ or φ; a foundation under the block says which.
    let mut signs = Vec::new();
    for ([_, _], sides) in ways() {
        let (found, expected) = moment(&sides);
        assert!((found.abs() / expected - 1.0).abs() < 1e-9, "{sides}: {found}, {expected}");
        signs.push(found.signum());
    }
    assert!(signs.windows(2).all(|pair| pair[0] * pair[1] > 0.0), "with drags on, however they are named: {signs:?}");
}

/// The values of probes after the last step.
#[derive(Default)]
struct Probes(Option<ProbeSet>, Vec<(String, f64)>);

impl Sink for Probes {
    fn step(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        if let Some(set) = &self.0 {
            self.1 = set.columns().iter().cloned().zip(set.values(now)).collect();
        }
        Ok(())
    }
}

fn probed(text: &str) -> (Probes, Summary) {
    let case = case(text);
    let mut probes = Probes(Some(ProbeSet::new(&case.problem, &case.probes).expect("probes")), Vec::new());
    let summary = run::run(&case.problem, &Settings::default(), &mut [&mut probes]).expect("a run");
    (probes, summary)
}

impl Probes {
    fn value(&self, name: &str) -> f64 {
        self.1.iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("{name} in {:?}", self.1)).1
    }
}

/// Probes on either side of a pair read its points: pressures, areas and works are the same, tractions and slip
/// velocities are opposite, and the integrals are the force of the pair; of pairs that are updated as well, whose
/// points have other weights in every step.
#[test]
fn a_probe_on_either_side_reads_the_pair() {
    for geometry in ["reference", "updated"] {
        for ([on, with], sides) in ways() {
            let mut more = format!(
                "{sides}geometry = \"{geometry}\"\nfriction = {{ law = \"coulomb\", coefficient = 0.4 }}\n\
                 wear = {{ law = \"archard\", coefficient = 1e-4, fraction = 0.25 }}\n"
            );
            for (quantity, take) in [
                ("pressure", "max"),
                ("pressure", "mean"),
                ("pressure", "integral"),
                ("traction", "integral"),
                ("slip_velocity", "mean"),
                ("touching", "integral"),
                ("friction_work", "integral"),
                ("wear", "integral"),
            ] {
                for side in [on, with] {
                    more += &format!(
                        "[[probe]]\nname = \"{quantity}-{take}-{side}\"\nquantity = \"{quantity}\"\non = \"{side}\"\n\
                         take = \"{take}\"\n"
                    );
                }
            }
            let (probes, summary) = probed(&hot_block(2, 8, "[\"0.05*t\", \"-1e-3*min(1, 10*t)\"]", &more));
            let contact = summary.last.contact.expect("contact");
            let of = |name: &str| [on, with].map(|side| probes.value(&name.replace("SIDE", side)));
            for name in
                ["pressure-max-SIDE", "pressure-mean-SIDE", "touching-integral-SIDE", "friction_work-integral-SIDE"]
            {
                let [a, b] = of(name);
                assert!(a > 0.0 && a.to_bits() == b.to_bits(), "{geometry} {sides} {name}: {a}, {b}");
            }
            for (name, force) in [("traction-integral-SIDE_x", contact.force[0]), ("slip_velocity-mean-SIDE_x", 0.0)] {
                let [a, b] = of(name);
                assert!(a != 0.0 && (a + b).abs() <= f64::EPSILON * a.abs(), "{geometry} {sides} {name}: {a}, {b}");
                // Of a pair that is updated the pressure has a part along x, since the faces tilt.
                let same = if geometry == "updated" { 2e-3 } else { 1e-12 };
                assert!(force == 0.0 || (a - force).abs() < same * force.abs(), "{geometry} {sides}: {a}, {force}");
            }
            let [load, _] = of("pressure-integral-SIDE");
            let same = if geometry == "updated" { 2e-3 } else { 1e-12 };
            assert!((load - contact.force[1].abs()).abs() < same * load, "{geometry} {sides}: {load}");
            let [off_on, off_with] = of("wear-integral-SIDE");
            let volume = contact.wear_volume;
            assert!((off_on - 0.25 * volume).abs() < 1e-12 * volume, "{geometry} {sides}: {off_on} of {volume}");
            assert!((off_with - 0.75 * volume).abs() < 1e-12 * volume, "{geometry} {sides}: {off_with} of {volume}");
        }
    }
}
