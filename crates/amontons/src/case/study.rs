//! Makes the levels of a convergence study from a case.

use super::fault::Source;
use super::parse::{Case, parse};
use super::request::{ReferenceRequest, StudyRequest, StudyRequestError};
use crate::convergence::{Reference, Study, StudyLevel, Vary};
use crate::output::final_values;
use crate::time::{Steps, TimePhase};

fn refuse<T>(found: impl Into<String>, expected: impl Into<String>) -> Result<T, StudyRequestError> {
    Err(StudyRequestError::Request { found: found.into(), expected: expected.into() })
}

/// The study of a case with overrides.
///
/// # Errors
/// The case has faults, or the levels do not fit it.
pub fn study(source: &Source, overrides: &[String], request: &StudyRequest) -> Result<Study, StudyRequestError> {
    let case = parse(source, overrides)?;
    let mut levels = request.levels.clone();
    check_levels(&levels)?;
    let finest = match request.reference {
        ReferenceRequest::Exact => None,
        ReferenceRequest::Finest => levels.pop(),
        ReferenceRequest::Level(level) => Some(level),
    };
    if levels.is_empty() {
        return refuse(format!("the levels {:?}", request.levels), "at least one level besides the reference");
    }
    if let (Some(reference), Some(last)) = (finest, levels.last())
        && reference <= *last
    {
        return refuse(
            format!("the reference {reference}"),
            format!("a reference finer than the finest level, {last}"),
        );
    }
    let level = |level: usize| -> Result<StudyLevel, StudyRequestError> {
        let mut overrides = overrides.to_vec();
        overrides.extend(refined(&case, request.vary, request.power, level)?);
        let case = parse(source, &overrides)?;
        let measured = Some(final_values(case.probes.clone()));
        Ok(StudyLevel { level, text: case.fingerprint(), problem: case.problem, measured })
    };
    let reference = match (finest, &case.exact) {
        (Some(finest), _) => Reference::Level(Box::new(level(finest)?)),
        (None, Some(exact)) => Reference::Exact(exact.clone()),
        (None, None) => return refuse("a case without [exact]", "a solution in closed form to compare with"),
    };
    let levels = levels.into_iter().map(level).collect::<Result<Vec<_>, _>>()?;
    Ok(Study { vary: request.vary, levels, reference })
}

/// A case on each of several meshes, given by their cells per side, coarsest first.
///
/// # Errors
/// The case has faults, or the levels do not fit it.
pub fn meshes(source: &Source, overrides: &[String], levels: &[usize]) -> Result<Vec<StudyLevel>, StudyRequestError> {
    let case = parse(source, overrides)?;
    check_levels(levels)?;
    let level = |&level: &usize| {
        let mut overrides = overrides.to_vec();
        overrides.extend(refined(&case, Vary::Space, 1, level)?);
        let case = parse(source, &overrides)?;
        Ok(StudyLevel { level, problem: case.problem, text: case.text, measured: None })
    };
    levels.iter().map(level).collect()
}

/// The overrides that divide each step of a case into `parts`; the accuracy of chosen steps is divided.
#[must_use]
pub fn divided_steps(case: &Case, parts: usize) -> Vec<String> {
    let timeline = &case.problem.timeline;
    let of = |(i, phase): (usize, &TimePhase)| {
        let table = if timeline.has_phases() { format!("phase[{i}]") } else { "time".to_owned() };
        match phase.steps.refined(parts) {
            Steps::Automatic { accuracy } => format!("{table}.accuracy={accuracy:?}"),
            steps => format!("{table}.steps={}", steps.nominal()),
        }
    };
    timeline.phases().enumerate().map(of).collect()
}

fn check_levels(levels: &[usize]) -> Result<(), StudyRequestError> {
    if levels.contains(&0) || !levels.is_sorted_by(|a, b| a < b) {
        return refuse(format!("the levels {levels:?}"), "positive levels, each finer than the one before");
    }
    Ok(())
}

/// The steps of a phase with `own` of all the steps of a case, in a level of as many steps.
fn share(level: usize, own: usize, all: usize) -> Result<usize, StudyRequestError> {
    if (level * own).is_multiple_of(all) {
        return Ok(level * own / all);
    }
    let found = format!("level {level} of phases of which one has {own} of {all} steps");
    refuse(found, format!("{own} · (level / {all}) to be a whole number of steps"))
}

/// The overrides that make a level of a case.
fn refined(case: &Case, vary: Vary, power: u32, level: usize) -> Result<Vec<String>, StudyRequestError> {
    // The cells along the first side; those of other sides and blocks are multiplied as these.
    let Some(&first) = case.cells.first().or_else(|| case.blocks.first()?.first()) else {
        return refuse("a mesh without cells", "a mesh of one or more cells");
    };
    let scaled = |what: &str, value: usize, power: u32| -> Result<usize, StudyRequestError> {
        let (times, over) = (level.pow(power), first.pow(power));
        if (value * times).is_multiple_of(over) {
            Ok(value * times / over)
        } else {
            refuse(
                format!("level {level} of a case with {first} cells and {value} {what}"),
                format!("{value} · (level / {first}) to be a whole number of {what}"),
            )
        }
    };
    let cells = |all: &[usize]| -> Result<String, StudyRequestError> {
        let all = all.iter().map(|&n| Ok(scaled("cells across", n, 1)?.to_string()));
        Ok(format!("[{}]", all.collect::<Result<Vec<_>, StudyRequestError>>()?.join(", ")))
    };
    let mesh = || -> Result<Vec<String>, StudyRequestError> {
        if case.has_mesh_file {
            return if level.is_power_of_two() {
                Ok(vec![format!("mesh.refine={}", level.ilog2())])
            } else {
                refuse(
                    format!("level {level} of a mesh from a file"),
                    "powers of two (1, 2, 4, …), the number of parts of each edge",
                )
            };
        }
        match case.cells.as_slice() {
            [] if case.blocks.iter().any(Vec::is_empty) => refuse(
                format!("level {level} of blocks of which one is a file"),
                "blocks that are generated".to_owned(),
            ),
            [] => {
                let of_block = |(i, all): (usize, &Vec<usize>)| Ok(format!("mesh.blocks[{i}].n={}", cells(all)?));
                case.blocks.iter().enumerate().map(of_block).collect()
            }
            [_] => Ok(vec![format!("mesh.n={level}")]),
            all => Ok(vec![format!("mesh.n={}", cells(all)?)]),
        }
    };
    let timeline = &case.problem.timeline;
    if timeline.is_automatic() {
        let expected = "equal steps, whose times nest: give `steps` a number, such as --set time.steps=64";
        return refuse("steps = \"auto\" in a study", expected);
    }
    // Each phase is refined by the same factor, so that the times of levels nest.
    let steps = |of: &dyn Fn(usize) -> Result<usize, StudyRequestError>| -> Result<Vec<String>, StudyRequestError> {
        if !timeline.has_phases() {
            return Ok(vec![format!("time.steps={}", of(timeline.steps())?)]);
        }
        let phases = timeline.phases().enumerate();
        phases.map(|(i, phase)| Ok(format!("phase[{i}].steps={}", of(phase.steps.nominal())?))).collect()
    };
    Ok(match vary {
        Vary::Both => mesh()?.into_iter().chain(steps(&|own| scaled("steps", own, power))?).collect(),
        Vary::Space => mesh()?,
        Vary::Time => steps(&|own| share(level, own, timeline.steps()))?,
    })
}
