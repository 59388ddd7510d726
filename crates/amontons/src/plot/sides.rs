//! The sides of a mesh in colours, with their names, for use in a case.

use std::collections::HashMap;

use super::PlotError;
use super::axes::LEGEND;
use super::body::{self, PlaneMesh};
use super::color::{Color, GRID, INK, LINES, SOFT};
use super::font::{self, HALF, HEADING, LABEL, NUMBER, TITLE};
use super::picture::{Anchor, DENSITY, MARGIN, Picture, Rect, Stroke};
use super::render::{self, ShadedTriangle, View};
use super::sheet::{self, Margins, PanelPlan};
use super::surface::Skin;
use crate::element::{CellType, Drawing};
use crate::mesh::{FacetKey, FacetSet, Mesh, facet_key};
use crate::units::{Measure, Units};

/// Largest width and height of one view.
const LONGEST: f64 = 380.0;
/// Largest number of facets for which all edges are drawn.
const FEW: usize = 4000;
/// Largest number of listed names.
const LISTED: usize = 40;
/// The two opposite views of a body in space: they show every face of a box.
const VIEWS: [(&str, [f64; 2]); 2] = [("from above", [-60.0, 32.0]), ("from the other side, below", [120.0, -32.0])];
/// Colour of a facet in no side.
const BARE: Color = Color::new(0xDE_DE_DE);

/// A side with its colour and its text.
struct ColoredSide<'m> {
    set: &'m FacetSet,
    color: Color,
    text: String,
}

/// The colour of a side by its number: six distinct ones, the next six lighter, and so on.
fn color(number: usize) -> Color {
    let (base, lighter) = (LINES[number % LINES.len()], number / LINES.len() % 3);
    let mixed = |c: u8| (f64::from(c) + (255.0 - f64::from(c)) * 0.3 * lighter as f64).round() as u8;
    Color { red: mixed(base.red), green: mixed(base.green), blue: mixed(base.blue), opacity: 1.0 }
}

/// The sides of a mesh, each in its own colour; where sides overlap the smallest is visible.
///
/// # Errors
/// [`PlotError::Data`] if the mesh is a line or cannot be drawn.
pub fn sides(mesh: &Mesh, name: &str, units: Units) -> Result<Picture, PlotError> {
    let area = |set: &FacetSet| units.write(mesh.measure(set), Measure::Area);
    let mut sides: Vec<(f64, ColoredSide)> = mesh
        .facets
        .iter()
        .enumerate()
        .map(|(i, (name, set))| {
            (mesh.measure(set), ColoredSide { set, color: color(i), text: format!("\"{name}\", {}", area(set)) })
        })
        .collect();
    let names: Vec<(Color, String)> = sides.iter().map(|(_, side)| (side.color, side.text.clone())).collect();
    // The smallest is drawn last.
    sides.sort_by(|a, b| b.0.total_cmp(&a.0));
    let sides: Vec<ColoredSide> = sides.into_iter().map(|(_, side)| side).collect();
    let title = format!("{name}: sides");
    let picture = match mesh.dim {
        2 => in_the_plane(mesh, &title, &sides, units)?,
        3 => in_space(mesh, &title, &sides)?,
        _ => return Err(PlotError::Data("the sides of a line are its ends: there is nothing to draw".to_owned())),
    };
    Ok(with_names(picture, &names))
}

/// The picture with the names of the sides below it, in columns.
fn with_names(mut picture: Picture, names: &[(Color, String)]) -> Picture {
    let shown = names.iter().take(LISTED);
    let widest = shown.clone().map(|(_, text)| font::width(text, NUMBER)).fold(0.0, f64::max) + 34.0;
    let columns = (((picture.width - 2.0 * MARGIN) / widest).floor() as usize).max(1);
    picture.width = picture.width.max(widest + 2.0 * MARGIN);
    let rows = names.len().min(LISTED).div_ceil(columns);
    for (i, (color, text)) in shown.enumerate() {
        let x = MARGIN + (i / rows.max(1)) as f64 * widest;
        let y = picture.height + LEGEND * (i % rows.max(1)) as f64;
        let corner = |dx: f64, dy: f64| [x + dx, y + dy];
        picture.polygon(vec![corner(0.0, 0.0), corner(12.0, 0.0), corner(12.0, 12.0), corner(0.0, 12.0)], *color);
        picture.text([x + 18.0, y + 6.0 + HALF * NUMBER], NUMBER, Anchor::Start, INK, text);
    }
    picture.height += LEGEND * rows as f64 + MARGIN;
    if names.len() > LISTED {
        return picture.noted(&format!("{LISTED} of {} sides are named here", names.len()));
    }
    picture
}

fn in_the_plane(mesh: &Mesh, title: &str, sides: &[ColoredSide], units: Units) -> Result<Picture, PlotError> {
    let body = PlaneMesh::of_mesh(mesh)?;
    let plan = PanelPlan {
        title: String::new(),
        note: String::new(),
        window: sheet::widened(body.window(), 0.03),
        labels: if mesh.axisymmetric { ["r", "z"] } else { ["x", "y"] },
        mirrored: false,
    };
    let (mut picture, frames) = sheet::lay_out(title, &[plan], Margins::default(), units);
    let Some(frame) = frames.first() else { return Ok(picture) };
    let at = |node: u32| frame.at(&body.points[node as usize]);
    let lines = |edges: &[[u32; 2]]| edges.iter().map(|edge| edge.map(at)).collect::<Vec<_>>();
    if body.edges.len() <= FEW {
        picture.lines(&lines(&body.edges), Stroke::new(GRID, 0.8));
    }
    picture.lines(&lines(&body.boundary), Stroke::new(SOFT, 0.8));
    for side in sides {
        let along = |nodes: &[u32]| -> Vec<[f64; 2]> {
            // Ends first: the middle node of a quadratic facet is last.
            let order: &[usize] = if nodes.len() == 3 { &[0, 2, 1] } else { &[0, 1] };
            order.iter().filter_map(|&i| nodes.get(i)).map(|&node| at(node)).collect()
        };
        let pieces: Vec<Vec<[f64; 2]>> = side.set.facets().map(|(_, nodes)| along(nodes)).collect();
        picture.lines(&pieces, Stroke::new(side.color, 3.0));
    }
    Ok(picture)
}

/// The surface in triangles, each with the number of the visible side.
struct SideTriangles {
    triangles: Vec<[u32; 3]>,
    /// Number of the side, from 1; 0 for none.
    which: Vec<usize>,
    lines: Vec<[u32; 2]>,
}

impl SideTriangles {
    fn new(mesh: &Mesh, skin: &Skin, sides: &[ColoredSide]) -> SideTriangles {
        let mut of_facet: HashMap<FacetKey, usize> = HashMap::new();
        for (number, side) in sides.iter().enumerate() {
            of_facet.extend(
                side.set.facets().map(|(element, nodes)| (facet_key(element, nodes.iter().copied()), number + 1)),
            );
        }
        let boundary = mesh.boundary();
        let mut surface = SideTriangles { triangles: Vec::new(), which: Vec::new(), lines: Vec::new() };
        let mut edges: HashMap<[u32; 2], Option<usize>> = HashMap::new();
        for (element, nodes) in boundary.facets() {
            let number = of_facet.get(&facet_key(element, nodes.iter().copied())).copied().unwrap_or(0);
            let Some(Drawing { outline, triangles: parts }) = CellType::drawing(nodes.len()) else { continue };
            for part in parts {
                surface.triangles.push(part.map(|i| nodes[i]));
                surface.which.push(number);
            }
            for (i, &a) in outline.iter().enumerate() {
                let b = outline[(i + 1) % outline.len()];
                let key = [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
                // An edge between two facets of one side is no border.
                let is_inside = edges.get(&key) == Some(&Some(number));
                edges.insert(key, if is_inside { None } else { Some(number) });
            }
        }
        surface.lines = if boundary.len() <= FEW {
            skin.edges.iter().map(|edge| edge.nodes).collect()
        } else {
            let mut borders: Vec<_> = edges.into_iter().filter_map(|(key, border)| border.map(|_| key)).collect();
            borders.sort_unstable();
            borders
        };
        surface
    }
}

fn in_space(mesh: &Mesh, title: &str, sides: &[ColoredSide]) -> Result<Picture, PlotError> {
    let skin = Skin::of_mesh(mesh)?;
    let surface = SideTriangles::new(mesh, &skin, sides);
    let seen: Vec<(&str, Vec<[f64; 3]>)> = VIEWS
        .iter()
        .map(|(name, [azimuth, elevation])| {
            let view = View::new(*azimuth, *elevation);
            (*name, skin.points.iter().map(|p| view.place(*p)).collect())
        })
        .collect();
    let windows: Vec<[[f64; 2]; 2]> = seen
        .iter()
        .map(|(_, points)| {
            let plane: Vec<[f64; 2]> =
                surface.triangles.iter().flatten().map(|&n| points[n as usize]).map(|p| [p[0], p[1]]).collect();
            sheet::widened(body::window(&plane), 0.01)
        })
        .collect();
    let span = |d: usize| windows.iter().map(|w| w[d][1] - w[d][0]).fold(f64::MIN_POSITIVE, f64::max);
    let scale = LONGEST / span(0).max(span(1));
    let size = |w: &[[f64; 2]; 2]| w.map(|[low, high]| ((high - low) * scale).ceil().max(1.0));
    let widest = windows.iter().map(|w| size(w)[0]).fold(160.0, f64::max);
    let tallest = windows.iter().map(|w| size(w)[1]).fold(0.0, f64::max);
    let top = (MARGIN + TITLE + 14.0 + HEADING + LABEL).ceil();
    let width = (2.0 * widest + 3.0 * MARGIN).max(font::width(title, TITLE) + 2.0 * MARGIN);
    let mut picture = Picture::new(width, top + tallest + 2.0 * MARGIN, title);
    picture.text([0.5 * width, MARGIN + 0.8 * TITLE], TITLE, Anchor::Middle, INK, title);
    let colors: Vec<[u8; 3]> = std::iter::once(BARE)
        .chain(sides.iter().map(|side| side.color))
        .map(|color| [color.red, color.green, color.blue])
        .collect();
    for (i, ((name, points), window)) in seen.iter().zip(&windows).enumerate() {
        let [w, h] = size(window);
        let x = MARGIN + i as f64 * (widest + MARGIN) + (0.5 * (widest - w)).floor();
        let rect = Rect { x, y: top + (tallest - h), width: w, height: h };
        picture.text([x + 0.5 * w, top - LABEL], HEADING, Anchor::Middle, INK, *name);
        let scene = ShadedTriangle {
            points,
            triangles: &surface.triangles,
            values: &|t| [surface.which.get(t).map_or(0.0, |&which| which as f64); 3],
            color: &|value| colors.get(value.round() as usize).copied().unwrap_or_default(),
            lines: &surface.lines,
            ink: SOFT,
        };
        picture.image(rect, render::image(&scene, *window, (w * DENSITY) as u32, (h * DENSITY) as u32));
    }
    Ok(picture)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Elements;

    /// All six sides of a box are visible: the colour of each is in one of the views, and no other colour.
    #[test]
    fn every_side_of_a_box_is_seen() -> Result<(), Box<dyn std::error::Error>> {
        let mesh = Mesh::box_([1.0, 2.0, 3.0], [2, 3, 4], Elements::Q1)?;
        let skin = Skin::of_mesh(&mesh)?;
        let sides: Vec<ColoredSide> = mesh
            .facets
            .values()
            .enumerate()
            .map(|(i, set)| ColoredSide { set, color: color(i), text: String::new() })
            .collect();
        let surface = SideTriangles::new(&mesh, &skin, &sides);
        assert_eq!(surface.which.iter().filter(|&&which| which == 0).count(), 0);
        let mut found = std::collections::BTreeSet::new();
        for (_, [azimuth, elevation]) in VIEWS {
            let view = View::new(azimuth, elevation);
            for (triangle, which) in surface.triangles.iter().zip(&surface.which) {
                let [a, b, c] = triangle.map(|n| skin.points[n as usize]);
                let normal = crate::plot::surface::across([a, b, c]);
                if crate::plot::surface::dot(normal, view.eye) > 0.0 {
                    found.insert(*which);
                }
            }
        }
        assert_eq!(found.len(), 6);
        let picture = super::sides(&mesh, "box", Units::SPACE)?;
        let text = picture.svg();
        for name in ["back", "bottom", "front", "left", "right", "top"] {
            assert!(text.contains(&format!("&quot;{name}&quot;")) || text.contains(&format!("\"{name}\"")), "{name}");
        }
        Ok(())
    }

    /// A side within another is visible, whichever comes first by name.
    #[test]
    fn the_smaller_of_two_sides_is_seen() -> Result<(), Box<dyn std::error::Error>> {
        for names in [["a", "b"], ["b", "a"]] {
            let mut mesh = Mesh::box_([1.0; 3], [2, 2, 2], Elements::Q1)?;
            let [part, whole] = [mesh.facets["top"].clone(), mesh.boundary()];
            mesh.facets.clear();
            mesh.facets.insert(names[0].to_owned(), part);
            mesh.facets.insert(names[1].to_owned(), whole);
            let mut sides: Vec<ColoredSide> =
                mesh.facets.values().map(|set| ColoredSide { set, color: INK, text: String::new() }).collect();
            sides.sort_by_key(|side| std::cmp::Reverse(side.set.len()));
            let surface = SideTriangles::new(&mesh, &Skin::of_mesh(&mesh)?, &sides);
            let smaller = surface.which.iter().filter(|&&which| which == 2).count();
            assert_eq!((smaller, surface.which.len()), (8, 48));
        }
        Ok(())
    }
}
