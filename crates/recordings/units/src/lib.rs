#![doc = include_str!("../README.md")]
//!
//! Unit strings as benches write them, and the one place where numbers become SI.
//!
//! Spelling is read leniently: letter case, spaces, multiplication signs and brackets do not matter, so `N·m`, `N*m`,
//! `N.m` and `[Nm]` are one unit. What cannot be determined for sure is an error: `Hz` on a speed may mean revolutions
//! or radians a second, and an empty unit may mean anything.

mod quantity;
mod table;
mod unit;

use recording::names::closest;

pub use quantity::Quantity;
use table::{AMBIGUOUS, TABLE};
pub use unit::{RPM_RAD_S, Unit};

/// A text is not a unit, or not a number with one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// No unit is given.
    #[error("no unit is given")]
    Empty,
    /// The unit is not known.
    #[error("the unit `{text}` is unknown; the closest known ones are {}", .closest.join(", "))]
    Unknown {
        /// The text.
        text: String,
        /// Known units spelt similarly, closest first.
        closest: Vec<String>,
    },
    /// The unit has several meanings.
    #[error("the unit `{text}` has several meanings; write {}", .instead.join(" or "))]
    Ambiguous {
        /// The text.
        text: String,
        /// Units to write instead.
        instead: Vec<&'static str>,
    },
    /// The unit measures something else.
    #[error("`{text}` is a unit of {found}, where one of {expected} is needed, such as {example}")]
    OtherQuantity {
        /// The text.
        text: String,
        /// Quantity that it measures.
        found: Quantity,
        /// Quantity that is needed.
        expected: Quantity,
        /// A unit that would do.
        example: &'static str,
    },
    /// A number with a decimal comma.
    #[error("`{text}` has a decimal comma; write a point, `{instead}`")]
    DecimalComma {
        /// The text.
        text: String,
        /// The same with a point.
        instead: String,
    },
    /// A number with a unit does not begin with a number.
    #[error("`{text}` is not a number with a unit, such as `0.6 kg m²`")]
    NotANumber {
        /// The text.
        text: String,
    },
}

/// Finds the unit a text means.
///
/// # Errors
///
/// [`UnitError`] if the text is empty, unknown or has several meanings.
///
/// # Example
///
/// ```
/// let unit = units::parse_unit("1/min")?;
/// assert_eq!(unit.to_si(60.0), std::f64::consts::TAU);
/// # Ok::<(), units::UnitError>(())
/// ```
pub fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let wanted = normalised(text);
    if wanted.is_empty() {
        return Err(UnitError::Empty);
    }
    if let Some((_, instead)) = AMBIGUOUS.iter().find(|(name, _)| *name == wanted) {
        return Err(UnitError::Ambiguous { text: text.trim().to_owned(), instead: instead.to_vec() });
    }
    match TABLE.iter().find(|row| row.spellings().any(|spelling| normalised(spelling) == wanted)) {
        Some(row) => Ok(row.unit),
        None => Err(UnitError::Unknown { text: text.trim().to_owned(), closest: closest_units(&wanted, |_| true) }),
    }
}

/// Returns true if two texts may mean the same unit: they are spelt alike, one of them is empty, or both are known and
/// equal.
pub fn may_be_same(one: &str, other: &str) -> bool {
    let (spelt, also) = (normalised(one), normalised(other));
    let equal = |a: Unit, b: Unit| (a.quantity, a.factor, a.offset) == (b.quantity, b.factor, b.offset);
    spelt.is_empty()
        || also.is_empty()
        || spelt == also
        || matches!((parse_unit(one), parse_unit(other)), (Ok(a), Ok(b)) if equal(a, b))
}

/// Finds the unit a text means, if it measures `quantity`.
///
/// # Errors
///
/// [`UnitError`] as [`parse_unit`], and if the unit measures something else. For an unknown unit it names those of
/// `quantity`.
pub fn parse_unit_of(text: &str, quantity: Quantity) -> Result<Unit, UnitError> {
    let of_quantity = |text: String| {
        let closest = closest_units(&normalised(&text), |unit| unit.quantity == quantity);
        UnitError::Unknown { text, closest }
    };
    let unit = parse_unit(text).map_err(|error| match error {
        UnitError::Unknown { text, .. } => of_quantity(text),
        other => other,
    })?;
    if unit.quantity == quantity {
        return Ok(unit);
    }
    Err(UnitError::OtherQuantity {
        text: text.trim().to_owned(),
        found: unit.quantity,
        expected: quantity,
        example: si_spelling(quantity),
    })
}

/// Reads a number with a unit, such as `0.6 kg m²` or `6000 rpm`, in SI.
///
/// # Errors
///
/// [`UnitError`] if there is no number, no unit, or a unit of something else.
pub fn parse_value(text: &str, quantity: Quantity) -> Result<f64, UnitError> {
    let (number, unit) = number_and_unit(text.trim())?;
    Ok(parse_unit_of(unit, quantity)?.to_si(number))
}

/// Reads a frequency, such as `18 Hz`, in Hz. Only where nothing but cycles a second can be meant: of a speed `Hz` has
/// two meanings.
///
/// # Errors
///
/// [`UnitError`] if there is no number, or no `Hz` behind it.
pub fn parse_frequency_hz(text: &str) -> Result<f64, UnitError> {
    let (number, unit) = number_and_unit(text.trim())?;
    match normalised(unit).as_str() {
        "hz" => Ok(number),
        "" => Err(UnitError::Empty),
        _ => Err(UnitError::Unknown { text: unit.trim().to_owned(), closest: vec!["Hz".to_owned()] }),
    }
}

/// The number that a text begins with, and what is behind it.
fn number_and_unit(text: &str) -> Result<(f64, &str), UnitError> {
    let (digits, unit) = text.split_at(number_length(text));
    let number = digits.parse::<f64>().ok().filter(|value| value.is_finite());
    let number = number.ok_or_else(|| UnitError::NotANumber { text: text.to_owned() })?;
    match unit.strip_prefix(',') {
        Some(decimals) if decimals.starts_with(|c: char| c.is_ascii_digit()) => {
            Err(UnitError::DecimalComma { text: text.to_owned(), instead: format!("{digits}.{decimals}") })
        }
        _ => Ok((number, unit)),
    }
}

/// The usual spelling of a quantity's SI unit.
pub fn si_spelling(quantity: Quantity) -> &'static str {
    let is_si = |unit: &&Unit| unit.factor == 1.0 && unit.offset == 0.0;
    units(quantity).find(is_si).map_or("", |unit| unit.spelling)
}

/// The usual spellings of every known unit of a quantity.
pub fn spellings(quantity: Quantity) -> impl Iterator<Item = &'static str> {
    units(quantity).map(|unit| unit.spelling)
}

fn units(quantity: Quantity) -> impl Iterator<Item = &'static Unit> {
    TABLE.iter().map(|row| &row.unit).filter(move |unit| unit.quantity == quantity)
}

/// Length of the longest beginning of `text` that is a number.
fn number_length(text: &str) -> usize {
    let ends = text.char_indices().map(|(at, c)| at + c.len_utf8());
    ends.take_while(|&end| end <= 32).filter(|&end| is_plain_number(&text[..end])).last().unwrap_or(0)
}

/// Returns true if a text is a decimal number: `inf` and `nan`, which Rust also reads, are not.
fn is_plain_number(text: &str) -> bool {
    text.chars().all(|c| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E')) && text.parse::<f64>().is_ok()
}

/// A unit without what does not matter: case, spaces, multiplication signs and brackets.
fn normalised(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.trim().chars().flat_map(char::to_lowercase) {
        match c {
            '²' => plain.push('2'),
            '⁻' | '−' | '–' => plain.push('-'),
            '¹' => plain.push('1'),
            'º' | '˚' => plain.push('°'),
            c if c.is_whitespace() => {}
            '.' | '·' | '⋅' | '∙' | '•' | '×' | '*' | '^' | '_' | '[' | ']' | '(' | ')' => {}
            c => plain.push(c),
        }
    }
    plain
}

fn closest_units(wanted: &str, is_possible: impl Fn(&Unit) -> bool) -> Vec<String> {
    let possible = TABLE.iter().filter(|row| is_possible(&row.unit));
    let all: Vec<String> = possible.flat_map(|row| row.spellings()).map(normalised).collect();
    let mut spellings: Vec<String> = Vec::new();
    for near in closest(wanted, all.iter().map(String::as_str), 6) {
        if let Ok(unit) = parse_unit(&near)
            && !spellings.iter().any(|known| known == unit.spelling)
        {
            spellings.push(unit.spelling.to_owned());
        }
    }
    spellings.truncate(3);
    spellings
}
