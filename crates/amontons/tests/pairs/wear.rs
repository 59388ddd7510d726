//! Wear of pairs: the depth belongs to the body that wears and moves with it, whichever side bears the contact points.

use amontons::case::{self, Source};
use amontons::output::{Memory, Summary};
use amontons::run::{self, Settings};

const KAPPA: f64 = 1e-11;
const STEPS: usize = 60;

fn run(text: &str) -> (Memory, Summary) {
    let case = case::parse(&Source::new("wear.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut memory = Memory::new().states_every(1).reports();
    let settings = Settings { certificate: false, ..Settings::default() };
    let summary = run::run(&case.problem, &settings, &mut [&mut memory]);
    (memory, summary.unwrap_or_else(|error| panic!("{error}\n{text}")))
}

/// A pin of 20 mm slides by 60 mm over a rail, of unlike facets; turned by a right angle with `turned`.
fn pin_on_rail(elements: &str, is_turned: bool, contact: &str) -> String {
    let pair = |a: &str, b: &str| if is_turned { format!("[{b}, {a}]") } else { format!("[{a}, {b}]") };
    let block = |name: &str, size: [&str; 2], origin: [&str; 2], n: [&str; 2]| {
        let [size, origin, n] = [size, origin, n].map(|[a, b]| pair(a, b));
        format!("{{ name = \"{name}\", size = {size}, origin = {origin}, n = {n}, elements = \"{elements}\" }}")
    };
    let rail = block("rail", ["0.14", "0.02"], ["0", "0"], ["31", "2"]);
    let pin = block("pin", ["0.02", "0.02"], ["0.03", "0.02"], ["5", "2"]);
    let [low, high] = if is_turned { ["left", "right"] } else { ["bottom", "top"] };
    let (held, moved) = (pair("0", "0"), pair("\"0.06*t\"", "-2e-5"));
    format!(
        "name = \"pin\"\n[mesh]\nkind = \"blocks\"\nblocks = [{rail}, {pin}]\n[time]\nend = 1.0\nsteps = {STEPS}\n\
         [material]\ndensity = 0\n\
         elasticity = {{ law = \"isotropic\", young = 1e9, poisson = 0, stress_state = \"plane-strain\" }}\n\
         [[boundary]]\non = \"rail_{low}\"\ndisplacement = {held}\n\
         [[boundary]]\non = \"pin_{high}\"\ndisplacement = {moved}\n\
         [contact]\non = \"pin_{low}\"\nwith = \"rail_{high}\"\ngeometry = \"updated\"\nnormal = {{ law = \"signorini\" }}\n\
         friction = {{ law = \"coulomb\", coefficient = 0.01 }}\n{}",
        contact.replace("PIN", &format!("pin_{low}")).replace("RAIL", &format!("rail_{high}"))
    )
}

/// The volume is κ ∫ N ds and never falls, whichever side bears the points and whichever body wears: of the first step
/// the slip is shorter by the shear of the bodies, 2e-4 of the path. A rail that wears is worn once in each place: the
/// force does not change once the pin has moved by its length. A pin that wears loses force all along.
#[test]
fn a_pin_and_a_rail_keep_what_has_come_off_them() {
    for (elements, is_turned) in [("Q1", false), ("Q1", true), ("P1", false)] {
        for bearing in ["PIN", "RAIL"] {
            let normal = usize::from(!is_turned);
            let forces = |memory: &Memory| -> Vec<f64> {
                memory.reports.iter().map(|report| report.contact.force[normal]).collect()
            };
            let fresh = forces(&run(&pin_on_rail(elements, is_turned, &format!("nonmortar = \"{bearing}\"\n"))).0);
            for fraction in [1.0, 0.0, 0.25] {
                let more = format!(
                    "nonmortar = \"{bearing}\"\n\
                     wear = {{ law = \"archard\", coefficient = {KAPPA:e}, fraction = {fraction} }}\n"
                );
                let (memory, summary) = run(&pin_on_rail(elements, is_turned, &more));
                let told = format!("{elements} {is_turned} {bearing} {fraction}");
                let forces = forces(&memory);
                let volumes: Vec<f64> =
                    memory.states.iter().map(|state| state.surface.worn.volumes[0].iter().sum()).collect();
                assert!(volumes.windows(2).all(|pair| pair[1] > pair[0]), "{told}: {volumes:?}");
                let expected = KAPPA * forces.iter().sum::<f64>() * 0.06 / STEPS as f64;
                let volume = volumes[STEPS];
                assert!((volume / expected - 1.0).abs() < 5e-4, "{told}: {volume:e} for {expected:e}");
                let contact = summary.last.contact.expect("contact");
                assert!((contact.wear_volume / volume - 1.0).abs() < 1e-12, "{told}");
                let worn = &memory.states[STEPS].surface.worn;
                assert!((worn.volumes[0][0] - fraction * volume).abs() < 1e-12 * volume, "{told}: {:?}", worn.volumes);
                // Depths are not negative, and no deeper than what the largest pressure makes: a mean of 0.59 MPa on
                // 20 mm, the edges press harder.
                let mean = KAPPA * 6e5 * if fraction == 0.0 { 0.02 } else { 0.06 };
                assert!(worn.depths.iter().flat_map(|of| of.iter()).all(|&h| (0.0..4.0 * mean).contains(&h)), "{told}");
                // The ratio to the force without wear, which goes up and down as facets pass each other.
                let ratios: Vec<f64> = forces.iter().zip(&fresh).skip(22).map(|(worn, fresh)| worn / fresh).collect();
                let least = ratios.iter().copied().fold(f64::INFINITY, f64::min);
                let most = ratios.iter().copied().fold(0.0, f64::max);
                if fraction == 0.0 {
                    // Under the pin the track is from 0 to κ p L deep: in the mean half of that, of the 20 µm, but for
                    // the edges, which press harder.
                    let expected = 0.5 * KAPPA * 5.9e5 * 0.02 / 2e-5;
                    assert!(((1.0 - least) / expected - 1.0).abs() < 0.15, "{told}: {least}");
                    assert!(most / least - 1.0 < 0.1 * expected, "{told}: {least} to {most}");
                } else {
                    assert!(most / least > 1.0 + 0.005 * fraction, "{told}: {least} to {most}");
                }
            }
        }
    }
}

/// Pins one behind the other on one rail that wears: the rail has what both have taken off it, and the second, which
/// runs in the track of the first, presses less.
#[test]
fn a_rail_keeps_what_two_pins_have_taken_off_it() {
    let block = "{ name = \"NAME\", size = [0.02, 0.02], origin = [X, 0.02], n = [5, 2] }";
    let [first, second] =
        [("first", "0.06"), ("second", "0.03")].map(|(name, x)| block.replace("NAME", name).replace('X', x));
    let contact = |name: &str| {
        format!(
            "[[boundary]]\non = \"{name}_top\"\ndisplacement = [\"0.04*t\", -2e-5]\n\
             [[contact]]\non = \"{name}_bottom\"\nwith = \"rail_top\"\ngeometry = \"updated\"\n\
             normal = {{ law = \"signorini\" }}\nfriction = {{ law = \"coulomb\", coefficient = 0.01 }}\n\
             wear = {{ law = \"archard\", coefficient = 1e-10, fraction = 0 }}\n"
        )
    };
    let text = format!(
        "name = \"pins\"\n[mesh]\nkind = \"blocks\"\nblocks = [{{ name = \"rail\", size = [0.14, 0.02], n = [31, 2] }}, \
         {first}, {second}]\n[time]\nend = 1.0\nsteps = 40\n[material]\ndensity = 0\n\
         elasticity = {{ law = \"isotropic\", young = 1e9, poisson = 0, stress_state = \"plane-strain\" }}\n\
         [[boundary]]\non = \"rail_bottom\"\ndisplacement = [0, 0]\n{}{}",
        contact("first"),
        contact("second")
    );
    let (memory, summary) = run(&text);
    let last = &memory.states[40].surface.worn;
    assert_eq!(last.depths.len(), 1, "one side wears");
    let contact = summary.last.contact.expect("contact");
    let [first, second] = ["first_bottom", "second_bottom"].map(|side| &contact.sides[side]);
    // The track of the first is 0.6 MPa · 1e-10/Pa · 20 mm = 1.2 µm deep, 6 % of 20 µm.
    let ratio = second.force[1] / first.force[1];
    assert!((0.88..0.97).contains(&ratio), "{ratio}");
    let volume = first.wear_volume + second.wear_volume;
    let mesh = case::parse(&Source::new("wear.toml", text), &[]).expect("a case").problem;
    let discrete = amontons::discretization::Discretization::new(&mesh);
    let held: f64 = discrete.worn.of_side("rail_top", &last.depths).expect("a side").map(|(area, h)| area * h).sum();
    assert!((held / volume - 1.0).abs() < 1e-12, "{held:e} of {volume:e}");
}

/// A column of height 1 with ν = 0 on a belt of the speed v, without friction: with the layer p = c r + d ṙ and the
/// depth h of the wear, E (δ − r − h) = p and ḣ = κ p v in each step; the rate is that of the penetration, which the
/// wear makes smaller. Each step takes a few iterations, however stiff the layer.
#[test]
fn a_damped_layer_wears_as_its_equations_say() {
    let (young, c, v, kappa, k) = (100.0, 1e4, 0.1, 5e-3, 0.1);
    for d in [0.0, 1e3, 1e5] {
        for dim in [2, 3] {
            let (size, n, top, belt) = if dim == 2 {
                ("[1.0, 1.0]", "[3, 3]", "[\"free\", \"-0.01*min(1, t/0.1)\"]", "[-0.1, 0]")
            } else {
                ("[1.0, 1.0, 1.0]", "[2, 2, 2]", "[\"free\", \"-0.01*min(1, t/0.1)\", \"free\"]", "[-0.06, 0, 0.08]")
            };
            let (kind, free) = if dim == 2 { ("rectangle", "") } else { ("box", "") };
            let sides = if dim == 2 {
                "[[boundary]]\non = \"left\"\ndisplacement = [0, \"free\"]\n"
            } else {
                "[[boundary]]\non = \"left\"\ndisplacement = [0, \"free\", \"free\"]\n\
                 [[boundary]]\non = \"back\"\ndisplacement = [\"free\", \"free\", 0]\n"
            };
            let state = if dim == 2 { ", stress_state = \"plane-strain\"" } else { free };
            let text = format!(
                "name = \"layer\"\nunits = \"dimensionless\"\n[mesh]\nkind = \"{kind}\"\nsize = {size}\nn = {n}\n\
                 [time]\nend = 0.5\nsteps = 5\n[material]\ndensity = 0\n\
                 elasticity = {{ law = \"isotropic\", young = {young:?}, poisson = 0.0{state} }}\n\
                 [[boundary]]\non = \"top\"\ndisplacement = {top}\n{sides}[contact]\non = \"bottom\"\n\
                 normal = {{ law = \"damped\", stiffness = {c:?}, damping = {d:?} }}\n\
                 foundation_velocity = {belt}\nwear = {{ law = \"archard\", coefficient = {kappa:?} }}\n"
            );
            let (memory, _) = run(&text);
            let [mut r, mut h] = [0.0; 2];
            for report in &memory.reports {
                // (c + d/k) r − d/k r₋ = p, r = δ − h₋ − k κ v p − p/E.
                let stiff = c + d / k;
                let p = (stiff * (0.01 - h) - d / k * r) / (1.0 + stiff * (k * kappa * v + 1.0 / young));
                h += k * kappa * v * p;
                r = 0.01 - h - p / young;
                for state in &report.contact.states {
                    assert!((state.pressure / p - 1.0).abs() < 1e-9, "d = {d}, {dim}: {} for {p}", state.pressure);
                    assert!((state.penetration - r).abs() < 1e-9 * 0.01, "d = {d}, {dim}: {}", state.penetration);
                }
                assert!(report.newton_mechanics <= 5 && report.parts == 1, "{} iterations", report.newton_mechanics);
            }
        }
    }
}
