//! From raw samples to physical ones.

mod formula;
mod table;

use std::sync::Arc;

pub(crate) use formula::Formula;
pub(crate) use table::{NumberTable, RangeTable, closest, interpolated};

/// How raw samples become physical ones.
#[derive(Debug, Clone)]
pub(crate) enum Conversion {
    Identity,
    /// `a + b x`.
    Linear {
        a: f64,
        b: f64,
    },
    /// `(p0 x² + p1 x + p2) / (p3 x² + p4 x + p5)`.
    Rational([f64; 6]),
    /// `(p1 - p3 (x - p4 - p5)) / (p2 (x - p4 - p5) - p0)`, the "polynomial" of MDF 3 with its P1 at 0.
    Polynomial([f64; 6]),
    /// The exponential function of MDF 3, and its logarithm where `log`.
    Exponential {
        p: [f64; 7],
        log: bool,
    },
    Formula(Formula),
    Interpolated(NumberTable),
    Closest(NumberTable),
    Ranges(RangeTable<f64>, f64),
    /// A conversion for each range, and one for what is in none; all of them yield numbers.
    Pieces(RangeTable<Arc<Conversion>>, Arc<Conversion>),
    /// Numbers to text or to other numbers; ranges may be points.
    Texts(RangeTable<Outcome>, Outcome),
    TextToNumber {
        pairs: Vec<(Arc<str>, f64)>,
        otherwise: f64,
    },
    TextToText {
        pairs: Vec<(Arc<str>, Arc<str>)>,
        otherwise: Option<Arc<str>>,
    },
    /// Bits to text: mask, and what the masked value becomes.
    Bits(Vec<(u64, Part)>),
}

/// Result of a table for a number.
#[derive(Debug, Clone)]
pub(crate) enum Outcome {
    Text(Arc<str>),
    /// A number again, which is written as text.
    Number(Arc<Conversion>),
    /// Nothing: no text.
    None,
}

/// A part of a text made of bits.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    /// Put before the text as `name = text`.
    pub name: Arc<str>,
    pub conversion: Arc<Conversion>,
}

/// Kind of the output of a conversion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Yields {
    Numbers,
    Text,
}

impl Conversion {
    /// Kind of the output for numbers.
    pub(crate) fn of_numbers(&self) -> Yields {
        match self {
            Self::Texts(..) | Self::Bits(_) => Yields::Text,
            _ => Yields::Numbers,
        }
    }

    /// Kind of the output for texts.
    pub(crate) fn of_text(&self) -> Yields {
        match self {
            Self::TextToNumber { .. } => Yields::Numbers,
            _ => Yields::Text,
        }
    }

    /// Converts numbers in place; conversions that yield text leave them.
    pub(crate) fn numbers(&self, x: &mut [f64]) {
        match self {
            Self::Linear { a, b } => x.iter_mut().for_each(|x| *x = *b * *x + *a),
            Self::Rational(p) => x.iter_mut().for_each(|x| *x = rational(p, *x)),
            Self::Polynomial(p) => x.iter_mut().for_each(|x| *x = polynomial(p, *x)),
            Self::Exponential { p, log } => x.iter_mut().for_each(|x| *x = exponential(p, *log, *x)),
            Self::Formula(formula) => formula.apply(x),
            Self::Interpolated(table) => x.iter_mut().for_each(|x| *x = interpolated(table, *x)),
            Self::Closest(table) => x.iter_mut().for_each(|x| *x = closest(table, *x)),
            Self::Ranges(table, otherwise) => {
                x.iter_mut().for_each(|x| *x = table.find(*x).copied().unwrap_or(*otherwise));
            }
            Self::Pieces(table, otherwise) => {
                x.iter_mut().for_each(|x| table.find(*x).unwrap_or(otherwise).numbers(std::slice::from_mut(x)));
            }
            Self::Identity | Self::Texts(..) | Self::TextToNumber { .. } | Self::TextToText { .. } | Self::Bits(_) => {}
        }
    }

    /// The text that a number becomes.
    pub(crate) fn text_of_number(&self, x: f64) -> String {
        match self {
            Self::Texts(table, otherwise) => match table.find(x).unwrap_or(otherwise) {
                Outcome::Text(text) => text.to_string(),
                Outcome::Number(conversion) => conversion.text_of_number(x),
                Outcome::None => String::new(),
            },
            Self::Bits(parts) => bits_text(parts, x),
            _ => {
                let mut one = [x];
                self.numbers(&mut one);
                one[0].to_string()
            }
        }
    }

    /// The number that a text becomes.
    pub(crate) fn number_of_text(&self, text: &str) -> f64 {
        match self {
            Self::TextToNumber { pairs, otherwise } => {
                pairs.iter().find(|(key, _)| **key == *text).map_or(*otherwise, |(_, number)| *number)
            }
            _ => f64::NAN,
        }
    }

    /// The text that a text becomes.
    pub(crate) fn text_of_text(&self, text: String) -> String {
        match self {
            Self::TextToText { pairs, otherwise } => match pairs.iter().find(|(key, _)| **key == *text) {
                Some((_, value)) => value.to_string(),
                None => otherwise.as_ref().map_or(text, |o| o.to_string()),
            },
            _ => text,
        }
    }
}

fn bits_text(parts: &[(u64, Part)], x: f64) -> String {
    let raw = if x < 0.0 { (x as i64).cast_unsigned() } else { x as u64 };
    let one = |(mask, part): &(u64, Part)| {
        let text = part.conversion.text_of_number((raw & mask) as f64);
        match part.name.is_empty() || text.is_empty() {
            true => text,
            false => format!("{} = {text}", part.name),
        }
    };
    let texts: Vec<String> = parts.iter().map(one).filter(|t| !t.is_empty()).collect();
    texts.join("|")
}

fn rational(p: &[f64; 6], x: f64) -> f64 {
    (p[0] * x * x + p[1] * x + p[2]) / (p[3] * x * x + p[4] * x + p[5])
}

fn polynomial(p: &[f64; 6], x: f64) -> f64 {
    let shifted = x - p[4] - p[5];
    (p[1] - p[3] * shifted) / (p[2] * shifted - p[0])
}

/// `ln(((x - p6) p5 - p2) / p0) / p1` where p3 is 0, or `ln((p2 / (x - p6) - p5) / p3) / p4` where p0 is 0; with exp in
/// place of ln for the logarithmic conversion.
fn exponential(p: &[f64; 7], log: bool, x: f64) -> f64 {
    let (argument, divisor) = match p[3] == 0.0 {
        true => (((x - p[6]) * p[5] - p[2]) / p[0], p[1]),
        false => ((p[2] / (x - p[6]) - p[5]) / p[3], p[4]),
    };
    if log { argument.exp() / divisor } else { argument.ln() / divisor }
}
