//! Parser from the text of an expression to its graph.

use std::ops::Range;

use super::ops::Op;
use super::program::{NodeId, OperationGraph};
use super::{ExpressionError, NamedConstants, Variable};

/// Longest expression, in bytes.
pub(super) const MAX_LENGTH: usize = 10_000;

/// Deepest nesting of parentheses, signs and powers; each takes a level of recursion.
pub(super) const MAX_DEPTH: usize = 200;

/// Longest piece of the source that is quoted in a message, in characters.
const MAX_QUOTE: usize = 30;

const OPERAND: &str = "a number, a variable, a function or `(`";

#[derive(Clone, Copy, Debug)]
pub(super) enum Arity {
    Exactly(usize),
    AtLeastTwo,
}

pub(super) const FUNCTIONS: [(&str, Op, Arity); 25] = [
    ("sin", Op::Sin, Arity::Exactly(1)),
    ("cos", Op::Cos, Arity::Exactly(1)),
    ("tan", Op::Tan, Arity::Exactly(1)),
    ("asin", Op::Asin, Arity::Exactly(1)),
    ("acos", Op::Acos, Arity::Exactly(1)),
    ("atan", Op::Atan, Arity::Exactly(1)),
    ("sinh", Op::Sinh, Arity::Exactly(1)),
    ("cosh", Op::Cosh, Arity::Exactly(1)),
    ("tanh", Op::Tanh, Arity::Exactly(1)),
    ("exp", Op::Exp, Arity::Exactly(1)),
    ("log", Op::Log, Arity::Exactly(1)),
    ("ln", Op::Log, Arity::Exactly(1)),
    ("log10", Op::Log10, Arity::Exactly(1)),
    ("sqrt", Op::Sqrt, Arity::Exactly(1)),
    ("abs", Op::Abs, Arity::Exactly(1)),
    ("sign", Op::Sign, Arity::Exactly(1)),
    ("floor", Op::Floor, Arity::Exactly(1)),
    ("ceil", Op::Ceil, Arity::Exactly(1)),
    ("step", Op::Step, Arity::Exactly(1)),
    ("min", Op::Min, Arity::AtLeastTwo),
    ("max", Op::Max, Arity::AtLeastTwo),
    ("atan2", Op::Atan2, Arity::Exactly(2)),
    ("pow", Op::Power, Arity::Exactly(2)),
    ("mod", Op::Modulo, Arity::Exactly(2)),
    ("if", Op::If, Arity::Exactly(3)),
];

/// The variables in the order of their names.
const VARIABLES: [Variable; 4] = [Variable::X, Variable::Y, Variable::Z, Variable::T];
/// The names of the coordinates and the time.
pub(super) const PLACE: &[&str] = &["x", "y", "z", "t"];

pub(super) const CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), ("e", std::f64::consts::E)];

/// Names of our functions in other languages that are too different for the edit distance.
const FOREIGN_NAMES: [(&str, &str); 10] = [
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("arctan2", "atan2"),
    ("power", "pow"),
    ("fmod", "mod"),
    ("fabs", "abs"),
    ("sgn", "sign"),
    ("ceiling", "ceil"),
    ("heaviside", "step"),
];

/// Symbols that are not part of the language, with a hint. Longer ones first.
const FOREIGN_SYMBOLS: [(&str, &str); 23] = [
    ("**", "write ^ for a power"),
    ("&&", "write (a)*(b) where both conditions must hold"),
    ("&", "write (a)*(b) where both conditions must hold"),
    ("||", "write max(a, b) where one condition must hold"),
    ("|", "write abs(a) for a magnitude, max(a, b) where one condition must hold"),
    ("=", "write == to compare"),
    ("!", "write a == 0 for the contrary of a condition"),
    ("%", "write mod(a, b) for a remainder"),
    ("?", "write if(condition, a, b)"),
    ("[", "write parentheses ( )"),
    ("]", "write parentheses ( )"),
    ("{", "write parentheses ( )"),
    ("}", "write parentheses ( )"),
    (";", "separate arguments by a comma"),
    ("\u{2212}", "write -"),
    ("\u{d7}", "write *"),
    ("\u{b7}", "write *"),
    ("\u{f7}", "write /"),
    ("\u{b2}", "write ^2"),
    ("\u{b3}", "write ^3"),
    ("\u{3c0}", "write pi"),
    ("\u{2264}", "write <="),
    ("\u{2265}", "write >="),
];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Token {
    Number(f64),
    Name,
    Plus,
    Minus,
    Times,
    Over,
    Caret,
    Compare(Op),
    Open,
    Close,
    Comma,
    End,
}

/// Result of the parser: the graph, its root, and the variables mentioned.
pub(super) struct Parsed {
    pub(super) graph: OperationGraph,
    pub(super) root: NodeId,
    pub(super) variables: [bool; 4],
    /// The constants mentioned, beside `pi` and `e`.
    pub(super) used: Vec<(String, f64)>,
}

pub(super) fn parse<'s>(
    source: &'s str,
    names: &'s [&'s str],
    constants: &'s NamedConstants,
) -> Result<Parsed, ExpressionError> {
    if source.len() > MAX_LENGTH {
        return Err(ExpressionError {
            offset: source.floor_char_boundary(MAX_LENGTH),
            found: format!("an expression of {} bytes", source.len()),
            expected: format!("at most {MAX_LENGTH} bytes"),
            hint: None,
        });
    }
    let mut parser = Parser {
        source,
        names,
        constants,
        used: Vec::new(),
        token: Token::End,
        span: 0..0,
        previous: Token::End,
        previous_span: 0..0,
        depth: 0,
        graph: OperationGraph::default(),
        variables: [false; 4],
    };
    parser.advance()?;
    let root = parser.comparison()?;
    if parser.token != Token::End {
        return Err(parser.after_operand("an operator or the end of the expression", None));
    }
    Ok(Parsed { graph: parser.graph, root, variables: parser.variables, used: parser.used })
}

struct Parser<'a> {
    source: &'a str,
    /// Names of the variables.
    names: &'a [&'a str],
    /// NamedConstants beside `pi` and `e`, and those that were met.
    constants: &'a NamedConstants,
    used: Vec<(String, f64)>,
    token: Token,
    span: Range<usize>,
    previous: Token,
    previous_span: Range<usize>,
    depth: usize,
    graph: OperationGraph,
    variables: [bool; 4],
}

/// The grammar, one function per level of precedence:
///
/// ```text
/// comparison = sum [("<" | "<=" | ">" | ">=" | "==" | "!=") sum]
/// sum        = product {("+" | "-") product}
/// product    = signed {("*" | "/") signed}
/// signed     = ("-" | "+") signed | power
/// power      = atom ["^" signed]
/// atom       = number | variable | constant | function "(" arguments ")" | "(" comparison ")"
/// ```
impl<'a> Parser<'a> {
    fn comparison(&mut self) -> Result<NodeId, ExpressionError> {
        let left = self.sum()?;
        let Token::Compare(op) = self.token else {
            return Ok(left);
        };
        self.advance()?;
        let right = self.sum()?;
        if let Token::Compare(_) = self.token {
            // `a < b < c` would compare the result 0 or 1 of the first comparison with c.
            return Err(
                self.error("a single comparison", Some("write (a < b)*(b < c) where both must hold".to_owned()))
            );
        }
        Ok(self.graph.binary(op, left, right))
    }

    fn sum(&mut self) -> Result<NodeId, ExpressionError> {
        let mut left = self.product()?;
        loop {
            let op = match self.token {
                Token::Plus => Op::Add,
                Token::Minus => Op::Subtract,
                _ => return Ok(left),
            };
            self.advance()?;
            let right = self.product()?;
            left = self.graph.binary(op, left, right);
        }
    }

    fn product(&mut self) -> Result<NodeId, ExpressionError> {
        let mut left = self.signed()?;
        loop {
            let op = match self.token {
                Token::Times => Op::Multiply,
                Token::Over => Op::Divide,
                _ => return Ok(left),
            };
            self.advance()?;
            let right = self.signed()?;
            left = self.graph.binary(op, left, right);
        }
    }

    /// Every recursion passes through here, so the depth is limited here.
    fn signed(&mut self) -> Result<NodeId, ExpressionError> {
        if self.depth >= MAX_DEPTH {
            return Err(self.error(
                &format!("at most {MAX_DEPTH} levels of nesting"),
                Some("remove parentheses, signs or powers that are not needed".to_owned()),
            ));
        }
        self.depth += 1;
        let node = match self.token {
            Token::Minus => {
                self.advance()?;
                let operand = self.signed()?;
                self.graph.unary(Op::Negate, operand)
            }
            Token::Plus => {
                self.advance()?;
                self.signed()?
            }
            _ => self.power()?,
        };
        self.depth -= 1;
        Ok(node)
    }

    fn power(&mut self) -> Result<NodeId, ExpressionError> {
        let base = self.atom()?;
        if self.token != Token::Caret {
            return Ok(base);
        }
        self.advance()?;
        let exponent = self.signed()?;
        Ok(self.graph.binary(Op::Power, base, exponent))
    }

    fn atom(&mut self) -> Result<NodeId, ExpressionError> {
        match self.token {
            Token::Number(value) => {
                self.advance()?;
                Ok(self.graph.constant(value))
            }
            Token::Name => self.name(),
            Token::Open => {
                let open = self.span.start;
                self.advance()?;
                let inner = self.comparison()?;
                if self.token != Token::Close {
                    return Err(self.after_operand("an operator or `)`", Some(open)));
                }
                self.advance()?;
                Ok(inner)
            }
            _ => Err(self.error(OPERAND, None)),
        }
    }

    fn name(&mut self) -> Result<NodeId, ExpressionError> {
        let name = self.text();
        let named = self.names.iter().zip(VARIABLES).find(|(known, _)| **known == name);
        if let Some((_, variable)) = named {
            self.advance()?;
            self.variables[variable as usize] = true;
            return Ok(self.graph.variable(variable));
        }
        if let Some(&(_, value)) = CONSTANTS.iter().find(|entry| entry.0 == name) {
            self.advance()?;
            return Ok(self.graph.constant(value));
        }
        if let Some(value) = self.constants.get(name) {
            self.advance()?;
            self.used.push((name.to_owned(), value));
            return Ok(self.graph.constant(value));
        }
        if let Some(&(_, op, arity)) = FUNCTIONS.iter().find(|entry| entry.0 == name) {
            self.advance()?;
            return self.call(name, op, arity);
        }
        let known: Vec<&str> = self.names.iter().copied().chain(self.constants.names()).collect();
        let hint = suggestion(name, &known, self.names == PLACE);
        let variables = self.names.join(", ");
        let own: String = self.constants.names().map(|name| format!(", {name}")).collect();
        Err(self.error(&format!("a variable ({variables}), a constant (pi, e{own}) or a function"), hint))
    }

    fn call(&mut self, name: &str, op: Op, arity: Arity) -> Result<NodeId, ExpressionError> {
        let usage = || {
            Some(match arity {
                Arity::Exactly(1) => format!("{name} takes one argument: {name}(a)"),
                Arity::Exactly(2) => format!("{name} takes two arguments: {name}(a, b)"),
                Arity::Exactly(_) => format!("{name} takes three arguments: {name}(a, b, c)"),
                Arity::AtLeastTwo => format!("{name} takes two or more arguments: {name}(a, b)"),
            })
        };
        if self.token != Token::Open {
            return Err(self.error("`(`", usage()));
        }
        let open = self.span.start;
        self.advance()?;
        if self.token == Token::Close {
            return Err(self.error("an argument", usage()));
        }
        let mut arguments = vec![self.comparison()?];
        while self.token == Token::Comma {
            if let Arity::Exactly(count) = arity
                && arguments.len() == count
            {
                return Err(self.error("`)`", usage()));
            }
            self.advance()?;
            arguments.push(self.comparison()?);
        }
        if self.token != Token::Close {
            return Err(self.after_operand("an operator, `,` or `)`", Some(open)));
        }
        let node = match (arity, arguments.as_slice()) {
            (Arity::Exactly(1), &[a]) => self.graph.unary(op, a),
            (Arity::Exactly(2), &[a, b]) => self.graph.binary(op, a, b),
            (Arity::Exactly(3), &[a, b, c]) => self.graph.ternary(op, a, b, c),
            (Arity::AtLeastTwo, &[first, ref others @ ..]) if !others.is_empty() => {
                others.iter().fold(first, |result, &other| self.graph.binary(op, result, other))
            }
            _ => return Err(self.error("`,` and a further argument", usage())),
        };
        self.advance()?;
        Ok(node)
    }

    fn text(&self) -> &'a str {
        self.source.get(self.span.clone()).unwrap_or_default()
    }

    fn error(&self, expected: &str, hint: Option<String>) -> ExpressionError {
        let found = match self.token {
            Token::End => "the end of the expression".to_owned(),
            _ => format!("`{}`", quote(self.text())),
        };
        ExpressionError { offset: self.span.start, found, expected: expected.to_owned(), hint }
    }

    /// The error for a token that cannot follow an operand, inside the parenthesis opened at `open`, if any.
    fn after_operand(&self, expected: &str, open: Option<usize>) -> ExpressionError {
        let before = self.source.get(self.previous_span.clone()).unwrap_or_default();
        let hint = match (self.token, self.previous) {
            (Token::Number(_) | Token::Name | Token::Open, Token::Number(_) | Token::Name) => {
                Some(format!("write {}*{}", factors(before), factors(self.text())))
            }
            (Token::Number(_) | Token::Name | Token::Open, _) => Some("write * between two factors".to_owned()),
            (Token::Comma, Token::Number(_)) => Some("write decimals with a point, as in 2.5".to_owned()),
            (Token::Close, _) => Some("no parenthesis is open here".to_owned()),
            (Token::End, _) => open.map(|open| format!("the parenthesis opened at byte {open} is not closed")),
            _ => None,
        };
        self.error(expected, hint)
    }

    fn advance(&mut self) -> Result<(), ExpressionError> {
        self.previous = self.token;
        self.previous_span = self.span.clone();
        let rest = self.source.get(self.span.end..).unwrap_or_default();
        let trimmed = rest.trim_start();
        let start = self.source.len() - trimmed.len();
        let (token, length) = match token(trimmed) {
            Ok(found) => found,
            Err((found, expected, hint)) => {
                return Err(ExpressionError { offset: start, found, expected, hint });
            }
        };
        self.token = token;
        self.span = start..start + length;
        Ok(())
    }
}

/// The first token of `text`, which must not begin with a space, and its length in bytes; or the text found, the text
/// expected, and a hint.
fn token(text: &str) -> Result<(Token, usize), (String, String, Option<String>)> {
    let two = |second| text.as_bytes().get(1) == Some(&second);
    let foreign = || FOREIGN_SYMBOLS.iter().find(|entry| text.starts_with(entry.0));
    Ok(match text.chars().next() {
        None => (Token::End, 0),
        Some('+') => (Token::Plus, 1),
        Some('-') => (Token::Minus, 1),
        Some('*') if !two(b'*') => (Token::Times, 1),
        Some('/') => (Token::Over, 1),
        Some('^') => (Token::Caret, 1),
        Some('(') => (Token::Open, 1),
        Some(')') => (Token::Close, 1),
        Some(',') => (Token::Comma, 1),
        Some('<') if two(b'=') => (Token::Compare(Op::LessEqual), 2),
        Some('<') => (Token::Compare(Op::Less), 1),
        Some('>') if two(b'=') => (Token::Compare(Op::GreaterEqual), 2),
        Some('>') => (Token::Compare(Op::Greater), 1),
        Some('=') if two(b'=') => (Token::Compare(Op::Equal), 2),
        Some('!') if two(b'=') => (Token::Compare(Op::NotEqual), 2),
        Some('0'..='9' | '.') => return number(text),
        Some(first) if foreign().is_none() && (first.is_alphabetic() || first == '_') => {
            let end = text.find(|c: char| !c.is_alphabetic() && !c.is_ascii_digit() && c != '_');
            (Token::Name, end.unwrap_or(text.len()))
        }
        Some(first) => {
            let (found, hint) = match foreign() {
                Some((symbol, hint)) => ((*symbol).to_owned(), Some((*hint).to_owned())),
                None => (first.escape_debug().to_string(), None),
            };
            let expected = "an operator, a number, a name or a parenthesis".to_owned();
            return Err((format!("`{found}`"), expected, hint));
        }
    })
}

fn number(text: &str) -> Result<(Token, usize), (String, String, Option<String>)> {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        let rest = bytes.get(from..).unwrap_or_default();
        from + rest.iter().take_while(|byte| byte.is_ascii_digit()).count()
    };
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    let mantissa = text.get(..end).unwrap_or_default();
    // An `e` without digits is the constant, and then an operator is missing.
    if let Some(b'e' | b'E') = bytes.get(end) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = end + 1 + sign;
        if digits(exponent) > exponent {
            end = digits(exponent);
        }
    }
    let literal = text.get(..end).unwrap_or_default();
    let found = || format!("`{}`", quote(literal));
    let Ok(value) = literal.parse::<f64>() else {
        return Err((found(), "a number".to_owned(), None));
    };
    // A number that would become infinite or zero is refused.
    let vanished = value == 0.0 && mantissa.contains(|c: char| matches!(c, '1'..='9'));
    if value.is_infinite() || vanished {
        let expected = "a number of magnitude between 5e-324 and 1.8e308, or 0".to_owned();
        return Err((found(), expected, None));
    }
    Ok((Token::Number(value), end))
}

/// A piece of the source, shortened for a message and without control characters.
fn quote(text: &str) -> String {
    let mut quoted: String = text.chars().take(MAX_QUOTE).flat_map(char::escape_debug).collect();
    if text.chars().nth(MAX_QUOTE).is_some() {
        quoted.push_str("...");
    }
    quoted
}

/// `x*y` for `xy`, or `f(...)` for a function, as part of a hint.
fn factors(text: &str) -> String {
    if text == "(" {
        "(...)".to_owned()
    } else if FUNCTIONS.iter().any(|entry| entry.0 == text) {
        format!("{text}(...)")
    } else {
        product_of_variables(text).unwrap_or_else(|| quote(text))
    }
}

fn product_of_variables(name: &str) -> Option<String> {
    let variables = name.len() <= MAX_QUOTE && name.chars().all(|c| "xyzt".contains(c));
    variables.then(|| name.chars().map(String::from).collect::<Vec<_>>().join("*"))
}

/// The name that was probably meant by an unknown one.
fn suggestion(name: &str, names: &[&str], is_of_place: bool) -> Option<String> {
    let length = name.chars().count();
    if length > MAX_QUOTE {
        return None;
    }
    if let Some(product) = product_of_variables(name).filter(|_| is_of_place) {
        return Some(format!("write {product}"));
    }
    let lower = name.to_lowercase();
    let known = || {
        let functions = FUNCTIONS.iter().map(|entry| entry.0);
        let constants = CONSTANTS.iter().map(|entry| entry.0);
        functions.chain(constants).chain(names.iter().copied())
    };
    let foreign = FOREIGN_NAMES.iter().find(|entry| entry.0 == lower).map(|entry| entry.1);
    let close = || {
        // In a short name a single letter is already half of it.
        let most = if length <= 4 { 1 } else { 2 };
        known()
            .map(|candidate| (strsim::damerau_levenshtein(&lower, candidate), candidate))
            .filter(|&(distance, _)| distance <= most && distance < length)
            .min_by_key(|&(distance, _)| distance)
            .map(|(_, candidate)| candidate)
    };
    let meant = foreign.or_else(|| known().find(|&candidate| candidate == lower)).or_else(close)?;
    Some(format!("did you mean {meant}?"))
}
