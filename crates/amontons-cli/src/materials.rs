//! The known materials, in words.

use amontons::case::{self, KnownMaterial};

/// One line per material.
pub fn all() -> String {
    let width = case::materials().keys().map(String::len).max().unwrap_or(0);
    let line = |(name, material): (&String, &KnownMaterial)| format!("{name:width$}  {}\n", material.title);
    let lines: String = case::materials().iter().map(line).collect();
    lines + "\nmaterial = \"NAME\" in a case takes one; `amontons materials NAME` prints its values and their source.\n"
}

/// One material as the table of a case that it replaces.
pub fn one(name: &str, material: &KnownMaterial) -> String {
    let KnownMaterial { title, source, density, young, poisson, .. } = material;
    let KnownMaterial { expansion_coefficient, specific_heat, conductivity, .. } = material;
    let heat_capacity = density * specific_heat;
    format!(
        "# {name}: {title}\n# {source}\n[material]\ndensity = {density:?}\nheat_capacity = {heat_capacity:?}\n\
         conductivity = {conductivity:?}\nexpansion_coefficient = {expansion_coefficient:?}\n\n[material.elasticity]\n\
         law = \"isotropic\"\nyoung = {young:?}\npoisson = {poisson:?}\n"
    )
}
