//! Lists the benchmark cases of `benchmarks/` and the meshes beside them, so that adding one is a matter of files
//! there.

use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=benchmarks");
    let folder = Path::new(&env::var("CARGO_MANIFEST_DIR").map_err(io::Error::other)?).join("benchmarks");
    let out = env::var("OUT_DIR").map_err(io::Error::other)?;
    let mut cases = String::from("&[\n");
    for name in names(&folder)?.iter().filter_map(|file| file.strip_suffix(".toml")) {
        let file = folder.join(format!("{name}.toml"));
        cases.push_str(&format!("    ({name:?}, include_str!({:?})),\n", file.display().to_string()));
    }
    fs::write(Path::new(&out).join("benchmarks.rs"), cases + "]\n")?;
    let mut meshes = String::from("&[\n");
    for file in names(&folder.join("meshes"))? {
        let name = format!("meshes/{file}");
        meshes.push_str(&format!("    ({name:?}, include_bytes!({:?})),\n", folder.join(&name).display().to_string()));
    }
    fs::write(Path::new(&out).join("benchmark_meshes.rs"), meshes + "]\n")
}

/// Names of the files in a folder, in order.
fn names(folder: &Path) -> io::Result<Vec<String>> {
    let mut names: Vec<String> =
        fs::read_dir(folder)?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    names.sort();
    Ok(names)
}
