//! The operations of an expression on numbers.

/// Largest magnitude of integer exponents that are evaluated by multiplication, which is exact if the product is, and
/// much faster than the general power.
const LARGEST_INTEGER_EXPONENT: u32 = 16;

/// An operation on one to three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Op {
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Log,
    Log10,
    Sqrt,
    Abs,
    Sign,
    Floor,
    Ceil,
    Step,
    Min,
    Max,
    Atan2,
    Modulo,
    If,
}

/// A way of applying a function to operands: to numbers, or to blocks of them.
pub(super) trait Operands {
    type Output;
    fn unary(self, function: impl Fn(f64) -> f64) -> Self::Output;
    fn binary(self, function: impl Fn(f64, f64) -> f64) -> Self::Output;
    fn ternary(self, function: impl Fn(f64, f64, f64) -> f64) -> Self::Output;
}

/// The one definition of all operations. Constant folding, evaluation at a point and evaluation of a block all use it,
/// so their results are equal.
#[allow(clippy::inline_always)] // a call would cost the scalar evaluation more than the operation
#[inline(always)]
pub(super) fn apply<O: Operands>(op: Op, operands: O) -> O::Output {
    match op {
        Op::Negate => operands.unary(|a| -a),
        Op::Add => operands.binary(|a, b| a + b),
        Op::Subtract => operands.binary(|a, b| a - b),
        Op::Multiply => operands.binary(|a, b| a * b),
        Op::Divide => operands.binary(|a, b| a / b),
        Op::Power => operands.binary(power),
        Op::Less => operands.binary(|a, b| truth(a < b)),
        Op::LessEqual => operands.binary(|a, b| truth(a <= b)),
        Op::Greater => operands.binary(|a, b| truth(a > b)),
        Op::GreaterEqual => operands.binary(|a, b| truth(a >= b)),
        // The user asks for exact equality, as in `t == 0`; a tolerance must be written explicitly.
        #[allow(clippy::float_cmp)]
        Op::Equal => operands.binary(|a, b| truth(a == b)),
        #[allow(clippy::float_cmp)]
        Op::NotEqual => operands.binary(|a, b| truth(a != b)),
        Op::Sin => operands.unary(f64::sin),
        Op::Cos => operands.unary(f64::cos),
        Op::Tan => operands.unary(f64::tan),
        Op::Asin => operands.unary(f64::asin),
        Op::Acos => operands.unary(f64::acos),
        Op::Atan => operands.unary(f64::atan),
        Op::Sinh => operands.unary(f64::sinh),
        Op::Cosh => operands.unary(f64::cosh),
        Op::Tanh => operands.unary(f64::tanh),
        Op::Exp => operands.unary(f64::exp),
        Op::Log => operands.unary(f64::ln),
        Op::Log10 => operands.unary(f64::log10),
        Op::Sqrt => operands.unary(f64::sqrt),
        Op::Abs => operands.unary(f64::abs),
        Op::Sign => operands.unary(sign),
        Op::Floor => operands.unary(f64::floor),
        Op::Ceil => operands.unary(f64::ceil),
        Op::Step => operands.unary(step),
        Op::Min => operands.binary(minimum),
        Op::Max => operands.binary(maximum),
        Op::Atan2 => operands.binary(f64::atan2),
        Op::Modulo => operands.binary(modulo),
        Op::If => operands.ternary(select),
    }
}

// A branch instead of a conversion of the truth value, because a branch vectorizes.
#[inline]
fn truth(condition: bool) -> f64 {
    if condition { 1.0 } else { 0.0 }
}

#[inline]
fn sign(a: f64) -> f64 {
    if a > 0.0 {
        1.0
    } else if a < 0.0 {
        -1.0
    } else {
        a
    }
}

#[inline]
fn step(a: f64) -> f64 {
    if a < 0.0 {
        0.0
    } else if a >= 0.0 {
        1.0
    } else {
        a
    }
}

// `f64::min` and `f64::max` would drop a NaN, and do not define the sign of a zero.
#[inline]
fn minimum(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

#[inline]
fn maximum(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

// The remainder is exact, while `a - b*floor(a/b)` suffers from the rounding of the quotient.
#[inline]
fn modulo(a: f64, b: f64) -> f64 {
    let remainder = a % b;
    if remainder != 0.0 && (remainder < 0.0) != (b < 0.0) { remainder + b } else { remainder }
}

#[inline]
fn select(condition: f64, a: f64, b: f64) -> f64 {
    if condition == 0.0 {
        b
    } else if condition.is_nan() {
        condition
    } else {
        a
    }
}

/// A power. Small integer exponents known only at evaluation are treated like constant ones, so that `x^t` at `t = 2`
/// equals `x^2` to the last bit.
pub(super) fn power(base: f64, exponent: f64) -> f64 {
    match small_integer(exponent) {
        Some(0) => 1.0,
        Some(n) => {
            let product = integer_power(base, n.unsigned_abs(), |a, b| a * b);
            if n < 0 { 1.0 / product } else { product }
        }
        None => base.powf(exponent),
    }
}

#[allow(clippy::float_cmp)] // an integer is wanted, not a number close to one
pub(super) fn small_integer(value: f64) -> Option<i32> {
    let n = value as i32;
    (f64::from(n) == value && n.unsigned_abs() <= LARGEST_INTEGER_EXPONENT).then_some(n)
}

/// `base` to the power `n >= 1` by squaring, for numbers and for nodes of the graph, with the same order of
/// multiplications.
pub(super) fn integer_power<T: Copy>(base: T, n: u32, mut multiply: impl FnMut(T, T) -> T) -> T {
    let mut result = base;
    for bit in (0..n.ilog2()).rev() {
        result = multiply(result, result);
        if n >> bit & 1 == 1 {
            result = multiply(result, base);
        }
    }
    result
}
