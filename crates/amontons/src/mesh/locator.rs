//! Finds the cell that contains a point, in any mesh.

use std::sync::Arc;

use super::{Mesh, invert};
use crate::element::{Element, MAX_NODES};
use crate::tensor::{Point, length};

/// Depth outside the reference cell up to which a point belongs to it, for round-off.
pub(crate) const OUTSIDE: f64 = -1e-9;

/// A cell of a mesh: block, and cell in the block.
pub(crate) type CellPlace = (u32, u32);

/// The cells of a mesh, sorted into the boxes of a background grid.
#[derive(Debug)]
pub(crate) struct CellBoxes {
    low: Point,
    width: Point,
    count: [usize; 3],
    buckets: Vec<Vec<CellPlace>>,
}

impl CellBoxes {
    /// Sorts the cells of a mesh.
    pub(crate) fn new(mesh: &Mesh) -> CellBoxes {
        CellBoxes::of(mesh, mesh.dim)
    }

    /// Sorts the cells of a mesh by the first `dim` coordinates.
    pub(crate) fn of(mesh: &Mesh, dim: usize) -> CellBoxes {
        let (low, high) = bounds(mesh.points.iter());
        let side = ((mesh.cell_count() as f64).powf(1.0 / dim as f64).ceil() as usize).max(1);
        let count = std::array::from_fn(|d| if d < dim { side } else { 1 });
        let width = std::array::from_fn(|d| ((high[d] - low[d]) / count[d] as f64).max(f64::MIN_POSITIVE));
        let mut grid = CellBoxes { low, width, count, buckets: vec![Vec::new(); count.iter().product()] };
        for (b, block) in mesh.blocks.iter().enumerate() {
            for (c, cell) in block.cells().enumerate() {
                for bucket in grid.range(
                    cell.iter().map(|&n| &mesh.points[n as usize]),
                    if block.element.degree > 1 { 0.25 } else { 0.0 },
                ) {
                    grid.buckets[bucket].push((b as u32, c as u32));
                }
            }
        }
        grid
    }

    /// Cells in the boxes touched by the bounding box of some points.
    pub(crate) fn near<'p>(&self, points: impl Iterator<Item = &'p Point>) -> impl Iterator<Item = CellPlace> {
        self.range(points, 0.0).into_iter().flat_map(|bucket| self.buckets[bucket].iter().copied())
    }

    /// Boxes touched by the bounding box of some points, widened by a fraction `wider` of itself on all sides: curved
    /// cells extend beyond their nodes, by at most an eighth of a box that a middle node spans.
    pub(crate) fn range<'p>(&self, points: impl Iterator<Item = &'p Point>, wider: f64) -> Vec<usize> {
        let (low, high) = bounds(points);
        let index =
            |d: usize, x: f64| (((x - self.low[d]) / self.width[d]).floor().max(0.0) as usize).min(self.count[d] - 1);
        let [x, y, z] = [0, 1, 2].map(|d| {
            let more = wider * (high[d] - low[d]) + 1e-9 * self.width[d];
            index(d, low[d] - more)..=index(d, high[d] + more)
        });
        let mut buckets = Vec::new();
        for k in z {
            for j in y.clone() {
                buckets.extend(x.clone().map(|i| (k * self.count[1] + j) * self.count[0] + i));
            }
        }
        buckets
    }
}

impl Mesh {
    /// Element and nodes of a cell.
    pub(super) fn cell_at(&self, (block, cell): CellPlace) -> (&'static Element, &[u32]) {
        let block = &self.blocks[block as usize];
        let n = block.element.nodes.len();
        (block.element, &block.nodes[cell as usize * n..(cell as usize + 1) * n])
    }
}

/// Finds the cell of a mesh that contains a point.
pub struct Locator<'a> {
    mesh: &'a Mesh,
    grid: Arc<CellBoxes>,
}

impl<'a> Locator<'a> {
    /// Sorts the cells of a mesh.
    #[must_use]
    pub fn new(mesh: &'a Mesh) -> Locator<'a> {
        Locator::of(mesh, Arc::new(CellBoxes::new(mesh)))
    }

    /// The locator of a mesh whose cells are already sorted.
    pub(crate) fn of(mesh: &'a Mesh, grid: Arc<CellBoxes>) -> Locator<'a> {
        Locator { mesh, grid }
    }

    /// The mesh.
    pub(crate) fn mesh(&self) -> &'a Mesh {
        self.mesh
    }

    /// Boxes touched by the bounding box of some points; see [`CellBoxes::range`].
    pub(crate) fn range<'p>(&self, points: impl Iterator<Item = &'p Point>, wider: f64) -> Vec<usize> {
        self.grid.range(points, wider)
    }

    /// Cells of a box.
    pub(crate) fn bucket(&self, bucket: usize) -> &[CellPlace] {
        &self.grid.buckets[bucket]
    }

    /// Element and nodes of a cell.
    pub(crate) fn cell(&self, at: CellPlace) -> (&'static Element, &'a [u32]) {
        self.mesh.cell_at(at)
    }

    /// Nodes of the cell that contains a point with the values of their shape functions there; `None` outside the mesh.
    #[must_use]
    pub fn locate(&self, p: &Point) -> Option<(&'a [u32], Vec<f64>)> {
        let (at, x) = self.find(p)?;
        let (element, nodes) = self.cell(at);
        let mut values = vec![0.0; nodes.len()];
        (element.shape_functions)(&x, &mut values);
        Some((nodes, values))
    }

    /// The cell in which a point lies deepest, as block and cell in the block, with the reference coordinates there;
    /// `None` outside the mesh.
    #[must_use]
    pub fn place(&self, p: &Point) -> Option<(usize, usize, Point)> {
        self.find(p).map(|((block, cell), x)| (block as usize, cell as usize, x))
    }

    /// The cell in which a point lies deepest, and its reference coordinates there; `None` outside the mesh.
    pub(crate) fn find(&self, p: &Point) -> Option<(CellPlace, Point)> {
        deepest(self.near(p, OUTSIDE))
    }

    /// Like [`Locator::find`] among the cells of a region. If the point lies outside all of them by less than a cell
    /// height, the nearest cell: the one with the shortest outer part of the line from its centre to the point.
    pub(crate) fn find_near(&self, p: &Point, region: usize) -> Option<(CellPlace, Point)> {
        let cells =
            || self.near(p, -1.0).filter(|(_, (block, _), _)| self.mesh.blocks[*block as usize].region == region);
        let beyond = |(_, at, x): &(f64, CellPlace, Point)| {
            let (element, nodes) = self.cell(*at);
            let (centre, mut inside, mut outside) = (element.centre(), 0.0, 1.0);
            for _ in 0..30 {
                let share = 0.5 * (inside + outside);
                let there = std::array::from_fn(|d| centre[d] + share * (x[d] - centre[d]));
                *(if element.shape.depth(&there) > 0.0 { &mut inside } else { &mut outside }) = share;
            }
            let mean =
                |d: usize| nodes.iter().map(|&n| self.mesh.points[n as usize][d]).sum::<f64>() / nodes.len() as f64;
            (1.0 - inside) * length(&std::array::from_fn(|d| p[d] - mean(d)))
        };
        deepest(cells().filter(|(depth, ..)| *depth > OUTSIDE))
            .or_else(|| deepest(cells().map(|cell| (-beyond(&cell), cell.1, cell.2))))
    }

    /// All cells with a point inside or on their boundary, as block and cell in the block.
    pub(crate) fn around(&self, p: &Point) -> Vec<(usize, usize)> {
        self.near(p, OUTSIDE).map(|(_, (block, cell), _)| (block as usize, cell as usize)).collect()
    }

    /// The cells in which a point lies deeper than `least`, with its depth and its reference coordinates there.
    fn near(&self, p: &Point, least: f64) -> impl Iterator<Item = (f64, CellPlace, Point)> {
        let at = move |at: CellPlace| {
            let (element, nodes) = self.cell(at);
            let x = reference_point(self.mesh, element, nodes, p)?;
            Some((element.shape.depth(&x), at, x)).filter(|(depth, ..)| *depth > least)
        };
        // A cell extends less than its size.
        let far = if least < OUTSIDE { 0.5 } else { 0.0 };
        let corner = |side: f64| std::array::from_fn(|d| p[d] + side * far * self.grid.width[d]);
        let buckets = self.range([&corner(-1.0), &corner(1.0)].into_iter(), 0.0);
        let mut seen: Vec<CellPlace> = buckets.iter().flat_map(|&bucket| self.bucket(bucket)).copied().collect();
        if buckets.len() > 1 {
            let mut before = Vec::with_capacity(seen.len());
            seen.retain(|at| {
                !before.contains(at) && {
                    before.push(*at);
                    true
                }
            });
        }
        seen.into_iter().filter_map(at)
    }
}

/// The cell in which a point lies deepest; the first of several.
fn deepest(cells: impl Iterator<Item = (f64, CellPlace, Point)>) -> Option<(CellPlace, Point)> {
    let deeper = |best: Option<(f64, CellPlace, Point)>, found: (f64, CellPlace, Point)| match best {
        Some(best) if best.0 >= found.0 => Some(best),
        _ => Some(found),
    };
    cells.fold(None, deeper).map(|(_, at, x)| (at, x))
}

fn bounds<'p>(points: impl Iterator<Item = &'p Point>) -> (Point, Point) {
    points.fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), p| {
        (std::array::from_fn(|d| low[d].min(p[d])), std::array::from_fn(|d| high[d].max(p[d])))
    })
}

/// Reference coordinates of a point in a cell by Newton's method from the centre: one step for a linear simplex, a few
/// for other cells that contain the point. `None` if it does not converge, far outside the cell.
pub(crate) fn reference_point(mesh: &Mesh, element: &Element, nodes: &[u32], p: &Point) -> Option<Point> {
    match mesh.dim {
        1 => newton::<1>(mesh, element, nodes, p),
        2 => newton::<2>(mesh, element, nodes, p),
        _ => newton::<3>(mesh, element, nodes, p),
    }
}

fn newton<const D: usize>(mesh: &Mesh, element: &Element, nodes: &[u32], p: &Point) -> Option<Point> {
    const MOST: usize = 30;
    const FAR: f64 = 10.0;
    let (mut values, mut gradients) = ([0.0; MAX_NODES], [[0.0; 3]; MAX_NODES]);
    let mut x = element.centre();
    for _ in 0..MOST {
        (element.shape_functions)(&x, &mut values[..nodes.len()]);
        (element.gradients)(&x, &mut gradients[..nodes.len()]);
        let (mut rest, mut j) = ([0.0; D], [[0.0; D]; D]);
        for row in 0..D {
            // Coordinates are relative to the point, so that round-off is relative to the size of the cell.
            for (n, &node) in nodes.iter().enumerate() {
                let at = mesh.points[node as usize][row] - p[row];
                rest[row] -= values[n] * at;
                for col in 0..D {
                    j[row][col] += at * gradients[n][col];
                }
            }
        }
        let (determinant, inverse) = invert(&j);
        if determinant.abs() < f64::MIN_POSITIVE {
            return None;
        }
        let mut step: f64 = 0.0;
        for row in 0..D {
            let change: f64 = (0..D).map(|col| inverse[row][col] * rest[col]).sum();
            x[row] += change;
            step = step.max(change.abs());
        }
        if step.is_nan() || x.iter().any(|c| c.abs() > FAR) {
            return None;
        }
        if step < 1e-13 {
            return Some(x);
        }
    }
    None
}
