//! Loads of regions.

use crate::field::{Coefficient, Field};
use crate::time::During;

/// A body force and a heat source in one region, which add to those of the whole body.
#[derive(Clone, Debug)]
pub struct RegionLoad {
    /// The number of the region, as [`Mesh::regions`](crate::mesh::Mesh::regions) lists them.
    pub region: usize,
    /// f₀ in N/m³, one field per component; empty for zero.
    pub body_force: Vec<Field>,
    /// The acceleration g in m/s² of the body force ϱ g, one field per component, and ϱ in kg/m³, the density of the
    /// material even if inertia is left out. `None` without gravity.
    pub gravity: Option<(Vec<Field>, Coefficient<f64>)>,
    /// q₀ in W/m³.
    pub heat_source: Field,
    /// The phases in which the load acts.
    pub during: During,
    /// Keys of body force and heat source, and of gravity, in the case file: for messages.
    pub keys: [String; 2],
}

impl RegionLoad {
    /// No load in a region.
    #[must_use]
    pub fn on(region: usize) -> RegionLoad {
        RegionLoad {
            region,
            body_force: Vec::new(),
            gravity: None,
            heat_source: Field::ZERO,
            during: During::Run,
            keys: [format!("region[{region}]"), "load".to_owned()],
        }
    }

    /// Its data by their keys: body force, gravity, heat source.
    pub(super) fn fields(&self) -> [Vec<(String, &Field)>; 3] {
        let [own, common] = &self.keys;
        let named = |key: String, (c, field)| (format!("{key}[{c}]"), field);
        let force = self.body_force.iter().enumerate().map(|of| named(format!("{own}.body_force"), of));
        let gravity = self.gravity.iter().flat_map(|(fields, _)| fields).enumerate();
        let gravity = gravity.map(|of| named(format!("{common}.gravity"), of));
        [force.collect(), gravity.collect(), vec![(format!("{own}.heat_source"), &self.heat_source)]]
    }
}
