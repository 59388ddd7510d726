//! Conversions of meshes: linear to quadratic, plane sections to bodies, prisms to simplices.

use std::collections::{BTreeMap, HashMap};

use super::generate::check;
use super::{Block, FacetSet, Mesh, MeshError};
use crate::element::{Element, P1_PRISM, P1_SEGMENT, P1_TETRAHEDRON, P1_TRIANGLE, Q1_HEXAHEDRON, Q1_QUADRILATERAL};
use crate::quadrature::Shape;
use crate::tensor::Point;

/// Vertices whose mean is a middle node, ascending; unused entries hold `u32::MAX`.
type Middle = [u32; 8];

/// The quadratic element that corresponds to a linear one, with the local vertices whose mean is each middle node.
pub(super) fn quadratic_of(element: &'static Element) -> Result<(&'static Element, Vec<Vec<usize>>), MeshError> {
    let missing = MeshError::Elements { what: "a quadratic mesh", found: element.name };
    if element.shape == Shape::Point {
        return Ok((element, Vec::new()));
    }
    let quadratic = Element::find(element.shape, 2).filter(|_| element.degree == 1).ok_or(missing)?;
    let mut values = vec![0.0; element.nodes.len()];
    let middles = quadratic.nodes[element.nodes.len()..].iter().map(|x| {
        (element.shape_functions)(x, &mut values);
        (0..values.len()).filter(|&i| values[i] > 1e-9).collect()
    });
    Ok((quadratic, middles.collect()))
}

/// The mean of some points.
fn mean(points: &[Point]) -> Point {
    std::array::from_fn(|d| points.iter().map(|p| p[d]).sum::<f64>() / points.len() as f64)
}

impl Mesh {
    /// The mesh with quadratic elements: middle nodes are the means of the vertices of their edge, face or cell. The
    /// linear nodes keep their numbers.
    ///
    /// # Errors
    /// [`MeshError::Elements`] if a cell is not linear, or has no quadratic element here; [`MeshError::TooLarge`].
    pub fn quadratic(&self) -> Result<Mesh, MeshError> {
        self.quadratic_by(|_, points| mean(points))
    }

    /// [`Mesh::quadratic`] with middle nodes placed by a function of the vertices and their positions.
    pub(super) fn quadratic_by(&self, place: impl Fn(&[u32], &[Point]) -> Point) -> Result<Mesh, MeshError> {
        let mut points = self.points.clone();
        let mut known: HashMap<Middle, u32> = HashMap::new();
        let mut convert =
            |element: &'static Element, nodes: &[u32]| -> Result<(&'static Element, Vec<u32>), MeshError> {
                let (quadratic, middles) = quadratic_of(element)?;
                let mut out = Vec::with_capacity(nodes.len() / element.nodes.len() * quadratic.nodes.len());
                for cell in nodes.chunks_exact(element.nodes.len()) {
                    out.extend_from_slice(cell);
                    for middle in &middles {
                        let mut key = [u32::MAX; 8];
                        for (slot, &i) in key.iter_mut().zip(middle) {
                            *slot = cell[i];
                        }
                        key.sort_unstable();
                        out.push(*known.entry(key).or_insert_with(|| {
                            let vertices = &key[..middle.len()];
                            let corners: Vec<Point> = vertices.iter().map(|&n| self.points[n as usize]).collect();
                            points.push(place(vertices, &corners));
                            points.len() as u32 - 1
                        }));
                    }
                }
                Ok((quadratic, out))
            };
        let mut blocks = Vec::new();
        for block in &self.blocks {
            let (element, nodes) = convert(block.element, &block.nodes)?;
            blocks.push(Block { element, region: block.region, nodes });
        }
        let mut of_sets = |sets: &BTreeMap<String, FacetSet>| {
            let mut all = BTreeMap::new();
            for (name, set) in sets {
                let mut converted = FacetSet::default();
                for block in &set.blocks {
                    let (element, nodes) = convert(block.element, &block.nodes)?;
                    converted.push(element, nodes);
                }
                all.insert(name.clone(), converted);
            }
            Ok(all)
        };
        let (facets, edges) = (of_sets(&self.facets)?, of_sets(&self.edges)?);
        if points.len() > u32::MAX as usize {
            return Err(MeshError::TooLarge { found: points.len() as f64 });
        }
        Ok(Mesh { points, blocks, facets, edges, regions: self.regions.clone(), ..*self })
    }

    /// The body swept by a plane mesh of linear elements along z from 0 to `height`, in `layers` of cells: prisms from
    /// triangles and hexahedra from quadrilaterals. Sides keep their names; `ends` are the sides at 0 and at `height`.
    ///
    /// # Errors
    /// Fails if the height is not positive and finite, if there are no layers, or if the mesh is too large or not a
    /// linear one with d = 2.
    pub fn extruded(&self, height: f64, layers: usize, ends: [&str; 2]) -> Result<Mesh, MeshError> {
        let size = self.points.len();
        check(&[height], &[layers], size as f64 * (layers as f64 + 1.0)).map_err(|error| match error {
            MeshError::Size { found, .. } => MeshError::Size { direction: 2, found },
            MeshError::Cells { found, .. } => MeshError::Cells { direction: 2, found },
            other => other,
        })?;
        let up = |nodes: &[u32], layer: usize| nodes.iter().map(|&n| n + (layer * size) as u32).collect::<Vec<u32>>();
        let points = (0..=layers)
            .flat_map(|l| self.points.iter().map(move |p| [p[0], p[1], height * (l as f64 / layers as f64)]))
            .collect();
        let (mut blocks, mut bottom, mut top) = (Vec::new(), FacetSet::default(), FacetSet::default());
        for block in &self.blocks {
            let element = match block.element.shape {
                Shape::Triangle => &P1_PRISM,
                _ => &Q1_HEXAHEDRON,
            };
            if self.dim != 2 || 2 * block.element.nodes.len() != element.nodes.len() {
                return Err(MeshError::Elements { what: "extrusion", found: block.element.name });
            }
            let mut nodes = Vec::with_capacity(2 * layers * block.nodes.len());
            for l in 0..layers {
                for cell in block.cells() {
                    nodes.extend(up(cell, l));
                    nodes.extend(up(cell, l + 1));
                }
            }
            for cell in block.cells() {
                // The lower end is mirrored so that its facets face outward.
                let mut mirrored = cell.to_vec();
                mirrored[1..].reverse();
                bottom.push(block.element, mirrored);
                top.push(block.element, up(cell, layers));
            }
            blocks.push(Block { element, region: block.region, nodes });
        }
        let mut facets = BTreeMap::from([(ends[0].to_owned(), bottom), (ends[1].to_owned(), top)]);
        for (name, set) in &self.facets {
            let mut swept = FacetSet::default();
            for l in 0..layers {
                for (_, edge) in set.facets() {
                    let (low, high) = (up(edge, l), up(edge, l + 1));
                    swept.push(&Q1_QUADRILATERAL, [low[0], low[1], high[1], high[0]]);
                }
            }
            facets.insert(name.clone(), swept);
        }
        let points_of = |set: &FacetSet| set.node_list().into_iter();
        let line = |node: u32| (0..layers).flat_map(move |l| [l, l + 1].map(|l| node + (l * size) as u32));
        let swept = |set: &FacetSet| FacetSet::of(&P1_SEGMENT, points_of(set).flat_map(line).collect());
        let edges = self.edges.iter().map(|(name, set)| (name.clone(), swept(set))).collect();
        Ok(Mesh {
            dim: 3,
            axisymmetric: false,
            thickness: None,
            points,
            blocks,
            regions: self.regions.clone(),
            facets,
            edges,
        })
    }

    /// The mesh split into simplices: a quadrilateral becomes two triangles, a prism three tetrahedra. Every
    /// quadrilateral face is split through its lowest-numbered vertex, so that neighbours fit (Dompierre, Labbé,
    /// Vallet, Camarero, 1999).
    ///
    /// # Errors
    /// [`MeshError::Elements`] for cells other than linear quadrilaterals, prisms and simplices.
    pub fn simplices(&self) -> Result<Mesh, MeshError> {
        let mut blocks = Vec::new();
        for block in &self.blocks {
            let mut nodes = Vec::new();
            let element = match (block.element.shape, block.element.degree) {
                (Shape::Quadrilateral, 1) => {
                    block.cells().for_each(|cell| nodes.extend(triangles(cell)));
                    &P1_TRIANGLE
                }
                (Shape::Prism, 1) => {
                    block.cells().for_each(|cell| nodes.extend(tetrahedra(cell)));
                    &P1_TETRAHEDRON
                }
                _ if block.element.is_simplex() => {
                    nodes.clone_from(&block.nodes);
                    block.element
                }
                _ => return Err(MeshError::Elements { what: "a mesh of simplices", found: block.element.name }),
            };
            blocks.push(Block { element, region: block.region, nodes });
        }
        let cut = |set: &FacetSet| {
            let mut cut = FacetSet::default();
            for (element, nodes) in set.facets() {
                if (element.shape, element.degree) == (Shape::Quadrilateral, 1) {
                    cut.push(&P1_TRIANGLE, triangles(nodes));
                } else {
                    cut.push(element, nodes.iter().copied());
                }
            }
            cut
        };
        let facets = self.facets.iter().map(|(name, set)| (name.clone(), cut(set))).collect();
        Ok(Mesh {
            points: self.points.clone(),
            blocks,
            facets,
            edges: self.edges.clone(),
            regions: self.regions.clone(),
            ..*self
        })
    }
}

/// The two triangles of a quadrilateral, split through its lowest-numbered vertex.
fn triangles(cell: &[u32]) -> [u32; 6] {
    let first = (0..4).min_by_key(|&i| cell[i]).unwrap_or(0);
    let [a, b, c, d] = std::array::from_fn(|i| cell[(first + i) % 4]);
    [a, b, c, a, c, d]
}

/// The three tetrahedra of a prism, each of its quadrilateral faces split through its lowest-numbered vertex.
fn tetrahedra(cell: &[u32]) -> [u32; 12] {
    const TURNED: [[usize; 6]; 6] = [
        [0, 1, 2, 3, 4, 5],
        [1, 2, 0, 4, 5, 3],
        [2, 0, 1, 5, 3, 4],
        [3, 5, 4, 0, 2, 1],
        [4, 3, 5, 1, 0, 2],
        [5, 4, 3, 2, 1, 0],
    ];
    let first = (0..6).min_by_key(|&i| cell[i]).unwrap_or(0);
    let [a, b, c, d, e, f] = TURNED[first].map(|i| cell[i]);
    if b.min(f) < c.min(e) { [a, b, c, f, a, b, f, e, a, e, f, d] } else { [a, b, c, e, a, e, c, f, a, e, f, d] }
}
