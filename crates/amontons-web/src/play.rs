//! A run in memory, and its data for a page.

use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::hypotheses::{Finding, Kind as Voice};
use amontons::plot::{self, Film, Options, PictureKind, RunPanel};
use amontons::run::{Settings, run};
use serde_json::{Value, json};

/// A finished run of a case.
#[derive(Debug)]
pub struct Play {
    film: Film,
    /// The case as run, with the overrides.
    text: String,
    /// The reason why the run ended early, if it did.
    error: Option<String>,
}

impl Play {
    /// Reads the text of a case with overrides, each `key=value`, and runs it. At most `frames` times are kept in
    /// addition to the start.
    ///
    /// # Errors
    /// The case has faults, or no step of the run could be made.
    pub fn new(text: &str, overrides: &[String], frames: usize) -> Result<Play, String> {
        let read = case::parse(&Source::new("case.toml", text), overrides).map_err(|error| error.to_string())?;
        let problem = Arc::new(read.problem);
        let mut film = Film::new(&problem, problem.timeline.steps().div_ceil(frames.max(1)));
        let ended = run(&problem, &Settings::default(), &mut [&mut film]);
        let error = ended.err().map(|error| match error.advice() {
            Some(advice) => format!("{error}\n{advice}"),
            None => error.to_string(),
        });
        // Without a summary only the error can be shown.
        match (film.summary(), error) {
            (None, error) => Err(error.unwrap_or_else(|| "the run has no summary".to_owned())),
            (Some(_), error) => Ok(Play { film, text: read.text, error }),
        }
    }

    /// The data of the page: `times`, the names of the `pictures`, the `headline` and the `rows` of the summary, the
    /// `findings` with failed ones first, the `case` as run, the `error` of a run that ended early, and the `summary`
    /// itself.
    #[must_use]
    pub fn told(&self) -> Value {
        let summary = self.film.summary();
        let last = self.film.times().len().saturating_sub(1);
        let pictures: Vec<&str> = self.film.frame(last).map_or_else(
            |_| Vec::new(),
            |run| PictureKind::ALL.into_iter().filter(|kind| shows(*kind, &run)).map(PictureKind::file_name).collect(),
        );
        let mut findings: Vec<&Finding> = summary.map(|s| s.findings.iter().collect()).unwrap_or_default();
        findings.sort_by_key(|finding| (finding.kind != Voice::Warning, std::cmp::Reverse(finding.status)));
        json!({
            "times": self.film.times(),
            "pictures": pictures,
            "headline": summary.map(amontons::output::Summary::headline),
            "rows": summary.map(amontons::output::Summary::rows),
            "findings": findings,
            "case": self.text,
            "error": self.error,
            "summary": summary,
        })
    }

    /// A picture at one of the kept times, as SVG. Names of pictures are those at the last time; at another time some
    /// may be missing.
    ///
    /// # Errors
    /// The run has no such picture or no such time.
    pub fn picture(&self, name: &str, frame: usize) -> Result<String, String> {
        let Some(kind) = PictureKind::ALL.into_iter().find(|kind| kind.file_name() == name) else {
            let known: Vec<&str> = PictureKind::ALL.iter().map(|kind| kind.file_name()).collect();
            return Err(format!("found the picture \"{name}\", expected one of {}", known.join(", ")));
        };
        let run = self.film.frame(frame).map_err(|error| error.to_string())?;
        let picture = plot::picture(kind, &[RunPanel { title: "", run: &run }], &Options::default());
        picture.map(|picture| picture.svg()).map_err(|error| error.to_string())
    }
}

/// True if a picture of a run can be drawn and is not trivial.
fn shows(kind: PictureKind, run: &plot::DrawnRun) -> bool {
    kind.is_told_by(run) && (run.dimension > 1 || kind == PictureKind::History)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    const PAPER: &str = include_str!("../../../cases/paper.toml");

    fn played(overrides: &[&str]) -> Result<Play, String> {
        let all: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        Play::new(PAPER, &[vec!["mesh.n=8".to_owned(), "time.steps=8".to_owned()], all].concat(), 4)
    }

    #[test]
    fn a_case_is_told_and_drawn_at_each_time() {
        let play = played(&[]).unwrap();
        let told = play.told();
        assert_eq!(told["times"], json!([0.0, 0.25, 0.5, 0.75, 1.0]));
        assert_eq!(told["pictures"], json!(["deformed", "temperature", "von-mises", "contact", "history"]));
        assert!(told["headline"].as_str().unwrap().contains("paper") && told["error"].is_null());
        for name in told["pictures"].as_array().unwrap() {
            assert!(play.picture(name.as_str().unwrap(), 4).unwrap().starts_with("<svg"), "{name}");
        }
        // Friction and foundation change the pictures.
        let other = played(&["contact.friction.coefficient=0.6"]).unwrap();
        let hot = played(&["contact.heat.foundation_temperature=10"]).unwrap();
        for (picture, than) in [("contact", &other), ("temperature", &hot)] {
            assert_ne!(play.picture(picture, 4).unwrap(), than.picture(picture, 4).unwrap(), "{picture}");
        }
    }

    #[test]
    fn faults_are_named_and_lost_steps_are_not_results() {
        let error = played(&["contact.friction.coefficient=-1"]).err().unwrap();
        assert!(error.contains("contact.friction.coefficient") && error.contains("expected"), "{error}");
        let error = Play::new("name = ", &[], 4).err().unwrap();
        assert!(error.starts_with("case.toml:1:"), "{error}");
        let play = played(&[]).unwrap();
        assert!(
            play.picture("wear", 4).is_err()
                && play.picture("colour", 4).is_err()
                && play.picture("contact", 5).is_err()
        );
    }
}
