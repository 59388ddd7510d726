//! Data that vary: from the raw case to [`Field`]s.

use super::build::Build;
use super::path::Path;
use super::place::At;
use super::raw::{Component, Datum, Extend, Scalar, TableData};
use super::table;
use crate::expression::{Expression, Variable};
use crate::field::{Field, TableError, TemperatureTable, TimeTable};
use crate::mesh::MeshData;
use crate::tensor::Point;

/// Names of the coordinates.
const AXES: [&str; 3] = ["x", "y", "z"];

impl Build<'_> {
    /// A datum of space and time, which must be finite at the points on which it acts.
    pub fn field(&mut self, path: &str, datum: &Datum, points: &[Point]) -> Field {
        let field = match datum {
            Datum::Number(value) => return Field::Constant(*value),
            Datum::Expression(text) => self.expression(path, text).map(Field::Expression),
            Datum::Table(table) if table.temperature.is_some() || table.value.is_some() => {
                let expected =
                    "a number, an expression or a table in time: this datum does not depend on the temperature";
                self.note(path, At::Value, "a table over the temperature", expected, None);
                None
            }
            Datum::Table(table) if table.data.is_some() || table.file.is_some() => self.mesh_data(path, table),
            Datum::Table(data) => self.table(path, data).map(Field::Table),
        };
        let Some(field) = field else { return Field::ZERO };
        self.check_finite(path, &field, points);
        field
    }

    /// A number or an expression, which must be finite at the points on which it acts.
    pub fn scalar(&mut self, path: &str, scalar: &Scalar, points: &[Point]) -> Field {
        self.field(path, &scalar.clone().into(), points)
    }

    /// A number or an expression without t. `why` is the reason for the message.
    pub fn steady(&mut self, path: &str, scalar: &Scalar, points: &[Point], why: &str) -> Field {
        let field = self.scalar(path, scalar, points);
        if !field.depends_on_time() {
            return field;
        }
        self.note(path, At::Value, "`t` in an expression", format!("an expression in {}: {why}", self.axes()), None);
        Field::ZERO
    }

    /// A number or an expression without t that is nowhere negative.
    pub fn coefficient(&mut self, path: &str, scalar: &Scalar, points: &[Point]) -> Field {
        let field = self.steady(path, scalar, points, "it is the same at all times");
        if let Some((x, value)) = points.iter().zip(field.values(points, 0.0)).find(|(_, value)| *value < 0.0) {
            let at = if matches!(field, Field::Constant(_)) { String::new() } else { format!(" at {}", self.place(x)) };
            self.note(path, At::Value, format!("the value {value:?}{at}"), "no negative value", None);
        }
        field
    }

    /// One datum per component.
    pub fn vector(&mut self, path: &str, data: &[Datum], points: &[Point]) -> Vec<Field> {
        data.iter().enumerate().map(|(c, datum)| self.field(&format!("{path}[{c}]"), datum, points)).collect()
    }

    /// One number or expression per component.
    pub fn scalars(&mut self, path: &str, data: &[Scalar], points: &[Point]) -> Vec<Field> {
        data.iter().enumerate().map(|(c, datum)| self.scalar(&format!("{path}[{c}]"), datum, points)).collect()
    }

    /// One datum per component, or `None` for a free component.
    pub fn components(&mut self, path: &str, data: Vec<Component>, points: &[Point]) -> Vec<Option<Field>> {
        let data = data.into_iter().map(Component::prescribed).enumerate();
        data.map(|(c, datum)| Some(self.field(&format!("{path}[{c}]"), &datum?, points))).collect()
    }

    /// Names of the coordinates of the body: `x, y`.
    pub fn axes(&self) -> String {
        AXES[..self.dim.min(AXES.len())].join(", ")
    }

    /// Text of a position: `x = 1.0, y = 2.0`.
    pub fn place(&self, x: &Point) -> String {
        AXES.iter().zip(x).take(self.dim).map(|(axis, x)| format!("{axis} = {x:?}")).collect::<Vec<_>>().join(", ")
    }

    pub fn expression(&mut self, path: &str, text: &str) -> Option<Expression> {
        let expression = match Expression::with(text, &self.constants) {
            Ok(expression) => expression,
            Err(error) => {
                self.note(path, At::Inside(error.offset), error.found, error.expected, error.hint.as_deref());
                return None;
            }
        };
        let beyond = [Variable::X, Variable::Y, Variable::Z]
            .into_iter()
            .zip(AXES)
            .skip(self.dim)
            .find(|(variable, _)| expression.uses(*variable));
        if let Some((_, axis)) = beyond {
            let body = if self.dim == 2 { "the body is plane" } else { "the body is a line" };
            let expected = format!("an expression in {}, t: {body}", self.axes());
            self.note(path, At::Value, format!("`{axis}` in an expression"), expected, None);
            return None;
        }
        Some(expression)
    }

    /// The table in time, from a file or from `times` and `values`.
    fn table(&mut self, path: &str, data: &TableData) -> Option<TimeTable> {
        let (times, values) = match (&data.table, &data.times, &data.values) {
            (Some(name), None, None) => self.columns(path, name, data)?,
            (None, Some(times), Some(values)) => self.pairs(path, times, values, data)?,
            _ => {
                self.note(
                    path,
                    At::Value,
                    "a table without clear data",
                    "either `table`, the name of a file, or `times` and `values`",
                    None,
                );
                return None;
            }
        };
        let factor = match &data.factor {
            None => None,
            Some(Scalar::Number(factor)) => Some((*factor, None)),
            Some(Scalar::Expression(text)) => Some((1.0, Some(self.expression(&format!("{path}.factor"), text)?))),
        };
        let values = values.iter().map(|value| value * factor.as_ref().map_or(1.0, |(number, _)| *number)).collect();
        let table = match TimeTable::new(times, values) {
            Ok(table) if data.extend == Extend::Hold => table.hold(),
            Ok(table) => table,
            Err(error) => {
                self.refuse_table(path, &error);
                return None;
            }
        };
        Some(match factor {
            Some((_, Some(expression))) => table.scaled(expression),
            _ => table,
        })
    }

    /// A table over the temperature.
    pub fn thermal_table(&mut self, path: &str, data: &TableData) -> Option<Field> {
        let others = [data.table.is_some(), data.times.is_some(), data.values.is_some(), data.data.is_some()];
        let more = [data.file.is_some(), data.column.is_some(), data.time.is_some(), data.extend != Extend::None];
        let (Some(temperatures), Some(values), false) =
            (&data.temperature, &data.value, others.into_iter().chain(more).any(|given| given))
        else {
            let expected = "`temperature` and `value`, with `factor` alone";
            self.note(path, At::Value, "a table without clear data", expected, None);
            return None;
        };
        let (number, factor) = match &data.factor {
            None => (1.0, None),
            Some(Scalar::Number(factor)) => (*factor, None),
            Some(Scalar::Expression(text)) => (1.0, Some(self.expression(&format!("{path}.factor"), text)?)),
        };
        if factor.as_ref().is_some_and(Expression::depends_on_time) {
            let expected = format!("an expression in {}", self.axes());
            self.note(&format!("{path}.factor"), At::Value, "`t` in an expression", expected, None);
            return None;
        }
        let values = values.iter().map(|value| number * value).collect();
        match TemperatureTable::new(temperatures.clone(), values) {
            Ok(table) => Some(Field::Thermal(match factor {
                Some(factor) => table.scaled(factor),
                None => table,
            })),
            Err(error) => {
                self.refuse_table(path, &error);
                None
            }
        }
    }

    /// Data of a mesh file.
    fn mesh_data(&mut self, path: &str, raw: &TableData) -> Option<Field> {
        let given = [raw.table.is_some(), raw.times.is_some(), raw.values.is_some()].contains(&true)
            || raw.column.is_some()
            || raw.time.is_some()
            || raw.extend != Extend::None;
        let Some(name) = raw.data.as_ref().filter(|_| !given) else {
            let expected = "`data`, the name of data of a mesh file, with `file` and `factor` alone";
            self.note(path, At::Value, "a table without clear data", expected, None);
            return None;
        };
        let Some(file) = raw.file.clone().or_else(|| Some(self.mesh_file.as_ref()?.0.clone())) else {
            let expected = "`file`, the mesh file that has the data: the mesh of the case is not from a file";
            self.note(path, At::Value, "data without a file", expected, None);
            return None;
        };
        let factor = match &raw.factor {
            None => Field::Constant(1.0),
            Some(Scalar::Number(factor)) => Field::Constant(*factor),
            Some(Scalar::Expression(text)) => Field::Expression(self.expression(&format!("{path}.factor"), text)?),
        };
        if factor.depends_on_time() {
            let expected = format!("an expression in {}", self.axes());
            self.note(&format!("{path}.factor"), At::Value, "`t` in an expression", expected, None);
            return None;
        }
        let key = if raw.file.is_some() { format!("{path}.file") } else { path.to_owned() };
        let bytes = match self.loader.look(&Path::parse(&key).unwrap_or_default(), &file, raw.file.is_some()) {
            Ok(bytes) => bytes,
            Err(missing) => {
                self.note(&key, At::Value, missing.found, missing.expected, missing.hint.as_deref());
                return None;
            }
        };
        if ![".vtu", ".msh"].iter().any(|ending| file.to_lowercase().ends_with(ending)) {
            let expected = "a file .msh (Gmsh) or .vtu (VTK) with data of cells or nodes";
            self.note(&key, At::Value, format!("the file {file}"), expected, None);
            return None;
        }
        let scale = self.mesh_file.as_ref().map_or(1.0, |(_, scale)| *scale);
        match MeshData::read(&file, &bytes, name, scale) {
            Ok(data) if data.dim() == self.dim => Some(data.into_field(factor)),
            Ok(data) if data.dim() + 1 == self.dim => Some(data.on_surface().into_field(factor)),
            Ok(data) => {
                let (found, dim) = (format!("cells of dimension {} in {file}", data.dim()), self.dim);
                let side = if dim > 1 { format!(", or {} for the data of a side", dim - 1) } else { String::new() };
                self.note(&key, At::Value, found, format!("cells of dimension {dim}, as the body{side}"), None);
                None
            }
            Err(error) => {
                let message = error.to_string();
                let (found, expected) = message.split_once(", expected ").unwrap_or((&message, "a mesh with data"));
                self.note(&format!("{path}.data"), At::Value, format!("{found} in {file}"), expected, None);
                None
            }
        }
    }

    /// Times and values that stand in the case.
    fn pairs(&mut self, path: &str, times: &[f64], values: &[f64], data: &TableData) -> Option<(Vec<f64>, Vec<f64>)> {
        for (key, given) in [("column", data.column.is_some()), ("time", data.time.is_some())] {
            if given {
                self.note(
                    &format!("{path}.{key}"),
                    At::Value,
                    format!("`{key}` besides `times` and `values`"),
                    "`table`, a file, with it",
                    None,
                );
                return None;
            }
        }
        Some((times.to_vec(), values.to_vec()))
    }

    fn refuse_table(&mut self, path: &str, error: &TableError) {
        match error {
            TableError::Empty { over } => {
                let key = if *over == "time" { "times" } else { "temperature" };
                self.note(&format!("{path}.{key}"), At::Value, format!("no {over}s"), "at least one", None);
            }
            TableError::Lengths { over, count, values } => {
                let key = if *over == "time" { "values" } else { "value" };
                let found = format!("{values} values for {count} {over}s");
                self.note(&format!("{path}.{key}"), At::Value, found, format!("one value per {over}"), None);
            }
            TableError::NotFinite { over, row, at, .. } => {
                let (of_at, of_value) = if *over == "time" { ("times", "values") } else { ("temperature", "value") };
                let key = if at.is_finite() { of_value } else { of_at };
                let place = format!("{path}.{key}[{}]", row - 1);
                self.note(&place, At::Value, "a number that is not finite", "finite numbers", None);
            }
            TableError::NotIncreasing { over, row, found, before } => {
                let key = if *over == "time" { "times" } else { "temperature" };
                self.note(
                    &format!("{path}.{key}[{}]", row - 1),
                    At::Value,
                    format!("the {over} {found:?} after {before:?}"),
                    format!("{over}s that increase"),
                    None,
                );
            }
        }
    }

    /// Times and values of a file.
    fn columns(&mut self, path: &str, name: &str, data: &TableData) -> Option<(Vec<f64>, Vec<f64>)> {
        let key = format!("{path}.table");
        let bytes = match self.loader.get(&Path::parse(&key).unwrap_or_default(), name) {
            Ok(bytes) => bytes,
            Err(missing) => {
                self.note(&key, At::Value, missing.found, missing.expected, missing.hint.as_deref());
                return None;
            }
        };
        match table::read(name, &bytes, data.time.as_ref(), data.column.as_ref()) {
            Ok(columns) => Some(columns),
            Err(refusal) => {
                self.note(
                    &format!("{path}.{}", refusal.key),
                    At::Value,
                    refusal.found,
                    refusal.expected,
                    refusal.hint.as_deref(),
                );
                None
            }
        }
    }

    /// Notes a field that has no finite value at a point at the start or the end.
    fn check_finite(&mut self, path: &str, field: &Field, points: &[Point]) {
        // Points of a placeholder mesh are irrelevant; missing times of a table are reported by the problem.
        let [first, last] = field.span();
        if self.doubtful.has_in_mesh || first > 0.0 || last < self.timeline.end() {
            return;
        }
        for t in [0.0, self.timeline.end()] {
            let values = field.values(points, t);
            if let Some((x, value)) = points.iter().zip(values).find(|(_, v)| !v.is_finite()) {
                let found = format!("the value {value} at {}, t = {t:?}", self.place(x));
                self.note(
                    path,
                    At::Value,
                    found,
                    "finite values at all nodes on which it acts, at t = 0 and t = end",
                    None,
                );
                return;
            }
        }
    }
}
