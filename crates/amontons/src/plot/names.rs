//! The names of the bodies of an assembly.

use super::axes;
use super::body::PlaneMesh;
use super::color::{INK, WHITE};
use super::font::{self, HALF, NUMBER};
use super::picture::{Anchor, Picture, Rect};
use super::run::DrawnRun;
use super::sheet::SheetPanel;
use crate::tensor;

/// Margin around a name.
const MARGIN: f64 = 3.0;

/// Writes the name of each region of an assembly into the region at its deformed position, if there is room. `regions`
/// holds the number of the region of each cell. Without pairs there is one body, which needs no name.
pub(super) fn draw(picture: &mut Picture, frame: &SheetPanel, run: &DrawnRun, moved: &PlaneMesh, regions: &[f64]) {
    let Some(problem) = &run.problem else { return };
    if !problem.contacts.iter().any(|contact| contact.pair.is_some()) || problem.mesh.regions.len() < 2 {
        return;
    }
    for (number, name) in problem.mesh.regions.iter().enumerate() {
        let is_of = |cell: &u32| regions.get(*cell as usize).is_some_and(|region| *region as usize == number);
        let of_region = moved.triangles.iter().zip(&moved.owners).filter(|(_, cell)| is_of(cell));
        let triangles: Vec<[[f64; 2]; 3]> =
            of_region.map(|(nodes, _)| nodes.map(|node| frame.at(&moved.points[node as usize]))).collect();
        let width = font::width(name, NUMBER);
        let Some([x, y]) = place(&triangles, [width + 2.0 * MARGIN, NUMBER + 2.0 * MARGIN]) else { continue };
        let [w, h] = [width + 2.0 * MARGIN, NUMBER + 2.0 * MARGIN];
        let behind = Rect { x: x - 0.5 * w, y: y - 0.5 * h, width: w, height: h };
        picture.polygon(behind.corners(), WHITE.with_opacity(0.7));
        picture.text([x, y + HALF * NUMBER], NUMBER, Anchor::Middle, INK, name.clone());
    }
}

/// The centre of a text with this width and height in a region: the centroid, or the middle of the nearest triangle if
/// the centroid is outside, as in a ring. `None` if the text is wider or higher than the region.
fn place(triangles: &[[[f64; 2]; 3]], room: [f64; 2]) -> Option<[f64; 2]> {
    let corners = || triangles.iter().flatten();
    for d in 0..2 {
        let [low, high] = axes::range(corners().map(|p| p[d]))?;
        if high - low < room[d] {
            return None;
        }
    }
    let middle = |[a, b, c]: &[[f64; 2]; 3]| [0, 1].map(|d| (a[d] + b[d] + c[d]) / 3.0);
    let area = |[a, b, c]: &[[f64; 2]; 3]| ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
    let total: f64 = triangles.iter().map(area).sum();
    let centroid = [0, 1].map(|d| triangles.iter().map(|t| area(t) * middle(t)[d]).sum::<f64>() / total);
    // A point is inside a triangle if it splits it into three of the same total area.
    let split = |t: &[[f64; 2]; 3]| (0..3).map(|i| area(&[t[i], t[(i + 1) % 3], centroid])).sum::<f64>();
    if triangles.iter().any(|t| split(t) <= area(t) + 1e-9 * total) {
        return Some(centroid);
    }
    let away = |p: &[f64; 2]| tensor::length(&[p[0] - centroid[0], p[1] - centroid[1], 0.0]);
    triangles.iter().map(middle).min_by(|a, b| away(a).total_cmp(&away(b)))
}
