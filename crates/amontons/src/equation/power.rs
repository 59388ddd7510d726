//! Powers of the terms of (4.1) in a step, for the audit of energy.

use super::system::Step;
use crate::linalg::sum_block;
use crate::time::Start;

/// Products of the vectors of the mechanical half-step, summed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Powers {
    /// w·M w at the end of the step, and the same product of the change of w in the step; of a step that adds to two
    /// states w·M (w − w̄), of one from an admissible velocity (w₁ − w₀)·M (w̄ − w₀).
    pub kinetic: f64,
    pub inertial: f64,
    /// b(w, w).
    pub viscous: f64,
    /// Powers of m(θ, ·) and of the load.
    pub thermal: f64,
    pub load: f64,
    /// a(u, u) at the end of the step, and the same product of the change of u in the step, zero if a is not linear; of
    /// a step that adds to two states a(u, w).
    pub elastic: f64,
    pub strained: f64,
}

/// Blocks of the vectors that [`Powers`] are sums of, from an entry on.
pub(crate) struct PowerTerms<'a> {
    pub first: usize,
    /// The displacement that determines the strains, the velocity, and its part that determines the strain rates.
    pub u: &'a [f64],
    pub w: &'a [f64],
    pub v: &'a [f64],
    pub mass_w: &'a [f64],
    pub a_u: &'a [f64],
    pub b_w: &'a [f64],
    pub thermal: &'a [f64],
    pub load: &'a [f64],
}

impl Powers {
    /// The sums over a block. The sums of all blocks are passed to [`Powers::new`].
    pub fn of_block(step: &Step, of: &PowerTerms) -> [f64; 7] {
        let Step { discrete, old, products, bar, rule, .. } = *step;
        let PowerTerms { first, u, w, v, mass_w, a_u, b_w, thermal, load } = *of;
        let is_of_one_step = rule.is_of_one_step();
        let before: [&[f64]; 2] = if is_of_one_step { [&old.w, &products.mass_w] } else { [bar.w, bar.mass_w] };
        let [w_old, mass_old] = before.map(|v| &v[first..first + w.len()]);
        let [kinetic, inertial, viscous, thermal, load] =
            sum_block([w, w_old, v, mass_w, mass_old, b_w, thermal, load], |entries| {
                let [w, w_old, v, mass_w, mass_old, b_w, thermal, load] = entries;
                let (w_end, mass_end) = (rule.end([w_old, w]), rule.end([mass_old, mass_w]));
                let change = if is_of_one_step { w_end - w_old } else { w } * (mass_end - mass_old);
                [w_end * mass_end, change, v * b_w, v * thermal, w * load]
            });
        let [kinetic, inertial] = match rule.start {
            Start::State | Start::TwoStates => [kinetic, inertial],
            Start::Admissible => Powers::from_admissible(step, first, [w, mass_w]),
        };
        let [elastic, strained] = if !is_of_one_step {
            sum_block([u, v, a_u], |[u, v, a_u]| [u * a_u, v * a_u])
        } else if discrete.is_linear() {
            let [u_old, a_old] = [step.deformation_before(), &products.a_u].map(|v| &v[first..first + u.len()]);
            sum_block([u, u_old, a_u, a_old], |[u, u_old, a_u, a_old]| {
                let (u, a_u) = (rule.end([u_old, u]), rule.end([a_old, a_u]));
                [u * a_u, (u - u_old) * (a_u - a_old)]
            })
        } else {
            [0.0; 2]
        };
        [kinetic, inertial, viscous, thermal, load, elastic, strained]
    }

    /// w₁·M w₁ and (w₁ − w₀)·M (w̄ − w₀) over a block, of a step from an admissible velocity w̄.
    fn from_admissible(step: &Step, first: usize, [w, mass_w]: [&[f64]; 2]) -> [f64; 2] {
        let Step { old, products, bar, rule, .. } = *step;
        let before = [&old.w, &products.mass_w, bar.w, bar.mass_w].map(|v| &v[first..first + w.len()]);
        let [w_old, mass_old, w_bar, mass_bar] = before;
        sum_block([w, mass_w, w_old, mass_old, w_bar, mass_bar], |[w, mass_w, w_old, mass_old, w_bar, mass_bar]| {
            let w_end = rule.end_velocity([w_old, w_bar, w]);
            [w_end * rule.end_velocity([mass_old, mass_bar, mass_w]), (w_end - w_old) * (mass_bar - mass_old)]
        })
    }

    pub fn new([kinetic, inertial, viscous, thermal, load, elastic, strained]: [f64; 7]) -> Powers {
        Powers { kinetic, inertial, viscous, thermal, load, elastic, strained }
    }
}
