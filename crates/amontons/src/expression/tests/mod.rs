//! Tests of the language and of the evaluation.

mod derivatives;
mod tree;

use proptest::prelude::*;

use super::*;
use tree::tree;

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
    assert_eq!(
        error("2x").to_string(),
        "at byte 1: found `x`, expected an operator or the end of the expression (write 2*x)"
    );
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
