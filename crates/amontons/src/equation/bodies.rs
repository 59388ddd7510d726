//! The bodies of a mesh, whose rigid motions a step may split off.

use crate::mesh::Mesh;
use crate::mesh::defects::components;
use crate::problem::Problem;
use crate::state::{Carried, Rigid};
use crate::tensor::{Point, dot};

/// Fraction of the moments of a body below which its nodes count as collinear, so that it does not rotate about their
/// line.
const FLAT: f64 = 1e-9;

/// The bodies of a mesh, whose rigid motions have no strain.
#[derive(Debug)]
pub(crate) struct Bodies {
    pub dim: usize,
    pub all: Vec<Body>,
    /// The body of each node, or `None` for a node without cells.
    pub of_node: Vec<Option<usize>>,
}

/// One of the bodies.
#[derive(Debug)]
pub(crate) struct Body {
    pub nodes: Vec<u32>,
    /// x − c of each node, and the inverse of Σ (|x − c|² 1 − (x − c)(x − c)ᵀ); zero if the body does not rotate.
    arms: Vec<Point>,
    inverse: [Point; 3],
}

impl Bodies {
    /// The bodies of a mesh, or `None` if a law is not linear, or if rigid motions cause forces (springs, dashpots) or
    /// are not those of the mesh (sectors, whose nodes follow each other rotated; rigid bodies).
    pub fn new(problem: &Problem, mesh: &Mesh, is_linear: bool) -> Option<Bodies> {
        let is_free = problem.boundary.iter().all(|b| b.spring.is_none() && b.dashpot.is_none());
        if !is_linear || !is_free || !problem.cyclic.is_empty() || !problem.rigid.is_empty() {
            return None;
        }
        let turns = mesh.dim > 1 && !mesh.axisymmetric;
        let of = |nodes: Vec<u32>| {
            let n = nodes.len().max(1) as f64;
            let x = |node: &u32| mesh.points[*node as usize];
            let centre: Point = std::array::from_fn(|c| nodes.iter().map(|node| x(node)[c]).sum::<f64>() / n);
            let arm = |node: &u32| -> Point { std::array::from_fn(|c| x(node)[c] - centre[c]) };
            let arms: Vec<Point> = nodes.iter().map(arm).collect();
            let inverse = if turns { inverse(&arms, mesh.dim) } else { [[0.0; 3]; 3] };
            Body { nodes, arms, inverse }
        };
        let all: Vec<Body> = components(mesh).into_iter().map(|part| of(part.nodes)).collect();
        let mut of_node = vec![None; mesh.points.len()];
        for (number, body) in all.iter().enumerate() {
            body.nodes.iter().for_each(|&node| of_node[node as usize] = Some(number));
        }
        Some(Bodies { dim: mesh.dim, all, of_node })
    }

    /// The parts of a displacement.
    pub fn apart(&self, is_axisymmetric: bool, u: &[f64]) -> Carried {
        let mut deformation = u.to_vec();
        let rigid = self.take(is_axisymmetric, &mut deformation);
        Carried { rigid, deformation }
    }

    /// Removes from a field the rigid motion of each body that is nearest to it in the mean square over the nodes, and
    /// returns it. A body of revolution moves along its axis only.
    pub fn take(&self, is_axisymmetric: bool, v: &mut [f64]) -> Vec<Rigid> {
        let all = self.all.iter().map(|body| {
            let at = |node: u32| -> Point {
                std::array::from_fn(|c| if c < self.dim { v[node as usize * self.dim + c] } else { 0.0 })
            };
            let n = body.nodes.len().max(1) as f64;
            let moves = |c: usize| c < self.dim && !(is_axisymmetric && c == 0);
            let mean = |c: usize| body.nodes.iter().map(|&node| at(node)[c]).sum::<f64>() / n;
            let translation: Point = std::array::from_fn(|c| if moves(c) { mean(c) } else { 0.0 });
            let moment = body.nodes.iter().zip(&body.arms).fold([0.0; 3], |sum: Point, (&node, arm)| {
                let v = at(node);
                let turn = cross(arm, &std::array::from_fn(|c| v[c] - translation[c]));
                std::array::from_fn(|c| sum[c] + turn[c])
            });
            let rotation = std::array::from_fn(|c| dot(&body.inverse[c], &moment));
            Rigid { translation, rotation }
        });
        let all: Vec<Rigid> = all.collect();
        self.add(&all, -1.0, v);
        all
    }

    /// Adds a multiple of rigid motions to a field.
    pub fn add(&self, rigid: &[Rigid], factor: f64, field: &mut [f64]) {
        for (body, Rigid { translation, rotation }) in self.all.iter().zip(rigid) {
            for (&node, arm) in body.nodes.iter().zip(&body.arms) {
                let turned = cross(rotation, arm);
                for c in 0..self.dim {
                    field[node as usize * self.dim + c] += factor * (translation[c] + turned[c]);
                }
            }
        }
    }
}

/// Bodies and split displacement of a step that splits off rigid motions.
#[derive(Clone, Copy)]
pub(crate) struct Apart<'a> {
    pub bodies: &'a Bodies,
    pub carried: &'a Carried,
}

fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The inverse of the moments of a body; zero if its nodes lie on a line. A plane body rotates about the last axis
/// only.
fn inverse(arms: &[Point], dim: usize) -> [Point; 3] {
    let mut moments = [[0.0; 3]; 3];
    for arm in arms {
        let squared = dot(arm, arm);
        for (a, row) in moments.iter_mut().enumerate() {
            for (b, entry) in row.iter_mut().enumerate() {
                *entry += if a == b { squared } else { 0.0 } - arm[a] * arm[b];
            }
        }
    }
    let mut inverse = [[0.0; 3]; 3];
    if dim < 3 {
        inverse[2][2] = if moments[2][2] > 0.0 { moments[2][2].recip() } else { 0.0 };
        return inverse;
    }
    let [a, b, c] = moments;
    let columns = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
    let determinant = dot(&a, &columns[0]);
    let size = moments[0][0] + moments[1][1] + moments[2][2];
    if determinant > FLAT * size.powi(3) {
        // The matrix is symmetric.
        inverse = columns.map(|column| column.map(|entry| entry / determinant));
    }
    inverse
}
