//! The modules in the order of their dependence: each uses only those before it.
#![allow(clippy::float_cmp, reason = "counts are exact")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Modules on one line may not use each other; a module may use those on the lines before.
const LAYERS: &[&[&str]] = &[
    &["tensor", "units", "machine", "pulse", "separated", "time"],
    &["arrays", "expression"],
    &["quadrature", "field", "vtu"],
    &["element", "vtkhdf"],
    &["mesh"],
    &["material", "contact", "space"],
    &["linalg"],
    &["mass"],
    &["problem"],
    &["rigid"],
    &["inclusion"],
    &["forms"],
    &["discretization"],
    &["model"],
    &["hypotheses"],
    &["state"],
    &["equation"],
    &["account", "majorant", "stability"],
    &["step"],
    &["convergence"],
    &["output"],
    &["adjoint"],
    &["identification"],
    &["run", "case"],
    &["accuracy", "plot"],
    &["contract", "verify"],
];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a source folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn a_module_uses_only_those_before_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let layer = |module: &str| LAYERS.iter().position(|layer| layer.contains(&module));
    let mut broken = Vec::new();
    for file in files {
        let inside = file.strip_prefix(&root).expect("a file below src");
        let module = inside
            .components()
            .next()
            .expect("a name")
            .as_os_str()
            .to_string_lossy()
            .trim_end_matches(".rs")
            .to_owned();
        // Tests may use anything.
        if module == "lib" || inside.ends_with("tests.rs") {
            continue;
        }
        let Some(own) = layer(&module) else {
            broken.push(format!("{module} has no place in the order"));
            continue;
        };
        let text = fs::read_to_string(&file).expect("a source file");
        let code = text.split("\nmod tests").next().unwrap_or_default();
        for (number, line) in code.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//")) {
            for used in line.split("crate::").skip(1) {
                let name: String = used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                if let Some(other) = layer(&name)
                    && (other > own || (other == own && name != module))
                {
                    broken.push(format!("{}:{}: {module} uses {name}", inside.display(), number + 1));
                }
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

/// The paths that begin a code: of `super::{a::{b, c}, d}` they are `super::a::b`, `super::a::c` and `super::d`. What
/// is left of the code is returned with them.
fn tree(code: &str) -> (Vec<Vec<String>>, &str) {
    let mut code = code.trim_start();
    if let Some(list) = code.strip_prefix('{') {
        let mut paths = Vec::new();
        code = list;
        loop {
            let (inside, rest) = tree(code);
            paths.extend(inside);
            // Past what may follow a name, as in `a as b`.
            let end = rest.find([',', '}']).unwrap_or(rest.len());
            code = rest.get(end + 1..).unwrap_or_default();
            if !rest[end..].starts_with(',') {
                return (paths, code);
            }
        }
    }
    let end = code.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(code.len());
    let (name, rest) = code.split_at(end);
    match rest.strip_prefix("::") {
        Some(inner) => {
            let (paths, rest) = tree(inner);
            (paths.into_iter().map(|path| [vec![name.to_owned()], path].concat()).collect(), rest)
        }
        None => (vec![vec![name.to_owned()]], rest),
    }
}

/// The paths in a code that begin with `crate` or `super`, as a module with this path means them, from the root.
fn paths(code: &str, module: &[String]) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for root in ["crate::", "super::"] {
        // Not the end of another path or name: `super::super::`, `pub(in crate::mesh)` is one.
        let starts = code.match_indices(root).map(|(start, _)| start);
        let starts =
            starts.filter(|&start| !code[..start].ends_with(|c: char| c == ':' || c == '_' || c.is_alphanumeric()));
        found.extend(starts.flat_map(|start| tree(&code[start..]).0));
    }
    let from_root = |path: Vec<String>| {
        let up = path.iter().take_while(|name| *name == "super").count();
        let first = if up > 0 { &module[..module.len().saturating_sub(up)] } else { &[] };
        [first, &path[up.max(1)..]].concat()
    };
    found.into_iter().map(from_root).collect()
}

/// The modules of each folder, at every depth, with those of the same folder that each uses; what is below a module
/// belongs to it, and `mod.rs` to the folder.
type Uses = BTreeMap<Vec<String>, BTreeMap<String, BTreeSet<String>>>;

fn uses(root: &Path) -> Uses {
    let mut files = Vec::new();
    sources(root, &mut files);
    let module = |file: &Path| {
        let inside = file.strip_prefix(root).expect("a file below the root").with_extension("");
        let names = inside.iter().map(|name| name.to_string_lossy().into_owned());
        names.filter(|name| !["mod", "lib", "main"].contains(&name.as_str())).collect::<Vec<_>>()
    };
    let modules: BTreeSet<Vec<String>> = files.iter().map(|file| module(file)).collect();
    let mut graphs = Uses::new();
    // Tests may use anything.
    for file in files.iter().filter(|file| !module(file).iter().any(|name| name == "tests")) {
        let own = module(file);
        let text = fs::read_to_string(file).expect("a source file");
        let code = text.split("\nmod tests").next().unwrap_or_default();
        // A list of names may take several lines.
        let code: Vec<&str> = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for path in paths(&code.join(" "), &own) {
            let length = (0..=path.len()).rev().find(|&length| modules.contains(&path[..length])).unwrap_or(0);
            let common = own.iter().zip(&path[..length]).take_while(|(a, b)| a == b).count();
            if common < own.len() && common < length {
                let graph = graphs.entry(own[..common].to_vec()).or_default();
                graph.entry(own[common].clone()).or_default().insert(path[common].clone());
                graph.entry(path[common].clone()).or_default();
            }
        }
    }
    graphs
}

/// A circle of modules, if there is one: what is left when modules that use none of the rest are taken away again and
/// again.
fn circle(mut graph: BTreeMap<String, BTreeSet<String>>) -> Option<String> {
    loop {
        let free: Vec<String> =
            graph.iter().filter(|(_, uses)| uses.is_empty()).map(|(name, _)| name.clone()).collect();
        if free.is_empty() {
            break;
        }
        graph.retain(|name, _| !free.contains(name));
        for uses in graph.values_mut() {
            uses.retain(|used| !free.contains(used));
        }
    }
    (!graph.is_empty())
        .then(|| graph.iter().map(|(name, uses)| format!("{name} uses {uses:?}")).collect::<Vec<_>>().join("; "))
}

#[test]
fn the_modules_of_a_folder_do_not_use_each_other_in_a_circle() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut circles = Vec::new();
    for (root, folders) in [(package.join("src"), 25), (package.join("../amontons-cli/src"), 2)] {
        let graphs = uses(&root);
        let count = graphs.values().flat_map(BTreeMap::values).map(BTreeSet::len).sum::<usize>();
        assert!(graphs.len() >= folders && count > 10 * folders, "{}: the imports are not read", root.display());
        circles.extend(graphs.into_iter().filter_map(|(folder, graph)| Some((folder.join("/"), circle(graph)?))));
    }
    assert!(circles.is_empty(), "{circles:#?}");
}

#[test]
fn a_circle_is_found() {
    let found = |code: &str| -> Vec<String> {
        let module = ["case", "raw", "mesh"].map(str::to_owned);
        paths(code, &module).into_iter().map(|path| path.join("::")).collect()
    };
    assert_eq!(found("use super::{a::{b, c as e}, d};"), ["case::raw::a::b", "case::raw::a::c", "case::raw::d"]);
    assert_eq!(found("x = super::e::f(super::super::g, crate::h);"), ["h", "case::raw::e::f", "case::g"]);
    assert!(found("amontons::super_h(my_crate::i, self::j)").is_empty());
    let graph = |edges: &[(&str, &[&str])]| {
        edges.iter().map(|(from, to)| ((*from).to_owned(), to.iter().map(|to| (*to).to_owned()).collect())).collect()
    };
    assert!(circle(graph(&[("a", &["b"]), ("b", &["c"]), ("c", &[])])).is_none());
    assert!(circle(graph(&[("a", &["b"]), ("b", &["c"]), ("c", &["b"])])).is_some());
}

/// Comments keep to the width of the code, but for tables, examples and words that have no place to break.
#[test]
fn comments_keep_to_120_columns() {
    let width: usize = 120;
    let mut wide = Vec::new();
    let mut files = Vec::new();
    for folder in [".", "../amontons-cli", "../../xtask"] {
        for inside in ["src", "tests", "benches", "examples"]
            .map(|inside| Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join(inside))
        {
            if inside.is_dir() {
                sources(&inside, &mut files);
            }
        }
    }
    for file in &files {
        let text = fs::read_to_string(file).expect("a source file");
        let mut example = false;
        for (number, line) in text.lines().enumerate() {
            let Some(comment) = line.trim_start().strip_prefix("//") else { continue };
            let said = comment.trim_start_matches(['/', '!']).trim_start();
            example ^= said.starts_with("```");
            if !example && !said.starts_with('|') && said.contains(' ') && line.chars().count() > width {
                wide.push(format!("{}:{}", file.display(), number + 1));
            }
        }
    }
    assert!(files.len() > 200 && wide.is_empty(), "{}", wide.join("\n"));
}

/// The files that a source file declares as modules.
fn declared(file: &Path) -> Vec<PathBuf> {
    let text = fs::read_to_string(file).expect("a source file");
    let folder = file.parent().expect("a folder");
    let mut path = None;
    let mut found = Vec::new();
    for line in text.lines().map(str::trim) {
        if let Some(given) = line.strip_prefix("#[path = \"") {
            path = given.split('"').next();
        } else if let Some(name) =
            line.trim_start_matches("pub ").strip_prefix("mod ").and_then(|m| m.strip_suffix(';'))
        {
            match path.take() {
                Some(given) => found.push(folder.join(given)),
                None => found.extend([folder.join(name).with_extension("rs"), folder.join(name).join("mod.rs")]),
            }
        }
    }
    found.iter().filter_map(|file| file.canonicalize().ok()).collect()
}

/// A file of tests that no program declares is not built, and its tests are never run.
#[test]
fn every_test_file_is_part_of_a_program() {
    let mut lost = Vec::new();
    for folder in [".", "../amontons-cli"] {
        let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).join("tests").canonicalize().expect("tests");
        let mut files = Vec::new();
        sources(&tests, &mut files);
        let declared: BTreeSet<PathBuf> = files.iter().flat_map(|file| declared(file)).collect();
        let is_program = |file: &Path| {
            let folder = file.parent().expect("a folder");
            folder == tests || (file.ends_with("main.rs") && folder.parent() == Some(&tests))
        };
        assert!(files.iter().any(|file| is_program(file)));
        lost.extend(files.into_iter().filter(|file| !is_program(file) && !declared.contains(file)));
    }
    assert!(lost.is_empty(), "{lost:?}");
}

/// Whether the tests of the library have what follows `--test` in a text: the name of a program, and words of which
/// each is the name of one of its files or a part of the name of one of its tests.
fn has_tests(named: &str) -> bool {
    let mut words = named.split_whitespace().skip_while(|word| *word == "--");
    let Some(program) = words.next() else { return false };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(program);
    if !folder.join("main.rs").is_file() {
        return false;
    }
    let mut files = Vec::new();
    sources(&folder, &mut files);
    let texts: Vec<String> = files.iter().map(|file| fs::read_to_string(file).expect("a source file")).collect();
    let is_there = |name: &str| {
        files.iter().any(|file| file.file_stem().is_some_and(|stem| stem == name))
            || texts
                .iter()
                .flat_map(|text| text.split("fn ").skip(1))
                .any(|test| test.split('(').next().is_some_and(|test| test.contains(name)))
    };
    let mut filters = Vec::new();
    while let Some(word) = words.next() {
        match word {
            "--test-threads" => drop(words.next()),
            option if option.starts_with("--") => {}
            filter => filters.push(filter),
        }
    }
    filters.iter().flat_map(|filter| filter.split("::")).all(is_there)
}

/// Commands in the documents run tests that are there.
#[test]
fn the_tests_that_documents_name_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (mut named, mut lost) = (0, Vec::new());
    for folder in [".", "book/src", "docs/adr", "crates/amontons/benches"] {
        let files = fs::read_dir(root.join(folder)).expect("a folder of documents").flatten();
        for file in files.map(|file| file.path()).filter(|file| file.extension().is_some_and(|e| e == "md")) {
            let text = fs::read_to_string(&file).expect("a document");
            for words in text.split("--test ").skip(1).filter_map(|rest| rest.split(['`', '\n']).next()) {
                named += 1;
                if !has_tests(words) {
                    lost.push(format!("{}: {words}", file.display()));
                }
            }
        }
    }
    assert!(named > 5 && lost.is_empty(), "{lost:?}");
    assert!(!has_tests("bodies no_such_test") && !has_tests("no_such_program") && has_tests("bodies cyclic"));
}
