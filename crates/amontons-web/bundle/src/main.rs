//! Writes the page for a browser as one file, which needs no server and asks for no other file, and beside it the
//! licences of the libraries in it:
//! `cargo run --release --manifest-path crates/amontons-web/bundle/Cargo.toml [-- [--profile PROFILE] FILE]`.
//!
//! The library is compiled to WebAssembly, compressed, and put into the page beside its script, its style and the
//! paper's case. `release/licences` lists the licences, with Python 3: `PYTHON` may name the interpreter.

use std::error::Error;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
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
/// How the library is compiled unless `--profile` says so.
const PROFILE: &str = "release";
/// What the name of the licences has beyond that of the page.
const LICENCES: &str = "-THIRD-PARTY.txt";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments: Vec<OsString> = env::args_os().skip(1).collect();
    let profile = match arguments.first() {
        Some(first) if first == "--profile" && arguments.len() > 1 => arguments.drain(..2).nth(1),
        _ => None,
    };
    let profile = profile.unwrap_or_else(|| PROFILE.into());
    let file = PathBuf::from(arguments.pop().unwrap_or_else(|| "amontons.html".into()));
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let name = file.file_name().ok_or_else(|| format!("found {}, expected the name of a file", file.display()))?;
    let beside = format!("{}{LICENCES}", name.to_string_lossy());
    let licences = licences(&package)?;
    let [glue, library] = bound(&compiled(&package, &profile)?)?;
    let page = page(&String::from_utf8(glue)?, &library, &beside)?;
    let put = |file: &Path, text: &[u8]| {
        fs::write(file, text).map_err(|error| format!("cannot write {}: {error}", file.display()))
    };
    put(&file.with_file_name(beside), &licences)?;
    put(&file, page.as_bytes())?;
    eprintln!("{}: {:.1} MB", file.display(), page.len() as f64 / 1e6);
    Ok(())
}

/// The licences of all that the page is made of.
fn licences(package: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
    let python = env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let mut command = Command::new(python);
    command.arg(package.join("../../release/licences")).arg("--manifest-path").arg(package.join("Cargo.toml"));
    let done = command.args(["--package", "amontons-web", "--target", TARGET]).stderr(Stdio::inherit()).output();
    let done = done.map_err(|error| format!("release/licences needs Python 3, which PYTHON may name: {error}"))?;
    if done.status.success() {
        Ok(done.stdout)
    } else {
        Err("the licences of the libraries could not be listed".into())
    }
}

/// The library as WebAssembly, compiled with a profile of the workspace.
fn compiled(package: &Path, profile: &OsStr) -> Result<PathBuf, Box<dyn Error>> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| package.join("../../target"), PathBuf::from);
    let manifest = package.join("Cargo.toml");
    let mut command = Command::new(cargo);
    command
        .args(["build", "--locked", "--package", "amontons-web", "--lib", "--target", TARGET, "--profile"])
        .arg(profile);
    command.arg("--manifest-path").arg(&manifest).arg("--target-dir").arg(&target);
    let status = command.status()?;
    if status.success() {
        Ok(target.join(TARGET).join(profile).join("amontons_web.wasm"))
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

/// The page with all that it needs, and a link to the file beside it that has the licences.
fn page(glue: &str, library: &[u8], licences: &str) -> Result<String, Box<dyn Error>> {
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
        ("{licences}", address(licences)),
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

/// A name of a file as an address has it.
fn address(name: &str) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
    name.bytes().map(|b| if plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

/// The source of a script or style that the browser may run.
fn allowed(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}
