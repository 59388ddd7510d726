//! The page with its text, style, script and data in one file.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use super::Contents;
use crate::convergence::ValueRow;
use crate::hypotheses::{Finding, FindingStatus, Kind};
use crate::output::Summary;
use crate::plot::table::CsvTable;

const STYLE: &str = include_str!("page/style.css");
/// The parts of the script in the order of their dependence.
const SCRIPT: [&str; 7] = [
    include_str!("page/numbers.js"),
    include_str!("page/raster.js"),
    include_str!("page/view.js"),
    include_str!("page/chart.js"),
    include_str!("page/map.js"),
    include_str!("page/sections.js"),
    include_str!("page/main.js"),
];

/// Text escaped for HTML elements and attributes.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // Other control characters are not allowed in HTML.
            c if c.is_control() && !matches!(c, '\n' | '\t') => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}

/// Content-security hash of a script or style that the browser may run: nothing else on the page runs.
fn allowed(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}

/// The page as HTML.
pub(super) fn write(contents: &Contents) -> String {
    let script = format!("\"use strict\";\n(() => {{\n{}}})();\n", SCRIPT.join("\n"));
    let name = escaped(&contents.case.problem.name);
    let policy = format!(
        "default-src 'none'; img-src data:; style-src {}; script-src {}; base-uri 'none'; form-action 'none'",
        allowed(STYLE),
        allowed(&script)
    );
    // Inside a script only `<` could end it.
    let data = contents.data.to_string().replace('<', "\\u003c");
    let sections = sections(contents);
    let links: String = sections.iter().map(|(id, title, _)| format!("<a href=\"#{id}\">{title}</a>\n")).collect();
    let bodies: String = sections
        .iter()
        .map(|(id, title, body)| format!("<section id=\"{id}\">\n<h2>{title}</h2>\n{body}</section>\n"))
        .collect();
    let headline = contents.summary.as_ref().map_or_else(String::new, Summary::headline);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"generator\" content=\"amontons {version}\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>{name}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <header>\n<h1>{name}</h1>\n<p>{headline}</p>\n<nav aria-label=\"Sections\">\n{links}</nav>\n\
         <noscript><p class=\"note\">Pictures and histories are drawn by the script of this page.</p></noscript>\n\
         </header>\n<main>\n{bodies}</main>\n<footer>\n<p>Made by amontons {version}.</p>\n</footer>\n\
         <script type=\"application/json\" id=\"data\">{data}</script>\n\
         <script type=\"text/plain\" id=\"arrays\">{arrays}</script>\n<script>{script}</script>\n</body>\n</html>\n",
        version = env!("CARGO_PKG_VERSION"),
        headline = escaped(&headline),
        arrays = contents.arrays,
    )
}

/// The sections of a page: id, title, HTML.
fn sections(contents: &Contents) -> Vec<(&'static str, &'static str, String)> {
    let mut all = Vec::new();
    if let Some(summary) = &contents.summary {
        let warnings: Vec<&Finding> = summary.warnings.iter().collect();
        all.push(("summary", "Summary", rows(summary) + &list(WARNINGS, &warnings) + &notes(&contents.notes)));
    }
    let has = |key: &str| !contents.data[key].is_null();
    if has("body") || has("rod") {
        all.push(("body", "Body", String::new()));
    }
    if has("contact") {
        all.push(("contact", "Contact", String::new()));
    }
    if has("history") {
        all.push(("history", "History", String::new()));
    }
    if has("probes") {
        all.push(("probes", "Probes", String::new()));
    }
    if let Some((table, picture)) = &contents.study {
        let picture = image(picture, "Errors over the refinement");
        all.push(("convergence", "Convergence", self::table(table) + &picture + &values(&contents.values)));
    }
    if let Some((table, picture)) = &contents.accuracy {
        let picture = picture.as_ref().map_or_else(String::new, |picture| image(picture, "Errors on the meshes"));
        all.push(("accuracy", "Accuracy", self::table(table) + &picture));
    }
    // Requested results come first, theory on request last.
    let findings = contents.summary.as_ref().map_or_else(String::new, |summary| findings(&summary.findings));
    if !findings.is_empty() {
        all.push(("verdicts", "Verdicts", findings));
    }
    all.push(("case", "Case", format!("<pre tabindex=\"0\"><code>{}</code></pre>\n", escaped(&contents.text))));
    all
}

/// The numbers at the end of a study: values on the levels, order and limit, or why there is none.
fn values(rows: &[ValueRow]) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let cell = |text: &str| format!("<td>{}</td>", escaped(text));
    let levels: String = first.levels.iter().map(|level| format!("<th scope=\"col\">{}</th>", level.level)).collect();
    let mut body = String::new();
    for row in rows {
        let values: String = row.levels.iter().map(|level| cell(&format!("{:.7e}", level.value))).collect();
        let Some(last) = row.levels.last() else { continue };
        let number = |text: Option<String>| cell(&text.unwrap_or_else(|| "–".to_owned()));
        let order = number(last.order.map(|order| format!("{order:.3}")));
        let limit = number(last.limit.map(|limit| format!("{limit:.9e}")));
        let error = number(last.error.map(|error| format!("{error:.1e}")));
        let name = escaped(&row.name);
        body += &format!("<tr><th scope=\"row\">{name}</th>{values}{order}{limit}{error}{}</tr>\n", cell(&last.remark));
    }
    format!(
        "<h3>At the end</h3>\n<div class=\"wide\" tabindex=\"0\"><table class=\"numbers\"><thead><tr>\
         <th scope=\"col\">quantity</th>{levels}<th scope=\"col\">order</th><th scope=\"col\">limit</th><th scope=\"col\">±</th>\
         <th scope=\"col\">remark</th></tr></thead><tbody>\n{body}</tbody></table></div>\n"
    )
}

/// The summary in rows of a name and a text.
fn rows(summary: &Summary) -> String {
    let row = |(name, text): &(String, String)| {
        format!("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", escaped(name), escaped(text))
    };
    let error = summary.error.as_ref().map_or_else(String::new, |e| format!("<p class=\"fails\">{}</p>\n", escaped(e)));
    format!(
        "{error}<table class=\"rows\"><tbody>\n{}</tbody></table>\n",
        summary.rows().iter().map(row).collect::<String>()
    )
}

fn notes(notes: &[String]) -> String {
    notes.iter().map(|note| format!("<p class=\"note\">{}</p>\n", escaped(note))).collect()
}

/// The titles of the two kinds of findings.
const WARNINGS: &str = "What you can act on";
const THEORY: &str = "What the theory covers";

/// The findings of both kinds, folded.
fn findings(all: &[Finding]) -> String {
    let of = |(title, kind): (&str, Kind)| {
        let mut own: Vec<&Finding> = all.iter().filter(|f| f.kind == kind).collect();
        // Findings that fail come first.
        own.sort_by_key(|f| std::cmp::Reverse(f.status));
        let fails = own.iter().filter(|f| f.status == FindingStatus::Fails).count();
        let told = format!("{title}: {} looked at, {fails} {}", own.len(), if fails == 1 { "fails" } else { "fail" });
        let folded = format!("<details>\n<summary>{told}</summary>\n{}</details>\n", list("", &own));
        if own.is_empty() { String::new() } else { folded }
    };
    [(WARNINGS, Kind::Warning), (THEORY, Kind::Theory)].into_iter().map(of).collect()
}

/// Findings under a title.
fn list(title: &str, findings: &[&Finding]) -> String {
    if findings.is_empty() {
        return String::new();
    }
    let verdicts: String = findings.iter().map(|finding| verdict(finding)).collect();
    let title = if title.is_empty() { String::new() } else { format!("<h3>{title}</h3>\n") };
    format!("{title}<ul class=\"verdicts\">\n{verdicts}</ul>\n")
}

fn verdict(finding: &Finding) -> String {
    let numbers = match (finding.value, finding.needed) {
        (Some(value), Some(needed)) => format!("{}, compared with {}", rounded(value), rounded(needed)),
        (Some(value), None) => rounded(value),
        _ => String::new(),
    };
    let repair = finding
        .repair
        .as_ref()
        .map_or_else(String::new, |repair| format!("<p class=\"repair\">to repair it: {}</p>", escaped(repair)));
    format!(
        "<li class=\"{status}\"><p><strong>{id}</strong> <span class=\"status\">{status}</span> <span class=\"number\">{numbers}</span></p>\
         <p>{message} ({place})</p>{repair}</li>\n",
        status = finding.status,
        id = escaped(finding.id.as_str()),
        message = escaped(&finding.message),
        place = escaped(&finding.place),
    )
}

/// A number of a table, rounded to five digits.
fn rounded(v: f64) -> String {
    match v.abs() {
        size if v.fract() == 0.0 && size < 1e6 => format!("{v}"),
        size if (1e-2..1e4).contains(&size) => format!("{v:.4}"),
        _ => format!("{v:.4e}"),
    }
}

/// A table; its numbers are rounded.
fn table(table: &CsvTable) -> String {
    let cell = |text: &String| match text.parse::<f64>() {
        Ok(v) => format!("<td>{}</td>", rounded(v)),
        Err(_) => format!("<td>{}</td>", escaped(text)),
    };
    let head: String = table.names().iter().map(|n| format!("<th scope=\"col\">{}</th>", escaped(n))).collect();
    let row = |row: &Vec<String>| format!("<tr>{}</tr>\n", row.iter().map(cell).collect::<String>());
    let rows: String = table.cells().iter().map(row).collect();
    format!(
        "<div class=\"wide\" tabindex=\"0\"><table class=\"numbers\"><thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
    )
}

fn image(svg: &str, text: &str) -> String {
    let data = STANDARD.encode(svg);
    format!(
        "<figure><img class=\"picture\" alt=\"{}\" src=\"data:image/svg+xml;base64,{data}\"></figure>\n",
        escaped(text)
    )
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn text_cannot_leave_its_place() {
        assert_eq!(escaped("</title><script>'\"&\u{1b}"), "&lt;/title&gt;&lt;script&gt;&#39;&quot;&amp;\u{FFFD}");
    }
}
