//! Faults of a bench file, each with its place and its remedy.

use std::fmt;

use units::UnitError;

/// A bench file with faults: all of them, in the order of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchFileError {
    /// The faults; at least one.
    pub faults: Vec<Fault>,
}

impl std::error::Error for BenchFileError {}

impl fmt::Display for BenchFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, fault) in self.faults.iter().enumerate() {
            let separator = if index == 0 { "" } else { "\n" };
            write!(f, "{separator}{fault}")?;
        }
        Ok(())
    }
}

/// One fault of a bench file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {key}: {kind}")]
pub struct Fault {
    /// Line, counted from 1. Of something missing: the line of the table that should hold it.
    pub line: usize,
    /// The key with its tables, e.g. `bench.dynamometer_inertia`.
    pub key: String,
    /// Kind of the fault.
    pub kind: FaultKind,
}

/// Kinds of a key's fault.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FaultKind {
    /// The text is not TOML.
    #[error("this is not TOML: {message}")]
    Syntax {
        /// The parser's words.
        message: String,
    },
    /// No such key.
    #[error("there is no such key; {}", suggestion(.closest.as_deref(), .known))]
    UnknownKey {
        /// The key that was probably meant.
        closest: Option<String>,
        /// Every key that may stand here.
        known: Vec<String>,
    },
    /// A key that must be there is not.
    #[error("this is missing; add {example}")]
    Missing {
        /// Text to write.
        example: String,
    },
    /// A placeholder was left.
    #[error("nothing is filled in yet; write the value of your bench, such as {example}")]
    Placeholder {
        /// Text to write.
        example: String,
    },
    /// A value of the wrong type.
    #[error("this is {found}, but must be {expected}, such as {example}")]
    WrongType {
        /// Its TOML type.
        found: &'static str,
        /// The type needed.
        expected: &'static str,
        /// Text to write.
        example: String,
    },
    /// A text that is none of the possible ones.
    #[error("`{found}` is not possible here; write {}", .possible.join(" or "))]
    NotOneOf {
        /// The text.
        found: String,
        /// The possible ones.
        possible: Vec<String>,
    },
    /// A text with characters that no person sees, and that other programs take for the end of it.
    #[error("the text has the control character {code}; write it without")]
    ControlCharacter {
        /// The character's code, as Unicode writes it.
        code: String,
    },
    /// A number outside what is possible.
    #[error("{value} is outside {low} … {high}; {remedy}")]
    OutOfRange {
        /// The number.
        value: f64,
        /// Smallest possible.
        low: f64,
        /// Largest possible.
        high: f64,
        /// The remedy.
        remedy: String,
    },
    /// An inertia no bench has.
    #[error("{value_kg_m2} kg m² is outside {} … {} kg m²; {}", .plausible.0, .plausible.1, inertia_remedy(.looks_like))]
    ImplausibleInertia {
        /// The value as read, kg m².
        value_kg_m2: f64,
        /// The plausible range, kg m².
        plausible: (f64, f64),
        /// Units in which the number would be plausible.
        looks_like: Vec<String>,
    },
    /// A unit, or a number with a unit, that cannot be read.
    #[error("{error}; write e.g. {example}")]
    Unit {
        /// Why not.
        error: UnitError,
        /// Text to write.
        example: String,
    },
    /// Two roles name the same channel.
    #[error("`{channel}` already plays {other}; give each role a channel of its own, or remove one of them")]
    ChannelUsedTwice {
        /// The channel.
        channel: String,
        /// The other role's key.
        other: String,
    },
    /// Two keys that say the same.
    #[error("this and `{other}` say the same thing; keep one of them")]
    Excludes {
        /// The other key.
        other: &'static str,
    },
    /// A value that the virtual bench cannot take.
    #[error("{message}")]
    VirtualBench {
        /// The reader's words.
        message: String,
    },
    /// A stretch of a recording that holds no time.
    #[error("from {from_s} s to {to_s} s there is no time; write the beginning first, and a later end")]
    EmptyStretch {
        /// The beginning, s.
        from_s: f64,
        /// The end, s.
        to_s: f64,
    },
    /// A stretch with two uses.
    #[error("this stretch has the use `{first}` already; write another [[recordings.stretch]] for the other use")]
    TwoUses {
        /// The key of the first use.
        first: &'static str,
    },
    /// Two stretches of a recording share time.
    #[error(
        "this overlaps the stretch from {from_s} s to {to_s} s of the same recording; make them end where the other begins"
    )]
    StretchesOverlap {
        /// Beginning of the other, s.
        from_s: f64,
        /// End of the other, s.
        to_s: f64,
    },
    /// A text is not a label.
    #[error("`{text}` is no label; write {{test}}_{{T|N}}_{{NT|TN}}, such as \"BS_T_NT\"")]
    NotALabel {
        /// The text.
        text: String,
    },
}

fn suggestion(closest: Option<&str>, known: &[String]) -> String {
    match closest {
        Some(closest) => format!("did you mean `{closest}`?"),
        None => format!("possible are {}", known.join(", ")),
    }
}

fn inertia_remedy(looks_like: &[String]) -> String {
    if looks_like.is_empty() {
        return "check the number, and write it with its unit, such as \"0.6 kg m²\"".to_owned();
    }
    format!("it looks like {}: write the number with that unit", looks_like.join(" or "))
}
