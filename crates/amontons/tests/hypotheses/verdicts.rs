//! Verdicts of the certificate against runs and the theorems' own words: contact that occurs or cannot, models that a
//! theorem speaks of.
#![allow(clippy::too_many_lines, clippy::too_many_arguments, reason = "a test is one list of cases")]

use crate::common::paper;
use amontons::case::{self, Source};
use amontons::hypotheses::{Certificate, Finding, advice, findings, full};
use amontons::problem::Problem;
use amontons::step::{March, Scheme};

fn find(problem: &Problem, id: &str) -> Finding {
    full(problem).findings.into_iter().find(|f| f.id.as_str() == id).unwrap_or_else(|| panic!("no finding {id}"))
}

/// The body of the paper without heat and with little load, held at its top, over a foundation that it need not reach.
fn over_a_gap(overrides: &[&str]) -> Problem {
    let common = [
        "mesh.n=8",
        "time.steps=16",
        "material.expansion=0",
        "material.coupling=0",
        "load.body_force=[0, -0.001]",
        "load.heat_source=0",
        "boundary=[{on='top', displacement=[0, 0], temperature=0}, {on='left', temperature=0}, {on='right', temperature=0}]",
    ];
    paper(&[&common, overrides].concat()).problem
}

/// Largest force of contact and largest |θ| over a run, and the largest u_ν of a side.
fn effect(problem: &Problem) -> [f64; 3] {
    let mut scheme = March::new(problem).expect("a regular system");
    let mut state = scheme.initial().expect("finite initial data");
    let mut largest = [0.0, 0.0, f64::NEG_INFINITY];
    for _ in 0..problem.timeline.steps() {
        let (next, report) = scheme.step(&state).expect("a step");
        for point in &report.contact.states {
            largest[0] = point.q.iter().fold(point.pressure.abs(), |m: f64, q| m.max(q.abs())).max(largest[0]);
        }
        largest[1] = next.theta.iter().fold(largest[1], |m, t| m.max(t.abs()));
        for point in &scheme.discretization().boundary.points {
            for &(node, value) in &point.nodes {
                let dof = 2 * scheme.discretization().boundary.nodes[node] as usize;
                let u_nu = value * (point.normal[0] * next.u[dof] + point.normal[1] * next.u[dof + 1]);
                largest[2] = u_nu.max(largest[2]);
            }
        }
        state = next;
    }
    largest
}

/// `time-step` is the same whether `step-unique` is at hand or not: where that holds, fails, and where there is no
/// contact.
#[test]
fn the_number_of_steps_does_not_depend_on_what_is_known() {
    let cases: [(&[&str], &str); 3] =
        [(&["time.steps=64"], "holds"), (&["time.steps=4"], "fails"), (&["contact=[]"], "holds")];
    for (overrides, status) in cases {
        let problem = paper(&[&["mesh.n=8"], overrides].concat()).problem;
        let known = full(&problem);
        let told = |id: &str| known.findings.iter().find(|f| f.id.as_str() == id).expect("a finding");
        assert_eq!(told("step-unique").status.as_str(), status, "{overrides:?}");
        let unknown = Certificate { findings: Vec::new(), ..known.clone() };
        assert_eq!(advice(&problem, &unknown).first(), Some(told("time-step")), "{overrides:?}");
    }
}

/// Seven kinds of data with which contact, or heat through an open gap, does occur where a bound of u_ν stays below the
/// gap.
#[test]
fn contact_is_not_called_impossible_where_it_occurs() {
    let none = "heat={law='none'}";
    let coulomb = "friction={law='coulomb', coefficient=0.2}";
    let soft = "normal={law='compliance', stiffness=1e3}";
    let contact = |gap: f64, laws: &[&str]| format!("contact={{on='bottom', gap={gap:?}, {}}}", laws.join(", "));
    let tractions = "boundary=[{on='top', displacement=[0, 0], temperature=0}, {on='left', traction=[0.01, 0], temperature=0}, {on='right', temperature=0}]";
    let cases: Vec<(&str, Vec<String>)> = vec![
        ("bilateral", vec![contact(0.05, &["normal={law='bilateral'}", none])]),
        ("tresca", vec![contact(1.0, &[soft, "friction={law='tresca', bound=1.0}", none]), tractions.to_owned()]),
        (
            "adhesion",
            vec![contact(0.01, &["normal={law='adhesion', stiffness=1e3, strength=20.0, release=0.01}", none])],
        ),
        (
            "gap",
            vec![
                contact(
                    0.01,
                    &[
                        soft,
                        coulomb,
                        "heat={law='gap', conductivity=1.0, roughness=0.01, foundation_temperature=1000.0}",
                    ],
                ),
                "material.expansion=1".to_owned(),
            ],
        ),
        (
            "radiation",
            vec![
                contact(
                    0.01,
                    &[
                        soft,
                        coulomb,
                        "heat={law='radiation', emissivity=1.0, constant=1.0, absolute_zero=0.0, foundation_temperature=10.0}",
                    ],
                ),
                "material.expansion=1".to_owned(),
            ],
        ),
    ];
    for (name, overrides) in cases {
        let problem = over_a_gap(&overrides.iter().map(String::as_str).collect::<Vec<_>>());
        let verdict = find(&problem, "contact-possible");
        let [force, theta, _] = effect(&problem);
        assert!(force > 0.0 || theta > 0.0, "{name}: the case shows nothing");
        assert_eq!(verdict.status.as_str(), "not-covered", "{name}: {}", verdict.message);
        assert!(verdict.place.starts_with("contact."), "{name}: {}", verdict.place);
    }
    // The hoop part of 𝓜 alone.
    let hoop = over_a_gap(&[
        "mesh={kind='rectangle', size=[1.0, 1.0], origin=[1.0, 0.0], n=8, axisymmetric=true}",
        "time.steps=64",
        "material.elasticity={law='isotropic', young=2.0, poisson=0.1}",
        "material.conductivity=1",
        "material.viscosity={law='lame', first=1, second=1}",
        "material.expansion=[[0, 0, 0], [0, 0, 0], [0, 0, 5]]",
        "load.heat_source=10",
        "boundary=[{on='top', displacement=[0, 0], temperature=0}, {on='bottom', normal_displacement=0}]",
        &format!("contact={{on='right', gap=0.01, {soft}, {coulomb}, {none}}}"),
    ]);
    assert!(effect(&hoop)[0] > 1.0 && !find(&hoop, "contact-possible").fails());
    // A body nearly incompressible that locks with the full strain and sags with its mean.
    let mean = |gap: f64| {
        over_a_gap(&[
            "mesh={kind='rectangle', size=[4.0, 1.0], n=[16, 4], elements='Q1'}",
            "time.end=20",
            "time.steps=40",
            "material.density=1e-6",
            "material.elasticity={law='isotropic', young=1.0, poisson=0.49999, stress_state='plane-strain'}",
            "material.dilatation='mean'",
            "material.viscosity={law='lame', first=1, second=1}",
            "boundary=[{on='left', displacement=[0, 0], temperature=0}]",
            &format!("contact={{on='bottom', gap={gap:?}, {soft}, {coulomb}, {none}}}"),
        ])
    };
    assert!(effect(&mean(0.2))[0] > 0.0 && find(&mean(0.2), "contact-possible").holds());
    let bound = find(&mean(1e3), "contact-possible");
    assert!(bound.fails() && bound.value.expect("a bound") >= effect(&mean(1e3))[2]);
}

/// Where it is said that contact cannot occur it does not, with the gap next to the bound: springs, dashpots, loads
/// that vary, revolution.
#[test]
fn where_contact_is_called_impossible_it_does_not_occur() {
    let laws = "normal={law='compliance', stiffness=1e3}, friction={law='coulomb', coefficient=0.5}, heat={law='none'}";
    let sprung = "boundary=[{on='top', spring=[2, 3], dashpot=[1, 0.5], temperature=0}, {on='left', temperature=0}]";
    let revolution = "mesh={kind='rectangle', size=[1.0, 1.0], n=6, axisymmetric=true}";
    let space = "material.elasticity={law='isotropic', young=2.0, poisson=0.3}";
    let undamped = "material.viscosity={law='lame', first=0, second=0}";
    let scalar = "material.conductivity=1";
    let relaxing = "material.prony=[{ratio=2.0, time=0.2}, {ratio=0.5, time=3}]";
    let cases: [(&[&str], &str); 8] = [
        (&[], "bottom"),
        (&[relaxing], "bottom"),
        (&[relaxing, undamped, "load.body_force=['sin(9*t)', '-5*cos(7*t)']"], "bottom"),
        (&[undamped, "load.body_force=['sin(9*t)', '-5*cos(7*t)']"], "bottom"),
        (&[sprung], "bottom"),
        (&[sprung, undamped, "load.body_force=['sin(9*t)', '-5*cos(7*t)']"], "bottom"),
        (&[revolution, space, scalar], "bottom"),
        (
            &[revolution, space, scalar, "material.expansion=[[0, 0, 0], [0, 0, 0], [0, 0, 5]]", "load.heat_source=3"],
            "right",
        ),
    ];
    for (overrides, side) in cases {
        let with =
            |gap: f64| over_a_gap(&[overrides, &[&format!("contact={{on='{side}', gap={gap:?}, {laws}}}")]].concat());
        let far = find(&with(1e6), "contact-possible");
        assert!(far.fails(), "{overrides:?}: {}", far.message);
        let bound = far.value.expect("a bound");
        let near = with(bound * (1.0 + 1e-9));
        assert!(find(&near, "contact-possible").fails() && find(&with(0.999 * bound), "contact-possible").holds());
        let [force, _, reached] = effect(&near);
        assert!(force == 0.0 && reached <= bound, "{overrides:?}: force {force:e}, u_ν = {reached:e}, bound {bound:e}");
    }
}

/// The condition on the step of a case without heat does not ask for an equation of heat.
#[test]
fn a_case_without_heat_has_a_condition_on_the_step() {
    let text = "name = 'cold'\n[mesh]\nkind = 'rectangle'\nsize = [1.0, 1.0]\nn = 4\n[time]\nend = 1.0\nsteps = 64\n\
        [material]\ndensity = 1.0\nelasticity = { law = 'isotropic', young = 10.0, poisson = 0.3, stress_state = 'plane-strain' }\n\
        viscosity = { law = 'lame', first = 1.0, second = 1.0 }\n\
        [[boundary]]\non = 'top'\ndisplacement = [0, 0]\n\
        [contact]\non = 'bottom'\nnormal = { law = 'compliance', stiffness = 10 }\n\
        friction = { law = 'coulomb', coefficient = 0.1 }\n";
    let problem = case::parse(&Source::new("cold.toml", text), &[]).unwrap_or_else(|error| panic!("{error}")).problem;
    let finding = find(&problem, "time-step");
    assert!(finding.holds(), "{}", finding.message);
}

/// Models and whether Theorem 1 speaks of them.
#[test]
fn the_theorem_is_cited_where_it_speaks_only() {
    let heat = |law: &str| format!("contact.heat={law}");
    let ramp = "law='ramp', conductance=1, width=1e-5, foundation_temperature=0";
    let cases: &[(&[&str], &str)] = &[
        (&[], "holds"),
        (&["material.density=0"], "holds"),
        (&["material.heat_capacity=0"], "holds"),
        (&["material.prony=[{ratio=0.3, time=0.1}]"], "holds"),
        (&["contact.foundation_velocity=['sin(t)', 0]", "contact.gap='0.1*t'"], "holds"),
        (&["contact.friction={law='tresca', bound=2.0}"], "holds"),
        (&["contact.normal={law='adhesion', stiffness=1e3, strength=20.0, release=0.01}"], "holds"),
        (
            &[&heat("{law='radiation', emissivity=1.0, constant=1.0, absolute_zero=-10.0, foundation_temperature=0}")],
            "holds",
        ),
        (&[&heat("{law='gap', conductivity=1.0, roughness=0.1, foundation_temperature=0}")], "holds"),
        (&[&heat("{law='power', coefficient=3, exponent=1, foundation_temperature=0}")], "holds"),
        (&["contact.frictional_heat=0.5"], "not-covered"),
        (
            &["contact.friction={law='temperature', temperature=[0, 10], coefficient=[0.3, 0.2], cap=0.1}"],
            "not-covered",
        ),
        (&["contact.friction={law='slip-rate', speed=[0, 1], coefficient=[0.4, 0.1]}"], "not-covered"),
        (&["contact.wear={law='archard', coefficient=0.02}"], "not-covered"),
        (&["contact.normal={law='damped', stiffness=10, damping=50}"], "not-covered"),
        (&["contact.normal={law='hunt-crossley', stiffness=10, exponent=1, damping=50}"], "not-covered"),
        (&["contact.normal={law='signorini'}"], "not-covered"),
        (&["contact.normal={law='power', stiffness=10, exponent=1.5}"], "not-covered"),
        (&[&heat("{law='pressure', coefficient=1, exponent=0.95, foundation_temperature=0}")], "not-covered"),
        (&["contact.foundation={heat_capacity=1.0, temperature=0}", &heat(&format!("{{{ramp}}}"))], "not-covered"),
        (&["contact.foundation={heat_capacity=1.0, temperature=0}", "contact.friction.coefficient=0"], "holds"),
        (&["material.viscosity={law='lame', first=0, second=0}"], "not-covered"),
        (&["material.conductivity=[[1, 1], [1, 1]]"], "fails"),
    ];
    for (overrides, expected) in cases {
        let found = findings(&paper(&[&["mesh.n=2", "time.steps=4"], *overrides].concat()).problem);
        let needed = found.iter().find(|f| f.id.as_str() == "2.23-needed").expect("the finding");
        assert_eq!(needed.status.as_str(), *expected, "{overrides:?}: {}", needed.message);
    }
    let status = |overrides: &[&str], id: &str| {
        let found = findings(&paper(&[&["mesh.n=2", "time.steps=4"], overrides].concat()).problem);
        found.into_iter().find(|f| f.id.as_str() == id).expect("the finding")
    };
    let temperature = "contact.friction={law='temperature', temperature=[0, 10], coefficient=[0.3, 0.2]}";
    for overrides in [
        [temperature],
        ["contact.wear={law='archard', coefficient=0.02}"],
        ["contact.normal={law='damped', stiffness=10, damping=50}"],
    ] {
        assert_eq!(status(&overrides, "H8").status.as_str(), "not-covered", "{overrides:?}");
    }
    // L_kc is there, M_kc is not.
    let linear = status(&[&heat("{law='power', coefficient=3, exponent=1, foundation_temperature=0}")], "H7");
    assert!(
        linear.fails() && linear.message.contains("L_kc = 3.0") && linear.message.contains("not bounded"),
        "{}",
        linear.message
    );
    // m_a = 0 but for round-off.
    let hencky = status(
        &[
            "material.elasticity={law='hencky', bulk=1.0, shear=1.0, shear_infinite=0.0, strain=0.01, exponent=0.5, stress_state='plane-stress'}",
        ],
        "2.23-needed",
    );
    assert!(hencky.holds(), "{}", hencky.message);
}

/// Friction that sees the temperature below its cap only: a monolithic step is not judged.
#[test]
fn friction_of_the_temperature_is_seen_below_its_cap() {
    for cap in [0.1, 10.0] {
        let problem = paper(&[
            "mesh.n=8",
            "time.steps=16",
            "scheme.coupling='monolithic'",
            "material.expansion=0",
            &format!(
                "contact.friction={{law='temperature', temperature=[0, 10], coefficient=[0.3, 0.2], cap={cap:?}}}"
            ),
            "contact.frictional_heat=0.5",
            "contact.normal.stiffness=1e3",
        ])
        .problem;
        assert_eq!(find(&problem, "step-unique").status.as_str(), "not-covered", "cap {cap}");
    }
}
