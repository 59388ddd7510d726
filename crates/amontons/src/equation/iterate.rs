//! An iterate of the mechanical half-step: a velocity with its terms of (4.1).

use std::borrow::Cow;

use super::given::Given;
use super::system::Step;
use crate::discretization::Warmed;
use crate::inclusion::{Multipliers, Undetermined};
use crate::linalg::{copy, map, zeros};
use crate::state::Rigid;

/// A velocity with its terms of (4.1), or with those of the previous state. It excludes the rigid motions if they are
/// split off.
#[derive(Default)]
pub(crate) struct Iterate<'a> {
    pub w: Vec<f64>,
    pub rigid: Vec<Rigid>,
    pub multipliers: Multipliers,
    pub mass_w: Cow<'a, [f64]>,
    pub a_u: Cow<'a, [f64]>,
    pub a_w: Cow<'a, [f64]>,
    pub b_w: Cow<'a, [f64]>,
    /// Σ ∫ 𝓖ε(z):ε(·) of the relaxing branches; empty without branches.
    pub relaxing: Vec<f64>,
    /// Springs that hold undetermined rigid motions.
    pub hold: Hold,
}

/// Undetermined rigid motions and the springs that hold them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hold {
    pub loose: Vec<Undetermined>,
    /// The forces of the springs over all degrees of freedom, N; empty if there are none.
    pub forces: Vec<f64>,
}

impl Hold {
    /// Interpolates to another one: the fraction α of the way.
    pub fn towards(&self, other: &Hold, alpha: f64) -> Hold {
        let before = self.forces.iter().copied().chain(std::iter::repeat(0.0));
        let forces = other.forces.iter().zip(before).map(|(new, old)| old + alpha * (new - old)).collect();
        Hold { loose: other.loose.clone(), forces }
    }
}

impl Iterate<'_> {
    /// The iterate at a velocity, with its M w, a(u, ·), a(w, ·) and b(w, ·).
    pub fn new(step: &Step, w: Vec<f64>, multipliers: Multipliers, products: [Vec<f64>; 4]) -> Self {
        let [mass_w, a_u, a_w, b_w] = products.map(Cow::Owned);
        let relaxing = step.relaxing(&w);
        Iterate { relaxing, w, rigid: Vec::new(), multipliers, mass_w, a_u, a_w, b_w, hold: Hold::default() }
    }
}

/// Data of the contact points and the iterate at the start of a half-step: at w_{n−1}, and at (u_D(t_n) − ū)/σ if the
/// displacement is prescribed.
pub(crate) fn begun<'a>(step: &Step<'a>, warmed: &Warmed) -> (Given, Iterate<'a>) {
    let Step { discrete, old, bar, products, t, rule, .. } = *step;
    let mut w = copy(&old.w);
    let replacing = step.replacing(|inputs| &inputs.displacements);
    let changes = discrete.v.prescribe_rates([t, rule.span], &replacing, bar.u, &mut w);
    let given = Given::new(step, &w);
    let mut multipliers = old.multipliers.clone();
    // A point that no longer faces the other body has lost contact.
    for (i, _) in step.boundary.points.iter().enumerate().filter(|(_, point)| point.weight == 0.0) {
        (multipliers.p[i], multipliers.q[i]) = (0.0, [0.0; 3]);
    }
    let rigid = step.take(&mut w);
    let now = if step.apart.is_some() {
        let products = products_apart(step, [&step.deformed(&w), &w], &rigid, warmed);
        Iterate { rigid, ..Iterate::new(step, w, multipliers, products) }
    } else if discrete.is_linear() && !changes && rule.is_of_one_step() {
        // a(ū + γ w̄, ·) is obtained without another product.
        let a_u = Cow::Owned(map([&products.a_u, &products.a_w], |[a_u, a_w]| a_u + rule.gamma * a_w));
        let [mass_w, a_w, b_w] = [&products.mass_w, &products.a_w, &products.b_w].map(|v| Cow::Borrowed(&**v));
        let relaxing = step.relaxing(&w);
        Iterate { relaxing, w, rigid, multipliers, mass_w, a_u, a_w, b_w, hold: Hold::default() }
    } else {
        let products = discrete.mechanical_products(&step.deformed(&w), &step.rates(&w), warmed);
        Iterate::new(step, w, multipliers, products)
    };
    (given, now)
}

/// M w, a(d, ·), a(v, ·) and b(v, ·) if rigid motions W are split off: w = W + v.
pub(crate) fn products_apart(step: &Step, [d, v]: [&[f64]; 2], rigid: &[Rigid], warmed: &Warmed) -> [Vec<f64>; 4] {
    let mut products = step.discrete.mechanical_products(d, &step.rates(v), warmed);
    let whole = step.with_rigid(rigid, &zeros(v.len()));
    let inertia = step.discrete.inertia().1.apply(&step.rates(&whole));
    products[0].iter_mut().zip(&inertia).for_each(|(sum, term)| *sum += term);
    products
}
