//! Random expressions, and their evaluation without the program.

use proptest::prelude::*;

/// An expression as a tree.
#[derive(Clone, Debug)]
pub(super) enum ExpressionTree {
    Number(f64),
    Name(&'static str),
    Negate(Box<ExpressionTree>),
    Infix(&'static str, Box<ExpressionTree>, Box<ExpressionTree>),
    Call(&'static str, Vec<ExpressionTree>),
}

impl ExpressionTree {
    /// Precedence of the outermost operation.
    fn level(&self) -> u8 {
        match self {
            ExpressionTree::Infix("+" | "-", ..) => 1,
            ExpressionTree::Infix("*" | "/", ..) => 2,
            ExpressionTree::Negate(_) => 3,
            ExpressionTree::Infix("^", ..) => 4,
            ExpressionTree::Infix(..) => 0,
            ExpressionTree::Number(_) | ExpressionTree::Name(_) | ExpressionTree::Call(..) => 5,
        }
    }

    /// The text, with parentheses only where the grammar needs them.
    pub(super) fn text(&self, least: u8) -> String {
        let text = match self {
            ExpressionTree::Number(value) => format!("{value:?}"),
            ExpressionTree::Name(name) => (*name).to_owned(),
            ExpressionTree::Negate(a) => format!("-{}", a.text(3)),
            ExpressionTree::Infix("^", a, b) => format!("{}^{}", a.text(5), b.text(3)),
            ExpressionTree::Infix(op, a, b) => {
                format!("{} {op} {}", a.text(self.level().max(1)), b.text(self.level() + 1))
            }
            ExpressionTree::Call(name, arguments) => {
                let arguments: Vec<_> = arguments.iter().map(|a| a.text(0)).collect();
                format!("{name}({})", arguments.join(", "))
            }
        };
        if self.level() < least { format!("({text})") } else { text }
    }

    pub(super) fn value(&self, x: &[f64; 3], t: f64) -> f64 {
        let truth = |condition: bool| f64::from(u8::from(condition));
        match self {
            ExpressionTree::Number(value) => *value,
            ExpressionTree::Name("x") => x[0],
            ExpressionTree::Name("y") => x[1],
            ExpressionTree::Name("z") => x[2],
            ExpressionTree::Name("t") => t,
            ExpressionTree::Name("pi") => std::f64::consts::PI,
            ExpressionTree::Name(_) => std::f64::consts::E,
            ExpressionTree::Negate(a) => -a.value(x, t),
            ExpressionTree::Infix(op, a, b) => {
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
            ExpressionTree::Call(name, arguments) => {
                let values: Vec<_> = arguments.iter().map(|a| a.value(x, t)).collect();
                call(name, &values)
            }
        }
    }

    /// The largest magnitude among the values of all parts, infinite if one of them is NaN. The
    /// frequency of `mod` counts as well, at a hundred times its value.
    pub(super) fn largest(&self, x: &[f64; 3], t: f64) -> f64 {
        let value = self.value(x, t).abs();
        let parts: Vec<&ExpressionTree> = match self {
            ExpressionTree::Number(_) | ExpressionTree::Name(_) => Vec::new(),
            ExpressionTree::Negate(a) => vec![a],
            ExpressionTree::Infix(_, a, b) => vec![a, b],
            ExpressionTree::Call(_, arguments) => arguments.iter().collect(),
        };
        let frequency = match self {
            ExpressionTree::Call("mod", arguments) => 100.0 / arguments[1].value(x, t).abs(),
            _ => 0.0,
        };
        let own = if value.is_nan() { f64::INFINITY } else { value.max(frequency) };
        parts.into_iter().map(|part| part.largest(x, t)).fold(own, f64::max)
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
        ("cos", [a]) => a.cos(),
        ("tanh", [a]) => a.tanh(),
        ("atan", [a]) => a.atan(),
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

const CALLS: [(&str, usize); 18] = [
    ("sin", 1),
    ("cos", 1),
    ("tanh", 1),
    ("atan", 1),
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

/// Expressions of every kind; many have no finite value.
pub(super) fn tree() -> impl Strategy<Value = ExpressionTree> {
    let leaf = prop_oneof![
        (0_u8..20).prop_map(|n| ExpressionTree::Number(f64::from(n))),
        (0.0..1e3).prop_map(ExpressionTree::Number),
        any::<f64>().prop_filter_map("finite", |v| { v.is_finite().then_some(ExpressionTree::Number(v.abs())) }),
        prop::sample::select(vec!["x", "y", "z", "t", "x", "y", "z", "t", "pi", "e"]).prop_map(ExpressionTree::Name),
    ];
    grown(leaf, &["+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!="], 6)
}

/// Expressions most of which vary moderately with the variables.
pub(super) fn moderate_tree() -> impl Strategy<Value = ExpressionTree> {
    let leaf = prop_oneof![
        1 => (0_u8..4).prop_map(|n| ExpressionTree::Number(f64::from(n))),
        1 => (0.1..4.0).prop_map(ExpressionTree::Number),
        8 => prop::sample::select(vec!["x", "y", "z", "t"]).prop_map(ExpressionTree::Name),
    ];
    grown(leaf, &["+", "+", "+", "-", "-", "-", "*", "*", "*", "/", "/", "^", "<", ">="], 4)
}

fn grown(
    leaf: impl Strategy<Value = ExpressionTree> + 'static,
    infix: &'static [&str],
    depth: u32,
) -> impl Strategy<Value = ExpressionTree> {
    leaf.prop_recursive(depth, 80, 4, move |inner| {
        let boxed = inner.clone().prop_map(Box::new).boxed();
        let call = prop::sample::select(&CALLS[..]).prop_flat_map(move |(name, count)| {
            prop::collection::vec(inner.clone(), count).prop_map(move |arguments| ExpressionTree::Call(name, arguments))
        });
        prop_oneof![
            1 => boxed.clone().prop_map(ExpressionTree::Negate),
            6 => (prop::sample::select(infix), boxed.clone(), boxed)
                .prop_map(|(op, a, b)| ExpressionTree::Infix(op, a, b)),
            4 => call,
        ]
    })
}
