//! Vectors of three components.

/// A unit vector in this direction, or `None` for a zero vector.
pub fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|x| x / length))
}

pub fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// a without its part along a unit vector.
pub fn across(a: &[f64; 3], unit: &[f64; 3]) -> [f64; 3] {
    let along = dot(a, unit);
    std::array::from_fn(|d| a[d] - along * unit[d])
}

pub fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
