//! What a probe reads, and where.

use super::quantity::Quantity;
use crate::tensor::Point;
use crate::units::Measure;

/// A number, or the components of a vector or tensor, recorded during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Its name, the beginning of the names of its columns.
    pub name: String,
    /// What is read.
    pub quantity: Quantity,
    /// Where.
    pub place: ProbePlace,
    /// The point about which a moment is taken, m; none for the place of the rigid part that the side is, where one is
    /// given, else the centre of the side.
    pub about: Option<Point>,
}

/// Where a probe reads.
///
/// Stresses, strains and heat fluxes at points and on sides are the recovered ones ([`super::nodal_stress`]),
/// interpolated from the nodes of the cell, so that they do not reach over the boundary of a region. Means and
/// integrals over a region are those of the values in the cells themselves.
///
/// Quantities of contact over a side are those of all contact points of its contacts. Over either side of a pair they
/// are those of the points of the pair, whichever side bears these; `traction` and `slip_velocity` are those of the
/// side that is named, and at a point those of the side `on`. `wear` over a side of a pair is the depth off its body.
/// Of a side that bears the points of several contacts each has points of its own at every node, which all count over
/// the side; one contact is read by its name.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbePlace {
    /// At a point, m: interpolated in the cell in which it lies; at a point of several cells in the first of them.
    At(Point),
    /// Over a facet set.
    On(String, Take),
    /// Over a region of the mesh.
    Region(String, Take),
    /// Over the points of one contact, by its name; vectors are those of its side `on`.
    Contact(String, Take),
    /// At a point of one contact, by its name.
    AtContact(Point, String),
}

/// What is taken of the values over a side or region, component by component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Take {
    /// Integral over measure.
    Mean,
    /// Largest value at a node; of contact pressures and tractions on quadratic facets the largest mean about a vertex.
    Max,
    /// Smallest value at a node; of contact pressures and tractions on quadratic facets the smallest mean about a
    /// vertex.
    Min,
    /// Integral: over length or area of a side (per unit of thickness in two dimensions), 2πr included in a body of
    /// revolution.
    Integral,
}

/// Why a probe cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProbeError {
    /// The point is not in the body.
    #[error("a point outside the body, which reaches from {low:?} to {high:?}")]
    Outside {
        /// Least coordinates of the body.
        low: Vec<f64>,
        /// Largest coordinates of the body.
        high: Vec<f64>,
    },
    /// There is no such facet set.
    #[error("no such side; there are {}", .0.join(", "))]
    Side(Vec<String>),
    /// There is no such region.
    #[error("no such region; there are {}", .0.join(", "))]
    Region(Vec<String>),
    /// The body has no such component.
    #[error("{name} in {dim} {}", if *.dim == 1 { "dimension" } else { "dimensions" })]
    Component {
        /// Name of the quantity.
        name: String,
        /// Dimension of the body.
        dim: usize,
    },
    /// A quantity that needs a normal, elsewhere than on a side.
    #[error("{0} elsewhere than on a side")]
    Normal(String),
    /// A quantity of contact elsewhere than on a side of a contact.
    #[error("{0} elsewhere than on a side of a contact")]
    Contact(String),
    /// There is no contact of this name.
    #[error("no such contact; there are {}", .0.join(", "))]
    NoContact(Vec<String>),
    /// A point of a side that bears the points of several contacts.
    #[error("a point of the contacts {}", .0.join(", "))]
    Several(Vec<String>),
    /// A quantity of the body is not one of a contact.
    #[error("{0}, which is not of the contact")]
    OfBody(String),
    /// A reaction elsewhere than where the displacement or the temperature is prescribed.
    #[error("{0} elsewhere than where the {1} is prescribed")]
    Free(String, &'static str),
    /// A reaction has a resultant only.
    #[error("{0} other than its integral")]
    Resultant(String),
    /// A rotation has a mean only.
    #[error("{0} other than its mean")]
    OnlyMean(String),
    /// A moment or a rotation of a body that does not turn.
    #[error("{0} in {1}, which does not turn")]
    Still(String, &'static str),
    /// The rotation of one point.
    #[error("{0} of a single point")]
    Alone(String),
    /// What a side as a whole bears, elsewhere.
    #[error("{0} elsewhere than on a side, an edge or points")]
    Whole(String),
    /// A point about which no moment is taken.
    #[error("`about` of {0}")]
    About(String),
    /// A field that the problem does not solve for.
    #[error("{0}, a field that the case does not solve for")]
    Absent(String),
    /// A hoop stress of a body that is not one of revolution.
    #[error("hoop in a body that is not axisymmetric")]
    Hoop,
}

impl Probe {
    /// What its values measure; none of an integral that has no name of its own.
    #[must_use]
    pub fn measure(&self) -> Option<Measure> {
        let over_side = matches!(self.place, ProbePlace::On(..) | ProbePlace::Contact(..));
        match (self.place.take(), self.quantity.measure()) {
            (_, measure @ (Measure::Force | Measure::Moment | Measure::Power)) => Some(measure),
            (Some(Take::Integral), Measure::Stress) if over_side => Some(Measure::Force),
            (Some(Take::Integral), Measure::HeatFlux) if over_side => Some(Measure::Power),
            (Some(Take::Integral), Measure::SurfaceWork) if over_side => Some(Measure::Energy),
            (Some(Take::Integral), Measure::Length) if over_side => Some(Measure::Volume),
            (Some(Take::Integral), Measure::Number) if over_side => Some(Measure::Area),
            (Some(Take::Integral), _) => None,
            (_, measure) => Some(measure),
        }
    }
}

impl ProbePlace {
    /// What is taken of the values; none at a point.
    pub(super) fn take(&self) -> Option<Take> {
        match self {
            ProbePlace::At(_) | ProbePlace::AtContact(..) => None,
            ProbePlace::On(_, take) | ProbePlace::Region(_, take) | ProbePlace::Contact(_, take) => Some(*take),
        }
    }
}
