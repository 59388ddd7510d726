//! The checks that make a [`Problem`] of its data.

use std::sync::Arc;

use super::schedule::Schedule;
use super::{Fault, Faults, MaterialSample, Problem, ProblemData, Scheduled, StartState, Support};
use crate::field::{Coefficient, Field};
use crate::mesh::defects::{Component, components};
use crate::mesh::{FacetSet, Mesh};
use crate::time::{Analysis, Steps, TimePhase};

impl ProblemData {
    /// Checks the data and makes them a problem, which does not change any more.
    ///
    /// # Errors
    /// All faults of the data, each with its place as in a case file.
    pub fn check(self) -> Result<Problem, Faults> {
        let mut faults = Vec::new();
        self.check_time(&mut faults);
        self.check_scheme(&mut faults);
        self.check_steady(&mut faults);
        self.check_start(&mut faults);
        self.check_material(&mut faults);
        if let Err(error) = self.mesh.check_nodes() {
            faults.push(Fault::new("mesh", error.to_string(), "cells and facets whose nodes exist"));
            return Err(Faults(faults));
        }
        let in_phases = if self.check_phases(&mut faults) { self.of_phases() } else { Vec::new() };
        let each = |check: fn(&ProblemData, &mut Vec<Fault>), faults: &mut Vec<Fault>| {
            for data in &in_phases {
                let mut found = Vec::new();
                check(data, &mut found);
                // What does not depend on conditions is found in each phase.
                let is_known = |fault: &Fault| {
                    faults.iter().any(|known| (&known.path, &known.found) == (&fault.path, &fault.found))
                };
                found.retain(|fault| in_phases.len() == 1 || !is_known(fault));
                faults.append(&mut found);
            }
        };
        each(ProblemData::check_parts, &mut faults);
        self.check_shapes(&mut faults);
        each(ProblemData::check_boundary, &mut faults);
        each(ProblemData::check_cyclic, &mut faults);
        each(ProblemData::check_rigid, &mut faults);
        drop(in_phases);
        self.check_times(&mut faults);
        if let Err(error) = self.mesh.check() {
            faults.push(Fault::new("mesh", error.to_string(), "cells of positive measure"));
        }
        if faults.is_empty() {
            // Both evaluate the data, which must be in order.
            self.check_mass(&mut faults);
            self.check_temperatures(&mut faults);
            self.check_tables(&mut faults);
            self.check_range(&mut faults);
        }
        if !faults.is_empty() {
            return Err(Faults(faults));
        }
        let all = Arc::new(Scheduled::of(&self));
        let changes = self.changes_conditions();
        let own = Problem(self, Schedule { all, phase: if changes { usize::MAX } else { 0 } });
        let own = own.in_phase(0);
        own.check_pairs_in_phases().map_or(Ok(own), |fault| Err(Faults(vec![fault])))
    }

    /// Checks that a start in equilibrium stands alone.
    fn check_start(&self, faults: &mut Vec<Fault>) {
        if self.initial.state == StartState::Given {
            return;
        }
        let start = &self.initial;
        for (key, what, given) in [
            ("displacement", "a displacement", !start.displacement.is_empty()),
            ("velocity", "a velocity", !start.velocity.is_empty()),
        ] {
            if given {
                let found = format!("{what} besides a start in equilibrium");
                let fault = Fault::new(format!("initial.{key}"), found, "one of the two");
                faults.push(fault.hint("remove it, or remove initial.state"));
            }
        }
        if !self.physics.has_mechanics() {
            let fault = Fault::new("initial.state", "a start in equilibrium without mechanics", "a body that moves");
            faults.push(fault.hint("remove it"));
        }
    }

    fn check_time(&self, faults: &mut Vec<Fault>) {
        let mut start = 0.0;
        for (i, phase) in self.timeline.phases().enumerate() {
            let path = if self.timeline.has_phases() { format!("phase[{i}]") } else { "time".to_owned() };
            if !(phase.end.is_finite() && phase.end > start) {
                let path = format!("{path}.end");
                faults.push(if i == 0 {
                    Fault::new(path, phase.end.to_string(), "a positive time in s")
                } else {
                    let expected = format!("more than {start:?}, the end of the phase before");
                    let hint = "`end` is a time, not a duration; phases stand in their order";
                    Fault::new(path, format!("{:?}", phase.end), expected).hint(hint)
                });
            }
            match &phase.steps {
                Steps::Equal(0) => faults.push(Fault::new(format!("{path}.steps"), "0", "at least one step")),
                Steps::Automatic { accuracy } if !(*accuracy > 0.0 && *accuracy <= Steps::COARSEST) => {
                    let expected = "a number above 0 and at most 0.1";
                    faults.push(Fault::new(format!("{path}.accuracy"), format!("{accuracy:?}"), expected));
                }
                Steps::Automatic { .. } if phase.analysis == Analysis::Steady => {
                    let (found, expected) = ("\"auto\" in a steady phase", "a number of steps");
                    let fault = Fault::new(format!("{path}.steps"), found, expected);
                    faults.push(fault.hint("remove it: a steady state has no error in time, and 1 step finds it"));
                }
                Steps::Equal(_) | Steps::Automatic { .. } | Steps::Made(_) => {}
            }
            start = phase.end;
        }
        if self.timeline.phases().len() == 0 {
            faults.push(Fault::new("phase", "no phase", "at least one"));
        }
    }

    fn check_material(&self, faults: &mut Vec<Fault>) {
        let (found, regions) = (self.materials.len(), self.mesh.regions.len());
        if found != 1 && found != regions {
            faults.push(Fault::new(
                "material",
                format!("{found} materials"),
                format!("one for all, or one for each of the {regions} regions"),
            ));
        }
        for (key, values) in
            [("density", self.values_of(|m| &m.density)), ("heat_capacity", self.values_of(|m| &m.heat_capacity))]
        {
            let Some(MaterialSample { value, x, theta }) =
                values.iter().find(|s| !(s.value.is_finite() && s.value >= 0.0))
            else {
                continue;
            };
            let warm = theta.map(|theta| format!(", θ = {theta:?}")).unwrap_or_default();
            let found = x.map_or(value.to_string(), |x| format!("{value:?} at {}{warm}", self.mesh.place(&x)));
            faults.push(Fault::new(format!("material.{key}"), found, "a number that is not negative"));
        }
    }

    /// What is missing if nothing holds a part of the body in equilibrium or in a phase without inertia, with a hint;
    /// `None` if inertia acts at all times.
    fn without_inertia_in(&self) -> Option<(String, &'static str)> {
        if self.initial.state == StartState::Equilibrium {
            let found = "no displacement prescribed, at a start in equilibrium".to_owned();
            return Some((found, "give `displacement` on a side, or remove initial.state"));
        }
        let phase = self.timeline.phases().find(|phase| !phase.analysis.has_inertia())?;
        let found = format!("no displacement prescribed and no inertia in {}", self.named(phase));
        Some((found, "give `displacement` on a side, or `analysis = \"dynamic\"` for this phase"))
    }

    /// A phase in words; of a run without phases the run.
    fn named(&self, phase: &TimePhase) -> String {
        let name = phase.analysis.name();
        if self.timeline.has_phases() {
            format!("the {name} phase \"{}\"", phase.name)
        } else {
            format!("a {name} run")
        }
    }

    /// Checks that each part of the body with a cell of zero density has a support.
    ///
    /// Likewise a part with a cell of zero heat capacity must have a held temperature. Parts of a pair share supports.
    fn check_parts(&self, faults: &mut Vec<Fault>) {
        let parts = components(&self.mesh);
        let mut part_of = vec![0; self.mesh.points.len()];
        for (number, part) in parts.iter().enumerate() {
            for &node in &part.nodes {
                part_of[node as usize] = number;
            }
        }
        let (is_still, steady) = (self.without_inertia_in().is_some(), self.timeline.first_steady());
        let steady = steady.and_then(|number| self.timeline.phases().nth(number));
        // Per part: displacement held, temperature held; ρ or c missing.
        let mut held = vec![[false; 2]; parts.len()];
        let mut lacks = vec![[false; 2]; parts.len()];
        let foundations = self.contacts.iter().filter(|c| c.pair.is_none() && c.acts());
        let exchange = foundations.map(|c| (c.on.as_str(), [true, c.warms_from_foundation()]));
        let sides =
            self.boundary.iter().map(|b| (b.on.as_str(), [b.holds_body(), b.holds_temperature()])).chain(exchange);
        for (on, holds) in sides {
            // A missing side is reported by `check_sides`; here we assume it could hold every part.
            let nodes = self.mesh.named(on).map(FacetSet::node_list);
            let touched =
                nodes.map(|nodes| nodes.into_iter().filter_map(|node| part_of.get(node as usize).copied()).collect());
            for part in touched.unwrap_or_else(|| (0..parts.len()).collect::<Vec<usize>>()) {
                if let Some(part) = held.get_mut(part) {
                    *part = [part[0] || holds[0], part[1] || holds[1]];
                }
            }
        }
        self.join_parts(&part_of, &mut held);
        for block in &self.mesh.blocks {
            let Some(m) = self.material_of(block.region) else { continue };
            for cell in block.cells() {
                let part = &mut lacks[part_of[cell[0] as usize]];
                let is_zero = |of: &Coefficient<f64>| {
                    cell.iter().all(|&node| self.mesh.points.get(node as usize).is_some_and(|x| of.at(x) == 0.0))
                };
                let is_light = is_still || is_zero(&m.density);
                *part = [part[0] || is_light, part[1] || steady.is_some() || is_zero(&m.heat_capacity)];
            }
        }
        let (no_support, support) = self.without_inertia_in().unwrap_or_else(|| {
            let hint = "give `displacement` on a side, or a positive material.density";
            ("no displacement prescribed and density 0".to_owned(), hint)
        });
        let (no_sink, sink) = self.without_sink(steady);
        for (what, found, expected, hint) in [
            (0, &*no_support, "a part Γ_D that holds the body", support),
            (1, &*no_sink, "a side whose temperature is known", sink),
        ] {
            let solved = [self.physics.has_mechanics(), self.physics.has_heat()][what];
            let Some(number) = (0..parts.len()).find(|&part| solved && lacks[part][what] && !held[part][what]) else {
                continue;
            };
            let found = if parts.len() == 1 {
                found.to_owned()
            } else {
                format!("{found} in part {} of the body, {}", number + 1, extent(&parts[number], &self.mesh))
            };
            faults.push(Fault::new("boundary", found, expected).hint(hint));
        }
    }

    /// What is found, with a hint, where heat has no way to leave.
    fn without_sink(&self, steady: Option<&TimePhase>) -> (String, &'static str) {
        match steady {
            None => (
                "no temperature prescribed and heat_capacity 0".to_owned(),
                "give `temperature` on a side, or a positive material.heat_capacity",
            ),
            Some(phase) => (
                format!("no temperature prescribed in {}, in which no heat is stored", self.named(phase)),
                "give `temperature` or `convection` on a side, or a foundation with a conductance, so that heat can leave",
            ),
        }
    }

    /// Checks that tables have values at all times of the run.
    fn check_times(&self, faults: &mut Vec<Fault>) {
        let mut check = |path: String, field: &Field| {
            let [first, last] = field.span();
            let hint = "give more rows, or `extend = \"hold\"` to keep the value at the end";
            if first > 0.0 {
                faults.push(
                    Fault::new(&*path, format!("a table that begins at t = {first:?}"), "values from t = 0").hint(hint),
                );
            }
            if last < self.timeline.end() {
                faults.push(
                    Fault::new(
                        path,
                        format!("a table that ends at t = {last:?}"),
                        format!("values to the end of the run, t = {:?}", self.timeline.end()),
                    )
                    .hint(hint),
                );
            }
        };
        for datum in self.data() {
            check(datum.key, datum.field);
        }
    }

    /// Checks that vector data have d components.
    fn check_shapes(&self, faults: &mut Vec<Fault>) {
        let dim = self.mesh.dim;
        let mut check = |path: String, found: Option<usize>| {
            if let Some(n) = found
                && n != dim
            {
                faults.push(Fault::new(path, format!("{n} components"), format!("{dim} components")));
            }
        };
        let filled = |v: &Vec<Field>| if v.is_empty() { None } else { Some(v.len()) };
        check("load.body_force".into(), filled(&self.body_force));
        for (i, load) in self.region_loads.iter().enumerate() {
            let [own, common] = &load.keys;
            let is_new = self.region_loads.iter().take(i).all(|before| before.keys[0] != *own);
            check(format!("{own}.body_force"), filled(&load.body_force).filter(|_| is_new));
            // Gravity is the same in all regions.
            let is_first = self.region_loads.iter().take(i).all(|before| before.keys[1] != *common);
            let gravity = load.gravity.as_ref().filter(|_| is_first);
            check(format!("{common}.gravity"), gravity.map(|(fields, _)| fields.len()));
        }
        check("initial.displacement".into(), filled(&self.initial.displacement));
        check("initial.velocity".into(), filled(&self.initial.velocity));
        for (i, b) in self.boundary.iter().enumerate() {
            check(format!("boundary[{i}].displacement"), b.displacement.as_ref().map(Vec::len));
            check(format!("boundary[{i}].traction"), b.traction.as_ref().map(Vec::len));
            check(format!("boundary[{i}].force"), b.force.as_ref().map(Vec::len));
            check(format!("boundary[{i}].spring"), b.spring.as_ref().and_then(Support::components));
            check(format!("boundary[{i}].dashpot"), b.dashpot.as_ref().and_then(Support::components));
        }
    }
}

/// Extent of a part of the body: `x from 0.0 to 1.0, y from 2.0 to 3.0`.
fn extent(part: &Component, mesh: &Mesh) -> String {
    let [low, high] = part.bounds(mesh);
    let along = |(c, axis): (usize, &str)| format!("{axis} from {:?} to {:?}", low[c], high[c]);
    ["x", "y", "z"].into_iter().take(mesh.dim).enumerate().map(along).collect::<Vec<_>>().join(", ")
}
