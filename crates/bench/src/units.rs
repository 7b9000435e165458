//! Unit strings as benches write them, and the one place where numbers become SI.
//!
//! Spelling is read leniently: letter case, spaces, multiplication signs and brackets do not matter, so `N·m`, `N*m`,
//! `N.m` and `[Nm]` are one unit. What cannot be told for sure is an error: `Hz` on a speed may mean revolutions or
//! radians a second, and an empty unit may mean anything.

use std::f64::consts::{PI, TAU};

use crate::role::Quantity;
use recording::names::closest;

/// One revolution a minute in rad/s, 2π/60.
pub const RPM_RAD_S: f64 = TAU / 60.0;
/// One degree in rad.
const DEGREE_RAD: f64 = PI / 180.0;
/// One pound-force foot in Nm: 0.453 592 37 kg · 9.806 65 m/s² · 0.3048 m.
const POUND_FORCE_FOOT_NM: f64 = 1.355_817_948_331_400_4;
/// One pound foot squared in kg m²: 0.453 592 37 kg · (0.3048 m)².
const POUND_FOOT_SQUARED_KG_M2: f64 = 0.453_592_37 * 0.3048 * 0.3048;
/// One kilogram-force metre in Nm.
const KILOPOND_METRE_NM: f64 = 9.806_65;

/// A unit of a known quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// What it measures.
    pub quantity: Quantity,
    /// SI value of one of it: value in SI = factor · value in the unit.
    pub factor: f64,
    /// Its usual spelling, e.g. `kg m²`.
    pub spelling: &'static str,
}

impl Unit {
    /// A value in this unit, converted to SI.
    pub fn to_si(self, value: f64) -> f64 {
        value * self.factor
    }

    /// An SI value, converted to this unit.
    pub fn from_si(self, value: f64) -> f64 {
        value / self.factor
    }
}

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
        /// What to write instead.
        instead: Vec<&'static str>,
    },
    /// The unit measures something else.
    #[error("`{text}` is a unit of {found}, where one of {expected} is needed, such as {example}")]
    OtherQuantity {
        /// The text.
        text: String,
        /// What it measures.
        found: Quantity,
        /// What is needed.
        expected: Quantity,
        /// A unit that would do.
        example: &'static str,
    },
    /// A number with a unit does not begin with a number.
    #[error("`{text}` is not a number with a unit, such as `0.6 kg m²`")]
    NotANumber {
        /// The text.
        text: String,
    },
}

use Quantity::{AngularSpeed, Damping, Inertia, Ratio, Stiffness, Torque};

/// Usual spelling, quantity, SI factor, and every other spelling after [`normalised`].
type Row = (&'static str, Quantity, f64, &'static [&'static str]);

const TABLE: &[Row] = &[
    ("rad/s", AngularSpeed, 1.0, &["rad/sec", "rads-1", "radian/s", "radians/s", "radps"]),
    (
        "rpm",
        AngularSpeed,
        RPM_RAD_S,
        &[
            "1/min", "/min", "u/min", "r/min", "rev/min", "rot/min", "tr/min", "umdr/min", "min-1", "1min-1", "umin-1",
            "rmin-1", "revmin-1", "upm", "revs/min", "1/minute",
        ],
    ),
    ("krpm", AngularSpeed, 1000.0 * RPM_RAD_S, &["1000rpm", "1000/min", "x1000rpm"]),
    ("rev/s", AngularSpeed, TAU, &["rps", "u/s", "r/s", "tr/s", "revs-1", "us-1", "revs/s"]),
    ("deg/s", AngularSpeed, DEGREE_RAD, &["°/s", "grad/s", "degs-1", "°s-1", "degree/s", "degrees/s"]),
    ("Nm", Torque, 1.0, &["n-m", "newtonmeter", "newtonmetre", "newton-meter", "newton-metre", "newtonmeters"]),
    ("kNm", Torque, 1e3, &["kn-m"]),
    ("mNm", Torque, 1e-3, &["mn-m"]),
    ("Ncm", Torque, 1e-2, &["n-cm"]),
    (
        "lbf ft",
        Torque,
        POUND_FORCE_FOOT_NM,
        &["lbft", "ftlb", "ftlbf", "lbf-ft", "lb-ft", "ft-lb", "ft-lbf", "ftlbs", "ft-lbs", "footpound", "poundfoot"],
    ),
    (
        "lbf in",
        Torque,
        POUND_FORCE_FOOT_NM / 12.0,
        &["lbin", "inlb", "inlbf", "lbf-in", "lb-in", "in-lb", "in-lbf", "inlbs", "in-lbs"],
    ),
    ("kgf m", Torque, KILOPOND_METRE_NM, &["kpm", "mkgf", "mkp", "kgf-m"]),
    ("1", Ratio, 1.0, &["-", "ratio", "frac", "fraction"]),
    ("%", Ratio, 1e-2, &["percent", "pct", "prozent", "perc", "percentage"]),
    ("‰", Ratio, 1e-3, &["promille", "permille"]),
    ("kg m²", Inertia, 1.0, &["kg-m2", "kgm2/rad", "nms2", "nms2/rad"]),
    ("g m²", Inertia, 1e-3, &["g-m2"]),
    ("kg cm²", Inertia, 1e-4, &["kg-cm2"]),
    ("g cm²", Inertia, 1e-7, &["g-cm2"]),
    ("kg mm²", Inertia, 1e-6, &["kg-mm2"]),
    ("lb ft²", Inertia, POUND_FOOT_SQUARED_KG_M2, &["lbmft2", "lb-ft2", "lbm-ft2"]),
    ("Nm/rad", Stiffness, 1.0, &["n-m/rad", "nmrad-1"]),
    ("kNm/rad", Stiffness, 1e3, &["knmrad-1"]),
    ("Nm/deg", Stiffness, 1.0 / DEGREE_RAD, &["nm/°", "nm/grad"]),
    ("Nm s/rad", Damping, 1.0, &["nm/rad/s", "nmsrad-1", "nm-s/rad"]),
    ("Nm/rpm", Damping, 1.0 / RPM_RAD_S, &["nm/1/min", "nmmin"]),
];

/// Units with more than one meaning, and what to write instead.
const AMBIGUOUS: &[(&str, &[&str])] =
    &[("hz", &["rev/s", "rad/s"]), ("1/s", &["rev/s", "rad/s"]), ("s-1", &["rev/s", "rad/s"])];

/// Finds the unit a text means.
///
/// # Errors
///
/// [`UnitError`] if the text is empty, unknown or has several meanings.
///
/// # Example
///
/// ```
/// let unit = bench::units::parse_unit("1/min")?;
/// assert_eq!(unit.to_si(60.0), std::f64::consts::TAU);
/// # Ok::<(), bench::units::UnitError>(())
/// ```
pub fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let wanted = normalised(text);
    if wanted.is_empty() {
        return Err(UnitError::Empty);
    }
    if let Some((_, instead)) = AMBIGUOUS.iter().find(|(name, _)| *name == wanted) {
        return Err(UnitError::Ambiguous { text: text.trim().to_owned(), instead: instead.to_vec() });
    }
    let row = TABLE.iter().find(|(spelling, _, _, others)| {
        normalised(spelling) == wanted || others.iter().any(|other| normalised(other) == wanted)
    });
    match row {
        Some(&(spelling, quantity, factor, _)) => Ok(Unit { quantity, factor, spelling }),
        None => Err(UnitError::Unknown { text: text.trim().to_owned(), closest: closest_units(&wanted) }),
    }
}

/// Whether two texts may mean the same unit: they are spelt alike, one of them is empty, or both are known and equal.
pub fn may_be_same(one: &str, other: &str) -> bool {
    let (spelt, also) = (normalised(one), normalised(other));
    let equal = |a: Unit, b: Unit| a.quantity == b.quantity && a.factor == b.factor;
    spelt.is_empty()
        || also.is_empty()
        || spelt == also
        || matches!((parse_unit(one), parse_unit(other)), (Ok(a), Ok(b)) if equal(a, b))
}

/// Finds the unit a text means, if it measures `quantity`.
///
/// # Errors
///
/// [`UnitError`] as [`parse_unit`], and if the unit measures something else.
pub fn parse_unit_of(text: &str, quantity: Quantity) -> Result<Unit, UnitError> {
    let unit = parse_unit(text)?;
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
    let text = text.trim();
    let split = number_length(text);
    let number = text[..split].parse::<f64>().ok().filter(|value| value.is_finite());
    let Some(number) = number else { return Err(UnitError::NotANumber { text: text.to_owned() }) };
    Ok(parse_unit_of(&text[split..], quantity)?.to_si(number))
}

/// The usual spelling of a quantity's SI unit.
pub fn si_spelling(quantity: Quantity) -> &'static str {
    match quantity {
        AngularSpeed => "rad/s",
        Torque => "Nm",
        Ratio => "1",
        Inertia => "kg m²",
        Stiffness => "Nm/rad",
        Damping => "Nm s/rad",
    }
}

/// The usual spellings of every known unit of a quantity.
pub fn spellings(quantity: Quantity) -> impl Iterator<Item = &'static str> {
    TABLE.iter().filter(move |row| row.1 == quantity).map(|row| row.0)
}

/// Length of the longest beginning of `text` that is a number.
fn number_length(text: &str) -> usize {
    let ends = text.char_indices().map(|(at, c)| at + c.len_utf8());
    ends.take_while(|&end| end <= 32).filter(|&end| is_plain_number(&text[..end])).last().unwrap_or(0)
}

/// Whether a text is a decimal number: `inf` and `nan`, which Rust also reads, are not.
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

fn closest_units(wanted: &str) -> Vec<String> {
    let all: Vec<String> =
        TABLE.iter().flat_map(|row| std::iter::once(row.0).chain(row.3.iter().copied())).map(normalised).collect();
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
