//! [`Formula`]: arithmetic on named parameters.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::IdentError;

/// Deepest nesting of parentheses, minus signs and powers.
const DEPTH: usize = 48;
/// Most operands that wait for their operator.
const STACK: usize = 64;

/// Characters of a formula that a message shows, at most.
const SHOWN: usize = 80;
/// Names that mean something else than a parameter.
const RESERVED: [&str; 3] = ["pi", "sqrt", "exp"];

/// A formula of numbers, named parameters, `pi`, `+ − * / ^`, parentheses, `sqrt(…)` and `exp(…)`.
///
/// As on paper, `^` binds closest and from the right, then the minus sign, then `*` and `/`, then `+` and `-`, from the
/// left: `-a^2` is `−(a²)` and `a^b^c` is `a^(b^c)`. Names consist of letters, digits and `_` and begin with no digit.
/// Written down it is its text; a number is read as a formula too.
///
/// # Example
/// ```
/// let formula: ident::Formula = "-(B + d) / J".parse()?;
/// assert_eq!(formula.names(), ["B", "d", "J"]);
/// let values = [3.0, 1.0, 2.0];
/// assert_eq!(formula.evaluate(|index| values[index]), -2.0);
/// # Ok::<(), ident::IdentError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "String"))]
#[serde(try_from = "Written", into = "String")]
pub struct Formula {
    text: String,
    names: Vec<String>,
    steps: Vec<Step>,
}

/// A step of the evaluation, in the order of a stack: operands first, then what is done to them.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Step {
    Number(f64),
    Name(usize),
    One(One),
    Two(Two),
}

/// Operation on one operand.
#[derive(Debug, Clone, Copy, PartialEq)]
enum One {
    Negate,
    Root,
    Exponential,
}

/// Operation on two operands.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Two {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl Formula {
    /// The parameters in it, each once, in the order they appear.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The value, where `value(i)` is that of `names()[i]`. It is not finite where the arithmetic has no result, as in
    /// `1 / 0`. Nothing is allocated.
    #[must_use]
    pub fn evaluate(&self, value: impl Fn(usize) -> f64) -> f64 {
        let mut stack = [0.0_f64; STACK];
        let mut height = 0;
        for step in &self.steps {
            match step {
                Step::Number(number) => stack[height] = *number,
                Step::Name(index) => stack[height] = value(*index),
                Step::One(what) => stack[height - 1] = what.of(stack[height - 1]),
                Step::Two(what) => stack[height - 2] = what.of(stack[height - 2], stack[height - 1]),
            }
            height = step.height_after(height);
        }
        stack[0]
    }

    /// Returns true if a parameter may have this name.
    pub(super) fn is_name(text: &str) -> bool {
        text.chars().next().is_some_and(begins_name) && text.chars().all(in_name) && !RESERVED.contains(&text)
    }
}

impl Step {
    /// Operands on the stack after this step.
    fn height_after(self, before: usize) -> usize {
        match self {
            Step::Number(_) | Step::Name(_) => before + 1,
            Step::One(_) => before,
            Step::Two(_) => before - 1,
        }
    }
}

impl One {
    fn of(self, x: f64) -> f64 {
        match self {
            One::Negate => -x,
            One::Root => x.sqrt(),
            One::Exponential => x.exp(),
        }
    }
}

impl Two {
    fn of(self, left: f64, right: f64) -> f64 {
        match self {
            Two::Add => left + right,
            Two::Subtract => left - right,
            Two::Multiply => left * right,
            Two::Divide => left / right,
            Two::Power => left.powf(right),
        }
    }
}

impl FromStr for Formula {
    type Err = IdentError;

    /// Reads a formula.
    ///
    /// # Errors
    /// [`IdentError::Formula`] where it is none, or nested too deeply.
    fn from_str(text: &str) -> Result<Self, IdentError> {
        let mut parser = Parser { text, at: 0, depth: 0, height: 0, names: Vec::new(), steps: Vec::new() };
        parser.sum()?;
        if parser.next().is_some() {
            return parser.expected("an operator or the end");
        }
        Ok(Formula { text: text.to_owned(), names: parser.names, steps: parser.steps })
    }
}

impl fmt::Display for Formula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// How a formula is written down.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a number, or a formula in quotes")]
enum Written {
    Number(f64),
    Text(String),
}

impl TryFrom<Written> for Formula {
    type Error = IdentError;

    fn try_from(written: Written) -> Result<Self, IdentError> {
        match written {
            Written::Text(text) => text.parse(),
            Written::Number(number) => number.try_into(),
        }
    }
}

impl TryFrom<f64> for Formula {
    type Error = IdentError;

    /// The formula that is this number.
    fn try_from(number: f64) -> Result<Self, IdentError> {
        if !number.is_finite() {
            return Err(IdentError::NotFinite { what: "a formula", index: 0 });
        }
        number.to_string().parse()
    }
}

impl From<Formula> for String {
    fn from(formula: Formula) -> Self {
        formula.text
    }
}

fn begins_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

fn in_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Reads by recursive descent: a sum of terms of signed powers of atoms.
struct Parser<'a> {
    text: &'a str,
    /// Bytes read.
    at: usize,
    depth: usize,
    height: usize,
    names: Vec<String>,
    steps: Vec<Step>,
}

impl Parser<'_> {
    /// The next character that is no space; it is not taken.
    fn next(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        let ahead = rest.trim_start();
        self.at += rest.len() - ahead.len();
        ahead.chars().next()
    }

    /// Takes the next character if it is this one.
    fn takes(&mut self, wanted: char) -> bool {
        let found = self.next() == Some(wanted);
        self.at += if found { wanted.len_utf8() } else { 0 };
        found
    }

    fn expected<T>(&self, expected: &'static str) -> Result<T, IdentError> {
        let position = self.text[..self.at].chars().count() + 1;
        Err(IdentError::Formula { formula: shown(self.text, position), position, expected })
    }

    fn then(&mut self, step: Step) -> Result<(), IdentError> {
        self.height = step.height_after(self.height);
        if self.height > STACK {
            return self.expected("a formula nested less deeply");
        }
        self.steps.push(step);
        Ok(())
    }

    fn sum(&mut self) -> Result<(), IdentError> {
        self.term()?;
        loop {
            let what = match self.next() {
                Some('+') => Two::Add,
                Some('-') => Two::Subtract,
                _ => return Ok(()),
            };
            self.at += 1;
            self.term()?;
            self.then(Step::Two(what))?;
        }
    }

    fn term(&mut self) -> Result<(), IdentError> {
        self.signed()?;
        loop {
            let what = match self.next() {
                Some('*') => Two::Multiply,
                Some('/') => Two::Divide,
                _ => return Ok(()),
            };
            self.at += 1;
            self.signed()?;
            self.then(Step::Two(what))?;
        }
    }

    /// Every recursion comes through here.
    fn signed(&mut self) -> Result<(), IdentError> {
        if self.depth == DEPTH {
            return self.expected("a formula nested less deeply");
        }
        self.depth += 1;
        if self.takes('-') {
            self.signed()?;
            self.then(Step::One(One::Negate))?;
        } else {
            self.atom()?;
            if self.takes('^') {
                self.signed()?;
                self.then(Step::Two(Two::Power))?;
            }
        }
        self.depth -= 1;
        Ok(())
    }

    fn atom(&mut self) -> Result<(), IdentError> {
        match self.next() {
            Some('(') => self.parentheses(),
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if begins_name(c) => self.name(),
            _ => self.expected("a number, a name, \"(\" or \"-\""),
        }
    }

    fn parentheses(&mut self) -> Result<(), IdentError> {
        if !self.takes('(') {
            return self.expected("\"(\"");
        }
        self.sum()?;
        if self.takes(')') { Ok(()) } else { self.expected("an operator or \")\"") }
    }

    fn number(&mut self) -> Result<(), IdentError> {
        let rest = &self.text[self.at..];
        let digits = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
        let mut length = digits(rest);
        if rest[length..].starts_with('.') {
            length += 1 + digits(&rest[length + 1..]);
        }
        if let Some(exponent) = rest[length..].strip_prefix(['e', 'E']) {
            let sign = usize::from(exponent.starts_with(['+', '-']));
            let count = digits(&exponent[sign..]);
            length += if count > 0 { 1 + sign + count } else { 0 };
        }
        match rest[..length].parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.at += length;
                self.then(Step::Number(number))
            }
            _ => self.expected("a finite number"),
        }
    }

    fn name(&mut self) -> Result<(), IdentError> {
        let rest = &self.text[self.at..];
        let name = &rest[..rest.find(|c| !in_name(c)).unwrap_or(rest.len())];
        let function = match name {
            "sqrt" => Some(One::Root),
            "exp" => Some(One::Exponential),
            _ if rest[name.len()..].trim_start().starts_with('(') => {
                return self.expected("sqrt or exp, which are the functions there are");
            }
            _ => None,
        };
        self.at += name.len();
        match function {
            Some(what) => {
                self.parentheses()?;
                self.then(Step::One(what))
            }
            None if name == "pi" => self.then(Step::Number(std::f64::consts::PI)),
            None => {
                let known = self.names.iter().position(|n| n == name);
                let index = known.unwrap_or(self.names.len());
                if known.is_none() {
                    self.names.push(name.to_owned());
                }
                self.then(Step::Name(index))
            }
        }
    }
}

/// A formula, or of a long one what stands around a character.
fn shown(text: &str, position: usize) -> String {
    let characters: Vec<char> = text.chars().collect();
    if characters.len() <= SHOWN {
        return text.to_owned();
    }
    let first = position.saturating_sub(SHOWN / 2).min(characters.len() - SHOWN);
    let last = first + SHOWN;
    let (before, after) = (if first > 0 { "…" } else { "" }, if last < characters.len() { "…" } else { "" });
    format!("{before}{}{after}", characters[first..last].iter().collect::<String>())
}
