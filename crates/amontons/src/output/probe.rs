//! Probes: numbers recorded after every step, at a point, over a side or over a region.

use std::collections::{BTreeMap, BTreeSet};

use super::cells::Tables;
use super::probe_place::{Probe, ProbeError, ProbePlace, Take};
use super::probe_take::{faced, on_contact, reduce};
use super::quantity::{Base, ContactQuantity, OF_WHOLE, Quantity, Selection};
use super::recovery::{Recovery, SamplingPoint, Stencil, evaluate, sampling};
use super::whole::{WholeInPhases, WholeQuantity};
use super::{PointValues, Snapshot};
use crate::contact::{Contact, ContactBoundary, Pair, Shares, names, read, read_vector};
use crate::convergence::Locator;
use crate::element::{Element, ShapeTable};
use crate::mesh::{Block, CellMap, FacetMap, FacetSet, Mesh};
use crate::problem::{Problem, ProblemData};
use crate::quadrature::{QuadratureRule, rule};
use crate::tensor::{Point, length};

/// Probes of a problem, prepared: weights of nodes and of sampling points.
#[derive(Debug)]
pub struct ProbeSet {
    dim: usize,
    names: Vec<String>,
    probes: Vec<Prepared>,
    tables: Tables,
    samples: Vec<SamplingPoint>,
}

#[derive(Debug)]
struct Prepared {
    quantity: Quantity,
    take: Option<Take>,
    /// Contact points of a quantity of contact.
    contact: OnPoints,
    /// A quantity of a side as a whole.
    whole: Option<WholeInPhases>,
    spots: Vec<Spot>,
}

/// Contact points that a probe reads.
#[derive(Debug, Default)]
struct OnPoints {
    /// Contact points with their shares in a value, and the weight of the value.
    values: Vec<(Shares, f64)>,
    /// Contacts that are read on the side which does not bear the points: vectors change their sign.
    turned: Vec<usize>,
    /// A side of a pair whose depth of wear is read instead of points.
    worn: Option<String>,
}

/// A point where a quantity is evaluated.
#[derive(Debug, Default)]
struct Spot {
    weight: f64,
    normal: Point,
    /// Nodes with the values of their shape functions.
    nodes: Vec<(u32, f64)>,
    /// Sampling points with their weights, by number once all probes are known.
    samples: Stencil,
    numbers: Vec<(usize, f64)>,
}

impl ProbeSet {
    /// Prepares probes for a problem.
    ///
    /// # Errors
    /// The number of the first probe that cannot be read, and the reason.
    pub fn new(problem: &Problem, probes: &[Probe]) -> Result<ProbeSet, (usize, ProbeError)> {
        let mesh = &problem.mesh;
        let (mut builder, mut prepared, mut names) = (ProbeBuilder::new(problem), Vec::new(), Vec::new());
        for (i, probe) in probes.iter().enumerate() {
            let named = |error| (i, error);
            let (contact, whole, spots) = if OF_WHOLE.contains(&probe.quantity.base) {
                ProbeSet::check(&problem.clone().into_data(), probe).map_err(named)?;
                let whole = WholeInPhases::new(problem, probe).map_err(named)?;
                (OnPoints::default(), Some(whole), Vec::new())
            } else {
                let (contact, spots) = builder.spots(probe).map_err(named)?;
                (contact, None, spots)
            };
            prepared.push(Prepared { quantity: probe.quantity, take: probe.place.take(), contact, whole, spots });
            names.extend(probe.quantity.columns(mesh.dim).into_iter().map(|ending| format!("{}{ending}", probe.name)));
        }
        let samples: BTreeSet<SamplingPoint> =
            prepared.iter().flat_map(|p| &p.spots).flat_map(|spot| &spot.samples).map(|(sample, _)| *sample).collect();
        let samples: Vec<SamplingPoint> = samples.into_iter().collect();
        for spot in prepared.iter_mut().flat_map(|p| &mut p.spots) {
            let numbered = spot
                .samples
                .drain(..)
                .filter_map(|(sample, weight)| Some((samples.binary_search(&sample).ok()?, weight)));
            spot.numbers = numbered.collect();
        }
        Ok(ProbeSet { dim: mesh.dim, names, probes: prepared, tables: Tables::new(problem, points), samples })
    }

    /// Checks that a probe can be read in a problem.
    ///
    /// # Errors
    /// The reason why not.
    pub fn check(problem: &ProblemData, probe: &Probe) -> Result<(), ProbeError> {
        ProbeBuilder::new(problem).check(probe).map(|_| ())
    }

    /// Names of the columns, those of one probe together.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.names
    }

    /// The nodes whose values the probes read, or `None` if a probe reads contact points or a side as a whole.
    pub(crate) fn nodes(&self, mesh: &Mesh) -> Option<BTreeSet<u32>> {
        let mut nodes = BTreeSet::new();
        for probe in &self.probes {
            if probe.whole.is_some() || matches!(probe.quantity.base, Base::Contact(_)) {
                return None;
            }
            nodes.extend(probe.spots.iter().flat_map(|spot| &spot.nodes).map(|(node, _)| *node));
        }
        for &(block, cell, _) in &self.samples {
            let cells = mesh.blocks.get(block as usize).map(Block::cells);
            nodes.extend(cells.and_then(|mut cells| cells.nth(cell as usize)).into_iter().flatten().copied());
        }
        Some(nodes)
    }

    /// The values at a time, one per column. A contact pressure is NaN at t = 0, where it is not known.
    #[must_use]
    pub fn values(&self, now: &Snapshot) -> Vec<f64> {
        let points = evaluate(now.problem, now.state, &self.tables, &self.samples);
        self.probes.iter().flat_map(|probe| probe.values(self.dim, now, &points)).collect()
    }
}

impl Prepared {
    fn values(&self, dim: usize, now: &Snapshot, points: &[PointValues]) -> Vec<f64> {
        if let Some(whole) = &self.whole {
            return self.quantity.parts(dim, &whole.value(now));
        }
        if let Base::Contact(quantity) = self.quantity.base {
            return self.on_points(dim, now, quantity);
        }
        let mut all: Vec<(f64, Vec<f64>)> = Vec::with_capacity(self.spots.len());
        for spot in &self.spots {
            let (mut nodal, mut point, mut values) = ([0.0; 3], PointValues::default(), Vec::new());
            for &(node, weight) in &spot.nodes {
                let at_node = self.quantity.at_node(now.state, dim, node as usize);
                nodal.iter_mut().zip(at_node).for_each(|(sum, v)| *sum += weight * v);
            }
            for &(number, weight) in &spot.numbers {
                if let Some(values) = points.get(number) {
                    point.add(weight, values);
                }
            }
            self.quantity.values(dim, &nodal, &point, &spot.normal, &mut values);
            all.push((spot.weight, values));
        }
        let count = all.first().map_or(0, |(_, values)| values.len());
        (0..count).map(|c| reduce(self.take, all.iter().map(|(weight, values)| (*weight, values[c])))).collect()
    }
}

impl Prepared {
    /// The values of a quantity of contact.
    fn on_points(&self, dim: usize, now: &Snapshot, quantity: ContactQuantity) -> Vec<f64> {
        if let Some(side) = &self.contact.worn {
            let of_side = now.discretization.worn.of_side(side, &now.state.surface.worn.depths);
            return vec![of_side.map_or(0.0, |of_side| reduce(self.take, faced(of_side).into_iter()))];
        }
        let points = &now.discretization.boundary.points;
        let turned = |i: usize| points.get(i).is_some_and(|point| self.contact.turned.contains(&point.contact));
        let value = |i: usize| {
            let value = on_contact(now, quantity, i);
            let is_vector = matches!(quantity, ContactQuantity::Traction | ContactQuantity::SlipVelocity);
            if is_vector && turned(i) { value.map(|component| 0.0 - component) } else { value }
        };
        let mean = |shares: &[(usize, f64)]| match (shares, quantity) {
            (&[(i, _)], _) => value(i),
            (_, ContactQuantity::Traction) => read_vector(shares, value),
            _ => [read(shares, |i| value(i)[0]), 0.0, 0.0],
        };
        let contact_of = |i: usize| now.problem.contacts.get(points.get(i)?.contact);
        let is_updated = |contact: &Contact| contact.pair.as_ref().is_some_and(Pair::is_updated);
        // The weights of an updated pair change in every step. All others are those of the mesh, which is not that of
        // the report where a probe is differentiated by the size of a body.
        let weight = |shares: &[(usize, f64)], weight: f64| match (shares, self.take) {
            (&[(i, _)], Some(_)) if contact_of(i).is_some_and(is_updated) => {
                now.report.and_then(|report| report.contact.weights.get(i)).copied().unwrap_or(weight)
            }
            _ => weight,
        };
        let of = |(shares, w): &(Shares, f64)| (weight(shares, *w), self.quantity.parts(dim, &mean(shares)));
        let all = faced(self.contact.values.iter().map(of));
        let count = self.quantity.columns(dim).len();
        (0..count).map(|c| reduce(self.take, all.iter().map(|(weight, values)| (*weight, values[c])))).collect()
    }
}

/// The points of a cell: first those of the recovery, then those of a rule for integrals of expressions linear in the
/// gradients.
fn points(element: &Element) -> QuadratureRule {
    let (mut all, integral) = (sampling(element), rule(element.shape, integral_degree(element)));
    all.points.extend(integral.points);
    all.weights.extend(integral.weights);
    all
}

/// Degree of the rules of integrals: of the fields times the Jacobian of a curved element or 2πr.
fn integral_degree(element: &Element) -> usize {
    2 * element.degree
}

/// The place of a probe in a mesh.
enum LocatedProbe<'a> {
    /// Contact points with their weights, and the contacts whose vectors change sign.
    Contact(Vec<(usize, f64)>, Vec<usize>),
    /// The depth of wear of a side of a pair.
    Worn,
    /// A quantity of a side as a whole.
    Whole,
    Point {
        block: usize,
        cell: usize,
        x: Point,
    },
    Side(&'a FacetSet, Take),
    Region(usize, Take),
}

/// Data that a probe reads: contact points, or spots in the body.
type ProbeData = (OnPoints, Vec<Spot>);

/// Prepares probes; each patch of the recovery is computed once.
struct ProbeBuilder<'a> {
    problem: &'a ProblemData,
    mesh: &'a Mesh,
    locator: Option<Locator<'a>>,
    boundary: Option<ContactBoundary>,
    recovery: Option<Recovery<'a>>,
    stencils: BTreeMap<(usize, u32), Stencil>,
}

impl<'a> ProbeBuilder<'a> {
    fn new(problem: &'a ProblemData) -> ProbeBuilder<'a> {
        ProbeBuilder {
            problem,
            mesh: &problem.mesh,
            locator: None,
            boundary: None,
            recovery: None,
            stencils: BTreeMap::new(),
        }
    }

    fn spots(&mut self, probe: &Probe) -> Result<ProbeData, ProbeError> {
        let quantity = probe.quantity;
        let spots = match self.check(probe)? {
            LocatedProbe::Contact(points, turned) => {
                // Tractions alternate between the nodes of quadratic facets: extremes are taken of their means about
                // vertices.
                let is_traction =
                    matches!(quantity.base, Base::Contact(ContactQuantity::Pressure | ContactQuantity::Traction));
                let is_extreme = matches!(probe.place.take(), Some(Take::Max | Take::Min));
                let extremes = match &probe.place {
                    ProbePlace::On(name, _) if is_traction && is_extreme => {
                        self.vertex_means(|contact, _| contact.bearing() == name)
                    }
                    ProbePlace::Contact(name, _) if is_traction && is_extreme => {
                        self.vertex_means(|_, called| called == name)
                    }
                    _ => None,
                };
                let alone = || points.iter().map(|&(i, weight)| (vec![(i, 1.0)], weight)).collect();
                let values = extremes.unwrap_or_else(alone);
                return Ok((OnPoints { values, turned, worn: None }, Vec::new()));
            }
            LocatedProbe::Worn => {
                let worn = if let ProbePlace::On(name, _) = &probe.place { Some(name.clone()) } else { None };
                return Ok((OnPoints { worn, ..OnPoints::default() }, Vec::new()));
            }
            LocatedProbe::Whole => return Ok((OnPoints::default(), Vec::new())),
            LocatedProbe::Point { block, cell, x } => vec![self.at(quantity, block, cell, &x)],
            LocatedProbe::Side(set, take) => self.on(quantity, set, take),
            LocatedProbe::Region(region, Take::Mean | Take::Integral) => self.within(quantity, region),
            LocatedProbe::Region(region, Take::Max | Take::Min) => self.at_nodes(quantity, region),
        };
        Ok((OnPoints::default(), spots))
    }

    /// Checks that the body has the quantity at the place of the probe. Returns the place in the mesh.
    fn check(&mut self, probe: &Probe) -> Result<LocatedProbe<'a>, ProbeError> {
        let (mesh, quantity) = (self.mesh, probe.quantity);
        let on_side = matches!(probe.place, ProbePlace::On(..) | ProbePlace::Contact(..));
        let physics = self.problem.physics;
        let is_solved = match quantity.base {
            Base::Temperature => physics.has_temperature(),
            Base::HeatFlux | Base::ReactionHeat => physics.has_heat(),
            _ => physics.has_mechanics(),
        };
        match (quantity.base, quantity.part) {
            _ if !is_solved => return Err(ProbeError::Absent(quantity.name())),
            _ if probe.about.is_some() && !quantity.is_moment() => return Err(ProbeError::About(quantity.name())),
            (Base::Hoop, _) if !mesh.axisymmetric => return Err(ProbeError::Hoop),
            (_, Selection::Normal) if !on_side => return Err(ProbeError::Normal(quantity.name())),
            _ if !quantity.has_component(mesh.dim) => {
                return Err(ProbeError::Component { name: quantity.name(), dim: mesh.dim });
            }
            _ => {}
        }
        let of_contact = matches!(quantity.base, Base::Contact(_));
        match &probe.place {
            ProbePlace::Contact(..) | ProbePlace::AtContact(..) if !of_contact => {
                Err(ProbeError::OfBody(quantity.name()))
            }
            _ if OF_WHOLE.contains(&quantity.base) => {
                WholeQuantity::new(self.problem, probe).map(|_| LocatedProbe::Whole)
            }
            ProbePlace::Contact(name, _) => self.of_contact(name),
            ProbePlace::AtContact(point, name) => {
                let only = self.contact(name)?;
                self.on_contact(point, Some(only)).ok_or_else(|| ProbeError::Contact(quantity.name()))
            }
            ProbePlace::At(point) if of_contact => {
                let found = self.on_contact(point, None).ok_or_else(|| ProbeError::Contact(quantity.name()))?;
                self.alone(found)
            }
            ProbePlace::At(point) => self.find(point),
            ProbePlace::On(side, take) => {
                let set =
                    mesh.facets.get(side).ok_or_else(|| ProbeError::Side(mesh.facets.keys().cloned().collect()))?;
                let Base::Contact(of) = quantity.base else { return Ok(LocatedProbe::Side(set, *take)) };
                self.of_side(side, of).ok_or_else(|| ProbeError::Contact(quantity.name()))
            }
            ProbePlace::Region(..) if of_contact => Err(ProbeError::Contact(quantity.name())),
            ProbePlace::Region(name, take) => {
                let region = mesh
                    .regions
                    .iter()
                    .position(|known| known == name)
                    .ok_or_else(|| ProbeError::Region(mesh.regions.clone()))?;
                Ok(LocatedProbe::Region(region, *take))
            }
        }
    }

    /// Means about the vertices of the sides of selected contacts, with weight 1 each, or `None` if no contact is
    /// selected.
    fn vertex_means(&mut self, is_meant: impl Fn(&Contact, &str) -> bool) -> Option<Vec<(Shares, f64)>> {
        let (mesh, problem) = (self.mesh, self.problem);
        let called = names(&problem.contacts);
        let all = problem.contacts.iter().zip(&called).enumerate();
        let mut means = Vec::new();
        for (number, (contact, _)) in all.filter(|(_, (contact, called))| is_meant(contact, called)) {
            let set = mesh.facets.get(contact.bearing())?;
            let of_contact = self.boundary().vertex_means(mesh, number, set).into_iter();
            means.extend(of_contact.map(|shares| (shares, 1.0)));
        }
        (!means.is_empty()).then_some(means)
    }

    /// The number of a contact by its name.
    fn contact(&self, name: &str) -> Result<usize, ProbeError> {
        let known = names(&self.problem.contacts);
        known.iter().position(|known| known == name).ok_or(ProbeError::NoContact(known))
    }

    /// The points of a contact by its name.
    fn of_contact(&mut self, name: &str) -> Result<LocatedProbe<'a>, ProbeError> {
        let number = self.contact(name)?;
        let is_turned = self.problem.contacts.get(number).is_some_and(|contact| contact.sign() < 0.0);
        let points = self.boundary().points.iter().enumerate().filter(|(_, point)| point.contact == number);
        let points = points.map(|(i, point)| (i, point.weight)).collect();
        Ok(LocatedProbe::Contact(points, if is_turned { vec![number] } else { Vec::new() }))
    }

    /// Returns the points, or an error if their side bears the points of several contacts.
    fn alone(&mut self, found: LocatedProbe<'a>) -> Result<LocatedProbe<'a>, ProbeError> {
        let LocatedProbe::Contact(points, _) = &found else { return Ok(found) };
        let contacts = &self.problem.contacts;
        let first = points.first().map(|(i, _)| *i);
        let number = first.and_then(|i| Some(self.boundary().points.get(i)?.contact));
        let Some(side) = number.and_then(|number| contacts.get(number)).map(Contact::bearing) else {
            return Ok(found);
        };
        let of_side = contacts.iter().zip(names(contacts)).filter(|(contact, _)| contact.bearing() == side);
        let of_side: Vec<String> = of_side.map(|(_, name)| name).collect();
        if of_side.len() > 1 { Err(ProbeError::Several(of_side)) } else { Ok(found) }
    }

    fn boundary(&mut self) -> &ContactBoundary {
        self.boundary.get_or_insert_with(|| self.problem.contact_boundary())
    }

    /// Contact points for interpolation at a point of Γ_C: those of the nodes of the cell there, weighted by its shape
    /// functions, or the nearest one with Gauss quadrature or if a node has none. `None` for a point off Γ_C. Of
    /// several contacts the first one there counts, or `only`.
    fn on_contact(&mut self, point: &Point, only: Option<usize>) -> Option<LocatedProbe<'a>> {
        let mesh = self.mesh;
        let (block, cell, x) = self.locator.get_or_insert_with(|| Locator::new(mesh)).place(point)?;
        let (element, nodes) = (mesh.blocks[block].element, mesh.blocks[block].cells().nth(cell)?);
        let mut values = vec![0.0; nodes.len()];
        (element.shape_functions)(&x, &mut values);
        let boundary = self.boundary();
        let on_contact = |node: u32| boundary.nodes.binary_search(&node).ok();
        let elsewhere: f64 = nodes
            .iter()
            .zip(&values)
            .filter(|(node, _)| on_contact(**node).is_none())
            .map(|(_, value)| value.abs())
            .sum();
        if elsewhere > 1e-6 {
            return None;
        }
        // A point that belongs to one node represents it.
        let point_of = |node: usize| {
            let is_of = |own: usize, contact: usize| own == node && only.is_none_or(|only| only == contact);
            let mut points = boundary.points.iter();
            points.position(|point| matches!(point.nodes[..point.own], [(own, _)] if is_of(own, point.contact)))
        };
        let weights: Option<Vec<(usize, f64)>> = nodes
            .iter()
            .zip(&values)
            .filter(|(_, value)| value.abs() > 1e-9)
            .filter_map(|(&node, &value)| Some((on_contact(node)?, value)))
            .map(|(node, value)| Some((point_of(node)?, value)))
            .collect();
        let away = |at: &Point| length(&std::array::from_fn(|c| at[c] - point[c]));
        let nearest = || {
            boundary
                .points
                .iter()
                .enumerate()
                .filter(|(_, point)| only.is_none_or(|only| only == point.contact))
                .min_by(|(_, a), (_, b)| away(&a.x).total_cmp(&away(&b.x)))
                .map(|(i, _)| vec![(i, 1.0)])
        };
        let points = weights.filter(|weights| !weights.is_empty()).or_else(nearest)?;
        let contacts = self.problem.contacts.iter().enumerate();
        let turned = contacts.filter(|(_, contact)| contact.sign() < 0.0).map(|(i, _)| i).collect();
        Some(LocatedProbe::Contact(points, turned))
    }

    /// The points of the contacts of a side, on either side of a pair, or the depth of wear of a side of a pair. `None`
    /// for a side without contact.
    fn of_side(&mut self, side: &str, quantity: ContactQuantity) -> Option<LocatedProbe<'a>> {
        let contacts = &self.problem.contacts;
        let of_side = |contact: &Contact| contact.sides().any(|name| name == side);
        let all: Vec<usize> = (0..contacts.len()).filter(|&i| of_side(&contacts[i])).collect();
        if all.is_empty() {
            return None;
        }
        if quantity == ContactQuantity::Wear && all.iter().any(|&i| contacts[i].pair.is_some()) {
            return Some(LocatedProbe::Worn);
        }
        let turned = all.iter().copied().filter(|&i| contacts[i].bearing() != side).collect();
        let points = self.boundary().points.iter().enumerate().filter(|(_, point)| all.contains(&point.contact));
        Some(LocatedProbe::Contact(points.map(|(i, point)| (i, point.weight)).collect(), turned))
    }

    fn find(&mut self, point: &Point) -> Result<LocatedProbe<'a>, ProbeError> {
        let mesh = self.mesh;
        let found = self.locator.get_or_insert_with(|| Locator::new(mesh)).place(point);
        let reach = |fold: fn(f64, f64) -> f64| {
            (0..mesh.dim).filter_map(|d| mesh.points.iter().map(|p| p[d]).reduce(fold)).collect()
        };
        let outside = || ProbeError::Outside { low: reach(f64::min), high: reach(f64::max) };
        found.map(|(block, cell, x)| LocatedProbe::Point { block, cell, x }).ok_or_else(outside)
    }

    /// The recovered value at a node of a region.
    fn stencil(&mut self, region: usize, node: u32) -> &Stencil {
        let recovery = self.recovery.get_or_insert_with(|| Recovery::new(self.mesh));
        self.stencils.entry((region, node)).or_insert_with(|| recovery.stencil(region, node))
    }

    /// A spot in a region, given by nodes and the values of their shape functions.
    fn spot(&mut self, quantity: Quantity, region: usize, nodes: &[u32], values: &[f64]) -> Spot {
        let mut spot = Spot { weight: 1.0, ..Spot::default() };
        for (&node, &value) in nodes.iter().zip(values) {
            if quantity.is_nodal() {
                spot.nodes.push((node, value));
            } else {
                spot.samples
                    .extend(self.stencil(region, node).iter().map(|(sample, weight)| (*sample, value * weight)));
            }
        }
        spot
    }

    /// The point of a cell with these reference coordinates.
    fn at(&mut self, quantity: Quantity, block: usize, cell: usize, x: &Point) -> Spot {
        let block = &self.mesh.blocks[block];
        let n = block.element.nodes.len();
        let mut values = vec![0.0; n];
        (block.element.shape_functions)(x, &mut values);
        self.spot(quantity, block.region, &block.nodes[cell * n..(cell + 1) * n], &values)
    }

    /// Points of the facets of a side: their nodes, or quadrature points.
    fn on(&mut self, quantity: Quantity, set: &FacetSet, take: Take) -> Vec<Spot> {
        let (mesh, cells) = (self.mesh, self.mesh.cells_of(set));
        let table = |element: &'static Element| match take {
            Take::Max | Take::Min => ShapeTable::at(element, element.nodes),
            Take::Mean | Take::Integral => {
                ShapeTable::new(element, integral_degree(element) + usize::from(mesh.axisymmetric))
            }
        };
        let tables: Vec<ShapeTable> = set.blocks.iter().map(|block| table(block.element)).collect();
        let (mut spots, mut cells) = (Vec::new(), cells.into_iter());
        for (block, table) in set.blocks.iter().zip(&tables) {
            let mut map = FacetMap::new(mesh, table);
            for (nodes, cell) in block.nodes.chunks_exact(block.element.nodes.len()).zip(&mut cells) {
                let region = cell.map_or(0, |(block, _)| mesh.blocks[block].region);
                for q in 0..table.len() {
                    map.at(nodes, q);
                    let spot = self.spot(quantity, region, nodes, map.values());
                    spots.push(Spot { weight: table.weights[q] * map.area, normal: map.normal, ..spot });
                }
            }
        }
        spots
    }

    /// The nodes of a region.
    fn at_nodes(&mut self, quantity: Quantity, region: usize) -> Vec<Spot> {
        let nodes = self
            .recovery
            .get_or_insert_with(|| Recovery::new(self.mesh))
            .nodes
            .get(region)
            .cloned()
            .unwrap_or_default();
        nodes.into_iter().map(|node| self.spot(quantity, region, &[node], &[1.0])).collect()
    }

    /// Points of a rule in the cells of a region.
    fn within(&self, quantity: Quantity, region: usize) -> Vec<Spot> {
        let (mut spots, nodal) = (Vec::new(), quantity.is_nodal());
        for (b, block) in self.mesh.blocks.iter().enumerate().filter(|(_, block)| block.region == region) {
            let (table, first) =
                (ShapeTable::of_rule(block.element, points(block.element)), sampling(block.element).points.len());
            let mut map = CellMap::new(self.mesh, &table);
            for (c, nodes) in block.cells().enumerate() {
                for q in first..table.len() {
                    map.at(nodes, q);
                    let at_nodes = nodes.iter().copied().zip(map.values().iter().copied()).filter(|_| nodal).collect();
                    let samples = if nodal { Vec::new() } else { vec![((b as u32, c as u32, q as u32), 1.0)] };
                    spots.push(Spot {
                        weight: table.weights[q] * map.measure,
                        nodes: at_nodes,
                        samples,
                        ..Spot::default()
                    });
                }
            }
        }
        spots
    }
}
