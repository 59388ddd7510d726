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
//! Powers with an integer exponent up to 16 in magnitude are products, and `a^0` is 1. A value that
//! is not a number is handed on by `sign`, `step`, `min`, `max` and the condition of `if`, which
//! therefore cannot hide it; only comparisons with it have an outcome: `!=` holds, the others do
//! not. An expression has at most 10 000 bytes and 200 levels of nesting.

mod parse;
mod program;

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

/// Why a text is not an expression.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("at byte {offset}: found {found}, expected {expected}{}", suffix(.hint.as_deref()))]
pub struct ExpressionError {
    /// Where in the text, in bytes from its beginning; always on the boundary of a character and
    /// at most the length of the text.
    pub offset: usize,
    /// What stands there.
    pub found: String,
    /// What could have stood there.
    pub expected: String,
    /// What to write instead, where that can be guessed.
    pub hint: Option<String>,
}

fn suffix(hint: Option<&str>) -> String {
    hint.map(|hint| format!(" ({hint})")).unwrap_or_default()
}

/// A compiled expression; see the [module](self) for the language.
///
/// Two expressions are equal if their texts are.
#[derive(Clone)]
pub struct Expression {
    source: String,
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
        let parsed = parse::parse(source)?;
        Ok(Expression { source: source.to_owned(), variables: parsed.variables, program: Program::new(&parsed.graph, parsed.root) })
    }

    /// The text it was compiled from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The value at the point `x` and the time `t`. It may be infinite or NaN, as for `1/x` or
    /// `sqrt(x)`; that is for the caller to check.
    pub fn value(&self, x: &[f64; 3], t: f64) -> f64 {
        self.program.value(x, t)
    }

    /// The values at many points and one time, equal to those of [`value`](Self::value) to the
    /// last bit. What does not depend on the point is evaluated once, which together with the
    /// evaluation in blocks makes this several times faster than point by point.
    ///
    /// `out` is as long as `points`; if it is not, only the first values, up to the shorter of the
    /// two lengths, are evaluated.
    pub fn values(&self, points: &[[f64; 3]], t: f64, out: &mut [f64]) {
        let count = points.len().min(out.len());
        self.program.values(&points[..count], t, &mut out[..count]);
    }

    /// Whether the text mentions a variable, be it without influence as in `0*x`.
    pub fn uses(&self, variable: Variable) -> bool {
        self.variables[variable as usize]
    }

    /// Whether the text mentions the time.
    pub fn depends_on_time(&self) -> bool {
        self.uses(Variable::T)
    }

    /// Whether the text mentions a coordinate.
    pub fn depends_on_space(&self) -> bool {
        [Variable::X, Variable::Y, Variable::Z].into_iter().any(|variable| self.uses(variable))
    }
}

impl fmt::Debug for Expression {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("Expression").field(&self.source).finish()
    }
}

impl PartialEq for Expression {
    fn eq(&self, other: &Expression) -> bool {
        self.source == other.source
    }
}

impl Eq for Expression {}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp, clippy::panic, clippy::cast_sign_loss)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const POINT: [f64; 3] = [0.3, -1.7, 2.5];
    const TIME: f64 = 0.8;

    fn at(source: &str) -> f64 {
        match Expression::parse(source) {
            Ok(expression) => expression.value(&POINT, TIME),
            Err(error) => panic!("{source}: {error}"),
        }
    }

    fn error(source: &str) -> ExpressionError {
        let error = Expression::parse(source).unwrap_err();
        assert!(source.is_char_boundary(error.offset), "{source}: {error}");
        error
    }

    #[test]
    fn precedence_and_associativity() {
        for (source, value) in [
            ("1", 1.0),
            (".5", 0.5),
            ("1.", 1.0),
            ("1e-3", 0.001),
            ("2.5E+4", 25_000.0),
            ("  1 +\t2\n", 3.0),
            ("2 + 3*4", 14.0),
            ("(2 + 3)*4", 20.0),
            ("10 - 4 - 3", 3.0),
            ("24/4/3", 2.0),
            ("24/4*3", 18.0),
            ("-2^2", -4.0),
            ("(-2)^2", 4.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("(2^3)^2", 64.0),
            ("2^-1^2", 0.5),
            ("-2^-2", -0.25),
            ("2^--2", 4.0),
            ("3*-2", -6.0),
            ("3 - -2", 5.0),
            ("3 + +2", 5.0),
            ("--3", 3.0),
            ("-2*-3", 6.0),
            ("2*3^2", 18.0),
            ("1 + 1 == 2", 1.0),
            ("1 < 2", 1.0),
            ("2 < 2", 0.0),
            ("2 <= 2", 1.0),
            ("2 > 1 + 1", 0.0),
            ("2 >= 1 + 1", 1.0),
            ("2 == 3", 0.0),
            ("2 != 3", 1.0),
            ("(1 < 2) < 1", 0.0),
            ("(1 < 2)*(3 > 2)*5", 5.0),
            ("0^0", 1.0),
            ("pow(2, 10)", 1024.0),
            ("if(1 < 2, 3, 4)", 3.0),
            ("if(1 > 2, 3, 4)", 4.0),
            ("min(3, 1, 2)", 1.0),
            ("max(3, 1, 4, 2)", 4.0),
        ] {
            assert_eq!(at(source), value, "{source}");
        }
        assert_eq!(at("-x^2"), -(0.3 * 0.3));
        assert_eq!(at("x + 10*y + 100*z + 1000*t"), 0.3 - 17.0 + 250.0 + 800.0);
        assert_eq!(at("pi"), std::f64::consts::PI);
        assert_eq!(at("2*e"), 2.0 * std::f64::consts::E);
    }

    #[test]
    fn functions_are_those_of_the_standard_library() {
        let [x, y, z] = POINT;
        for (source, value) in [
            ("sin(y)", y.sin()),
            ("cos(y)", y.cos()),
            ("tan(y)", y.tan()),
            ("asin(x)", x.asin()),
            ("acos(x)", x.acos()),
            ("atan(y)", y.atan()),
            ("sinh(y)", y.sinh()),
            ("cosh(y)", y.cosh()),
            ("tanh(y)", y.tanh()),
            ("exp(y)", y.exp()),
            ("log(z)", z.ln()),
            ("ln(z)", z.ln()),
            ("log10(z)", z.log10()),
            ("sqrt(z)", z.sqrt()),
            ("abs(y)", y.abs()),
            ("floor(y)", y.floor()),
            ("ceil(y)", y.ceil()),
            ("min(x, y, z)", x.min(y).min(z)),
            ("max(x, y, z)", x.max(y).max(z)),
            ("atan2(y, x)", y.atan2(x)),
            ("pow(z, y)", z.powf(y)),
            ("z^y", z.powf(y)),
            ("z^0.5", z.powf(0.5)),
            ("mod(y, x)", y % x + x),
            ("mod(z, x)", z % x),
            ("y^2", y * y),
            ("y^3", y * y * y),
            ("y^-1", 1.0 / y),
        ] {
            assert_eq!(at(source).to_bits(), value.to_bits(), "{source}");
        }
    }

    #[test]
    fn functions_of_our_own() {
        for (source, value) in [
            ("sign(-3)", -1.0),
            ("sign(0)", 0.0),
            ("sign(3)", 1.0),
            ("step(-1e-300)", 0.0),
            ("step(0)", 1.0),
            ("step(-0)", 1.0),
            ("step(2)", 1.0),
            ("mod(7, 3)", 1.0),
            ("mod(-7, 3)", 2.0),
            ("mod(7, -3)", -2.0),
            ("mod(-7, -3)", -1.0),
            ("mod(-6, 3)", 0.0),
            ("mod(5.5, 2)", 1.5),
        ] {
            assert_eq!(at(source), value, "{source}");
        }
    }

    #[test]
    fn integer_powers_are_products_however_the_exponent_is_known() {
        for n in -18..=18 {
            let constant = Expression::parse(&format!("x^({n})")).unwrap();
            let varying = Expression::parse("x^t").unwrap();
            for x in [-3.0, -0.7, 0.0, 1.1, 25.0] {
                let (a, b) = (constant.value(&[x, 0.0, 0.0], 0.0), f64::from(n));
                assert_eq!(a.to_bits(), varying.value(&[x, 0.0, 0.0], b).to_bits(), "{x}^{n}");
                let exact = x.powi(n);
                assert!(a == exact || (a / exact - 1.0).abs() < 1e-14, "{x}^{n}");
            }
        }
    }

    #[test]
    fn results_that_are_not_finite_are_returned() {
        assert_eq!(at("1/(x - x)"), f64::INFINITY);
        assert_eq!(at("log(0)"), f64::NEG_INFINITY);
        for source in [
            "sqrt(y)",
            "0/0",
            "sign(sqrt(y))",
            "step(sqrt(y))",
            "min(sqrt(y), 1)",
            "min(1, sqrt(y))",
            "max(sqrt(y), 1)",
            "max(1, sqrt(y))",
            "if(sqrt(y), 1, 2)",
            "mod(1, 0)",
        ] {
            assert!(at(source).is_nan(), "{source}");
        }
        assert_eq!(at("if(1, 2, sqrt(y))"), 2.0);
        assert_eq!(at("sqrt(y) == sqrt(y)"), 0.0);
        assert_eq!(at("sqrt(y) != sqrt(y)"), 1.0);
    }

    #[test]
    fn errors_say_where_and_what_to_write() {
        for (source, offset, found, hint) in [
            ("", 0, "the end of the expression", ""),
            ("  ", 2, "the end of the expression", ""),
            ("1 +", 3, "the end of the expression", ""),
            ("2 x", 2, "`x`", "write 2*x"),
            ("2x", 1, "`x`", "write 2*x"),
            ("2e", 1, "`e`", "write 2*e"),
            ("2 sin(x)", 2, "`sin`", "write 2*sin(...)"),
            ("2(x)", 1, "`(`", "write 2*(...)"),
            ("x(1)", 1, "`(`", "write x*(...)"),
            ("(x)(y)", 3, "`(`", "write * between two factors"),
            ("sin(2x)", 5, "`x`", "write 2*x"),
            ("xy", 0, "`xy`", "write x*y"),
            ("x**2", 1, "`**`", "write ^ for a power"),
            ("x = 1", 2, "`=`", "write == to compare"),
            ("x < y < z", 6, "`<`", "write (a < b)*(b < c) where both must hold"),
            ("x == y != z", 7, "`!=`", "write (a < b)*(b < c) where both must hold"),
            ("(x < 1) && (y < 1)", 8, "`&&`", "write (a)*(b) where both conditions must hold"),
            ("1,5*x", 1, "`,`", "write decimals with a point, as in 2.5"),
            ("(x + 1", 6, "the end of the expression", "the parenthesis opened at byte 0 is not closed"),
            ("x + 1)", 5, "`)`", "no parenthesis is open here"),
            ("()", 1, "`)`", ""),
            ("sin x", 4, "`x`", "sin takes one argument: sin(a)"),
            ("sin", 3, "the end of the expression", "sin takes one argument: sin(a)"),
            ("sin()", 4, "`)`", "sin takes one argument: sin(a)"),
            ("sin(x, y)", 5, "`,`", "sin takes one argument: sin(a)"),
            ("atan2(x)", 7, "`)`", "atan2 takes two arguments: atan2(a, b)"),
            ("if(x, y)", 7, "`)`", "if takes three arguments: if(a, b, c)"),
            ("min(x)", 5, "`)`", "min takes two or more arguments: min(a, b)"),
            ("1 + sine(x)", 4, "`sine`", "did you mean sin?"),
            ("Sin(x)", 0, "`Sin`", "did you mean sin?"),
            ("sqr(x)", 0, "`sqr`", "did you mean sqrt?"),
            ("arctan(x)", 0, "`arctan`", "did you mean atan?"),
            ("PI", 0, "`PI`", "did you mean pi?"),
            ("X", 0, "`X`", "did you mean x?"),
            ("temperature", 0, "`temperature`", ""),
            ("1 + é", 4, "`é`", ""),
            ("2*π", 2, "`π`", "write pi"),
            ("1 − x", 2, "`−`", "write -"),
            ("x²", 1, "`²`", "write ^2"),
            ("x # 1", 2, "`#`", ""),
            ("x \u{7}", 2, "`\\u{7}`", ""),
            (".", 0, "`.`", ""),
            ("1e999", 0, "`1e999`", ""),
            ("x + 1e-999", 4, "`1e-999`", ""),
            ("1.2.3", 3, "`.3`", "write 1.2*.3"),
        ] {
            let error = error(source);
            let actual = (error.offset, error.found.as_str(), error.hint.as_deref().unwrap_or(""));
            assert_eq!(actual, (offset, found, hint), "{source}");
        }
    }

    #[test]
    fn errors_read_as_a_sentence() {
        assert_eq!(error("2x").to_string(), "at byte 1: found `x`, expected an operator or the end of the expression (write 2*x)");
        assert_eq!(
            error("1 +").to_string(),
            "at byte 3: found the end of the expression, expected a number, a variable, \
             a function or `(`"
        );
    }

    #[test]
    fn hostile_texts_are_refused() {
        assert_eq!(error(&"(".repeat(50_000)).offset, parse::MAX_LENGTH);
        assert_eq!(error(&"x+".repeat(50_000)).offset, parse::MAX_LENGTH);
        assert_eq!(error(&"é".repeat(50_000)).offset, parse::MAX_LENGTH);
        assert_eq!(error(&format!("x{}", "é".repeat(9_000))).offset, parse::MAX_LENGTH - 1);
        for (piece, offset) in [("(", 200), ("-", 200), ("2^", 400), ("sin(", 800), ("if(", 600)] {
            let error = error(&piece.repeat(9_000 / piece.len()));
            assert_eq!(error.offset, offset, "{piece}");
            assert!(error.expected.contains("200 levels"), "{piece}");
        }
        assert!(error(&"a".repeat(10_000)).to_string().len() < 300);
        assert!(error(&"1".repeat(10_000)).to_string().len() < 300);
    }

    #[test]
    fn large_expressions_within_the_limits_are_evaluated() {
        assert_eq!(at(&format!("x{}", "+1".repeat(4_999))), 4_999.0 + 0.3);
        assert_eq!(at(&format!("{}1{}", "(".repeat(199), ")".repeat(199))), 1.0);
        let wide = format!("max({}0)", "x+y,".repeat(2_000));
        assert_eq!(at(&wide), 0.0);
        // Many values alive at once, so that the slots do not fit the stack.
        let terms: Vec<_> = (1..150).map(|i| format!("(x+{i}")).collect();
        let nested = format!("{}{}", terms.join("*"), ")".repeat(149));
        let expression = Expression::parse(&nested).unwrap();
        let mut out = [0.0; 5];
        expression.values(&[POINT; 5], TIME, &mut out);
        assert!(out.iter().all(|value| value.to_bits() == at(&nested).to_bits()));
    }

    #[test]
    fn dependence_is_that_of_the_text() {
        for (source, space, time) in [
            ("1 + pi", false, false),
            ("x", true, false),
            ("y", true, false),
            ("z", true, false),
            ("exp(-t)", false, true),
            ("x*t", true, true),
            ("0*z + t^0", true, true),
        ] {
            let expression = Expression::parse(source).unwrap();
            assert_eq!(expression.depends_on_space(), space, "{source}");
            assert_eq!(expression.depends_on_time(), time, "{source}");
        }
        let expression = Expression::parse("x + max(z, 1)").unwrap();
        let used = [Variable::X, Variable::Y, Variable::Z, Variable::T].map(|variable| expression.uses(variable));
        assert_eq!(used, [true, false, true, false]);
    }

    #[test]
    fn an_expression_is_its_text() {
        fn shared<T: Send + Sync + Clone>(_: &T) {}
        let expression = Expression::parse("x + 1").unwrap();
        shared(&expression);
        assert_eq!(expression.source(), "x + 1");
        assert_eq!(format!("{expression:?}"), "Expression(\"x + 1\")");
        assert_eq!(expression, expression.clone());
        assert_ne!(expression, Expression::parse("x+1").unwrap());
    }

    #[test]
    fn lengths_that_differ_are_cut_to_the_shorter() {
        let expression = Expression::parse("x").unwrap();
        let mut out = [7.0; 3];
        expression.values(&[POINT; 2], 0.0, &mut out);
        assert_eq!(out, [0.3, 0.3, 7.0]);
        expression.values(&[POINT; 9], 0.0, &mut out[..1]);
        expression.values(&[], 0.0, &mut out);
        assert_eq!(out, [0.3, 0.3, 7.0]);
    }

    /// An expression as its author thinks of it.
    #[derive(Clone, Debug)]
    enum Tree {
        Number(f64),
        Name(&'static str),
        Negate(Box<Tree>),
        Infix(&'static str, Box<Tree>, Box<Tree>),
        Call(&'static str, Vec<Tree>),
    }

    impl Tree {
        /// How tightly the outermost operation binds.
        fn level(&self) -> u8 {
            match self {
                Tree::Infix("+" | "-", ..) => 1,
                Tree::Infix("*" | "/", ..) => 2,
                Tree::Negate(_) => 3,
                Tree::Infix("^", ..) => 4,
                Tree::Infix(..) => 0,
                Tree::Number(_) | Tree::Name(_) | Tree::Call(..) => 5,
            }
        }

        /// With parentheses only where the grammar needs them.
        fn text(&self, least: u8) -> String {
            let text = match self {
                Tree::Number(value) => format!("{value:?}"),
                Tree::Name(name) => (*name).to_owned(),
                Tree::Negate(a) => format!("-{}", a.text(3)),
                Tree::Infix("^", a, b) => format!("{}^{}", a.text(5), b.text(3)),
                Tree::Infix(op, a, b) => {
                    format!("{} {op} {}", a.text(self.level().max(1)), b.text(self.level() + 1))
                }
                Tree::Call(name, arguments) => {
                    let arguments: Vec<_> = arguments.iter().map(|a| a.text(0)).collect();
                    format!("{name}({})", arguments.join(", "))
                }
            };
            if self.level() < least { format!("({text})") } else { text }
        }

        fn value(&self, x: &[f64; 3], t: f64) -> f64 {
            let truth = |condition: bool| f64::from(u8::from(condition));
            match self {
                Tree::Number(value) => *value,
                Tree::Name("x") => x[0],
                Tree::Name("y") => x[1],
                Tree::Name("z") => x[2],
                Tree::Name("t") => t,
                Tree::Name("pi") => std::f64::consts::PI,
                Tree::Name(_) => std::f64::consts::E,
                Tree::Negate(a) => -a.value(x, t),
                Tree::Infix(op, a, b) => {
                    let (a, b) = (a.value(x, t), b.value(x, t));
                    match *op {
                        "+" => a + b,
                        "-" => a - b,
                        "*" => a * b,
                        "/" => a / b,
                        "<" => truth(a < b),
                        "<=" => truth(a <= b),
                        ">" => truth(a > b),
                        ">=" => truth(a >= b),
                        "==" => truth(a == b),
                        "!=" => truth(a != b),
                        _ => power(a, b),
                    }
                }
                Tree::Call(name, arguments) => {
                    let values: Vec<_> = arguments.iter().map(|a| a.value(x, t)).collect();
                    call(name, &values)
                }
            }
        }
    }

    fn power(a: f64, b: f64) -> f64 {
        fn squaring(a: f64, n: u32) -> f64 {
            match n {
                1 => a,
                n if n % 2 == 0 => squaring(a, n / 2) * squaring(a, n / 2),
                n => squaring(a, n - 1) * a,
            }
        }
        match b {
            0.0 => 1.0,
            b if b == b.trunc() && (1.0..=16.0).contains(&b) => squaring(a, b as u32),
            b if b == b.trunc() && (-16.0..=-1.0).contains(&b) => 1.0 / squaring(a, -b as u32),
            b => a.powf(b),
        }
    }

    fn call(name: &str, values: &[f64]) -> f64 {
        match (name, values) {
            ("sin", [a]) => a.sin(),
            ("exp", [a]) => a.exp(),
            ("log", [a]) => a.ln(),
            ("sqrt", [a]) => a.sqrt(),
            ("floor", [a]) => a.floor(),
            ("abs", [a]) => a.abs(),
            ("sign" | "step", [a]) if a.is_nan() => f64::NAN,
            ("sign", [a]) if *a == 0.0 => *a,
            ("sign", [a]) => a.signum(),
            ("step", [a]) => f64::from(u8::from(*a >= 0.0)),
            ("atan2", [a, b]) => a.atan2(*b),
            ("pow", [a, b]) => power(*a, *b),
            ("mod", [a, b]) => {
                let r = a % b;
                if r < 0.0 && *b > 0.0 || r > 0.0 && *b < 0.0 { r + b } else { r }
            }
            ("if", [c, a, b]) => match *c {
                0.0 => *b,
                c if c.is_nan() => c,
                _ => *a,
            },
            ("min" | "max", [first, others @ ..]) => others.iter().fold(*first, |a, &b| match name {
                _ if a.is_nan() || b.is_nan() => f64::NAN,
                "min" if a < b => a,
                "max" if a > b => a,
                _ => b,
            }),
            _ => panic!("{name} of {} arguments", values.len()),
        }
    }

    fn tree() -> impl Strategy<Value = Tree> {
        let leaf = prop_oneof![
            (0_u8..20).prop_map(|n| Tree::Number(f64::from(n))),
            (0.0..1e3).prop_map(Tree::Number),
            any::<f64>().prop_filter_map("finite", |v| { v.is_finite().then_some(Tree::Number(v.abs())) }),
            prop::sample::select(vec!["x", "y", "z", "t", "x", "y", "z", "t", "pi", "e"]).prop_map(Tree::Name),
        ];
        leaf.prop_recursive(6, 80, 4, |inner| {
            let boxed = inner.clone().prop_map(Box::new).boxed();
            let infix = vec!["+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!="];
            let calls = vec![
                ("sin", 1),
                ("exp", 1),
                ("log", 1),
                ("sqrt", 1),
                ("floor", 1),
                ("abs", 1),
                ("sign", 1),
                ("step", 1),
                ("atan2", 2),
                ("pow", 2),
                ("mod", 2),
                ("if", 3),
                ("min", 2),
                ("min", 4),
                ("max", 3),
            ];
            let call = prop::sample::select(calls)
                .prop_flat_map(move |(name, count)| prop::collection::vec(inner.clone(), count).prop_map(move |arguments| Tree::Call(name, arguments)));
            prop_oneof![
                1 => boxed.clone().prop_map(Tree::Negate),
                6 => (prop::sample::select(infix), boxed.clone(), boxed)
                    .prop_map(|(op, a, b)| Tree::Infix(op, a, b)),
                4 => call,
            ]
        })
    }

    fn bits(value: f64) -> Option<u64> {
        (!value.is_nan()).then(|| value.to_bits())
    }

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![8 => -3.0..3.0, 2 => (-3_i8..=3).prop_map(f64::from), 1 => any::<f64>()]
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            failure_persistence: None,
            ..ProptestConfig::with_cases(500)
        })]

        #[test]
        fn evaluation_agrees_with_the_tree(
            tree in tree(),
            points in prop::collection::vec([coordinate(), coordinate(), coordinate()], 0..300),
            t in coordinate(),
        ) {
            let text = tree.text(0);
            prop_assume!(text.len() <= parse::MAX_LENGTH);
            let expression = match Expression::parse(&text) {
                Ok(expression) => expression,
                Err(error) => return Err(TestCaseError::fail(format!("{text}: {error}"))),
            };
            let mut out = vec![7.0; points.len()];
            expression.values(&points, t, &mut out);
            for (point, block) in points.iter().zip(out) {
                let value = expression.value(point, t);
                prop_assert_eq!(value.to_bits(), block.to_bits(), "{} at {:?} {}", text, point, t);
                let direct = tree.value(point, t);
                prop_assert_eq!(bits(value), bits(direct), "{} at {:?} {}", text, point, t);
            }
        }

        #[test]
        fn any_bytes_are_an_expression_or_an_error(
            bytes in prop::collection::vec(any::<u8>(), 0..200),
        ) {
            survives(&String::from_utf8_lossy(&bytes));
        }

        #[test]
        fn any_pieces_are_an_expression_or_an_error(
            pieces in prop::collection::vec(
                prop::sample::select(vec![
                    "x", "t", "1", "2.5e", "e-3", ".", "+", "-", "*", "/", "^", "(", ")", ",", "<",
                    "==", "!", "sin", "min(", "if(", " ", "π", "é", "\0", "foo",
                ]),
                0..40,
            ),
        ) {
            survives(&pieces.concat());
        }
    }

    fn survives(text: &str) {
        match Expression::parse(text) {
            Ok(expression) => {
                let mut out = [0.0; 10];
                expression.values(&[POINT; 10], TIME, &mut out);
                assert_eq!(out[9].to_bits(), expression.value(&POINT, TIME).to_bits());
            }
            Err(error) => {
                assert!(text.is_char_boundary(error.offset));
                assert!(!error.to_string().is_empty());
            }
        }
    }
}
