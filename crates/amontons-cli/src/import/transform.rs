//! `*TRANSFORM`: axes in which conditions and forces at nodes are given.

use std::collections::BTreeSet;

use super::deck::{Card, DeckFault, DeckPlace};
use super::mesh::{DeckMesh, DeckNodeId};
use super::vector::{across, cross, unit};

/// Axes of some nodes.
#[derive(Clone, Debug)]
pub struct NodeAxes {
    nodes: BTreeSet<DeckNodeId>,
    kind: AxesKind,
}

#[derive(Clone, Copy, Debug)]
enum AxesKind {
    /// The axes, row by row.
    Rectangular([[f64; 3]; 3]),
    /// A point and the direction of the axis: radial, tangential and axial.
    Cylindrical([f64; 3], [f64; 3]),
}

/// All transforms of a deck.
#[derive(Debug, Default)]
pub struct Transforms(Vec<NodeAxes>);

/// Axes from a point on the first axis and a point in the plane of the first two.
pub fn axes(a: [f64; 3], b: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    let first = unit(a)?;
    let second = unit(across(&b, &first))?;
    Some([first, second, cross(&first, &second)])
}

impl Transforms {
    /// Reads the keyword.
    pub fn take(&mut self, card: &Card, mesh: &DeckMesh) -> Result<(), DeckFault> {
        let nodes = mesh.nodes(&card.place, card.required("NSET")?)?;
        let expected = "two points, six numbers";
        let line = card.first(expected)?;
        let numbers = line.numbers()?;
        let wrong =
            |expected: &str| DeckFault::new(&line.place, format!("\"{}\"", line.whole().escape_debug()), expected);
        let (a, b) = match numbers[..] {
            [a, b, c, d, e, f, ..] => ([a, b, c], [d, e, f]),
            _ => return Err(wrong(expected)),
        };
        let kind = match card.word("TYPE").as_deref() {
            None | Some("R") => AxesKind::Rectangular(
                axes(a, b).ok_or_else(|| wrong("two points that are not on one line with the origin"))?,
            ),
            Some("C") => {
                let along = unit(std::array::from_fn(|d| b[d] - a[d])).ok_or_else(|| wrong("two different points"))?;
                AxesKind::Cylindrical(a, along)
            }
            Some(other) => {
                let found = format!("*TRANSFORM, TYPE={}", other.escape_debug());
                return Err(DeckFault::new(&card.place, found, "TYPE=R or TYPE=C"));
            }
        };
        self.0.push(NodeAxes { nodes, kind });
        Ok(())
    }

    /// The common axes of nodes, or `None` if they have none of their own; a fault if they differ.
    pub fn of(&self, nodes: &BTreeSet<DeckNodeId>, place: &DeckPlace) -> Result<Option<NodeAxes>, DeckFault> {
        let mut own = self.0.iter().rev().filter(|local| local.nodes.intersection(nodes).next().is_some());
        let Some(local) = own.next() else { return Ok(None) };
        if !nodes.is_subset(&local.nodes) {
            let found = "nodes of which some have a *TRANSFORM and some have none or another one";
            return Err(DeckFault::new(place, found, "a set of nodes per *TRANSFORM"));
        }
        Ok(Some(local.clone()))
    }
}

impl NodeAxes {
    /// The axes at a point, row by row.
    pub fn axes(&self, x: &[f64; 3]) -> [[f64; 3]; 3] {
        match &self.kind {
            AxesKind::Rectangular(axes) => *axes,
            AxesKind::Cylindrical(point, along) => {
                let from: [f64; 3] = std::array::from_fn(|d| x[d] - point[d]);
                let radial = unit(across(&from, along)).unwrap_or_default();
                [radial, cross(along, &radial), *along]
            }
        }
    }

    /// The axis of the case parallel to a local one, with its sign, if any.
    pub fn along(&self, axis: usize) -> Option<(usize, f64)> {
        let own = match &self.kind {
            AxesKind::Rectangular(axes) => *axes.get(axis)?,
            AxesKind::Cylindrical(_, along) if axis == 2 => *along,
            AxesKind::Cylindrical(..) => return None,
        };
        (0..3).find(|&d| own[d].abs() > 1.0 - 1e-9).map(|d| (d, own[d].signum()))
    }

    /// True if a local axis is radial: no plane side is normal to it.
    pub fn is_radial(&self, axis: usize) -> bool {
        axis == 0 && matches!(self.kind, AxesKind::Cylindrical(..))
    }
}
