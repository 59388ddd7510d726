//! A finding: a statement with its id, status, numbers and text.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::problem::Physics;

/// The ids of findings, each with its text, its kind and the equations that it concerns.
macro_rules! findings {
    ($(#[doc = $doc:literal] $id:ident = $text:literal, $kind:ident, $of:ident;)*) => {
        /// The subject of a finding. Its text is the `id` of result files and messages.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        #[serde(into = "String", try_from = "String")]
        #[non_exhaustive]
        pub enum FindingId {
            $(#[doc = $doc] $id,)*
        }

        impl FindingId {
            /// All ids, in the order of the table in [`crate::hypotheses`].
            pub const ALL: &[FindingId] = &[$(FindingId::$id),*];

            /// The text of result files and messages.
            #[must_use]
            pub const fn as_str(self) -> &'static str {
                match self { $(FindingId::$id => $text,)* }
            }

            /// The subject in words.
            #[must_use]
            pub const fn meaning(self) -> &'static str {
                match self { $(FindingId::$id => $doc.trim_ascii(),)* }
            }

            /// Warning, or statement on the theory.
            #[must_use]
            pub const fn kind(self) -> Kind {
                match self { $(FindingId::$id => Kind::$kind,)* }
            }

            /// The equations that it concerns.
            const fn equations(self) -> Equations {
                match self { $(FindingId::$id => Equations::$of,)* }
            }
        }
    };
}

findings! {
    /// (H1) on 𝓥.
    H1 = "H1", Theory, Mechanics;
    /// (H2) on 𝓔.
    H2 = "H2", Theory, Mechanics;
    /// (H3) on 𝓚.
    H3 = "H3", Theory, Heat;
    /// (H4) on 𝓜.
    H4 = "H4", Theory, Both;
    /// (H5) on 𝓡.
    H5 = "H5", Theory, Both;
    /// (H6) on loads, gap and initial data.
    H6 = "H6", Theory, Any;
    /// (H7) on k_c.
    H7 = "H7", Theory, Both;
    /// (H8) on p_ν and p_τ.
    H8 = "H8", Theory, Mechanics;
    /// The cut-off of φ_L in (2.10).
    PhiL = "phi-L", Theory, Both;
    /// (2.23) as it is printed.
    Printed = "2.23-printed", Theory, Mechanics;
    /// The condition that replaces (2.23).
    Needed = "2.23-needed", Theory, Mechanics;
    /// One solution of a step.
    StepUnique = "step-unique", Theory, Mechanics;
    /// The number of steps that ensures one solution.
    TimeStep = "time-step", Theory, Mechanics;
    /// A rigid foundation that conducts by the penetration.
    ContactHeat = "contact-heat", Warning, Both;
    /// Softening contact laws.
    Softening = "softening", Theory, Mechanics;
    /// The shape of the cells.
    MeshQuality = "mesh-quality", Warning, Any;
    /// Possibility of contact.
    ContactPossible = "contact-possible", Warning, Mechanics;
    /// Coverage of the sides of pairs.
    Pairs = "pairs", Warning, Mechanics;
    /// The energy identity of a run.
    Energy = "energy", Warning, Mechanics;
    /// The heat identity of a run.
    Heat = "heat", Warning, Heat;
    /// Why there is no certificate.
    Certificate = "certificate", Theory, Mechanics;
    /// Nodes at one place.
    CoincidentNodes = "coincident-nodes", Warning, Any;
    /// A part that can move without strain.
    PartFree = "part-free", Warning, Mechanics;
    /// Forces on points or edges, under which the displacement has no bound.
    PointForce = "point-force", Warning, Mechanics;
    /// Contact points whose normal displacement is prescribed.
    ContactHeld = "contact-held", Warning, Mechanics;
    /// Pairs that overlap at rest, or whose facets are deep compared with the gap.
    PairGap = "pair-gap", Warning, Mechanics;
    /// Sides that are inside an obstacle at the start, or where their contact begins.
    StartInside = "start-inside", Warning, Mechanics;
    /// Penetrations of rigid foundations at the start that the scheme keeps.
    StartKept = "start-kept", Warning, Mechanics;
    /// Prescribed displacements that begin away from where their side is, where inertia acts.
    PhaseJump = "phase-jump", Warning, Mechanics;
    /// Obstacles from files whose size is far from that of the body.
    ObstacleSize = "obstacle-size", Warning, Mechanics;
    /// An expansion tensor of the size of α.
    ExpansionScale = "expansion-scale", Warning, Both;
    /// An expansion tensor without a component zz in plane strain.
    ExpansionZz = "expansion-zz", Warning, Both;
    /// The pressures of a rigid part that meets a rigid body by rigid contact.
    RigidOnRigid = "rigid-on-rigid", Warning, Mechanics;
    /// The mean dilatation of cells whose dilatation is constant.
    MeanDilatation = "mean-dilatation", Warning, Mechanics;
    /// A coefficient that jumps within a cell.
    CoefficientJump = "coefficient-jump", Warning, Any;
    /// Cells that are too large for the heat of Γ_C.
    ThermalLayer = "thermal-layer", Warning, Heat;
    /// Large strain.
    Strain = "strain", Warning, Mechanics;
    /// Temperatures outside the range of the data.
    TemperatureRange = "temperature-range", Warning, Mechanics;
    /// A temperature below the absolute zero of a radiating contact.
    AbsoluteZero = "absolute-zero", Warning, Mechanics;
    /// Penetration deeper than a cell.
    Penetration = "penetration", Warning, Mechanics;
    /// Rigid motions that nothing determines.
    Undetermined = "undetermined-motion", Warning, Mechanics;
    /// Contacts that never press.
    NoContact = "no-contact", Warning, Mechanics;
    /// A contact that few points of a side bear.
    FewPoints = "few-points", Warning, Mechanics;
    /// A fluid that comes through a contact.
    Leak = "leak", Warning, Mechanics;
    /// Energy of motion that the scheme takes.
    SchemeShare = "scheme-share", Warning, Mechanics;
    /// Velocities that change sign from step to step.
    Alternation = "alternation", Warning, Mechanics;
    /// A stiffness and a density that no material has together.
    Magnitude = "magnitude", Warning, Mechanics;
    /// Data that results do not depend on.
    NoEffect = "no-effect", Warning, Any;
    /// Friction that drops when slip starts, if nothing slows the slip.
    StaticFriction = "static-friction", Warning, Mechanics;
    /// Stresses recovered at the nodes that are far from those in the cells.
    NodalStress = "nodal-stress", Warning, Mechanics;
    /// Steps that take many times the contact systems that were predicted.
    ManySystems = "many-systems", Warning, Any;
}

/// The equations that a problem must have for a finding to apply.
#[derive(Clone, Copy)]
enum Equations {
    Any,
    Mechanics,
    Heat,
    Both,
}

impl FindingId {
    /// True if the finding applies to a problem with these equations.
    pub(super) fn concerns(self, physics: Physics) -> bool {
        match self.equations() {
            Equations::Any => true,
            Equations::Mechanics => physics.has_mechanics(),
            Equations::Heat => physics.has_heat(),
            Equations::Both => physics == Physics::Coupled,
        }
    }
}

impl fmt::Display for FindingId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// A text that is no id of a finding.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no finding has the id \"{0}\"")]
pub struct UnknownFinding(pub String);

impl FromStr for FindingId {
    type Err = UnknownFinding;

    fn from_str(text: &str) -> Result<FindingId, UnknownFinding> {
        FindingId::ALL.iter().copied().find(|id| id.as_str() == text).ok_or_else(|| UnknownFinding(text.to_owned()))
    }
}

impl TryFrom<String> for FindingId {
    type Error = UnknownFinding;

    fn try_from(text: String) -> Result<FindingId, UnknownFinding> {
        text.parse()
    }
}

impl From<FindingId> for String {
    fn from(id: FindingId) -> String {
        id.as_str().to_owned()
    }
}

/// The kind of a finding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A warning about the results: act on it if it fails.
    Warning,
    /// A statement on the scope of the theory: if it fails, the run may still be right.
    #[default]
    Theory,
}

/// The verdict on a statement, in ascending order of severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FindingStatus {
    /// The statement holds.
    Holds,
    /// The theory does not cover the data, or the statement is not evaluated.
    NotCovered,
    /// The statement fails.
    Fails,
}

impl FindingStatus {
    pub(super) fn of(holds: bool) -> FindingStatus {
        if holds { FindingStatus::Holds } else { FindingStatus::Fails }
    }

    /// The text of result files and messages.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            FindingStatus::Holds => "holds",
            FindingStatus::NotCovered => "not-covered",
            FindingStatus::Fails => "fails",
        }
    }
}

impl fmt::Display for FindingStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

/// The verdict on a hypothesis or condition.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// The subject.
    pub id: FindingId,
    /// The verdict.
    pub status: FindingStatus,
    /// The value found, if any.
    pub value: Option<f64>,
    /// The value required, if any.
    pub needed: Option<f64>,
    /// Explanation in words.
    pub message: String,
    /// Place of the cause: a dotted path of the case file if there is one.
    #[serde(rename = "where")]
    pub place: String,
    /// An instruction that makes the statement hold, if one is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repair: Option<String>,
    /// Warning, or statement on the scope of the theory.
    #[serde(default)]
    pub kind: Kind,
}

impl Finding {
    pub(super) fn new(id: FindingId, status: FindingStatus, message: impl Into<String>, place: &str) -> Finding {
        Finding {
            id,
            status,
            value: None,
            needed: None,
            message: message.into(),
            place: place.to_owned(),
            repair: None,
            kind: id.kind(),
        }
    }

    /// Sets the number found and the number required.
    pub(super) fn numbers(mut self, value: Option<f64>, needed: Option<f64>) -> Finding {
        (self.value, self.needed) = (value, needed);
        self
    }

    /// Sets the instruction that repairs it; ignored if the finding holds.
    pub(super) fn repair(mut self, repair: impl Into<String>) -> Finding {
        if !self.holds() {
            self.repair = Some(repair.into());
        }
        self
    }

    /// True if the statement holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.status == FindingStatus::Holds
    }

    /// True if the statement fails.
    #[must_use]
    pub fn fails(&self) -> bool {
        self.status == FindingStatus::Fails
    }

    /// True if it is a warning that fails: something to act on.
    #[must_use]
    pub fn warns(&self) -> bool {
        self.kind == Kind::Warning && self.fails()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A finding is parsed from the text that result files contain.
    #[test]
    fn findings_are_read_as_they_are_written() {
        for &id in FindingId::ALL {
            assert_eq!(id.as_str().parse(), Ok(id));
            for status in [FindingStatus::Holds, FindingStatus::NotCovered, FindingStatus::Fails] {
                let finding = Finding::new(id, status, "message", "where");
                let text = serde_json::to_value(&finding).unwrap_or_default();
                assert_eq!((text["id"].as_str(), text["status"].as_str()), (Some(id.as_str()), Some(status.as_str())));
                assert_eq!(serde_json::from_value::<Finding>(text).ok(), Some(finding));
            }
        }
        assert!("H9".parse::<FindingId>().is_err() && FindingStatus::Holds < FindingStatus::NotCovered);
    }
}
