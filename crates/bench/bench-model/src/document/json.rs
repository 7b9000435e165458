//! JSON whose faults are stated in the words of the file: line, field, problem.

use serde::de::DeserializeOwned;
use serde_json::error::Category;

/// Longest part of the file that a message quotes, characters.
const QUOTED: usize = 40;

/// Why a text is not the JSON that is wanted. Fields are named as in the file: `model.mechanics`, `uncertainty[0]`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum JsonFault {
    /// Nothing is in it.
    #[error("the file is empty")]
    Empty,
    /// The end is missing.
    #[error("the file ends in the middle{}; part of it is missing", after(.field))]
    Cut {
        /// The field that was begun last.
        field: String,
    },
    /// Values that contradict each other or that nothing can have.
    #[error("{problem}")]
    Contradiction {
        /// Which fields, and what is wrong with them.
        problem: String,
    },
    /// A value or a sign that does not belong there.
    #[error("line {line}{}: {problem}", of(.field))]
    Value {
        /// Line of the file, from 1.
        line: usize,
        /// The field.
        field: String,
        /// Fault of the text, in words.
        problem: String,
    },
}

fn after(field: &str) -> String {
    if field.is_empty() { String::new() } else { format!(", in `{field}`") }
}

fn of(field: &str) -> String {
    if field.is_empty() { String::new() } else { format!(", `{field}`") }
}

/// The value that a text in JSON holds.
///
/// # Errors
/// [`JsonFault`] with line and field.
pub fn from_json<T: DeserializeOwned>(text: &str) -> Result<T, JsonFault> {
    serde_json::from_str(text).map_err(|error| fault(text, &error))
}

fn fault(text: &str, error: &serde_json::Error) -> JsonFault {
    if text.trim().is_empty() {
        return JsonFault::Empty;
    }
    let message = error.to_string();
    let message = message.rfind(" at line ").map_or(&*message, |end| &message[..end]);
    let at = offset(text, error.line(), error.column());
    let field = Place::at(&text[..at]);
    match error.classify() {
        Category::Eof => JsonFault::Cut { field: Place::at(text).field() },
        Category::Syntax => {
            JsonFault::Value { line: error.line(), field: field.field(), problem: of_syntax(message, &text[at..]) }
        }
        Category::Data | Category::Io => {
            let missing = message.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`'));
            let (field, problem) = match missing {
                Some(name) => (field.object(), Some(format!("the field `{name}` is missing"))),
                None => (field.field(), of_data(message)),
            };
            match problem.or_else(|| (!field.is_empty()).then(|| message.to_owned())) {
                Some(problem) => JsonFault::Value { line: error.line(), field, problem },
                None => JsonFault::Contradiction { problem: message.to_owned() },
            }
        }
    }
}

/// Where the character of this line and column begins, both from 1; the column counts bytes.
fn offset(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let mut at = (start + column.saturating_sub(1)).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// A fault of the writing.
fn of_syntax(message: &str, rest: &str) -> String {
    let word: String = rest.chars().take_while(|c| c.is_alphanumeric() || "+-._".contains(*c)).take(QUOTED).collect();
    match message {
        "number out of range" => "this number is too large".to_owned(),
        "expected value" | "invalid number" | "expected ident" if !word.is_empty() => {
            format!("`{word}` is no value; write a number, a text in quotes, true, false or null")
        }
        "expected value" => "a value is missing".to_owned(),
        "trailing comma" => "a comma is followed by nothing".to_owned(),
        "trailing characters" => "more text follows after the end of the object".to_owned(),
        "key must be a string" => "the name of a field is not in quotes".to_owned(),
        other => format!("this is not written as JSON: {other}"),
    }
}

/// A value of another kind than is needed; `None` for a message that is not the reader's own.
fn of_data(message: &str) -> Option<String> {
    let needed =
        |found: &str, expected: &str| format!("{}, where {} is needed", of_found(found), of_expected(expected));
    let split = |prefix: &str| message.strip_prefix(prefix)?.split_once(", expected ");
    if let Some((found, expected)) = split("invalid type: ").or_else(|| split("invalid value: ")) {
        return Some(needed(found, expected));
    }
    if let Some((count, expected)) = split("invalid length ") {
        return Some(format!("a list of {count}, where {} is needed", of_expected(expected)));
    }
    let (found, known) = split("unknown variant ")?;
    Some(format!("{found} is unknown here; write {known}"))
}

/// Kind of value that was found, as the file has it.
fn of_found(found: &str) -> String {
    let value = |kind: &str| found.strip_prefix(kind).map(|value| value.trim_matches('`').to_owned());
    if let Some(text) = found.strip_prefix("string ") {
        return format!("the text {}", text.chars().take(QUOTED).collect::<String>());
    }
    value("integer ").or_else(|| value("floating point ")).or_else(|| value("boolean ")).unwrap_or_else(
        || match found {
            "map" => "an object".to_owned(),
            "sequence" => "a list".to_owned(),
            other => other.to_owned(),
        },
    )
}

fn of_expected(expected: &str) -> String {
    match expected {
        "f64" => "a number".to_owned(),
        "u32" | "u64" | "usize" => "a whole number from 0".to_owned(),
        "a string" => "a text in quotes".to_owned(),
        "a sequence" => "a list".to_owned(),
        "a map" => "an object".to_owned(),
        other if other.starts_with("struct ") => "an object".to_owned(),
        other => match other.strip_prefix("a tuple of size ") {
            Some(size) => format!("a list of {size}"),
            None => other.to_owned(),
        },
    }
}

/// Where a position in JSON is: the objects and lists around it, each with its last field or its number of entries
/// before.
#[derive(Debug, Default)]
struct Place {
    levels: Vec<Level>,
}

#[derive(Debug)]
enum Level {
    Object { field: String, is_name: bool },
    List { before: usize },
}

impl Place {
    /// The place where a text ends.
    fn at(text: &str) -> Self {
        let mut place = Place::default();
        let mut rest = text.chars();
        while let Some(c) = rest.next() {
            match c {
                '"' => place.named(&quoted(&mut rest)),
                '{' => place.levels.push(Level::Object { field: String::new(), is_name: true }),
                '[' => place.levels.push(Level::List { before: 0 }),
                '}' | ']' => drop(place.levels.pop()),
                ':' | ',' => place.passed(c),
                _ => {}
            }
        }
        place
    }

    /// A text in quotes: the name of a field, or a value.
    fn named(&mut self, text: &str) {
        if let Some(Level::Object { field, is_name: true }) = self.levels.last_mut() {
            text.clone_into(field);
        }
    }

    /// A sign between names and values.
    fn passed(&mut self, sign: char) {
        match self.levels.last_mut() {
            Some(Level::Object { is_name, .. }) => *is_name = sign == ',',
            Some(Level::List { before }) if sign == ',' => *before += 1,
            _ => {}
        }
    }

    /// The field here.
    fn field(&self) -> String {
        path(&self.levels)
    }

    /// The object here.
    fn object(&self) -> String {
        path(&self.levels[..self.levels.len().saturating_sub(1)])
    }
}

fn path(levels: &[Level]) -> String {
    let mut path = String::new();
    for level in levels {
        match level {
            Level::Object { field, .. } if field.is_empty() => {}
            Level::Object { field, .. } if path.is_empty() => path.push_str(field),
            Level::Object { field, .. } => path.push_str(&format!(".{field}")),
            Level::List { before } => path.push_str(&format!("[{before}]")),
        }
    }
    path
}

/// The rest of a text up to its closing quote; empty where there is none.
fn quoted(rest: &mut std::str::Chars<'_>) -> String {
    let mut text = String::new();
    while let Some(c) = rest.next() {
        match c {
            '"' => return text,
            '\\' => text.extend(rest.next()),
            c => text.push(c),
        }
    }
    String::new()
}
