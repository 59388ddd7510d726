//! Inputs of a step that are set from the outside: loads, and values in place of those that the case prescribes.

use std::collections::BTreeMap;

use crate::contact::names;
use crate::discretization::Discretization;
use crate::forms;
use crate::mesh::{FacetSet, Mesh};
use crate::problem::{BoundaryCondition, Fault, Problem};
use crate::space::Space;

/// Inputs that hold until they are changed: loads that add to those of the problem, and values that replace those that
/// the problem prescribes.
///
/// Loads act in the whole step. A displacement or a temperature is reached at the end of the step, in proportion to
/// time if the step is made in parts. Inputs belong to no state, so neither a checkpoint nor a saved state holds them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepInputs {
    /// Nodal loads by side, "" for those at all nodes: degree of freedom and value, N and W.
    forces_on: BTreeMap<String, Vec<(usize, f64)>>,
    heat_on: BTreeMap<String, Vec<(usize, f64)>>,
    /// Their sums over all degrees of freedom; empty if nothing is set.
    pub(crate) forces: Vec<f64>,
    pub(crate) heat: Vec<f64>,
    /// Values by number of the prescription in V^h and Q^h, m and K.
    pub(crate) displacements: BTreeMap<usize, Vec<f64>>,
    pub(crate) temperatures: BTreeMap<usize, Vec<f64>>,
    /// θ_F by number of the contact, K.
    pub(crate) foundations: BTreeMap<usize, f64>,
}

/// A prescribed value of the displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// A component along an axis, 0 for x.
    Axis(usize),
    /// The component along the outward normal of a plane side.
    Normal,
}

/// A kind of nodal load.
#[derive(Clone, Copy)]
struct LoadKind {
    name: &'static str,
    /// Numbers per node.
    components: usize,
    /// The equation it acts in.
    equation: &'static str,
    is_solved: bool,
}

impl LoadKind {
    fn force(problem: &Problem) -> LoadKind {
        let is_solved = problem.physics.has_mechanics();
        LoadKind { name: "force", components: problem.mesh.dim, equation: "mechanics", is_solved }
    }

    fn heat(problem: &Problem) -> LoadKind {
        LoadKind { name: "heat", components: 1, equation: "heat", is_solved: problem.physics.has_heat() }
    }

    /// Checks the values of a load at a number of nodes.
    fn check(&self, path: &str, values: &[f64], nodes: usize) -> Result<(), Fault> {
        if !self.is_solved {
            let (name, equation) = (self.name, self.equation);
            let found = format!("{name} in a problem without {equation}");
            let hint = format!("remove the {name}, or solve the case with {equation}");
            return Err(Fault::new(path, found, format!("a problem with {equation}")).hint(hint));
        }
        check_values(path, values, [self.components, self.components * nodes])
    }
}

impl StepInputs {
    /// The inputs without values in place of prescribed ones.
    pub(crate) fn without_prescribed(&self) -> StepInputs {
        StepInputs { displacements: BTreeMap::new(), temperatures: BTreeMap::new(), ..self.clone() }
    }

    /// Sets the force on a side, an edge or points, in N: one number per component, which is spread evenly as the
    /// `force` of the case is, or one vector per node, nodes ascending. It replaces the force set there before.
    ///
    /// # Errors
    /// If the mesh does not have the name, the number of values is another, a value is not finite, or the problem has
    /// no mechanics.
    pub(crate) fn set_force(&mut self, problem: &Problem, on: &str, values: &[f64]) -> Result<(), Fault> {
        let (mesh, kind) = (&*problem.mesh, LoadKind::force(problem));
        let (path, nodes) = (format!("force on \"{on}\""), named(mesh, "force", on)?.node_list());
        kind.check(&path, values, nodes.len())?;
        let spread = || {
            let condition = BoundaryCondition::on(on).force(values.iter().copied());
            forms::f(mesh, &[], &[condition]).at(0.0)
        };
        let entries = if values.len() == kind.components { sparse(&spread()) } else { at(&nodes, values, mesh.dim) };
        self.forces_on.insert(on.to_owned(), entries);
        self.forces = sum(&self.forces_on, mesh.points.len() * mesh.dim);
        Ok(())
    }

    /// Sets forces at all nodes, one vector per node, in N. They add to those on sides and replace those set in this
    /// way before.
    ///
    /// # Errors
    /// Those of [`StepInputs::set_force`], except for the name.
    pub(crate) fn set_forces(&mut self, problem: &Problem, values: &[f64]) -> Result<(), Fault> {
        let (size, kind) = (problem.mesh.points.len() * problem.mesh.dim, LoadKind::force(problem));
        kind.check("forces", values, problem.mesh.points.len())?;
        check_values("forces", values, [size; 2])?;
        self.forces_on.insert(String::new(), sparse(values));
        self.forces = sum(&self.forces_on, size);
        Ok(())
    }

    /// Sets the heat supplied on a side, an edge or points, in W: one number, which is spread evenly, or one per node,
    /// nodes ascending. It replaces the heat set there before.
    ///
    /// # Errors
    /// If the mesh does not have the name, the number of values is another, a value is not finite, or the problem has
    /// no heat equation.
    pub(crate) fn set_heat(&mut self, problem: &Problem, on: &str, values: &[f64]) -> Result<(), Fault> {
        let (mesh, kind) = (&*problem.mesh, LoadKind::heat(problem));
        let set = named(mesh, "heat", on)?;
        let (path, nodes) = (format!("heat on \"{on}\""), set.node_list());
        kind.check(&path, values, nodes.len())?;
        let entries = match values {
            [value] => {
                let condition = BoundaryCondition::on(on).heat_inflow(value / mesh.measure(set));
                sparse(&forms::q(mesh, &crate::field::Field::ZERO, &[condition]).at(0.0))
            }
            _ => at(&nodes, values, 1),
        };
        self.heat_on.insert(on.to_owned(), entries);
        self.heat = sum(&self.heat_on, mesh.points.len());
        Ok(())
    }

    /// Sets the heat supplied at all nodes, one number per node, in W. It adds to that on sides and replaces the one
    /// set in this way before.
    ///
    /// # Errors
    /// Those of [`StepInputs::set_heat`], except for the name.
    pub(crate) fn set_heats(&mut self, problem: &Problem, values: &[f64]) -> Result<(), Fault> {
        let size = problem.mesh.points.len();
        LoadKind::heat(problem).check("heat", values, size)?;
        check_values("heat", values, [size; 2])?;
        self.heat_on.insert(String::new(), sparse(values));
        self.heat = sum(&self.heat_on, size);
        Ok(())
    }

    /// Sets a component of the displacement that the problem prescribes on a side, in m: one number, or one per node,
    /// nodes ascending. At a node of two sides the value counts whose entry in the case is the first.
    ///
    /// # Errors
    /// If the mesh does not have the name, the problem does not prescribe the component there, the number of values is
    /// another, or a value is not finite.
    pub(crate) fn set_displacement(
        &mut self,
        problem: &Problem,
        discrete: &Discretization,
        on: &str,
        along: Along,
        values: &[f64],
    ) -> Result<(), Fault> {
        let key = match along {
            Along::Axis(c) => format!("displacement[{c}]"),
            Along::Normal => "normal_displacement".to_owned(),
        };
        let set = named(&problem.mesh, &key, on)?;
        let number = displacement_number(problem, on, along);
        let prescribed = Replaced { key: &key, on, set, space: &discrete.v, number };
        let (number, values) = prescribed.values(values)?;
        self.displacements.insert(number, values);
        Ok(())
    }

    /// Sets the temperature that the problem prescribes on a side, in K: one number, or one per node, nodes ascending.
    ///
    /// # Errors
    /// Those of [`StepInputs::set_displacement`].
    pub(crate) fn set_temperature(
        &mut self,
        problem: &Problem,
        discrete: &Discretization,
        on: &str,
        values: &[f64],
    ) -> Result<(), Fault> {
        let set = named(&problem.mesh, "temperature", on)?;
        let prescribed = problem.boundary.iter().filter(|condition| condition.temperature.is_some());
        let number = prescribed.map(|condition| &condition.on).position(|name| name == on);
        let number = number.filter(|_| problem.physics.has_heat());
        let (number, values) = Replaced { key: "temperature", on, set, space: &discrete.q, number }.values(values)?;
        self.temperatures.insert(number, values);
        Ok(())
    }

    /// Sets the temperature of the foundation of a contact, in K.
    ///
    /// # Errors
    /// If no contact has the name, the problem does not prescribe the temperature of its foundation, or the value is
    /// not finite.
    pub(crate) fn set_foundation_temperature(
        &mut self,
        problem: &Problem,
        name: &str,
        value: f64,
    ) -> Result<(), Fault> {
        let path = format!("foundation_temperature of \"{name}\"");
        let known = names(&problem.contacts);
        let Some(number) = known.iter().position(|known| known == name) else {
            return Err(unknown(path, "contact", &known));
        };
        let contact = problem.contacts.get(number);
        let found = match contact {
            _ if !problem.physics.has_heat() => Some("a problem without heat"),
            Some(contact) if contact.pair.is_some() => Some("a pair of bodies"),
            Some(contact) if contact.foundation_heat.is_some() => Some("a foundation with a heat capacity"),
            _ => None,
        };
        if let Some(found) = found {
            let hint = "set a side of the other body instead, or remove foundation_heat";
            return Err(Fault::new(path, found, "a foundation whose temperature the case prescribes").hint(hint));
        }
        check_values(&path, &[value], [1; 2])?;
        self.foundations.insert(number, value);
        Ok(())
    }
}

/// A condition whose values are to be replaced.
struct Replaced<'a> {
    key: &'a str,
    on: &'a str,
    set: &'a FacetSet,
    space: &'a Space,
    /// Number of the prescription; `None` if the case prescribes nothing here.
    number: Option<usize>,
}

impl Replaced<'_> {
    /// The number of the prescription, and the values in its order.
    fn values(&self, values: &[f64]) -> Result<(usize, Vec<f64>), Fault> {
        let Replaced { key, on, set, space, number } = *self;
        let path = format!("{key} on \"{on}\"");
        let hint = format!(
            "give the side a {} in [[boundary]], which is then replaced: factors depend on what is prescribed",
            key.split('[').next().unwrap_or(key)
        );
        let Some((number, own)) = number.map(|number| (number, space.nodes_of(number))) else {
            return Err(Fault::new(path, "a value that the case does not prescribe", "a prescribed value").hint(hint));
        };
        if own.is_empty() {
            let found = "a value that earlier entries of [[boundary]] prescribe at all nodes of the side";
            return Err(Fault::new(path, found, "a side with a node of its own").hint("set the other side"));
        }
        let nodes = set.node_list();
        check_values(&path, values, [1, nodes.len()])?;
        let of = |node: &u32| match values {
            [value] => *value,
            _ => nodes.binary_search(node).ok().and_then(|place| values.get(place)).copied().unwrap_or_default(),
        };
        Ok((number, own.iter().map(of).collect()))
    }
}

/// Number of the prescription of a displacement on a side, in the order of
/// [`crate::problem::ProblemData::displacement_space`].
fn displacement_number(problem: &Problem, on: &str, along: Along) -> Option<usize> {
    let mut first = 0;
    for condition in &problem.boundary {
        let count = condition.prescriptions(&problem.mesh).len();
        let components: Vec<bool> = condition.displacement.iter().flatten().map(Option::is_some).collect();
        let before = |end: usize| components.iter().take(end).filter(|given| **given).count();
        let place = match along {
            Along::Axis(c) => components.get(c).is_some_and(|given| *given).then(|| before(c)),
            Along::Normal => condition.normal_displacement.as_ref().map(|_| before(components.len())),
        };
        if let Some(place) = place.filter(|place| *place < count && condition.on == on) {
            return Some(first + place);
        }
        first += count;
    }
    None
}

/// The facets of a name.
pub(crate) fn named<'m>(mesh: &'m Mesh, key: &str, on: &str) -> Result<&'m FacetSet, Fault> {
    mesh.named(on).ok_or_else(|| {
        let known: Vec<String> = mesh.facets.keys().chain(mesh.edges.keys()).cloned().collect();
        unknown(format!("{key} on \"{on}\""), "side", &known)
    })
}

/// The fault of a name that is unknown.
fn unknown(path: String, what: &str, known: &[String]) -> Fault {
    let expected = if known.is_empty() { format!("a {what}, of which there is none") } else { known.join(", ") };
    Fault::new(path, format!("no {what} of this name"), expected)
}

/// Checks the number of values, one of two, and that they are finite.
fn check_values(path: &str, values: &[f64], counts: [usize; 2]) -> Result<(), Fault> {
    let [least, most] = counts;
    if !counts.contains(&values.len()) {
        let number = |n: usize| if n == 1 { "1 number".to_owned() } else { format!("{n} numbers") };
        let expected = if least == most { number(least) } else { format!("{least} or {}", number(most)) };
        return Err(Fault::new(path, number(values.len()), expected).hint("give one per node, nodes ascending"));
    }
    match values.iter().position(|value| !value.is_finite()) {
        Some(place) => {
            let found = format!("{} in place {place}", values.get(place).copied().unwrap_or_default());
            Err(Fault::new(path, found, "finite numbers"))
        }
        None => Ok(()),
    }
}

/// The entries that are not zero.
fn sparse(values: &[f64]) -> Vec<(usize, f64)> {
    values.iter().copied().enumerate().filter(|(_, value)| value.abs() > 0.0).collect()
}

/// Values at nodes by degree of freedom.
fn at(nodes: &[u32], values: &[f64], components: usize) -> Vec<(usize, f64)> {
    let dofs = nodes.iter().flat_map(|&node| (0..components).map(move |c| node as usize * components + c));
    dofs.zip(values.iter().copied()).collect()
}

/// The sum over all degrees of freedom; empty if nothing is set.
fn sum(of: &BTreeMap<String, Vec<(usize, f64)>>, size: usize) -> Vec<f64> {
    let mut sum = vec![0.0; size];
    for (dof, value) in of.values().flatten() {
        sum.get_mut(*dof).into_iter().for_each(|sum| *sum += value);
    }
    sum
}
