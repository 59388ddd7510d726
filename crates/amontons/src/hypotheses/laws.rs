//! (H7), (H8): the contact laws.
//!
//! Declared constants of a law cannot be proved by samples but can be refuted: two arguments that contradict a declared
//! constant make the hypothesis fail.

use super::sample::{PAIRS, PLACES, SLACK, Samples, at, attained, diameter, some};
use super::{Constants, Finding, FindingId, FindingStatus};
use crate::arrays::all_at_once;
use crate::contact::{Contact, ContactPoint, GraphKind, arrays};
use crate::problem::Problem;
use crate::tensor::Point;

/// True if pressure or friction changes with time.
fn in_time(contact: &Contact) -> bool {
    contact.normal.at_time(0.0).is_some() || contact.friction.at_time(0.0).is_some()
}

/// L_τ of (H8) for pressure and friction together, and the place where it is attained if laws vary over the side.
pub(super) fn friction_lipschitz(contact: &Contact, points: &[Point]) -> (Option<f64>, Option<Point>) {
    let (normal, friction) = (contact.normal.graded(), contact.friction.graded());
    let whole = || contact.friction.lipschitz(contact.normal.lipschitz());
    if (normal.is_none() && friction.is_none()) || in_time(contact) {
        return (whole(), friction.map(|law| law.extremes()[1].x));
    }
    let of = |x: &Point| {
        let nu = normal.map_or_else(|| contact.normal.lipschitz(), |law| law.at(x).lipschitz());
        friction.map_or_else(|| contact.friction.lipschitz(nu), |law| law.at(x).lipschitz(nu))
    };
    let mut worst: Option<(f64, Point)> = None;
    for x in points {
        let Some(here) = of(x) else { return (None, Some(*x)) };
        if worst.is_none_or(|(most, _)| here > most) {
            worst = Some((here, *x));
        }
    }
    worst.map_or_else(|| (whole(), None), |(most, x)| (Some(most), Some(x)))
}

/// (H7), (H8) and the cut-off of φ_L.
pub(super) fn contact(problem: &Problem, constants: &Constants) -> Vec<Finding> {
    let each = tested(problem).enumerate().map(|(side, test)| {
        let mut findings = vec![exchange(&test, constants), pressure(&test, constants), cut_off(&test)];
        for finding in &mut findings {
            finding.place = finding.place.replacen("contact", &problem.contact_path(side), 1);
        }
        findings
    });
    let worst = |worst: Vec<Finding>, found: Vec<Finding>| {
        worst
            .into_iter()
            .zip(found)
            .map(|(worst, found)| if found.status > worst.status { found } else { worst })
            .collect()
    };
    each.reduce(worst).unwrap_or_else(|| {
        let none = |id: FindingId, what: &str| {
            Finding::new(id, FindingStatus::Holds, format!("there is no contact: {what}"), "contact")
        };
        vec![
            none(FindingId::H7, "k_c = 0"),
            none(FindingId::H8, "p_ν = p_τ = 0"),
            none(FindingId::PhiL, "φ_L does not enter"),
        ]
    })
}

/// The laws of every contact with some of its points, at which they are tested.
pub(super) fn tested(problem: &Problem) -> impl Iterator<Item = Test<'_>> {
    let (boundary, length) = (problem.contact_boundary(), diameter(problem));
    problem.contacts.iter().enumerate().map(move |(side, contact)| {
        let places: Vec<Point> = boundary.points.iter().filter(|p| p.contact == side).map(|p| p.x).collect();
        let tau = friction_lipschitz(contact, &places);
        Test { contact, places: some(&places, PLACES).copied().collect(), length, tau }
    })
}

/// The laws of a contact and the sampling of their arguments: penetrations of any size below `length`, the size of the
/// body.
pub(super) struct Test<'a> {
    pub(super) contact: &'a Contact,
    pub(super) places: Vec<Point>,
    pub(super) length: f64,
    /// L_τ of (H8) and the place where it is attained.
    pub(super) tau: (Option<f64>, Option<Point>),
}

impl Test<'_> {
    /// Evaluates `of` with array laws computed for all samples at once.
    pub(super) fn sampled<T>(&self, of: impl FnMut() -> T) -> T {
        all_at_once(&arrays(std::slice::from_ref(self.contact)), of)
    }

    /// The arguments of a law at a penetration, with the pressure of the normal law, or 0 if that pressure has no
    /// Lipschitz constant.
    fn at(&self, x: &Point, penetration: f64) -> ContactPoint {
        let pressure = self
            .contact
            .normal
            .lipschitz()
            .map_or(0.0, |_| self.contact.normal.pressure(x, penetration, 0.0, 0.0).value);
        ContactPoint { x: *x, penetration, pressure, ..ContactPoint::default() }
    }

    /// True if samples satisfy L_ν, L_τ and L_kc, the friction bound is not negative, and the flux does not decrease
    /// with θ.
    pub(super) fn keeps_its_constants(&self) -> bool {
        self.sampled(|| self.keeps_them())
    }

    fn keeps_them(&self) -> bool {
        let contact = self.contact;
        let (nu, kc) = (
            contact.normal.lipschitz().unwrap_or(f64::INFINITY),
            contact.heat.conductance_lipschitz().unwrap_or(f64::INFINITY),
        );
        // A friction bound that is independent of the penetration has no constant.
        let tau = if nu.is_finite() { self.tau.0 } else { contact.friction.lipschitz(Some(nu)) }.unwrap_or(0.0);
        let mut random = Samples::default();
        let keeps = |x: &Point, random: &mut Samples| {
            let r = random.spread(self.length, 12.0);
            let s = r + random.spread(self.length, 12.0);
            let (theta, other) = (random.spread(1e3, 6.0), random.spread(1e3, 6.0));
            let near = |a: f64, b: f64, l: f64| {
                (a - b).abs() <= l * (r - s).abs() * (1.0 + SLACK) + 16.0 * f64::EPSILON * (a.abs() + b.abs())
            };
            let [at_r, at_s] = [r, s].map(|r| self.at(x, r));
            let bound = |at: &ContactPoint| {
                contact.friction.bound(&ContactPoint { pressure: at.pressure.max(0.0), ..*at }).value
            };
            let flux =
                |at: &ContactPoint, temperature: f64| contact.heat.flux(&ContactPoint { temperature, ..*at }).value;
            near(at_r.pressure, at_s.pressure, nu)
                && bound(&at_r) >= 0.0
                && near(bound(&at_r), bound(&at_s), tau)
                && near(flux(&at_r, theta), flux(&at_s, theta), kc * theta.abs())
                && (flux(&at_r, theta) - flux(&at_r, other)) * (theta - other) >= 0.0
        };
        self.places.iter().all(|x| (0..PAIRS).all(|_| keeps(x, &mut random)))
    }

    /// A sample that contradicts f ≥ 0, f = 0 for r ≤ 0, |f(r) − f(s)| ≤ L |r − s| or f ≤ `bound`.
    fn refute(
        &self,
        name: &str,
        lipschitz: &str,
        l: f64,
        bound: f64,
        f: impl Fn(&ContactPoint) -> f64,
    ) -> Option<String> {
        self.sampled(|| self.refutation(name, lipschitz, l, bound, &f))
    }

    fn refutation(
        &self,
        name: &str,
        lipschitz: &str,
        l: f64,
        bound: f64,
        f: &dyn Fn(&ContactPoint) -> f64,
    ) -> Option<String> {
        let mut random = Samples::default();
        for x in &self.places {
            for _ in 0..PAIRS {
                let r = random.spread(self.length, 12.0);
                let s = if random.number() < 0.0 {
                    random.spread(self.length, 12.0)
                } else {
                    r + random.spread(r.abs(), 6.0)
                };
                let (fr, fs) = (f(&self.at(x, r)), f(&self.at(x, s)));
                if r <= 0.0 && fr != 0.0 {
                    return Some(format!("{name} = {fr:.3e} at the penetration {r:.3e}, expected zero, at {}", at(x)));
                }
                if fr < 0.0 || fr.is_nan() || fr > bound * (1.0 + SLACK) {
                    return Some(format!(
                        "{name} = {fr:.6e} at the penetration {r:.3e}, expected a number from 0 to {bound:.6e}, at {}",
                        at(x)
                    ));
                }
                let noise = 8.0 * f64::EPSILON * (fr.abs() + fs.abs());
                if (fr - fs).abs() > l * (r - s).abs() * (1.0 + SLACK) + noise {
                    let found = ((fr - fs) / (r - s)).abs();
                    return Some(format!(
                        "{lipschitz} = {l:.6e}, but the penetrations {r:.3e} and {s:.3e} give {found:.6e} at {}",
                        at(x)
                    ));
                }
            }
        }
        None
    }
}

/// (H7): k_c is bounded, Lipschitz and zero for r ≤ 0.
fn exchange(test: &Test, constants: &Constants) -> Finding {
    let heat = &test.contact.heat;
    let bound = heat.conductance_bound();
    // φ_L has the slope 1 at 0.
    let k_c = |at: &ContactPoint| heat.flux(at).by_temperature;
    let finding = |status, message: String| {
        Finding::new(FindingId::H7, status, message, "contact.heat").numbers(constants.bound_kc, None)
    };
    if bound > 0.0 && test.heat_sees_level() {
        return finding(
            FindingStatus::NotCovered,
            "the flux is not a product k_c(r) φ_L(θ − θ_F) as in (2.10): its slope depends on the temperatures"
                .to_owned(),
        );
    }
    if bound > 0.0 && heat.at_time(0.0).is_some() {
        return finding(
            FindingStatus::NotCovered,
            "the conductance depends on the time, in (2.10) on the penetration".to_owned(),
        );
    }
    if bound > 0.0 && test.heat_sees_pressure() {
        return finding(
            FindingStatus::NotCovered,
            "the conductance depends on the pressure, in (2.10) on the penetration".to_owned(),
        );
    }
    let (lipschitz, bound) = match (heat.conductance_lipschitz().filter(|l| l.is_finite()), bound.is_finite()) {
        (Some(lipschitz), true) => (lipschitz, bound),
        (lipschitz, is_bounded) => {
            let bounded = if is_bounded {
                format!("bounded by M_kc = {bound:.6e}")
            } else {
                "not bounded, M_kc = ∞".to_owned()
            };
            let slope = lipschitz
                .map_or_else(|| "has no Lipschitz constant".to_owned(), |l| format!("Lipschitz with L_kc = {l:.6e}"));
            return finding(FindingStatus::Fails, format!("k_c is {bounded}, and {slope}"))
                .repair("a law whose conductance grows gradually up to a bound, such as \"ramp\"");
        }
    };
    match test.refute("k_c", "L_kc", lipschitz, bound, k_c) {
        Some(contradiction) => {
            finding(FindingStatus::Fails, format!("k_c violates the constants that it declares: {contradiction}"))
                .repair("correct the constants of the law")
        }
        None => finding(FindingStatus::Holds, {
            let [at_lipschitz, at_bound] = heat
                .graded()
                .map_or_else(Default::default, |law| law.extremes().map(|instance| attained(Some(instance.x), None)));
            format!(
                "k_c is bounded by M_kc = {bound:.6e}{at_bound}, Lipschitz with L_kc = {lipschitz:.6e}{at_lipschitz}, and zero without penetration"
            )
        }),
    }
}

/// (H8): p_ν and p_τ are Lipschitz and zero for r ≤ 0. The bound in (2.9) depends on the penetration alone.
fn pressure(test: &Test, constants: &Constants) -> Finding {
    let contact = test.contact;
    let finding = |status, message: String, place: &str| {
        Finding::new(FindingId::H8, status, message, place)
            .numbers(constants.lipschitz_nu.zip(constants.lipschitz_tau).map(|(n, t)| n + t), None)
    };
    let Some(nu) = contact.normal.lipschitz().filter(|l| l.is_finite()) else {
        let (status, message) = if contact.normal.graph() == GraphKind::Function {
            (FindingStatus::Fails, "p_ν is not a Lipschitz function of the penetration")
        } else {
            (
                FindingStatus::NotCovered,
                "the pressure is not a function of the penetration, which (2.8) assumes: a rigid foundation has no L_ν",
            )
        };
        return finding(status, message.to_owned(), "contact.normal").repair("use normal compliance with a stiffness");
    };
    let Some(tau) = test.tau.0.filter(|l| l.is_finite()) else {
        let message = if test.friction_is_given() {
            "p_τ does not depend on the penetration: it is not zero in open contact"
        } else {
            "p_τ is not a Lipschitz function of the penetration"
        };
        return finding(FindingStatus::Fails, message.to_owned(), "contact.friction")
            .repair("a friction bound that grows gradually from zero");
    };
    let wrong = "correct the constants of the law";
    if let Some(contradiction) = test.refute("p_ν", "L_ν", nu, f64::INFINITY, |at| at.pressure) {
        return finding(
            FindingStatus::Fails,
            format!("p_ν violates the constants that it declares: {contradiction}"),
            "contact.normal",
        )
        .repair(wrong);
    }
    if let Some(contradiction) = test.refute("p_τ", "L_τ", tau, f64::INFINITY, |at| contact.friction.bound(at).value)
    {
        return finding(
            FindingStatus::Fails,
            format!("p_τ violates the constants that it declares: {contradiction}"),
            "contact.friction",
        )
        .repair(wrong);
    }
    if let Some((what, place)) = beyond(test) {
        return finding(FindingStatus::NotCovered, what.to_owned(), place)
            .repair("use a pressure and a friction bound that depend on the penetration alone");
    }
    let at_nu = attained(contact.normal.graded().map(|law| law.extremes()[0].x), None);
    let at_tau = attained(test.tau.1, None);
    let message = format!(
        "p_ν and p_τ are Lipschitz with L_ν = {nu:.6e}{at_nu} and L_τ = {tau:.6e}{at_tau}, not negative, and zero without penetration"
    );
    finding(FindingStatus::Holds, message, "contact")
}

/// A dependence of pressure or friction that (2.8), (2.9) do not provide for, and its place.
pub(super) fn beyond(test: &Test) -> Option<(&'static str, &'static str)> {
    if test.rate_matters() {
        Some((
            "the pressure depends on the rate of the penetration, which (2.8) does not provide for",
            "contact.normal",
        ))
    } else if test.contact.normal.at_time(0.0).is_some() {
        Some(("the pressure depends on the time, which (2.8) does not provide for", "contact.normal"))
    } else if test.contact.friction.at_time(0.0).is_some() {
        Some(("the friction bound depends on the time, which (2.9) does not provide for", "contact.friction"))
    } else if test.friction_sees_slip() {
        Some(("the friction bound depends on the slip speed, which (2.9) does not provide for", "contact.friction"))
    } else if test.friction_sees_heat() {
        Some(("the friction bound depends on the temperature, which (2.9) does not provide for", "contact.friction"))
    } else if test.contact.wear.is_some() {
        Some((
            "wear makes pressure and friction depend on the history, which (2.8), (2.9) do not provide for",
            "contact.wear",
        ))
    } else {
        None
    }
}

/// `contact-heat`: warns if the conductance depends on the penetration although the foundation is rigid, where it is
/// zero or round-off; `None` otherwise.
pub(super) fn rigid_conductance(problem: &Problem) -> Option<Finding> {
    let side = tested(problem).position(|test| {
        let heat = test.contact.heat.as_ref();
        // Conductance of a closed contact without penetration at rest, at any pressure.
        let closed = |x: &Point| {
            (-12..=12).all(|decade| {
                heat.flux(&ContactPoint { x: *x, pressure: 10f64.powi(decade), ..ContactPoint::default() })
                    .by_temperature
                    == 0.0
            })
        };
        // p ∈ G(z − λp) leaves no penetration, for arbitrarily small λ.
        let rigid = |x: &Point| {
            (-12..=12).all(|decade| {
                let lambda = 10f64.powi(decade);
                test.length - lambda * test.contact.normal.pressure(x, test.length, 0.0, lambda).value
                    <= 1e-9 * test.length
            })
        };
        test.contact.normal.graph() != GraphKind::Function
            && heat.conductance_bound() > 0.0
            && test.places.iter().any(|x| rigid(x) && closed(x))
    })?;
    let message = "the foundation is rigid and the conductance depends on the penetration, which is round-off in closed contact: the heat flow is meaningless";
    let place = format!("{}.heat", problem.contact_path(side));
    Some(
        Finding::new(FindingId::ContactHeat, FindingStatus::Fails, message, &place)
            .repair("use a conductance that depends on the pressure, law = \"pressure\", or a compliant foundation"),
    )
}

/// φ_L of (2.10) is cut off at ±L.
fn cut_off(test: &Test) -> Finding {
    let heat = &test.contact.heat;
    let (bound, cut) = (heat.conductance_bound(), heat.truncation());
    let finding = |status, message: String| {
        Finding::new(FindingId::PhiL, status, message, "contact.heat.truncation").numbers(cut, None)
    };
    match cut {
        _ if bound == 0.0 && test.friction_makes_heat() => {
            finding(FindingStatus::Holds, "no heat is conducted: φ_L does not enter; friction heat is not part of (2.10)".to_owned())
        }
        _ if bound == 0.0 => finding(FindingStatus::Holds, "there is no heat exchange: φ_L does not enter".to_owned()),
        _ if test.heat_sees_level() => {
            finding(FindingStatus::NotCovered, "the flux is not a product k_c(r) φ_L(θ − θ_F) as in (2.10), so there is no φ_L to truncate".to_owned())
        }
        Some(l) => finding(FindingStatus::Holds, format!("φ_L is truncated at ±L, L = {l:.6e}, as in (2.10)")),
        None => finding(
            FindingStatus::NotCovered,
            "φ_L(s) = s is not bounded; (2.10) truncates it at ±L and (3.24) uses L. Section 5 of the paper also computes without truncation, and the theorem in book/src/theory.md does not need it".to_owned(),
        )
        .repair("contact.heat.truncation = L, larger than any temperature difference that occurs: results are then the same"),
    }
}
