//! Parts of a deck that are missing in the case, and their effect on the answer.

use super::deck::{Card, DeckPlace};

/// Effect on the answer of a part that is left out or expressed otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Matter {
    /// The answer differs.
    Answer,
    /// The answer may differ under a condition named in the reason.
    Perhaps,
    /// The answer is the same.
    Nothing,
}

/// A part of the deck that the case expresses otherwise or not at all.
#[derive(Clone, Debug)]
struct Note {
    place: DeckPlace,
    what: String,
    why: String,
    matter: Matter,
    count: usize,
}

/// All notes of a deck.
#[derive(Debug, Default)]
pub struct Notes(Vec<Note>);

/// Keywords that request output or end a block.
const OUTPUT: [&str; 25] = [
    "NODE PRINT",
    "EL PRINT",
    "NODE FILE",
    "EL FILE",
    "CONTACT FILE",
    "CONTACT PRINT",
    "FACE PRINT",
    "SECTION PRINT",
    "ELEMENT PRINT",
    "OUTPUT",
    "NODE OUTPUT",
    "ELEMENT OUTPUT",
    "CONTACT OUTPUT",
    "ENERGY OUTPUT",
    "ENERGY PRINT",
    "ENERGY FILE",
    "FILE FORMAT",
    "FILE OUTPUT",
    "RESTART",
    "PREPRINT",
    "PRINT",
    "MONITOR",
    "TIME POINTS",
    "FILTER",
    "INTEGRATED OUTPUT",
];
/// Keywords that control the solution method of the other program.
const CONTROL: [&str; 6] =
    ["CONTROLS", "SOLVER", "SOLUTION TECHNIQUE", "CONTACT CONTROLS", "CONTACT STABILIZATION", "SECTION CONTROLS"];

/// Keywords whose loss changes the answer, with the reason.
const KNOWN: [(&str, &str); 33] = [
    ("PLASTIC", "the case is elastic: the answer differs where the yield stress is reached"),
    ("CYCLIC HARDENING", "the case is elastic: the answer differs where the yield stress is reached"),
    ("DEFORMATION PLASTICITY", "the case is elastic"),
    ("RATE DEPENDENT", "the case is elastic"),
    ("CREEP", "the case has no such creep law"),
    ("HYPERELASTIC", "the case has no such law: give a modulus for small strains"),
    ("HYPERFOAM", "the case has no such law: give a modulus for small strains"),
    ("USER MATERIAL", "the case has no such law"),
    ("CONCRETE DAMAGED PLASTICITY", "the case is elastic"),
    ("MOHR COULOMB", "the case is elastic"),
    ("DRUCKER PRAGER", "the case is elastic"),
    ("DAMPING", "the case has no such damping; see `viscosity`"),
    ("GAP RADIATION", "the case radiates no heat there; see the heat law `radiation`"),
    ("RADIATE", "the case radiates no heat there"),
    ("SRADIATE", "the case radiates no heat there"),
    ("CAVITY RADIATION", "the case radiates no heat there"),
    ("EQUATION", "the nodes are not coupled"),
    ("MPC", "the nodes are not coupled"),
    ("COUPLING", "the nodes are not coupled"),
    ("DISTRIBUTING COUPLING", "the nodes are not coupled"),
    ("KINEMATIC COUPLING", "the nodes are not coupled"),
    ("KINEMATIC", "the nodes are not coupled"),
    ("DISTRIBUTING", "the nodes are not coupled"),
    ("RIGID BODY", "the body is not rigid: see [[rigid]]"),
    ("PRE-TENSION SECTION", "the bolt has no pretension: see `preload` of a contact"),
    ("SPRING", "there is no spring; see `spring` of a side"),
    ("DASHPOT", "there is no dashpot; see `dashpot` of a side"),
    ("MASS", "there is no mass at the point"),
    ("CONTACT", "general contact is not taken; see `automatic` of a contact"),
    ("CYCLIC SYMMETRY MODEL", "sectors are not repeated; see `[[cyclic]]`"),
    ("MODEL CHANGE", "bodies and contacts are there all the time"),
    ("VISCO", "the step is taken as a static one"),
    ("BASE MOTION", "the base does not move"),
];

/// Parameters that are used or have no effect on the answer, by their keywords.
const PARAMETERS: [(&str, &[&str]); 35] = [
    ("AMPLITUDE", &["NAME", "TIME", "DEFINITION"]),
    ("BOUNDARY", &["OP", "AMPLITUDE", "TYPE"]),
    ("CFLUX", &["OP", "AMPLITUDE"]),
    ("CLEARANCE", &["SLAVE", "MASTER", "VALUE"]),
    ("CLOAD", &["OP", "AMPLITUDE"]),
    ("CONDUCTIVITY", &["TYPE"]),
    (
        "CONTACT PAIR",
        &[
            "INTERACTION",
            "TYPE",
            "ADJUST",
            "SMALLSLIDING",
            "MECHANICALCONSTRAINT",
            "CPSET",
            "TRACKING",
            "EXTENSIONZONE",
        ],
    ),
    ("COUPLING", &["CONSTRAINTNAME", "REFNODE", "SURFACE"]),
    ("COUPLED TEMPERATURE-DISPLACEMENT", &["STEADYSTATE", "DIRECT", "SOLVER", "DELTMX", "CETOL", "CREEP"]),
    ("DENSITY", &[]),
    ("DFLUX", &["OP", "AMPLITUDE"]),
    ("DLOAD", &["OP", "AMPLITUDE"]),
    ("DSFLUX", &["OP", "AMPLITUDE"]),
    ("DSLOAD", &["OP", "AMPLITUDE"]),
    ("DYNAMIC", &["DIRECT", "SOLVER", "ALPHA", "APPLICATION", "NOHAF", "HAFTOL", "INITIAL", "RELATIVETOABSOLUTE"]),
    ("ELASTIC", &["TYPE", "MODULI"]),
    ("EXPANSION", &["TYPE", "ZERO"]),
    ("FILM", &["OP", "AMPLITUDE", "FILMAMPLITUDE"]),
    ("FRICTION", &["SLIPTOLERANCE", "ELASTICSLIP", "TAUMAX", "ROUGH"]),
    ("GAP CONDUCTANCE", &["PRESSURE"]),
    ("HEAT TRANSFER", &["STEADYSTATE", "DIRECT", "SOLVER", "DELTMX", "END", "MXDEM"]),
    ("KINEMATIC", &[]),
    ("KINEMATIC COUPLING", &["REFNODE"]),
    ("MATERIAL", &["NAME"]),
    ("ORIENTATION", &["NAME", "SYSTEM"]),
    ("RIGID BODY", &["NSET", "PINNSET", "TIENSET", "ELSET", "REFNODE", "ROTNODE"]),
    ("SFILM", &["OP", "AMPLITUDE", "FILMAMPLITUDE"]),
    ("SOLID SECTION", &["ELSET", "MATERIAL", "ORIENTATION", "CONTROLS"]),
    ("SPECIFIC HEAT", &[]),
    ("STATIC", &["DIRECT", "SOLVER", "TIMERESET"]),
    ("STEP", &["NAME", "INC", "NLGEOM", "AMPLITUDE", "UNSYMM", "EXTRAPOLATION", "CONVERTSDI"]),
    ("SURFACE BEHAVIOR", &["PRESSURE-OVERCLOSURE", "PENALTY", "AUGMENTEDLAGRANGE", "DIRECT"]),
    ("SURFACE INTERACTION", &["NAME"]),
    ("TEMPERATURE", &["OP", "AMPLITUDE"]),
    ("TIE", &["NAME", "ADJUST", "POSITIONTOLERANCE", "TYPE", "NOROTATION"]),
];

/// Analyses that a case cannot express.
pub const REFUSED: [(&str, &str); 12] = [
    ("BUCKLE", "a buckling analysis"),
    ("FREQUENCY", "an analysis of natural frequencies"),
    ("COMPLEX FREQUENCY", "an analysis of complex frequencies"),
    ("MODAL DYNAMIC", "a dynamic analysis by modes"),
    ("STEADY STATE DYNAMICS", "an analysis of a harmonic response"),
    ("RANDOM RESPONSE", "an analysis of a random response"),
    ("RESPONSE SPECTRUM", "an analysis of a response spectrum"),
    ("GREEN", "an analysis by Green's functions"),
    ("SUBSTRUCTURE GENERATE", "the generation of a substructure"),
    ("SENSITIVITY", "a sensitivity analysis"),
    ("ELECTROMAGNETICS", "an electromagnetic analysis"),
    ("CFD", "an analysis of a flow"),
];

impl Notes {
    /// Adds a note; repeated notes with the same reason are counted.
    pub fn add(&mut self, place: &DeckPlace, what: impl Into<String>, why: impl Into<String>, matter: Matter) {
        let (what, why) = (what.into(), why.into());
        match self.0.iter_mut().find(|note| note.what == what && note.why == why) {
            Some(note) => note.count += 1,
            None => self.0.push(Note { place: place.clone(), what, why, matter, count: 1 }),
        }
    }

    /// Notes the parameters of a keyword that are not used.
    pub fn parameters(&mut self, card: &Card) {
        let Some((_, known)) = PARAMETERS.iter().find(|(name, _)| *name == card.name) else { return };
        for parameter in card.parameters().filter(|parameter| !known.contains(parameter)) {
            if parameter == "VALUE" && card.word("VALUE").as_deref() == Some("RELATIVE") {
                continue;
            }
            let what = format!("{} of *{}", parameter.escape_debug(), card.name);
            self.add(&card.place, what, "the parameter is not taken", Matter::Perhaps);
        }
    }

    /// Notes a keyword that is not used.
    pub fn keyword(&mut self, place: &DeckPlace, name: &str) {
        let what = format!("*{name}");
        if OUTPUT.contains(&name) {
            self.add(place, what, "output only", Matter::Nothing);
        } else if CONTROL.contains(&name) {
            self.add(place, what, "control of the solution, which is not needed here", Matter::Nothing);
        } else if let Some((_, why)) = KNOWN.iter().find(|(known, _)| *known == name) {
            self.add(place, what, *why, Matter::Answer);
        } else {
            self.add(place, what, "not known: see whether the answer depends on it", Matter::Perhaps);
        }
    }

    /// One line per note, those with an effect first.
    pub fn lines(&self) -> Vec<String> {
        let mut notes: Vec<&Note> = self.0.iter().collect();
        notes.sort_by_key(|note| note.matter);
        let width = notes.iter().map(|note| note.place.to_string().len()).max().unwrap_or(0);
        let line = |note: &&Note| {
            let Note { place, what, why, matter, count } = note;
            let mark = match matter {
                Matter::Answer => "the answer differs",
                Matter::Perhaps => "may matter",
                Matter::Nothing => "does not matter",
            };
            let more = if *count > 1 { format!(" ({count} times)") } else { String::new() };
            format!("{:width$}  {what}{more}: {why} [{mark}]", place.to_string())
        };
        notes.iter().map(line).collect()
    }
}
