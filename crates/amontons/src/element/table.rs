//! Shape functions at fixed reference points, evaluated once for all cells.

use super::Element;
use crate::quadrature::{QuadratureRule, rule};
use crate::tensor::Point;

/// An element at the points of a quadrature rule: values and reference gradients of its shape functions, and weights.
#[derive(Clone, Debug)]
pub struct ShapeTable {
    /// The element.
    pub element: &'static Element,
    /// Weights of the points on the reference cell.
    pub weights: Vec<f64>,
    values: Vec<f64>,
    gradients: Vec<Point>,
}

impl ShapeTable {
    /// The element at the points of the rule that is exact for polynomials of a degree on its shape, see
    /// [`crate::quadrature::rule`].
    #[must_use]
    pub fn new(element: &'static Element, degree: usize) -> ShapeTable {
        ShapeTable::of_rule(element, rule(element.shape, degree))
    }

    /// The element at some points, with weight 1 each.
    #[must_use]
    pub fn at(element: &'static Element, points: &[Point]) -> ShapeTable {
        ShapeTable::of_rule(element, QuadratureRule { points: points.to_vec(), weights: vec![1.0; points.len()] })
    }

    /// The element at the points of a rule.
    #[must_use]
    pub fn of_rule(element: &'static Element, rule: QuadratureRule) -> ShapeTable {
        let n = element.nodes.len();
        let (mut values, mut gradients) = (vec![0.0; n * rule.points.len()], vec![[0.0; 3]; n * rule.points.len()]);
        for (q, x) in rule.points.iter().enumerate() {
            (element.shape_functions)(x, &mut values[q * n..(q + 1) * n]);
            (element.gradients)(x, &mut gradients[q * n..(q + 1) * n]);
        }
        ShapeTable { element, weights: rule.weights, values, gradients }
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// True if there are no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// Values of the shape functions at point `q`, one per node.
    #[must_use]
    pub fn values(&self, q: usize) -> &[f64] {
        let n = self.element.nodes.len();
        &self.values[q * n..(q + 1) * n]
    }

    /// Reference gradients of the shape functions at point `q`, one per node.
    #[must_use]
    pub fn gradients(&self, q: usize) -> &[Point] {
        let n = self.element.nodes.len();
        &self.gradients[q * n..(q + 1) * n]
    }
}
