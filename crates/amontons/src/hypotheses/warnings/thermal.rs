//! `thermal-layer`: compares the penetration depth of heat from Γ_C with the size of a cell.

use super::super::sample::at;
use super::super::{Finding, FindingId};
use super::warning;
use crate::model::thermal_layers;
use crate::problem::Problem;
use crate::units::Measure;

/// Fraction of the steps in which the layer may be thinner than a cell.
const SHARE: f64 = 0.1;

/// `thermal-layer`: heat that enters through Γ_C reaches the depth √(t K/c) in the time t. As long as that is less than
/// a cell, linear functions cannot represent the layer: the surface is too cold, and nodes below it undershoot. Warns
/// if this is so in more than a tenth of the steps.
pub(super) fn layer(problem: &Problem) -> Option<Finding> {
    let layers = thermal_layers(problem);
    let layer = layers.into_iter().max_by(|a, b| (a.cell / a.end).total_cmp(&(b.cell / b.end)))?;
    // The layer is as deep as a cell after n = (h/δ)² steps.
    let unresolved = if problem.timeline.is_equal() {
        (layer.cell / layer.step).powi(2)
    } else {
        let until = (layer.cell / layer.end).powi(2) * problem.timeline.end();
        problem.timeline.instants().take_while(|now| now.t < until).count() as f64
    };
    if unresolved <= SHARE * problem.timeline.steps() as f64 {
        return None;
    }
    let length = |value: f64| problem.units().write(value, Measure::Length);
    let message = format!(
        "heat penetrates √(t K/c) = {} in a step and {} in the whole run, and the cells of \"{}\" are {} high: the layer is {:.3} times thinner \
         than the cell at {} after a step, and thinner than it in {:.0} of {} steps",
        length(layer.step),
        length(layer.end),
        layer.side,
        length(layer.cell),
        layer.cell / layer.step,
        at(&layer.x),
        unresolved.min(problem.timeline.steps() as f64).ceil(),
        problem.timeline.steps()
    );
    let needed = layer.end * SHARE.sqrt();
    let repair = format!(
        "use cells of at most {} along the normal next to \"{}\"; until then do not trust temperatures and heat of the contact",
        length(needed),
        layer.side
    );
    Some(warning(FindingId::ThermalLayer, "mesh", [layer.cell, needed], message, repair))
}
