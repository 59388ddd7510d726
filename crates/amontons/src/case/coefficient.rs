//! The coefficients of a law: numbers, or fields that are checked at all points where the law is evaluated.

use std::cell::OnceCell;
use std::sync::Arc;

use super::build::Build;
use super::path::Path;
use super::place::At;
use super::raw::{Coefficient, Datum};
use crate::field::{Field, Law, LawKind, common, reference};
use crate::tensor::Point;

/// Largest number of coefficients of a law: a stiffness, three angles, three coefficients of expansion.
const MOST: usize = 48;
/// Number of times at which time-dependent coefficients are checked.
const LEVELS: usize = 64;

/// The reason why coefficients give no law: the key below the law, and the message.
#[derive(Clone, Debug)]
pub(super) struct Refusal {
    pub key: &'static str,
    pub found: String,
    pub expected: String,
    pub hint: Option<&'static str>,
}

impl Refusal {
    /// A refusal of the law as a whole.
    pub fn new(found: impl Into<String>, expected: impl Into<String>) -> Refusal {
        Refusal { key: "", found: found.into(), expected: expected.into(), hint: None }
    }

    /// Makes the refusal one about a key of the law.
    pub fn of(self, key: &'static str) -> Refusal {
        Refusal { key, ..self }
    }
}

/// Function that makes a law of the values of its coefficients.
pub(super) type Make<T> = dyn Fn(&[f64]) -> Result<T, Refusal> + Send + Sync;

/// A law or a tensor with its coefficients.
pub(super) struct Plan<T> {
    fields: Arc<[Field]>,
    /// The temperatures that all of its tables cover; empty without dependence on the temperature.
    temperatures: Arc<[f64]>,
    make: Arc<Make<T>>,
}

impl<T> Clone for Plan<T> {
    fn clone(&self) -> Plan<T> {
        let (fields, temperatures) = (Arc::clone(&self.fields), Arc::clone(&self.temperatures));
        Plan { fields, temperatures, make: Arc::clone(&self.make) }
    }
}

impl<T> Plan<T> {
    /// A plan that applies `make` to the values of these coefficients.
    pub fn new(fields: Vec<Field>, make: impl Fn(&[f64]) -> Result<T, Refusal> + Send + Sync + 'static) -> Plan<T> {
        let tables = fields.iter().map(Field::temperatures).filter(|table| !table.is_empty());
        let temperatures = common(tables).into();
        Plan { fields: fields.into(), temperatures, make: Arc::new(make) }
    }

    /// The law at a point and a time, at the tabulated temperature nearest to 0.
    pub fn at(&self, x: &Point, t: f64) -> Result<T, Refusal> {
        self.at_temperature(x, t, reference(&self.temperatures))
    }

    /// The law at a position, time and temperature.
    pub fn at_temperature(&self, x: &Point, t: f64, theta: f64) -> Result<T, Refusal> {
        let mut values = [0.0; MOST];
        for (value, field) in values.iter_mut().zip(self.fields.iter()) {
            *value = field.value_at(x, t, theta);
        }
        (self.make)(&values[..self.fields.len().min(MOST)])
    }

    /// The law for these values of its coefficients.
    pub fn of(&self, values: &[f64]) -> Result<T, Refusal> {
        (self.make)(values)
    }

    /// The temperatures that all of its tables cover, K.
    pub fn temperatures(&self) -> &[f64] {
        &self.temperatures
    }

    /// True if a coefficient depends on the temperature.
    pub fn warms(&self) -> bool {
        self.fields.iter().any(|field| !field.temperatures().is_empty())
    }

    /// Its coefficients.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// True if a coefficient varies in space, time or temperature.
    pub fn varies(&self) -> bool {
        !self.fields.iter().all(|field| matches!(field, Field::Constant(_)))
    }

    /// True if a coefficient changes with time.
    pub fn changes(&self) -> bool {
        self.fields.iter().any(Field::depends_on_time)
    }
}

/// The points at which a law is evaluated, computed on demand.
pub(super) struct Sites<'a> {
    make: Box<dyn Fn() -> Vec<Point> + 'a>,
    points: OnceCell<Vec<Point>>,
}

impl<'a> Sites<'a> {
    pub fn new(make: impl Fn() -> Vec<Point> + 'a) -> Sites<'a> {
        Sites { make: Box::new(make), points: OnceCell::new() }
    }

    pub fn points(&self) -> &[Point] {
        self.points.get_or_init(&self.make)
    }
}

impl Build<'_> {
    /// The times at which time-dependent coefficients are checked; `[0]` for others.
    pub fn times(&self, changes: bool) -> Vec<f64> {
        if changes { self.timeline.spread(LEVELS) } else { vec![0.0] }
    }

    /// A coefficient that does not depend on time, checked against the limits of its key at all sites.
    pub fn steady_coefficient(&mut self, path: &str, raw: &Coefficient, sites: &Sites) -> Field {
        let field = self.coefficient_in_time(path, &raw.clone().into(), sites);
        if !field.depends_on_time() {
            return field;
        }
        let expected = format!("an expression in {}: it is the same at all times", self.axes());
        self.note(path, At::Value, "`t` in an expression, or a table in time", expected, None);
        self.stand_in(path)
    }

    /// A coefficient that does not depend on time but may depend on the temperature, checked against the limits of its
    /// key at all sites and temperatures.
    pub fn thermal_coefficient(&mut self, path: &str, raw: &Coefficient, sites: &Sites) -> Field {
        let Coefficient::Table(data) = raw else { return self.steady_coefficient(path, raw, sites) };
        if data.temperature.is_none() && data.value.is_none() {
            return self.steady_coefficient(path, raw, sites);
        }
        let Some(field) = self.thermal_table(path, data) else { return self.stand_in(path) };
        if self.is_beyond(path, &field, sites) { self.stand_in(path) } else { field }
    }

    /// A coefficient that may change with time, checked against the limits of its key at all sites and times.
    pub fn coefficient_in_time(&mut self, path: &str, raw: &Datum, sites: &Sites) -> Field {
        let field = match raw {
            Datum::Number(value) => return Field::Constant(*value),
            _ => self.field(path, raw, &[]),
        };
        if matches!(field, Field::Constant(_)) {
            // The fault of the text is noted already.
            return self.stand_in(path);
        }
        if self.is_beyond(path, &field, sites) {
            self.stand_in(path)
        } else if field.depends_on_space() || field.depends_on_time() {
            field
        } else {
            Field::Constant(field.value(&[0.0; 3], 0.0))
        }
    }

    /// A placeholder within the limits of the key, for a faulty coefficient.
    fn stand_in(&self, path: &str) -> Field {
        let path = Path::parse(path).unwrap_or_default();
        let limits = self.limits.iter().find(|(key, _)| *key == path).map(|(_, limits)| limits);
        let value = [1.0, 0.0, 0.3].into_iter().find(|v| limits.is_none_or(|limits| limits.admit(*v)));
        Field::Constant(value.unwrap_or(1.0))
    }

    /// True if a field violates the limits of its key somewhere, which is noted.
    fn is_beyond(&mut self, path: &str, field: &Field, sites: &Sites) -> bool {
        let [first, last] = field.span();
        if first > 0.0 || last < self.timeline.end() {
            let found = format!("a table from t = {first:?} to t = {last:?}");
            let expected = format!("values from t = 0 to the end of the run, t = {:?}", self.timeline.end());
            let hint = "give more rows, or `extend = \"hold\"` to keep the value at the end";
            self.note(path, At::Value, found, expected, Some(hint));
            return true;
        }
        // The points of a placeholder mesh are irrelevant.
        if self.doubtful.has_in_mesh {
            return false;
        }
        let key = Path::parse(path).unwrap_or_default();
        let limits = self.limits.iter().find(|(other, _)| *other == key).map(|(_, limits)| limits.clone());
        let wrong = |value: f64| !(value.is_finite() && limits.as_ref().is_none_or(|limits| limits.admit(value)));
        let here = [[0.0; 3]];
        let points = if field.depends_on_space() { sites.points() } else { &here };
        for &theta in field.temperatures() {
            let values = points.iter().map(|x| (x, field.value_at(x, 0.0, theta)));
            let Some((x, value)) = values.into_iter().find(|(_, value)| wrong(*value)) else { continue };
            let place = if field.depends_on_space() { format!(" at {}", self.place(x)) } else { String::new() };
            let expected = limits.map_or_else(|| "finite values".to_owned(), |limits| limits.expected);
            self.note(path, At::Value, format!("the value {value:?} at θ = {theta:?}{place}"), expected, None);
            return true;
        }
        if !field.temperatures().is_empty() {
            return false;
        }
        for t in self.times(field.depends_on_time()) {
            let values = field.values(sites.points(), t);
            let Some((x, value)) = sites.points().iter().zip(values).find(|(_, value)| wrong(*value)) else { continue };
            let when = if field.depends_on_time() { format!(", t = {t:?}") } else { String::new() };
            let found = format!("the value {value:?} at {}{when}", self.place(x));
            let expected = limits.map_or_else(|| "finite values".to_owned(), |limits| limits.expected);
            self.note(path, At::Value, found, expected, None);
            return true;
        }
        false
    }

    /// The law of a plan, fixed or varying, with `nowhere` away from the sites, where it may not exist; `None`, with a
    /// note at `path`, if it does not exist at all sites.
    pub fn law<T: LawKind + ?Sized>(
        &mut self,
        path: &str,
        plan: &Plan<Arc<T>>,
        sites: &Sites,
        nowhere: Arc<T>,
    ) -> Option<Law<T>> {
        if !self.holds(path, plan, sites) {
            return None;
        }
        if !plan.varies() {
            return plan.at(&[0.0; 3], 0.0).ok().map(Law::from);
        }
        let (times, plan) = (self.times(plan.changes()), plan.clone());
        let temperatures = Arc::clone(&plan.temperatures);
        let at = move |x: &Point, t: f64, theta: f64| {
            plan.at_temperature(x, t, theta).unwrap_or_else(|_| Arc::clone(&nowhere))
        };
        Some(Law::varying(sites.points(), &times, &temperatures, at))
    }

    /// True if a plan gives a law at all sites and times. Otherwise the first reason is noted at the law with this
    /// path.
    pub fn holds<T>(&mut self, path: &str, plan: &Plan<T>, sites: &Sites) -> bool {
        if plan.warms() && plan.temperatures().is_empty() {
            let expected = "tables of one law that have temperatures in common";
            self.note(path, At::Value, "tables over temperatures without a common range", expected, None);
            return false;
        }
        let refused = if !plan.varies() {
            plan.at(&[0.0; 3], 0.0).err().map(|refusal| (refusal, String::new()))
        } else if self.doubtful.has_in_mesh {
            None
        } else {
            let times = self.times(plan.changes());
            let levels = if plan.warms() { plan.temperatures() } else { &[0.0] };
            let when = times.iter().flat_map(|&t| levels.iter().map(move |&theta| (t, theta)));
            let mut all = when.flat_map(|when| sites.points().iter().map(move |x| (x, when)));
            all.find_map(|(x, (t, theta))| {
                let refusal = plan.at_temperature(x, t, theta).err()?;
                let when = if plan.changes() { format!(", t = {t:?}") } else { String::new() };
                let warm = if plan.warms() { format!(", θ = {theta:?}") } else { String::new() };
                Some((refusal, format!(" at {}{when}{warm}", self.place(x))))
            })
        };
        let Some((refusal, place)) = refused else { return true };
        let path = if refusal.key.is_empty() { path.to_owned() } else { format!("{path}.{}", refusal.key) };
        self.note(&path, At::Value, format!("{}{place}", refusal.found), refusal.expected, refusal.hint);
        false
    }
}
