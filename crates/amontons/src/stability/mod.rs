//! Stability of steady sliding: squeal, hot spots, and both together.
//!
//! A steady state with closed points that slide or stick is perturbed by (u′, θ′) exp(λt). The perturbation solves
//! T(λ)(u′, θ′) = 0 with the pencil of the polynomial module, and grows if Re λ > 0. Mechanics alone gives squeal: two
//! modes of the pressed body that friction couples (N. Hoffmann, M. Fischer, R. Allgaier, L. Gaul, Mech. Res. Commun.
//! 29 (2002) 197). Without inertia, heat gives hot spots: where the pressure is larger, friction heats, and what
//! expands presses more (R. A. Burton, V. Nerlikar, S. R. Kilaparti, Wear 24 (1973) 177).
//!
//! [`modes`] finds all eigenvalues in a region by Arnoldi's method about one shift, and shows by the argument principle
//! that none is missing there. It linearises the laws with fixed normals and fixed opposite points: what the next step
//! of the run would do, with a step that tends to zero.

mod contact;
mod count;
mod eliminated;
mod krylov;
mod polynomial;
mod search;
mod shares;
mod slopes;
mod steady;
#[cfg(all(test, feature = "case"))]
mod tests;
mod unknowns;
mod waves;

use std::sync::atomic::{AtomicBool, Ordering};

use faer::c64;

use crate::discretization::Discretization;
use crate::linalg::SolveError;
use crate::problem::{Fault, Problem};
use crate::state::{State, StepReport};
use search::FoundPairs;
use shares::ModeShares;
pub use slopes::DifferentiableModes;
use steady::LinearisedState;
pub use steady::SteadyState;
use waves::{Sectors, WaveNumber};

/// Difference of two frequencies, relative to them, that is round-off.
const SAME: f64 = 1e-7;

/// What is perturbed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModeKind {
    /// The motion, with inertia, at the temperature of the state: complex eigenvalues of squeal.
    Squeal,
    /// Motion without inertia, and temperature: growth of hot spots.
    Thermal,
    /// Motion with inertia, and temperature.
    Coupled,
}

impl ModeKind {
    /// Every kind.
    pub const ALL: [ModeKind; 3] = [ModeKind::Squeal, ModeKind::Thermal, ModeKind::Coupled];

    /// The word in the case file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ModeKind::Squeal => "squeal",
            ModeKind::Thermal => "thermal",
            ModeKind::Coupled => "coupled",
        }
    }

    /// The kind that suits a problem: squeal if inertia acts at the end of its run, otherwise hot spots.
    #[must_use]
    pub fn of(problem: &Problem) -> ModeKind {
        let swings = problem.has_mass();
        if swings || !problem.physics.has_heat() { ModeKind::Squeal } else { ModeKind::Thermal }
    }
}

/// A part of the plane of λ: growth Re λ in 1/s and the angular frequency Im λ in rad/s, and with them the conjugates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeRegion {
    /// Least and largest growth, 1/s.
    pub growth: [f64; 2],
    /// Least and largest angular frequency, rad/s, not negative.
    pub frequency: [f64; 2],
}

impl ModeRegion {
    /// True if λ or its conjugate lies in the region.
    #[must_use]
    pub fn has(&self, [growth, frequency]: [f64; 2]) -> bool {
        let within = |[from, to]: [f64; 2], value: f64| from <= value && value <= to;
        within(self.growth, growth) && within(self.frequency, frequency.abs())
    }

    /// The corners of the paths around what is covered, counterclockwise; all are closed but that around the upper half
    /// of a region that reaches the real axis.
    fn paths(&self, coverage: Coverage) -> Vec<Vec<c64>> {
        let upper = self.upper_path();
        if coverage != Coverage::Both {
            return vec![upper];
        }
        let mut lower: Vec<c64> = upper.iter().map(c64::conj).rev().collect();
        if self.frequency[0] > 0.0 {
            return vec![upper, lower];
        }
        // The lower half begins on the left and ends on the right; both ends are those of the upper half.
        lower.pop();
        lower.extend(upper);
        vec![lower]
    }

    /// The corners around the upper half, counterclockwise from the lower right one; closed if the region does not
    /// reach the real axis.
    fn upper_path(&self) -> Vec<c64> {
        let ([left, right], [below, above]) = (self.growth, self.frequency);
        let mut path =
            vec![c64::new(right, below), c64::new(right, above), c64::new(left, above), c64::new(left, below)];
        if below > 0.0 {
            path.push(path[0]);
        }
        path
    }

    /// Distance of a point to the farthest corner of the upper half.
    fn farthest(&self, from: c64) -> f64 {
        self.upper_path().into_iter().map(|corner| (corner - from).norm()).fold(0.0, f64::max)
    }
}

/// The part of the plane of λ that a search covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Coverage {
    /// The upper half, of a pencil that is real: the lower half has the conjugates.
    Folded,
    /// Both halves.
    Both,
    /// The upper half, of a region away from the real axis.
    Upper,
}

/// What a case asks for, before its problem is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    /// What is perturbed; `None` for the kind that suits the problem.
    pub kind: Option<ModeKind>,
    /// The number of modes.
    pub count: usize,
    /// Least and largest frequency in Hz of all modes that are looked for.
    pub hertz: Option<[f64; 2]>,
    /// Least and largest growth of all modes that are looked for, 1/s.
    pub growth: Option<[f64; 2]>,
    /// Numbers of waves around a body of which the mesh is a sector; `None` for all.
    pub waves: Option<Vec<usize>>,
}

impl Search {
    /// What to look for in a problem. Where only frequencies are given, growth reaches as far as they do to both sides,
    /// and where only growth is given, frequencies reach as far as it does.
    #[must_use]
    pub fn wanted<'a>(&'a self, problem: &Problem, interrupt: Option<&'a AtomicBool>) -> Wanted<'a> {
        let frequency = self.hertz.map(|range| range.map(|hertz| hertz * std::f64::consts::TAU));
        let region = match (self.growth, frequency) {
            (None, None) => None,
            (Some(growth), Some(frequency)) => Some(ModeRegion { growth, frequency }),
            (None, Some(frequency)) => Some(ModeRegion { growth: [-frequency[1], frequency[1]], frequency }),
            (Some(growth), None) => {
                let most = growth.into_iter().fold(0.0, |most: f64, growth| most.max(growth.abs()));
                Some(ModeRegion { growth, frequency: [0.0, most] })
            }
        };
        let kind = self.kind.unwrap_or_else(|| ModeKind::of(problem));
        Wanted { kind, count: self.count, region, waves: self.waves.as_deref(), interrupt }
    }
}

/// What to look for.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// What is perturbed.
    pub kind: ModeKind,
    /// The number of modes: those of lowest frequency, or of hot spots those of largest growth. In a sector as many for
    /// each number of waves.
    pub count: usize,
    /// All modes of this region in place of a number of them.
    pub region: Option<ModeRegion>,
    /// Numbers of waves around a body of which the mesh is a sector; `None` for all, 0 to half the number of sectors.
    pub waves: Option<&'a [usize]>,
    /// Ends the search when it becomes true.
    pub interrupt: Option<&'a AtomicBool>,
}

impl Wanted<'_> {
    /// The pencils to be searched. Those of n and N − n waves have conjugate eigenvalues: n is searched on both sides
    /// of the real axis, or N − n too in a region away from it.
    fn searches(&self, sectors: Sectors) -> Vec<(WaveNumber, Coverage)> {
        let mut numbers = self.waves.map_or_else(|| (0..=sectors.count / 2).collect(), <[usize]>::to_vec);
        numbers.sort_unstable();
        numbers.dedup();
        let is_away = self.region.is_some_and(|region| region.frequency[0] > 0.0);
        let of = |number: usize| {
            let waves = sectors.waves(number);
            match (waves.is_real(), is_away) {
                (true, _) => vec![(waves, Coverage::Folded)],
                (false, true) => vec![(waves, Coverage::Upper), (waves.backward(), Coverage::Upper)],
                (false, false) => vec![(waves, Coverage::Both)],
            }
        };
        numbers.into_iter().flat_map(of).collect()
    }

    /// Checks that numbers of waves are those of a sector.
    fn check_waves(&self, sectors: Sectors) -> Result<(), StabilityError> {
        let Some(waves) = self.waves else { return Ok(()) };
        let most = sectors.count / 2;
        let (found, expected, hint) = if sectors.count == 1 {
            ("numbers of waves of a whole body".to_owned(), "a sector".to_owned(), "remove them: all modes are found")
        } else if let Some(over) = waves.iter().find(|number| **number > most) {
            let hint = "n waves and N − n are the same modes, which run the other way around";
            (format!("{over}"), format!("at most {most}, half of {} sectors", sectors.count), hint)
        } else {
            return Ok(());
        };
        Err(StabilityError::Problem(Fault::new("stability.waves", found, expected).hint(hint)))
    }

    /// Returns an error if the search was asked to stop.
    fn go_on(&self) -> Result<(), SolveError> {
        let stops = self.interrupt.is_some_and(|interrupt| interrupt.load(Ordering::Relaxed));
        if stops { Err(SolveError::Interrupted) } else { Ok(()) }
    }
}

/// A mode: a perturbation (u′, θ′) exp(λt).
#[derive(Clone, Debug)]
pub struct Mode {
    /// Re λ in 1/s: the mode grows if it is positive.
    pub growth: f64,
    /// Im λ in rad/s, not negative.
    pub frequency: f64,
    /// Of a sector the number of waves around the body, positive if they run in the positive sense about the axis, and
    /// up to whole multiples of the number of sectors. A mode of frequency 0 does not run, and there are two, ±n.
    pub waves: Option<i64>,
    /// ‖T(λ)x‖ over the sum of the sizes of its terms.
    pub residual: f64,
    /// What each contact adds to the growth, 1/s: the power of its forces over twice the energy of the mode, or of heat
    /// that of its flux over the square of the temperature. The rest is what the body damps.
    pub by_contact: Vec<f64>,
    /// Share of each body in the kinetic energy, or of hot spots in the square of the temperature.
    pub by_body: Vec<f64>,
    /// u′ by node and component, real and imaginary part, largest component 1 m; without dimension but for the scale.
    /// Of a sector that of the sector of the mesh.
    pub displacement: Vec<[f64; 2]>,
    /// θ′ by node, K, in the scale of u′; of hot spots the largest temperature is 1 K.
    pub temperature: Vec<[f64; 2]>,
    /// Derivatives of growth and of angular frequency by each parameter of [`Modes::parameters`]; `None` where the mode
    /// has none, as where two modes meet.
    pub slopes: Vec<Option<[f64; 2]>>,
    /// The eigenpair that it is.
    origin: ModeOrigin,
}

/// The eigenpair of a mode.
#[derive(Clone, Copy, Debug, Default)]
struct ModeOrigin {
    /// Number of the search, and of the pair in it.
    search: usize,
    pair: usize,
    is_conjugate: bool,
}

impl Mode {
    /// The mode of the conjugate of λ.
    fn conjugate(&self) -> Mode {
        let conjugate = |values: &[[f64; 2]]| values.iter().map(|[re, im]| [*re, -im]).collect();
        Mode {
            frequency: -self.frequency,
            displacement: conjugate(&self.displacement),
            temperature: conjugate(&self.temperature),
            origin: ModeOrigin { is_conjugate: true, ..self.origin },
            ..self.clone()
        }
    }

    /// Derivatives of growth and of the frequency in Hz by a parameter.
    #[must_use]
    pub fn slope(&self, parameter: usize) -> Option<[f64; 2]> {
        let [growth, frequency] = self.slopes.get(parameter).copied().flatten()?;
        Some([growth, frequency / std::f64::consts::TAU])
    }

    /// −Re λ/|λ|: negative for a mode that grows.
    #[must_use]
    pub fn damping_ratio(&self) -> f64 {
        let size = self.growth.hypot(self.frequency);
        if size > 0.0 { -self.growth / size } else { 0.0 }
    }

    /// Cosine and sine of the phase of the sector `place` further in the positive sense about the axis, of `sectors`,
    /// against that of the mesh: there u′ is e^{−2πi·waves·place/sectors} times that of the mesh, turned.
    #[must_use]
    pub fn phase(&self, place: usize, sectors: usize) -> [f64; 2] {
        let turns = self.waves.unwrap_or_default() * place as i64;
        let whole = sectors.max(1) as i64;
        let (sine, cosine) = (std::f64::consts::TAU * turns.rem_euclid(whole) as f64 / whole as f64).sin_cos();
        [cosine, -sine]
    }

    /// Im λ/2π in Hz.
    #[must_use]
    pub fn hertz(&self) -> f64 {
        self.frequency / std::f64::consts::TAU
    }
}

/// What the argument principle says of the modes, of sectors those of a number of waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeCount {
    /// Number of waves in both senses, 0 to half the number of sectors; 0 for a whole body.
    pub waves: usize,
    /// The region in which none is missing.
    pub region: ModeRegion,
    /// Number of modes in it.
    pub modes: usize,
    /// Eigenvalues that the count finds in the region beyond the modes, with conjugates. Other than zero only if the
    /// memory was not enough to find them all.
    pub missing: isize,
}

/// The modes of a state.
#[derive(Clone, Debug)]
pub struct Modes {
    /// What is perturbed.
    pub kind: ModeKind,
    /// All modes of the region, conjugates once: by frequency, or of hot spots by growth, the largest first.
    pub modes: Vec<Mode>,
    /// Number of sectors of the body, 1 if the mesh is all of it.
    pub sectors: usize,
    /// The counts: one, or of sectors one per number of waves.
    pub counts: Vec<ModeCount>,
    /// Number of unknowns of T.
    pub unknowns: usize,
    /// Factorizations of T(λ): one per search, the others for the counts.
    pub factorizations: usize,
    /// Largest dimension of a Krylov space.
    pub dimension: usize,
    /// Contact points that are open, stick and slip.
    pub points: [usize; 3],
    /// Largest velocity of the body over the largest slip velocity: zero in a steady state.
    pub unsteady: f64,
    /// Names of the bodies of [`Mode::by_body`].
    pub bodies: Vec<String>,
    /// Names and values of the parameters of [`Mode::slopes`].
    pub parameters: Vec<(String, f64)>,
}

impl Modes {
    /// Eigenvalues that a count finds beyond the modes: the first number that is not zero.
    #[must_use]
    pub fn missing(&self) -> isize {
        self.counts.iter().map(|count| count.missing).find(|missing| *missing != 0).unwrap_or_default()
    }

    /// Adds the modes of a number of waves.
    fn add(&mut self, found: &FoundPairs, shares: &ModeShares, search: usize) {
        let waves = found.pencil.unknowns.waves();
        let before = self.modes.len();
        for (number, pair) in found.pairs.iter().enumerate() {
            let origin = ModeOrigin { search, pair: number, is_conjugate: false };
            let mode = Mode { origin, ..shares.mode(&found.pencil, pair) };
            if self.sectors == 1 {
                self.modes.push(mode);
                continue;
            }
            // The conjugate belongs to the waves that run the other way around.
            let forward = Mode { waves: Some(waves.signed()), ..mode };
            let backward = || Mode { waves: Some(waves.backward().signed()), ..forward.conjugate() };
            if !waves.is_real() && forward.frequency <= 0.0 {
                self.modes.push(backward());
            }
            if forward.frequency >= 0.0 {
                self.modes.push(forward);
            }
        }
        let least = waves.waves.min(waves.backward().waves);
        let modes = self.modes.len() - before;
        // Both senses apart have one region.
        if let Some(count) = self.counts.iter_mut().find(|count| count.waves == least) {
            count.modes += modes;
            count.missing = if count.missing == 0 { found.missing } else { count.missing };
        } else {
            let (region, missing) = (found.region, found.missing);
            self.counts.push(ModeCount { waves: least, region, modes, missing });
        }
        self.unknowns = found.pencil.size();
        self.factorizations += found.factorizations;
        self.dimension = self.dimension.max(found.dimension);
    }

    /// Brings the modes into order: by frequency, or of hot spots by growth, the largest first.
    fn sort(&mut self) {
        if self.kind == ModeKind::Thermal {
            self.modes.sort_by(|a, b| b.growth.total_cmp(&a.growth));
            return;
        }
        self.modes.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        // Of two modes of one frequency, as above the onset of squeal, the growing one comes first.
        let is_same = |a: &Mode, b: &Mode| b.frequency - a.frequency <= SAME * b.frequency;
        for same in self.modes.chunk_by_mut(is_same) {
            same.sort_by(|a, b| b.growth.total_cmp(&a.growth));
        }
    }

    /// The largest growth, 1/s.
    #[must_use]
    pub fn largest_growth(&self) -> f64 {
        self.modes.iter().map(|mode| mode.growth).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// Why a state cannot be linearised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The state has no step that led to it.
    NoStep,
    /// There is nothing to perturb.
    NoUnknowns,
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Reason::NoStep => "found a state that no step of this session led to, expected the end of a step",
            Reason::NoUnknowns => "found no displacement or temperature that is free, expected a body that can move",
        })
    }
}

/// Reason why modes were not found.
#[derive(Debug, thiserror::Error)]
pub enum StabilityError {
    /// The problem has something without a steady state, or that is not linearised.
    #[error("{0}")]
    Problem(Fault),
    /// The state cannot be linearised.
    #[error("modes: {0}")]
    State(Reason),
    /// T(λ) is singular or does not fit into memory.
    #[error("modes: {0}")]
    Solve(#[from] SolveError),
    /// The eigenvalues of a small dense matrix were not found.
    #[error("modes: the eigenvalues of a matrix of {size} rows were not found")]
    Eigenvalues {
        /// Rows of the matrix.
        size: usize,
    },
    /// An eigenvalue lies on the boundary of the region.
    #[error("modes: found an eigenvalue on the boundary of the region near growth {:.6e} 1/s, angular frequency {:.6e} rad/s, expected a boundary between eigenvalues; move stability.growth or stability.frequency by a little", at[0], at[1])]
    OnBoundary {
        /// Growth and angular frequency near it.
        at: [f64; 2],
    },
    /// The count finds another number of modes.
    #[error(
        "modes: found modes of which the count has {missing:+} more in the region, expected the same number; narrow stability.frequency or stability.growth"
    )]
    Missing {
        /// Eigenvalues of the count beyond those that were found, conjugates counted twice.
        missing: isize,
    },
    /// Fewer modes exist than were asked for.
    #[error("modes: found {found} modes, expected at least {count}; give stability.count a smaller number")]
    TooFew {
        /// Modes that exist.
        found: usize,
        /// Modes asked for.
        count: usize,
    },
}

/// Finds the modes of a state.
///
/// # Errors
/// If a contact has no steady state, T is singular everywhere, or the boundary of the region meets an eigenvalue.
pub fn modes(
    problem: &Problem,
    discrete: &Discretization,
    state: &State,
    report: &StepReport,
    wanted: &Wanted,
) -> Result<Modes, StabilityError> {
    Ok(search(SteadyState { problem, discrete, state, report }, wanted)?.0)
}

/// The modes of a state with the pencils and eigenpairs of each search.
fn search(at: SteadyState, wanted: &Wanted) -> Result<(Modes, Vec<FoundPairs>), StabilityError> {
    let linearised = LinearisedState::new(at, wanted)?;
    let sectors = Sectors::of(at.problem).map_err(StabilityError::Problem)?;
    wanted.check_waves(sectors)?;
    let LinearisedState { contacts, boundary, forms, .. } = &linearised;
    let shares = ModeShares::new(at.discrete, boundary, contacts, forms, wanted.kind);
    let mut all = Modes {
        kind: wanted.kind,
        modes: Vec::new(),
        sectors: sectors.count,
        counts: Vec::new(),
        unknowns: 0,
        factorizations: 0,
        dimension: 0,
        points: linearised.points(),
        unsteady: linearised.unsteady(),
        bodies: shares.names(),
        parameters: Vec::new(),
    };
    let mut parts = Vec::new();
    for (waves, coverage) in wanted.searches(sectors) {
        let unknowns = linearised.unknowns(waves);
        if unknowns.size == 0 {
            return Err(StabilityError::State(Reason::NoUnknowns));
        }
        let pencil = linearised.pencil(unknowns, None).ok_or(StabilityError::State(Reason::NoUnknowns))?;
        let found = search::find(pencil, wanted, coverage, at.discrete.mesh.dim)?;
        all.add(&found, &shares, parts.len());
        parts.push(found);
    }
    all.sort();
    Ok((all, parts))
}
