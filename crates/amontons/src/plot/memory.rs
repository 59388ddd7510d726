//! Data of pictures of a run in memory.

use std::sync::Arc;

use super::body::PlaneMesh;
use super::run::{DrawnRun, HistoryColumns, PlaneSnapshot, Rod, SpaceSnapshot};
use super::surface::Skin;
use super::{PlotError, contact, ground};
use crate::contact::names_of_points;
use crate::mesh::Mesh;
use crate::output::{
    self, ContactValues, OutputError, RunStart, Sink, Summary, cell_values, contact_columns, history_columns,
    history_values, nodal_stress,
};
use crate::problem::Problem;
use crate::state::State;
use crate::tensor::Sym;

impl DrawnRun {
    /// A run in memory at the time of a state. `contact` holds the columns of its contact points from
    /// [`crate::output::contact_columns`], `history` the rows of all steps. Its pictures are those of the results
    /// folder that the run would have written.
    ///
    /// # Errors
    /// [`PlotError::Data`] if a column is missing or a value is not finite.
    pub fn of_state(
        problem: &Arc<Problem>,
        state: &State,
        contact: &[(String, ContactValues)],
        history: HistoryColumns,
    ) -> Result<DrawnRun, PlotError> {
        let mesh = &problem.mesh;
        let sides = names_of_points(&problem.contacts);
        let problem = &ground::found(problem, &history);
        let mut run = DrawnRun {
            name: problem.name.clone(),
            dimension: mesh.dim,
            t: state.t,
            history,
            units: problem.units(),
            problem: Some(Arc::clone(problem)),
            ..DrawnRun::default()
        };
        // At t = 0 there are no columns.
        let rows = Some(contact).filter(|columns| !columns.is_empty());
        match mesh.dim {
            2 => {
                run.contact = rows.map_or_else(|| Ok(Vec::new()), |rows| contact::in_plane(&rows, &sides))?;
                contact::read_in_means(problem, &mut run.contact);
                run.snapshot = Some(plane(problem, state)?);
            }
            3 => {
                let mut points = rows.map_or_else(|| Ok(Vec::new()), |rows| contact::in_space(&rows, &sides))?;
                contact::read_in_means(problem, &mut points);
                run.solid = Some(SpaceSnapshot { contact: points, ..solid(problem, state)? });
            }
            _ => run.rod = Some(rod(problem, state)),
        }
        run.sides = sides;
        Ok(run)
    }
}

/// A sink that keeps the data of the pictures of a run, so that no results folder is needed.
///
/// ```
/// use std::sync::Arc;
/// use amontons::plot::{self, Film, Options, PictureKind, RunPanel};
/// use amontons::{case, run::{Settings, run}};
///
/// let source = case::Source::new("starter.toml", case::STARTER);
/// let problem = Arc::new(case::parse(&source, &["mesh.n=[16, 8]".into()])?.problem);
/// let mut film = Film::new(&problem, 8);
/// run(&problem, &Settings::default(), &mut [&mut film])?;
/// let last = film.frame(film.times().len() - 1)?;
/// let picture = plot::picture(PictureKind::Contact, &[RunPanel { title: "", run: &last }], &Options::default())?;
/// assert!(picture.svg().contains("pressure"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Film {
    problem: Arc<Problem>,
    every: usize,
    frames: Vec<FilmFrame>,
    history: HistoryColumns,
    summary: Option<Summary>,
}

/// A state with the columns of its contact points.
#[derive(Clone, Debug)]
struct FilmFrame {
    state: State,
    contact: Vec<(String, ContactValues)>,
}

impl Film {
    /// Keeps the start, every `every`-th step and the last one; 0: the last only.
    #[must_use]
    pub fn new(problem: &Arc<Problem>, every: usize) -> Film {
        Film { problem: Arc::clone(problem), every, frames: Vec::new(), history: HistoryColumns::new(), summary: None }
    }

    /// The kept times, s.
    #[must_use]
    pub fn times(&self) -> Vec<f64> {
        self.frames.iter().map(|frame| frame.state.t).collect()
    }

    /// The summary after the end of the run.
    #[must_use]
    pub fn summary(&self) -> Option<&Summary> {
        self.summary.as_ref()
    }

    /// The run at one of its times, with its whole history.
    ///
    /// # Errors
    /// [`PlotError::Data`] if there is no such time or a value is not finite.
    pub fn frame(&self, index: usize) -> Result<DrawnRun, PlotError> {
        let missing = || {
            let kept = self.frames.len();
            PlotError::Data(format!("there is no frame {index}; the film has {kept}, counted from 0"))
        };
        let FilmFrame { state, contact } = self.frames.get(index).ok_or_else(missing)?;
        DrawnRun::of_state(&self.problem, state, contact, self.history.clone())
    }

    fn keep(&mut self, now: &output::Snapshot) {
        if self.frames.last().is_none_or(|frame| frame.state.step != now.state.step) {
            self.frames.push(FilmFrame { state: now.state.clone(), contact: contact_columns(now) });
        }
    }

    fn keep_if_due(&mut self, now: &output::Snapshot) {
        if self.every > 0 && now.state.step.is_multiple_of(self.every) {
            self.keep(now);
        }
    }
}

impl Sink for Film {
    fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
        self.history = history_columns(&self.problem).into_iter().map(|name| (name, Vec::new())).collect();
        self.keep_if_due(&start.from);
        Ok(())
    }

    fn step(&mut self, now: &output::Snapshot) -> Result<(), OutputError> {
        for (name, value) in history_columns(&self.problem).iter().zip(history_values(now).unwrap_or_default()) {
            self.history.entry(name.clone()).or_default().push(value);
        }
        self.keep_if_due(now);
        Ok(())
    }

    fn last(&mut self, last: &output::Snapshot) -> Result<(), OutputError> {
        self.keep(last);
        Ok(())
    }

    fn finish(&mut self, summary: &Summary) -> Result<(), OutputError> {
        self.summary = Some(summary.clone());
        Ok(())
    }
}

fn plane(problem: &Problem, state: &State) -> Result<PlaneSnapshot, PlotError> {
    let u = displacement::<2>(&problem.mesh, state);
    let Stresses { cells, nodes } = Stresses::new(problem, state);
    let snapshot = PlaneSnapshot {
        body: PlaneMesh::of_mesh(&problem.mesh)?,
        displacement: u,
        temperature: temperature(problem, state),
        von_mises: cells,
        nodal_von_mises: nodes,
        regions: regions(&problem.mesh),
    };
    snapshot.check()?;
    Ok(snapshot)
}

fn solid(problem: &Problem, state: &State) -> Result<SpaceSnapshot, PlotError> {
    let Stresses { cells, nodes } = Stresses::new(problem, state);
    let solid = SpaceSnapshot {
        surface: Skin::of_mesh(&problem.mesh)?,
        displacement: displacement::<3>(&problem.mesh, state),
        temperature: temperature(problem, state),
        von_mises: cells,
        nodal_von_mises: nodes,
        regions: regions(&problem.mesh),
        contact: Vec::new(),
    };
    solid.check()?;
    Ok(solid)
}

/// The fields of a body on a line, its nodes in the order of x.
fn rod(problem: &Problem, state: &State) -> Rod {
    let (mesh, u, theta) = (&problem.mesh, displacement::<1>(&problem.mesh, state), temperature(problem, state));
    let mut order: Vec<usize> = (0..mesh.points.len()).collect();
    order.sort_by(|&i, &j| mesh.points[i][0].total_cmp(&mesh.points[j][0]));
    Rod {
        x: order.iter().map(|&i| mesh.points[i][0]).collect(),
        displacement: order.iter().map(|&i| u[i][0]).collect(),
        temperature: order.iter().filter_map(|&i| theta.get(i).copied()).collect(),
    }
}

/// The displacement of each node, zero in a run without mechanics.
fn displacement<const D: usize>(mesh: &Mesh, state: &State) -> Vec<[f64; D]> {
    let component = |node: usize, c: usize| state.u.get(node * mesh.dim + c).copied().unwrap_or(0.0);
    (0..mesh.points.len()).map(|node| std::array::from_fn(|c| component(node, c))).collect()
}

fn temperature(problem: &Problem, state: &State) -> Vec<f64> {
    if problem.physics.has_temperature() { state.theta.clone() } else { Vec::new() }
}

/// The region of each cell.
fn regions(mesh: &Mesh) -> Vec<f64> {
    mesh.blocks.iter().flat_map(|block| std::iter::repeat_n(block.region as f64, block.len())).collect()
}

/// Von Mises stresses; empty in a run without mechanics.
#[derive(Default)]
struct Stresses {
    cells: Vec<f64>,
    nodes: Vec<f64>,
}

impl Stresses {
    fn new(problem: &Problem, state: &State) -> Stresses {
        if !problem.physics.has_mechanics() {
            return Stresses::default();
        }
        let nodal = nodal_stress(problem, state).means(problem.mesh.points.len());
        Stresses {
            cells: cell_values(problem, state).iter().map(|values| values.stress.von_mises()).collect(),
            nodes: nodal.iter().map(Sym::von_mises).collect(),
        }
    }
}
