//! Waves around a cyclic body: modes that repeat from sector to sector but for a phase.
//!
//! A body of N equal sectors in a state that is the same in each has modes u(Rx) = e^{iψ} R u(x) with ψ = 2πn/N and
//! n = 0 … N − 1, R turning by one sector. With n waves the pencil T_n(λ) has the unknowns of one sector, and
//! T_{N−n}(λ) is the conjugate of T_n at the conjugate of λ, since the state is real: the eigenvalues of N − n are the
//! conjugates of those of n. Friction makes T_n not Hermitian, so that λ and λ̄ need not both belong to n: waves that
//! run with the sliding and against it are different modes.

use std::f64::consts::TAU;

use faer::c64;

use crate::mesh::cross;
use crate::problem::{Fault, Problem};
use crate::tensor::{Point, dot, length, minus};

/// Difference of two unit vectors that is round-off.
const SAME: f64 = 1e-9;

/// The sectors of a body about its axis; one if it is whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sectors {
    pub count: usize,
    axis: Point,
}

/// A number of waves around the body, 0 ≤ n < N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WaveNumber {
    sectors: Sectors,
    pub waves: usize,
}

impl Sectors {
    /// A body that is whole.
    pub const WHOLE: Sectors = Sectors { count: 1, axis: [0.0, 0.0, 1.0] };

    /// The sectors of a problem.
    ///
    /// # Errors
    /// If the entries of `cyclic` have different axes or numbers, or a sector meets its axis.
    pub fn of(problem: &Problem) -> Result<Sectors, Fault> {
        let mut found: Option<Sectors> = None;
        let size = problem.mesh.points.iter().map(length).fold(0.0, f64::max);
        for (i, cyclic) in problem.cyclic.iter().enumerate() {
            let path = format!("cyclic[{i}]");
            let Ok((links, count)) = cyclic.links(&problem.mesh) else {
                return Err(Fault::new(path, "sides that do not match", "the two sides of a sector"));
            };
            let axis = cyclic.axis.map(|c| c / length(&cyclic.axis));
            if !links.on_axis.is_empty() {
                let hint = "cut a small bore, or mesh the whole body";
                return Err(Fault::new(path, "a sector that meets its axis", "a bore in a search for modes").hint(hint));
            }
            let first = *found.get_or_insert(Sectors { count, axis });
            let through = problem.cyclic.first().map_or(cyclic.through, |first| minus(&cyclic.through, &first.through));
            let off = length(&cross(&axis, &through)) > SAME * size;
            if first.count != count || (dot(&first.axis, &axis).abs() - 1.0).abs() > SAME || off {
                let told = format!("{count} sectors beside {}, or about another axis", first.count);
                return Err(Fault::new(path, told, "sectors of one body about one axis in a search for modes"));
            }
        }
        Ok(found.unwrap_or(Sectors::WHOLE))
    }

    /// A number of waves.
    pub fn waves(self, waves: usize) -> WaveNumber {
        WaveNumber { sectors: self, waves }
    }
}

impl WaveNumber {
    /// The phase e^{2πi n p/N} of the sector into which a turn by p sectors takes, given by the images of the axes.
    pub fn phase(&self, turn: &[Point; 3]) -> c64 {
        let Sectors { count, axis } = self.sectors;
        let trace: f64 = (0..3).map(|c| turn[c][c]).sum();
        // The axial vector of R is 2 sin α times the axis.
        let axial = [turn[1][2] - turn[2][1], turn[2][0] - turn[0][2], turn[0][1] - turn[1][0]];
        let angle = (0.5 * dot(&axial, &axis)).atan2(0.5 * (trace - 1.0));
        let places = (angle / TAU * count as f64).round() as i64;
        let (part, whole) = ((places * self.waves as i64).rem_euclid(count as i64), count as i64);
        // Exact where it is real or imaginary, so that T is real where the phases are.
        match (4 * part % whole, 4 * part / whole) {
            (0, 0) => c64::new(1.0, 0.0),
            (0, 1) => c64::new(0.0, 1.0),
            (0, 2) => c64::new(-1.0, 0.0),
            (0, _) => c64::new(0.0, -1.0),
            _ => c64::from_polar(1.0, TAU * part as f64 / whole as f64),
        }
    }

    /// True if all phases are real: T(λ) is, and the conjugate of each eigenvalue is one.
    pub fn is_real(&self) -> bool {
        (2 * self.waves).is_multiple_of(self.sectors.count)
    }

    /// The waves N − n, that run the other way around.
    pub fn backward(self) -> WaveNumber {
        let count = self.sectors.count;
        WaveNumber { waves: (count - self.waves) % count, ..self }
    }

    /// The number of waves with its sign: positive if a mode of positive frequency, u ~ e^{i(ωt + nφ)}, runs in the
    /// positive sense about the axis. Waves that do not run, n = 0 and 2n = N, are positive.
    pub fn signed(&self) -> i64 {
        let (n, count) = (self.waves as i64, self.sectors.count as i64);
        if self.is_real() || 2 * n > count { (n.min(count - n)).abs() } else { -n }
    }
}
