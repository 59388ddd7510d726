//! Quantities of a side as a whole: reactions, total force, and rotation.

use super::Snapshot;
use super::borne::Borne;
use super::probe_place::{Probe, ProbeError, ProbePlace, Take};
use super::quantity::{Base, Quantity};
use super::reaction::Held;
use super::turned::Turned;
use crate::mesh::Mesh;
use crate::problem::{Problem, ProblemData};
use crate::tensor::Point;

/// A quantity of a side, an edge, points or a region as a whole.
#[derive(Debug)]
pub(super) enum WholeQuantity {
    Held(Held),
    Borne(Box<Borne>),
    Turned(Turned),
}

/// The error for a name that the mesh does not have.
fn unknown(mesh: &Mesh) -> ProbeError {
    ProbeError::Side(mesh.facets.keys().chain(mesh.edges.keys()).cloned().collect())
}

/// The reference point of the moment of a probe.
fn about(problem: &ProblemData, probe: &Probe) -> Point {
    let mesh = &problem.mesh;
    let of_side = |on: &String| {
        let part = problem.rigid.iter().find(|part| part.on == *on);
        part.and_then(|part| part.at).or_else(|| mesh.centre(mesh.named(on)?))
    };
    let of_place = || match &probe.place {
        ProbePlace::On(on, _) => of_side(on),
        ProbePlace::At(point) | ProbePlace::AtContact(point, _) => Some(*point),
        ProbePlace::Region(..) | ProbePlace::Contact(..) => None,
    };
    probe.about.or_else(of_place).unwrap_or_default()
}

/// A quantity of a side as a whole in each phase, whose conditions may differ; one for all phases if they do not.
#[derive(Debug)]
pub(super) struct WholeInPhases(Vec<WholeQuantity>);

impl WholeInPhases {
    /// The quantity read by a probe. A reaction must be one in some phase, and is zero in the others.
    ///
    /// # Errors
    /// The reason why it cannot be read.
    pub(super) fn new(problem: &Problem, probe: &Probe) -> Result<WholeInPhases, ProbeError> {
        let phases = if problem.changes_conditions_of_run() { problem.timeline.phases().len() } else { 1 };
        let mut all = Vec::with_capacity(phases);
        let mut free = None;
        for phase in 0..phases {
            match WholeQuantity::new(&problem.in_phase(phase), probe) {
                Err(error @ ProbeError::Free(..)) => {
                    free = Some(error);
                    all.push(WholeQuantity::Held(Held::default()));
                }
                made => all.push(made?),
            }
        }
        let is_held = |of: &WholeQuantity| !matches!(of, WholeQuantity::Held(held) if held.is_empty());
        match free {
            Some(error) if !all.iter().any(is_held) => Err(error),
            _ => Ok(WholeInPhases(all)),
        }
    }

    /// The vector, or a scalar in its place, in the phase of a step.
    pub(super) fn value(&self, now: &Snapshot) -> Point {
        let phase = now.problem.timeline.phase_at(now.state.t);
        let own = self.0.get(phase).or_else(|| self.0.first());
        own.map_or([f64::NAN; 3], |own| own.value(now))
    }
}

impl WholeQuantity {
    /// The quantity read by a probe.
    ///
    /// # Errors
    /// The reason why it cannot be read.
    pub(super) fn new(problem: &ProblemData, probe: &Probe) -> Result<WholeQuantity, ProbeError> {
        let (mesh, quantity, name) = (&problem.mesh, probe.quantity, probe.quantity.name());
        if quantity.is_axial() && (mesh.axisymmetric || mesh.dim == 1) {
            let body = if mesh.axisymmetric { "a body of revolution" } else { "a body on a line" };
            return Err(ProbeError::Still(name, body));
        }
        let about = quantity.is_moment().then(|| about(problem, probe));
        match (quantity.base, &probe.place) {
            (Base::Reaction | Base::ReactionHeat | Base::ReactionMoment, _) => held(problem, probe, about),
            (Base::Rotation, _) => turned(mesh, probe)?.map(WholeQuantity::Turned).ok_or(ProbeError::Alone(name)),
            (_, ProbePlace::On(on, Take::Integral)) => {
                let set = mesh.named(on).ok_or_else(|| unknown(mesh))?;
                Ok(WholeQuantity::Borne(Box::new(Borne::new(problem, set, about))))
            }
            (_, ProbePlace::On(..)) => Err(ProbeError::Resultant(name)),
            _ => Err(ProbeError::Whole(name)),
        }
    }

    /// The vector, or a scalar in its place.
    pub(super) fn value(&self, now: &Snapshot) -> Point {
        match self {
            WholeQuantity::Held(held) => held.resultant(now),
            WholeQuantity::Borne(borne) => borne.value(now),
            WholeQuantity::Turned(turned) => turned.value(now),
        }
    }
}

/// The reactions at the nodes of a side, an edge or points.
fn held(problem: &ProblemData, probe: &Probe, about: Option<Point>) -> Result<WholeQuantity, ProbeError> {
    let (mesh, Quantity { base, .. }, name) = (&problem.mesh, probe.quantity, probe.quantity.name());
    let prescribed = if base == Base::ReactionHeat { "temperature" } else { "displacement" };
    let nodes = match &probe.place {
        ProbePlace::At(point) | ProbePlace::AtContact(point, _) => mesh.nodes_at(point),
        ProbePlace::On(on, Take::Integral) => mesh.named(on).ok_or_else(|| unknown(mesh))?.node_list(),
        ProbePlace::On(..) => return Err(ProbeError::Resultant(name)),
        ProbePlace::Region(..) | ProbePlace::Contact(..) => Vec::new(),
    };
    Held::new(problem, base, &nodes, about).map(WholeQuantity::Held).ok_or(ProbeError::Free(name, prescribed))
}

/// The rotation of a side or a region, or `None` for a single point.
fn turned(mesh: &Mesh, probe: &Probe) -> Result<Option<Turned>, ProbeError> {
    match &probe.place {
        ProbePlace::On(on, Take::Mean) => Ok(Turned::of_set(mesh, mesh.named(on).ok_or_else(|| unknown(mesh))?)),
        ProbePlace::Region(region, Take::Mean) => {
            let number = mesh.regions.iter().position(|known| known == region);
            Ok(Turned::of_region(mesh, number.ok_or_else(|| ProbeError::Region(mesh.regions.clone()))?))
        }
        ProbePlace::On(..) | ProbePlace::Region(..) => Err(ProbeError::OnlyMean(probe.quantity.name())),
        ProbePlace::At(_) | ProbePlace::AtContact(..) | ProbePlace::Contact(..) => Ok(None),
    }
}
