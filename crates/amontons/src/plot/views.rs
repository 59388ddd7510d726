//! Directions from which bodies in space are seen: towards their contact. The bodies of a pair are opened like a book,
//! each in its own view.

use super::render::View;
use super::run::DrawnRun;
use super::surface::{across, dot, norm};
use crate::contact::Contact;
use crate::element::CellType;
use crate::mesh::defects::components;
use crate::problem::Problem;

/// Directions of view of a body without contact.
const AROUND: [(&str, [f64; 2]); 2] = [("from above", [-60.0, 32.0]), ("from below", [-60.0, -32.0])];
/// Least angle between a view and the plane of its contact, in degrees.
const LEAST: f64 = 35.0;
/// Least ratio of the magnitude of the vector area to the area for a side with a direction; a bore has none.
const ONE_SIDED: f64 = 0.35;
/// Least cosine between the normals of contacts in the same view.
const SAME: f64 = 0.5;
/// Largest number of views of one body.
const MOST: usize = 3;

/// A view of the whole body, or of one body of several.
#[derive(Clone, Debug)]
pub(super) struct Look {
    pub name: String,
    pub view: View,
    /// True per node that belongs to the body shown, or `None` if all do.
    pub nodes: Option<Vec<bool>>,
    /// The mean outward normal of the contact shown, if any.
    pub normal: Option<[f64; 3]>,
}

/// One body with the outward directions of its contacts.
struct Opened {
    name: String,
    nodes: Vec<bool>,
    directions: Vec<[f64; 3]>,
}

/// Name of a view: `from above`, by the position of the eye.
fn name_of(view: &View) -> &'static str {
    if view.eye[2] < 0.0 { AROUND[1].0 } else { AROUND[0].0 }
}

/// The view of a contact with this outward normal: the nearer one of the two standard views, rotated towards the normal
/// until the eye is high enough above the plane of the contact.
pub(super) fn onto(normal: [f64; 3]) -> View {
    let normal = normal.map(|c| c / norm(normal));
    let [above, below] = AROUND.map(|(_, [azimuth, elevation])| View::new(azimuth, elevation));
    // A vertical contact is equally near to both, up to rounding: it is seen from above.
    let nearer = if dot(below.eye, normal) > dot(above.eye, normal) + 1e-6 { below } else { above };
    let height = dot(nearer.eye, normal);
    let (sine, cosine) = LEAST.to_radians().sin_cos();
    if height >= sine {
        return nearer;
    }
    let flat = [0, 1, 2].map(|d| nearer.eye[d] - height * normal[d]);
    let size = norm(flat);
    View::of_eye([0, 1, 2].map(|d| sine * normal[d] + cosine * flat[d] / size))
}

/// Outward area vectors of one side of a contact, with the region of the body and the area.
fn areas(problem: &Problem, side: &str) -> Vec<(u32, [f64; 3], f64)> {
    let Some(set) = problem.mesh.facets.get(side) else { return Vec::new() };
    let parts = set.facets().flat_map(|(_, facet)| {
        let pieces = CellType::drawing(facet.len()).map_or(&[][..], |drawing| drawing.triangles);
        pieces.iter().map(move |part| {
            let vector = across(part.map(|i| problem.mesh.points[facet[i] as usize]));
            (facet[0], vector, norm(vector))
        })
    });
    parts.collect()
}

/// The directions of one-sided areas; directions within 60° of each other count as one.
fn directions<'a>(sides: impl Iterator<Item = &'a Vec<([f64; 3], f64)>>) -> Vec<[f64; 3]> {
    let mut found: Vec<[f64; 3]> = Vec::new();
    for side in sides {
        let sum = side.iter().fold([0.0; 3], |sum, (v, _)| [0, 1, 2].map(|d| sum[d] + v[d]));
        let area: f64 = side.iter().map(|(_, area)| area).sum();
        if norm(sum) <= ONE_SIDED * area || area <= 0.0 {
            continue;
        }
        match found.iter_mut().find(|other| dot(**other, sum) > SAME * norm(**other) * norm(sum)) {
            Some(other) => *other = [0, 1, 2].map(|d| other[d] + sum[d]),
            None => found.push(sum),
        }
    }
    found
}

/// The bodies of a problem that bear contact.
fn opened(problem: &Problem) -> Vec<Opened> {
    let mesh = &problem.mesh;
    let mut region_of = vec![0; mesh.points.len()];
    for block in &mesh.blocks {
        block.cells().flatten().for_each(|&node| region_of[node as usize] = block.region);
    }
    let sides: Vec<Vec<(u32, [f64; 3], f64)>> =
        problem.contacts.iter().flat_map(Contact::sides).map(|side| areas(problem, side)).collect();
    let of_body = |nodes: &[bool]| -> Vec<Vec<([f64; 3], f64)>> {
        let own = |side: &Vec<(u32, [f64; 3], f64)>| {
            side.iter().filter(|(node, ..)| nodes[*node as usize]).map(|(_, v, area)| (*v, *area)).collect()
        };
        sides.iter().map(own).filter(|side: &Vec<_>| !side.is_empty()).collect()
    };
    let bodies = components(mesh).into_iter().filter_map(|body| {
        let mut nodes = vec![false; mesh.points.len()];
        body.nodes.iter().for_each(|&node| nodes[node as usize] = true);
        let areas = of_body(&nodes);
        let region = body.nodes.first().and_then(|&node| mesh.regions.get(region_of[node as usize]));
        (!areas.is_empty()).then(|| Opened {
            name: region.cloned().unwrap_or_default(),
            nodes,
            directions: directions(areas.iter()),
        })
    });
    bodies.collect()
}

/// Both views of the whole body.
fn around() -> Vec<Look> {
    let look = |(name, [azimuth, elevation]): (&str, [f64; 2])| Look {
        name: name.to_owned(),
        view: View::new(azimuth, elevation),
        nodes: None,
        normal: None,
    };
    AROUND.map(look).to_vec()
}

/// The views of a run: those of its contact, for pairs each body alone, and with `all` also the whole and the reverse.
/// Without a contact direction or the problem, those from above and from below, or the first.
pub(super) fn looks(run: &DrawnRun, all: bool) -> Vec<Look> {
    let usual = || around().into_iter().take(if all { 2 } else { 1 }).collect::<Vec<_>>();
    let Some(problem) = &run.problem else { return usual() };
    if problem.contacts.iter().any(|contact| contact.pair.is_some()) {
        let whole = around().into_iter().take(usize::from(all));
        return whole.chain(opened(problem).into_iter().flat_map(|body| of_pair(body, all))).collect();
    }
    let directions: Vec<[f64; 3]> = opened(problem).into_iter().flat_map(|body| body.directions).collect();
    let look = |normal: &[f64; 3]| {
        let view = onto(*normal);
        Look { name: format!("{}, on the contact", name_of(&view)), view, nodes: None, normal: Some(*normal) }
    };
    let mut found: Vec<Look> = directions.iter().take(if all { MOST } else { 1 }).map(look).collect();
    if let ([first], true) = (&found[..], all) {
        let view = View::of_eye(first.view.eye.map(|c| 0.0 - c));
        found.push(Look { name: name_of(&view).to_owned(), view, nodes: None, normal: None });
    }
    if found.is_empty() { usual() } else { found }
}

/// The views of one body of several.
fn of_pair(body: Opened, all: bool) -> Vec<Look> {
    let Opened { name, nodes, directions } = body;
    let look = |normal: &[f64; 3]| {
        let view = onto(*normal);
        let name = format!("\"{name}\" {}, on its contact", name_of(&view));
        Look { name, view, nodes: Some(nodes.clone()), normal: Some(*normal) }
    };
    let found: Vec<Look> = directions.iter().take(if all { MOST } else { 1 }).map(look).collect();
    if found.is_empty() {
        let alone =
            |usual: Look| Look { name: format!("\"{name}\" {}", usual.name), nodes: Some(nodes.clone()), ..usual };
        return around().into_iter().take(1).map(alone).collect();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions spread over the sphere, and those of the axes.
    fn normals() -> Vec<[f64; 3]> {
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let spread = (0..500).map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 500.0;
            let (sine, cosine) = (golden * f64::from(i)).sin_cos();
            [(1.0 - z * z).sqrt() * cosine, (1.0 - z * z).sqrt() * sine, z]
        });
        let axes = (0..6).map(|i| [0, 1, 2].map(|d| if d == i / 2 { 1.0 - 2.0 * f64::from(i as u8 % 2) } else { 0.0 }));
        spread.chain(axes).collect()
    }

    /// The eye is at least 32° above the contact, at the nearer standard view if possible, and z points upwards.
    #[test]
    fn a_contact_is_in_sight_whatever_its_normal() {
        for normal in normals() {
            let View { right, up, eye } = onto(normal.map(|c| 7.0 * c));
            let height = dot(eye, normal).asin().to_degrees();
            assert!(height > 34.9, "{height}° above the contact with normal {normal:?}");
            assert!(right[2].abs() < 1e-12 && up[2] >= -1e-12, "{normal:?}: {right:?}, {up:?}");
            let [a, b, c] = [dot(right, up), dot(up, eye), norm(eye) - 1.0];
            assert!(a.abs() + b.abs() + c.abs() < 1e-12, "{normal:?}");
        }
        let front = View::new(-60.0, 32.0);
        assert_eq!(onto([0.0, -1.0, 0.0]), front);
    }
}
