//! Fill and work of a Cholesky factor by the order of elimination, on a cube of tetrahedra of degree 1 with three
//! unknowns per node: nested dissection by coordinates, approximate minimum degree, and orders of other programs.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use amontons::linalg::{Graph, nested_dissection};
use amontons::mesh::{Elements, Mesh};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMat;
use faer::sparse::linalg::amd;

/// What to measure.
#[derive(clap::Args)]
pub struct Arguments {
    /// Cells per edge of the cube.
    #[arg(long, default_value_t = 20)]
    n: usize,
    /// Write the graph of the nodes here, in the format of METIS.
    #[arg(long)]
    graph: Option<PathBuf>,
    /// An order of another program: one node per line, counted from 0, the first to be eliminated first.
    #[arg(long)]
    order: Option<PathBuf>,
}

/// Prints one line per order.
pub fn run(arguments: &Arguments) -> ExitCode {
    match measure(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("Error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn measure(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let n = arguments.n;
    let mesh = Mesh::box_([1.0; 3], [n; 3], Elements::P1)?;
    let graph = Graph::of_mesh(&mesh);
    let nodes = graph.len();
    println!("{n}³ cells, {nodes} nodes, {} unknowns", 3 * nodes);
    if let Some(path) = &arguments.graph {
        write_graph(path, &graph)?;
    }
    println!("{:<34} {:>14} {:>12} {:>10}", "order", "numbers in L", "operations", "time in s");
    let keep = vec![true; nodes];
    for (name, last) in
        [("nested dissection", Vec::new()), ("nested dissection, one side last", mesh.facets["bottom"].node_list())]
    {
        let begin = Instant::now();
        let order = nested_dissection(&graph, &mesh.points, &keep, &last).order;
        row(name, &graph, &order, Some(begin.elapsed().as_secs_f64()))?;
    }
    let begin = Instant::now();
    let order = minimum_degree(&graph)?;
    row("approximate minimum degree (faer)", &graph, &order, Some(begin.elapsed().as_secs_f64()))?;
    if let Some(path) = &arguments.order {
        let order =
            fs::read_to_string(path)?.lines().map(|line| line.trim().parse()).collect::<Result<Vec<u32>, _>>()?;
        row(&path.display().to_string(), &graph, &order, None)?;
    }
    Ok(())
}

fn row(name: &str, graph: &Graph, order: &[u32], seconds: Option<f64>) -> Result<(), String> {
    let [numbers, operations] = cost(graph, order)?;
    let seconds = seconds.map_or_else(|| "-".to_owned(), |s| format!("{s:.3}"));
    println!("{name:<34} {numbers:>14.4e} {operations:>12.4e} {seconds:>10}");
    Ok(())
}

/// Entries of L and operations to compute it, Σ c² over the lengths c of its columns, with three unknowns per node.
fn cost(graph: &Graph, order: &[u32]) -> Result<[f64; 2], String> {
    const NONE: usize = usize::MAX;
    let n = graph.len();
    let mut position = vec![NONE; n];
    for (k, &node) in order.iter().enumerate() {
        *position.get_mut(node as usize).ok_or(format!("node {node}, expected one below {n}"))? = k;
    }
    if order.len() != n || position.contains(&NONE) {
        return Err(format!("{} nodes in the order, expected each of {n} once", order.len()));
    }
    // Row k of L contains the nodes on the paths of the elimination tree from its earlier neighbours up to k.
    let (mut parent, mut seen, mut below) = (vec![NONE; n], vec![NONE; n], vec![0u32; n]);
    for k in 0..n {
        seen[k] = k;
        for &neighbour in graph.row(order[k] as usize) {
            let mut i = position[neighbour as usize];
            while i < k && seen[i] != k {
                if parent[i] == NONE {
                    parent[i] = k;
                }
                below[i] += 1;
                seen[i] = k;
                i = parent[i];
            }
        }
    }
    let columns = below.iter().flat_map(|&below| (1..=3).map(move |own| 3.0 * f64::from(below) + f64::from(own)));
    Ok(columns.fold([0.0, 0.0], |[numbers, operations], c| [numbers + c, operations + c * c]))
}

/// The order of faer's AMD on the graph of the nodes.
fn minimum_degree(graph: &Graph) -> Result<Vec<u32>, String> {
    let n = graph.len();
    let (mut starts, mut rows) = (vec![0usize], Vec::new());
    for j in 0..n {
        rows.extend(graph.row(j).iter().map(|&i| i as usize).filter(|&i| i < j));
        starts.push(rows.len());
    }
    let count = rows.len();
    let pattern = SymbolicSparseColMat::<usize>::new_checked(n, n, starts, None, rows);
    let (mut order, mut inverse) = (vec![0usize; n], vec![0usize; n]);
    let mut memory = MemBuffer::new(amd::order_scratch::<usize>(n, count));
    amd::order(&mut order, &mut inverse, pattern.as_ref(), amd::Control::default(), MemStack::new(&mut memory))
        .map_err(|error| format!("{error:?}"))?;
    Ok(order.into_iter().map(|node| node as u32).collect())
}

/// Writes the graph in the format of METIS: nodes and edges, then the neighbours of each node, counted from 1.
fn write_graph(path: &Path, graph: &Graph) -> io::Result<()> {
    let others = |i: usize| graph.row(i).iter().filter(move |&&j| j as usize != i);
    let edges: usize = (0..graph.len()).map(|i| others(i).count()).sum::<usize>() / 2;
    let mut text = format!("{} {edges}\n", graph.len());
    for i in 0..graph.len() {
        text += &others(i).map(|j| (j + 1).to_string()).collect::<Vec<_>>().join(" ");
        text += "\n";
    }
    fs::write(path, text)
}
