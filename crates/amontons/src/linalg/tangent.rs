//! What the boundary term adds to S.

/// An entry that the boundary term adds to S: row, column, value.
pub type Entry = (u32, u32, f64);

/// J = Σ ω Nᵀ T N, the derivative of the forces on Γ_C: a sum over contact points, the entries of each together.
///
/// A backend that needs to know J up to a factor only, as a preconditioner does, may take each point by itself: a
/// motion that no point resists is then still one that no point resists.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tangent {
    entries: Vec<Entry>,
    /// Where the entries of each point end.
    ends: Vec<usize>,
}

impl Tangent {
    /// No forces.
    #[must_use]
    pub fn new() -> Tangent {
        Tangent::default()
    }

    /// Adds the entries of one contact point.
    pub fn add(&mut self, entries: impl IntoIterator<Item = Entry>) {
        self.entries.extend(entries);
        self.ends.push(self.entries.len());
    }

    /// Adds values on the diagonal, each by itself.
    pub fn add_diagonal(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().enumerate().for_each(|(i, value)| self.add([(i as u32, i as u32, value)]));
    }

    /// The entries of all points: J is their sum.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The entries of one point after the other.
    pub fn points(&self) -> impl Iterator<Item = &[Entry]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.entries[start..end])
    }

    /// The same with other names of rows and columns.
    #[must_use]
    pub fn renamed(&self, name: impl Fn(u32) -> u32) -> Tangent {
        let entries = self.entries.iter().map(|&(i, j, value)| (name(i), name(j), value)).collect();
        Tangent { entries, ends: self.ends.clone() }
    }

    /// y += J x.
    pub fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for &(i, j, value) in &self.entries {
            y[i as usize] += value * x[j as usize];
        }
    }

    /// Whether nothing is added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Whether it is the same to the last bit.
    #[must_use]
    pub fn is_same(&self, other: &Tangent) -> bool {
        let bits = |&(i, j, value): &Entry| (i, j, value.to_bits());
        self.entries.iter().map(bits).eq(other.entries.iter().map(bits))
    }

    /// Whether it is symmetric to round-off.
    #[must_use]
    pub fn is_symmetric(&self) -> bool {
        let mut pairs: Vec<Entry> = self
            .entries
            .iter()
            .filter(|(i, j, _)| i != j)
            .map(|&(i, j, value)| (i.min(j), i.max(j), if i < j { value } else { -value }))
            .collect();
        pairs.sort_by_key(|&(i, j, _)| (i, j));
        pairs.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).all(|same| {
            let (sum, size) =
                same.iter().fold((0.0, 0.0), |(sum, size), pair| (sum + pair.2, f64::max(size, pair.2.abs())));
            sum.abs() <= 1e-12 * size
        })
    }
}
