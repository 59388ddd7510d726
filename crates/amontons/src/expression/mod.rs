//! Mathematical expressions in the coordinates `x`, `y`, `z` and the time `t`.
//!
//! An expression is compiled once and evaluated at many points in every time step:
//!
//! ```text
//! sin(pi*x)*exp(-t)
//! (x > 0.25)*(x - 0.25)^2
//! max(0, 1 - t)
//! ```
//!
//! From the loosest to the tightest, the operators are
//!
//! | operators                  | remarks                                                     |
//! |----------------------------|-------------------------------------------------------------|
//! | `<` `<=` `>` `>=` `==` `!=` | 1 if it holds, 0 if not; not chained, `a < b < c` is refused |
//! | `+` `-`                    |                                                             |
//! | `*` `/`                    | always written out, `2x` is refused                         |
//! | `-` `+` as signs           | `-x^2` is `-(x^2)`                                          |
//! | `^`                        | from right to left, `2^3^2` is 512; `2^-1` is 0.5           |
//!
//! Numbers are written as `1`, `.5`, `1e-3`, `2.5E+4`; `pi` and `e` are constants. The functions:
//!
//! | functions                                    | remarks                                    |
//! |----------------------------------------------|--------------------------------------------|
//! | `sin` `cos` `tan` `asin` `acos` `atan`       | angles in radians                          |
//! | `atan2(y, x)`                                | angle of the point (x, y), in (-pi, pi]    |
//! | `sinh` `cosh` `tanh` `exp` `sqrt` `abs`      |                                            |
//! | `log` `ln` `log10`                           | `log` and `ln` are both the natural one    |
//! | `pow(a, b)`                                  | the same as `a^b`                          |
//! | `mod(a, b)`                                  | `a - b*floor(a/b)`, of the sign of `b`     |
//! | `floor` `ceil`                               |                                            |
//! | `sign(s)`                                    | -1, 0 or 1                                 |
//! | `step(s)`                                    | 0 for `s < 0`, else 1                      |
//! | `min(a, b, ...)` `max(a, b, ...)`            | two or more arguments                      |
//! | `if(c, a, b)`                                | `a` if `c` is not 0, else `b`              |
//!
//! Powers with an integer exponent up to 16 in magnitude are products, and `a^0` is 1. A NaN is passed on by `sign`,
//! `step`, `min`, `max` and the condition of `if`, which therefore cannot hide it; only comparisons with it have an
//! outcome: `!=` holds, the others do not. Derivatives are those of the formula as written, see
//! [`Expression::derivatives`]. An expression has at most 10 000 bytes and 200 levels of nesting.

mod derivative;
mod ops;
mod parse;
mod program;

use std::collections::BTreeMap;
use std::fmt;

use thiserror::Error;

use program::Program;

/// A variable of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variable {
    /// First coordinate of the point.
    X,
    /// Second coordinate of the point.
    Y,
    /// Third coordinate of the point.
    Z,
    /// Time.
    T,
}

impl Variable {
    fn axis(self) -> Option<usize> {
        match self {
            Variable::X => Some(0),
            Variable::Y => Some(1),
            Variable::Z => Some(2),
            Variable::T => None,
        }
    }
}

/// Numbers with names that expressions may mention beside `pi` and `e`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamedConstants(BTreeMap<String, f64>);

/// Names of variables of expressions and formulas, which no constant may have.
const VARIABLE_NAMES: [&str; 8] = ["x", "y", "z", "t", "p", "v", "r", "theta"];

impl NamedConstants {
    /// Adds a constant.
    ///
    /// # Errors
    /// What the name of a constant must be, if this one is none or has a meaning already.
    pub fn add(&mut self, name: &str, value: f64) -> Result<(), &'static str> {
        let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let is_function = parse::FUNCTIONS.iter().any(|(function, ..)| *function == name);
        if !is_word {
            return Err("a name of letters, digits and `_` that begins with a letter");
        }
        if is_function || VARIABLE_NAMES.contains(&name) || parse::CONSTANTS.iter().any(|(known, _)| *known == name) {
            return Err("a name that is no variable, function or constant of expressions");
        }
        self.0.insert(name.to_owned(), value);
        Ok(())
    }

    fn get(&self, name: &str) -> Option<f64> {
        self.0.get(name).copied()
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }
}

/// Reason why a text is not an expression.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("at byte {offset}: found {found}, expected {expected}{}", suffix(.hint.as_deref()))]
pub struct ExpressionError {
    /// Position in the text, in bytes from its beginning; always on the boundary of a character and at most the length
    /// of the text.
    pub offset: usize,
    /// The text found there.
    pub found: String,
    /// The text expected there.
    pub expected: String,
    /// A suggestion for what to write instead; `None` if there is none.
    pub hint: Option<String>,
}

fn suffix(hint: Option<&str>) -> String {
    hint.map(|hint| format!(" ({hint})")).unwrap_or_default()
}

/// The value of an expression and its first derivatives at a point and a time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Derivatives {
    /// The value.
    pub value: f64,
    /// The derivatives by the three coordinates.
    pub by_x: [f64; 3],
    /// The derivative by the time.
    pub by_t: f64,
}

/// A compiled expression; see the [module](self) for the language.
///
/// Two expressions are equal if their texts and the constants in them are.
#[derive(Clone)]
pub struct Expression {
    source: String,
    /// The constants that the text mentions, with their values.
    constants: Box<[(String, f64)]>,
    variables: [bool; 4],
    program: Program,
}

impl Expression {
    /// Compiles an expression.
    ///
    /// # Errors
    ///
    /// [`ExpressionError`] at the first place where the text departs from the language, or if it
    /// is too long or too deeply nested.
    pub fn parse(source: &str) -> Result<Expression, ExpressionError> {
        Expression::named(source, parse::PLACE, &NamedConstants::default())
    }

    /// Compiles an expression that may mention constants.
    ///
    /// # Errors
    /// Those of [`parse`](Self::parse).
    pub fn with(source: &str, constants: &NamedConstants) -> Result<Expression, ExpressionError> {
        Expression::named(source, parse::PLACE, constants)
    }

    /// Compiles an expression in up to four variables with these names.
    fn named(source: &str, names: &[&str], constants: &NamedConstants) -> Result<Expression, ExpressionError> {
        let parsed = parse::parse(source, names, constants)?;
        Ok(Expression {
            source: source.to_owned(),
            constants: parsed.used.into(),
            variables: parsed.variables,
            program: Program::new(&parsed.graph, parsed.root),
        })
    }

    /// The text it was compiled from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The value at the point `x` and the time `t`. It may be infinite or NaN, as for `1/x` or `sqrt(x)`; the caller
    /// must check that.
    pub fn value(&self, x: &[f64; 3], t: f64) -> f64 {
        self.program.value(x, t)
    }

    /// The values at many points and one time, equal to those of [`value`](Self::value) to the last bit. Parts that do
    /// not depend on the point are evaluated once; with evaluation in blocks this is several times faster than point by
    /// point.
    ///
    /// `out` is as long as `points`; if it is not, only the first values, up to the shorter of the
    /// two lengths, are evaluated.
    pub fn values(&self, points: &[[f64; 3]], t: f64, out: &mut [f64]) {
        let count = points.len().min(out.len());
        self.program.values(&points[..count], t, &mut out[..count]);
    }

    /// The value and the derivatives by the coordinates and the time, by the rules of calculus and therefore exact up
    /// to rounding. The value equals that of [`value`](Self::value) to the last bit.
    ///
    /// A function in pieces has the derivative of the piece that gives the value:
    ///
    /// | function                                  | derivative                                         |
    /// |-------------------------------------------|----------------------------------------------------|
    /// | comparisons, `sign` `step` `floor` `ceil` | 0, also at the jumps                               |
    /// | `abs(a)`                                  | that of `a` times `sign(a)`, at the kink 0         |
    /// | `min` `max`                               | that of the argument chosen, the last among equals |
    /// | `if(c, a, b)`                             | that of `a` or `b`; the condition has no part      |
    /// | `mod(a, b)`                               | that of `a - n*b` with `n = floor(a/b)` held fixed |
    /// | `a^b`                                     | by `a`: 0 if `b` is 0                              |
    ///
    /// Terms that are constant to first order count as constant: `sqrt(x^2)` and `sqrt(x^2 + y^2)` have the derivative
    /// 0 at the origin. A vanishing factor outweighs the infinite slope of the other: `x*sqrt(x)` has the derivative 0
    /// at 0. An infinite operand, as after an overflow, counts as constant where the function levels out:
    /// `1/(1 + exp(x))` has the derivative 0 at 1000. These rules do not see a singularity that the next operation
    /// undoes: they give 0 for `1/(1/x)` and `(x^3)^(1/3)` at 0.
    ///
    /// A derivative is infinite where the slope is, as for `sqrt(x)` at 0. It is NaN where the value is, and where the
    /// rules lead to no number: for `atan2` at the origin, for a variable exponent by that exponent at a negative base,
    /// for `sqrt(x)^2` at 0. The caller must check that.
    pub fn derivatives(&self, x: &[f64; 3], t: f64) -> Derivatives {
        self.program.derivatives(x, t)
    }

    /// True if the text mentions a variable, even without influence as in `0*x`.
    pub fn uses(&self, variable: Variable) -> bool {
        self.variables[variable as usize]
    }

    /// True if the text mentions the time.
    pub fn depends_on_time(&self) -> bool {
        self.uses(Variable::T)
    }

    /// True if the text mentions a coordinate.
    pub fn depends_on_space(&self) -> bool {
        [Variable::X, Variable::Y, Variable::Z].into_iter().any(|variable| self.uses(variable))
    }
}

/// A formula in up to four named variables, such as `0.2 + 0.1*exp(-v/0.3)` in `p` and `v`; see the [module](self) for
/// the language.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    expression: Expression,
}

impl Formula {
    /// Compiles a formula in variables with these names; only the first four count.
    ///
    /// # Errors
    /// Fails like [`Expression::parse`].
    pub fn parse(source: &str, names: &[&str]) -> Result<Formula, ExpressionError> {
        Formula::with(source, names, &NamedConstants::default())
    }

    /// Compiles a formula that may mention constants.
    ///
    /// # Errors
    /// Fails like [`Expression::parse`].
    pub fn with(source: &str, names: &[&str], constants: &NamedConstants) -> Result<Formula, ExpressionError> {
        Ok(Formula { expression: Expression::named(source, names, constants)? })
    }

    /// The value and the derivatives by the variables in their order, with the rules of [`Expression::derivatives`].
    #[must_use]
    pub fn derivatives(&self, [x, y, z, t]: [f64; 4]) -> (f64, [f64; 4]) {
        let Derivatives { value, by_x: [by_x, by_y, by_z], by_t } = self.expression.derivatives(&[x, y, z], t);
        (value, [by_x, by_y, by_z, by_t])
    }

    /// The value.
    #[must_use]
    pub fn value(&self, [x, y, z, t]: [f64; 4]) -> f64 {
        self.expression.value(&[x, y, z], t)
    }

    /// True if the text mentions variable number `variable`, from 0.
    #[must_use]
    pub fn uses(&self, variable: usize) -> bool {
        self.expression.variables.get(variable).is_some_and(|used| *used)
    }
}

impl fmt::Debug for Expression {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Expression").field(&self.source).finish()
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Expression) -> bool {
        self.source == other.source && self.constants == other.constants
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp, clippy::panic, clippy::cast_sign_loss)]
mod tests;
