//! The laws of contact of a case, with their coefficients.

use std::sync::Arc;

use super::coefficient::Refusal;
use super::raw::{Datum, Friction, HeatTerm, Normal, Wear};
use crate::contact::{
    Adhesion, Archard, Bilateral, Capped, Compliance, ConductanceFormula, ConstantConductance, Coulomb, Damped,
    FrictionFormula, FrictionLaw, FrictionVariable, FrictionalHeat, Frictionless, GapConduction, HeatLaw, HuntCrossley,
    NoSlip, NormalLaw, OrthotropicFriction, PiecewiseLinear, Power, PowerConductance, PressureConductance,
    PressureFormula, PressureFormulaFault, PressureTable, PressureTableFault, Radiation, Ramp, Signorini, Softening,
    StaticKinetic, Stop, TableFault, Tabulated, Tresca, WearLaw,
};
use crate::expression::{ExpressionError, NamedConstants};

/// Coefficients with their keys below the law, in the order in which the law takes their values.
pub(super) type Keyed<'a> = Vec<(String, &'a Datum)>;

/// Function that makes a law of the values of its coefficients.
pub(super) type MakeLaw<T> = Box<dyn Fn(&[f64]) -> Result<T, Refusal> + Send + Sync>;

fn keyed<'a, T>(all: &[(&str, &'a T)]) -> Vec<(String, &'a T)> {
    all.iter().map(|(key, coefficient)| ((*key).to_owned(), *coefficient)).collect()
}

/// The values of a table times a factor; 1 changes no bit.
fn times(values: &[f64], factor: f64) -> Vec<f64> {
    values.iter().map(|value| value * factor).collect()
}

/// Coefficients and constructor of a law of the pressure.
type NormalPlan<'a> = (Keyed<'a>, MakeLaw<Arc<dyn NormalLaw>>);

fn normal_law<'a, L: NormalLaw + 'static>(
    coefficients: &[(&str, &'a Datum)],
    law: impl Fn(&[f64]) -> L + Send + Sync + 'static,
) -> NormalPlan<'a> {
    (keyed(coefficients), Box::new(move |v| Ok(Arc::new(law(v)))))
}

/// The law of the contact pressure.
pub(super) fn normal<'a>(raw: &'a Normal, constants: &NamedConstants) -> NormalPlan<'a> {
    match raw {
        Normal::Compliance { stiffness } => normal_law(&[("stiffness", stiffness)], |v| Compliance { stiffness: v[0] }),
        Normal::Power { stiffness, exponent } => normal_law(&[("stiffness", stiffness), ("exponent", exponent)], |v| {
            Power { stiffness: v[0], exponent: v[1] }
        }),
        Normal::Table { penetration, pressure, factor } => {
            let (penetration, pressure) = (penetration.clone(), pressure.clone());
            let make = move |v: &[f64]| -> Result<Arc<dyn NormalLaw>, Refusal> {
                let law = PressureTable::new(&penetration, &times(&pressure, v[0]));
                Ok(Arc::new(law.map_err(|fault| pressure_refusal(&fault))?))
            };
            (keyed(&[("factor", factor)]), Box::new(make))
        }
        Normal::Expression { pressure, begin, factor } => {
            let (pressure, begin, constants) = (pressure.clone(), *begin, constants.clone());
            let make = move |v: &[f64]| -> Result<Arc<dyn NormalLaw>, Refusal> {
                let law = PressureFormula::new(&pressure, v[0], begin, &constants);
                Ok(Arc::new(law.map_err(|fault| formula_refusal(fault).of("pressure"))?))
            };
            (keyed(&[("factor", factor)]), Box::new(make))
        }
        Normal::Stop { stiffness, depth } => {
            normal_law(&[("stiffness", stiffness), ("depth", depth)], |v| Stop { stiffness: v[0], depth: v[1] })
        }
        Normal::Signorini => normal_law(&[], |_| Signorini),
        Normal::Bilateral => normal_law(&[], |_| Bilateral),
        Normal::Damped { stiffness, damping } => {
            normal_law(&[("stiffness", stiffness), ("damping", damping)], |v| Damped { stiffness: v[0], damping: v[1] })
        }
        Normal::HuntCrossley { stiffness, exponent, damping } => {
            normal_law(&[("stiffness", stiffness), ("exponent", exponent), ("damping", damping)], |v| HuntCrossley {
                at_rest: Power { stiffness: v[0], exponent: v[1] },
                damping: v[2],
            })
        }
        Normal::Softening { stiffness, peak, softening, residual } => {
            let keys = [("stiffness", stiffness), ("peak", peak), ("softening", softening), ("residual", residual)];
            let make = |v: &[f64]| -> Result<Arc<dyn NormalLaw>, Refusal> {
                if v[3] > v[1] {
                    let expected = format!("at most the peak, {:?}", v[1]);
                    return Err(Refusal::new(format!("{:?}", v[3]), expected).of("residual"));
                }
                Ok(Arc::new(Softening { stiffness: v[0], peak: v[1], softening: v[2], residual: v[3] }))
            };
            (keyed(&keys), Box::new(make))
        }
        Normal::Adhesion { stiffness, strength, release } => {
            normal_law(&[("stiffness", stiffness), ("strength", strength), ("release", release)], |v| Adhesion {
                stiffness: v[0],
                strength: v[1],
                release: v[2],
            })
        }
    }
}

fn pressure_refusal(fault: &PressureTableFault) -> Refusal {
    let key = match fault {
        PressureTableFault::Falls { .. } => "pressure",
        PressureTableFault::Start { .. } | PressureTableFault::Table(_) => "penetration",
    };
    Refusal::new(fault.found(), fault.expected()).of(key)
}

fn formula_refusal(fault: PressureFormulaFault) -> Refusal {
    match fault {
        PressureFormulaFault::Text(error) => expression_refusal(error),
        PressureFormulaFault::Start(value) => {
            Refusal::new(format!("{value:?} where it begins"), "a pressure that is 0 there; `begin` says where")
        }
        PressureFormulaFault::Begin(begin) => Refusal::new(format!("a beginning at {begin:?}"), "one of at most 0"),
        PressureFormulaFault::Falls(r) => {
            let expected =
                "a pressure that is finite and does not fall as r grows; law = \"softening\" is one that falls";
            Refusal::new(format!("one that falls or is not finite at r = {r:.3e}"), expected)
        }
    }
}

/// The refusal of a text that is no formula.
fn expression_refusal(error: ExpressionError) -> Refusal {
    let ExpressionError { offset, found, expected, hint } = error;
    let hint = hint.map_or_else(String::new, |hint| format!(" ({hint})"));
    Refusal::new(format!("{found} at byte {offset}"), format!("{expected}{hint}"))
}

/// Coefficients and constructor of a law of friction.
type FrictionPlan<'a> = (Keyed<'a>, MakeLaw<Arc<dyn FrictionLaw>>);

/// The plan of a friction law, limited by a cap if there is one.
fn capped<'a>(
    coefficients: &[(&str, &'a Datum)],
    cap: Option<&'a Datum>,
    law: impl Fn(&[f64]) -> Result<Arc<dyn FrictionLaw>, Refusal> + Send + Sync + 'static,
) -> FrictionPlan<'a> {
    let count = coefficients.len();
    let mut keyed = keyed(coefficients);
    keyed.extend(cap.map(|cap| ("cap".to_owned(), cap)));
    let make = move |v: &[f64]| -> Result<Arc<dyn FrictionLaw>, Refusal> {
        let law = law(v)?;
        Ok(match v.get(count) {
            Some(&cap) => Arc::new(Capped { law, cap }),
            None => law,
        })
    };
    (keyed, Box::new(make))
}

/// The law of the friction bound.
pub(super) fn friction<'a>(raw: &'a Friction, constants: &NamedConstants) -> FrictionPlan<'a> {
    match raw {
        Friction::None => (Vec::new(), Box::new(|_| Ok(Arc::new(Frictionless)))),
        Friction::Stick => (Vec::new(), Box::new(|_| Ok(Arc::new(NoSlip)))),
        Friction::Coulomb { coefficient, cap } => {
            capped(&[("coefficient", coefficient)], cap.as_ref(), |v| Ok(Arc::new(Coulomb { coefficient: v[0] })))
        }
        Friction::Tresca { bound } => capped(&[("bound", bound)], None, |v| Ok(Arc::new(Tresca { bound: v[0] }))),
        Friction::StaticKinetic { at_rest, kinetic, decay_speed, cap } => {
            static_kinetic(at_rest, kinetic, decay_speed.as_ref(), cap.as_ref())
        }
        Friction::SlipRate { speed, coefficient, factor, cap } => {
            tabulated(FrictionVariable::SlipSpeed, "speed", (speed, coefficient), factor, cap.as_ref())
        }
        Friction::Temperature { temperature, coefficient, factor, cap } => {
            tabulated(FrictionVariable::Temperature, "temperature", (temperature, coefficient), factor, cap.as_ref())
        }
        Friction::Pressure { pressure, coefficient, factor, cap } => {
            tabulated(FrictionVariable::Pressure, "pressure", (pressure, coefficient), factor, cap.as_ref())
        }
        Friction::Expression { coefficient, factor, cap } => {
            let (coefficient, constants) = (coefficient.clone(), constants.clone());
            capped(&[("factor", factor)], cap.as_ref(), move |v| {
                let law = FrictionFormula::new(&coefficient, v[0], &constants);
                Ok(Arc::new(law.map_err(|error| expression_refusal(error).of("coefficient"))?))
            })
        }
        Friction::Orthotropic { coefficients, direction } => {
            let numbered = |key: &str, all: &'_ [Datum]| -> Vec<String> {
                (0..all.len()).map(|i| format!("{key}[{i}]")).collect()
            };
            let keys = numbered("coefficients", coefficients).into_iter().zip(coefficients);
            let keyed = keys.chain(numbered("direction", direction).into_iter().zip(direction)).collect();
            (keyed, Box::new(orthotropic))
        }
    }
}

fn static_kinetic<'a>(
    at_rest: &'a Datum,
    kinetic: &'a Datum,
    decay_speed: Option<&'a Datum>,
    cap: Option<&'a Datum>,
) -> FrictionPlan<'a> {
    let mut coefficients = vec![("static", at_rest), ("kinetic", kinetic)];
    coefficients.extend(decay_speed.map(|decay| ("decay_speed", decay)));
    let decays = decay_speed.is_some();
    capped(&coefficients, cap, move |v| {
        let (at_rest, kinetic) = (v[0], v[1]);
        if at_rest < kinetic {
            let expected = format!("at least the kinetic coefficient, {kinetic:?}");
            return Err(Refusal::new(format!("{at_rest:?}"), expected).of("static"));
        }
        Ok(Arc::new(StaticKinetic { at_rest, kinetic, decay_speed: decays.then(|| v[2]) }))
    })
}

fn orthotropic(v: &[f64]) -> Result<Arc<dyn FrictionLaw>, Refusal> {
    let (coefficients, direction) = ([v[0], v[1]], &v[2..]);
    if direction.iter().all(|c| *c == 0.0) {
        return Err(Refusal::new("zero", "a direction").of("direction"));
    }
    for (coefficient, key) in coefficients.into_iter().zip(["coefficients[0]", "coefficients[1]"]) {
        if coefficient <= 0.0 {
            return Err(Refusal::new(format!("{coefficient:?}"), "a positive number").of(key));
        }
    }
    let direction = std::array::from_fn(|c| direction.get(c).copied().unwrap_or(0.0));
    Ok(Arc::new(OrthotropicFriction { coefficients, direction }))
}

fn tabulated<'a>(
    variable: FrictionVariable,
    key: &'static str,
    (arguments, values): (&[f64], &[f64]),
    factor: &'a Datum,
    cap: Option<&'a Datum>,
) -> FrictionPlan<'a> {
    let (arguments, values) = (arguments.to_vec(), values.to_vec());
    capped(&[("factor", factor)], cap, move |v| {
        let coefficient =
            PiecewiseLinear::new(&arguments, &times(&values, v[0])).map_err(|fault| function_refusal(&fault, key))?;
        Ok(Arc::new(Tabulated { variable, coefficient }))
    })
}

fn function_refusal(fault: &TableFault, key: &'static str) -> Refusal {
    let key = if matches!(fault, TableFault::Lengths { .. }) { "coefficient" } else { key };
    Refusal::new(fault.found(), fault.expected()).of(key)
}

/// Coefficients and constructor of a law of heat exchange.
pub(super) type HeatPlan<'a> = (Keyed<'a>, MakeLaw<Arc<dyn HeatLaw>>);

fn heat_law<'a, L: HeatLaw + 'static>(
    coefficients: &[(&str, &'a Datum)],
    truncation: Option<&'a Datum>,
    law: impl Fn(&[f64], Option<f64>) -> L + Send + Sync + 'static,
) -> HeatPlan<'a> {
    let count = coefficients.len();
    let mut keyed = keyed(coefficients);
    keyed.extend(truncation.map(|truncation| ("truncation".to_owned(), truncation)));
    (keyed, Box::new(move |v| Ok(Arc::new(law(v, v.get(count).copied())))))
}

/// One law of heat exchange.
pub(super) fn heat<'a>(raw: &'a HeatTerm, constants: &NamedConstants) -> HeatPlan<'a> {
    match raw {
        HeatTerm::Constant { conductance, truncation } => {
            heat_law(&[("conductance", conductance)], truncation.as_ref(), |v, truncation| ConstantConductance {
                conductance: v[0],
                truncation,
            })
        }
        HeatTerm::Ramp { conductance, width, truncation } => {
            heat_law(&[("conductance", conductance), ("width", width)], truncation.as_ref(), |v, truncation| Ramp {
                conductance: v[0],
                width: v[1],
                truncation,
            })
        }
        HeatTerm::Power { coefficient, exponent, truncation } => {
            heat_law(&[("coefficient", coefficient), ("exponent", exponent)], truncation.as_ref(), |v, truncation| {
                PowerConductance { coefficient: v[0], exponent: v[1], truncation }
            })
        }
        HeatTerm::Pressure { coefficient, exponent, truncation } => {
            heat_law(&[("coefficient", coefficient), ("exponent", exponent)], truncation.as_ref(), |v, truncation| {
                PressureConductance { coefficient: v[0], exponent: v[1], truncation }
            })
        }
        HeatTerm::Gap { conductivity, roughness, truncation } => heat_law(
            &[("conductivity", conductivity), ("roughness", roughness)],
            truncation.as_ref(),
            |v, truncation| GapConduction { conductivity: v[0], roughness: v[1], truncation },
        ),
        HeatTerm::Expression { conductance, factor, truncation } => {
            let mut keys = keyed(&[("factor", factor)]);
            keys.extend(truncation.as_ref().map(|truncation| ("truncation".to_owned(), truncation)));
            let (conductance, constants) = (conductance.clone(), constants.clone());
            let make = move |v: &[f64]| -> Result<Arc<dyn HeatLaw>, Refusal> {
                let law = ConductanceFormula::new(&conductance, v[0], v.get(1).copied(), &constants);
                Ok(Arc::new(law.map_err(|error| expression_refusal(error).of("conductance"))?))
            };
            (keys, Box::new(make))
        }
        HeatTerm::Radiation { emissivity, absolute_zero, constant } => {
            let (constant, absolute_zero) = (*constant, *absolute_zero);
            heat_law(&[("emissivity", emissivity)], None, move |v, _| Radiation {
                emissivity: v[0],
                constant,
                absolute_zero,
            })
        }
    }
}

/// The law of the fraction of friction heat that enters the side `on`.
pub(super) fn frictional_heat(partition: &Datum) -> HeatPlan<'_> {
    heat_law(&[("frictional_heat", partition)], None, |v, _| FrictionalHeat { partition: v[0] })
}

/// Coefficients and constructor of a law of wear.
type WearPlan<'a> = (Keyed<'a>, MakeLaw<Arc<dyn WearLaw>>);

/// The law of wear.
pub(super) fn wear(raw: &Wear) -> WearPlan<'_> {
    match raw {
        Wear::Archard { coefficient, .. } => {
            (keyed(&[("coefficient", coefficient)]), Box::new(|v| Ok(Arc::new(Archard::Constant(v[0])))))
        }
        Wear::ArchardTemperature { temperature, coefficient, factor, .. } => {
            let (temperature, coefficient) = (temperature.clone(), coefficient.clone());
            let make = move |v: &[f64]| -> Result<Arc<dyn WearLaw>, Refusal> {
                let table = PiecewiseLinear::new(&temperature, &times(&coefficient, v[0]))
                    .map_err(|fault| function_refusal(&fault, "temperature"))?;
                Ok(Arc::new(Archard::ByTemperature(table)))
            };
            (keyed(&[("factor", factor)]), Box::new(make))
        }
    }
}

/// A law without wear, as a placeholder.
pub(super) const NO_WEAR: Archard = Archard::Constant(0.0);
