//! Quantities that probes read, by their names in case files and tables.

use super::PointValues;
use crate::material::VTK_COMPONENTS;
use crate::state::State;
use crate::tensor::{Point, Sym, dot, length};
use crate::units::Measure;

/// The physical quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// u in m.
    Displacement,
    /// w = u̇ in m/s.
    Velocity,
    /// θ in K.
    Temperature,
    /// σ of (2.1) in Pa.
    Stress,
    /// ε(u).
    Strain,
    /// Von Mises stress in Pa.
    VonMises,
    /// tr(σ)/3 in Pa.
    MeanStress,
    /// Principal stresses in Pa, the largest first.
    Principal,
    /// Hoop stress of a body of revolution in Pa.
    Hoop,
    /// q = −𝓚∇θ in W/m².
    HeatFlux,
    /// Force of a prescribed displacement on the body, N: its integral over a side.
    Reaction,
    /// The moment of reaction forces about a point, N m.
    ReactionMoment,
    /// Total force on a side, N: prescribed values, given loads, supports and contact.
    TotalForce,
    /// The moment of the total force about a point, N m.
    TotalMoment,
    /// The rotation of the rigid motion nearest to the displacements of a side or region, rad.
    Rotation,
    /// Heat supplied to the body by a prescribed temperature, W: its integral over a side.
    ReactionHeat,
    /// A quantity defined at the contact points only.
    Contact(ContactQuantity),
}

impl Base {
    /// True if the quantity follows from the strains, which rigid motions do not change.
    #[must_use]
    pub fn is_of_strains(self) -> bool {
        let all = [Base::Stress, Base::Strain, Base::VonMises, Base::MeanStress, Base::Principal, Base::Hoop];
        all.contains(&self)
    }
}

/// A quantity at the contact points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactQuantity {
    /// p_ν in Pa.
    Pressure,
    /// r in m; negative for an open gap.
    Penetration,
    /// σ_τ in Pa, the traction of friction on the body.
    Traction,
    /// w_τ − v_F in m/s.
    SlipVelocity,
    /// 1 in contact, 0 for an open gap: its integral is the area of contact.
    Touching,
    /// Depth of wear, m.
    Wear,
    /// Work of friction since the start, J/m².
    FrictionWork,
}

/// The selected part of a vector or tensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Selection {
    /// All components.
    All,
    /// One component: x, y, z of a vector; xx, yy, zz, xy, yz, zx of a tensor; the first, second, third principal
    /// value.
    Component(usize),
    /// The length of a vector.
    Magnitude,
    /// The component along the outward normal ν of a side: v·ν of a vector v, σν·ν of a tensor.
    Normal,
}

/// A quantity by its name, such as `displacement_x`, `von_mises`, `stress`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// The physical quantity.
    pub base: Base,
    /// The selected part.
    pub part: Selection,
}

const VECTOR: &[(&str, Selection)] = &[
    ("", Selection::All),
    ("_x", Selection::Component(0)),
    ("_y", Selection::Component(1)),
    ("_z", Selection::Component(2)),
    ("_magnitude", Selection::Magnitude),
    ("_normal", Selection::Normal),
];
const NO_NORMAL: &[(&str, Selection)] = &[
    ("", Selection::All),
    ("_x", Selection::Component(0)),
    ("_y", Selection::Component(1)),
    ("_z", Selection::Component(2)),
    ("_magnitude", Selection::Magnitude),
];
const TENSOR: &[(&str, Selection)] = &[
    ("", Selection::All),
    ("_xx", Selection::Component(0)),
    ("_yy", Selection::Component(1)),
    ("_zz", Selection::Component(2)),
    ("_xy", Selection::Component(3)),
    ("_yz", Selection::Component(4)),
    ("_zx", Selection::Component(5)),
    ("_normal", Selection::Normal),
];
const PRINCIPAL: &[(&str, Selection)] = &[
    ("", Selection::All),
    ("_1", Selection::Component(0)),
    ("_2", Selection::Component(1)),
    ("_3", Selection::Component(2)),
];
const NUMBER: &[(&str, Selection)] = &[("", Selection::All)];

/// Quantities known for a side as a whole only: reactions, resultants and rotation.
pub(crate) const OF_WHOLE: [Base; 6] =
    [Base::Reaction, Base::ReactionHeat, Base::ReactionMoment, Base::TotalForce, Base::TotalMoment, Base::Rotation];

/// What is known of a quantity without the selected part.
struct BaseRow {
    name: &'static str,
    base: Base,
    parts: &'static [(&'static str, Selection)],
    measure: Measure,
    meaning: &'static str,
}

macro_rules! bases {
    ($($name:literal: $base:expr, $parts:ident, $measure:ident, $meaning:literal;)*) => {
        &[$(BaseRow { name: $name, base: $base, parts: $parts, measure: Measure::$measure, meaning: $meaning }),*]
    };
}

/// Every quantity: name, parts with the endings of their names, measured quantity, and meaning.
const BASES: &[BaseRow] = bases! {
    "displacement": Base::Displacement, VECTOR, Length, "displacement u";
    "velocity": Base::Velocity, VECTOR, Velocity, "velocity w = u̇";
    "temperature": Base::Temperature, NUMBER, Temperature, "temperature θ";
    "stress": Base::Stress, TENSOR, Stress, "stress σ of (2.1)";
    "strain": Base::Strain, TENSOR, Number, "strain ε(u)";
    "von_mises": Base::VonMises, NUMBER, Stress, "von Mises stress";
    "mean_stress": Base::MeanStress, NUMBER, Stress, "tr(σ)/3";
    "principal": Base::Principal, PRINCIPAL, Stress, "principal stresses, the largest first";
    "hoop": Base::Hoop, NUMBER, Stress, "hoop stress of a body of revolution";
    "heat_flux": Base::HeatFlux, VECTOR, HeatFlux, "heat flux q = −𝓚∇θ";
    "reaction": Base::Reaction, NO_NORMAL, Force, "what a prescribed displacement exerts on the body";
    "reaction_moment": Base::ReactionMoment, NO_NORMAL, Moment,
        "moment about a point of what a prescribed displacement exerts on the body";
    "total_force": Base::TotalForce, NO_NORMAL, Force,
        "all that acts on a side: what holds it, loads, supports and contact";
    "total_moment": Base::TotalMoment, NO_NORMAL, Moment, "moment about a point of all that acts on a side";
    "rotation": Base::Rotation, NO_NORMAL, Angle, "rotation of the rigid motion nearest to the displacements";
    "reaction_heat": Base::ReactionHeat, NUMBER, Power, "heat that a prescribed temperature supplies to the body";
    "pressure": Base::Contact(ContactQuantity::Pressure), NUMBER, Stress, "contact pressure p_ν";
    "penetration": Base::Contact(ContactQuantity::Penetration), NUMBER, Length,
        "penetration r, negative where the gap is open";
    "traction": Base::Contact(ContactQuantity::Traction), NO_NORMAL, Stress, "what friction does to the side, σ_τ";
    "slip_velocity": Base::Contact(ContactQuantity::SlipVelocity), NO_NORMAL, Velocity,
        "slip velocity of the side against what it faces";
    "touching": Base::Contact(ContactQuantity::Touching), NUMBER, Number,
        "1 where there is contact, 0 where the gap is open: its integral is the area";
    "wear": Base::Contact(ContactQuantity::Wear), NUMBER, Length, "depth worn off";
    "friction_work": Base::Contact(ContactQuantity::FrictionWork), NUMBER, SurfaceWork,
        "work of friction since the start";
};

/// Every quantity: its name, its meaning, and the quantity that it measures.
#[must_use]
pub fn quantities() -> Vec<(String, String, Measure)> {
    Quantity::all().map(|(name, quantity)| (name, quantity.meaning(), quantity.measure())).collect()
}

impl Quantity {
    fn row(self) -> &'static BaseRow {
        BASES.iter().find(|row| row.base == self.base).unwrap_or(&BASES[0])
    }

    /// Its meaning in words, with the selected part.
    fn meaning(self) -> String {
        let of = self.row().meaning;
        let ending = self.name();
        let component = |c: usize| {
            let name = ending.rsplit('_').next().unwrap_or_default();
            if self.base == Base::Principal {
                format!("{of}: number {}", c + 1)
            } else {
                format!("{of}: {name} component")
            }
        };
        match self.part {
            Selection::All => of.to_owned(),
            Selection::Component(c) => component(c),
            Selection::Magnitude => format!("{of}: its length"),
            Selection::Normal => format!("{of}: its part along the outward normal of a side"),
        }
    }

    /// Every quantity with its name.
    pub fn all() -> impl Iterator<Item = (String, Quantity)> {
        BASES.iter().flat_map(|row| {
            row.parts.iter().map(|&(ending, part)| (format!("{}{ending}", row.name), Quantity { base: row.base, part }))
        })
    }

    /// The quantity of a name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Quantity> {
        Quantity::all().find(|(known, _)| known == name).map(|(_, quantity)| quantity)
    }

    /// The name.
    #[must_use]
    pub fn name(self) -> String {
        Quantity::all().find(|(_, known)| *known == self).map(|(name, _)| name).unwrap_or_default()
    }

    /// The quantity that its values measure.
    #[must_use]
    pub fn measure(self) -> Measure {
        self.row().measure
    }

    /// Endings of the names of its columns in `dim` dimensions; one empty ending for a scalar.
    #[must_use]
    pub fn columns(self, dim: usize) -> Vec<&'static str> {
        if self.part != Selection::All {
            return vec![""];
        }
        let parts = self.row().parts;
        if self.is_axial() && dim < 3 {
            return vec![""];
        }
        let most = if self.is_vector() { dim } else { usize::MAX };
        let components = parts
            .iter()
            .filter(|(_, part)| matches!(part, Selection::Component(c) if *c < most))
            .map(|(ending, _)| *ending);
        if parts.len() == 1 { vec![""] } else { components.collect() }
    }

    /// True for a field at the nodes, whose values elsewhere are interpolated.
    pub(super) fn is_nodal(self) -> bool {
        matches!(self.base, Base::Displacement | Base::Velocity | Base::Temperature)
    }

    /// True for a vector of the body, with one component per dimension of the body.
    pub(super) fn is_vector(self) -> bool {
        matches!(
            self.base,
            Base::Displacement
                | Base::Velocity
                | Base::HeatFlux
                | Base::Reaction
                | Base::TotalForce
                | Base::Contact(ContactQuantity::Traction | ContactQuantity::SlipVelocity)
        )
    }

    /// True for a moment or a rotation: a vector in space, a number about the normal in the plane.
    pub(super) fn is_axial(self) -> bool {
        matches!(self.base, Base::ReactionMoment | Base::TotalMoment | Base::Rotation)
    }

    /// True for a moment.
    pub(super) fn is_moment(self) -> bool {
        self.measure() == Measure::Moment
    }

    /// True if a body in `dim` dimensions has the selected component.
    pub(super) fn has_component(self, dim: usize) -> bool {
        let Selection::Component(c) = self.part else { return true };
        if self.is_axial() { dim == 3 || c == 2 } else { !self.is_vector() || c < dim }
    }

    /// The selected parts of a vector, or of a scalar in its first component.
    pub(super) fn parts(self, dim: usize, v: &Point) -> Vec<f64> {
        let mut out = Vec::new();
        if self.is_vector() || self.is_axial() && (dim == 3 || self.part != Selection::All) {
            self.of_vector(dim, v, &[0.0; 3], &mut out);
        } else if self.is_axial() {
            out.push(v[2]);
        } else {
            out.push(v[0]);
        }
        out
    }

    /// Appends its values at a point with these interpolated nodal fields and these point values; ν is the outward
    /// normal there.
    pub(super) fn values(self, dim: usize, nodal: &Point, point: &PointValues, normal: &Point, out: &mut Vec<f64>) {
        match self.base {
            Base::Displacement | Base::Velocity => self.of_vector(dim, nodal, normal, out),
            Base::Temperature => out.push(nodal[0]),
            Base::HeatFlux => self.of_vector(dim, &point.heat_flux, normal, out),
            Base::Stress => self.of_tensor(&point.stress, normal, out),
            Base::Strain => self.of_tensor(&point.strain, normal, out),
            Base::VonMises => out.push(point.stress.von_mises()),
            Base::MeanStress => out.push(point.stress.trace() / 3.0),
            Base::Hoop => out.push(point.stress.get(2, 2)),
            Base::Principal => {
                let axes = point.stress.principal_axes();
                match self.part {
                    Selection::Component(c) => out.extend(axes.get(c).map(|(value, _)| *value)),
                    _ => out.extend(axes.map(|(value, _)| value)),
                }
            }
            // These are known only at contact points, at prescribed values and for whole sides.
            Base::Contact(_) | Base::Reaction | Base::ReactionHeat => out.push(f64::NAN),
            Base::ReactionMoment | Base::TotalForce | Base::TotalMoment | Base::Rotation => out.push(f64::NAN),
        }
    }

    fn of_vector(self, dim: usize, v: &Point, normal: &Point, out: &mut Vec<f64>) {
        match self.part {
            Selection::All => out.extend(v.iter().take(dim)),
            Selection::Component(c) => out.extend(v.get(c)),
            Selection::Magnitude => out.push(length(v)),
            Selection::Normal => out.push(dot(v, normal)),
        }
    }

    fn of_tensor(self, tensor: &Sym, normal: &Point, out: &mut Vec<f64>) {
        match self.part {
            Selection::Component(c) => out.extend(VTK_COMPONENTS.get(c).map(|&(i, j)| tensor.get(i, j))),
            Selection::Normal => out.push(dot(&tensor.apply(normal), normal)),
            Selection::All | Selection::Magnitude => out.extend(VTK_COMPONENTS.map(|(i, j)| tensor.get(i, j))),
        }
    }

    /// The nodal field of this quantity at a node: two or three components, or one.
    pub(super) fn at_node(self, state: &State, dim: usize, node: usize) -> Point {
        let vector = |all: &[f64]| std::array::from_fn(|c| if c < dim { all[node * dim + c] } else { 0.0 });
        match self.base {
            Base::Displacement => vector(&state.u),
            Base::Velocity => vector(&state.w),
            Base::Temperature => [state.theta[node], 0.0, 0.0],
            _ => [0.0; 3],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        let all: Vec<(String, Quantity)> = Quantity::all().collect();
        for (name, quantity) in &all {
            assert_eq!((Quantity::parse(name), &quantity.name()), (Some(*quantity), name));
            assert_eq!(all.iter().filter(|(other, _)| other == name).count(), 1);
        }
        assert_eq!(Quantity::parse("displacement_xx"), None);
        let columns = |name: &str, dim| Quantity::parse(name).map(|q| q.columns(dim));
        assert_eq!(columns("velocity", 2), Some(vec!["_x", "_y"]));
        assert_eq!(columns("stress", 2), Some(vec!["_xx", "_yy", "_zz", "_xy", "_yz", "_zx"]));
        assert_eq!(columns("principal", 1), Some(vec!["_1", "_2", "_3"]));
        assert_eq!(columns("von_mises", 3), Some(vec![""]));
        assert_eq!(columns("velocity_y", 3), Some(vec![""]));
        assert_eq!(columns("rotation", 2), Some(vec![""]));
        assert_eq!(columns("total_moment", 3), Some(vec!["_x", "_y", "_z"]));
    }
}
