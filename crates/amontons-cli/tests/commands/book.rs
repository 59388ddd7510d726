//! The command blocks of the guide, typed by a shell as their readers type them.
//!
//! A block is one of the language `sh`, or an indented one that begins with the program. Blocks of the language
//! `sh,ignore` are not typed; a comment above them says why.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{assert_code, output, read, stdout};

/// Pages whose commands are for an empty folder; those of the others are for the source folder.
const ALONE: [&str; 2] = ["install.md", "commands.md"];
/// These have a test of their own, which compares what is printed, too.
const ELSEWHERE: [&str; 2] = ["tutorial.md", "decks.md"];
/// The tests of the library solve every shipped case against its expected values, as this does.
const SOLVED_ELSEWHERE: &str = "amontons verify cases/";
/// What a page takes to be there.
const PREPARED: [(&str, &str); 2] =
    [("runs.md", "amontons run cases/paper.toml --quiet"), ("report.md", "amontons run cases/clutch.toml --quiet")];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The pages in the order of the table of contents.
fn pages() -> Vec<String> {
    let contents = read(&root().join("book/src/SUMMARY.md"));
    let page = |line: &str| Some(line.split_once("](")?.1.split(')').next()?.to_owned());
    contents.lines().filter_map(page).collect()
}

/// The command lines of a page; `Err` where a block that is not typed has no reason.
fn commands(text: &str) -> Result<Vec<String>, String> {
    let (mut found, mut language, mut before) = (Vec::new(), None, "");
    let mut indented = false;
    for line in text.lines() {
        if let Some(mark) = line.strip_prefix("```") {
            language = match language {
                None => Some(mark),
                Some(_) => None,
            };
            let has_reason = before.starts_with("<!-- not run: ") && before.ends_with(" -->");
            if mark == "sh,ignore" && !has_reason {
                return Err(format!("no reason above a block that is not run, but \"{before}\""));
            }
        } else if language == Some("sh") {
            found.push(line.to_owned());
        } else if language.is_none() {
            let command = line.strip_prefix("    ").filter(|line| line.starts_with("amontons ") || indented);
            indented = command.is_some();
            found.extend(command.map(str::to_owned));
        }
        before = line;
    }
    found.retain(|line| !line.trim().is_empty() && !line.starts_with('#'));
    Ok(found)
}

/// Types lines into a shell in a folder. A run replaces results of the same name, which another page may have made.
fn typed(lines: &[String], page: &str, folder: &Path) {
    let program = Path::new(env!("CARGO_BIN_EXE_amontons")).parent().expect("a folder");
    let path = std::env::var("PATH").unwrap_or_default();
    let again =
        "amontons() { if [ \"$1\" = run ]; then command amontons \"$@\" --force; else command amontons \"$@\"; fi; }";
    let script = format!("set -euo pipefail\n{again}\n{}\n", lines.join("\n"));
    let mut shell = Command::new("bash");
    shell.args(["-c", &script]).current_dir(folder);
    shell.env("PATH", format!("{}:{path}", program.display())).env("HOME", folder).env("NO_COLOR", "1");
    let done = output(&mut shell);
    assert!(done.status.success(), "{page}: {}", lines.join("\n"));
    assert_code(&done, 0);
}

#[test]
#[cfg(unix)]
fn every_command_of_the_guide_runs() {
    let root = root().canonicalize().expect("the source folder");
    let source = tempfile::tempdir().expect("a folder");
    for name in ["cases", "crates"] {
        std::os::unix::fs::symlink(root.join(name), source.path().join(name)).expect("a link");
    }
    let (mut before, mut count) = (BTreeSet::new(), 0);
    for page in pages().iter().filter(|page| !ELSEWHERE.contains(&page.as_str())) {
        let lines = commands(&read(&root.join("book/src").join(page))).unwrap_or_else(|why| panic!("{page}: {why}"));
        count += lines.len();
        if ALONE.contains(&page.as_str()) {
            let folder = tempfile::tempdir().expect("a folder");
            for name in ["o-ring.inp", "punch.inp"] {
                fs::copy(root.join("cases").join(name), folder.path().join(name)).expect("a mesh");
            }
            typed(&lines, page, folder.path());
            continue;
        }
        let prepared = PREPARED.iter().filter(|(of, _)| of == page).map(|(_, line)| (*line).to_owned());
        // What another page has typed need not be solved again.
        let new: Vec<String> = prepared
            .chain(lines)
            .filter(|line| before.insert(line.clone()) && !line.starts_with(SOLVED_ELSEWHERE))
            .collect();
        if !new.is_empty() {
            typed(&new, page, source.path());
        }
    }
    assert!(count > 50, "{count} commands");
}

/// The page on commands has a section with a block for each command, its exit codes and its common options.
#[test]
fn the_page_on_commands_is_complete() {
    let page = read(&root().join("book/src/commands.md"));
    let help = stdout(&output(&mut crate::common::amontons(&["--help"])));
    let told = help.split("Commands:\n").nth(1).and_then(|rest| rest.split("\n\n").next()).expect("the commands");
    let names: Vec<&str> =
        told.lines().filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help").collect();
    let sections: BTreeMap<&str, &str> =
        page.split("\n## amontons ").skip(1).filter_map(|section| section.split_once('\n')).collect();
    assert_eq!(sections.keys().copied().collect::<BTreeSet<_>>(), names.iter().copied().collect());
    for (name, section) in &sections {
        assert!(section.contains("```sh") && section.contains(&format!("amontons {name}")), "{name} has no block");
        assert!(page.contains(&format!("](#amontons-{name})")), "{name} is not in the table");
    }
    let codes = help.split("Exit codes:").nth(1).expect("the exit codes");
    let numbers = codes.split(|c: char| !c.is_ascii_digit()).filter(|number| !number.is_empty());
    for code in numbers {
        assert!(page.contains(&format!("\n| {code} | ")), "exit code {code}");
    }
    let run = stdout(&output(&mut crate::common::amontons(&["run", "--help"])));
    let options = page.split("\n## ").skip(1).flat_map(|section| section.split('`')).filter_map(|code| {
        let option = code.split([' ', '=']).next()?;
        option.starts_with("--").then_some(option)
    });
    for option in options.filter(|option| !["--help"].contains(option)) {
        let is_known = run.contains(option)
            || names
                .iter()
                .any(|name| stdout(&output(&mut crate::common::amontons(&[name, "--help"]))).contains(option));
        assert!(is_known, "{option} is no option");
    }
}
