//! Writes the page for a browser as one file, which needs no server and asks for no other file:
//! `cargo run --release --manifest-path crates/amontons-web/Cargo.toml [-- FILE]`.
//!
//! The library is compiled to WebAssembly, compressed, and put into the page beside its script, its style and the
//! paper's case.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};
use wasm_bindgen_cli_support::Bindgen;

const TARGET: &str = "wasm32-unknown-unknown";
const PAGE: &str = include_str!("../../page/index.html");
/// The style of reports, and what the page has beside it.
const STYLE: &str =
    concat!(include_str!("../../../amontons/src/plot/report/page/style.css"), include_str!("../../page/style.css"));
const SCRIPT: &str = include_str!("../../page/main.js");
const WORKER: &str = include_str!("../../page/worker.js");
const CASE: &str = include_str!("../../../../cases/paper.toml");
const LEVEL: u8 = 9;

fn main() -> Result<(), Box<dyn Error>> {
    let file = PathBuf::from(env::args_os().nth(1).unwrap_or_else(|| "amontons.html".into()));
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let [glue, library] = bound(&compiled(&package)?)?;
    let page = page(&String::from_utf8(glue)?, &library)?;
    fs::write(&file, &page).map_err(|error| format!("cannot write {}: {error}", file.display()))?;
    eprintln!("{}: {:.1} MB", file.display(), page.len() as f64 / 1e6);
    Ok(())
}

/// The library as WebAssembly.
fn compiled(package: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| package.join("target"), PathBuf::from);
    let manifest = package.join("Cargo.toml");
    let mut command = Command::new(cargo);
    command.args([
        "build",
        "--release",
        "--locked",
        "--package",
        "amontons-web",
        "--target",
        TARGET,
        "--manifest-path",
    ]);
    let status = command.arg(&manifest).arg("--target-dir").arg(&target).status()?;
    if status.success() {
        Ok(target.join(TARGET).join("release/amontons_web.wasm"))
    } else {
        Err(format!("the library could not be compiled for {TARGET}; `rustup target add {TARGET}` adds this target")
            .into())
    }
}

/// The script that calls the library, and the library with what the script needs of it.
fn bound(library: &Path) -> Result<[Vec<u8>; 2], Box<dyn Error>> {
    let folder = library.with_extension("bound");
    Bindgen::new().input_path(library).no_modules(true)?.typescript(false).out_name("amontons").generate(&folder)?;
    Ok([fs::read(folder.join("amontons.js"))?, fs::read(folder.join("amontons_bg.wasm"))?])
}

/// The page with all that it needs.
fn page(glue: &str, library: &[u8]) -> Result<String, Box<dyn Error>> {
    let library = STANDARD.encode(miniz_oxide::deflate::compress_to_vec_zlib(library, LEVEL));
    let worker = format!("\"use strict\";\n{glue}\n{WORKER}");
    // Within a script only `<` of a closing tag could end it.
    if [&worker, CASE, SCRIPT].iter().any(|text| text.contains("</script")) {
        return Err("a script of the page has a closing tag".into());
    }
    let parts = [
        ("{style hash}", allowed(STYLE)),
        ("{script hash}", allowed(SCRIPT)),
        ("{style}", STYLE.to_owned()),
        ("{script}", SCRIPT.to_owned()),
        ("{version}", env!("CARGO_PKG_VERSION").to_owned()),
        ("{case}", CASE.to_owned()),
        ("{worker}", worker),
        ("{library}", library),
    ];
    // Each place is filled once, in the order of the page, so that no part is searched for places.
    let (mut out, mut rest) = (String::new(), PAGE);
    let first =
        |rest: &str| parts.iter().filter_map(|part| Some((rest.find(part.0)?, part))).min_by_key(|found| found.0);
    while let Some((at, (place, text))) = first(rest) {
        out += &rest[..at];
        out += text;
        rest = &rest[at + place.len()..];
    }
    Ok(out + rest)
}

/// The source of a script or style that the browser may run.
fn allowed(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}
