//! The chain rule, operation by operation.

use std::array::from_fn;
use std::f64::consts::LN_10;

use super::ops::{Op, power};

/// The derivatives of a value by x, y, z and t.
pub(super) type Partials = [f64; 4];

/// The derivatives of `value`, the outcome of `op`, from the values and derivatives of its operands.
pub(super) fn partials(op: Op, operands: [f64; 3], slopes: [&Partials; 3], value: f64) -> Partials {
    let [a, b, _] = operands;
    let [da, db, dc] = slopes;
    let unary = |local: f64| da.map(|da| chain(local, a, da));
    match op {
        Op::Negate => da.map(|da| -da),
        Op::Add => from_fn(|i| da[i] + db[i]),
        Op::Subtract => from_fn(|i| da[i] - db[i]),
        Op::Multiply => from_fn(|i| product(a, da[i], db[i]) + product(b, db[i], da[i])),
        Op::Divide => from_fn(|i| quotient(value, b, da[i], db[i])),
        Op::Power => power_slope([a, b], [da, db], value),
        Op::Less
        | Op::LessEqual
        | Op::Greater
        | Op::GreaterEqual
        | Op::Equal
        | Op::NotEqual
        | Op::Sign
        | Op::Floor
        | Op::Ceil
        | Op::Step => [0.0; 4],
        Op::Sin => unary(a.cos()),
        Op::Cos => unary(-a.sin()),
        Op::Tan => unary(1.0 + value * value),
        Op::Asin => unary(1.0 / ((1.0 - a) * (1.0 + a)).sqrt()),
        Op::Acos => unary(-1.0 / ((1.0 - a) * (1.0 + a)).sqrt()),
        Op::Atan => unary(1.0 / (1.0 + a * a)),
        Op::Sinh => unary(a.cosh()),
        Op::Cosh => unary(a.sinh()),
        // The square of the value would lose all digits where it is close to 1.
        Op::Tanh => unary(a.cosh().recip().powi(2)),
        Op::Exp => unary(value),
        // The magnitude is used because the slope at -0 is that at 0; for negative arguments the value is NaN.
        Op::Log => unary(1.0 / a.abs()),
        Op::Log10 => unary(1.0 / (a.abs() * LN_10)),
        Op::Sqrt => unary(0.5 / value.abs()),
        Op::Abs if a == 0.0 => [0.0; 4],
        Op::Abs => unary(a.signum()),
        Op::Min => *if a < b { da } else { db },
        Op::Max => *if a > b { da } else { db },
        Op::Atan2 => {
            let r = a.hypot(b);
            let (by_a, by_b) = if r.is_infinite() { (0.0, 0.0) } else { (b / r / r, -a / r / r) };
            from_fn(|i| chain(by_a, r, da[i]) + chain(by_b, r, db[i]))
        }
        // The remainder is exact while the quotient is rounded: its floor would be wrong next to a jump.
        Op::Modulo => {
            let periods = ((a - value) / b).round();
            from_fn(|i| da[i] - chain(periods, b, db[i]))
        }
        Op::If => *if a == 0.0 { dc } else { db },
    }
}

/// The slope `local` of a function of `a`, times the slope of `a`.
///
/// A constant operand contributes nothing, however steep the function is; nor does an infinite operand, as after an
/// overflow, where the function is level.
fn chain(local: f64, a: f64, da: f64) -> f64 {
    if da == 0.0 || (local == 0.0 && a.is_infinite()) { 0.0 } else { local * da }
}

/// The term `a db` in the derivative of the product `a b`.
///
/// A vanishing `a` gives 0 even if the finite `b` has an infinite slope: the difference quotient is that of `a`, which
/// tends to `da`, times `b`.
fn product(a: f64, da: f64, db: f64) -> f64 {
    let outweighs = a == 0.0 && (da == 0.0 || (da.is_finite() && db.is_infinite()));
    if db == 0.0 || outweighs { 0.0 } else { a * db }
}

/// The derivative of `value = a/b`.
fn quotient(value: f64, b: f64, da: f64, db: f64) -> f64 {
    let change = if value == 0.0 && b.is_infinite() { da } else { da - product(value, da, db) };
    if change == 0.0 { 0.0 } else { change / b }
}

/// The derivatives of `value = a^b`. Each of the two terms is computed only if it counts: the logarithm of a negative
/// base does not matter for a constant exponent.
fn power_slope([a, b]: [f64; 2], [da, db]: [&Partials; 2], value: f64) -> Partials {
    let moves = |slopes: &Partials| slopes.iter().any(|&slope| slope != 0.0);
    let mut result = [0.0; 4];
    if b != 0.0 && moves(da) {
        let local = b * power(a, b - 1.0);
        result = da.map(|da| chain(local, a, da));
    }
    if moves(db) {
        // 0^b is 0 for all b > 0.
        let local = if value == 0.0 && a >= 0.0 { 0.0 } else { value * a.ln() };
        for (result, &db) in result.iter_mut().zip(db) {
            *result += chain(local, b, db);
        }
    }
    result
}
