//! Cells as numbers, and what the whole file says about its decimal sign.

use crate::CsvProblem;

/// Content of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    Value(f64),
    /// Nothing, or a word for it.
    Missing,
    Text,
}

/// The decimal sign of a file. `1,234` may be 1.234 or 1234: some other number of the file has to decide.
#[derive(Debug, Clone, Default)]
pub(super) struct Decimals {
    sign: Option<u8>,
    is_comma_taken: bool,
    /// True if some number shows that digits are not grouped in thousands.
    is_proven: bool,
    /// The first number that does not: line and column.
    doubtful: Option<(u64, usize, String)>,
}

impl Decimals {
    /// `delimiter` separates the cells; where that is a comma, points do not group thousands.
    pub(super) fn new(delimiter: u8) -> Self {
        Self { is_comma_taken: delimiter == b',', ..Self::default() }
    }

    /// The sign, if there was any.
    pub(super) fn sign(&self) -> Option<u8> {
        self.sign
    }

    /// A number outside the numeric columns was written with this sign.
    pub(super) fn seen(&mut self, sign: u8) {
        self.is_proven |= self.sign.is_none_or(|known| known == sign) && sign == b',';
    }

    /// Reads a cell; `line` and `column` are where it is.
    #[inline]
    pub(super) fn read(&mut self, cell: &str, line: u64, column: usize) -> Result<Number, CsvProblem> {
        if self.is_proven
            && self.sign == Some(b'.')
            && let Ok(value) = cell.parse::<f64>()
            && value.is_finite()
        {
            return Ok(Number::Value(value));
        }
        self.read_carefully(cell, line, column)
    }

    fn read_carefully(&mut self, cell: &str, line: u64, column: usize) -> Result<Number, CsvProblem> {
        let cell = cell.trim();
        if cell.is_empty() {
            return Ok(Number::Missing);
        }
        let count = |sign| cell.bytes().filter(|b| *b == sign).count();
        match (count(b','), count(b'.')) {
            (0, 0) => match cell.parse() {
                Ok(value) => held(value, cell),
                Err(_) => words_or_groups(cell),
            },
            (1, 0) => self.signed(cell, b',', line, column),
            (0, 1) => self.signed(cell, b'.', line, column),
            _ => words_or_groups(cell),
        }
    }

    /// A cell with one decimal sign.
    fn signed(&mut self, cell: &str, sign: u8, line: u64, column: usize) -> Result<Number, CsvProblem> {
        let Some(value) = parse_with(cell, sign) else { return words_or_groups(cell) };
        if self.sign.is_some_and(|known| known != sign) {
            return Err(CsvProblem::MixedDecimalSigns { text: cell.into() });
        }
        self.sign = Some(sign);
        let is_settled = self.is_proven || (self.is_comma_taken && sign == b'.');
        if !is_settled && is_grouped(cell, char::from(sign)) {
            self.doubtful.get_or_insert_with(|| (line, column, cell.to_owned()));
        } else {
            self.is_proven = true;
        }
        held(value, cell)
    }

    /// Takes notice of a cell that is not read.
    pub(super) fn observe(&mut self, cell: &str, line: u64, column: usize) -> Result<(), CsvProblem> {
        if self.may_decide(cell) {
            self.read_carefully(cell, line, column)?;
        }
        Ok(())
    }

    /// Tells whether a cell may decide about the sign, which no other has so far.
    pub(super) fn may_decide(&self, cell: &str) -> bool {
        let starts = |b: &u8| b.is_ascii_digit() || matches!(b, b'-' | b'+' | b'.' | b',');
        let is_settled = self.is_proven && self.sign.is_some();
        !is_settled && cell.as_bytes().first().is_some_and(starts)
    }

    /// The first number that has two readings, between which nothing in the file decides: line, column and text.
    pub(super) fn undecided(&self) -> Option<&(u64, usize, String)> {
        self.doubtful.as_ref().filter(|_| !self.is_proven)
    }
}

/// A number as it was parsed; digits that came out as infinite were too large for a double.
fn held(value: f64, cell: &str) -> Result<Number, CsvProblem> {
    match value.is_infinite() && cell.bytes().any(|b| b.is_ascii_digit()) {
        true => Err(CsvProblem::TooLarge { text: cell.into() }),
        false => Ok(Number::Value(value)),
    }
}

/// A number with this decimal sign.
fn parse_with(cell: &str, sign: u8) -> Option<f64> {
    if sign == b'.' {
        return cell.parse().ok();
    }
    let mut buffer = [0; 48];
    match buffer.get_mut(..cell.len()) {
        None => cell.replace(',', ".").parse().ok(),
        Some(buffer) => {
            buffer.copy_from_slice(cell.as_bytes());
            buffer.iter_mut().filter(|b| **b == b',').for_each(|b| *b = b'.');
            std::str::from_utf8(buffer).ok()?.parse().ok()
        }
    }
}

/// Returns true if digits are in groups of three with this sign between them, so that it may be no decimal sign:
/// `1,234`.
pub(super) fn is_grouped(cell: &str, sign: char) -> bool {
    let mut groups = cell.trim_start_matches(['-', '+']).split(sign);
    let digits = |group: &str| group.bytes().all(|b| b.is_ascii_digit());
    let first = groups.next().unwrap_or_default();
    let begins = (1..=3).contains(&first.len()) && digits(first) && !first.starts_with('0');
    let mut count = 0;
    let follow = groups.all(|group| {
        count += 1;
        group.len() == 3 && digits(group)
    });
    begins && follow && count > 0
}

/// A cell that is no plain number: a word for a missing or infinite one, grouped digits, or text.
fn words_or_groups(cell: &str) -> Result<Number, CsvProblem> {
    for sign in [',', '.', ' ', '\'', '’', '\u{a0}', '\u{202f}'] {
        let ends = [',', '.'].map(|end| cell.rsplit_once(end).map_or(cell, |(whole, _)| whole));
        if is_grouped(cell, sign) || ends.iter().any(|whole| is_grouped(whole, sign)) {
            return Err(CsvProblem::GroupedDigits { text: cell.into() });
        }
    }
    Ok(word(cell))
}

fn word(cell: &str) -> Number {
    if is_error_word(cell) {
        return Number::Missing;
    }
    match cell.to_lowercase().as_str() {
        "n/a" | "na" | "-" | "--" | "---" | "null" | "none" | "nil" | "-nan" | "nan(ind)" | "-nan(ind)" | "<na>"
        | "k.a." => Number::Missing,
        "true" | "wahr" => Number::Value(1.0),
        "false" | "falsch" => Number::Value(0.0),
        "1.#inf" | "+1.#inf" | "∞" | "+∞" => Number::Value(f64::INFINITY),
        "-1.#inf" | "-∞" => Number::Value(f64::NEG_INFINITY),
        lower if ["1.#qnan", "1.#ind", "1.#snan"].iter().any(|w| lower.trim_start_matches('-').starts_with(w)) => {
            Number::Missing
        }
        _ => Number::Text,
    }
}

/// The errors of spreadsheets, English and German.
pub(super) fn is_error_word(cell: &str) -> bool {
    let words = ["#N/A", "#NV", "#VALUE!", "#WERT!", "#DIV/0!", "#NUM!", "#ZAHL!", "#REF!", "#BEZUG!", "#NAME?"];
    words.iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// Returns true if a cell is a number with either decimal sign.
pub(super) fn is_number(cell: &str) -> bool {
    matches!(Decimals::default().read(cell, 0, 0), Ok(Number::Value(_)) | Err(_))
}
