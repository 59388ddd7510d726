//! Checks for data that a run cannot compute with: magnitudes whose products overflow or underflow, and temperatures
//! below absolute zero.

use super::{Datum, DatumRole, Fault, ProblemData};
use crate::contact::Contact;
use crate::field::{Coefficient, Field};
use crate::material::Material;
use crate::mesh::Mesh;
use crate::tensor::{Point, Sym, mandel_len};

/// Powers of ten between which squares, energies and entries of matrices must lie.
const LIMIT: f64 = 290.0;
/// Time levels, and nodes per side or body, at which data are sampled.
const LEVELS: usize = 64;
const NODES: usize = 1024;

/// A magnitude as its power of ten, with the key that it comes from.
#[derive(Clone, Debug)]
struct KeyMagnitude {
    power: f64,
    key: String,
}

/// The scale of a number, or `None` for zero.
fn scale(value: f64, key: impl Into<String>) -> Option<KeyMagnitude> {
    (value != 0.0).then(|| KeyMagnitude { power: value.abs().log10(), key: key.into() })
}

impl KeyMagnitude {
    /// The scale times 10^power.
    fn times(self, power: f64) -> KeyMagnitude {
        KeyMagnitude { power: self.power + power, ..self }
    }
}

/// The largest of some scales.
fn largest(scales: impl IntoIterator<Item = Option<KeyMagnitude>>) -> Option<KeyMagnitude> {
    scales.into_iter().flatten().max_by(|a, b| a.power.total_cmp(&b.power))
}

/// The power of ten of a number, or `None` for zero.
fn power(value: f64) -> Option<f64> {
    (value != 0.0).then(|| value.abs().log10())
}

/// Hint for a temperature below absolute zero.
const HINT: &str = "correct the temperature, or `absolute_zero` of the radiation, which is -273.15 for degrees Celsius and 0 for kelvins";

impl ProblemData {
    /// Checks that temperatures of the data are not below the absolute zero of a radiating contact.
    pub(super) fn check_temperatures(&self, faults: &mut Vec<Fault>) {
        let zero = self.contacts.iter().filter_map(|c| c.heat.absolute_zero()).reduce(f64::max);
        let Some(zero) = zero else { return };
        let expected = format!("temperatures from absolute_zero = {zero:?} on");
        for datum in
            self.data().into_iter().chain(self.initial_data()).filter(|datum| datum.role == DatumRole::Temperature)
        {
            let coldest = self.samples(&datum).min_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((value, x, t)) = coldest.filter(|(value, ..)| *value < zero) {
                let found = format!("the temperature {value:?} at {}, t = {t:?}", self.mesh.place(&x));
                faults.push(Fault::new(datum.key, found, &*expected).hint(HINT));
            }
        }
        for (side, contact) in self.contacts.iter().enumerate() {
            if let Some(start) = contact
                .foundation_heat
                .as_ref()
                .and_then(|foundation| foundation.temperature)
                .filter(|start| *start < zero)
            {
                let path = format!("{}.foundation.temperature", self.contact_path(side));
                faults.push(Fault::new(path, format!("the temperature {start:?}"), &*expected).hint(HINT));
            }
        }
    }

    /// Checks that squares of stresses, displacements, velocities and temperatures, energies and matrix entries neither
    /// overflow nor underflow.
    pub(super) fn check_range(&self, faults: &mut Vec<Fault>) {
        // Steps without length are reported elsewhere.
        if ![self.timeline.shortest(), self.timeline.longest()].iter().all(|k| k.is_normal()) {
            return;
        }
        let Scales { stress, displacement, velocity, temperature, flux, energy, matrices } = self.scales();
        let squares = [
            ("stresses", "Pa", stress),
            ("displacements", "m", displacement),
            ("velocities", "m/s", velocity),
            ("temperatures", "K", temperature),
        ];
        let squares = squares.into_iter().filter_map(|(what, unit, scale)| {
            let scale = scale?;
            let found = format!(
                "{what} of about {} {unit}, whose squares are about {}",
                tens(scale.power),
                tens(2.0 * scale.power)
            );
            Some((scale.clone().times(scale.power), found))
        });
        let energy = energy.map(|scale| (scale.clone(), format!("energies of about {} J", tens(scale.power))));
        // A flux may be arbitrarily small: it is zero if all temperatures are equal.
        let flux = flux.filter(|scale| scale.power > 0.0);
        let flux = flux.map(|scale| (scale.clone(), format!("heat fluxes of about {} W/m²", tens(scale.power))));
        let matrices = matrices
            .into_iter()
            .flatten()
            .map(|scale| (scale.clone(), format!("entries of a matrix of about {}", tens(scale.power))));
        for (scale, found) in
            squares.chain(energy).chain(flux).chain(matrices).filter(|(scale, _)| scale.power.abs() > LIMIT)
        {
            // One fault per datum is enough.
            if faults.iter().any(|fault| fault.path == scale.key) {
                continue;
            }
            let expected = "squares, energies and entries of matrices between 1e-290 and 1e290";
            faults.push(
                Fault::new(scale.key, found, expected)
                    .hint("correct the value, or choose units in which the data of the case are nearer to 1"),
            );
        }
    }

    /// Least and largest temperature of the data: initial, prescribed, of surroundings and of foundations that exchange
    /// heat, K.
    pub(crate) fn temperature_bounds(&self) -> [f64; 2] {
        let conducts = |datum: &Datum| {
            let contact = datum.contact.and_then(|contact| self.contacts.get(contact));
            contact.is_none_or(|contact| contact.heat.conductance_bound() != 0.0)
        };
        let data = self.data().into_iter().chain(self.initial_data());
        let acting = data.filter(|datum| datum.role == DatumRole::Temperature && conducts(datum));
        let values: Vec<f64> =
            acting.flat_map(|datum| self.samples(&datum).map(|(value, ..)| value).collect::<Vec<_>>()).collect();
        let foundations = self.contacts.iter().filter_map(|contact| contact.foundation_heat.as_ref()?.temperature);
        values
            .into_iter()
            .chain(foundations)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
    }

    /// Returns `[negative, positive]`: true if heat sources or inflows have that sign somewhere.
    pub(crate) fn heat_signs(&self) -> [bool; 2] {
        let mut signs = [false; 2];
        for datum in
            self.data().iter().filter(|datum| matches!(datum.role, DatumRole::HeatSource | DatumRole::HeatInflow))
        {
            for (value, ..) in self.samples(datum) {
                signs = [signs[0] || value < 0.0, signs[1] || value > 0.0];
            }
        }
        signs
    }

    /// Values of a datum at nodes and time levels.
    fn samples<'a>(&'a self, datum: &Datum<'a>) -> impl Iterator<Item = (f64, Point, f64)> + use<'a> {
        let mut points = self.nodes_of(datum);
        let field = datum.field;
        if !field.depends_on_space() {
            points.truncate(1);
        }
        let stride = points.len().div_ceil(NODES).max(1);
        let points: Vec<Point> = points.into_iter().step_by(stride).collect();
        let levels = if field.depends_on_time() { self.timeline.spread(LEVELS) } else { vec![0.0] };
        levels.into_iter().flat_map(move |t| {
            field
                .values(&points, t)
                .into_iter()
                .zip(points.clone())
                .map(move |(value, x)| (value, x, t))
                .collect::<Vec<_>>()
        })
    }

    /// The largest magnitude of a datum.
    fn scale_of(&self, datum: &Datum) -> Option<KeyMagnitude> {
        let magnitude = match datum.field {
            Field::Constant(value) => value.abs(),
            _ => self
                .samples(datum)
                .fold(0.0, |max: f64, (value, ..)| if value.is_finite() { max.max(value.abs()) } else { max }),
        };
        scale(magnitude, datum.key.clone())
    }

    /// The scale of a number of the materials.
    fn largest_number(&self, key: &str, of: fn(&Material) -> &Coefficient<f64>) -> Option<KeyMagnitude> {
        let largest = self.values_of(of).iter().fold(0.0, |max: f64, sample| max.max(sample.value));
        scale(largest, format!("material.{key}"))
    }

    /// The scale of the entries of a tensor of the materials.
    fn largest_entry(&self, key: &str, of: fn(&Material) -> &Coefficient<Sym>) -> Option<KeyMagnitude> {
        let largest = self.values_of(of).iter().fold(0.0, |max: f64, sample| max.max(entry(&sample.value, &self.mesh)));
        scale(largest, format!("material.{key}"))
    }

    /// The largest bound of the laws of contact, with the key of the law, or `None` if no law has one.
    fn of_laws(&self, key: &str, bound: impl Fn(&Contact) -> Option<f64>) -> Option<KeyMagnitude> {
        largest(self.contacts.iter().enumerate().map(|(side, contact)| {
            let bound = bound(contact).filter(|bound| bound.is_finite());
            scale(bound?, format!("{}.{key}", self.contact_path(side)))
        }))
    }

    /// The orders of magnitude of a run: the response of the body to its loads and prescribed values.
    fn scales(&self) -> Scales {
        let (mesh, k) = (&*self.mesh, [self.timeline.shortest(), self.timeline.longest()]);
        let data: Vec<Datum> = self.data().into_iter().chain(self.initial_data()).collect();
        let of =
            |role: DatumRole| largest(data.iter().filter(|datum| datum.role == role).map(|datum| self.scale_of(datum)));
        let material = |key: &str, of: &dyn Fn(&Material) -> f64| {
            scale(self.materials.iter().map(of).fold(0.0, f64::max), format!("material.{key}"))
        };
        let elastic = material("elasticity", &|m| m.elasticity.constants().lipschitz);
        let viscous = material("viscosity", &|m| m.viscosity.constants().lipschitz);
        let density = self.largest_number("density", |m| &m.density);
        let capacity = self.largest_number("heat_capacity", |m| &m.heat_capacity);
        let conductivity = self.largest_entry("conductivity", |m| &m.conductivity);
        let expansion = self.largest_entry("expansion", |m| &m.expansion);
        let conductance = self.of_laws("heat", |contact| Some(contact.heat.conductance_bound()));
        let stiffness = self.of_laws("normal", |contact| contact.normal.lipschitz());
        let (length, end) = (power(diameter(mesh)).unwrap_or(0.0), power(self.timeline.end()).unwrap_or(0.0));
        let by = |scale: Option<KeyMagnitude>, factor: &Option<KeyMagnitude>, sign: f64, more: f64| {
            Some(scale?.times(sign * factor.as_ref()?.power + more))
        };

        let given = of(DatumRole::Temperature);
        let sources = largest([of(DatumRole::HeatSource).map(|s| s.times(length)), of(DatumRole::HeatInflow)]);
        let heated = [by(sources.clone(), &conductivity, -1.0, length), by(sources, &capacity, -1.0, end - length)];
        let temperature = largest([given, least(heated)]);

        let force = of(DatumRole::BodyForce).map(|s| s.times(length));
        let spread = of(DatumRole::Force).map(|s| s.times((1.0 - mesh.dim as f64) * length));
        let load = largest([force, of(DatumRole::Traction), spread, by(temperature.clone(), &expansion, 1.0, 0.0)]);
        let moved = of(DatumRole::Displacement);
        let fast = largest([of(DatumRole::Velocity), moved.clone().map(|s| s.times(-end))]);
        let stress = largest([
            load.clone(),
            by(moved.clone(), &elastic, 1.0, -length),
            by(fast.clone(), &viscous, 1.0, -length),
        ]);
        // Stiffness, viscosity or inertia carries the load, whichever is largest.
        let carried = [
            by(load.clone(), &elastic, -1.0, length),
            by(load.clone(), &viscous, -1.0, length + end),
            by(load, &density, -1.0, 2.0 * end - length),
        ];
        let displacement = largest([moved, least(carried)]);
        let velocity = largest([fast, of(DatumRole::FoundationVelocity), displacement.clone().map(|s| s.times(-end))]);
        let dim = mesh.tensor_dim() as f64;
        let energy = stress.clone().zip(displacement.clone()).map(|(s, u)| s.times(u.power + (dim - 1.0) * length));
        let flux = by(temperature.clone(), &conductance, 1.0, 0.0)
            .map(|flux| KeyMagnitude { key: conductance.as_ref().map_or(flux.key, |scale| scale.key.clone()), ..flux });
        let matrices = entries(mesh, k, [density, viscous, elastic, stiffness], [capacity, conductivity, conductance]);
        Scales { stress, displacement, velocity, temperature, flux, energy, matrices }
    }
}

/// The largest entries of K_u with ρ, 𝓥, 𝓔 and the stiffness of contact, and of K_θ with c, 𝓚 and the conductance, for
/// the shortest and the longest step.
fn entries(
    mesh: &Mesh,
    steps: [f64; 2],
    of_u: [Option<KeyMagnitude>; 4],
    of_theta: [Option<KeyMagnitude>; 3],
) -> [Option<KeyMagnitude>; 2] {
    let ([density, viscous, elastic, contact], [capacity, conductivity, conductance]) = (of_u, of_theta);
    let h = power(mesh.spacing()).unwrap_or(0.0);
    let [shortest, k] = steps.map(|k| power(k).unwrap_or(0.0));
    let dim = mesh.tensor_dim() as f64;
    let [volume, side, edge] = [dim, dim - 1.0, dim - 2.0].map(|d| d * h);
    let (inertia, stiffness) = (density.map(|s| s.times(volume - shortest)), elastic.map(|s| s.times(edge + k)));
    [
        largest([inertia, viscous.map(|s| s.times(edge)), stiffness, contact.map(|s| s.times(side + k))]),
        largest([
            capacity.map(|s| s.times(volume - shortest)),
            conductivity.map(|s| s.times(edge)),
            conductance.map(|s| s.times(side)),
        ]),
    ]
}

/// The least of several scales, without those that are zero.
fn least(scales: impl IntoIterator<Item = Option<KeyMagnitude>>) -> Option<KeyMagnitude> {
    scales.into_iter().flatten().min_by(|a, b| a.power.total_cmp(&b.power))
}

/// Magnitudes of a run; `None` for a magnitude of zero.
struct Scales {
    stress: Option<KeyMagnitude>,
    displacement: Option<KeyMagnitude>,
    velocity: Option<KeyMagnitude>,
    temperature: Option<KeyMagnitude>,
    /// Heat flux through contact.
    flux: Option<KeyMagnitude>,
    energy: Option<KeyMagnitude>,
    /// Largest entries of K_u and K_θ.
    matrices: [Option<KeyMagnitude>; 2],
}

/// Largest entry of a tensor.
fn entry(tensor: &Sym, mesh: &Mesh) -> f64 {
    tensor.0[..mandel_len(mesh.tensor_dim())].iter().fold(0.0, |max: f64, c| max.max(c.abs()))
}

/// The largest extent of the body along an axis, m.
fn diameter(mesh: &Mesh) -> f64 {
    let extent = |d: usize| {
        let bounds = mesh
            .points
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[d]), high.max(p[d])));
        bounds.1 - bounds.0
    };
    (0..mesh.dim).map(extent).fold(0.0, f64::max)
}

/// A power of ten as text: `1e-170`.
fn tens(power: f64) -> String {
    format!("1e{:.0}", power.round())
}
