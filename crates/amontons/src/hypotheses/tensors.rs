//! (H1)–(H5): the operators and tensors of the material.
//!
//! Constants of linear operators are eigenvalues. The declared constants of a nonlinear law cannot be proved by samples
//! but can be refuted: two arguments that contradict a declared constant make the hypothesis fail.

use super::sample::{PAIRS, PLACES, SLACK, Samples, at, attained, some};
use super::{Constants, Finding, FindingId, FindingStatus};
use crate::arrays::all_at_once;
use crate::field::{Coefficient, Law};
use crate::material::{Material, OperatorConstants, TensorLaw};
use crate::problem::{MaterialSample, Problem};
use crate::tensor::{Point, Sym, mandel_len};

/// Fraction of the largest eigenvalue that counts as zero.
const ROUND_OFF: f64 = 1e-14;

/// The letters of an operator and of its constants, and the place of its key.
#[derive(Clone, Copy)]
struct OperatorNames {
    name: &'static str,
    monotonicity: &'static str,
    lipschitz: &'static str,
    place: &'static str,
}

const VISCOSITY: OperatorNames =
    OperatorNames { name: "𝓥", monotonicity: "m_b", lipschitz: "M_b", place: "material.viscosity" };
const ELASTICITY: OperatorNames =
    OperatorNames { name: "𝓔", monotonicity: "m_a", lipschitz: "M_a", place: "material.elasticity" };

/// (H1)–(H5).
pub(super) fn material(problem: &Problem, constants: &Constants) -> Vec<Finding> {
    let names = &problem.mesh.regions;
    let each = (0..problem.materials.len()).map(|region| {
        let mut findings = of_material(problem, region, constants);
        if problem.materials.len() > 1 {
            for finding in &mut findings {
                finding.place = format!("{} of region {}", finding.place, names.get(region).map_or("", String::as_str));
            }
        }
        findings
    });
    let worst = |worst: Vec<Finding>, found: Vec<Finding>| {
        worst
            .into_iter()
            .zip(found)
            .map(|(worst, found)| if is_worse(&found, &worst) { found } else { worst })
            .collect()
    };
    each.reduce(worst).unwrap_or_default()
}

/// True if a finding on a material represents the body instead of another finding: it has the worse status or, if
/// equal, the worse constant, which is a lower bound in (H1)–(H3) and an upper one in (H4), (H5).
fn is_worse(found: &Finding, other: &Finding) -> bool {
    let upper = matches!(found.id, FindingId::H4 | FindingId::H5);
    let by_value = if upper { found.value > other.value } else { found.value < other.value };
    found.status > other.status || (found.status == other.status && by_value)
}

/// (H1)–(H5) of the material of a region.
fn of_material(problem: &Problem, region: usize, constants: &Constants) -> Vec<Finding> {
    let Some(material) = problem.materials.get(region) else { return Vec::new() };
    let (m, e) = (constants.bound_m, constants.bound_e);
    let expansion = problem.values_in(region, |m| &m.expansion);
    let coupling = problem.values_in(region, |m| &m.coupling);
    let of_law = |law: &Law<dyn TensorLaw>, id: FindingId, names: OperatorNames| {
        warm(operator(problem, law, id, names), law.temperatures())
    };
    let conductivity = conductivity(problem, &problem.values_in(region, |m| &m.conductivity));
    let expansion = bounded(problem, &expansion, m, FindingId::H4, ["𝓜", "M_m", "material.expansion"]);
    vec![
        of_law(&material.viscosity, FindingId::H1, VISCOSITY),
        of_law(&material.elasticity, FindingId::H2, ELASTICITY),
        warm(conductivity, material.conductivity.temperatures()),
        warm(expansion, material.expansion.temperatures()),
        bounded(problem, &coupling, e, FindingId::H5, ["𝓡", "M_e", "material.coupling"]),
    ]
}

/// The norm of the part of a tensor that acts on strains of 𝕊^d.
pub(super) fn norm(tensor: &Sym, dim: usize) -> f64 {
    tensor.0[..mandel_len(dim)].iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The largest norm of a tensor of the materials.
pub(super) fn largest_norm(problem: &Problem, of: fn(&Material) -> &Coefficient<Sym>) -> f64 {
    let dim = problem.mesh.tensor_dim();
    problem.values_of(of).iter().map(|sample| norm(&sample.value, dim)).fold(0.0, f64::max)
}

/// The finding on a datum tabulated over the temperature: the hypotheses do not admit such data, and its constants are
/// bounds over the range of the table.
fn warm(finding: Finding, temperatures: &[f64]) -> Finding {
    let (Some(first), Some(last)) = (temperatures.first(), temperatures.last()) else { return finding };
    let status = finding.status.max(FindingStatus::NotCovered);
    let message = format!(
        "{}; it depends on the temperature, which ({}) does not admit: these are bounds for θ from {first:?} to {last:?}",
        finding.message, finding.id
    );
    Finding { status, message, ..finding }
}

/// (H1), (H2): strongly monotone, Lipschitz and zero at zero.
fn operator(problem: &Problem, law: &Law<dyn TensorLaw>, id: FindingId, names: OperatorNames) -> Finding {
    let OperatorNames { name, monotonicity: m, lipschitz: upper, place } = names;
    let c = law.constants();
    let (least, lipschitz) = (c.monotonicity, c.lipschitz);
    let [at_least, at_most] = law
        .graded()
        .map_or_else(|| [String::new(), String::new()], |law| law.extremes().map(|i| attained(Some(i.x), i.theta)));
    // Round-off of an eigenvalue is relative to the largest one.
    let positive = least > ROUND_OFF * lipschitz;
    let (status, message) = if id == FindingId::H1 && lipschitz == 0.0 {
        (
            FindingStatus::NotCovered,
            format!("the material has no viscosity: {m} = 0, and the theory asks for a positive number"),
        )
    } else if !lipschitz.is_finite() {
        (
            FindingStatus::Fails,
            format!("{name} is not Lipschitz: {upper} = {lipschitz:.6e}{at_most}, expected a finite number"),
        )
    } else if !positive {
        (
            FindingStatus::Fails,
            format!("{name} is not strongly monotone: {m} = {least:.6e}{at_least}, expected a positive number"),
        )
    } else if let Some(contradiction) = refuted(problem, law, c, m, upper) {
        (FindingStatus::Fails, format!("{name} violates the constants that it declares: {contradiction}"))
    } else {
        let how = if law.is_linear() { "eigenvalues" } else { "declared, not refuted by samples" };
        (
            FindingStatus::Holds,
            format!(
                "{name} is strongly monotone with {m} = {least:.6e}{at_least} and Lipschitz with {upper} = {lipschitz:.6e}{at_most} ({how}); it vanishes at zero"
            ),
        )
    };
    let repair = if id == FindingId::H1 {
        "give the material some viscosity, with both eigenvalues positive"
    } else {
        "give the law a positive stiffness in every direction"
    };
    let value = if positive { least } else { least.min(0.0) };
    Finding::new(id, status, message, place).numbers(Some(value), Some(0.0)).repair(repair)
}

/// Reason why a law has no Lipschitz constant, as far as samples show; Theorem 1 requires no other property of 𝓔.
pub(super) fn not_lipschitz(problem: &Problem, law: &Law<dyn TensorLaw>, upper: &str) -> Option<String> {
    let lipschitz = law.constants().lipschitz;
    if !lipschitz.is_finite() {
        return Some(format!("{upper} = {lipschitz:.6e}"));
    }
    // −M is a lower bound of monotonicity that every law with the Lipschitz constant M satisfies.
    refuted(problem, law, OperatorConstants { monotonicity: -lipschitz, lipschitz }, "m", upper)
}

/// Two arguments that contradict the constants of a law, or a nonzero value at zero.
fn refuted(
    problem: &Problem,
    law: &Law<dyn TensorLaw>,
    constants: OperatorConstants,
    m: &str,
    upper: &str,
) -> Option<String> {
    let dim = problem.mesh.tensor_dim();
    let mut random = Samples::default();
    // Only the d-dimensional part does work, and the constants refer to it.
    let value = |x: &Point, xi: &Sym| {
        let mut value = law.value(x, xi);
        value.0[mandel_len(dim)..].fill(0.0);
        value
    };
    let mut arguments = Vec::new();
    for x in some(&problem.mesh.points, PLACES) {
        for _ in 0..if law.is_linear() { 4 } else { PAIRS } {
            let (a, size) = (random.spread(1.0, 8.0).abs(), random.spread(1.0, 8.0).abs());
            let a = random.sym(dim, a);
            arguments.push((x, a, a + random.sym(dim, size)));
        }
    }
    let arrays: Vec<_> = law.arrays().iter().collect();
    let values: Vec<[Sym; 3]> = all_at_once(&arrays, || {
        arguments.iter().map(|(x, a, b)| [value(x, &Sym::ZERO), value(x, a), value(x, b)]).collect()
    });
    for ((x, a, b), [zero, at_a, at_b]) in arguments.into_iter().zip(values) {
        let zero = zero.norm();
        if zero != 0.0 {
            return Some(format!("its value at zero has the norm {zero:.3e}, expected zero, at {}", at(x)));
        }
        let difference = a - b;
        let (squared, change) = (difference.dot(&difference), at_a - at_b);
        // Round-off of the two values is independent of their difference.
        let noise = 8.0 * f64::EPSILON * constants.lipschitz * (a.norm() + b.norm());
        let (work, length) = (change.dot(&difference), change.norm());
        if work < constants.monotonicity * squared * (1.0 - SLACK) - noise * difference.norm() {
            return Some(format!(
                "{m} = {:.6e}, but two arguments give {:.6e} at {}",
                constants.monotonicity,
                work / squared,
                at(x)
            ));
        }
        if length > constants.lipschitz * difference.norm() * (1.0 + SLACK) + noise || length.is_nan() {
            return Some(format!(
                "{upper} = {:.6e}, but two arguments give {:.6e} at {}",
                constants.lipschitz,
                length / difference.norm(),
                at(x)
            ));
        }
    }
    None
}

/// (H3): 𝓚 is positive definite.
fn conductivity(problem: &Problem, values: &[MaterialSample<Sym>]) -> Finding {
    let eigenvalues = |sample: &MaterialSample<Sym>| sample.value.eigenvalues(problem.mesh.dim);
    let least_of = |sample: &MaterialSample<Sym>| eigenvalues(sample).first().copied().unwrap_or(0.0);
    let worst = values.iter().min_by(|a, b| least_of(a).total_cmp(&least_of(b)));
    let all = worst.map_or_else(Vec::new, eigenvalues);
    let (least, largest) = (all.first().copied().unwrap_or(0.0), all.last().copied().unwrap_or(0.0));
    let positive = least > ROUND_OFF * largest.abs();
    let list = all.iter().map(|e| format!("{:.6}", if positive { *e } else { e + 0.0 })).collect::<Vec<_>>().join(", ");
    let place = worst.and_then(|sample| Some(attained(Some(sample.x?), sample.theta)));
    let place = place.map(|place| format!(", the least over the body,{place}")).unwrap_or_default();
    let message = if positive {
        format!("𝓚 has the eigenvalues {list}{place}")
    } else {
        format!(
            "𝓚 has the eigenvalues {list}{place}: it is not positive definite, heat flows in some directions only and the result depends on the mesh"
        )
    };
    let value = if positive { least } else { least.max(0.0) };
    Finding::new(FindingId::H3, FindingStatus::of(positive), message, "material.conductivity")
        .numbers(Some(value), Some(0.0))
        .repair("a positive definite matrix, such as a multiple of the identity")
}

/// (H4), (H5): symmetric and bounded. |∫ θ 𝓜:ε(v)| ≤ ‖𝓜‖ ‖θ‖ ‖ε(v)‖, and ‖θ‖ ≤ √(1 − c_f²)/c_f ‖∇θ‖.
fn bounded(
    problem: &Problem,
    values: &[MaterialSample<Sym>],
    bound: Option<f64>,
    id: FindingId,
    [name, upper, place]: [&str; 3],
) -> Finding {
    let norms = values.iter().map(|sample| (norm(&sample.value, problem.mesh.tensor_dim()), sample.x, sample.theta));
    let (norm, x, theta) = norms.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, None, None));
    let at_most = attained(x, theta);
    let message = match bound {
        _ if !norm.is_finite() => format!("{name} is not bounded: ‖{name}‖ = {norm:.6e}{at_most}"),
        Some(bound) => {
            format!(
                "{name} is symmetric and bounded: ‖{name}‖ = {norm:.6e}{at_most}, so {upper} = {bound:.6e} by (2.13)"
            )
        }
        None => format!(
            "{name} is symmetric and bounded: ‖{name}‖ = {norm:.6e}{at_most}, so its form is bounded by ‖{name}‖ ‖θ‖ ‖ε(v)‖"
        ),
    };
    Finding::new(id, FindingStatus::of(norm.is_finite()), message, place).numbers(bound.or(Some(norm)), None)
}
