//! Materials by name: `material = "steel-s235"`, or a table with the key `base`.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::Deserialize;

use super::nearest::meant;
use super::path::Path;
use super::physics::{is_warmed, of_heat, of_mechanics};
use super::place::{At, PathFault};
use super::raw::{self, Coefficient, Elasticity, Expansion, Steady, Tensor};

/// The table of the materials.
const TABLE: &str = include_str!("materials.toml");

/// A named material: isotropic, linear, elastic, with the values of a standard.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct KnownMaterial {
    /// Its description.
    pub title: String,
    /// Source of its values.
    pub source: String,
    /// Density in kg/m³.
    pub density: f64,
    /// Young's modulus in Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Mean coefficient of thermal expansion in 1/K.
    pub expansion_coefficient: f64,
    /// Specific heat in J/(kg K).
    pub specific_heat: f64,
    /// Heat conductivity in W/(m K).
    pub conductivity: f64,
}

/// The materials that a case may name.
#[must_use]
pub fn materials() -> &'static BTreeMap<String, KnownMaterial> {
    static ALL: LazyLock<BTreeMap<String, KnownMaterial>> = LazyLock::new(|| toml::from_str(TABLE).unwrap_or_default());
    &ALL
}

/// Fills in the missing keys of named materials; faults go to the findings.
///
/// A named material has keys of mechanics and of heat, which decide on the equations of a case. The keys of an equation
/// are filled in only if another key of the case belongs to it. If none belongs to either, both are.
pub(super) fn fill(raw: &mut raw::Case, findings: &mut Vec<PathFault>) {
    let given = |m: &raw::Material| {
        let coupled = m.expansion.is_some() || m.expansion_coefficient.is_some() || m.coupling.is_some();
        let moves = m.density.is_some() || m.elasticity.is_some() || m.viscosity.is_some() || !m.prony.is_empty();
        let conducts = m.heat_capacity.is_some() || m.conductivity.is_some();
        [moves || coupled || m.stress_state.is_some(), conducts || coupled]
    };
    let of_materials =
        raw.region.iter().filter_map(|region| region.material.as_ref()).chain([&raw.material]).map(given);
    let [moves, conducts] = of_materials.fold(
        [!of_mechanics(raw).is_empty(), !of_heat(raw).is_empty()],
        |[moves, conducts], [also_moves, also_conducts]| [moves || also_moves, conducts || also_conducts],
    );
    // A given temperature replaces the heat equation.
    let is_warmed = is_warmed(raw);
    let equations = [moves || !conducts || is_warmed, (conducts || !moves) && !is_warmed];
    let expands = equations[0] && (equations[1] || is_warmed);
    let own = raw.region.iter_mut().enumerate();
    let own = own.filter_map(|(i, region)| Some((format!("region[{i}].material"), region.material.as_mut()?)));
    for (prefix, material) in std::iter::once(("material".to_owned(), &mut raw.material)).chain(own) {
        let mut note = |key: &str, found: String, expected: String, hint: Option<String>| {
            let path = Path::parse(&format!("{prefix}.{key}")).unwrap_or_default();
            findings.push(PathFault::new(path, At::Value, found, expected).hint(hint));
        };
        let Some(name) = &material.base else {
            if material.stress_state.is_some() {
                let found = "a stress state without `base`".to_owned();
                note("stress_state", found, "`elasticity.stress_state`".to_owned(), None);
            }
            continue;
        };
        if let Some(known) = materials().get(name) {
            known.complete(material, equations, expands);
            continue;
        }
        let names: Vec<&str> = materials().keys().map(String::as_str).collect();
        let near = meant(name, &names);
        let hint = near.unwrap_or_else(|| "`amontons materials` lists them".to_owned());
        note("base", format!("\"{}\"", name.escape_debug()), "the name of a material".to_owned(), Some(hint));
        // A placeholder, so that nothing else is reported missing.
        materials().values().take(1).for_each(|known| known.complete(material, equations, expands));
    }
}

impl KnownMaterial {
    /// Fills in the missing keys of the equations, mechanics and heat, and that of the expansion.
    fn complete(&self, material: &mut raw::Material, [mechanics, heat]: [bool; 2], expands: bool) {
        let number = Coefficient::Number;
        if mechanics {
            material.density.get_or_insert(Steady::Number(self.density));
            let stress_state = material.stress_state;
            material.elasticity.get_or_insert_with(|| Elasticity::Isotropic {
                young: number(self.young),
                poisson: number(self.poisson),
                stress_state,
            });
        }
        if heat {
            material.heat_capacity.get_or_insert(number(self.density * self.specific_heat));
            material.conductivity.get_or_insert(Tensor::Multiple(number(self.conductivity)));
        }
        if expands && material.expansion.is_none() {
            material.expansion_coefficient.get_or_insert(Expansion::Isotropic(number(self.expansion_coefficient)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_is_one() {
        assert!(toml::from_str::<BTreeMap<String, KnownMaterial>>(TABLE).is_ok());
        assert!(materials().len() >= 20);
        for (name, m) in materials() {
            assert!(!m.title.is_empty() && m.source.contains("EN "), "{name}");
            // Each value must be within the range of solids, so that a wrong power of ten is found.
            for (value, [low, high]) in [
                (m.density, [2e3, 9e3]),
                (m.young, [2e10, 3e11]),
                (m.poisson, [0.15, 0.35]),
                (m.expansion_coefficient, [5e-6, 3e-5]),
                (m.specific_heat, [400.0, 1000.0]),
                (m.conductivity, [0.9, 400.0]),
            ] {
                assert!((low..high).contains(&value), "{name}: {value}");
            }
        }
    }
}
