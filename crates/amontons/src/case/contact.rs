//! `[contact]`: converts the raw laws to those of the library.

use std::sync::Arc;

use super::build::{Build, side};
use super::coefficient::{Plan, Sites};
use super::laws::{self, Keyed};
use super::place::At;
use super::raw::{self, Datum};
use super::side_facts::SideFacts;
use crate::contact::{
    Contact, ContactBoundary, Fluid, FrictionLaw, Frictionless, HeatLaw, Insulated, LumpedFoundation, NormalLaw,
    Preload, Quadrature, Signorini, WearLaw,
};
use crate::field::{Field, Law, LawKind};
use crate::mesh::Mesh;
use crate::time::During;

/// The law of a contact without one, which a case with heat only does not evaluate.
fn no_pressure() -> Law<dyn NormalLaw> {
    Signorini.into()
}

impl Build<'_> {
    pub fn contact(&mut self, path: &str, mut raw: raw::Contact, mesh: &Mesh, materials: &SideFacts) -> Contact {
        self.partition(path, &mut raw, materials);
        let pair = self.pair(path, &raw, materials);
        let bearing = pair.as_ref().filter(|pair| pair.on_is_mortar).map_or(&raw.on, |pair| &pair.with).clone();
        let (points, is_pair) = (side(mesh, &bearing), pair.is_some());
        let components = raw.foundation_velocity.len();
        if ![0, self.dim, 3].contains(&components) {
            let expected =
                format!("{} components, or 3 with motion out of the plane or the line of the body", self.dim);
            let found = format!("{components} components");
            self.note(&format!("{path}.foundation_velocity"), At::Value, found, expected, None);
        }
        let quadrature = match raw.quadrature {
            raw::Quadrature::Nodal => Quadrature::Nodal,
            raw::Quadrature::Gauss => Quadrature::Gauss,
        };
        let sites = Sites::new(|| {
            let set = mesh.facets.get(&bearing).filter(|_| !is_pair);
            let at_points = set.map(|set| ContactBoundary::new(mesh, set, quadrature).points).unwrap_or_default();
            points.iter().copied().chain(at_points.into_iter().map(|point| point.x)).collect()
        });
        let (heat, foundation_temperature) = self.exchange(path, raw.heat, &raw.frictional_heat, &sites);
        let foundation_temperature = foundation_temperature
            .map_or(Field::ZERO, |datum| self.field(&format!("{path}.heat.foundation_temperature"), &datum, &points));
        Contact {
            gap: self.field(&format!("{path}.gap"), &raw.gap.unwrap_or_default(), &points),
            quadrature,
            normal: raw.normal.map_or_else(no_pressure, |normal| self.normal(path, &normal, &sites)),
            friction: self.friction(path, &raw.friction, &sites),
            heat,
            foundation_heat: self.foundation_heat(path, raw.foundation, &foundation_temperature),
            foundation_temperature,
            wear_fraction: raw.wear.as_ref().map_or(1.0, raw::Wear::fraction),
            wear: raw.wear.map(|wear| self.wear(path, &wear, &sites)),
            obstacle: raw.obstacle.and_then(|obstacle| self.obstacle(&format!("{path}.obstacle"), &obstacle, &points)),
            foundation_velocity: self.vector(&format!("{path}.foundation_velocity"), &raw.foundation_velocity, &points),
            fluid: raw.fluid.map(|fluid| Fluid {
                pressure: self.field(&format!("{path}.fluid.pressure"), &fluid.pressure, &points),
                from: fluid.from,
                to: fluid.to,
                sealed_above: fluid.sealed_above,
            }),
            preload: raw.preload.map(|preload| Preload {
                force: self.field(&format!("{path}.preload.force"), &preload.force, &[]),
                until: preload.until,
            }),
            during: raw.phases.map_or(During::Run, During::Phases),
            on: raw.on.clone(),
            name: raw.name,
            pair,
        }
    }

    /// The laws of heat exchange and of friction heat, and the temperature of the foundation.
    fn exchange(
        &mut self,
        path: &str,
        raw: raw::Heat,
        frictional: &Datum,
        sites: &Sites,
    ) -> (Law<dyn HeatLaw>, Option<Datum>) {
        let is_sum = matches!(raw, raw::Heat::Sum { .. });
        let (terms, foundation_temperature) = raw.terms();
        let mut all: Vec<Law<dyn HeatLaw>> = Vec::new();
        for (i, term) in terms.iter().enumerate() {
            let at = if is_sum { format!("{path}.heat.laws[{i}]") } else { format!("{path}.heat") };
            all.push(self.heat(&at, laws::heat(term, &self.constants), sites));
        }
        if !matches!(frictional, Datum::Number(value) if *value <= 0.0) {
            all.push(self.heat(path, laws::frictional_heat(frictional), sites));
        }
        let only = if all.len() < 2 { all.pop() } else { None };
        let heat = match only {
            Some(law) => law,
            None if all.is_empty() => Insulated.into(),
            None => Law::sum(all),
        };
        (heat, foundation_temperature)
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

    pub fn wants_components(&mut self, path: &str, found: usize) {
        let expected = format!("{} components", self.dim);
        self.note(path, At::Value, format!("{found} components"), expected, None);
    }

    /// The law at `path` with coefficients that may change with time, `nowhere` away from the sites; `None`, with a
    /// note, if it does not exist everywhere.
    fn contact_law<T: LawKind + ?Sized>(
        &mut self,
        path: &str,
        (keyed, make): (Keyed, laws::MakeLaw<Arc<T>>),
        sites: &Sites,
        nowhere: Arc<T>,
    ) -> Option<Law<T>> {
        let fields = keyed
            .into_iter()
            .map(|(key, datum)| self.coefficient_in_time(&format!("{path}.{key}"), datum, sites))
            .collect();
        self.law(path, &Plan::new(fields, make), sites, nowhere)
    }

    fn normal(&mut self, path: &str, raw: &raw::Normal, sites: &Sites) -> Law<dyn NormalLaw> {
        let law =
            self.contact_law(&format!("{path}.normal"), laws::normal(raw, &self.constants), sites, Arc::new(Signorini));
        law.unwrap_or_else(no_pressure)
    }

    fn friction(&mut self, path: &str, raw: &raw::Friction, sites: &Sites) -> Law<dyn FrictionLaw> {
        if let raw::Friction::Orthotropic { direction, .. } = raw
            && direction.len() != self.dim
        {
            self.wants_components(&format!("{path}.friction.direction"), direction.len());
            return Frictionless.into();
        }
        let law = self.contact_law(
            &format!("{path}.friction"),
            laws::friction(raw, &self.constants),
            sites,
            Arc::new(Frictionless),
        );
        law.unwrap_or_else(|| Frictionless.into())
    }

    fn heat(&mut self, path: &str, plan: laws::HeatPlan, sites: &Sites) -> Law<dyn HeatLaw> {
        self.contact_law(path, plan, sites, Arc::new(Insulated)).unwrap_or_else(|| Insulated.into())
    }

    fn wear(&mut self, path: &str, raw: &raw::Wear, sites: &Sites) -> Law<dyn WearLaw> {
        let law = self.contact_law(&format!("{path}.wear"), laws::wear(raw), sites, Arc::new(laws::NO_WEAR));
        law.unwrap_or_else(|| laws::NO_WEAR.into())
    }
}
