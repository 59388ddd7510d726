//! The modules in the order of their dependence: each uses only those before it.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, clippy::float_cmp, reason = "a test fails by panicking, and counts are exact")]

use std::fs;
use std::path::{Path, PathBuf};

/// Modules on one line may not use each other; a module may use those on the lines before.
const LAYERS: &[&[&str]] = &[
    &["tensor", "expression", "units"],
    &["quadrature", "field", "vtu"],
    &["element"],
    &["mesh"],
    &["material", "contact", "space"],
    &["problem"],
    &["linalg"],
    &["inclusion"],
    &["forms"],
    &["discretization"],
    &["model"],
    &["hypotheses"],
    &["scheme"],
    &["convergence"],
    &["output"],
    &["run", "case"],
    &["plot"],
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
        let module = inside.components().next().expect("a name").as_os_str().to_string_lossy().trim_end_matches(".rs").to_owned();
        if module == "lib" {
            continue;
        }
        let Some(own) = layer(&module) else {
            broken.push(format!("{module} has no place in the order"));
            continue;
        };
        let text = fs::read_to_string(&file).expect("a source file");
        // Tests may use anything.
        let code = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
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
