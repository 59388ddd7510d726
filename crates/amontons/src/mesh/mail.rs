//! Text meshes of Code_Aster (`.mail`), as described in its document U3.01.00.
//!
//! A file is a sequence of blocks that begin with a keyword and end with `FINSF`, and ends with `FIN`: the nodes by
//! their names (`COOR_3D`), the cells of each type (`HEXA20`), and groups of cells and nodes (`GROUP_MA`, `GROUP_NO`).
//! Words are separated by blanks and commas, and `%` begins a comment. The keyword may have parameters: `NOM` names a
//! group, and `NBLIGE` gives the number of lines of the head of the block.
//!
//! Groups become regions, sides, edges and points as for [`med`](super::med).

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::Mesh;
use super::read::{FilePosition, Kind, Loose, LooseBlock, MeshFile, MeshFileError, NodeSet};
use crate::element::{CellType, Element};
use crate::tensor::Point;

/// The types of cells that the library lacks.
const MISSING: [&str; 2] = ["SEG4", "TRIA7"];
/// Words that may begin a block, for messages.
const KEYWORDS: &str = "TITRE, COOR_2D, COOR_3D, a type of cells such as HEXA20, GROUP_MA, GROUP_NO or FIN";

/// Reads a mesh from the bytes of a `.mail` file: cells → blocks in the order in which types and groups occur.
///
/// # Errors
/// Fails if the bytes are no mesh of one body; the error names the line.
pub fn parse(bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    read(bytes).map(|read| read.mesh)
}

/// Reads the mesh and the list of skipped contents.
pub(super) fn read(bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = MailLines::new(&text);
    let mut file = MailFile::default();
    while let Some((line, words)) = lines.next() {
        let Some(first) = words.first() else { continue };
        if first.eq_ignore_ascii_case("FIN") {
            return file.loose()?.into_read(FilePosition::Line);
        }
        file.take(&MailBlock::of(line, &words, &mut lines)?)?;
    }
    Err(syntax(lines.number.max(1), "the end of the file", "FIN, which ends a mesh of Code_Aster; it may be truncated"))
}

fn syntax(line: usize, found: impl Into<String>, expected: impl Into<String>) -> MeshFileError {
    MeshFileError::Syntax { at: FilePosition::Line(line), found: found.into(), expected: expected.into() }
}

/// A word of the file as quoted in messages.
fn quoted(word: &str) -> String {
    format!("{:?}", word.chars().take(40).collect::<String>())
}

/// The nonempty lines, with their numbers.
struct MailLines<'t> {
    text: std::str::Lines<'t>,
    /// Number of the last line.
    number: usize,
}

impl<'t> MailLines<'t> {
    fn new(text: &'t str) -> MailLines<'t> {
        MailLines { text: text.lines(), number: 0 }
    }

    /// The words of the next nonempty line. An equals sign is a separate word.
    fn next(&mut self) -> Option<(usize, Vec<&'t str>)> {
        loop {
            let text = self.text.next()?;
            self.number += 1;
            let text = text.split('%').next().unwrap_or_default();
            let words = text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
            let words: Vec<&str> = words.flat_map(at_equals).collect();
            if !words.is_empty() {
                return Some((self.number, words));
            }
        }
    }
}

/// Splits `NOM=A` into three words.
fn at_equals(word: &str) -> impl Iterator<Item = &str> {
    word.split_inclusive('=')
        .flat_map(|part| match part.strip_suffix('=') {
            Some(name) => [name, "="],
            None => [part, ""],
        })
        .filter(|part| !part.is_empty())
}

/// A block: its keyword with line and parameters, and its words with their lines.
struct MailBlock<'t> {
    line: usize,
    keyword: String,
    parameters: BTreeMap<String, &'t str>,
    words: Vec<(usize, &'t str)>,
}

impl<'t> MailBlock<'t> {
    /// The block that begins with these words, read to its end.
    fn of(line: usize, words: &[&'t str], lines: &mut MailLines<'t>) -> Result<MailBlock<'t>, MeshFileError> {
        let keyword = words.first().copied().unwrap_or_default().to_ascii_uppercase();
        let is_known = ["TITRE", "COOR_1D", "COOR_2D", "COOR_3D", "GROUP_MA", "GROUP_NO"].contains(&keyword.as_str())
            || MISSING.contains(&keyword.as_str())
            || cell_type(&keyword).is_some();
        if !is_known {
            return Err(syntax(line, quoted(words.first().copied().unwrap_or_default()), KEYWORDS));
        }
        let mut section = MailBlock { line, keyword, parameters: BTreeMap::new(), words: Vec::new() };
        // The rest of the keyword line holds the first words of the block, further head lines are remarks.
        let others = section.head(words.get(1..).unwrap_or_default());
        section.words.extend(others.into_iter().map(|word| (line, word)));
        let of_head = section.parameters.get("NBLIGE").and_then(|count| count.parse::<usize>().ok()).unwrap_or(1);
        let mut number = 1;
        while let Some((line, words)) = lines.next() {
            number += 1;
            if words.first().is_some_and(|word| word.eq_ignore_ascii_case("FINSF")) {
                return Ok(section);
            }
            if number <= of_head {
                section.head(&words);
            } else {
                section.words.extend(words.into_iter().map(|word| (line, word)));
            }
        }
        let found = format!("the end of the file in the block {} of line {line}", section.keyword);
        Err(syntax(lines.number, found, "FINSF, which ends a block; it may be truncated"))
    }

    /// Reads the parameters of a head line; returns its other words.
    fn head(&mut self, words: &[&'t str]) -> Vec<&'t str> {
        let (mut at, mut others) = (0, Vec::new());
        while let Some(&word) = words.get(at) {
            if let (Some(&"="), Some(&value)) = (words.get(at + 1), words.get(at + 2)) {
                self.parameters.insert(word.to_ascii_uppercase(), value);
                at += 3;
            } else {
                others.push(word);
                at += 1;
            }
        }
        others
    }
}

/// The type of cells with a name, and the element that they become.
fn cell_type(name: &str) -> Option<(&'static Element, &'static CellType)> {
    CellType::find(|_, cell| cell.mail == Some(name))
}

/// A cell of the file.
struct MailCell<'t> {
    line: usize,
    /// Its type, as for [`cell_type`].
    kind: (&'static Element, &'static CellType),
    nodes: Vec<&'t str>,
    groups: BTreeSet<String>,
}

/// The contents of the blocks.
#[derive(Default)]
struct MailFile<'t> {
    points: Vec<Point>,
    nodes: HashMap<&'t str, u32>,
    /// Line of the coordinates.
    given: Option<usize>,
    cells: Vec<MailCell<'t>>,
    of_name: HashMap<&'t str, usize>,
    /// Groups of cells and of nodes, with the lines and names of their members.
    groups: Vec<(String, Vec<(usize, &'t str)>)>,
    node_groups: Vec<(String, Vec<(usize, &'t str)>)>,
}

impl<'t> MailFile<'t> {
    fn take(&mut self, section: &MailBlock<'t>) -> Result<(), MeshFileError> {
        match section.keyword.as_str() {
            "TITRE" => Ok(()),
            "COOR_1D" => self.coordinates(section, 1),
            "COOR_2D" => self.coordinates(section, 2),
            "COOR_3D" => self.coordinates(section, 3),
            "GROUP_MA" | "GROUP_NO" => self.group(section),
            _ => self.cells(section),
        }
    }

    /// Reads nodes: a name and one coordinate per dimension of the space.
    fn coordinates(&mut self, section: &MailBlock<'t>, dim: usize) -> Result<(), MeshFileError> {
        if let Some(before) = self.given.replace(section.line) {
            let found = format!("{} after the coordinates of line {before}", section.keyword);
            return Err(syntax(section.line, found, "the coordinates of all nodes in one block"));
        }
        for entry in section.words.chunks(dim + 1) {
            let Some((&(line, name), values)) = entry.split_first() else { continue };
            let mut x = [0.0; 3];
            for (c, x) in x.iter_mut().enumerate().take(dim) {
                let Some(&(line, word)) = values.get(c) else {
                    let found = format!("{c} coordinates of the node {}", quoted(name));
                    return Err(syntax(line, found, format!("{dim} coordinates")));
                };
                *x = real(word).ok_or_else(|| {
                    let found = format!("{} as a coordinate of the node {}", quoted(word), quoted(name));
                    syntax(line, found, "a finite number")
                })?;
            }
            if self.nodes.insert(name, self.points.len() as u32).is_some() {
                return Err(syntax(
                    line,
                    format!("the node {} again", quoted(name)),
                    "a name of its own for each node",
                ));
            }
            self.points.push(x);
        }
        Ok(())
    }

    /// Reads cells of one type: a name and the names of the nodes.
    fn cells(&mut self, section: &MailBlock<'t>) -> Result<(), MeshFileError> {
        let code = &section.keyword;
        let Some(kind) = cell_type(code) else {
            let (at, known) = (FilePosition::Line(section.line), CellType::names(|cell| cell.mail));
            let missing = MeshFileError::Element { at, found: code.clone(), known };
            return if section.words.is_empty() { Ok(()) } else { Err(missing) };
        };
        let nodes = kind.1.nodes;
        for entry in section.words.chunks(nodes + 1) {
            let Some((&(line, name), of_cell)) = entry.split_first() else { continue };
            if of_cell.len() < nodes {
                // If a node was missing before, the name of the next cell occupies its position.
                let mut of_cells = section.words.chunks(nodes + 1).flat_map(|entry| entry.iter().skip(1));
                let unknown = of_cells.find(|(_, node)| !self.nodes.is_empty() && !self.nodes.contains_key(node));
                if let Some(&(line, node)) = unknown {
                    return self.node(line, node).map(|_| ());
                }
                let found = format!("{} nodes of the cell {}", of_cell.len(), quoted(name));
                return Err(syntax(line, found, format!("{nodes} nodes of a {code}")));
            }
            if self.of_name.insert(name, self.cells.len()).is_some() {
                return Err(syntax(
                    line,
                    format!("the cell {} again", quoted(name)),
                    "a name of its own for each cell",
                ));
            }
            let nodes = of_cell.iter().map(|(_, node)| *node).collect();
            self.cells.push(MailCell { line, kind, nodes, groups: BTreeSet::new() });
        }
        Ok(())
    }

    /// Reads a group, whose name is a parameter or the first word.
    fn group(&mut self, section: &MailBlock<'t>) -> Result<(), MeshFileError> {
        let (name, members) = match (section.parameters.get("NOM"), section.words.split_first()) {
            (Some(name), _) => (*name, section.words.as_slice()),
            (None, Some(((_, name), rest))) => (*name, rest),
            (None, None) => {
                let found = format!("a {} without a name", section.keyword);
                return Err(syntax(section.line, found, "its name, and the names of what it holds"));
            }
        };
        let groups = if section.keyword == "GROUP_MA" { &mut self.groups } else { &mut self.node_groups };
        groups.push((name.to_owned(), members.to_vec()));
        Ok(())
    }

    /// Resolves names and returns the contents.
    fn loose(mut self) -> Result<Loose, MeshFileError> {
        for (name, members) in std::mem::take(&mut self.groups) {
            for (line, member) in members {
                let cell = self.of_name.get(member).and_then(|&cell| self.cells.get_mut(cell));
                let cell = cell.ok_or_else(|| {
                    let found = format!("the cell {} in the group {}", quoted(member), quoted(&name));
                    syntax(line, found, "a cell of the file")
                })?;
                cell.groups.insert(name.clone());
            }
        }
        let mut node_sets: BTreeMap<String, BTreeSet<u32>> = BTreeMap::new();
        for (name, members) in std::mem::take(&mut self.node_groups) {
            let nodes = members.iter().map(|&(line, node)| self.node(line, node));
            let nodes: BTreeSet<u32> = nodes.collect::<Result<_, _>>()?;
            node_sets.entry(name).or_default().extend(nodes);
        }
        let mut tags: BTreeMap<(usize, String), i64> = BTreeMap::new();
        let mut index: HashMap<(&str, BTreeSet<i64>), usize> = HashMap::new();
        let mut positions: HashMap<&str, Vec<usize>> = HashMap::new();
        let mut blocks: Vec<LooseBlock> = Vec::new();
        for cell in &self.cells {
            let (element, &CellType { nodes, mail: Some(name), .. }) = cell.kind else { continue };
            let dim = element.dim();
            let tag = |group: &String| {
                let next = tags.len() as i64;
                *tags.entry((dim, group.clone())).or_insert(next)
            };
            let groups: BTreeSet<i64> = cell.groups.iter().map(tag).collect();
            let block = *index.entry((name, groups.clone())).or_insert_with(|| {
                let kind = Kind { name, dim, nodes, element: Some(element) };
                blocks.push(LooseBlock { kind, groups, at: cell.line, nodes: Vec::new(), numbers: Vec::new() });
                blocks.len() - 1
            });
            for position in positions.entry(name).or_insert_with(|| element.orders.mail.positions(nodes)) {
                let name = cell.nodes.get(*position).copied().unwrap_or_default();
                let node = self.node(cell.line, name)?;
                blocks.get_mut(block).into_iter().for_each(|block| block.nodes.push(node));
            }
        }
        let names = tags.into_iter().map(|((dim, name), tag)| ((dim, tag), name)).collect();
        let node_sets = node_sets.into_iter().map(|(name, nodes)| NodeSet { name, nodes }).collect();
        Ok(Loose { points: self.points, blocks, names, node_sets, ..Loose::default() })
    }

    fn node(&self, line: usize, name: &str) -> Result<u32, MeshFileError> {
        self.nodes.get(name).copied().ok_or_else(|| {
            let expected = format!("the name of one of the {} nodes of the file", self.points.len());
            syntax(line, format!("the node {}", quoted(name)), expected)
        })
    }
}

/// A finite number, with E or D as exponent letter.
fn real(word: &str) -> Option<f64> {
    let value = word.parse().or_else(|_| word.replace(['D', 'd'], "E").parse::<f64>());
    value.ok().filter(|value: &f64| value.is_finite())
}
