//! Fields on a body as pixels and level lines.

use super::body::PlaneMesh;
use super::field::ColorBar;
use super::picture::{Image, Picture, Rect};
use super::sheet::SheetPanel;

/// Draws a field on a body within a window of a panel, with the colours of a bar.
pub(super) fn draw(
    picture: &mut Picture,
    frame: &SheetPanel,
    body: &PlaneMesh,
    values: &[[f64; 3]],
    bar: &ColorBar,
    window: [[f64; 2]; 2],
) {
    let [x, y] = window;
    let (a, b) = (frame.at(&[x[0], y[1]]), frame.at(&[x[1], y[0]]));
    let place = Rect { x: a[0].min(b[0]), y: a[1], width: (b[0] - a[0]).abs(), height: b[1] - a[1] };
    let mut image = image(body, values, |value| bar.color(value), window, place.pixels());
    if b[0] < a[0] {
        image.mirror();
    }
    picture.image(place, image);
}

/// Colours the triangles of a body by linear interpolation of the values at their corners. The image covers a window
/// and is transparent outside the body.
///
/// A pixel takes the colour of the value at its centre.
fn image(
    body: &PlaneMesh,
    values: &[[f64; 3]],
    color: impl Fn(f64) -> [u8; 3],
    [wx, wy]: [[f64; 2]; 2],
    [width, height]: [u32; 2],
) -> Image {
    let mut rgba = vec![0; 4 * width as usize * height as usize];
    let scale = [f64::from(width) / (wx[1] - wx[0]), f64::from(height) / (wy[1] - wy[0])];
    // Pixel coordinates: the centre of pixel (i, j) is at (i, j), j downwards.
    let place = |n: u32| {
        let p = body.points[n as usize];
        [(p[0] - wx[0]) * scale[0] - 0.5, (wy[1] - p[1]) * scale[1] - 0.5]
    };
    for (nodes, &[va, vb, vc]) in body.triangles.iter().zip(values) {
        let [a, b, c] = nodes.map(place);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 {
            continue;
        }
        let pixels = |lo: f64, hi: f64, end: u32| {
            (lo.ceil().max(0.0) as u32)..((hi.floor() + 1.0).clamp(0.0, f64::from(end)) as u32)
        };
        let low = |d: usize| a[d].min(b[d]).min(c[d]) - 1e-6;
        let high = |d: usize| a[d].max(b[d]).max(c[d]) + 1e-6;
        for j in pixels(low(1), high(1), height) {
            for i in pixels(low(0), high(0), width) {
                let (x, y) = (f64::from(i), f64::from(j));
                let sb = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
                let sc = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
                let sa = 1.0 - sb - sc;
                // A pixel on an edge belongs to both triangles: no gaps between them.
                if sa.min(sb).min(sc) < -1e-6 {
                    continue;
                }
                let [red, green, blue] = color(sa * va + sb * vb + sc * vc);
                let at = 4 * (j as usize * width as usize + i as usize);
                rgba[at..at + 4].copy_from_slice(&[red, green, blue, 255]);
            }
        }
    }
    Image { width, height, rgba }
}

/// Pieces of the line on which a nodal field has a value, at most one per triangle.
pub(super) fn level_line(body: &PlaneMesh, values: &[f64], level: f64) -> Vec<[[f64; 2]; 2]> {
    let mut pieces = Vec::new();
    for nodes in &body.triangles {
        let mut ends = Vec::with_capacity(2);
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (m, n) = (nodes[i] as usize, nodes[j] as usize);
            let (v, w) = (values[m] - level, values[n] - level);
            // A corner at the level counts as above, so that a line that leaves a triangle enters the next at the same
            // point.
            if (v < 0.0) != (w < 0.0) {
                let s = v / (v - w);
                let (p, q) = (body.points[m], body.points[n]);
                ends.push([p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])]);
            }
        }
        if let [a, b] = ends[..] {
            pieces.push([a, b]);
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::super::color::ColorMap;
    use super::*;
    use crate::mesh::{Diagonal, Mesh};

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    #[test]
    fn a_linear_nodal_field_has_the_colours_of_its_values() -> Outcome {
        let body = PlaneMesh::of_mesh(&Mesh::rectangle([2.0, 1.0], [6, 3], Diagonal::Crossed)?)?;
        let f = |x: f64, y: f64| 3.0 * x - y;
        let values: Vec<[f64; 3]> = body
            .triangles
            .iter()
            .map(|t| t.map(|n| f(body.points[n as usize][0], body.points[n as usize][1])))
            .collect();
        let image = image(&body, &values, |v| ColorMap::Viridis.of([-1.0, 6.0], v), body.window(), [80, 40]);
        for i in 0..80 {
            for j in 0..40 {
                let value = f((f64::from(i) + 0.5) / 40.0, 1.0 - (f64::from(j) + 0.5) / 40.0);
                let expected = ColorMap::Viridis.at((value + 1.0) / 7.0);
                let found = image.pixel(i, j);
                assert_eq!(found[3], 255, "pixel {i}, {j} is not covered");
                assert!(
                    (0..3).all(|c| found[c].abs_diff(expected[c]) <= 1),
                    "pixel {i}, {j}: {found:?}, expected {expected:?}"
                );
            }
        }
        Ok(())
    }

    #[test]
    fn a_field_of_one_value_is_flat_and_outside_is_transparent() -> Outcome {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let body = PlaneMesh::new(points, [[0u32, 1, 2].as_slice()])?;
        let image = image(&body, &[[5.0; 3]], |v| ColorMap::Inferno.of([0.0, 10.0], v), body.window(), [20, 20]);
        let [r, g, b] = ColorMap::Inferno.at(0.5);
        assert_eq!(image.pixel(3, 15), [r, g, b, 255]);
        assert_eq!(image.pixel(15, 3), [0, 0, 0, 0]);
        Ok(())
    }

    #[test]
    fn level_lines_lie_on_the_level_and_join() -> Outcome {
        let body = PlaneMesh::of_mesh(&Mesh::rectangle([1.0, 1.0], [8, 8], Diagonal::Right)?)?;
        let values: Vec<f64> = body.points.iter().map(|p| p[0] + p[1]).collect();
        let pieces = level_line(&body, &values, 0.77);
        let length: f64 = pieces.iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        assert!((length - 0.77 * 2f64.sqrt()).abs() < 1e-12);
        assert!(pieces.iter().flatten().all(|p| (p[0] + p[1] - 0.77).abs() < 1e-12));
        assert!(level_line(&body, &values, 3.0).is_empty());
        Ok(())
    }
}
