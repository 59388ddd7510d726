//! The search against the dense eigenvalues of the same pencil, and the count against what is taken from it.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use faer::{Mat, c64};

use super::polynomial::Polynomial;
use super::search::{FoundPairs, find};
use super::slopes::slopes_of;
use super::steady::forms;
use super::{Coverage, ModeKind, ModeRegion, Wanted, contact, count, unknowns};
use crate::case::{self, Source};
use crate::linalg::Pattern;
use crate::run::{Settings, Stepping};

/// A block on a belt in the plane or in space, with damping: x by numbers of a fixed sequence.
fn block(seed: u64, in_space: bool) -> String {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(7);
    let mut next = |from: f64, to: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        from + (to - from) * (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let (kind, zero) = if in_space { ("box", ", 0") } else { ("rectangle", "") };
    let (depth, cells) = if in_space { (format!(", {:?}", next(0.4, 1.0)), ", 1") } else { (String::new(), "") };
    let plane = if in_space { "" } else { ", stress_state = \"plane-strain\"" };
    format!(
        r#"
name = "block"
units = "dimensionless"
[mesh]
kind = "{kind}"
size = [{:?}, {:?}{depth}]
n = [3, 2{cells}]
elements = "Q1"
[time]
end = 1.0
analysis = "steady"
[material]
density = {:?}
elasticity = {{ law = "isotropic", young = 1.0, poisson = {:?}{plane} }}
viscosity = {{ law = "lame", first = 0.0, second = {:?} }}
[[boundary]]
on = "top"
displacement = [0, -0.02{zero}]
[contact]
on = "bottom"
normal = {normal}
friction = {{ law = "coulomb", coefficient = {:?} }}
foundation_velocity = [{:?}, 0, {:?}]
"#,
        next(0.5, 2.0),
        next(0.5, 2.0),
        next(0.5, 2.0),
        next(0.0, 0.4),
        next(0.0, 0.01),
        next(0.0, 0.6),
        next(0.3, 1.0),
        next(-0.5, 0.5),
        normal = if seed.is_multiple_of(2) {
            "{ law = \"compliance\", stiffness = 1.5 }"
        } else {
            "{ law = \"signorini\" }"
        },
    )
}

/// The pencil of squeal of the steady state of a case.
fn pencil(text: String) -> Polynomial {
    let case = case::parse(&Source::new("block.toml", text), &[]).unwrap_or_else(|error| panic!("{error}"));
    let mut run = Stepping::new(&case.problem, &Settings::default()).expect("a run");
    run.step().expect("a steady state");
    let seen = run.snapshot();
    let (discrete, report) = (seen.discretization, seen.report.expect("a report"));
    let what = unknowns::Perturbed { displacement: true, temperature: false };
    let points = contact::linearised(&seen.problem.contacts, &discrete.boundary, report, false).expect("points");
    let unknowns = unknowns::PerturbedUnknowns::new(
        (discrete, &seen.problem.contacts),
        (what, &[]),
        super::Sectors::WHOLE.waves(0),
    );
    let forms = forms(discrete, seen.state, what, ModeKind::Squeal);
    Polynomial::new(unknowns, &forms, (&discrete.boundary, &points), &discrete.mesh, None).expect("a pencil")
}

/// All eigenvalues of λ²T₂ + λT₁ + T₀, by those of a dense matrix of twice the size.
fn dense(pencil: &Polynomial) -> Vec<c64> {
    let n = pencil.size();
    let term = |term: usize| {
        let mut matrix = Mat::<f64>::zeros(n, n);
        for j in 0..n {
            let (mut unit, mut column) = (vec![c64::default(); n], vec![c64::default(); n]);
            unit[j] = c64::new(1.0, 0.0);
            pencil.add_product(term, c64::new(1.0, 0.0), &unit, &mut column);
            (0..n).for_each(|i| matrix[(i, j)] = column[i].re);
        }
        matrix
    };
    let solver = term(2).partial_piv_lu();
    let [a, b] = [0, 1].map(|power| faer::prelude::Solve::solve(&solver, term(power)));
    let companion = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
        (true, true) => 0.0,
        (true, false) => f64::from(u8::from(i + n == j)),
        (false, true) => -a[(i - n, j)],
        (false, false) => -b[(i - n, j - n)],
    });
    companion.eigenvalues().expect("eigenvalues")
}

fn wanted(count: usize) -> Wanted<'static> {
    Wanted { kind: ModeKind::Squeal, count, region: None, waves: None, interrupt: None }
}

fn inside(region: &ModeRegion, lambda: c64) -> bool {
    lambda.im >= 0.0 && region.has([lambda.re, lambda.im])
}

/// The region holds exactly the eigenvalues that a dense solver finds there, on random blocks.
#[test]
fn a_search_finds_what_a_dense_solver_finds() {
    for seed in 0..40 {
        let made = pencil(block(seed, seed % 4 > 1));
        let all = dense(&made);
        let FoundPairs { pairs, region, missing, .. } = find(made, &wanted(5), Coverage::Folded, 2).expect("modes");
        let expected: Vec<c64> = all.into_iter().filter(|lambda| inside(&region, *lambda)).collect();
        assert_eq!((pairs.len(), missing), (expected.len(), 0), "{seed}: {region:?}, {expected:?}");
        for pair in &pairs {
            let off = expected.iter().map(|lambda| (lambda - pair.lambda).norm()).fold(f64::INFINITY, f64::min);
            assert!(off < 1e-7 * pair.lambda.norm(), "{seed}: {} is {off:e} off", pair.lambda);
        }
    }
}

/// The count finds what is kept from it, a pair as two, and what is no eigenvalue as one too many.
#[test]
fn the_count_finds_what_is_missing() {
    for seed in 0..12 {
        let found = find(pencil(block(seed, seed % 4 > 1)), &wanted(4), Coverage::Folded, 2).expect("modes");
        let at = found.pencil.at(c64::new(0.5, 0.0));
        let pattern = Pattern::new(&at).expect("a pattern");
        let all: Vec<c64> = found.pairs.iter().map(|pair| pair.lambda).filter(|lambda| lambda.im > 0.0).collect();
        let both = |kept: &[c64]| kept.iter().flat_map(|lambda| [*lambda, lambda.conj()]).collect::<Vec<c64>>();
        let count = |known: &[c64]| {
            let wanted = wanted(4);
            count::count(&found.pencil, &pattern, (&found.region, Coverage::Folded, &wanted), known)
                .expect("a count")
                .missing
        };
        let off = all.len();
        assert_eq!(off, found.pairs.len(), "{seed}: real modes");
        assert_eq!((count(&both(&all)), count(&both(&all[1..]))), (0, 2), "{seed}");
        let middle = 0.5 * (found.region.frequency[0] + found.region.frequency[1]);
        let more = [&both(&all)[..], &both(&[c64::new(0.1 * found.region.growth[1], middle)])].concat();
        assert_eq!(count(&more), -2, "{seed}");
    }
}

/// A search that is asked to stop ends with the interruption.
#[test]
fn a_search_ends_when_it_is_asked_to() {
    let stop = std::sync::atomic::AtomicBool::new(true);
    let wanted = Wanted { interrupt: Some(&stop), ..wanted(4) };
    let ended = find(pencil(block(1, false)), &wanted, Coverage::Folded, 2);
    assert!(matches!(ended, Err(super::StabilityError::Solve(crate::linalg::SolveError::Interrupted))));
}

/// Results do not depend on the number of threads.
#[test]
fn the_number_of_threads_changes_no_bit() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let found = pool.install(|| find(pencil(block(3, true)), &wanted(6), Coverage::Folded, 3)).expect("modes");
        let bits = |pair: &super::search::FoundPair| [pair.lambda.re.to_bits(), pair.lambda.im.to_bits()];
        (found.pairs.iter().map(bits).collect::<Vec<_>>(), found.factorizations)
    };
    assert_eq!(with(1), with(3));
}

/// The pencil of two degrees of freedom: T₀ by rows, diagonal T₁ and T₂.
fn two_degrees(stiffness: [[f64; 2]; 2], damping: [f64; 2], mass: f64) -> Polynomial {
    let entry = |i: u32, j: u32| (i, j, stiffness[i as usize][j as usize]);
    let terms = [
        vec![entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1)],
        vec![(0, 0, damping[0]), (1, 1, damping[1])],
        vec![(0, 0, mass), (1, 1, mass)],
    ];
    Polynomial::of_terms(2, terms).expect("a pencil")
}

/// The eigenvalues of positive frequency of two degrees of freedom with unit masses.
fn of_two_degrees(stiffness: [[f64; 2]; 2], damping: [f64; 2]) -> Vec<c64> {
    let found = find(two_degrees(stiffness, damping, 1.0), &wanted(2), Coverage::Folded, 1).expect("modes");
    assert_eq!((found.pairs.len(), found.missing), (2, 0));
    found.pairs.iter().map(|pair| pair.lambda).collect()
}

/// Derivatives of the eigenvalues of two degrees of freedom by the derivatives of stiffness and damping.
fn slopes_of_two(
    (stiffness, damping): ([[f64; 2]; 2], [f64; 2]),
    (stiffening, damped): ([[f64; 2]; 2], [f64; 2]),
) -> Vec<(c64, Vec<c64>)> {
    let found = find(two_degrees(stiffness, damping, 1.0), &wanted(2), Coverage::Folded, 1).expect("modes");
    slopes_of(&found, &wanted(2), two_degrees(stiffening, damped, 0.0)).expect("derivatives")
}

/// With λ² = −K the derivative is −(K_μ)/(2λ): of the block on a belt at μ = 0.6 that of the growth is 0.9952397.
#[test]
fn the_growth_of_a_block_on_a_belt_rises_as_its_formula_says() {
    let off = -2.25 * 3.0f64.sqrt();
    let stiffness = |mu: f64| [[23.25, off + 11.0 * mu], [off, 18.75]];
    let found = slopes_of_two((stiffness(0.6), [0.0; 2]), ([[0.0, 11.0], [0.0, 0.0]], [0.0; 2]));
    let growing = found.iter().find(|(lambda, _)| lambda.re > 0.0).expect("a mode that grows");
    assert!((growing.1[0].re - 0.995_239_7).abs() < 1e-7, "{growing:?}");
    for (lambda, slopes) in &found {
        // Of λ² = −21 ± √d with d = 2.25² + off (off + 11 μ): 2 λ λ_μ = ± 5.5 off/√d.
        let root = lambda * lambda + 21.0;
        let exact = 5.5 * off / root / (2.0 * lambda);
        assert!((slopes[0] - exact).norm() < 1e-10 * exact.norm(), "{slopes:?} for {exact}");
    }
    // Damping of the first degree of freedom, against differences of the eigenvalues: slope 2.
    let damping = [0.3, 0.1];
    let found = slopes_of_two((stiffness(0.6), damping), ([[0.0; 2]; 2], [1.0, 0.0]));
    let errors = [0.04, 0.02, 0.01].map(|h| {
        let [low, high] = [-h, h].map(|h| of_two_degrees(stiffness(0.6), [damping[0] + h, damping[1]]));
        let near =
            |all: &[c64], at: c64| all.iter().copied().min_by(|a, b| (a - at).norm().total_cmp(&(b - at).norm()));
        let off = |(lambda, slopes): &(c64, Vec<c64>)| {
            let [low, high] = [&low, &high].map(|all| near(all, *lambda).expect("a mode"));
            ((high - low) / (2.0 * h) - slopes[0]).norm()
        };
        found.iter().map(off).fold(0.0, f64::max)
    });
    let orders = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
    assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.05), "{errors:?}");
}

/// Of two equal springs, λ² = −k twice, the derivatives are −κ/(2λ) with the eigenvalues κ of the change of the
/// stiffness, which need not be symmetric. Where two modes meet in one shape there is none.
#[test]
fn a_pair_has_the_derivatives_of_its_projection_and_a_meeting_none() {
    for (change, kappa) in [
        ([[1.0, 2.0], [2.0, 4.0]], [c64::new(5.0, 0.0), c64::new(0.0, 0.0)]),
        ([[0.0, 1.0], [-1.0, 0.0]], [c64::new(0.0, 1.0), c64::new(0.0, -1.0)]),
        ([[3.0, 0.0], [0.0, 3.0]], [c64::new(3.0, 0.0); 2]),
    ] {
        let found = slopes_of_two(([[7.0, 0.0], [0.0, 7.0]], [0.0; 2]), (change, [0.0; 2]));
        let [(lambda, slopes)] = &found[..] else { panic!("{found:?}") };
        assert_eq!(slopes.len(), 2);
        for kappa in kappa {
            let exact = -kappa / (2.0 * lambda);
            let off = slopes.iter().map(|slope| (slope - exact).norm()).fold(f64::INFINITY, f64::min);
            assert!(off < 1e-10, "{slopes:?} without {exact}");
        }
    }
    let meeting = slopes_of_two(([[2.0, 0.0], [1.0, 2.0]], [0.0; 2]), ([[0.0, 1.0], [0.0, 0.0]], [0.0; 2]));
    assert!(meeting.iter().all(|(_, slopes)| slopes.is_empty()), "{meeting:?}");
}

/// A block on a belt with two inclined springs and a contact spring (after Hoffmann et al.): k = 20 at 150°, 11 at 30°,
/// contact 11.
fn on_a_belt(mu: f64, damping: [f64; 2]) -> Vec<c64> {
    let off = -2.25 * 3.0f64.sqrt();
    of_two_degrees([[23.25, off + 11.0 * mu], [off, 18.75]], damping)
}

/// Eigenvalues of two degrees of freedom are the square roots of those of −K, also where they meet and become complex.
#[test]
fn two_degrees_squeal_as_their_formula_says() {
    let off = -2.25 * 3.0f64.sqrt();
    for mu in [0.0, 0.4, 0.5, 0.6, 1.0] {
        let (half, product) = (c64::new(2.25, 0.0), c64::new(off * (off + 11.0 * mu), 0.0));
        let root = (half * half + product).sqrt();
        let found = on_a_belt(mu, [0.0; 2]);
        for squared in [21.0 + root, 21.0 - root] {
            let exact = (-squared).sqrt();
            let near = |lambda: &c64| (lambda - exact).norm().min((lambda + exact).norm());
            let nearest = found.iter().map(near).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-10 * exact.norm(), "μ = {mu}: {exact} is {nearest:e} off in {found:?}");
        }
    }
    for delta in [0.5, 1.5] {
        let found = of_two_degrees([[2.0, 1.0 - delta], [1.0, 2.0]], [0.0; 2]);
        let root = c64::new(1.0 - delta, 0.0).sqrt();
        for exact in [2.0 + root, 2.0 - root].map(|squared| (-squared).sqrt()) {
            let near = |lambda: &c64| (lambda - exact).norm().min((lambda + exact).norm());
            let nearest = found.iter().map(near).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-10, "Δ = {delta}: {exact} is {nearest:e} off in {found:?}");
        }
    }
}

/// Dashpots move the onset of squeal, and unequal ones bring it nearer: where the largest growth is zero, by bisection.
#[test]
fn unequal_damping_brings_squeal_nearer() {
    for (damping, expected) in [
        ([0.1, 0.1], 0.477_276_22),
        ([0.1, 0.0], 0.354_283_12),
        ([0.0, 0.1], 0.354_283_12),
        ([0.5, 0.05], 0.404_495_82),
    ] {
        let (mut quiet, mut loud) = (0.36f64.min(expected - 0.02), 0.6);
        while loud - quiet > 1e-9 {
            let middle = 0.5 * (quiet + loud);
            let growth = on_a_belt(middle, damping).iter().map(|lambda| lambda.re).fold(f64::NEG_INFINITY, f64::max);
            if growth > 0.0 {
                loud = middle;
            } else {
                quiet = middle;
            }
        }
        assert!((loud - expected).abs() < 1e-8, "{damping:?}: {loud}");
    }
}
