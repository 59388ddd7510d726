//! A coarser surface with fewer nodes: nodes within a small box are merged.

use std::collections::{BTreeMap, BTreeSet};

/// Triangles and lines between vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ReducedMesh {
    /// Position and part of each vertex; only vertices of the same part are merged.
    pub vertices: Vec<([f64; 3], u64)>,
    pub triangles: Vec<[u32; 3]>,
    /// Lines that are always drawn.
    pub outline: Vec<[u32; 2]>,
    /// Lines of the mesh; empty for a coarser surface.
    pub mesh: Vec<[u32; 2]>,
}

/// A box of a part: its index along each axis.
type BoxIndex = ([i64; 3], u64);

impl ReducedMesh {
    /// The vertices kept in a coarser shape of at most `most` vertices: their numbers, and for each vertex the index of
    /// the kept one that represents it. A kept vertex is the one nearest to the mean of those it represents, or of
    /// those of them on the outline, if any.
    fn kept(&self, most: usize) -> (Vec<usize>, Vec<u32>) {
        let low = [0, 1, 2].map(|d| self.vertices.iter().map(|(p, _)| p[d]).fold(f64::INFINITY, f64::min));
        let high = [0, 1, 2].map(|d| self.vertices.iter().map(|(p, _)| p[d]).fold(f64::NEG_INFINITY, f64::max));
        let size = [0, 1, 2].map(|d| high[d] - low[d]).into_iter().fold(0.0, f64::max);
        let boxes = |count: f64| {
            let mut inside: BTreeMap<BoxIndex, Vec<usize>> = BTreeMap::new();
            for (i, (p, part)) in self.vertices.iter().enumerate() {
                let place = [0, 1, 2].map(|d| ((p[d] - low[d]) / size * count).floor() as i64);
                inside.entry((place, *part)).or_default().push(i);
            }
            inside
        };
        // The finest boxes, 2, 2.8, 4, 5.7 … along the longest side, whose number is small enough.
        let counts = (1..40).map(|i| 2f64.powf(0.5 * f64::from(i)));
        let groups = counts.map(boxes).take_while(|groups| groups.len() <= most).last().unwrap_or_else(|| boxes(1.0));
        let (mut kept, mut stands_for) = (Vec::new(), vec![0u32; self.vertices.len()]);
        let outline: BTreeSet<usize> = self.outline.iter().flatten().map(|&v| v as usize).collect();
        for group in groups.values() {
            for &i in group {
                stands_for[i] = kept.len() as u32;
            }
            let on_outline: Vec<usize> = group.iter().copied().filter(|i| outline.contains(i)).collect();
            let group = if on_outline.is_empty() { group } else { &on_outline };
            let middle =
                [0, 1, 2].map(|d| group.iter().map(|&i| self.vertices[i].0[d]).sum::<f64>() / group.len() as f64);
            let away = |i: usize| (0..3).map(|d| (self.vertices[i].0[d] - middle[d]).powi(2)).sum::<f64>();
            kept.extend(group.iter().copied().min_by(|&i, &j| away(i).total_cmp(&away(j))));
        }
        (kept, stands_for)
    }

    /// The shape with at most about `most` vertices, and the kept vertices of the original shape.
    pub(super) fn thinned(self, most: usize) -> (ReducedMesh, Vec<usize>) {
        let all: Vec<usize> = (0..self.vertices.len()).collect();
        if self.vertices.len() <= most {
            return (self, all);
        }
        let (kept, now) = self.kept(most);
        let mut seen = BTreeSet::new();
        let mut triangles = Vec::new();
        for triangle in self.triangles.iter().map(|t| t.map(|v| now[v as usize])) {
            let mut key = triangle;
            key.sort_unstable();
            if key[0] != key[1] && key[1] != key[2] && seen.insert(key) {
                triangles.push(triangle);
            }
        }
        let outline: BTreeSet<[u32; 2]> = self
            .outline
            .iter()
            .map(|e| e.map(|v| now[v as usize]))
            .filter(|[a, b]| a != b)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        let vertices = kept.iter().map(|&i| self.vertices[i]).collect();
        (ReducedMesh { vertices, triangles, outline: outline.into_iter().collect(), mesh: Vec::new() }, kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 40 × 40 cells keeps its corners up to a box, its area up to a rim, and both parts separate.
    #[test]
    fn a_coarser_square_is_a_square() {
        let (n, mut shape) = (40u32, ReducedMesh::default());
        for i in 0..=n {
            for j in 0..=n {
                shape.vertices.push(([f64::from(i) / f64::from(n), f64::from(j) / f64::from(n), 0.0], 0));
            }
        }
        for i in 0..n {
            let corner = n * (n + 1);
            shape.outline.extend([[i, i + 1], [corner + i, corner + i + 1]]);
            shape.outline.extend([[i * (n + 1), (i + 1) * (n + 1)], [i * (n + 1) + n, (i + 1) * (n + 1) + n]]);
            for j in 0..n {
                let a = i * (n + 1) + j;
                shape.triangles.extend([[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]);
            }
        }
        let (thin, kept) = shape.clone().thinned(300);
        assert!(thin.vertices.len() <= 300 && thin.vertices.len() > 100, "{}", thin.vertices.len());
        assert!(kept.iter().zip(&thin.vertices).all(|(&i, v)| shape.vertices[i] == *v));
        let area = |s: &ReducedMesh| -> f64 {
            let p = |v: u32| s.vertices[v as usize].0;
            let twice = |t: &[u32; 3]| {
                let [a, b, c] = t.map(p);
                (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            };
            s.triangles.iter().map(|t| 0.5 * twice(t)).sum()
        };
        // The rim stays, except for corners, which are within a box; there are at least 14 boxes per side.
        let corners = 4.0 * (1.0f64 / 14.0).powi(2);
        let found = area(&thin);
        assert!((area(&shape) - 1.0).abs() < 1e-12 && found <= 1.0 + 1e-12 && found >= 1.0 - corners, "{found}");
        assert_eq!(shape.clone().thinned(2000).0, shape, "few enough");
    }
}
