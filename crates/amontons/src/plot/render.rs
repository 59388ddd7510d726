//! A body in space as pixels: parallel projection with a depth buffer, shaded.

use super::color::Color;
use super::picture::Image;
use super::surface::{across, dot, norm};

/// Number of samples per pixel in each direction.
const SAMPLES: usize = 2;

/// A direction of view, given by the directions to the right, upwards and to the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub right: [f64; 3],
    pub up: [f64; 3],
    pub eye: [f64; 3],
}

impl View {
    /// The view from an azimuth from the x-axis and an elevation above the plane of x and y, in degrees; z points
    /// upwards.
    pub(super) fn new(azimuth: f64, elevation: f64) -> View {
        let ((sa, ca), (se, ce)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
        View { right: [-sa, ca, 0.0], up: [-se * ca, -se * sa, ce], eye: [ce * ca, ce * sa, se] }
    }

    /// The view from a direction.
    pub(super) fn of_eye(eye: [f64; 3]) -> View {
        let [x, y, z] = eye.map(|c| c / norm(eye));
        // Seen from straight above or below, y points upwards.
        let azimuth = if x.hypot(y) > 1e-9 { y.atan2(x).to_degrees() } else { -90.0 };
        View::new(azimuth, z.clamp(-1.0, 1.0).asin().to_degrees())
    }

    /// Projected coordinates: right, up, towards the eye.
    pub(super) fn place(&self, p: [f64; 3]) -> [f64; 3] {
        [dot(self.right, p), dot(self.up, p), dot(self.eye, p)]
    }
}

/// Triangles coloured by their values.
pub(super) struct ShadedTriangle<'a> {
    /// Projected nodes: right, up, towards the eye.
    pub points: &'a [[f64; 3]],
    pub triangles: &'a [[u32; 3]],
    /// Values at the corners of each triangle.
    pub values: &'a dyn Fn(usize) -> [f64; 3],
    pub color: &'a dyn Fn(f64) -> [u8; 3],
    /// Lines on the surface, drawn where they are visible.
    pub lines: &'a [[u32; 2]],
    pub ink: Color,
}

/// Draws a scene into an image that covers a window of right and up and is transparent outside the body.
///
/// At each sample the surface nearest to the eye is visible, whatever the order of the triangles.
pub(super) fn image(scene: &ShadedTriangle, window: [[f64; 2]; 2], width: u32, height: u32) -> Image {
    let (columns, rows) = (width as usize * SAMPLES, height as usize * SAMPLES);
    let [wx, wy] = window;
    let scale = [columns as f64 / (wx[1] - wx[0]), rows as f64 / (wy[1] - wy[0])];
    // The centre of sample (i, j) is at (i, j), j downwards.
    let place = |n: u32| {
        let p = scene.points[n as usize];
        [(p[0] - wx[0]) * scale[0] - 0.5, (wy[1] - p[1]) * scale[1] - 0.5, p[2]]
    };
    let mut canvas =
        Canvas { columns, rows, depth: vec![f64::NEG_INFINITY; columns * rows], colors: vec![[0; 3]; columns * rows] };
    for (t, nodes) in scene.triangles.iter().enumerate() {
        let light = light(nodes.map(|n| scene.points[n as usize]));
        let values = (scene.values)(t);
        canvas.triangle(nodes.map(place), |share| {
            let value = share[0] * values[0] + share[1] * values[1] + share[2] * values[2];
            (scene.color)(value).map(|c| (f64::from(c) * light).round() as u8)
        });
    }
    // Lines lie on the surface: surfaces nearer by no more than this do not hide them.
    let near = 0.004 * (wx[1] - wx[0]).max(wy[1] - wy[0]);
    for line in scene.lines {
        canvas.line(line.map(place), near, scene.ink);
    }
    canvas.image(width, height)
}

/// Fraction of light reflected by a triangle, from a lamp slightly above the left shoulder of the viewer.
fn light(corners: [[f64; 3]; 3]) -> f64 {
    const LAMP: [f64; 3] = [-0.28, 0.28, 0.918];
    let normal = across(corners);
    let size = norm(normal);
    // The visible side is the one towards the eye.
    let facing = if size > 0.0 { dot(normal, LAMP) * normal[2].signum() / size } else { 0.0 };
    0.7 + 0.3 * facing.max(0.0)
}

struct Canvas {
    columns: usize,
    rows: usize,
    depth: Vec<f64>,
    colors: Vec<[u8; 3]>,
}

impl Canvas {
    fn triangle(&mut self, [a, b, c]: [[f64; 3]; 3], color: impl Fn([f64; 3]) -> [u8; 3]) {
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 {
            return;
        }
        let span = |d: usize, end: usize| {
            let (low, high) = (a[d].min(b[d]).min(c[d]) - 1e-6, a[d].max(b[d]).max(c[d]) + 1e-6);
            (low.ceil().max(0.0) as usize)..((high.floor() + 1.0).clamp(0.0, end as f64) as usize)
        };
        for j in span(1, self.rows) {
            for i in span(0, self.columns) {
                let (x, y) = (i as f64, j as f64);
                let sb = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
                let sc = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
                let sa = 1.0 - sb - sc;
                // A sample on an edge belongs to both triangles: no gaps between them.
                if sa.min(sb).min(sc) < -1e-6 {
                    continue;
                }
                let depth = sa * a[2] + sb * b[2] + sc * c[2];
                let at = j * self.columns + i;
                if depth > self.depth[at] {
                    self.depth[at] = depth;
                    self.colors[at] = color([sa, sb, sc]);
                }
            }
        }
    }

    /// Draws a line as wide as two samples.
    fn line(&mut self, [a, b]: [[f64; 3]; 2], near: f64, ink: Color) {
        let steps = (2.0 * (b[0] - a[0]).hypot(b[1] - a[1])).ceil().max(1.0);
        let mut last = None;
        for step in 0..=steps as usize {
            let s = step as f64 / steps;
            let [x, y, depth] = [0, 1, 2].map(|d| a[d] + s * (b[d] - a[d]));
            let place = [x.floor(), y.floor()];
            if last == Some(place) {
                continue;
            }
            last = Some(place);
            for [di, dj] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
                let (i, j) = (place[0] + di, place[1] + dj);
                if i < 0.0 || j < 0.0 || i >= self.columns as f64 || j >= self.rows as f64 {
                    continue;
                }
                let at = j as usize * self.columns + i as usize;
                let seen = self.depth[at];
                if seen > f64::NEG_INFINITY && seen <= depth + near {
                    self.colors[at] = [ink.red, ink.green, ink.blue];
                }
            }
        }
    }

    /// The mean of the samples of each pixel.
    fn image(&self, width: u32, height: u32) -> Image {
        let mut rgba = Vec::with_capacity(4 * width as usize * height as usize);
        for j in 0..height as usize {
            for i in 0..width as usize {
                let mut sum = [0u32; 3];
                let mut covered = 0;
                for s in 0..SAMPLES * SAMPLES {
                    let at = (SAMPLES * j + s / SAMPLES) * self.columns + SAMPLES * i + s % SAMPLES;
                    if self.depth[at] > f64::NEG_INFINITY {
                        covered += 1;
                        sum.iter_mut().zip(self.colors[at]).for_each(|(sum, c)| *sum += u32::from(c));
                    }
                }
                let share = |sum: u32| (sum + covered / 2).checked_div(covered).unwrap_or(0) as u8;
                rgba.extend(sum.map(share));
                rgba.push((255 * covered / (SAMPLES * SAMPLES) as u32) as u8);
            }
        }
        Image { width, height, rgba }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Elements, Mesh};
    use crate::plot::surface::Skin;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    #[test]
    fn views_are_right_handed_and_orthonormal() {
        for (azimuth, elevation) in [(-60.0, 30.0), (120.0, -30.0), (0.0, 90.0), (17.0, 0.0)] {
            let View { right, up, eye } = View::new(azimuth, elevation);
            let cross = across([[0.0; 3], right, up]);
            assert!((0..3).all(|d| (cross[d] - eye[d]).abs() < 1e-15), "{azimuth}, {elevation}");
            assert!((norm(right) - 1.0).abs() < 1e-15 && dot(right, up).abs() < 1e-15);
        }
    }

    /// A large triangle behind a small one, drawn in both orders: the nearer one is visible where they overlap.
    #[test]
    fn what_is_nearer_is_in_front() {
        let points =
            [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [1.0, 1.0, 1.0], [4.0, 1.0, 1.0], [1.0, 4.0, 1.0]];
        for triangles in [[[0, 1, 2], [3, 4, 5]], [[3, 4, 5], [0, 1, 2]]] {
            let near = usize::from(triangles[0][0] != 3);
            let values = move |t: usize| [if t == near { 1.0 } else { 0.0 }; 3];
            let color = |v: f64| if v > 0.5 { [255, 0, 0] } else { [0, 0, 255] };
            let scene = ShadedTriangle {
                points: &points,
                triangles: &triangles,
                values: &values,
                color: &color,
                lines: &[[0, 1], [3, 4]],
                ink: Color::new(0x00_FF_00),
            };
            let image = image(&scene, [[0.0, 10.0], [0.0, 10.0]], 50, 50);
            let [front, back, outside] = [image.pixel(8, 40), image.pixel(25, 35), image.pixel(45, 5)];
            assert!(front[0] > 160 && front[2] == 0 && front[3] == 255, "{front:?}");
            assert!(back[2] > 160 && back[0] == 0 && back[3] == 255, "{back:?}");
            assert_eq!(outside, [0; 4]);
        }
    }

    /// Faces of a box by the coordinate that points to the eye: three are visible, each at its place, and no line of
    /// the others.
    #[test]
    fn a_box_shows_the_three_faces_towards_the_eye() -> Outcome {
        let surface = Skin::of_mesh(&Mesh::box_([1.0, 1.0, 1.0], [3, 3, 3], Elements::Q1)?)?;
        let view = View::new(-60.0, 30.0);
        let points: Vec<[f64; 3]> = surface.points.iter().map(|p| view.place(*p)).collect();
        // The value of a triangle is the number of its face: 2 axis + (1 at the far end).
        let face = |t: usize| -> f64 {
            let corners = surface.triangles[t].map(|n| surface.points[n as usize]);
            let axis = (0..3).find(|&d| corners.iter().all(|p| (p[d] - corners[0][d]).abs() < 1e-12)).unwrap_or(9);
            2.0 * axis as f64 + corners[0][axis]
        };
        let values = |t: usize| [face(t); 3];
        let color = |v: f64| [40 * (v.round() as u8 + 1), 0, 0];
        let draw = |lines: &[[u32; 2]]| {
            let scene = ShadedTriangle {
                points: &points,
                triangles: &surface.triangles,
                values: &values,
                color: &color,
                lines,
                ink: Color::new(0x00_FF_00),
            };
            image(&scene, [[-1.0, 2.0], [-2.0, 2.0]], 300, 400)
        };
        let image = draw(&[]);
        for (centre, number) in [([1.0, 0.5, 0.5], 1u8), ([0.5, 0.0, 0.5], 2), ([0.5, 0.5, 1.0], 5)] {
            let [x, y, _] = view.place(centre);
            let [red, _, _, opacity] = image.pixel(((x + 1.0) * 100.0) as u32, ((2.0 - y) * 100.0) as u32);
            let full = f64::from(40 * (number + 1));
            assert!(
                f64::from(red) >= 0.65 * full && f64::from(red) <= full && opacity == 255,
                "face {number}: red {red}, at most {full}"
            );
        }
        // The area of the picture equals the projected area of the three faces: Σ |ν·eye|.
        let covered: f64 = image.rgba.chunks_exact(4).map(|p| f64::from(p[3]) / 255.0).sum::<f64>() / 1e4;
        let expected: f64 = view.eye.iter().map(|e| e.abs()).sum();
        assert!((covered - expected).abs() < 0.01, "{covered}, expected {expected}");
        // A line along the hidden edge x = 0, y = 1 leaves no trace except at its end, which is on the outline.
        let at = |p: [f64; 3]| {
            surface.points.iter().position(|q| (0..3).all(|d| (q[d] - p[d]).abs() < 1e-12)).map(|n| n as u32)
        };
        let (low, high) = (at([0.0, 1.0, 1.0 / 3.0]).ok_or("no node")?, at([0.0, 1.0, 2.0 / 3.0]).ok_or("no node")?);
        assert!(draw(&[[low, high]]).rgba == image.rgba, "a hidden line is seen");
        Ok(())
    }
}
