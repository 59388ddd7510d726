//! The elements of a file, of all dimensions, and their conversion to a mesh.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::overlap::Overlap;
use super::serendipity::complete;
use super::{FilePosition, MeshFile, MeshFileError, Skipped};
use crate::element::{self, Element};
use crate::mesh::topology::{SortedFacet, key};
use crate::mesh::{Block, FacetSet, Mesh};
use crate::tensor::{Point, dot};

/// Name of the only region of a body without groups.
const BODY: &str = "body";
/// Name of the only side of a body without named sides.
const BOUNDARY: &str = "boundary";
/// Largest extent across a plane body, relative to its largest extent: the rounding of coordinates in a file.
const FLAT: f64 = 1e-9;

/// A type of element in a file.
#[derive(Clone, Copy, Debug)]
pub(in crate::mesh) struct Kind {
    pub name: &'static str,
    pub dim: usize,
    /// Number of nodes in the file.
    pub nodes: usize,
    /// The element of the library, if it has one; it may have further nodes in the middle of faces and cell.
    pub element: Option<&'static Element>,
}

/// Elements of one type with the same groups.
#[derive(Clone, Debug)]
pub(in crate::mesh) struct LooseBlock {
    pub kind: Kind,
    /// Tags of the groups.
    pub groups: BTreeSet<i64>,
    /// Position in the file: a byte, or a cell of a grid.
    pub at: usize,
    /// Nodes, in the order of the library if it has the element.
    pub nodes: Vec<u32>,
    /// Numbers of the elements in the file, if data refer to them.
    pub numbers: Vec<i64>,
}

impl LooseBlock {
    fn len(&self) -> usize {
        self.nodes.len() / self.kind.nodes.max(1)
    }
}

/// A named node set.
#[derive(Clone, Debug)]
pub(in crate::mesh) struct NodeSet {
    pub name: String,
    pub nodes: BTreeSet<u32>,
}

/// The contents of a file.
#[derive(Clone, Debug, Default)]
pub(in crate::mesh) struct Loose {
    pub points: Vec<Point>,
    pub blocks: Vec<LooseBlock>,
    /// Names of groups by dimension and tag.
    pub names: BTreeMap<(usize, i64), String>,
    /// Node sets from which sides, edges or points are made.
    pub node_sets: Vec<NodeSet>,
    /// Skipped contents of the file.
    pub skipped: Vec<Skipped>,
}

impl Loose {
    fn name(&self, dim: usize, group: i64) -> String {
        self.names.get(&(dim, group)).cloned().unwrap_or_else(|| group.to_string())
    }

    /// The mesh of the elements of the highest dimension, with the groups of the next lower one as its sides.
    pub(in crate::mesh) fn into_read(
        mut self,
        place: impl Fn(usize) -> FilePosition,
    ) -> Result<MeshFile, MeshFileError> {
        self.blocks.retain(|block| !block.nodes.is_empty());
        let dim = self.dim();
        if dim == 0 {
            let points: usize = self.blocks.iter().map(LooseBlock::len).sum();
            return Err(MeshFileError::Empty {
                found: format!("{} nodes and {points} points as elements", self.points.len()),
            });
        }
        self.resolve_node_sets();
        complete(&mut self.points, &mut self.blocks);
        let (cells, rest): (Vec<_>, Vec<_>) =
            std::mem::take(&mut self.blocks).into_iter().partition(|block| block.kind.dim == dim);
        self.flatten(dim, &cells)?;
        let (regions, blocks) = self.regions(dim, &cells, &place)?;
        let facets = self.sides(dim, &rest, &place)?;
        let edges = self.edges(dim, &cells, &rest, &place)?;
        let mut mesh =
            Mesh { dim, points: self.points, blocks, regions, facets, edges, axisymmetric: false, thickness: None };
        orient(&mut mesh);
        drop_unused(&mut mesh);
        if mesh.facets.is_empty() {
            mesh.facets.insert(BOUNDARY.to_owned(), mesh.boundary());
        }
        Ok(MeshFile { mesh, plane: None, skipped: self.skipped, whole: None })
    }

    /// Sets coordinates beyond the dimension to zero; fails if they are not constant on the body.
    fn flatten(&mut self, dim: usize, cells: &[LooseBlock]) -> Result<(), MeshFileError> {
        if dim == 3 {
            return Ok(());
        }
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &node in cells.iter().flat_map(|block| &block.nodes) {
            for d in 0..3 {
                low[d] = low[d].min(self.points[node as usize][d]);
                high[d] = high[d].max(self.points[node as usize][d]);
            }
        }
        let largest = (0..3).map(|d| high[d] - low[d]).fold(0.0, f64::max);
        for d in dim..3 {
            if high[d] - low[d] > FLAT * largest {
                let plane = if dim == 2 { "plane z = 0" } else { "line y = z = 0" };
                return Err(MeshFileError::NotFlat {
                    dim,
                    axis: ['x', 'y', 'z'][d],
                    low: low[d],
                    high: high[d],
                    plane,
                });
            }
            for point in &mut self.points {
                point[d] = 0.0;
            }
        }
        Ok(())
    }

    /// Names of the regions in the order of their tags, and the cells by region and element. Cells of several groups
    /// are assigned by [`Overlap`].
    fn regions(
        &mut self,
        dim: usize,
        cells: &[LooseBlock],
        place: &impl Fn(usize) -> FilePosition,
    ) -> Result<(Vec<String>, Vec<Block>), MeshFileError> {
        let mut names: Vec<String> = Vec::new();
        let mut numbers: HashMap<i64, usize> = HashMap::new();
        for &group in cells.iter().flat_map(|block| &block.groups).collect::<BTreeSet<_>>() {
            let name = self.name(dim, group);
            let known = names.iter().position(|other| *other == name);
            numbers.insert(group, known.unwrap_or(names.len()));
            if known.is_none() {
                names.push(name);
            }
        }
        let bare: Vec<&LooseBlock> = cells.iter().filter(|block| block.groups.is_empty()).collect();
        if names.is_empty() {
            names.push(BODY.to_owned());
        } else if let Some(first) = bare.first() {
            let (found, of) = (bare.iter().map(|b| b.len()).sum(), cells.iter().map(LooseBlock::len).sum());
            return Err(MeshFileError::NoRegion { at: place(first.at), found, of, dim });
        }
        let of_block = |block: &LooseBlock| -> BTreeSet<usize> {
            block.groups.iter().filter_map(|group| numbers.get(group).copied()).collect()
        };
        let overlap = Overlap::new(names, cells.iter().map(|block| (of_block(block), block.len())));
        self.skipped.extend(overlap.told());
        let mut blocks: Vec<Block> = Vec::new();
        for loose in cells {
            let element = supported(loose, place)?;
            let region = overlap.region(&of_block(loose));
            let mut nodes = loose.nodes.clone();
            if mirrored(&self.points, dim, element, &nodes) {
                turn_over(element, &mut nodes);
            }
            match blocks.iter_mut().find(|b| b.region == region && std::ptr::eq(b.element, element)) {
                Some(block) => block.nodes.append(&mut nodes),
                None => blocks.push(Block { element, region, nodes }),
            }
        }
        blocks.sort_by_key(|block| block.region);
        Ok((overlap.into_regions(), blocks))
    }

    /// The named edges and points of the body whose name is not that of a side.
    fn edges(
        &self,
        dim: usize,
        cells: &[LooseBlock],
        rest: &[LooseBlock],
        place: &impl Fn(usize) -> FilePosition,
    ) -> Result<BTreeMap<String, FacetSet>, MeshFileError> {
        let mut of_body = vec![false; self.points.len()];
        for &node in cells.iter().flat_map(|block| &block.nodes) {
            of_body[node as usize] = true;
        }
        let mut edges = BTreeMap::new();
        for below in (1..dim).rev() {
            for (name, set) in self.sides(below, rest, place)? {
                let mut inside = FacetSet::default();
                for (element, nodes) in set.facets().filter(|(_, nodes)| nodes.iter().all(|&n| of_body[n as usize])) {
                    inside.push(element, nodes.iter().copied());
                }
                if !inside.is_empty() {
                    edges.entry(name).or_insert(inside);
                }
            }
        }
        Ok(edges)
    }

    /// The named sets of elements of dimension `above` − 1 without repetition, ordered and oriented as in the file.
    fn sides(
        &self,
        above: usize,
        rest: &[LooseBlock],
        place: &impl Fn(usize) -> FilePosition,
    ) -> Result<BTreeMap<String, FacetSet>, MeshFileError> {
        let mut sides: BTreeMap<String, (FacetSet, BTreeSet<SortedFacet>)> = BTreeMap::new();
        for loose in rest.iter().filter(|block| block.kind.dim + 1 == above && !block.groups.is_empty()) {
            let element = supported(loose, place)?;
            let names: BTreeSet<String> = loose.groups.iter().map(|&group| self.name(above - 1, group)).collect();
            for name in names {
                let (side, seen) = sides.entry(name).or_insert_with(|| (FacetSet::default(), BTreeSet::new()));
                for nodes in loose.nodes.chunks_exact(loose.kind.nodes) {
                    if seen.insert(key(nodes.iter().copied())) {
                        side.push(element, nodes.iter().copied());
                    }
                }
            }
        }
        Ok(sides.into_iter().map(|(name, (side, _))| (name, side)).collect())
    }
}

fn supported(block: &LooseBlock, place: &impl Fn(usize) -> FilePosition) -> Result<&'static Element, MeshFileError> {
    block.kind.element.ok_or_else(|| {
        let known: Vec<&str> = element::ALL.iter().filter(|e| e.dim() == block.kind.dim).map(|e| e.name).collect();
        MeshFileError::Element { at: place(block.at), found: block.kind.name.to_owned(), known: known.join(", ") }
    })
}

/// True if every cell has a negative determinant at its centre.
fn mirrored(points: &[Point], dim: usize, element: &Element, nodes: &[u32]) -> bool {
    let mut gradients = [[0.0; 3]; element::MAX_NODES];
    (element.gradients)(&element.centre(), &mut gradients[..element.nodes.len()]);
    nodes.chunks_exact(element.nodes.len()).all(|cell| {
        let mut j = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for row in 0..dim {
            j[row] = std::array::from_fn(|col| {
                cell.iter().zip(&gradients).map(|(&n, g)| points[n as usize][row] * g[col]).sum()
            });
        }
        let [u, v, w] = j;
        dot(&u, &[v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]]) < 0.0
    })
}

/// Mirrors cells by the symmetry of their reference cell: exchanges its first two axes, or the ends of a segment.
fn turn_over(element: &Element, nodes: &mut [u32]) {
    let mirror = |x: &Point| if element.dim() == 1 { [1.0 - x[0], 0.0, 0.0] } else { [x[1], x[0], x[2]] };
    let distance = |a: &Point, b: &Point| (0..3).map(|d| (a[d] - b[d]).abs()).sum::<f64>();
    let partner = |at: &Point| element.nodes.iter().position(|x| distance(x, at) < 1e-9);
    let Some(partners) = element.nodes.iter().map(|x| partner(&mirror(x))).collect::<Option<Vec<usize>>>() else {
        return;
    };
    for cell in nodes.chunks_exact_mut(element.nodes.len()) {
        let old = cell.to_vec();
        for (node, &partner) in cell.iter_mut().zip(&partners) {
            *node = old[partner];
        }
    }
}

/// Orders the nodes of every side facet as in the first cell that has it, hence oriented outward.
fn orient(mesh: &mut Mesh) {
    let mut on_side = vec![false; mesh.points.len()];
    let mut wanted: HashMap<SortedFacet, Vec<(usize, usize)>> = HashMap::new();
    let listed = |set: &FacetSet| set.facets().map(|(element, nodes)| (element, nodes.to_vec())).collect::<Vec<_>>();
    let mut oriented: Vec<Vec<(&'static Element, Vec<u32>)>> = mesh.facets.values().map(listed).collect();
    for (s, side) in oriented.iter().enumerate() {
        for (f, (_, nodes)) in side.iter().enumerate() {
            wanted.entry(key(nodes.iter().copied())).or_default().push((s, f));
            for &node in nodes {
                on_side[node as usize] = true;
            }
        }
    }
    for block in &mesh.blocks {
        for cell in block.cells() {
            for facet in block.element.facets {
                if facet.nodes.iter().all(|&n| on_side[cell[n] as usize]) {
                    let nodes = facet.nodes.iter().map(|&n| cell[n]);
                    for (s, f) in wanted.remove(&key(nodes.clone())).unwrap_or_default() {
                        oriented[s][f] = (facet.element, nodes.clone().collect());
                    }
                }
            }
        }
    }
    for (set, facets) in mesh.facets.values_mut().zip(oriented) {
        set.blocks.clear();
        for (element, nodes) in facets {
            set.push(element, nodes);
        }
    }
}

/// Removes nodes without a cell or side; the others keep their order.
fn drop_unused(mesh: &mut Mesh) {
    let mut index = vec![u32::MAX; mesh.points.len()];
    let sides =
        mesh.facets.values().chain(mesh.edges.values()).flat_map(|set| &set.blocks).flat_map(|block| &block.nodes);
    for &node in mesh.blocks.iter().flat_map(|block| &block.nodes).chain(sides) {
        index[node as usize] = 0;
    }
    let mut kept = Vec::with_capacity(mesh.points.len());
    for (index, point) in index.iter_mut().zip(&mesh.points) {
        if *index == 0 {
            *index = kept.len() as u32;
            kept.push(*point);
        }
    }
    mesh.points = kept;
    let sets = mesh.facets.values_mut().chain(mesh.edges.values_mut());
    let sides = sets.flat_map(|set| &mut set.blocks).flat_map(|block| &mut block.nodes);
    for node in mesh.blocks.iter_mut().flat_map(|block| &mut block.nodes).chain(sides) {
        *node = index[*node as usize];
    }
}
