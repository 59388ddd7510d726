//! Conditions on the parts of the boundary except contact, and which of them exclude each other.

use super::{DatumRole, Fault, ProblemData};
use crate::contact::{Contact, GraphKind, Quadrature};
use crate::element::ShapeTable;
use crate::field::Field;
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::space::{Prescription, Space};
use crate::tensor::{Point, dot, length};
use crate::time::During;

/// Conditions on one named part of the boundary except contact.
///
/// An edge or points can have displacements, temperatures and forces only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoundaryCondition {
    /// Name of the facet set, or of an edge or points.
    pub on: String,
    /// Prescribed displacement, m, one entry per component, `None` for a free component: (2.5).
    pub displacement: Option<Vec<Option<Field>>>,
    /// Prescribed displacement u_ν along the outward normal, m; the side is in one plane, of any direction.
    pub normal_displacement: Option<Field>,
    /// Traction f₁, Pa, one field per component: (2.6).
    pub traction: Option<Vec<Field>>,
    /// Force, N, one field per component, spread evenly over the side, edge or points: (2.6) with f₁ = F/|Γ|. In two
    /// dimensions per unit of thickness, N/m; of a body of revolution the force on the whole ring.
    pub force: Option<Vec<Field>>,
    /// Pressure p, Pa: the traction −pν.
    pub pressure: Option<Field>,
    /// Springs to the ground, Pa/m: the traction −k u.
    pub spring: Option<Support>,
    /// Dashpots to the ground, Pa s/m: the traction −c u̇.
    pub dashpot: Option<Support>,
    /// Prescribed temperature, K: (2.7).
    pub temperature: Option<Field>,
    /// Heat flux into the body −q·ν, W/m².
    pub heat_inflow: Option<Field>,
    /// Heat exchange with the surroundings.
    pub convection: Option<Convection>,
    /// The phases in which the condition acts.
    pub during: During,
    /// What becomes of the force of its support when it ends.
    pub release: Release,
}

/// What becomes of the force of a support that ends with a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Release {
    /// The force is gone at once, as when a clamp is opened.
    #[default]
    AtOnce,
    /// The force falls in proportion to time, to zero at the end of the next phase.
    InPhase,
}

/// Distributed springs or dashpots (Winkler's foundation), constant in time.
#[derive(Clone, Debug, PartialEq)]
pub enum Support {
    /// Along the normal: the traction −k u_ν ν.
    Normal(Field),
    /// By component: the traction −k_i u_i.
    Components(Vec<Field>),
}

impl Support {
    /// The fields with their index in the case file.
    fn fields(&self) -> impl Iterator<Item = (String, &Field)> {
        let (one, several) = match self {
            Support::Normal(field) => (Some(field), [].as_slice()),
            Support::Components(fields) => (None, fields.as_slice()),
        };
        one.into_iter()
            .map(|f| (String::new(), f))
            .chain(several.iter().enumerate().map(|(c, f)| (format!("[{c}]"), f)))
    }

    /// Number of components, or `None` for a support along the normal.
    pub(super) fn components(&self) -> Option<usize> {
        match self {
            Support::Normal(_) => None,
            Support::Components(fields) => Some(fields.len()),
        }
    }

    fn is_zero(&self) -> bool {
        self.fields().all(|(_, field)| field.is_zero())
    }
}

/// Heat exchange with the surroundings: −q·ν = h (θ_a − θ).
#[derive(Clone, Debug, PartialEq)]
pub struct Convection {
    /// h in W/(m² K), constant in time, not negative.
    pub coefficient: Field,
    /// θ_a in K.
    pub ambient: Field,
}

impl BoundaryCondition {
    /// A free and insulated side, on the facet set `on`.
    #[must_use]
    pub fn on(on: impl Into<String>) -> BoundaryCondition {
        BoundaryCondition { on: on.into(), ..BoundaryCondition::default() }
    }

    /// Prescribes all components of the displacement, m.
    #[must_use]
    pub fn displacement(self, components: impl IntoIterator<Item = impl Into<Field>>) -> BoundaryCondition {
        BoundaryCondition { displacement: Some(components.into_iter().map(|c| Some(c.into())).collect()), ..self }
    }

    /// Prescribes the displacement along the outward normal, m.
    #[must_use]
    pub fn normal_displacement(self, along: impl Into<Field>) -> BoundaryCondition {
        BoundaryCondition { normal_displacement: Some(along.into()), ..self }
    }

    /// Applies a traction, Pa.
    #[must_use]
    pub fn traction(self, components: impl IntoIterator<Item = impl Into<Field>>) -> BoundaryCondition {
        BoundaryCondition { traction: Some(components.into_iter().map(Into::into).collect()), ..self }
    }

    /// Applies a force, N, spread evenly.
    #[must_use]
    pub fn force(self, components: impl IntoIterator<Item = impl Into<Field>>) -> BoundaryCondition {
        BoundaryCondition { force: Some(components.into_iter().map(Into::into).collect()), ..self }
    }

    /// Prescribes the temperature, K.
    #[must_use]
    pub fn temperature(self, theta: impl Into<Field>) -> BoundaryCondition {
        BoundaryCondition { temperature: Some(theta.into()), ..self }
    }

    /// Applies a heat flux into the body, W/m².
    #[must_use]
    pub fn heat_inflow(self, flux: impl Into<Field>) -> BoundaryCondition {
        BoundaryCondition { heat_inflow: Some(flux.into()), ..self }
    }

    /// Lets the condition act in the phases of these names alone.
    #[must_use]
    pub fn in_phases(self, names: impl IntoIterator<Item = impl Into<String>>) -> BoundaryCondition {
        BoundaryCondition { during: During::phases(names), ..self }
    }

    /// Lets the force of the support fall over the phase behind its end.
    #[must_use]
    pub fn released_in_phase(self) -> BoundaryCondition {
        BoundaryCondition { release: Release::InPhase, ..self }
    }

    /// True if a displacement of the body is held by a prescribed value or a spring.
    #[must_use]
    pub fn holds_body(&self) -> bool {
        let prescribed = self.displacement.iter().flatten().any(Option::is_some) || self.normal_displacement.is_some();
        prescribed || self.spring.as_ref().is_some_and(|spring| !spring.is_zero())
    }

    /// True if the temperature of the body is held by a prescribed value or by the surroundings.
    #[must_use]
    pub fn holds_temperature(&self) -> bool {
        self.temperature.is_some() || self.convection.as_ref().is_some_and(|c| !c.coefficient.is_zero())
    }

    /// True if no condition is given.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let BoundaryCondition {
            on: _,
            during: _,
            release: _,
            displacement,
            normal_displacement,
            traction,
            force,
            pressure,
            spring,
            dashpot,
            temperature,
            heat_inflow,
            convection,
        } = self;
        let mechanical =
            displacement.is_none() && normal_displacement.is_none() && traction.is_none() && pressure.is_none();
        let mechanical = mechanical && force.is_none();
        mechanical
            && spring.is_none()
            && dashpot.is_none()
            && temperature.is_none()
            && heat_inflow.is_none()
            && convection.is_none()
    }

    /// Every field with its key in the case file.
    #[must_use]
    pub(crate) fn fields(&self) -> Vec<(String, DatumRole, &Field)> {
        let mut fields: Vec<(String, DatumRole, &Field)> = Vec::new();
        let displacement = self.displacement.iter().flatten().enumerate();
        fields.extend(
            displacement.filter_map(|(c, field)| {
                Some((format!("displacement[{c}]"), DatumRole::Displacement, field.as_ref()?))
            }),
        );
        let traction = self.traction.iter().flatten().enumerate();
        fields.extend(traction.map(|(c, field)| (format!("traction[{c}]"), DatumRole::Traction, field)));
        let force = self.force.iter().flatten().enumerate();
        fields.extend(force.map(|(c, field)| (format!("force[{c}]"), DatumRole::Force, field)));
        for (key, support) in [("spring", &self.spring), ("dashpot", &self.dashpot)] {
            let components = support.iter().flat_map(Support::fields);
            fields.extend(components.map(|(index, field)| (format!("{key}{index}"), DatumRole::Other, field)));
        }
        let scalars = [
            ("normal_displacement", DatumRole::Displacement, self.normal_displacement.as_ref()),
            ("pressure", DatumRole::Traction, self.pressure.as_ref()),
            ("temperature", DatumRole::Temperature, self.temperature.as_ref()),
            ("heat_inflow", DatumRole::HeatInflow, self.heat_inflow.as_ref()),
            ("convection.coefficient", DatumRole::Other, self.convection.as_ref().map(|c| &c.coefficient)),
            ("convection.ambient", DatumRole::Temperature, self.convection.as_ref().map(|c| &c.ambient)),
        ];
        fields.extend(scalars.into_iter().filter_map(|(key, role, field)| Some((key.to_owned(), role, field?))));
        fields
    }

    /// The directions in which the displacement is prescribed: (2.5).
    #[must_use]
    pub fn prescriptions<'a>(&'a self, mesh: &Mesh) -> Vec<Prescription<'a>> {
        let on = self.on.as_str();
        let by_component = self.displacement.iter().flatten().enumerate();
        let mut all: Vec<Prescription> = by_component
            .filter_map(|(c, field)| Some(Prescription { on, direction: unit(c), field: field.as_ref()? }))
            .collect();
        let plane = mesh.facets.get(on).and_then(|set| plane_of(mesh, set).ok());
        if let (Some(field), Some(direction)) = (&self.normal_displacement, plane) {
            all.push(Prescription { on, direction, field });
        }
        all
    }
}

/// Unit vector e_c.
fn unit(c: usize) -> Point {
    std::array::from_fn(|d| f64::from(u8::from(c == d)))
}

/// The outward normal of a plane side. A side is plane up to the precision of mesh files, relative to its size. A
/// normal that is a coordinate axis up to round-off becomes that axis.
///
/// # Errors
/// The number and the normal of the first facet that is not in the plane of the first one.
pub(super) fn plane_of(mesh: &Mesh, set: &FacetSet) -> Result<Point, (usize, Point)> {
    const FLAT: f64 = 1e-6;
    const ROUND_OFF: f64 = 1e-12;
    let mut normals: Vec<(usize, f64, Point)> = Vec::new();
    for block in &set.blocks {
        let table = ShapeTable::at(block.element, block.element.nodes);
        let (mut map, first) = (FacetMap::new(mesh, &table), normals.last().map_or(0, |(number, ..)| number + 1));
        for (number, facet) in block.nodes.chunks_exact(block.element.nodes.len()).enumerate() {
            for q in 0..table.len() {
                map.at(facet, q);
                normals.push((first + number, map.area, map.normal));
            }
        }
    }
    // A side on the axis of a body of revolution has no area.
    let has_area = normals.iter().any(|(_, area, _)| *area > 0.0);
    let sum: Point = std::array::from_fn(|c| {
        normals.iter().map(|(_, area, normal)| if has_area { *area } else { 1.0 } * normal[c]).sum()
    });
    let mean = sum.map(|c| c / length(&sum));
    let along = (0..mesh.dim).find(|&c| (0..mesh.dim).all(|d| d == c || mean[d].abs() < ROUND_OFF));
    let plane = along.map_or(mean, |c| unit(c).map(|one| one * mean[c].signum()));
    let nodes = set.node_list();
    let reach = |of: &dyn Fn(&Point) -> f64| {
        let extremes = nodes.iter().map(|&node| of(&mesh.points[node as usize]));
        extremes.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let spread = |[low, high]: [f64; 2]| high - low;
    let size = (0..mesh.dim).map(|c| spread(reach(&|x| x[c]))).fold(0.0, f64::max);
    let is_flat = spread(reach(&|x| dot(x, &plane))) <= FLAT * size.max(f64::MIN_POSITIVE);
    // The sides of a sheet have one plane and opposite normals; a side in one dimension is a point.
    let is_one_sided = normals.iter().all(|(.., normal)| dot(normal, &plane) > 0.5);
    if (is_flat || nodes.len() == 1) && is_one_sided {
        return Ok(plane);
    }
    let first = normals.first().map_or([f64::NAN; 3], |(.., normal)| *normal);
    let differs = |normal: &Point| (0..mesh.dim).any(|c| (normal[c] - first[c]).abs() > FLAT);
    Err(normals
        .iter()
        .find(|(.., normal)| differs(normal))
        .map_or((0, first), |(number, _, normal)| (*number, *normal)))
}

/// Expected text for a side with a displacement and a force in one direction.
const BOTH: &str = "one of the two: Γ_D and Γ_N do not overlap";

impl ProblemData {
    /// V^h with the prescribed displacements: (2.5).
    #[must_use]
    pub fn displacement_space(&self) -> Space {
        let prescribed = self.boundary.iter().flat_map(|b| b.prescriptions(&self.mesh));
        Space::linked(&self.mesh, self.mesh.dim, prescribed, self.links(), self.rigid_nodes())
    }

    /// Q^h with the prescribed temperatures: (2.7).
    #[must_use]
    pub fn temperature_space(&self) -> Space {
        let prescribed = self.boundary.iter().filter_map(|b| Some((b.on.as_str(), b.temperature.as_ref()?)));
        let prescribed = prescribed.map(|(on, field)| Prescription { on, direction: unit(0), field });
        Space::linked(&self.mesh, 1, prescribed, self.links(), Vec::new())
    }

    /// Checks that sides exist, are named once, and bear no two conditions that exclude each other.
    pub(super) fn check_boundary(&self, faults: &mut Vec<Fault>) {
        for (side, contact) in self.contacts.iter().enumerate().filter(|(_, contact)| contact.acts()) {
            let path = self.contact_path(side);
            if contact.normal.graph() != GraphKind::Function && contact.quadrature == Quadrature::Gauss {
                let hint = "more points than nodes have no unique pressures";
                faults.push(
                    Fault::new(format!("{path}.quadrature"), "Gauss points on a rigid foundation", "nodal quadrature")
                        .hint(hint),
                );
            }
            if contact.slides_out(self.mesh.dim) && contact.friction.never_slips() {
                let found = "friction that never slips, with a velocity out of the plane of the body";
                let hint = "remove the velocity out of the plane, or give another friction law";
                let path = format!("{path}.foundation_velocity");
                faults.push(Fault::new(path, found, "friction that can slip").hint(hint));
            }
            self.check_pair(side, &path, faults);
            self.check_once(side, &path, faults);
            self.check_turning(contact, &path, faults);
            self.check_preload(contact, &path, faults);
            self.check_obstacle_load(contact, &path, faults);
            self.check_fluid(contact, &path, faults);
        }
        self.check_sides(faults);
        for (i, b) in self.boundary.iter().enumerate() {
            self.check_again(i, b, faults);
            self.check_edge(i, b, faults);
            self.check_displacement(i, b, faults);
            self.check_forces(i, b, faults);
            for (key, what, given) in [
                ("heat_inflow", "a heat inflow", b.heat_inflow.is_some()),
                ("convection", "a heat exchange with the surroundings", b.convection.is_some()),
            ] {
                if given && b.temperature.is_some() {
                    faults.push(
                        Fault::new(
                            format!("boundary[{i}].{key}"),
                            format!("{what} besides a temperature"),
                            "one of the two",
                        )
                        .hint("remove one of them"),
                    );
                }
            }
            let heat = self.contacts.iter().find(|c| c.on == b.on && c.acts() && c.warms_from_foundation());
            if b.temperature.is_some() && heat.is_some() {
                faults.push(
                    Fault::new(
                        format!("boundary[{i}].temperature"),
                        format!("a temperature on \"{}\"", b.on),
                        "heat exchange or a temperature, not both",
                    )
                    .hint("remove contact.heat or the temperature"),
                );
            }
        }
    }

    /// Checks that no other condition acts on the side of a condition at the same time.
    fn check_again(&self, i: usize, b: &BoundaryCondition, faults: &mut Vec<Fault>) {
        let acts = |of: &BoundaryCondition| of.during != During::NEVER;
        let is_same = |other: &BoundaryCondition| other.on == b.on && acts(other) && acts(b);
        let Some(first) = self.boundary[..i].iter().position(is_same) else { return };
        let both = [b, &self.boundary[first]].map(|of| of.during == During::Run);
        let (path, mut expected) = (format!("boundary[{i}].on"), "each side in one [[boundary]] entry".to_owned());
        if both != [true; 2] {
            let phase = self.timeline.phases().next().map_or("", |phase| &phase.name);
            expected += &format!(" per phase: both act in \"{phase}\"");
        }
        faults.push(again(path, &b.on, first, &expected));
    }

    /// Checks that at most one contact of a side has no obstacle, and that each contact has a name of its own.
    fn check_once(&self, side: usize, path: &str, faults: &mut Vec<Fault>) {
        let (contact, before) = (&self.contacts[side], &self.contacts[..side]);
        let is_same = |other: &Contact| other.on == contact.on && other.obstacle.is_none() && other.acts();
        if let Some(first) = before.iter().position(is_same).filter(|_| contact.obstacle.is_none()) {
            let mut hint = format!(
                "merge it with entry {} of the file, which is on the same side, or give one of them an `obstacle`",
                first + 1
            );
            let both = [contact, &self.contacts[first]].map(|of| of.during == During::Run);
            let mut expected = "one [[contact]] entry without `obstacle` per side".to_owned();
            if both != [true; 2] {
                let phase = self.timeline.phases().next().map_or("", |phase| &phase.name);
                expected += &format!(" and phase: both act in \"{phase}\"");
                hint = format!("name different phases in both, {hint}");
            }
            faults.push(Fault::new(format!("{path}.on"), format!("\"{}\" again", contact.on), expected).hint(hint));
        }
        let goes_by = |(number, other): &(usize, &Contact)| {
            let is_on = other.name.is_empty() && other.on == contact.name;
            *number != side && (is_on || (*number < side && other.name == contact.name))
        };
        let other = self.contacts.iter().enumerate().filter(|_| !contact.name.is_empty()).find(goes_by);
        if let Some((other, _)) = other {
            let hint = format!("entry {} of the file goes by this name", other + 1);
            let found = format!("\"{}\" again", contact.name);
            faults.push(Fault::new(format!("{path}.name"), found, "a name of its own for each contact").hint(hint));
        }
    }

    /// Checks that a turning obstacle meets a body in the plane or in space, not a line or a body of revolution.
    fn check_turning(&self, contact: &Contact, path: &str, faults: &mut Vec<Fault>) {
        let turns = contact.obstacle.as_ref().is_some_and(|obstacle| obstacle.turning.is_some());
        if turns && (self.mesh.dim == 1 || self.mesh.axisymmetric) {
            let body = if self.mesh.dim == 1 { "a line" } else { "a body of revolution" };
            let hint = if self.mesh.dim == 1 {
                "remove it"
            } else {
                "remove it; of an obstacle that turns about the axis of revolution give the `foundation_velocity`"
            };
            let found = format!("a rotation beside {body}");
            let fault = Fault::new(format!("{path}.obstacle.turning"), found, "an obstacle that does not turn");
            faults.push(fault.hint(hint));
        }
    }

    /// Checks that the sides named by conditions exist.
    fn check_sides(&self, faults: &mut Vec<Fault>) {
        let known: Vec<&str> = self.mesh.facets.keys().map(String::as_str).collect();
        let all: Vec<&str> = known.iter().copied().chain(self.mesh.edges.keys().map(String::as_str)).collect();
        for (i, b) in self.boundary.iter().enumerate().filter(|(_, b)| self.mesh.named(&b.on).is_none()) {
            let of = if all.len() > known.len() { "sides, edges and points" } else { "facet sets" };
            faults.push(unknown(format!("boundary[{i}].on"), &b.on, of, &all));
        }
        let contacts =
            self.contacts.iter().enumerate().map(|(side, c)| (format!("{}.on", self.contact_path(side)), &c.on));
        let pairs = self
            .contacts
            .iter()
            .enumerate()
            .filter_map(|(side, c)| Some((format!("{}.with", self.contact_path(side)), &c.pair.as_ref()?.with)));
        for (path, name) in contacts.chain(pairs) {
            if !self.mesh.facets.contains_key(name) {
                faults.push(unknown(path, name, "facet sets", &known));
            }
        }
    }

    /// Checks that an edge or points have no condition that needs an area.
    fn check_edge(&self, i: usize, b: &BoundaryCondition, faults: &mut Vec<Fault>) {
        if b.on.is_empty() || self.mesh.facets.contains_key(&b.on) || !self.mesh.edges.contains_key(&b.on) {
            return;
        }
        for (key, what, given) in [
            ("normal_displacement", "a displacement along the normal", b.normal_displacement.is_some()),
            ("traction", "a traction", b.traction.is_some()),
            ("pressure", "a pressure", b.pressure.is_some()),
            ("spring", "a spring", b.spring.is_some()),
            ("dashpot", "a dashpot", b.dashpot.is_some()),
            ("heat_inflow", "a heat inflow", b.heat_inflow.is_some()),
            ("convection", "a heat exchange with the surroundings", b.convection.is_some()),
        ] {
            if given {
                let found = format!("{what} on \"{}\", which has no area", b.on);
                let expected = "`displacement`, `force` or `temperature` on an edge or on points";
                faults.push(
                    Fault::new(format!("boundary[{i}].{key}"), found, expected).hint("give it on a side, or a `force`"),
                );
            }
        }
    }

    /// Checks that a displacement is given by components or along the normal, not both, and not on Γ_C.
    fn check_displacement(&self, i: usize, b: &BoundaryCondition, faults: &mut Vec<Fault>) {
        let given =
            [("displacement", b.displacement.is_some()), ("normal_displacement", b.normal_displacement.is_some())];
        let on_contact = self.contacts.iter().any(|c| c.bearing() == b.on && c.acts());
        for (key, _) in given.iter().filter(|(_, given)| *given && on_contact) {
            faults.push(
                Fault::new(
                    format!("boundary[{i}].{key}"),
                    format!("a displacement on \"{}\"", b.on),
                    "Γ_D apart from Γ_C",
                )
                .hint(
                    "[contact] is on the same side; a side that bears contact takes loads, springs and heat flows only",
                ),
            );
        }
        let path = format!("boundary[{i}].normal_displacement");
        if given.iter().all(|(_, given)| *given) {
            faults.push(
                Fault::new(&*path, "a displacement along the normal and one by components", "one of the two")
                    .hint("remove one of them"),
            );
        }
        let set = self.mesh.facets.get(&b.on).filter(|_| b.normal_displacement.is_some());
        if let Some(Err((facet, normal))) = set.map(|set| plane_of(&self.mesh, set)) {
            let normal = normal.iter().take(self.mesh.dim).map(|c| format!("{c:.6}")).collect::<Vec<_>>().join(", ");
            faults.push(
                Fault::new(
                    path,
                    format!("facet {facet} of \"{}\" with the normal ({normal})", b.on),
                    "a side in one plane",
                )
                .hint(
                    "give each plane part of the side a name and an entry of its own, or hold the side by a `spring`",
                ),
            );
        }
    }

    /// Checks that forces act on components that are not prescribed.
    fn check_forces(&self, i: usize, b: &BoundaryCondition, faults: &mut Vec<Fault>) {
        let dim = self.mesh.dim;
        let plane = self
            .mesh
            .facets
            .get(&b.on)
            .filter(|_| b.normal_displacement.is_some())
            .and_then(|set| plane_of(&self.mesh, set).ok());
        let held: Vec<bool> = (0..dim)
            .map(|c| {
                let by_component = b.displacement.iter().flatten().nth(c).is_some_and(Option::is_some);
                by_component || plane.is_some_and(|normal| normal[c].abs() >= 1.0)
            })
            .collect();
        let all_held = held.iter().all(|held| *held);
        for (key, what, given) in [("traction", "a traction", &b.traction), ("force", "a force", &b.force)] {
            let Some(load) = given else { continue };
            if all_held {
                faults.push(
                    Fault::new(format!("boundary[{i}].{key}"), format!("{what} besides a displacement"), BOTH)
                        .hint("remove one of them"),
                );
            } else if let Some(c) = (0..dim).find(|&c| held[c] && load.get(c).is_some_and(|field| !field.is_zero())) {
                let found = format!("{what} in a direction whose displacement is prescribed");
                faults.push(Fault::new(format!("boundary[{i}].{key}[{c}]"), found, BOTH).hint("set it to 0"));
            }
        }
        Self::check_supports(i, b, all_held, faults);
    }

    /// Checks that pressures, springs and dashpots act on components that are not prescribed.
    fn check_supports(i: usize, b: &BoundaryCondition, all_held: bool, faults: &mut Vec<Fault>) {
        let along_normal = |support: &Option<Support>| matches!(support, Some(Support::Normal(_)));
        for (key, what, given, normal) in [
            ("pressure", "a pressure", b.pressure.is_some(), b.pressure.is_some()),
            ("spring", "a spring", b.spring.is_some(), along_normal(&b.spring)),
            ("dashpot", "a dashpot", b.dashpot.is_some(), along_normal(&b.dashpot)),
        ] {
            if given && all_held {
                faults.push(
                    Fault::new(format!("boundary[{i}].{key}"), format!("{what} besides a displacement"), BOTH)
                        .hint("remove one of them"),
                );
            } else if normal && b.normal_displacement.is_some() {
                let found = format!("{what} along the normal besides a displacement along it");
                faults.push(Fault::new(format!("boundary[{i}].{key}"), found, BOTH).hint("remove one of them"));
            }
        }
    }
}

/// The fault of a side that an earlier entry, the `first`, already names.
fn again(path: String, on: &str, first: usize, expected: &str) -> Fault {
    let hint = format!("merge it with entry {} of the file, which is on the same side", first + 1);
    Fault::new(path, format!("\"{on}\" again"), expected).hint(hint)
}

/// The fault of an unknown name, with the nearest known name as a hint.
pub(super) fn unknown(path: String, name: &str, of: &str, known: &[&str]) -> Fault {
    let fault = Fault::new(path, format!("\"{name}\""), format!("one of the {of} {}", known.join(", ")));
    match known
        .iter()
        .min_by_key(|k| strsim::damerau_levenshtein(k, name))
        .filter(|k| strsim::damerau_levenshtein(k, name) <= 2)
    {
        Some(near) => fault.hint(format!("did you mean \"{near}\"?")),
        None => fault,
    }
}
