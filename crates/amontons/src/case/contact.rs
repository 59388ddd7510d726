//! `[contact]`: from the raw laws to those of the library.

use std::sync::Arc;

use super::build::{Build, side};
use super::place::At;
use super::raw;
use crate::contact::{
    Adhesion, Archard, Bilateral, Capped, Compliance, Contact, Coulomb, Damped, FrictionLaw, FrictionalHeat,
    Frictionless, GapConduction, HeatLaw, HuntCrossley, Insulated, LumpedFoundation, NormalLaw, Orthotropic,
    PiecewiseLinear, Power, PowerConductance, PressureConductance, PressureTable, PressureTableFault, Quadrature,
    Radiation, Ramp, Signorini, Softening, StaticKinetic, Stop, Sum, TableFault, Tabulated, Tresca, Variable, WearLaw,
};
use crate::field::Field;
use crate::mesh::Mesh;

impl Build<'_> {
    pub fn contact(&mut self, path: &str, raw: raw::Contact, mesh: &Mesh) -> Contact {
        let points = side(mesh, &raw.on);
        if !raw.foundation_velocity.is_empty() && raw.foundation_velocity.len() != self.dim {
            self.wants_components(&format!("{path}.foundation_velocity"), raw.foundation_velocity.len());
        }
        let (terms, foundation_temperature) = raw.heat.terms();
        let mut laws: Vec<Arc<dyn HeatLaw>> = terms.iter().map(heat).collect();
        if raw.frictional_heat > 0.0 {
            laws.push(Arc::new(FrictionalHeat { partition: raw.frictional_heat }));
        }
        let only = if laws.len() < 2 { laws.pop() } else { None };
        let heat: Arc<dyn HeatLaw> = match only {
            Some(law) => law,
            None if laws.is_empty() => Arc::new(Insulated),
            None => Arc::new(Sum { laws }),
        };
        let foundation_temperature = foundation_temperature
            .map_or(Field::ZERO, |datum| self.field(&format!("{path}.heat.foundation_temperature"), &datum, &points));
        Contact {
            gap: self.field(&format!("{path}.gap"), &raw.gap, &points),
            quadrature: match raw.quadrature {
                raw::Quadrature::Nodal => Quadrature::Nodal,
                raw::Quadrature::Gauss => Quadrature::Gauss,
            },
            normal: self.normal(path, raw.normal),
            friction: self.friction(path, raw.friction),
            heat,
            foundation_heat: self.foundation_heat(path, raw.foundation, &foundation_temperature),
            foundation_temperature,
            wear: raw.wear.map(|wear| self.wear(path, wear)),
            obstacle: raw.obstacle.and_then(|obstacle| self.obstacle(&format!("{path}.obstacle"), obstacle, &points)),
            foundation_velocity: self.vector(&format!("{path}.foundation_velocity"), &raw.foundation_velocity, &points),
            on: raw.on,
        }
    }

    fn foundation_heat(
        &mut self,
        path: &str,
        raw: Option<raw::Foundation>,
        prescribed: &Field,
    ) -> Option<LumpedFoundation> {
        let raw = raw?;
        let at = format!("{path}.foundation.surroundings");
        let surroundings = raw.surroundings.map(|datum| self.field(&at, &datum, &[]));
        for (at, field) in
            [(format!("{path}.heat.foundation_temperature"), Some(prescribed)), (at, surroundings.as_ref())]
        {
            if field.is_some_and(Field::depends_on_space) {
                let hint = "remove x, y, z: a foundation with a heat capacity has one temperature";
                self.note(&at, At::Value, "an expression in space", "a number or an expression in t", Some(hint));
            }
        }
        let surroundings =
            surroundings.unwrap_or_else(|| raw.temperature.unwrap_or_else(|| prescribed.value(&[0.0; 3], 0.0)).into());
        Some(LumpedFoundation {
            capacity: raw.heat_capacity,
            temperature: raw.temperature,
            exchange: raw.exchange,
            surroundings,
        })
    }

    fn wear(&mut self, path: &str, raw: raw::Wear) -> Arc<dyn WearLaw> {
        match raw {
            raw::Wear::Archard { coefficient } => Arc::new(Archard::Constant(coefficient)),
            raw::Wear::ArchardTemperature { temperature, coefficient } => {
                match PiecewiseLinear::new(&temperature, &coefficient) {
                    Ok(table) => Arc::new(Archard::ByTemperature(table)),
                    Err(fault) => {
                        let key =
                            if matches!(fault, TableFault::Lengths { .. }) { "coefficient" } else { "temperature" };
                        self.note(&format!("{path}.wear.{key}"), At::Value, fault.found(), fault.expected(), None);
                        Arc::new(Archard::Constant(0.0))
                    }
                }
            }
        }
    }

    pub fn wants_components(&mut self, path: &str, found: usize) {
        let expected = format!("{} components", self.dim);
        self.note(path, At::Value, format!("{found} components"), expected, None);
    }

    fn normal(&mut self, path: &str, raw: raw::Normal) -> Arc<dyn NormalLaw> {
        match raw {
            raw::Normal::Compliance { stiffness } => Arc::new(Compliance { stiffness }),
            raw::Normal::Power { stiffness, exponent } => Arc::new(Power { stiffness, exponent }),
            raw::Normal::Table { penetration, pressure } => match PressureTable::new(&penetration, &pressure) {
                Ok(law) => Arc::new(law),
                Err(fault) => {
                    let key = match fault {
                        PressureTableFault::Falls { .. } => "pressure",
                        PressureTableFault::Start { .. } | PressureTableFault::Table(_) => "penetration",
                    };
                    self.note(&format!("{path}.normal.{key}"), At::Value, fault.found(), fault.expected(), None);
                    Arc::new(Signorini)
                }
            },
            raw::Normal::Stop { stiffness, depth } => Arc::new(Stop { stiffness, depth }),
            raw::Normal::Signorini => Arc::new(Signorini),
            raw::Normal::Bilateral => Arc::new(Bilateral),
            raw::Normal::Damped { stiffness, damping } => Arc::new(Damped { stiffness, damping }),
            raw::Normal::HuntCrossley { stiffness, exponent, damping } => {
                Arc::new(HuntCrossley { at_rest: Power { stiffness, exponent }, damping })
            }
            raw::Normal::Softening { stiffness, peak, softening, residual } => {
                if residual > peak {
                    self.note(
                        &format!("{path}.normal.residual"),
                        At::Value,
                        format!("{residual:?}"),
                        format!("at most the peak, {peak:?}"),
                        None,
                    );
                }
                Arc::new(Softening { stiffness, peak, softening, residual })
            }
            raw::Normal::Adhesion { stiffness, strength, release } => {
                Arc::new(Adhesion { stiffness, strength, release })
            }
        }
    }

    fn friction(&mut self, path: &str, raw: raw::Friction) -> Arc<dyn FrictionLaw> {
        let (law, cap): (Arc<dyn FrictionLaw>, Option<f64>) = match raw {
            raw::Friction::None => (Arc::new(Frictionless), None),
            raw::Friction::Coulomb { coefficient, cap } => (Arc::new(Coulomb { coefficient }), cap),
            raw::Friction::Tresca { bound } => (Arc::new(Tresca { bound }), None),
            raw::Friction::StaticKinetic { at_rest, kinetic, decay_speed, cap } => {
                if at_rest < kinetic {
                    let expected = format!("at least the kinetic coefficient, {kinetic:?}");
                    self.note(&format!("{path}.friction.static"), At::Value, format!("{at_rest:?}"), expected, None);
                }
                (Arc::new(StaticKinetic { at_rest, kinetic, decay_speed }), cap)
            }
            raw::Friction::SlipRate { speed, coefficient, cap } => {
                (self.tabulated(path, Variable::SlipSpeed, "speed", &speed, &coefficient), cap)
            }
            raw::Friction::Temperature { temperature, coefficient, cap } => {
                (self.tabulated(path, Variable::Temperature, "temperature", &temperature, &coefficient), cap)
            }
            raw::Friction::Pressure { pressure, coefficient, cap } => {
                (self.tabulated(path, Variable::Pressure, "pressure", &pressure, &coefficient), cap)
            }
            raw::Friction::Orthotropic { coefficients, direction } => {
                if direction.len() != self.dim {
                    self.wants_components(&format!("{path}.friction.direction"), direction.len());
                } else if direction.iter().all(|c| *c == 0.0) {
                    self.note(&format!("{path}.friction.direction"), At::Value, "zero", "a direction", None);
                }
                if let Some(i) = coefficients.iter().position(|c| *c <= 0.0) {
                    self.note(
                        &format!("{path}.friction.coefficients[{i}]"),
                        At::Value,
                        format!("{:?}", coefficients[i]),
                        "a positive number",
                        None,
                    );
                }
                let direction = std::array::from_fn(|c| direction.get(c).copied().unwrap_or(0.0));
                (Arc::new(Orthotropic { coefficients, direction }), None)
            }
        };
        match cap {
            Some(cap) => Arc::new(Capped { law, cap }),
            None => law,
        }
    }

    fn tabulated(
        &mut self,
        path: &str,
        variable: Variable,
        key: &str,
        arguments: &[f64],
        values: &[f64],
    ) -> Arc<dyn FrictionLaw> {
        match PiecewiseLinear::new(arguments, values) {
            Ok(coefficient) => Arc::new(Tabulated { variable, coefficient }),
            Err(fault) => {
                let key = if matches!(fault, TableFault::Lengths { .. }) { "coefficient" } else { key };
                self.note(&format!("{path}.friction.{key}"), At::Value, fault.found(), fault.expected(), None);
                Arc::new(Frictionless)
            }
        }
    }
}

fn heat(raw: &raw::HeatTerm) -> Arc<dyn HeatLaw> {
    match *raw {
        raw::HeatTerm::Ramp { conductance, width, truncation } => Arc::new(Ramp { conductance, width, truncation }),
        raw::HeatTerm::Power { coefficient, exponent, truncation } => {
            Arc::new(PowerConductance { coefficient, exponent, truncation })
        }
        raw::HeatTerm::Pressure { coefficient, exponent, truncation } => {
            Arc::new(PressureConductance { coefficient, exponent, truncation })
        }
        raw::HeatTerm::Gap { conductivity, roughness, truncation } => {
            Arc::new(GapConduction { conductivity, roughness, truncation })
        }
        raw::HeatTerm::Radiation { emissivity, absolute_zero, constant } => {
            Arc::new(Radiation { emissivity, constant, absolute_zero })
        }
    }
}
