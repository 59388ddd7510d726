//! `contact.pvd` and `contact/*.vtu` for ParaView: the sides of contact as surfaces with their results.
//!
//! Every side has its own nodes here, so that a node of two sides has the values of both. A node takes the values of
//! its contact point. A node without one, as with Gauss quadrature and on the mortar side of a pair, takes the mean of
//! the points that it takes part in, weighted by ω |N|.

use std::path::Path;
use std::sync::Arc;

use super::files::{WrittenFile, write_atomically};
use super::shown::{Lives, ResultTable, Shown};
use super::{OutputError, Snapshot};
use crate::contact::mortar::{NodeShare, SectorImage};
use crate::contact::{Contact, ContactBoundary, PointOnBoundary, Quadrature, Status, Supports, names_of_points};
use crate::mesh::{FacetSet, link_of};
use crate::problem::{Physics, with_supports};
use crate::state::ContactReport;
use crate::tensor::Point;
use crate::units::Measure;
use crate::vtu::write::{self as grid, Cells, WrittenArray as Array};

/// An array at the points: name, measured quantity, whether a problem with these equations has it, and values.
struct SurfaceArray {
    name: &'static str,
    measure: Measure,
    is_of: fn(Physics) -> bool,
    value: ArrayValue,
}

/// Nodal unknowns, which are also among the fields of the body.
const UNKNOWNS: [&str; 2] = ["displacement", "temperature"];

enum ArrayValue {
    Scalar(fn(&SideNode) -> f64),
    Vector(fn(&SideNode) -> Point),
    Code(fn(&SideNode) -> i64),
}

const ALWAYS: fn(Physics) -> bool = |_| true;

const fn field(name: &'static str, measure: Measure, is_of: fn(Physics) -> bool, value: ArrayValue) -> SurfaceArray {
    SurfaceArray { name, measure, is_of, value }
}

/// The arrays in their order. `status` is 0 for open, 1 for stick and 2 for slip.
static FIELDS: [SurfaceArray; 11] = [
    field("displacement", Measure::Length, Physics::has_mechanics, ArrayValue::Vector(|node| node.displacement)),
    field("pressure", Measure::Stress, ALWAYS, ArrayValue::Scalar(|node| node.mean.pressure)),
    field("gap", Measure::Length, ALWAYS, ArrayValue::Scalar(|node| node.mean.gap)),
    field("traction", Measure::Stress, ALWAYS, ArrayValue::Vector(|node| node.mean.traction)),
    field("slip_velocity", Measure::Velocity, ALWAYS, ArrayValue::Vector(|node| node.mean.slip)),
    field("status", Measure::Number, ALWAYS, ArrayValue::Code(SideNode::status)),
    field("temperature", Measure::Temperature, Physics::has_temperature, ArrayValue::Scalar(|node| node.temperature)),
    field("heat_flux", Measure::HeatFlux, Physics::has_heat, ArrayValue::Scalar(|node| node.mean.flux)),
    field("wear", Measure::Length, ALWAYS, ArrayValue::Scalar(|node| node.mean.wear)),
    field("friction_work", Measure::SurfaceWork, ALWAYS, ArrayValue::Scalar(|node| node.mean.work)),
    field("weight", Measure::Area, ALWAYS, ArrayValue::Scalar(|node| node.weight)),
];

/// The arrays at the points with the quantities they measure.
pub(crate) fn measures() -> Vec<(String, Measure)> {
    FIELDS.iter().map(|field| (field.name.to_owned(), field.measure)).collect()
}

/// Every array that the files can have.
pub(super) fn shown() -> impl Iterator<Item = Shown> {
    let of = |field: &SurfaceArray| {
        let lives = if UNKNOWNS.contains(&field.name) { Lives::Node } else { Lives::Mean };
        Shown::new(ResultTable::Surface, field.name, Some(field.measure), lives)
    };
    let side = Shown::new(ResultTable::Surface, "side", None, Lives::Whole);
    FIELDS.iter().map(of).chain([side])
}

/// A side of a contact.
pub(crate) struct ContactSide<'a> {
    contact: usize,
    /// Name of the facet set.
    on: &'a str,
    /// Its name; the name of the contact if the side bears the points of several.
    pub name: String,
    /// True if it bears the contact points, false if it faces the side that does.
    bears: bool,
}

/// The sides in the order of their numbers: per contact the side that bears its points, then the side that it faces if
/// that is deformable.
pub(crate) fn sides(contacts: &[Contact]) -> impl Iterator<Item = ContactSide<'_>> {
    contacts.iter().zip(names_of_points(contacts)).enumerate().flat_map(|(i, (contact, name))| {
        let bearing = ContactSide { contact: i, on: contact.bearing(), name, bears: true };
        let facing = contact.facing().map(|on| ContactSide { contact: i, on, name: on.to_owned(), bears: false });
        std::iter::once(bearing).chain(facing)
    })
}

/// Writes the sides of contact after a step.
pub(super) fn write(path: &Path, now: &Snapshot, report: &ContactReport) -> Result<WrittenFile, OutputError> {
    static NONE: FacetSet = FacetSet { blocks: Vec::new() };
    let (problem, mesh) = (now.problem, &now.problem.mesh);
    let boundary = boundary(now, report);
    let mut cells = Cells { connectivity: Vec::new(), ends: Vec::new(), types: Vec::new() };
    let (mut points, mut nodes, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    for (number, side) in sides(&problem.contacts).enumerate() {
        let set = mesh.facets.get(side.on).unwrap_or(&NONE);
        let (of_side, first) = (set.node_list(), nodes.len());
        for (element, facet) in set.facets() {
            let local = facet.iter().filter_map(|node| of_side.binary_search(node).ok());
            cells.connectivity.extend(local.map(|i| (first + i) as i64));
            cells.ends.push(cells.connectivity.len() as i64);
            cells.types.push(element.vtk());
            numbers.push(number as i64);
        }
        points.extend(of_side.iter().filter_map(|&node| mesh.points.get(node as usize).copied()));
        nodes.extend(on_side(now, report, &boundary, &side, &of_side));
    }
    let has = FIELDS.iter().filter(|field| (field.is_of)(problem.physics));
    let arrays: Vec<Array> = has.map(|field| field.array(&nodes)).collect();
    let side = Array::counts("side", numbers);
    write_atomically(path, |out| grid::write(out, &points, cells, &arrays, &[side]))
}

impl SurfaceArray {
    fn array(&self, nodes: &[SideNode]) -> Array<'static> {
        match self.value {
            ArrayValue::Scalar(value) => Array::reals(self.name, 1, nodes.iter().map(value).collect::<Vec<f64>>()),
            ArrayValue::Vector(value) => Array::reals(self.name, 3, nodes.iter().flat_map(value).collect::<Vec<f64>>()),
            ArrayValue::Code(value) => Array::counts(self.name, nodes.iter().map(value).collect()),
        }
    }
}

/// Γ_C as used in the step; after a break, an updated pair is paired anew.
fn boundary(now: &Snapshot, report: &ContactReport) -> Arc<ContactBoundary> {
    let Snapshot { problem, discretization, state, .. } = *now;
    if let Some(boundary) = &report.boundary {
        return Arc::clone(boundary);
    }
    let of = |supports: Supports| discretization.boundary.updated(&problem.contacts, &problem.mesh, &state.u, supports);
    let updated = with_supports(&discretization.v, Some(&discretization.outside), of);
    updated.unwrap_or_else(|| Arc::clone(&discretization.boundary))
}

/// The nodes of a side, ascending, with their values.
fn on_side(
    now: &Snapshot,
    report: &ContactReport,
    boundary: &ContactBoundary,
    side: &ContactSide,
    of_side: &[u32],
) -> Vec<SideNode> {
    let (state, dim) = (now.state, now.problem.mesh.dim);
    let is_nodal = |contact: &Contact| contact.quadrature == Quadrature::Nodal;
    let contact = now.problem.contacts.get(side.contact);
    let is_pair = contact.is_some_and(|contact| contact.pair.is_some());
    let has_own = !is_pair && contact.is_some_and(is_nodal);
    let begin = |&node: &u32| {
        let first = node as usize * dim;
        let component = |c: usize| if c < dim { state.u.get(first + c).copied().unwrap_or(0.0) } else { 0.0 };
        SideNode {
            displacement: std::array::from_fn(component),
            temperature: state.theta.get(node as usize).copied().unwrap_or(0.0),
            ..SideNode::default()
        }
    };
    let worn = contact.map_or(1.0, |contact| contact.wear_fraction);
    let is_on = contact.is_some_and(|contact| side.on == contact.on);
    let mut points: Vec<Vec<OfPoint>> = vec![Vec::new(); of_side.len()];
    for (i, point) in boundary.points.iter().enumerate().filter(|(_, point)| point.contact == side.contact) {
        let Some((values, status, weight)) = SidePointValues::at(now, report, i, point) else { continue };
        let mut values = if side.bears { values } else { values.across() };
        values.wear *= worn;
        let mut add = |node: Option<&u32>, of_point: OfPoint| {
            let place = node.and_then(|node| of_side.binary_search(node).ok());
            points.get_mut(place.unwrap_or(usize::MAX)).into_iter().for_each(|points| points.push(of_point.clone()));
        };
        if is_pair {
            for NodeShare { node, part, turn } in &point.shares[usize::from(!side.bears)] {
                let values = turn.map_or(values, |turn| values.turned(&turn));
                add(Some(node), OfPoint { values, status, weight: weight * part, is_own: false });
            }
        } else {
            for (k, &(node, share)) in point.nodes.iter().enumerate() {
                let (weight, is_own) = if has_own { (weight, k == 0) } else { (weight * share, false) };
                add(boundary.nodes.get(node), OfPoint { values, status, weight, is_own });
            }
        }
    }
    // The depth of wear of a pair is stored on each body, not at the contact points.
    let depths = &state.surface.worn.depths;
    let depth = |node: &u32| now.discretization.worn.depth(side.contact, is_on, *node, depths).unwrap_or(0.0);
    let links = &now.discretization.v.links;
    let made = of_side.iter().map(|node| {
        // A follower shows the values of its leader, but only the leader counts.
        let link = link_of(links, *node).filter(|_| is_pair);
        let place = of_side.binary_search(&link.map_or(*node, |link| link.to)).unwrap_or(usize::MAX);
        let points = points.get(place).map_or(&[][..], Vec::as_slice);
        let mut made = begin(node).with(points, has_own);
        if let Some(link) = link {
            (made.weight, made.mean.traction) = (0.0, link.turned(&made.mean.traction));
            made.mean.slip = link.turned(&made.mean.slip);
        }
        if is_pair {
            made.mean.wear = depth(node);
        }
        made
    });
    made.collect()
}

/// Results at a contact point, seen from its side.
#[derive(Clone, Copy, Default)]
struct SidePointValues {
    pressure: f64,
    /// g − u_ν.
    gap: f64,
    /// σ_τ.
    traction: Point,
    slip: Point,
    flux: f64,
    /// Power of friction that enters both bodies of a pair.
    rubbed: f64,
    wear: f64,
    work: f64,
}

impl SidePointValues {
    /// The results at point `i` with its status and weight.
    fn at(
        now: &Snapshot,
        report: &ContactReport,
        i: usize,
        point: &PointOnBoundary,
    ) -> Option<(SidePointValues, Status, f64)> {
        let (state, surface) = (report.states.get(i)?, &now.state.surface);
        let of = |values: &[f64]| values.get(i).copied().unwrap_or(0.0);
        let values = SidePointValues {
            pressure: state.pressure,
            gap: 0.0 - state.penetration,
            traction: state.q.map(|q| 0.0 - q),
            slip: state.slip,
            flux: report.flux.get(i).map_or(0.0, |flux| flux.value),
            rubbed: of(&report.rubbed),
            wear: of(&surface.wear),
            work: of(&surface.friction_work),
        };
        Some((values, state.status, report.weights.get(i).copied().unwrap_or(point.weight)))
    }

    /// The results seen from the other side of the pair: forces change sign, and heat that does not enter one body
    /// enters the other.
    fn across(self) -> SidePointValues {
        let back = |vector: Point| vector.map(|component| 0.0 - component);
        let (traction, slip) = (back(self.traction), back(self.slip));
        SidePointValues { traction, slip, flux: 0.0 - self.flux - self.rubbed, ..self }
    }

    /// The results rotated back from an image to the sector of its node.
    fn turned(self, turn: &SectorImage) -> SidePointValues {
        SidePointValues { traction: turn.back(&self.traction), slip: turn.back(&self.slip), ..self }
    }

    /// Adds a share of other values.
    fn add(&mut self, other: &SidePointValues, share: f64) {
        let vector =
            |sum: &mut Point, then: &Point| sum.iter_mut().zip(then).for_each(|(sum, then)| *sum += share * then);
        self.pressure += share * other.pressure;
        self.gap += share * other.gap;
        self.flux += share * other.flux;
        self.rubbed += share * other.rubbed;
        self.wear += share * other.wear;
        self.work += share * other.work;
        vector(&mut self.traction, &other.traction);
        vector(&mut self.slip, &other.slip);
    }
}

/// A contact point that a node takes part in, with the weight of its share.
#[derive(Clone)]
struct OfPoint {
    values: SidePointValues,
    status: Status,
    weight: f64,
    /// True if it is the node's own point.
    is_own: bool,
}

/// A node of a side.
#[derive(Default)]
struct SideNode {
    displacement: Point,
    temperature: f64,
    /// The mean over its points, their weight, and the parts of the weight that are open, stick and slip.
    mean: SidePointValues,
    weight: f64,
    in_state: [f64; 3],
}

impl SideNode {
    /// Sets the values from the node's own point, or else from the mean of the points that it takes part in.
    ///
    /// If nodes have their own points (`has_own`), a node without one is in the middle of a quadratic facet, whose area
    /// belongs to its vertices. Otherwise the area of a node is the sum of its shares. Shares of Gauss points are
    /// values of shape functions. Their sum is positive except at corners of quadratic facets, where magnitudes are
    /// used.
    fn with(mut self, points: &[OfPoint], has_own: bool) -> SideNode {
        if let Some(own) = points.iter().find(|point| point.is_own) {
            (self.mean, self.weight) = (own.values, own.weight);
            self.in_state[own.status as usize] = 1.0;
            return self;
        }
        let [sum, sizes] = [|w: f64| w, f64::abs].map(|of| points.iter().map(|point| of(point.weight)).sum::<f64>());
        let is_signed = sum > 0.5 * sizes;
        let total = if is_signed { sum } else { sizes };
        self.weight = if has_own { 0.0 } else { total };
        for point in points.iter().filter(|_| total > 0.0) {
            let weight = if is_signed { point.weight } else { point.weight.abs() };
            self.mean.add(&point.values, weight / total);
            self.in_state[point.status as usize] += weight;
        }
        self
    }

    /// The status of most of its points.
    fn status(&self) -> i64 {
        let [open, stick, slip] = self.in_state;
        if slip > stick && slip > open { 2 } else { i64::from(stick > open) }
    }
}

#[cfg(all(test, feature = "case"))]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

    use super::*;
    use crate::case::{self, Source};
    use crate::output::Sink;
    use crate::run::{self, Settings};

    /// Two blocks on each other, or one on a foundation, pressed, sheared and warm at the top.
    fn column(blocks: &str, contact: &str) -> String {
        format!(
            r#"name = "column"
            [mesh]
            kind = "blocks"
            blocks = [{blocks}]
            [material]
            density = 1
            heat_capacity = 1
            conductivity = 1
            elasticity = {{ law = "isotropic", young = 100, poisson = 0.3, stress_state = "plane-stress" }}
            viscosity = {{ law = "lame", first = 1, second = 1 }}
            [time]
            end = 0.5
            steps = 5
            [[boundary]]
            on = "up_top"
            displacement = ["t", "-0.1*t*(1 + x)"]
            temperature = 2
            [contact]
            {contact}
            normal = {{ law = "compliance", stiffness = 1000.0 }}
            friction = {{ law = "coulomb", coefficient = 0.3 }}
            "#
        )
    }

    const UP: &str = r#"{ name = "up", size = [1.0, 1.0], origin = [0.0, 1.0], n = [4, 2] }"#;

    /// A pair with heat flow through the contact.
    fn pair(more: &str) -> String {
        let low = r#"{ name = "low", size = [1.0, 1.0], n = [3, 3] }"#;
        let contact = format!(
            "on = \"up_bottom\"\nwith = \"low_top\"\n{more}\nfrictional_heat = 0.25\n\
             heat = {{ law = \"constant\", conductance = 3.0 }}"
        );
        let held = "[[boundary]]\non = \"low_bottom\"\ndisplacement = [0, 0]\ntemperature = 0\n[contact]\n";
        column(&format!("{low}, {UP}"), &contact).replace("[contact]\n", held)
    }

    const STATUS: [Status; 3] = [Status::Open, Status::Stick, Status::Slip];

    /// Nodes of each side after the last step, with the report.
    #[derive(Default)]
    struct Last(Vec<Vec<SideNode>>, ContactReport);

    impl Sink for Last {
        fn last(&mut self, last: &Snapshot) -> Result<(), OutputError> {
            self.1 = last.report.unwrap().contact.clone();
            let boundary = boundary(last, &self.1);
            self.0 = sides(&last.problem.contacts)
                .map(|side| on_side(last, &self.1, &boundary, &side, &last.problem.mesh.facets[side.on].node_list()))
                .collect();
            Ok(())
        }
    }

    fn solved(text: String) -> Last {
        let case = case::parse(&Source::new("column.toml", text), &[]).unwrap();
        let mut last = Last::default();
        run::run(&case.problem, &Settings { certificate: false, ..Settings::default() }, &mut [&mut last]).unwrap();
        last
    }

    /// Σ ω f over the nodes of a side.
    fn total(nodes: &[SideNode], f: impl Fn(&SideNode) -> f64) -> f64 {
        nodes.iter().map(|node| node.weight * f(node)).sum()
    }

    fn assert_near(a: f64, b: f64) {
        assert!(a != 0.0 && (a - b).abs() <= 1e-13 * a.abs(), "{a} {b}");
    }

    #[test]
    fn a_node_has_the_values_of_its_contact_point() {
        let last = solved(column(UP, "on = \"up_bottom\""));
        let [nodes] = &last.0[..] else { panic!("{} sides", last.0.len()) };
        assert_eq!(nodes.len(), 5);
        for (node, (state, weight)) in nodes.iter().zip(last.1.states.iter().zip(&last.1.weights)) {
            assert_eq!(node.mean.pressure.to_bits(), state.pressure.to_bits());
            assert_eq!((node.mean.gap, node.mean.slip), (-state.penetration, state.slip));
            assert_eq!((node.mean.traction, node.weight), (state.q.map(|q| 0.0 - q), *weight));
            assert_eq!(STATUS[node.status() as usize], state.status);
        }
        assert!(nodes.iter().any(|node| node.mean.pressure > 0.0 && node.displacement[1] < 0.0));
    }

    /// With Gauss points and sliding, the sums over the nodes equal the sums over the points.
    #[test]
    fn gauss_points_are_averaged() {
        let last = solved(column(UP, "on = \"up_bottom\"\nquadrature = \"gauss\""));
        let points = last.1.states.iter().zip(&last.1.weights);
        let force: f64 = points.map(|(state, weight)| state.pressure * weight).sum();
        assert_near(total(&last.0[0], |node| node.mean.pressure), force);
        let least = last.1.states.iter().map(|state| state.pressure).fold(f64::INFINITY, f64::min);
        assert!(last.0[0].iter().all(|node| node.mean.pressure >= least), "means stay in the range of their points");
    }

    /// Action equals reaction on nonmatching meshes, whichever side bears the points, updated or not.
    #[test]
    fn both_sides_of_a_pair_have_the_same_forces_and_heat() {
        for more in ["", "nonmortar = \"low_top\"", "geometry = \"updated\""] {
            let last = solved(pair(more));
            let [bearing, facing] = &last.0[..] else { panic!("{} sides", last.0.len()) };
            assert_eq!(bearing.len() + facing.len(), 9);
            assert_near(total(bearing, |_| 1.0), total(facing, |_| 1.0));
            assert_near(total(bearing, |node| node.mean.pressure), total(facing, |node| node.mean.pressure));
            assert_near(total(bearing, |node| node.mean.traction[0]), -total(facing, |node| node.mean.traction[0]));
            let rubbed: f64 = last.1.rubbed.iter().zip(&last.1.weights).map(|(power, weight)| power * weight).sum();
            let leaves = |nodes: &[SideNode]| total(nodes, |node| node.mean.flux);
            assert_near(leaves(bearing) + leaves(facing), -rubbed);
            assert!(rubbed > 1e-3 && bearing.iter().any(|node| node.status() == 2), "the pair slides: {rubbed}");
            assert!(facing.iter().any(|node| node.mean.pressure > 0.0 && node.mean.gap < 0.0));
        }
    }
}
