//! The unknowns of a perturbation: free displacements and temperatures, node by node.

use faer::c64;

use super::eliminated::Functional;
use super::waves::WaveNumber;
use crate::contact::mortar::SectorImage;
use crate::contact::{Contact, ContactBoundary, PointOnBoundary};
use crate::discretization::Discretization;
use crate::mesh::{leader, link_of};
use crate::space::Space;
use crate::space::rigid::rigid_of;
use crate::tensor::Point;

/// What is perturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Perturbed {
    pub displacement: bool,
    pub temperature: bool,
}

/// Each component of the displacement and each temperature at a node as a combination of the unknowns.
pub(super) struct PerturbedUnknowns {
    pub size: usize,
    /// By node and component.
    pub u: Vec<Functional>,
    /// By node.
    pub theta: Vec<Functional>,
    /// Temperatures of the foundations with a heat capacity, by contact; empty where θ_F is given, or where waves
    /// around the body leave it as it is.
    foundations: Vec<Functional>,
    /// Pressures of the points that wear, by contact point.
    pressures: Vec<Option<u32>>,
    /// True for unknowns of the displacement.
    pub moves: Vec<bool>,
    /// Node of each unknown; those of foundations, the last ones, have none.
    pub node_of: Vec<u32>,
    dim: usize,
    waves: WaveNumber,
}

impl PerturbedUnknowns {
    /// The unknowns of a discrete problem, node by node, then the pressures of the points that wear, each by its node,
    /// then those of foundations. In a sector nodes on its second
    /// side follow those on the first one with the phase of the waves.
    pub fn new(
        (discrete, contacts): (&Discretization, &[Contact]),
        (what, wearing): (Perturbed, &[Option<u32>]),
        waves: WaveNumber,
    ) -> PerturbedUnknowns {
        let Discretization { mesh, v, q, .. } = discrete;
        let (dim, nodes) = (mesh.dim, mesh.points.len());
        let (mut of_u, mut of_theta) = (vec![None; nodes * dim], vec![None; nodes]);
        let (mut moves, mut node_of) = (Vec::new(), Vec::new());
        for node in 0..nodes {
            for dof in (node * dim..(node + 1) * dim).filter(|dof| what.displacement && v.free[*dof]) {
                of_u[dof] = Some(moves.len() as u32);
                moves.push(true);
            }
            if what.temperature && q.free[node] {
                of_theta[node] = Some(moves.len() as u32);
                moves.push(false);
            }
            node_of.resize(moves.len(), node as u32);
        }
        let mut pressure = |node: &Option<u32>| {
            let node = (*node)?;
            moves.push(false);
            node_of.push(node);
            Some(moves.len() as u32 - 1)
        };
        let pressures = wearing.iter().map(&mut pressure).collect();
        let mut foundation = |contact: &Contact| {
            let warms = what.temperature && contact.foundation_heat.is_some() && waves.waves == 0;
            let at = warms.then_some((moves.len() as u32, c64::new(1.0, 0.0)));
            moves.extend(at.map(|_| false));
            at.into_iter().collect()
        };
        let foundations = contacts.iter().map(&mut foundation).collect();
        let u = (0..nodes as u32).flat_map(|node| (0..dim).map(move |c| (node, c)));
        let u = u.map(|(node, c)| displacement((v, waves), &of_u, node, c)).collect();
        let theta = (0..nodes as u32).map(|node| {
            let phase = link_of(&q.links, node).map_or(c64::new(1.0, 0.0), |link| waves.phase(&link.turn));
            of_theta[leader(&q.links, node) as usize].map(|at| (at, phase))
        });
        PerturbedUnknowns {
            size: moves.len(),
            u,
            theta: theta.map(|at| at.into_iter().collect()).collect(),
            foundations,
            pressures,
            moves,
            node_of,
            dim,
            waves,
        }
    }

    /// Unknowns without a mesh.
    #[cfg(test)]
    pub fn plain(size: usize) -> PerturbedUnknowns {
        let (u, theta, foundations, moves) = (Vec::new(), Vec::new(), Vec::new(), vec![true; size]);
        PerturbedUnknowns {
            size,
            u,
            theta,
            foundations,
            pressures: Vec::new(),
            moves,
            node_of: Vec::new(),
            dim: 1,
            waves: super::waves::Sectors::WHOLE.waves(0),
        }
    }

    /// The waves around the body.
    pub fn waves(&self) -> WaveNumber {
        self.waves
    }

    /// The component of the jump at a contact point in a direction.
    pub fn jump(&self, boundary: &ContactBoundary, point: &PointOnBoundary, direction: &Point) -> Functional {
        let mut sum = Functional::new();
        for (node, value, turn) in point.entries() {
            let phase = self.phase(turn);
            let direction = turn.map_or(*direction, |turn| turn.back(direction));
            let first = boundary.nodes[node] as usize * self.dim;
            for c in 0..self.dim {
                add(&mut sum, phase * (value * direction[c]), &self.u[first + c]);
            }
        }
        merged(sum)
    }

    /// The temperature of the foundation of a contact; empty if it is given.
    pub fn foundation(&self, contact: usize) -> &[(u32, c64)] {
        self.foundations.get(contact).map_or(&[], Vec::as_slice)
    }

    /// The pressure at a contact point that wears.
    pub fn pressure(&self, point: usize) -> Option<Functional> {
        self.pressures.get(point).copied().flatten().map(|at| vec![(at, c64::new(1.0, 0.0))])
    }

    /// The temperatures at a contact point on its own side and on the other one, which is empty at a foundation whose
    /// temperature is given.
    pub fn temperatures(&self, boundary: &ContactBoundary, point: &PointOnBoundary) -> [Functional; 2] {
        let mut sums = [Functional::new(), Functional::new()];
        for (entry, (node, value, turn)) in point.entries().enumerate() {
            let (side, sign) = if entry < point.own { (0, 1.0) } else { (1, -1.0) };
            add(&mut sums[side], self.phase(turn) * (sign * value), &self.theta[boundary.nodes[node] as usize]);
        }
        sums[1].extend(self.foundation(point.contact));
        sums.map(merged)
    }

    /// The phase of a sector against that of a point.
    fn phase(&self, sector: Option<&SectorImage>) -> c64 {
        sector.map_or(c64::new(1.0, 0.0), |image| self.waves.phase(image.turn()))
    }
}

/// The displacement of a node along an axis of space.
fn displacement((space, waves): (&Space, WaveNumber), unknown: &[Option<u32>], node: u32, c: usize) -> Functional {
    let dim = space.components;
    if let Some((body, position)) = rigid_of(&space.rigid, node) {
        let body = &space.rigid[body];
        let motions = body.at(position).enumerate();
        return motions.filter_map(|(j, motion)| Some((unknown[body.dof(j)]?, c64::new(motion[c], 0.0)))).collect();
    }
    let axis: Point = std::array::from_fn(|a| f64::from(u8::from(a == c)));
    let link = link_of(&space.links, node);
    let (leader, axis) = link.map_or((node, axis), |link| (link.to, link.back(&axis)));
    let phase = link.map_or(c64::new(1.0, 0.0), |link| waves.phase(&link.turn));
    let axes = space.directions(leader);
    let along = |a: usize| axis.iter().zip(&axes[a]).map(|(x, y)| x * y).sum::<f64>();
    let of = |a: usize| {
        Some((unknown[leader as usize * dim + a]?, phase * along(a))).filter(|(_, factor)| factor.norm() > 0.0)
    };
    (0..dim).filter_map(of).collect()
}

/// Adds a multiple of a functional.
pub(super) fn add(sum: &mut Functional, factor: c64, of: &[(u32, c64)]) {
    if factor.norm() > 0.0 {
        sum.extend(of.iter().map(|(at, value)| (*at, factor * value)));
    }
}

/// A functional with each unknown once.
pub(super) fn merged(mut sum: Functional) -> Functional {
    sum.sort_by_key(|(at, _)| *at);
    sum.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    sum
}
