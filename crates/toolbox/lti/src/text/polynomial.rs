//! Polynomials and their ratios as text.

use super::number::{digits_of_both, number};

/// Columns of a line before it is broken.
const WIDTH: usize = 96;

/// A polynomial to be written: coefficients with the power of the variable that each belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial<'a> {
    variable: &'a str,
    terms: Vec<Term>,
}

#[derive(Debug, Clone, PartialEq)]
struct Term {
    power: i32,
    value: f64,
    /// `None` for a number that is no parameter.
    error: Option<f64>,
}

impl<'a> Polynomial<'a> {
    /// A polynomial of no term yet in this variable.
    #[must_use]
    pub fn new(variable: &'a str) -> Self {
        Polynomial { variable, terms: Vec::new() }
    }

    /// With one more term that is no parameter, such as a leading one.
    #[must_use]
    pub fn with_constant(mut self, power: i32, value: f64) -> Self {
        self.terms.push(Term { power, value, error: None });
        self
    }

    /// With coefficients whose powers start at `first` and change by `step`, and their standard errors where known.
    #[must_use]
    pub fn with_coefficients(mut self, first: i32, step: i32, values: &[f64], errors: Option<&[f64]>) -> Self {
        let powers = (0..).map(|k| first + step * k);
        let error = |k: usize| errors.and_then(|errors| errors.get(k).copied());
        self.terms.extend(powers.zip(values).enumerate().map(|(k, (power, value))| Term {
            power,
            value: *value,
            error: error(k),
        }));
        self
    }

    /// The terms, each with its sign: `1`, `− 1.4994 (± 0.0031) q⁻¹`. Terms that are exactly zero are left out.
    fn parts(&self) -> Vec<(bool, String)> {
        let there = self.terms.iter().filter(|term| term.value != 0.0 || term.error.is_some());
        let parts: Vec<_> = there.map(|term| (term.value.is_sign_negative(), self.term(term))).collect();
        if parts.is_empty() { vec![(false, "0".to_owned())] } else { parts }
    }

    fn term(&self, term: &Term) -> String {
        let size = term.value.abs();
        let coefficient = match term.error.map(|error| digits_of_both(size, error)) {
            None => number(size),
            Some((value, None)) => value,
            Some((value, Some(error))) => format!("{value} (± {error})"),
        };
        match term.power {
            0 => coefficient,
            power if size == 1.0 && term.error.is_none() => self.variable.to_owned() + &superscript(power),
            power => format!("{coefficient} {}{}", self.variable, superscript(power)),
        }
    }

    /// On one line.
    #[must_use]
    pub fn on_one_line(&self) -> String {
        self.lines("", usize::MAX).concat()
    }

    /// `head = …`, broken into lines that are indented as far as the head is long.
    #[must_use]
    pub fn equation(&self, head: &str) -> String {
        let indent = " ".repeat(head.chars().count() + 3);
        self.lines(&format!("{head} = "), WIDTH).join(&format!("\n{indent}"))
    }

    fn lines(&self, head: &str, width: usize) -> Vec<String> {
        let mut lines = vec![head.to_owned()];
        let room = width.saturating_sub(head.chars().count());
        let mut used = 0;
        for (index, (negative, term)) in self.parts().into_iter().enumerate() {
            let sign = match (index, negative) {
                (0, false) => "",
                (0, true) => "−",
                (_, false) => "+ ",
                (_, true) => "− ",
            };
            let length = sign.chars().count() + term.chars().count() + 1;
            if index > 0 && used + length > room {
                lines.push(String::new());
                used = 0;
            }
            let Some(line) = lines.last_mut() else { continue };
            if used > 0 {
                line.push(' ');
            }
            line.push_str(sign);
            line.push_str(&term);
            used += length;
        }
        lines
    }
}

/// A power as it is written behind its variable; nothing for the first.
fn superscript(power: i32) -> String {
    if power == 1 {
        return String::new();
    }
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    };
    power.to_string().chars().map(raised).collect()
}

/// A ratio of polynomials, and what follows it, such as a delay.
#[derive(Debug, Clone, PartialEq)]
pub struct Fraction {
    /// The numerator, on one line.
    pub numerator: String,
    /// The denominator, on one line.
    pub denominator: String,
    /// Factor on the ratio; empty for none.
    pub factor: String,
}

impl Fraction {
    /// `head = numerator over denominator`, on three lines.
    #[must_use]
    pub fn equation(&self, head: &str) -> String {
        let width = |text: &str| text.chars().count();
        let rule = width(&self.numerator).max(width(&self.denominator));
        let indent = |text: &str| " ".repeat(width(head) + 3 + (rule - width(text)) / 2);
        let (above, below) = (indent(&self.numerator), indent(&self.denominator));
        let factor = if self.factor.is_empty() { String::new() } else { format!(" {}", self.factor) };
        let middle = format!("{head} = {}{factor}", "─".repeat(rule));
        format!("{above}{}\n{middle}\n{below}{}", self.numerator, self.denominator)
    }
}
