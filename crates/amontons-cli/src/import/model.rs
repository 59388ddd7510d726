//! A deck as a whole, keyword by keyword.

use std::collections::HashMap;

use super::conditions::{ConditionContext, Conditions};
use super::contact::Contacts;
use super::deck::{Card, DeckFault, DeckPlace};
use super::forces::{Force, grouped};
use super::material::{DeckMaterial, DeckSection};
use super::mesh::DeckMesh;
use super::notes::{Matter, Notes, REFUSED};
use super::orientation::Orientation;
use super::rigid::{DeckRigid, Rigids};
use super::sides::DeckSides;
use super::time::{Amplitude, DeckPhysics, DeckStep, Procedure, TimeLine};
use super::transform::Transforms;

/// Keywords of the mesh, which the library reads.
const OF_MESH: [&str; 14] = [
    "HEADING",
    "NODE",
    "ELEMENT",
    "NSET",
    "ELSET",
    "SURFACE",
    "PART",
    "END PART",
    "ASSEMBLY",
    "END ASSEMBLY",
    "INSTANCE",
    "END INSTANCE",
    "END STEP",
    "PHYSICAL CONSTANTS",
];

/// The nodes, elements and sets of a deck, in the form of a mesh file.
pub fn mesh_of(cards: &[Card]) -> String {
    let others = ["HEADING", "END STEP", "PHYSICAL CONSTANTS"];
    let is_mesh = |card: &&Card| {
        let name = card.name.as_str();
        name == "SOLID SECTION" || OF_MESH.contains(&name) && !others.contains(&name)
    };
    cards.iter().filter(is_mesh).map(Card::to_string).collect()
}

/// The content of a deck.
#[derive(Debug)]
pub struct DeckModel {
    pub sides: DeckSides,
    pub materials: Vec<DeckMaterial>,
    pub orientations: Vec<Orientation>,
    pub sections: Vec<DeckSection>,
    pub amplitudes: HashMap<String, Amplitude>,
    pub conditions: Conditions,
    pub contacts: Contacts,
    pub rigid: Vec<DeckRigid>,
    pub time: TimeLine,
    pub inertia: bool,
    pub physics: DeckPhysics,
    pub large: bool,
    pub forces: Vec<Force>,
}

/// A deck while it is read.
struct DeckReader {
    mesh: DeckMesh,
    dim: usize,
    sides: DeckSides,
    transforms: Transforms,
    materials: Vec<DeckMaterial>,
    orientations: Vec<Orientation>,
    sections: Vec<DeckSection>,
    amplitudes: HashMap<String, Amplitude>,
    conditions: Conditions,
    contacts: Contacts,
    rigid: Rigids,
    steps: Vec<DeckStep>,
    notes: Notes,
    /// True if keywords belong to the last material.
    in_material: bool,
    /// The open part.
    part: Option<String>,
    inertia: bool,
}

impl DeckModel {
    /// Reads all keywords in their order.
    pub fn of(cards: &[Card]) -> Result<(DeckModel, Notes), DeckFault> {
        refuse(cards)?;
        let mesh = DeckMesh::of(cards)?;
        check_bodies(&mesh, cards)?;
        let cells = mesh.bodies.iter().flat_map(|body| body.cells.values());
        let dim = cells.map(|cell| cell.solid.element.dim()).max().unwrap_or(0);
        let mut reading = DeckReader {
            mesh,
            dim,
            sides: DeckSides::default(),
            transforms: Transforms::default(),
            materials: Vec::new(),
            orientations: Vec::new(),
            sections: Vec::new(),
            amplitudes: HashMap::new(),
            conditions: Conditions::default(),
            contacts: Contacts::default(),
            rigid: Rigids::default(),
            steps: Vec::new(),
            notes: Notes::default(),
            in_material: false,
            part: None,
            inertia: false,
        };
        for card in cards {
            reading.take(card)?;
        }
        reading.finish(cards)
    }
}

/// Refuses analyses that a case cannot express.
fn refuse(cards: &[Card]) -> Result<(), DeckFault> {
    for card in cards {
        if let Some((_, what)) = REFUSED.iter().find(|(name, _)| *name == card.name) {
            let expected = "a static, dynamic, heat transfer or coupled temperature-displacement step";
            return Err(DeckFault::new(&card.place, format!("*{}, {what}", card.name), expected));
        }
        if card.name == "STATIC" && card.has("RIKS") {
            let expected = "a static step whose loads are given, without RIKS";
            return Err(DeckFault::new(&card.place, "*STATIC, RIKS, a path whose load is unknown", expected));
        }
    }
    Ok(())
}

/// Refuses decks without solid elements.
fn check_bodies(mesh: &DeckMesh, cards: &[Card]) -> Result<(), DeckFault> {
    if mesh.bodies.iter().any(|body| !body.cells.is_empty()) {
        return Ok(());
    }
    let expected = "solid elements, such as C3D8, C3D10, CPS4, CPE4 or CAX4";
    if let Some((kind, place, count)) = mesh.others.first() {
        let found = format!("{count} elements of type {}, which are no parts of a body", kind.escape_debug());
        return Err(DeckFault::new(place, found, expected));
    }
    let Some(first) = cards.first() else {
        return Err(DeckFault::new(&DeckPlace::start(), "no keyword", "a deck of Abaqus or CalculiX"));
    };
    Err(DeckFault::new(&first.place, "a deck without elements", expected))
}

impl DeckReader {
    fn take(&mut self, card: &Card) -> Result<(), DeckFault> {
        self.notes.parameters(card);
        if self.in_material
            && let Some(material) = self.materials.last_mut()
            && material.take(card, &mut self.notes)?
        {
            return Ok(());
        }
        self.in_material &= !OF_MESH.contains(&card.name.as_str()) && card.name != "STEP";
        match card.name.as_str() {
            "PART" => self.part = Some(card.required("NAME")?.to_owned()),
            "END PART" => self.part = None,
            _ => {}
        }
        match card.name.as_str() {
            name if OF_MESH.contains(&name) => Ok(()),
            "MATERIAL" => {
                self.materials.push(DeckMaterial::of(card)?);
                self.in_material = true;
                Ok(())
            }
            "SOLID SECTION" => self.section(card),
            "ORIENTATION" => {
                self.orientations.push(Orientation::of(card, &mut self.notes)?);
                Ok(())
            }
            "AMPLITUDE" => {
                self.amplitudes.insert(card.required("NAME")?.to_uppercase(), Amplitude::of(card)?);
                Ok(())
            }
            "TRANSFORM" => self.transforms.take(card, &self.mesh),
            "STEP" => {
                let start = self.steps.last().map_or(0.0, DeckStep::end);
                self.steps.push(DeckStep::of(card, start));
                Ok(())
            }
            _ => self.rest(card),
        }
    }

    /// Reads procedures, contacts and conditions, and notes other keywords.
    fn rest(&mut self, card: &Card) -> Result<(), DeckFault> {
        if self.procedure(card)? || self.contacts.take(card, &self.mesh, &mut self.notes)? {
            return Ok(());
        }
        let is_single = self.part.as_deref().is_none_or(|part| self.mesh.instances(part) == 1);
        if is_single && self.rigid.take(card, &self.mesh, self.dim, &mut self.notes)? {
            return Ok(());
        }
        let named = card.word("AMPLITUDE").filter(|_| card.name != "STEP");
        if let Some(name) = named.filter(|name| !self.amplitudes.contains_key(name)) {
            let found = format!("AMPLITUDE={}", name.escape_debug());
            return Err(DeckFault::new(&card.place, found, "an *AMPLITUDE that the deck defines before"));
        }
        let flat = |cell: &super::mesh::DeckElement| cell.solid.element.dim() == 2 && !cell.solid.axisymmetric;
        let is_flat = self.mesh.bodies.iter().flat_map(|body| body.cells.values()).next().is_some_and(flat);
        let thickness = self.sections.first().filter(|_| is_flat).map_or(1.0, |section| section.thickness);
        let mut scene = ConditionContext {
            mesh: &self.mesh,
            sides: &mut self.sides,
            notes: &mut self.notes,
            transforms: &self.transforms,
            rigid: &mut self.rigid,
            dim: self.dim,
            thickness,
            step: self.steps.len().saturating_sub(1),
        };
        if !self.conditions.take(card, &mut scene)? {
            self.notes.keyword(&card.place, &card.name);
        }
        Ok(())
    }

    fn section(&mut self, card: &Card) -> Result<(), DeckFault> {
        let set = card.required("ELSET")?;
        let regions = self.mesh.regions(self.part.as_deref(), set);
        if regions.is_empty() && self.part.is_none() {
            let found = format!("ELSET={}", set.escape_debug());
            return Err(DeckFault::new(&card.place, found, "an element set that the deck defines"));
        }
        let thickness = match card.data.first() {
            Some(line) => line.number(0)?.unwrap_or(1.0),
            None => 1.0,
        };
        self.sections.push(DeckSection {
            place: card.place.clone(),
            regions,
            material: card.required("MATERIAL")?.to_owned(),
            orientation: card.word("ORIENTATION"),
            thickness,
        });
        Ok(())
    }

    /// Reads the procedure of a step. Returns false for other keywords.
    fn procedure(&mut self, card: &Card) -> Result<bool, DeckFault> {
        let steady = card.has("STEADYSTATE");
        let of = |mechanics: bool, heat: bool, transient: bool| Procedure { mechanics, heat, transient };
        let procedure = match card.name.as_str() {
            "STATIC" | "VISCO" => of(true, false, false),
            "DYNAMIC" => {
                self.inertia = true;
                let why = "both programs damp by rules of their own: compare with shorter steps";
                self.notes.add(&card.place, "*DYNAMIC", why, Matter::Perhaps);
                of(true, false, true)
            }
            "HEAT TRANSFER" => of(false, true, !steady),
            "COUPLED TEMPERATURE-DISPLACEMENT" | "UNCOUPLED TEMPERATURE-DISPLACEMENT" => of(true, true, !steady),
            _ => return Ok(false),
        };
        let relaxes = self.materials.iter().any(DeckMaterial::relaxes);
        if card.name == "VISCO" && !relaxes {
            self.notes.keyword(&card.place, "VISCO");
        }
        if card.name == "STATIC" && relaxes {
            let why = "the case relaxes in all steps, Abaqus has the moduli of long times in a static step";
            self.notes.add(&card.place, "*STATIC", why, Matter::Perhaps);
        }
        let Some(step) = self.steps.last_mut() else {
            return Err(DeckFault::new(&card.place, format!("*{} outside of a step", card.name), "*STEP before it"));
        };
        step.proceed(card, procedure)?;
        Ok(true)
    }

    /// Checks that a deck has everything a case needs, and notes features of steps and elements that a case lacks.
    fn check(&mut self, cards: &[Card]) -> Result<(), DeckFault> {
        let last = cards.last().map_or_else(DeckPlace::start, |card| card.place.clone());
        if self.steps.is_empty() {
            return Err(DeckFault::new(&last, "a deck without a *STEP", "a step with its procedure, such as *STATIC"));
        }
        for step in &self.steps {
            if step.procedure.is_none() {
                return Err(DeckFault::new(
                    &step.place,
                    "a step without a procedure",
                    "*STATIC, *HEAT TRANSFER or another one",
                ));
            }
            if step.large {
                let why = "a case is a theory of small displacements and strains";
                self.notes.add(&step.place, "NLGEOM", why, Matter::Perhaps);
            }
        }
        if self.sections.is_empty() {
            return Err(DeckFault::new(
                &last,
                "a deck without a *SOLID SECTION",
                "a section with a material per element set",
            ));
        }
        for card in cards.iter().filter(|card| card.name == "ELEMENT") {
            let kind = card.word("TYPE").unwrap_or_default();
            if ["8R", "8I", "4R", "4I"].iter().any(|end| kind.ends_with(end))
                && !["CPS8R", "CPE8R", "CAX8R"].contains(&kind.as_str())
            {
                let why = "the case integrates fully, which is stiffer in bending: take finer or quadratic elements";
                self.notes.add(&card.place, format!("elements of type {}", kind.escape_debug()), why, Matter::Perhaps);
            }
        }
        for (kind, place, count) in &self.mesh.others {
            let why = format!("{count} elements are no parts of a body");
            self.notes.add(place, format!("elements of type {kind}"), why, Matter::Answer);
        }
        Ok(())
    }

    fn finish(mut self, cards: &[Card]) -> Result<(DeckModel, Notes), DeckFault> {
        self.check(cards)?;
        let procedures: Vec<Procedure> = self.steps.iter().filter_map(|step| step.procedure).collect();
        let of_heat = || procedures.iter().filter(|procedure| procedure.heat);
        let stores = of_heat().any(|procedure| procedure.transient);
        let mixed = (stores && of_heat().any(|procedure| !procedure.transient))
            || (self.inertia && procedures.iter().any(|procedure| procedure.mechanics && !procedure.transient));
        if mixed && let Some(step) = self.steps.first() {
            let why = "inertia and the storage of heat act in all steps of a case, in the deck in some";
            self.notes.add(&step.place, "*STEP", why, Matter::Answer);
        }
        self.rigid.settle(&self.mesh, &self.sections, &mut self.sides, &mut self.notes)?;
        let forces = grouped(&self.conditions, &self.mesh, &mut self.sides);
        let time = TimeLine::of(self.steps, &mut self.notes);
        let physics = DeckPhysics {
            mechanics: procedures.iter().any(|procedure| procedure.mechanics),
            heat: procedures.iter().any(|procedure| procedure.heat),
            stores,
        };
        let model = DeckModel {
            large: time.steps.iter().any(|step| step.large),
            physics,
            inertia: self.inertia,
            forces,
            sides: self.sides,
            materials: self.materials,
            orientations: self.orientations,
            sections: self.sections,
            amplitudes: self.amplitudes,
            conditions: self.conditions,
            contacts: self.contacts,
            rigid: self.rigid.parts,
            time,
        };
        Ok((model, self.notes))
    }
}
