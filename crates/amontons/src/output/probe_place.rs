//! Probes: quantity and place.

use super::quantity::Quantity;
use crate::tensor::Point;
use crate::units::Measure;

/// A number, or the components of a vector or tensor, recorded during a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Its name, the beginning of the names of its columns.
    pub name: String,
    /// The quantity read.
    pub quantity: Quantity,
    /// The place.
    pub place: ProbePlace,
    /// The reference point of a moment, m. `None` for the point of action of the rigid part on this side, if given,
    /// else for the centre of the side.
    pub about: Option<Point>,
}

/// The place where a probe reads.
///
/// Stresses, strains and heat fluxes at points and on sides are the recovered ones ([`super::nodal_stress`]),
/// interpolated from the nodes of the cell; they do not cross the boundary of a region. Means and integrals over a
/// region use the values in the cells.
///
/// Quantities of contact over a side use all contact points of its contacts. Over either side of a pair they use the
/// points of the pair, whichever side bears them. `traction` and `slip_velocity` are those of the named side, and at a
/// point those of the side `on`. `wear` over a side of a pair is the depth off its body. If a side bears the points of
/// several contacts, each contact has its own point at every node, and all count; to read one contact, name it.
#[derive(Clone, Debug, PartialEq)]
pub enum ProbePlace {
    /// At a point, m: interpolated in its cell; at a point of several cells in the first of them.
    At(Point),
    /// Over a facet set.
    On(String, Take),
    /// Over a region of the mesh.
    Region(String, Take),
    /// Over the points of one contact, by its name; vectors refer to its side `on`.
    Contact(String, Take),
    /// At a point of one contact, by its name.
    AtContact(Point, String),
}

/// Reduction of the values over a side or region, component by component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Take {
    /// Integral divided by measure.
    Mean,
    /// Maximum nodal value. On quadratic facets contact pressures and tractions are averaged per vertex first.
    Max,
    /// Minimum nodal value. On quadratic facets contact pressures and tractions are averaged per vertex first.
    Min,
    /// Integral over the length or area of a side (per unit of thickness in two dimensions), with 2πr in a body of
    /// revolution.
    Integral,
}

/// The reasons why a probe cannot be read.
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
    /// A quantity that needs a normal, but not on a side.
    #[error("{0} elsewhere than on a side")]
    Normal(String),
    /// A quantity of contact, but not on a side of a contact.
    #[error("{0} elsewhere than on a side of a contact")]
    Contact(String),
    /// There is no contact of this name.
    #[error("no such contact; there are {}", .0.join(", "))]
    NoContact(Vec<String>),
    /// A point on a side that bears the points of several contacts.
    #[error("a point of the contacts {}", .0.join(", "))]
    Several(Vec<String>),
    /// A quantity of the body, but on a contact.
    #[error("{0}, which is not of the contact")]
    OfBody(String),
    /// A reaction where neither displacement nor temperature is prescribed.
    #[error("{0} elsewhere than where the {1} is prescribed")]
    Free(String, &'static str),
    /// A reaction with a reduction other than the resultant.
    #[error("{0} other than its integral")]
    Resultant(String),
    /// A rotation with a reduction other than the mean.
    #[error("{0} other than its mean")]
    OnlyMean(String),
    /// A moment or a rotation of a body that cannot turn.
    #[error("{0} in {1}, which does not turn")]
    Still(String, &'static str),
    /// The rotation of one point.
    #[error("{0} of a single point")]
    Alone(String),
    /// A resultant of a whole side, but at another place.
    #[error("{0} elsewhere than on a side, an edge or points")]
    Whole(String),
    /// A reference point for a quantity that is no moment.
    #[error("`about` of {0}")]
    About(String),
    /// A field that the problem does not solve for.
    #[error("{0}, a field that the case does not solve for")]
    Absent(String),
    /// A hoop stress of a body that is not a body of revolution.
    #[error("hoop in a body that is not axisymmetric")]
    Hoop,
}

impl Probe {
    /// The quantity that its values measure, or `None` for an integral without a name of its own.
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
    /// The reduction, or `None` at a point.
    pub(super) fn take(&self) -> Option<Take> {
        match self {
            ProbePlace::At(_) | ProbePlace::AtContact(..) => None,
            ProbePlace::On(_, take) | ProbePlace::Region(_, take) | ProbePlace::Contact(_, take) => Some(*take),
        }
    }
}
