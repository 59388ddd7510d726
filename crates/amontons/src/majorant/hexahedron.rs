//! The complementary energy of a parallelepiped in the tractions on its facets.
//!
//! The stress in balance is a combination of those of the cube; the fields without load and without tractions outside
//! take the amounts that make the energy least. The discrete stress is a polynomial of the degree of the element, known
//! by its values at the nodes. Its linear part is in balance with its own tractions and a constant load. The energy
//! depends on the rest of the stress, of the load, and of the tractions. Nothing cancels where these are small.
//!
//! A stiffness that varies is that of the centre here, which makes the number an estimate.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

use super::composite::SimplexMap;
use super::cube::{CubeStresses, NodalProducts, OUTER};
use super::dense::{Semidefinite, product};
use super::modes::{FacetModes, MOST};
use super::parallelogram::{MOMENTS, PieceMoments, bilinear_products};
use super::skeleton::Skeleton;
use super::stress::{LocalCompliance, StepLaws, StepMotion};
use crate::element::{Q1_HEXAHEDRON, ShapeTable};
use crate::mesh::CellMap;
use crate::tensor::{Point, Sym};

/// Moments of the tractions on a facet.
const PER_FACET: usize = OUTER / 6;
/// Components of the tractions on all facets.
const ALL: usize = 6 * MOST;

/// What the shapes of parallelepipeds are made of.
#[derive(Debug)]
pub(super) struct CubeProducts<'a> {
    pub stresses: &'a CubeStresses,
    pub pieces: &'a PieceMoments,
    /// Those of the element of the cell.
    pub nodal: &'a NodalProducts,
}

/// What parallelepipeds of one shape share.
#[derive(Debug)]
pub(super) struct HexahedronShape {
    /// G in the components of the tractions on the facets.
    pub gram: Vec<f64>,
    /// The slopes in these components per component of the load, and per component of the stress at each node.
    slopes: Vec<f64>,
    /// The energy in the load and the stress at the nodes: ½ d·K d.
    own: Vec<f64>,
    map: SimplexMap,
    /// The vertex of the cell by facet and slot.
    corners: [[usize; 4]; 6],
}

/// The linear part of a stress.
struct LinearStress {
    /// The stress in the middle.
    middle: Sym,
    /// The change along each edge.
    changes: [Sym; 3],
}

impl LinearStress {
    /// The linear part of a stress with these values at the nodes, of which the first are the vertices.
    fn new(values: &[Sym]) -> LinearStress {
        let weighted = |weight: &dyn Fn(&Point) -> f64| {
            let vertices = Q1_HEXAHEDRON.nodes.iter().zip(values);
            vertices.fold(Sym::ZERO, |sum, (x, value)| sum + weight(x) * *value)
        };
        let change = |c: usize| weighted(&|x: &Point| 0.5 * (x[c] - 0.5));
        LinearStress { middle: weighted(&|_| 0.125), changes: [change(0), change(1), change(2)] }
    }

    /// The stress at a point of the cube.
    fn at(&self, x: &Point) -> Sym {
        self.changes.iter().zip(x).fold(self.middle, |sum, (change, x)| sum + (x - 0.5) * *change)
    }
}

impl HexahedronShape {
    /// The shape of a cell; `None` if its stiffness is not positive definite.
    pub fn new(laws: &StepLaws, skeleton: &Skeleton, cell: usize, cube: &CubeProducts) -> Option<HexahedronShape> {
        let nodes = skeleton.nodes(laws.mesh, cell);
        let at = |vertex: usize| laws.mesh.points[nodes[vertex] as usize];
        let map = SimplexMap::new(3, &[at(0), at(1), at(3), at(4)]);
        let centre = std::array::from_fn(|c| (0..8).map(|vertex| 0.125 * at(vertex)[c]).sum());
        let compliance = laws.compliance(laws.region(skeleton, cell), &centre)?;
        let facets = &skeleton.cells[cell].facets;
        let corner = |f: usize, slot: usize| skeleton.corner(laws.mesh, (cell, facets[f]), slot);
        let corners: [[usize; 4]; 6] = std::array::from_fn(|f| std::array::from_fn(|slot| corner(f, slot)));
        let of_facet =
            |(f, &facet): (usize, &usize)| block(&skeleton.modes[facet], (f, &corners[f]), &map, cube.pieces);
        let blocks: Vec<Vec<f64>> = facets.iter().enumerate().map(of_facet).collect();
        let rows = data_rows(cube, &map, &compliance, &blocks);
        let whole = least(cube, &rows, &map, (&compliance, &blocks));
        let size = ALL + 3 + 6 * cube.nodal.count;
        let part = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| -> Vec<f64> {
            whole[rows.start * size..rows.end * size]
                .chunks_exact(size)
                .flat_map(|row| row[columns.clone()].iter().copied())
                .collect()
        };
        let (gram, slopes, own) = (part(0..ALL, 0..ALL), part(ALL..size, 0..ALL), part(ALL..size, ALL..size));
        Some(HexahedronShape { gram, slopes, own, map, corners })
    }

    /// The moments, by facet and slot, of the tractions of the linear part of the discrete stress; and where the
    /// tractions are these, the slopes of the energy in their components, and its value. The load is in N/m³.
    pub fn affine(
        &self,
        (laws, motion): (&StepLaws, &StepMotion),
        (region, nodes): (usize, &[u32]),
        load: &Point,
        table: &ShapeTable,
    ) -> ([[Point; 4]; 6], Vec<f64>, f64) {
        let mut at = CellMap::new(laws.mesh, table);
        let values: Vec<Sym> = (0..table.len())
            .map(|q| {
                at.at(nodes, q);
                laws.at(region, &at, nodes, motion)
            })
            .collect();
        let linear = LinearStress::new(&values);
        let divergence = |c: usize| {
            let along = |(k, change): (usize, &Sym)| change.apply(&self.map.gradient(k + 1))[c];
            linear.changes.iter().enumerate().map(along).sum::<f64>()
        };
        let mut data: Vec<f64> = (0..3).map(|c| load[c] + divergence(c)).collect();
        for (value, x) in values.iter().zip(table_nodes(table)) {
            data.extend((*value - linear.at(x)).0);
        }
        let mut slopes = vec![0.0; ALL];
        for (row, x) in self.slopes.chunks_exact(ALL).zip(&data) {
            slopes.iter_mut().zip(row).for_each(|(sum, slope)| *sum += x * slope);
        }
        let images = self.own.chunks_exact(data.len()).map(|row| product(row, &data));
        let energy = 0.5 * images.zip(&data).map(|(image, x)| image * x).sum::<f64>();
        (std::array::from_fn(|f| self.tractions(f, &linear)), slopes, energy)
    }

    /// The moments of the tractions of a linear stress on a facet, by slot.
    fn tractions(&self, f: usize, linear: &LinearStress) -> [Point; 4] {
        let corners = self.corners[f].map(|vertex| Q1_HEXAHEDRON.nodes[vertex]);
        // The coordinate of the cube that is 0 or 1 on the facet.
        let across = (0..3).find(|&c| corners.iter().all(|x| (x[c] - corners[0][c]).abs() < 0.5)).unwrap_or(0);
        let outward = self.map.determinant * (2.0 * corners[0][across] - 1.0);
        let area = self.map.gradient(across + 1).map(|c| outward * c);
        let tractions = corners.map(|x| linear.at(&x).apply(&area));
        let moment = |slot: usize| -> Point {
            std::array::from_fn(|c| (0..4).map(|other| bilinear_products(slot, other) * tractions[other][c]).sum())
        };
        std::array::from_fn(moment)
    }
}

/// The reference coordinates of the nodes at which the stress is known.
fn table_nodes(table: &ShapeTable) -> &'static [Point] {
    table.element.nodes
}

/// The moments in the cube of the tractions on a facet, per component of these: row by row.
fn block(modes: &FacetModes, (f, corners): (usize, &[usize; 4]), map: &SimplexMap, pieces: &PieceMoments) -> Vec<f64> {
    let own = Q1_HEXAHEDRON.facets[f].nodes;
    let place = |slot: usize| own.iter().position(|vertex| *vertex == corners[slot % 4]).unwrap_or(0);
    let mut block = vec![0.0; PER_FACET * MOST];
    for column in 0..MOST {
        let mut y = [0.0; MOST];
        y[column] = 1.0;
        let moments = modes.moments(&y);
        let parts: Vec<Point> = modes.further(&y).skip(1).collect();
        for at in 0..MOMENTS {
            let (triangle, slot) = (at / 3, at % 3);
            // The facet of the cell may go round in the other sense.
            let (first, second) = (place(triangle), place(triangle + 1));
            let is_same = second == (first + 1) % 4;
            let row = if is_same { 3 * first + slot } else { 3 * second + [1, 0, 2][slot] };
            let weighted = pieces.by_vertex[at].iter().zip(&moments).chain(pieces.parts[at].iter().zip(&parts));
            let sum = weighted.fold([0.0; 3], |sum: Point, (a, x)| std::array::from_fn(|c| sum[c] + a * x[c]));
            for (c, value) in map.inverse_times(&sum).iter().enumerate() {
                block[(3 * row + c) * MOST + column] = *value;
            }
        }
    }
    block
}

/// A row of products with the moments on all facets, and with a load in the cube, as one in the components of the
/// tractions and in a load.
fn in_components(row: &[f64], blocks: &[Vec<f64>], map: &SimplexMap) -> Vec<f64> {
    let mut sum = vec![0.0; ALL + 3];
    for ((block, row), sum) in blocks.iter().zip(row.chunks_exact(PER_FACET)).zip(sum.chunks_exact_mut(MOST)) {
        for (weights, x) in block.chunks_exact(MOST).zip(row) {
            sum.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += x * weight);
        }
    }
    let load = [row[OUTER], row[OUTER + 1], row[OUTER + 2]];
    let of_load = map.inverse_transposed_times(&load);
    sum[ALL..].iter_mut().zip(of_load).for_each(|(sum, x)| *sum = map.determinant * x);
    sum
}

/// The products of each field of the cube, in the energy, with the components of the tractions, the load, and the
/// components of the stress at the nodes, which is subtracted. Row by row; the square of the fields is left out.
struct DataRows {
    /// The lower triangle of the fields that are free.
    free: Vec<f64>,
    /// Rows of the free fields, then of the others.
    rows: Vec<f64>,
    width: usize,
}

fn data_rows(cube: &CubeProducts, map: &SimplexMap, compliance: &LocalCompliance, blocks: &[Vec<f64>]) -> DataRows {
    let CubeStresses { free, fields, .. } = *cube.stresses;
    let images: [Sym; 6] = std::array::from_fn(|k| map.stress(&unit(k)));
    let strains = images.map(|image| map.determinant * compliance.times(&image));
    let energies =
        cube.stresses.energies(&std::array::from_fn(|k| std::array::from_fn(|l| images[k].dot(&strains[l]))));
    let count = cube.nodal.count;
    let width = ALL + 3 + 6 * count;
    let mut rows = Vec::with_capacity(fields * width);
    for (field, energies) in energies.chunks_exact(fields).enumerate() {
        rows.extend(in_components(&energies[free..], blocks, map));
        for node in 0..count {
            let weights = &cube.nodal.with_fields;
            let strain = strains
                .iter()
                .zip(weights)
                .fold(Sym::ZERO, |sum, (strain, weights)| sum + weights[field * count + node] * *strain);
            rows.extend(strain.0.map(|x| 0.0 - x));
        }
    }
    let of_free = energies.chunks_exact(fields).take(free).enumerate();
    DataRows { free: of_free.flat_map(|(i, row)| row[..=i].iter().copied()).collect(), rows, width }
}

fn unit(k: usize) -> Sym {
    Sym(std::array::from_fn(|i| f64::from(u8::from(i == k))))
}

/// The matrix of the energy in the components of the tractions, the load, and the stress at the nodes, the least in the
/// free fields.
fn least(
    cube: &CubeProducts,
    data: &DataRows,
    map: &SimplexMap,
    (compliance, blocks): (&LocalCompliance, &[Vec<f64>]),
) -> Vec<f64> {
    let (width, free) = (data.width, cube.stresses.free);
    let first = ALL + 3;
    let (of_free, of_others) = data.rows.split_at(free * width);
    let mut whole = vec![0.0; width * width];
    for column in 0..width {
        let own: Vec<f64> = of_others.iter().skip(column).step_by(width).copied().collect();
        for (row, value) in in_components(&own, blocks, map).into_iter().enumerate() {
            whole[row * width + column] = value;
            if column >= first {
                whole[column * width + row] = value;
            }
        }
    }
    let count = cube.nodal.count;
    for k in 0..6 {
        let strain = map.determinant * compliance.times(&unit(k));
        for a in 0..count {
            let row = &mut whole[(first + 6 * a + k) * width + first..][..6 * count];
            for (values, share) in row.chunks_exact_mut(6).zip(&cube.nodal.own[a * count..]) {
                values.iter_mut().zip(strain.0).for_each(|(value, x)| *value = share * x);
            }
        }
    }
    let mut half = of_free.to_vec();
    Semidefinite::packed(data.free.clone(), free).forward(&mut half, width);
    let half = MatRef::from_row_major_slice(&half, free, width);
    let target = MatMut::from_row_major_slice_mut(&mut whole, width, width);
    matmul(target, Accum::Add, half.transpose(), half, -1.0, Par::Seq);
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Element, Q2_HEXAHEDRON};
    use crate::tensor::SymMap;

    /// The frames of the facets of a parallelepiped, and the vertices of these, which go round from an arbitrary one.
    fn facets(vertices: &[Point]) -> Vec<(FacetModes, [usize; 4])> {
        let of = |f: usize| {
            let own = Q1_HEXAHEDRON.facets[f].nodes;
            let corners: [usize; 4] =
                std::array::from_fn(|slot| own[if f.is_multiple_of(2) { (f + slot) % 4 } else { (7 + f - slot) % 4 }]);
            (FacetModes::new(3, &corners.map(|vertex| vertices[vertex])), corners)
        };
        (0..6).map(of).collect()
    }

    /// A linear stress with its own tractions and the load that it balances has no energy: it is one of the fields.
    #[test]
    fn a_linear_stress_has_no_energy_with_its_own_tractions() {
        let stresses = CubeStresses::new();
        let pieces = PieceMoments::new();
        let span: [Point; 3] = [[1.3, 0.2, -0.1], [0.4, 0.8, 0.3], [-0.2, 0.5, 1.1]];
        let vertices: Vec<Point> = Q1_HEXAHEDRON
            .nodes
            .iter()
            .map(|x| std::array::from_fn(|c| 0.3 + (0..3).map(|k| x[k] * span[k][c]).sum::<f64>()))
            .collect();
        let map = SimplexMap::new(3, &[vertices[0], vertices[1], vertices[3], vertices[4]]);
        let mut stiffness = SymMap::isotropic(3, 1.2, 1.0);
        stiffness.0[0][0] += 0.7;
        let compliance = LocalCompliance::new(&stiffness, 3).expect("a stiffness");
        let linear = LinearStress {
            middle: Sym([0.3, -0.2, 0.5, 0.7, 0.1, -0.4]),
            changes: [Sym([0.2, 0.1, 0.4, -0.3, 0.6, 0.5]), Sym([0.7, -0.1, 0.2, 0.3, 0.3, -0.6]), Sym([0.9; 6])],
        };
        let facets = facets(&vertices);
        let blocks: Vec<Vec<f64>> =
            facets.iter().enumerate().map(|(f, (modes, corners))| block(modes, (f, corners), &map, &pieces)).collect();
        let shape = HexahedronShape {
            gram: Vec::new(),
            slopes: Vec::new(),
            own: Vec::new(),
            map,
            corners: std::array::from_fn(|f| facets[f].1),
        };
        for element in [&Q1_HEXAHEDRON, &Q2_HEXAHEDRON] as [&Element; 2] {
            let nodal = NodalProducts::new(&stresses, element);
            let cube = CubeProducts { stresses: &stresses, pieces: &pieces, nodal: &nodal };
            let rows = data_rows(&cube, &map, &compliance, &blocks);
            let whole = least(&cube, &rows, &map, (&compliance, &blocks));
            let mut data: Vec<f64> =
                (0..6).flat_map(|f| facets[f].0.of_moments(&shape.tractions(f, &linear))).collect();
            let divergence = |c: usize| (0..3).map(|k| linear.changes[k].apply(&map.gradient(k + 1))[c]).sum::<f64>();
            data.extend((0..3).map(|c| 0.0 - divergence(c)));
            let without_stress = data.len();
            data.extend(element.nodes.iter().flat_map(|x| linear.at(x).0));
            let energy = |data: &[f64]| -> f64 {
                0.5 * whole
                    .chunks_exact(data.len())
                    .map(|row| product(row, data))
                    .zip(data)
                    .map(|(a, x)| a * x)
                    .sum::<f64>()
            };
            let mut alone = data.clone();
            alone[without_stress..].fill(0.0);
            let (none, some) = (energy(&data), energy(&alone));
            assert!(none.abs() < 1e-13 * some && some > 0.1, "{}: {none:e} {some:e}", element.name);
            // Another traction on one facet, without force and moment, costs energy.
            data[10] += 0.1;
            data[40] -= 0.1;
            assert!(energy(&data) > 1e-4 * some);
        }
    }
}
