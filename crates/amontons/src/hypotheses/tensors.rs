//! (H3)–(H5): the tensors of the material.

use super::laws::{ROUND_OFF, attained, norm};
use super::{Finding, FindingId, FindingStatus};
use crate::problem::{MaterialSample, Problem};
use crate::tensor::Sym;

/// (H3): 𝓚 is positive definite.
pub(super) fn conductivity(problem: &Problem, values: &[MaterialSample<Sym>]) -> Finding {
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
pub(super) fn bounded(
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
