//! Stresses at nodes, recovered from the points of the cells where they are most accurate.
//!
//! Superconvergent patch recovery (Zienkiewicz and Zhu 1992, *Int. J. Numer. Methods Eng.* 33, 1331–1364). Around every
//! vertex inside a region the values of the cells at their sampling points (the centre for linear elements, the Gauss
//! points of the next lower order for quadratic ones) are fitted by a polynomial of the degree of the element, in the
//! sense of least squares. The vertex takes the value of its patch. A node on the boundary of the region, or in the
//! middle of an edge, face or cell, takes the mean of the patches around the inner vertices next to it. For smooth
//! solutions on regular meshes the values at the nodes converge one order faster than those of the cells.
//!
//! A patch never crosses the boundary of a region: stresses jump between two materials, and a node there has one value
//! per region. In a region without inner vertices, such as a layer of one cell, a patch around the node itself is
//! fitted as far as its points determine a polynomial. A value that would be a difference of much larger ones is
//! replaced by that of a polynomial of lower degree, at last the mean of the patch.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::cells::{Evaluator, PointValues, Tables, all_values};
use super::fit::{Fit, exponents};
use crate::arrays::all_at_once;
use crate::element::Element;
use crate::material::material_arrays;
use crate::mesh::Mesh;
use crate::problem::Problem;
use crate::quadrature::{QuadratureRule, Shape, rule};
use crate::state::State;
use crate::tensor::{Point, Sym};

/// A sampling point: block, cell of the block, point of the cell.
pub(super) type SamplingPoint = (u32, u32, u32);

/// A value at a node as a sum over sampling points, in ascending order.
pub(super) type Stencil = Vec<(SamplingPoint, f64)>;

/// Sampling points with the polynomial that is fitted to their values.
type Patch<'r> = (Vec<SamplingPoint>, Fit<'r>);

/// Largest sum of the magnitudes of the weights of a value, by degree of the polynomial. On even meshes of triangles
/// and tetrahedra it is up to 8 at a corner of linear cells, two edges from an inner vertex, and up to 17 at one of
/// quadratic cells. For points that hardly determine a polynomial, as in a layer of one tetrahedron, it is unbounded.
const MOST: [f64; 3] = [1.0, 9.0, 20.0];
/// Number of times that a patch without inner vertices grows by its neighbours.
const GROWTH: usize = 2;
/// Number of nodes that share patches: the patches of all nodes together would take more memory than a run.
const TOGETHER: usize = 1024;

/// Values at the nodes of each region.
#[derive(Clone, Debug, Default)]
pub struct NodalStress {
    /// By region of the mesh: its nodes, ascending, each with its stress.
    pub regions: Vec<Vec<(u32, Sym)>>,
}

impl NodalStress {
    /// The stress at a node of a region, or `None` at other nodes.
    #[must_use]
    pub fn get(&self, region: usize, node: u32) -> Option<Sym> {
        let nodes = self.regions.get(region)?;
        nodes
            .binary_search_by_key(&node, |(node, _)| *node)
            .ok()
            .and_then(|place| nodes.get(place))
            .map(|(_, stress)| *stress)
    }

    /// The stress at every node of a mesh with `nodes` nodes: the mean where several regions meet.
    #[must_use]
    pub fn means(&self, nodes: usize) -> Vec<Sym> {
        let mut sums = vec![(Sym::ZERO, 0.0); nodes];
        for &(node, stress) in self.regions.iter().flatten() {
            if let Some((sum, count)) = sums.get_mut(node as usize) {
                *sum += stress;
                *count += 1.0;
            }
        }
        sums.into_iter().map(|(sum, count)| if count > 0.0 { (1.0 / count) * sum } else { sum }).collect()
    }
}

/// The recovered stress of a state at the nodes of each region. For several states of one mesh, keep a
/// [`StressRecovery`].
#[must_use]
pub fn nodal_stress(problem: &Problem, state: &State) -> NodalStress {
    StressRecovery::new(&problem.mesh).stress(problem, state)
}

/// The patches of a mesh as weights of sampling points at each node. They depend on the mesh only: compute them once
/// per run.
#[derive(Debug)]
pub struct StressRecovery {
    regions: Vec<RegionWeights>,
}

/// The nodes of a region, ascending, with the weights of sampling points, numbered through all blocks.
#[derive(Debug, Default)]
struct RegionWeights {
    nodes: Vec<u32>,
    /// The end of each node in `samples` and `weights`.
    ends: Vec<usize>,
    samples: Vec<u32>,
    weights: Vec<f64>,
}

impl RegionWeights {
    /// These nodes and others after them.
    fn followed_by(mut self, others: RegionWeights) -> RegionWeights {
        let before = self.samples.len();
        self.ends.extend(others.ends.iter().map(|end| before + end));
        self.nodes.extend(others.nodes);
        self.samples.extend(others.samples);
        self.weights.extend(others.weights);
        self
    }

    /// Sampling points with their weights, for each node.
    fn of_nodes(&self) -> impl IndexedParallelIterator<Item = (u32, impl Iterator<Item = (usize, f64)>)> {
        (0..self.nodes.len()).into_par_iter().map(|place| {
            let range = (if place == 0 { 0 } else { self.ends[place - 1] })..self.ends[place];
            let samples = self.samples[range.clone()].iter().map(|&sample| sample as usize);
            (self.nodes[place], samples.zip(self.weights[range].iter().copied()))
        })
    }
}

impl StressRecovery {
    /// Fits the patches of a mesh.
    #[must_use]
    pub fn new(mesh: &Mesh) -> StressRecovery {
        let recovery = Recovery::new(mesh);
        let counts: Vec<usize> = recovery.points.iter().map(|rule| rule.points.len()).collect();
        let sizes = mesh.blocks.iter().zip(&counts).map(|(block, count)| block.len() * count);
        let starts: Vec<usize> = sizes.scan(0, |end, size| Some(std::mem::replace(end, *end + size))).collect();
        let number = |(block, cell, q): SamplingPoint| {
            (starts[block as usize] + cell as usize * counts[block as usize] + q as usize) as u32
        };
        let of_region = |(region, nodes): (usize, &Vec<u32>)| {
            let of_some = |nodes: &[u32]| {
                let mut some = RegionWeights { nodes: nodes.to_vec(), ..RegionWeights::default() };
                for stencil in recovery.stencils(region, nodes) {
                    some.samples.extend(stencil.iter().map(|(sample, _)| number(*sample)));
                    some.weights.extend(stencil.iter().map(|(_, weight)| weight));
                    some.ends.push(some.samples.len());
                }
                some
            };
            let parts: Vec<RegionWeights> = nodes.par_chunks(TOGETHER).map(of_some).collect();
            parts.into_iter().fold(RegionWeights::default(), RegionWeights::followed_by)
        };
        StressRecovery { regions: recovery.nodes.iter().enumerate().map(of_region).collect() }
    }

    /// The recovered stress of a state of a problem on this mesh.
    #[must_use]
    pub fn stress(&self, problem: &Problem, state: &State) -> NodalStress {
        let tables = Tables::new(problem, sampling);
        let values = all_values(problem, state, &tables, |values| values.stress);
        self.of_values(|sample| values.get(sample))
    }

    /// The recovered stress at every node of the mesh, the mean where regions meet, of a state whose values at the
    /// centres of the cells are known: linear elements are sampled there.
    pub(super) fn means(&self, problem: &Problem, state: &State, centres: &[PointValues]) -> Vec<Sym> {
        let is_linear = problem.mesh.blocks.iter().all(|block| block.element.degree < 2);
        let stress = if is_linear {
            self.of_values(|sample| centres.get(sample).map(|values| &values.stress))
        } else {
            self.stress(problem, state)
        };
        stress.means(problem.mesh.points.len())
    }

    /// The recovered stress of the stresses at the sampling points.
    fn of_values<'v>(&self, stress: impl Fn(usize) -> Option<&'v Sym> + Sync) -> NodalStress {
        let value = |(sample, weight): (usize, f64)| weight * stress(sample).copied().unwrap_or(Sym::ZERO);
        let of_region = |region: &RegionWeights| {
            let nodes = region.of_nodes();
            nodes.map(|(node, all)| (node, all.map(value).fold(Sym::ZERO, |sum, term| sum + term))).collect()
        };
        NodalStress { regions: self.regions.iter().map(of_region).collect() }
    }
}

/// Values of a state at some sampling points, ascending, of tables that begin with the points of [`sampling`].
pub(super) fn evaluate(
    problem: &Problem,
    state: &State,
    tables: &Tables,
    samples: &[SamplingPoint],
) -> Vec<PointValues> {
    all_at_once(&material_arrays(&problem.materials), || {
        let mut values = Vec::with_capacity(samples.len());
        for part in samples.chunk_by(|a, b| a.0 == b.0) {
            let Some(block) = part.first().map(|s| s.0 as usize).filter(|&b| b < problem.mesh.blocks.len()) else {
                continue;
            };
            let mut evaluator = Evaluator::new(problem, state, tables, block);
            values.extend(part.iter().map(|&(_, cell, q)| evaluator.at(cell as usize, q as usize)));
        }
        values
    })
}

/// The points of a cell at which its stress is most accurate.
pub(super) fn sampling(element: &Element) -> QuadratureRule {
    // Three symmetric points; those of the collapsed square are not.
    const TRIANGLE: [[f64; 2]; 3] = [[1.0 / 6.0, 1.0 / 6.0], [2.0 / 3.0, 1.0 / 6.0], [1.0 / 6.0, 2.0 / 3.0]];
    let quadratic = element.degree > 1;
    let points: Vec<Point> = match element.shape {
        _ if !quadratic => vec![element.centre()],
        Shape::Triangle => TRIANGLE.iter().map(|&[x, y]| [x, y, 0.0]).collect(),
        Shape::Prism => {
            rule(Shape::Segment, 3).points.iter().flat_map(|z| TRIANGLE.iter().map(|&[x, y]| [x, y, z[0]])).collect()
        }
        Shape::Tetrahedron => rule(Shape::Tetrahedron, 2).points,
        shape => rule(shape, 3).points,
    };
    QuadratureRule { weights: vec![1.0; points.len()], points }
}

/// The patches of a mesh.
pub(super) struct Recovery<'m> {
    mesh: &'m Mesh,
    /// Cells at each node, as block and cell, ascending; those of node n end at `ends[n]`.
    cells: Vec<(u32, u32)>,
    ends: Vec<usize>,
    /// Nodes of each region, ascending.
    pub nodes: Vec<Vec<u32>>,
    /// Nodes on the boundary of each region, ascending.
    boundary: Vec<Vec<u32>>,
    /// Sampling points of the blocks.
    points: Vec<QuadratureRule>,
    /// Exponents of the polynomials of each degree from 0 on.
    exponents: Vec<Vec<[i32; 3]>>,
}

impl<'m> Recovery<'m> {
    /// Sorts the cells by their nodes.
    pub fn new(mesh: &'m Mesh) -> Recovery<'m> {
        let regions = mesh.blocks.iter().map(|block| block.region + 1).max().unwrap_or(0);
        let (mut ends, mut nodes) = (vec![0; mesh.points.len() + 1], vec![Vec::new(); regions]);
        for block in &mesh.blocks {
            nodes[block.region].extend_from_slice(&block.nodes);
            for &node in &block.nodes {
                ends[node as usize] += 1;
            }
        }
        for list in &mut nodes {
            list.sort_unstable();
            list.dedup();
        }
        // The start of each list; filling advances it to the end.
        let mut start = 0;
        for end in &mut ends {
            (*end, start) = (start, start + *end);
        }
        let mut cells = vec![(0, 0); start];
        for (b, block) in mesh.blocks.iter().enumerate() {
            for (c, cell) in block.cells().enumerate() {
                for &node in cell {
                    cells[ends[node as usize]] = (b as u32, c as u32);
                    ends[node as usize] += 1;
                }
            }
        }
        let points = mesh.blocks.iter().map(|block| sampling(block.element)).collect();
        let most = mesh.blocks.iter().map(|block| block.element.degree).max().unwrap_or(0);
        let exponents = (0..=most.max(1)).map(|degree| exponents(mesh.dim, degree)).collect();
        Recovery { mesh, cells, ends, nodes, boundary: mesh.region_boundaries(), points, exponents }
    }

    fn element(&self, block: u32) -> &'static Element {
        self.mesh.blocks[block as usize].element
    }

    fn nodes_of(&self, (block, cell): (u32, u32)) -> &'m [u32] {
        let block = &self.mesh.blocks[block as usize];
        let n = block.element.nodes.len();
        &block.nodes[cell as usize * n..(cell as usize + 1) * n]
    }

    fn vertices_of(&self, cell: (u32, u32)) -> &'m [u32] {
        &self.nodes_of(cell)[..self.element(cell.0).shape.vertices()]
    }

    /// Cells of a region at a node.
    fn around(&self, region: usize, node: u32) -> impl Iterator<Item = (u32, u32)> {
        let node = node as usize;
        let start = if node == 0 { 0 } else { self.ends[node - 1] };
        self.cells[start..self.ends[node]]
            .iter()
            .copied()
            .filter(move |&(block, _)| self.mesh.blocks[block as usize].region == region)
    }

    fn is_inner(&self, region: usize, node: u32) -> bool {
        self.boundary.get(region).is_some_and(|nodes| nodes.binary_search(&node).is_err())
    }

    /// The vertices whose patches give the value of a node.
    fn centres(&self, region: usize, node: u32) -> Vec<u32> {
        let cells: Vec<(u32, u32)> = self.around(region, node).collect();
        if self.is_inner(region, node) && cells.first().is_some_and(|&cell| self.vertices_of(cell).contains(&node)) {
            return vec![node];
        }
        let inner =
            |set: &BTreeSet<u32>| set.iter().copied().filter(|&v| self.is_inner(region, v)).collect::<Vec<u32>>();
        let all: BTreeSet<u32> = cells.iter().flat_map(|&cell| self.vertices_of(cell)).copied().collect();
        // The vertices of the edge, face or cell that has the node in its middle.
        let common: BTreeSet<u32> =
            all.iter().copied().filter(|v| cells.iter().all(|&cell| self.vertices_of(cell).contains(v))).collect();
        let next = || {
            all.iter().flat_map(|&v| self.around(region, v)).flat_map(|cell| self.vertices_of(cell)).copied().collect()
        };
        [inner(&common), inner(&all)].into_iter().find(|centres| !centres.is_empty()).unwrap_or_else(|| inner(&next()))
    }

    /// The value at a node of a region.
    pub fn stencil(&self, region: usize, node: u32) -> Stencil {
        let fits: Vec<Patch> =
            self.centres(region, node).into_iter().map(|centre| self.patch(region, centre)).collect();
        self.mean(region, node, &fits.iter().collect::<Vec<_>>())
    }

    /// The values at some nodes of a region, which share the patches around its inner vertices.
    fn stencils(&self, region: usize, nodes: &[u32]) -> Vec<Stencil> {
        let centres: Vec<Vec<u32>> = nodes.iter().map(|&node| self.centres(region, node)).collect();
        let mut all: Vec<u32> = centres.iter().flatten().copied().collect();
        all.sort_unstable();
        all.dedup();
        let fits: Vec<Patch> = all.iter().map(|&centre| self.patch(region, centre)).collect();
        let fit = |centre: &u32| all.binary_search(centre).ok().and_then(|place| fits.get(place));
        let at = |(&node, centres): (&u32, &Vec<u32>)| {
            self.mean(region, node, &centres.iter().filter_map(fit).collect::<Vec<_>>())
        };
        nodes.iter().zip(&centres).map(at).collect()
    }

    /// The fit around a vertex inside a region.
    fn patch(&self, region: usize, centre: u32) -> Patch<'_> {
        self.fit(&self.around(region, centre).collect::<Vec<_>>(), centre).0
    }

    /// The mean of some fits at a node; without any, a fit around the node itself.
    fn mean(&self, region: usize, node: u32, fits: &[&Patch]) -> Stencil {
        let x = &self.mesh.points[node as usize];
        let mut terms = Stencil::new();
        let mut add = |(samples, fit): &Patch, share: f64| {
            terms
                .extend(samples.iter().copied().zip(fit.bounded_weights(x, &MOST).iter().map(|weight| share * weight)));
        };
        for fit in fits {
            add(fit, 1.0 / fits.len() as f64);
        }
        if fits.is_empty() {
            add(&self.own_fit(region, node), 1.0);
        }
        // Samples of one patch are in ascending order already.
        if fits.len() > 1 {
            terms.sort_by_key(|(sample, _)| *sample);
            terms.dedup_by(|(next, weight), (sample, sum)| {
                let is_same = next == sample;
                if is_same {
                    *sum += *weight;
                }
                is_same
            });
        }
        terms
    }

    /// The fit around a node without an inner vertex near it: over its cells, and over their neighbours until their
    /// points determine the polynomial.
    fn own_fit(&self, region: usize, node: u32) -> Patch<'_> {
        let mut cells: Vec<(u32, u32)> = self.around(region, node).collect();
        let mut fit = self.fit(&cells, node);
        for _ in 0..GROWTH {
            if fit.1 {
                break;
            }
            let nodes = cells.iter().flat_map(|&cell| self.nodes_of(cell));
            let grown: BTreeSet<(u32, u32)> = nodes.flat_map(|&n| self.around(region, n)).collect();
            cells = grown.into_iter().collect();
            fit = self.fit(&cells, node);
        }
        fit.0
    }

    /// The fit over some cells, ascending, about a node, and true if their points determine it.
    fn fit(&self, cells: &[(u32, u32)], about: u32) -> (Patch<'_>, bool) {
        let (mut samples, mut points) = (Vec::new(), Vec::new());
        let mut values = Vec::new();
        for &cell in cells {
            let (element, nodes) = (self.element(cell.0), self.nodes_of(cell));
            values.resize(nodes.len(), 0.0);
            for (q, at) in self.points[cell.0 as usize].points.iter().enumerate() {
                (element.shape_functions)(at, &mut values);
                let mut x = [0.0; 3];
                for (&node, value) in nodes.iter().zip(&values) {
                    for (x, p) in x.iter_mut().zip(&self.mesh.points[node as usize]) {
                        *x += value * p;
                    }
                }
                samples.push((cell.0, cell.1, q as u32));
                points.push(x);
            }
        }
        let degree = cells.iter().map(|cell| self.element(cell.0).degree).min().unwrap_or(1);
        let (fit, is_determined) = Fit::new(&self.exponents[degree], &self.mesh.points[about as usize], &points);
        ((samples, fit), is_determined)
    }
}
