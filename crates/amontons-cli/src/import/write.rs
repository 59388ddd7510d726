//! The case of a deck as text.

use amontons::mesh::MeshFile;
use amontons::mesh::PlaneState;

use crate::arguments::DeckUnits;

use super::body;
use super::conditions::{DeckPrescription, PrescribedQuantity};
use super::contact;
use super::deck::{DeckFault, DeckPlace};
use super::material::{Context, DeckSection};
use super::model::DeckModel;
use super::notes::{Matter, Notes};
use super::parts;
use super::time::Track;
use super::units::{number, quoted};

/// Largest number of reaction probes.
const MOST_PROBES: usize = 12;
/// Conductance of a tie relative to that of the bodies.
const TIE: f64 = 1e4;

/// Names of the files of a case.
pub struct Names {
    pub case: String,
    pub deck: String,
    pub mesh: String,
}

/// The assumed units of a deck, in words.
pub fn assumed(units: DeckUnits) -> &'static str {
    match units {
        DeckUnits::None => {
            "not known: the case has the numbers of the deck without units; --units mm-N-s makes it one in SI"
        }
        DeckUnits::MmNS => "the deck is taken to be in mm, t, s, N and MPa; the case is in SI",
        DeckUnits::MKgS => "the deck is taken to be in m, kg, s, N and Pa, as the case is",
        DeckUnits::MmKgMs => "the deck is taken to be in mm, kg, ms, kN and GPa; the case is in SI",
    }
}

/// Data needed by all parts of a case.
struct CaseWriter<'a> {
    model: &'a DeckModel,
    read: &'a MeshFile,
    context: Context,
}

/// The case.
pub fn case(
    model: &DeckModel,
    read: &MeshFile,
    units: DeckUnits,
    (names, notes): (&Names, &mut Notes),
) -> Result<String, DeckFault> {
    let writing = CaseWriter::new(model, read, units);
    let mut text = writing.frame(names)?;
    text += &writing.materials()?;
    for (place, why) in model.materials.iter().filter_map(|material| material.unfit(&writing.context)) {
        notes.add(place, "*VISCOELASTIC", why, Matter::Answer);
    }
    text += &body::load(model, writing.context.units, (read.mesh.dim, writing.temperature()), notes)?;
    if writing.context.physics.mechanics && writing.context.physics.heat {
        text +=
            "\n[scheme]\ncoupling = \"monolithic\"              # mechanics sees the temperatures of its own step\n";
    }
    text += &writing.boundaries(notes);
    let (rigid, held) = if writing.context.physics.mechanics {
        parts::text(model, &read.mesh, writing.context.units, notes)
    } else {
        (String::new(), Vec::new())
    };
    text += &rigid;
    let size = writing.size();
    let conductivity = model.materials.iter().filter_map(super::material::DeckMaterial::conducts).fold(0.0, f64::max);
    let conductivity = if conductivity > 0.0 { conductivity * writing.context.units.conductivity() } else { 1.0 };
    let scene = contact::ContactContext {
        units: writing.context.units,
        heat: writing.context.physics.heat,
        rests: !writing.context.physics.mechanics,
        large: model.large,
        tie: TIE * conductivity / size,
    };
    text += &model.contacts.text(&scene);
    if writing.context.physics.heat {
        let initial = number(writing.context.initial - writing.context.shift);
        text += &format!("\n[initial]\ntemperature = {initial}\n");
    }
    let every = model.time.count.div_ceil(100);
    text += &format!("\n[output]\nevery = {every}                            # steps between files for ParaView\n");
    text += &writing.probes();
    text.extend(held.iter().map(|on| parts::probe(on)));
    Ok(head(names, units, &writing, notes) + &text)
}

/// The comment at the head of a case.
fn head(names: &Names, units: DeckUnits, writing: &CaseWriter, notes: &Notes) -> String {
    let mut text = format!(
        "# The case of the deck {}, written by `amontons import`. Lines are those of the deck.\n# Units: {}.\n",
        one_line(&names.deck),
        assumed(units)
    );
    if writing.context.shift != 0.0 {
        text += &format!(
            "# Temperatures count from {}, the initial temperature of the deck, at which the body is free of stress.\n",
            number(writing.context.shift)
        );
    }
    let lines = notes.lines();
    if !lines.is_empty() {
        text += "# Not in the case, or said otherwise:\n";
        for line in lines {
            text += &format!("#   {}\n", one_line(&line));
        }
    }
    text + "\n"
}

/// A text as a comment, without control characters, which would end it.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

impl<'a> CaseWriter<'a> {
    fn new(model: &'a DeckModel, read: &'a MeshFile, units: DeckUnits) -> CaseWriter<'a> {
        let expands = model.materials.iter().any(super::material::DeckMaterial::expands);
        let heat = model.physics.heat;
        let sees = model.materials.iter().any(super::material::DeckMaterial::sees_temperature);
        let warmed = model.physics.mechanics && !heat && !model.conditions.field.0.is_empty() && sees;
        let initial = model.conditions.initial.unwrap_or(0.0);
        let plane = read.mesh.dim == 2 && !read.mesh.axisymmetric;
        let stress_state = match read.plane {
            _ if !plane => None,
            Some(PlaneState::Strain) => Some("plane-strain"),
            _ => Some("plane-stress"),
        };
        let context = Context {
            units: units.into(),
            physics: model.physics,
            warmed,
            inertia: model.inertia,
            stress_state,
            dim: read.mesh.dim,
            shift: if model.physics.mechanics && (heat || warmed) && expands { initial } else { 0.0 },
            initial,
        };
        CaseWriter { model, read, context }
    }

    /// Largest extent of the mesh in the units of the case.
    fn size(&self) -> f64 {
        let points = &self.read.mesh.points;
        let extent = |d: usize| {
            let (low, high) = points
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), point| (low.min(point[d]), high.max(point[d])));
            high - low
        };
        (0..3).map(extent).fold(0.0, f64::max).max(f64::MIN_POSITIVE) * self.context.units.length
    }

    /// Name, units, mesh and time.
    fn frame(&self, names: &Names) -> Result<String, DeckFault> {
        let Context { units, dim, .. } = self.context;
        let mut text = format!("name = {}\n", quoted(&names.case));
        if units.dimensionless {
            text += "units = \"dimensionless\"\n";
        }
        if dim == 2 && !self.read.mesh.axisymmetric {
            let mut sections = self.model.sections.iter();
            let first = sections.next().map_or(1.0, |section| section.thickness);
            if let Some(other) = sections.find(|section| section.thickness.total_cmp(&first).is_ne()) {
                let found = format!("a thickness of {} beside one of {}", number(other.thickness), number(first));
                return Err(DeckFault::new(&other.place, found, "one thickness, which a plane case has"));
            }
            text += &format!("thickness = {}\n", number(first * units.length));
        }
        text += &format!("\n[mesh]\nfile = {}\n", quoted(&names.mesh));
        if units.length < 1.0 {
            text += &format!("scale = {}\n", number(units.length));
        }
        if self.read.mesh.axisymmetric {
            text += "axisymmetric = true\n";
        }
        let time = &self.model.time;
        let places: Vec<String> = time
            .steps
            .iter()
            .map(|step| format!("*STEP {} to {}", step.place, number(step.end() * units.time)))
            .collect();
        text += &format!("\n[time]                               # {}\n", places.join(", "));
        text += &format!("end = {}\nsteps = {}\n", number(time.end * units.time), time.count);
        if self.context.physics.mechanics && !self.context.inertia {
            text += "inertia = false\n";
        }
        Ok(text)
    }

    fn materials(&self) -> Result<String, DeckFault> {
        let mut text = String::new();
        for (number, section) in self.model.sections.iter().enumerate() {
            let table = self.material(section)?;
            if number == 0 {
                text += &format!("\n[material]                           # {}\n{table}", of_section(section));
                continue;
            }
            for on in &section.regions {
                text += &format!("\n[[region]]                           # {}\n", of_section(section));
                text += &format!("on = {}\n[region.material]\n{table}", quoted(on));
            }
        }
        Ok(text)
    }

    fn material(&self, section: &DeckSection) -> Result<String, DeckFault> {
        let name = &section.material;
        let mut all = self.model.materials.iter();
        let material = all.find(|material| material.name.eq_ignore_ascii_case(name)).ok_or_else(|| {
            let found = format!("MATERIAL={}", name.escape_debug());
            DeckFault::new(&section.place, found, "a *MATERIAL that the deck defines")
        })?;
        let angle = match &section.orientation {
            Some(name) => {
                let mut all = self.model.orientations.iter();
                let found = all.find(|orientation| orientation.name == *name).ok_or_else(|| {
                    let found = format!("ORIENTATION={}", name.escape_debug());
                    DeckFault::new(&section.place, found, "an *ORIENTATION that the deck defines")
                })?;
                Some(found.text(self.context.dim, self.context.units.length))
            }
            None => None,
        };
        let mut text = String::new();
        for (key, value, place) in material.entries(&self.context, angle.as_deref())? {
            let from = place.map_or_else(String::new, |place| format!("   # {place}"));
            text += &format!("{key} = {value}{from}\n");
        }
        Ok(text)
    }

    fn boundaries(&self, notes: &mut Notes) -> String {
        let mut text = String::new();
        let Context { units, dim, .. } = self.context;
        for entry in &self.model.conditions.entries {
            text += &self.boundary(entry, notes);
        }
        for force in &self.model.forces {
            let component = |d: usize| {
                let factor = force.count as f64 * units.force();
                self.history(&force.tracks[d], (0.0, true)).mapped(factor, 0.0).text(units.time, None)
            };
            let components: Vec<String> = (0..dim).map(component).collect();
            let each = if force.count > 1 { format!(" at {} nodes", force.count) } else { String::new() };
            text += &format!("\n[[boundary]]                         # {}{each}\n", force.from);
            text += &format!("on = {}\nforce = [{}]\n", quoted(&force.on), components.join(", "));
        }
        text
    }

    /// The temperature given by the deck, as an entry of `[load]`.
    fn temperature(&self) -> Option<String> {
        let Context { units, shift, initial, warmed, .. } = self.context;
        let field = || self.history(&self.model.conditions.field, (initial, true)).mapped(1.0, -shift);
        warmed.then(|| format!("temperature = {}   # *TEMPERATURE\n", field().text(units.time, None)))
    }

    fn history(&self, track: &Track, begin: (f64, bool)) -> super::time::DeckAmplitude {
        self.model.time.history(track, &self.model.amplitudes, begin)
    }

    /// The text of an entry of a side or of points.
    fn boundary(&self, entry: &DeckPrescription, notes: &mut Notes) -> String {
        let Context { units, dim, shift, initial, .. } = self.context;
        let mut text = format!("\n[[boundary]]                         # {}\n", entry.from.join(", "));
        text += &format!("on = {}\n", quoted(&entry.on));
        let mut displacement: Vec<String> = vec!["\"free\"".to_owned(); dim];
        let mut traction: Vec<String> = vec!["0.0".to_owned(); dim];
        let mut lines = String::new();
        let is_any = |wanted: fn(&PrescribedQuantity) -> bool| entry.tracks.keys().any(wanted);
        for (quantity, (track, _)) in &entry.tracks {
            self.note_late(quantity, track, entry, notes);
            let of = |begin: (f64, bool), factor: f64, summand: f64| {
                self.history(track, begin).mapped(factor, summand).text(units.time, None)
            };
            match quantity {
                PrescribedQuantity::Displacement(d) => displacement[*d] = of((0.0, true), units.length, 0.0),
                PrescribedQuantity::Traction(d) => traction[*d] = of((0.0, true), units.stress(), 0.0),
                PrescribedQuantity::Normal => lines += "normal_displacement = 0.0\n",
                PrescribedQuantity::Temperature => {
                    lines += &format!("temperature = {}\n", of((initial, true), 1.0, -shift));
                }
                PrescribedQuantity::Pressure => {
                    lines += &format!("pressure = {}\n", of((0.0, true), units.stress(), 0.0));
                }
                PrescribedQuantity::HeatInflow => {
                    lines += &format!("heat_inflow = {}\n", of((0.0, true), units.flux(), 0.0));
                }
                PrescribedQuantity::Ambient => {
                    let ambient = of((initial, false), 1.0, -shift);
                    let film = number(entry.film.unwrap_or(0.0) * units.flux());
                    lines += &format!("convection = {{ coefficient = {film}, ambient = {ambient} }}\n");
                }
            }
        }
        if is_any(|quantity| matches!(quantity, PrescribedQuantity::Displacement(_))) {
            text += &format!("displacement = [{}]\n", displacement.join(", "));
        }
        if is_any(|quantity| matches!(quantity, PrescribedQuantity::Traction(_))) {
            text += &format!("traction = [{}]\n", traction.join(", "));
        }
        text + &lines
    }

    /// Notes conditions that exist in some steps of the deck only: in a case they hold at all times.
    fn note_late(&self, quantity: &PrescribedQuantity, track: &Track, entry: &DeckPrescription, notes: &mut Notes) {
        let what = format!("condition on {}", entry.on.escape_debug());
        if matches!(
            quantity,
            PrescribedQuantity::Displacement(_) | PrescribedQuantity::Normal | PrescribedQuantity::Temperature
        ) {
            self.model.time.note_late(track, &what, notes);
        }
        if *quantity == PrescribedQuantity::Ambient && track.0.iter().any(|event| event.value.is_none()) {
            let first = self.model.time.steps.first().map_or_else(DeckPlace::start, |step| step.place.clone());
            notes.add(&first, what, "the case keeps its film to the end", Matter::Answer);
        }
    }

    /// Probes of the reactions of supports.
    fn probes(&self) -> String {
        let mut text = String::new();
        let held = |entry: &&DeckPrescription| {
            entry.tracks.keys().any(|q| matches!(q, PrescribedQuantity::Displacement(_) | PrescribedQuantity::Normal))
        };
        let hot = |entry: &&DeckPrescription| entry.tracks.contains_key(&PrescribedQuantity::Temperature);
        let all = self.model.conditions.entries.iter();
        let forces = all.clone().filter(held).map(|entry| (entry, "reaction"));
        let heats = all.filter(hot).map(|entry| (entry, "reaction_heat"));
        let mut known: Vec<String> = Vec::new();
        for (entry, quantity) in forces.chain(heats).take(MOST_PROBES) {
            let admitted = |c: char| if c.is_ascii_alphanumeric() || "_-.".contains(c) { c } else { '_' };
            let name: String = format!("{quantity}-{}", entry.on).chars().map(admitted).collect();
            if known.contains(&name) {
                continue;
            }
            text += &format!("\n[[probe]]\nname = \"{name}\"\nquantity = \"{quantity}\"\n");
            text += &format!("on = {}\ntake = \"integral\"\n", quoted(&entry.on));
            known.push(name);
        }
        text
    }
}

/// The origin of a material, for a comment.
fn of_section(section: &DeckSection) -> String {
    one_line(&format!("{}: *SOLID SECTION {}", section.material, section.place))
}
