//! The conditions on the sides of a case.

use super::build::{Build, side};
use super::place::At;
use super::raw::{self, Scalar};
use crate::mesh::Mesh;
use crate::problem::{BoundaryCondition, Convection, Release, Support};
use crate::tensor::Point;
use crate::time::During;

impl Build<'_> {
    /// The conditions of entry `i`.
    pub fn boundary(&mut self, i: usize, raw: raw::Boundary, mesh: &Mesh) -> BoundaryCondition {
        let points = &side(mesh, &raw.on);
        let path = |key: &str| format!("boundary[{i}].{key}");
        let condition = BoundaryCondition {
            displacement: raw.displacement.map(|v| self.components(&path("displacement"), v, points)),
            normal_displacement: raw.normal_displacement.map(|s| self.field(&path("normal_displacement"), &s, points)),
            traction: raw.traction.map(|v| self.vector(&path("traction"), &v, points)),
            force: raw.force.map(|v| self.vector(&path("force"), &v, points)),
            pressure: raw.pressure.map(|s| self.field(&path("pressure"), &s, points)),
            spring: raw.spring.map(|s| self.support(&path("spring"), s, points)),
            dashpot: raw.dashpot.map(|s| self.support(&path("dashpot"), s, points)),
            temperature: raw.temperature.map(|s| self.field(&path("temperature"), &s, points)),
            heat_inflow: raw.heat_inflow.map(|s| self.field(&path("heat_inflow"), &s, points)),
            convection: raw.convection.map(|c| Convection {
                coefficient: self.coefficient(&path("convection.coefficient"), &c.coefficient, points),
                ambient: self.field(&path("convection.ambient"), &c.ambient, points),
            }),
            during: raw.phases.map_or(During::Run, During::Phases),
            release: raw.release.map_or_else(Release::default, |release| match release {
                raw::Releasing::AtOnce => Release::AtOnce,
                raw::Releasing::Phase => Release::InPhase,
            }),
            on: raw.on,
        };
        if condition.is_empty() {
            let expected = "`displacement`, `traction`, `temperature`, `heat_inflow` or another condition";
            self.note(
                &format!("boundary[{i}]"),
                At::Value,
                "a side without a condition",
                expected,
                Some("add a condition or remove the entry: a side without one is free of load and insulated"),
            );
        }
        condition
    }

    fn support(&mut self, path: &str, raw: raw::Support, points: &[Point]) -> Support {
        match raw {
            raw::Support::Number(value) => Support::Normal(self.coefficient(path, &Scalar::Number(value), points)),
            raw::Support::Expression(text) => {
                Support::Normal(self.coefficient(path, &Scalar::Expression(text), points))
            }
            raw::Support::Components(all) => Support::Components(
                all.iter()
                    .enumerate()
                    .map(|(c, scalar)| self.coefficient(&format!("{path}[{c}]"), scalar, points))
                    .collect(),
            ),
        }
    }
}
