//! Time per step over unknowns, both on logarithmic axes.

use super::Row;

const SIZE: [f64; 2] = [640.0, 420.0];
const MARGIN: [f64; 2] = [70.0, 50.0];
const COLORS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#000000"];

/// The picture of a table as SVG.
pub fn chart(rows: &[Row]) -> String {
    let range = |of: &dyn Fn(&Row) -> f64| {
        let ends = rows.iter().map(|row| of(row).log10());
        let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        (low.floor(), high.ceil().max(low.floor() + 1.0))
    };
    let (x, y) = (range(&|row| row.unknowns as f64), range(&|row| row.per_step));
    let at = |value: f64, (low, high): (f64, f64), axis: usize| {
        let share = (value.log10() - low) / (high - low);
        let length = SIZE[axis] - 2.0 * MARGIN[axis];
        MARGIN[axis] + length * if axis == 0 { share } else { 1.0 - share }
    };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        SIZE[0], SIZE[1]
    );
    for decade in x.0 as i32..=x.1 as i32 {
        let px = at(10f64.powi(decade), x, 0);
        svg += &format!(
            "<line x1=\"{px:.1}\" x2=\"{px:.1}\" y1=\"{}\" y2=\"{}\" stroke=\"#ddd\"/><text x=\"{px:.1}\" y=\"{}\" text-anchor=\"middle\">1e{decade}</text>\n",
            MARGIN[1],
            SIZE[1] - MARGIN[1],
            SIZE[1] - MARGIN[1] + 16.0
        );
    }
    for decade in y.0 as i32..=y.1 as i32 {
        let py = at(10f64.powi(decade), y, 1);
        svg += &format!(
            "<line y1=\"{py:.1}\" y2=\"{py:.1}\" x1=\"{}\" x2=\"{}\" stroke=\"#ddd\"/><text y=\"{py:.1}\" x=\"{}\" text-anchor=\"end\">1e{decade} s</text>\n",
            MARGIN[0],
            SIZE[0] - MARGIN[0],
            MARGIN[0] - 6.0
        );
    }
    svg += &format!(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">unknowns of displacement and temperature</text><text x=\"12\" y=\"20\">time per step</text>\n",
        0.5 * SIZE[0],
        SIZE[1] - 10.0
    );
    svg += &series(rows, |row| (at(row.unknowns as f64, x, 0), at(row.per_step, y, 1)));
    svg + "</svg>\n"
}

/// One line with its name per program and case.
fn series(rows: &[Row], place: impl Fn(&Row) -> (f64, f64)) -> String {
    let mut svg = String::new();
    let mut names: Vec<String> = rows.iter().map(|row| format!("{}, {}", row.case, row.program)).collect();
    names.sort();
    names.dedup();
    for (k, name) in names.iter().enumerate() {
        let color = COLORS[k % COLORS.len()];
        let mut points: Vec<(f64, f64)> =
            rows.iter().filter(|row| format!("{}, {}", row.case, row.program) == *name).map(&place).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let path: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        svg +=
            &format!("<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>\n", path.join(" "));
        for (x, y) in points {
            svg += &format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{color}\"/>\n");
        }
        svg += &format!(
            "<text x=\"{}\" y=\"{}\" fill=\"{color}\">{name}</text>\n",
            MARGIN[0] + 8.0,
            40.0 + 16.0 * k as f64
        );
    }
    svg
}
