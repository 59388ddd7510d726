//! The rule in time: the unknown of a step, and how it enters displacements and accelerations.

use super::analysis::Analysis;

/// σ of a steady step over its length: the velocities σ leaves of any displacement are round-off beside all others, and
/// the squares of its terms are far from overflow.
const LONG: f64 = (1u128 << 70) as f64;

/// The rule of a step from t₀ to t₁ = t₀ + k. Its unknown x is the velocity at t_ϑ = t₀ + ϑk:
///
/// u_ϑ = ū + γ x and ẇ = (x − w̄)/δ, so that the step solves M (x − w̄)/δ + B x + A (ū + γ x) + … = f(t_ϑ).
///
/// ū, w̄ and so on are the state at t₀, or those of [`Start`]. At the end of the step u₁ = ū + σ x, and any other
/// unknown v, of which the step finds v_ϑ, is v₁ = v₀ + (v_ϑ − v₀)/ϑ; the velocity is w₁ = w₀ + (x − w̄)/ϑ if w̄ is
/// [`Start::Admissible`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Length k of the step, s.
    pub k: f64,
    /// γ in s.
    pub gamma: f64,
    /// δ in s.
    pub delta: f64,
    /// σ in s: k in schemes of one step.
    pub span: f64,
    /// ϑ: the equations hold at t₀ + ϑk.
    pub level: f64,
    /// What the step adds to.
    pub start: Start,
    /// How the laws of contact hold in the step, or `None` if all of them hold at its end.
    pub contact: Option<ContactRule>,
    /// What of the equations acts.
    pub analysis: Analysis,
}

/// The values ū, w̄, θ̄ that a step adds to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Start {
    /// Those of the state at its start.
    #[default]
    State,
    /// (4 v₀ − v₋₁)/3 of the states at its start and one step of the same length before.
    TwoStates,
    /// Those of the state at its start, with the velocity nearest to w₀, in the norm of the kinetic energy, that takes
    /// no point into a rigid foundation by the end of the step.
    Admissible,
}

/// How the laws of contact hold in a step of the ϑ-scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactRule {
    /// Newton's coefficient of restitution e of rigid foundations, 0 ≤ e ≤ 1.
    pub restitution: f64,
    /// The pressure of a layer.
    pub pressure: PressureRule,
    /// The slip velocity of the friction law.
    pub friction: FrictionRule,
}

/// The pressure of a layer in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PressureRule {
    /// The mean over the penetrations of the step, whose work at ϑ = ½ is the change of the energy of the layer.
    #[default]
    Gradient,
    /// That of the penetration at t_ϑ.
    Plain,
}

/// The slip velocity of the friction law in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrictionRule {
    /// That at t_ϑ, the mean of the step: the power of friction is never negative.
    #[default]
    Mean,
    /// That at the end of the step: a point that sticks is at rest there.
    End,
}

impl Rule {
    /// The ϑ-scheme with step length k, ½ ≤ ϑ ≤ 1: γ = δ = ϑk. At ϑ = ½ it is of second order and adds no damping; at
    /// ϑ = 1 it is backward Euler.
    #[must_use]
    pub fn theta(k: f64, theta: f64, contact: ContactRule) -> Rule {
        let (gamma, delta) = (theta * k, theta * k);
        Rule { gamma, delta, level: theta, contact: Some(contact), ..Rule::backward_euler(k) }
    }

    /// The backward differentiation formula of second order, BDF2, with step length k: v̇ = (3 v₁ − 4 v₀ + v₋₁)/(2k) =
    /// (v₁ − v̄)/δ with γ = δ = σ = 2k/3, and the equations hold at the end of the step.
    #[must_use]
    pub fn bdf2(k: f64) -> Rule {
        let span = 2.0 * k / 3.0;
        Rule { gamma: span, delta: span, span, start: Start::TwoStates, ..Rule::backward_euler(k) }
    }

    /// The contact-stabilised Newmark scheme with step length k: the ϑ-scheme at ϑ = ½ from an admissible velocity v,
    /// so that w₁ = w₀ + 2 (x − v), with rigid foundations met at the end of the step.
    ///
    /// Source: P. Deuflhard, R. Krause, S. Ertel, Int. J. Numer. Meth. Engng 73 (2008) 1274–1290.
    #[must_use]
    pub fn contact_stabilised(k: f64) -> Rule {
        Rule { start: Start::Admissible, ..Rule::theta(k, 0.5, ContactRule::default()) }
    }

    /// Backward Euler with step length k: γ = δ = k, and the equations hold at the end of the step.
    #[must_use]
    pub fn backward_euler(k: f64) -> Rule {
        let (contact, analysis) = (None, Analysis::Dynamic);
        Rule { k, gamma: k, delta: k, span: k, level: 1.0, start: Start::State, contact, analysis }
    }

    /// A steady step of length k: backward Euler in infinite time. Nothing is stored, δ = ∞, and the body reaches its
    /// place at a velocity that is round-off to every law, γ = σ ≫ k.
    #[must_use]
    pub fn steady(k: f64) -> Rule {
        let span = LONG * k;
        Rule { gamma: span, delta: f64::INFINITY, span, analysis: Analysis::Steady, ..Rule::backward_euler(k) }
    }

    /// The density that acts in the step: 0 if inertia does not act.
    #[must_use]
    pub fn inertia(&self, rho: f64) -> f64 {
        if self.analysis.has_inertia() { rho } else { 0.0 }
    }

    /// True if the step leads to a steady state.
    #[must_use]
    pub fn is_steady(&self) -> bool {
        self.analysis == Analysis::Steady
    }

    /// The time for which the body moves at the velocity of the step, along which forces work, s. What flows or slides
    /// on does so for the length of the step.
    #[must_use]
    pub fn moving(&self) -> f64 {
        if self.is_steady() { self.span } else { self.k }
    }

    /// Returns true if this is backward Euler.
    #[must_use]
    pub fn is_backward_euler(&self) -> bool {
        self.is_at_end() && self.start == Start::State
    }

    /// Returns true if ū is the displacement at the start of the step: the step does not add to two states.
    #[must_use]
    pub fn is_of_one_step(&self) -> bool {
        self.start != Start::TwoStates
    }

    /// The rule for a body whose nodes in contact have no mass: the laws of contact hold at the end of the step, and so
    /// do the equations of these nodes, which are static.
    #[must_use]
    pub fn with_massless_contact(self) -> Rule {
        Rule { contact: None, ..self }
    }

    /// Returns true if the equations of the nodes in contact, which have no mass, hold at the end of the step, and the
    /// others before it.
    #[must_use]
    pub fn balances_contact_at_end(&self) -> bool {
        !self.is_at_end() && self.contact.is_none()
    }

    /// The share of the forces of contact that the equations of a step have: ϑ of those at its end if the rest is that
    /// of its start. Else 1.
    #[must_use]
    pub fn contact_share(&self) -> f64 {
        if self.balances_contact_at_end() { self.level } else { 1.0 }
    }

    /// Returns true if bodies hit rigid foundations by a law of impact, which holds velocities. Else no point is inside
    /// its foundation at the end of the step.
    #[must_use]
    pub fn has_impacts(&self) -> bool {
        self.contact.is_some() && self.start == Start::State
    }

    /// Returns true if the equations hold at the end of the step.
    #[must_use]
    pub fn is_at_end(&self) -> bool {
        self.level >= 1.0
    }

    /// w₁ = w₀ + (w_ϑ − w̄)/ϑ: the velocity at the end of a step, by those at its start, w̄, and w_ϑ.
    #[must_use]
    pub fn end_velocity(&self, [start, bar, at_level]: [f64; 3]) -> f64 {
        match self.start {
            Start::State | Start::TwoStates => self.end([start, at_level]),
            Start::Admissible => start + (at_level - bar) / self.level,
        }
    }

    /// The slip velocity at the end of the step over x_τ − v_F − b, if friction follows the end of the step: 1/ϑ. Else
    /// 1.
    #[must_use]
    pub fn slip_share(&self) -> f64 {
        match self.contact {
            Some(ContactRule { friction: FrictionRule::End, .. }) => self.level.recip(),
            _ => 1.0,
        }
    }

    /// The time t_ϑ at which the equations hold in a step from `start` to `end`, s.
    #[must_use]
    pub fn time(&self, [start, end]: [f64; 2]) -> f64 {
        self.between([start, end])
    }

    /// (1 − ϑ) v₀ + ϑ v₁: the value at t_ϑ of a quantity known at both ends of the step.
    #[must_use]
    pub fn between(&self, [start, end]: [f64; 2]) -> f64 {
        if self.is_at_end() { end } else { start + self.level * (end - start) }
    }

    /// v₁ = v₀ + (v_ϑ − v₀)/ϑ: the value at the end of the step.
    #[must_use]
    pub fn end(&self, [start, at_level]: [f64; 2]) -> f64 {
        if self.is_at_end() { at_level } else { start + (at_level - start) / self.level }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ü + u = 0 in 100 steps of 0.1: amplitude and frequency over those of the motion, from the eigenvalues
    /// 1/(1 + iϑk) · (1 − i(1 − ϑ)k) of a step.
    #[test]
    fn an_oscillator_has_the_amplitude_and_frequency_of_its_rule() {
        let known = [
            (1.0, 0.608_038_824_7, 0.996_686_524_9),
            (0.75, 0.779_407_159_8, 0.998_546_413_3),
            (0.6, 0.905_072_066_2, 0.999_068_422_4),
            (0.5, 1.0, 0.999_167_914_4),
        ];
        for (theta, amplitude, frequency) in known {
            let (rule, mut u, mut w, mut angle) =
                (Rule::theta(0.1, theta, ContactRule::default()), 1.0f64, 0.0f64, 0.0);
            for _ in 0..100 {
                let before = f64::atan2(-w, u);
                let x = (w - rule.delta * u) / (1.0 + rule.delta * rule.gamma);
                (u, w) = (u + rule.k * x, rule.end([w, x]));
                angle += (f64::atan2(-w, u) - before).rem_euclid(std::f64::consts::TAU);
            }
            assert!((u.hypot(w) - amplitude).abs() < 1e-9, "ϑ = {theta}: amplitude {}", u.hypot(w));
            assert!((angle / 10.0 - frequency).abs() < 1e-9, "ϑ = {theta}: frequency {}", angle / 10.0);
        }
    }

    /// The same by BDF2, from two states of its motion: with z = u − iw, z₀ = 1 and z₋₁ = 1/ζ, ζ the root near 1 of
    /// 3ζ² − 4ζ + 1 = 2ik ζ².
    #[test]
    fn bdf2_has_the_amplitude_and_frequency_of_its_root() {
        let rule = Rule::bdf2(0.1);
        // 1/ζ = 2 − √(1 + 2ik), √(1 + 2ik) = a + ib.
        let a = (0.5 * (1.0f64.hypot(0.2) + 1.0)).sqrt();
        let b = 0.1 / a;
        let (mut before, mut now, mut angle) = ([2.0 - a, b], [1.0f64, 0.0f64], 0.0);
        for _ in 0..100 {
            let [u, w] = [0, 1].map(|i| (4.0 * now[i] - before[i]) / 3.0);
            let x = (w - rule.delta * u) / (1.0 + rule.delta * rule.gamma);
            let next = [u + rule.span * x, rule.end([now[1], x])];
            angle += (f64::atan2(-next[1], next[0]) - f64::atan2(-now[1], now[0])).rem_euclid(std::f64::consts::TAU);
            (before, now) = (now, next);
        }
        assert!((now[0].hypot(now[1]) - 0.997_563_877_0).abs() < 1e-9, "amplitude {}", now[0].hypot(now[1]));
        assert!((angle / 10.0 - 0.996_710_675_5).abs() < 1e-9, "frequency {}", angle / 10.0);
    }

    #[test]
    fn the_ends_of_a_step_and_its_level_agree() {
        for theta in [0.5, 0.6, 1.0] {
            let rule = Rule::theta(0.1, theta, ContactRule::default());
            let at = rule.between([3.0, 7.0]);
            assert!((rule.end([3.0, at]) - 7.0).abs() < 1e-14 && (at - (3.0 + theta * 4.0)).abs() < 1e-14);
        }
        let euler = Rule::backward_euler(0.1);
        // To the bit, whatever the values.
        assert_eq!((euler.gamma.to_bits(), euler.delta.to_bits()), (0.1f64.to_bits(), 0.1f64.to_bits()));
        assert_eq!(euler.end([1e300, 0.1]).to_bits(), 0.1f64.to_bits());
        assert_eq!(euler.between([1e300, 0.1]).to_bits(), 0.1f64.to_bits());
    }
}
