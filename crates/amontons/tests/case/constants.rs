//! Numbers with names, which expressions and formulas of a case mention.

use amontons::case::{self, Source};
use amontons::contact::ContactPoint;

const BAR: &str = r#"name = "bar"
[constants]
g0 = 9.81
mu0 = 0.3
spare = 1.0
[mesh]
kind = "interval"
size = 1.0
n = 2
[time]
end = 1.0
steps = 4
[material]
density = 1.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.0 }
[[boundary]]
on = "left"
displacement = [0]
[load]
body_force = ["-g0*(1 + t)"]
[contact]
on = "right"
normal = { law = "expression", pressure = "g0*r" }
friction = { law = "expression", coefficient = "mu0*exp(-v)" }
foundation_velocity = [0, 0, 1]
"#;

spoiled! { BAR
    a_constant_with_the_name_of_a_function: "spare = 1.0" => "sin = 1.0"
        "bar.toml:5:1: constants.sin: found `sin`, expected a name that is no variable, function or constant of expressions";
    a_constant_with_the_name_of_a_variable: "spare = 1.0" => "theta = 1.0"
        "bar.toml:5:1: constants.theta: found `theta`, expected a name that is no variable, function or constant of expressions";
    a_constant_whose_name_is_no_word: "spare = 1.0" => "\"mu-0\" = 1.0"
        "bar.toml:5:1: constants.mu-0: found `mu-0`, expected a name of letters, digits and `_` that begins with a letter";
    a_constant_with_a_unit: "g0 = 9.81" => "g0 = \"9.81 m\""
        "bar.toml:3:6: constants.g0: found \"9.81 m\", expected a number without a unit (numbers with names that expressions and formulas of the case may mention: `[constants]` with `mu0 = 0.4`)";
    a_constant_that_is_not_there: "-g0*" => "-g1*"
        "bar.toml:20:17: load.body_force[0]: found `g1`, expected a variable (x, y, z, t), a constant (pi, e, g0, mu0, spare) or a function; did you mean g0?";
}

/// A case with constants is that with the numbers in their places, and overrides reach them.
#[test]
fn constants_stand_for_their_numbers() {
    let parsed = |text: &str, set: &[&str]| {
        let set: Vec<String> = set.iter().map(|set| (*set).to_owned()).collect();
        case::parse(&Source::new("bar.toml", text), &set).unwrap_or_else(|error| panic!("{error}")).problem
    };
    let with_numbers = |g0: &str| {
        let (head, rest) = BAR.split_once("[constants]").expect("constants");
        let (_, rest) = rest.split_once("[mesh]").expect("a mesh");
        format!("{head}[mesh]{rest}").replace("g0*", &format!("{g0}*")).replace("mu0*", "0.3*")
    };
    for (set, g0) in [(&[][..], "9.81"), (&["constants.g0=2.5"][..], "2.5")] {
        let [named, plain] = [parsed(BAR, set), parsed(&with_numbers(g0), &[])];
        let at = ContactPoint { pressure: 2.0, slip_speed: 0.7, ..ContactPoint::default() };
        let seen = [&named, &plain].map(|problem| {
            let contact = &problem.contacts[0];
            let normal = contact.normal.pressure(&[0.0; 3], 0.4, 0.0, 0.0);
            [problem.body_force[0].value(&[0.5, 0.0, 0.0], 0.3), normal.value, contact.friction.bound(&at).value]
        });
        assert_eq!(seen[0].map(f64::to_bits), seen[1].map(f64::to_bits), "{seen:?}");
    }
    // Two texts that are the same are not the same data if a constant differs.
    assert_ne!(parsed(BAR, &[]).body_force, parsed(BAR, &["constants.g0=2.5"]).body_force);
}
