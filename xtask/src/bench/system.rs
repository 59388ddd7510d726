//! One linear system of the cube, solved by this program and by pyamg: the same matrix and right-hand side.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

use amontons::case::{self, Source};
use amontons::discretization::Discretization;
use amontons::linalg::{Backend, BlockMatrix, Layout, Multigrid, System, dot};
use amontons::mesh::Mesh;
use amontons::time::Rule;
use serde_json::Value;

use super::{CUBE, Row};

/// Residual, relative to the right-hand side, down to which the system is solved.
const LEFT: f64 = 1e-10;

/// Solves K x = r on the cube with `n` cells per edge, with one thread and with all, and with the script of pyamg if
/// `python` is given.
pub fn measure(n: usize, python: Option<&str>) -> Result<Vec<Row>, Box<dyn Error>> {
    let case = case::parse(&Source::new("cube.toml", CUBE), &[format!("mesh.n={n}")]).map_err(|f| f.to_string())?;
    let problem = case.problem;
    let discrete = Discretization::new(&problem);
    let matrix = Arc::new(discrete.mechanical_matrix(Rule::backward_euler(problem.timeline.longest())));
    let layout = Layout::of(&discrete.mesh, &discrete.v, &[]);
    let free = &discrete.v.free;
    let right: Vec<f64> =
        (0..free.len()).map(|i| if free[i] { (i as f64 * 0.7).sin() + (i as f64 * 0.13).cos() } else { 0.0 }).collect();
    let row = |program: String, setup: f64, solve: f64, krylov: usize, memory: f64| Row {
        case: "cube system",
        program,
        unknowns: discrete.v.unknowns(),
        steps: 1,
        setup,
        per_step: solve,
        over_bound: None,
        krylov,
        memory,
        result: f64::NAN,
    };
    let mut rows = Vec::new();
    for threads in [1, std::thread::available_parallelism().map_or(1, usize::from)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let (setup, solve, iterations) =
            pool.install(|| solve(&matrix, &layout, &right)).map_err(|error| error.to_string())?;
        let plural = if threads == 1 { "" } else { "s" };
        rows.push(row(format!("amontons {threads} thread{plural}"), setup, solve, iterations, f64::NAN));
    }
    if let Some(python) = python {
        let folder = std::env::temp_dir().join(format!("amontons-bench-{}-system", std::process::id()));
        fs::create_dir_all(&folder)?;
        write(&folder, &matrix, &discrete.mesh, free, &right)?;
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/pyamg_system.py");
        let output = Command::new(python).arg(script).arg(&folder).env("OMP_NUM_THREADS", "1").output()?;
        fs::remove_dir_all(&folder)?;
        let text = String::from_utf8_lossy(&output.stdout);
        let Some(found) = text.lines().last().and_then(|line| serde_json::from_str::<Value>(line).ok()) else {
            return Err(format!("pyamg: {}", String::from_utf8_lossy(&output.stderr)).into());
        };
        let number = |key: &str| found.get(key).and_then(Value::as_f64).unwrap_or(f64::NAN);
        if number("left") > 2.0 * LEFT {
            return Err(format!("pyamg left a residual of {:e}", number("left")).into());
        }
        let program = format!("pyamg {}", found.get("version").and_then(Value::as_str).unwrap_or_default());
        let iterations = number("iterations") as usize;
        rows.push(row(program, number("setup"), number("solve"), iterations, number("peak_memory_bytes")));
    }
    Ok(rows)
}

/// Seconds to make the multigrid levels and to solve, and iterations.
fn solve(
    matrix: &Arc<BlockMatrix>,
    layout: &Layout,
    right: &[f64],
) -> Result<(f64, f64, usize), Box<dyn Error + Send + Sync>> {
    let backend: Arc<dyn Backend> = Arc::new(Multigrid::default());
    let begin = Instant::now();
    let mut system = System::new(&backend, matrix, layout)?;
    // The levels are made by the first product that needs them.
    let r = system.unknowns().gather(right);
    system.solve_to(&mut r.clone(), 0.5)?;
    let (setup, before) = (begin.elapsed().as_secs_f64(), system.iterations());
    let begin = Instant::now();
    let mut x = r.clone();
    system.solve_to(&mut x, LEFT)?;
    let seconds = begin.elapsed().as_secs_f64();
    let iterations = system.iterations() - before;
    let mut values = vec![0.0; right.len()];
    system.unknowns().add(&x, &mut values);
    let left = system.unknowns().gather(&matrix.apply(&values));
    let rest: Vec<f64> = left.iter().zip(&r).map(|(left, r)| r - left).collect();
    let relative = (dot(&rest, &rest) / dot(&r, &r)).sqrt();
    if relative > 2.0 * LEFT {
        return Err(format!("this program left a residual of {relative:e}").into());
    }
    Ok((setup, seconds, iterations))
}

/// Writes the blocks of the free nodes as compressed rows, with the right-hand side and the coordinates.
fn write(folder: &Path, matrix: &BlockMatrix, mesh: &Mesh, free: &[bool], right: &[f64]) -> Result<(), Box<dyn Error>> {
    let nodes: Vec<usize> = (0..mesh.points.len()).filter(|node| free[3 * node]).collect();
    let mut place = vec![None; mesh.points.len()];
    (0i32..).zip(&nodes).for_each(|(at, &node)| place[node] = Some(at));
    let (mut starts, mut columns, mut blocks) = (vec![0i32], Vec::new(), Vec::new());
    for &node in &nodes {
        for (other, block) in matrix.row(node) {
            if let Some(at) = place[other] {
                columns.push(at);
                blocks.extend(block.iter().flat_map(|value| value.to_ne_bytes()));
            }
        }
        starts.push(i32::try_from(columns.len())?);
    }
    let integers = |list: &[i32]| list.iter().flat_map(|value| value.to_ne_bytes()).collect::<Vec<u8>>();
    let reals = |list: &mut dyn Iterator<Item = f64>| list.flat_map(f64::to_ne_bytes).collect::<Vec<u8>>();
    fs::write(folder.join("starts"), integers(&starts))?;
    fs::write(folder.join("columns"), integers(&columns))?;
    fs::write(folder.join("blocks"), blocks)?;
    fs::write(folder.join("right"), reals(&mut nodes.iter().flat_map(|node| right[3 * node..3 * node + 3].to_vec())))?;
    fs::write(folder.join("points"), reals(&mut nodes.iter().flat_map(|node| mesh.points[*node])))?;
    Ok(())
}
