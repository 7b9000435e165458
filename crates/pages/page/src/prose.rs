//! Text in a line: words, symbols, quantities, code, links.

use serde::Serialize;

use crate::quantity::Quantity;
use crate::tone::Tone;

/// A piece of text in a line.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Inline {
    /// Words.
    Text(String),
    /// Words that stand out.
    Strong(String),
    /// A symbol of a formula.
    Symbol(Symbol),
    /// A value with its interval and unit.
    Quantity(Quantity),
    /// A name to be taken letter by letter, such as that of a file.
    Code(String),
    /// A short word with a colour.
    Tag(Tone, String),
    /// Words that lead elsewhere.
    Link {
        /// The words.
        text: String,
        /// An address, or `#id` of a section.
        target: String,
    },
}

/// A symbol as it is typed: `T_d*` is T with a d below and a star behind.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Symbol(String);

impl Symbol {
    /// A symbol; what follows an underscore stands below the line.
    pub fn new(typed: impl Into<String>) -> Self {
        Symbol(typed.into())
    }

    /// The symbol as it is typed.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// The symbol in pieces, each with whether it stands below the line. What follows an underscore does, up to the
    /// next character that is neither letter, digit nor comma.
    pub fn pieces(&self) -> Vec<(&str, bool)> {
        let mut all = Vec::new();
        let mut rest = self.0.as_str();
        while let Some((before, behind)) = rest.split_once('_') {
            let end = behind.find(|c: char| !c.is_alphanumeric() && c != ',').unwrap_or(behind.len());
            let (below, after) = behind.split_at(end);
            all.extend([(before, false), (below, true)]);
            rest = after;
        }
        all.push((rest, false));
        all.retain(|(piece, _)| !piece.is_empty());
        all
    }
}

/// Pieces of text in a line. From plain text, words such as `T_d` become symbols.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Prose(pub Vec<Inline>);

impl Prose {
    /// Text with nothing in it that is a symbol.
    pub fn verbatim(text: impl Into<String>) -> Self {
        Prose(vec![Inline::Text(text.into())])
    }

    /// A name to be taken letter by letter.
    pub fn code(name: impl Into<String>) -> Self {
        Prose(vec![Inline::Code(name.into())])
    }

    /// A symbol alone.
    pub fn symbol(typed: impl Into<String>) -> Self {
        Prose(vec![Inline::Symbol(Symbol::new(typed))])
    }

    /// Words that stand out.
    pub fn strong(text: impl Into<String>) -> Self {
        Prose(vec![Inline::Strong(text.into())])
    }

    /// A short word with a colour.
    pub fn tag(tone: Tone, text: impl Into<String>) -> Self {
        Prose(vec![Inline::Tag(tone, text.into())])
    }

    /// Words that lead elsewhere.
    pub fn link(text: impl Into<String>, target: impl Into<String>) -> Self {
        Prose(vec![Inline::Link { text: text.into(), target: target.into() }])
    }

    /// This, and more behind it.
    #[must_use]
    pub fn then(mut self, more: impl Into<Prose>) -> Self {
        self.0.extend(more.into().0);
        self
    }

    /// Returns true if there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The text without markup, symbols as they are typed.
    pub fn plain(&self) -> String {
        let plain = |piece: &Inline| match piece {
            Inline::Text(text) | Inline::Strong(text) | Inline::Code(text) | Inline::Tag(_, text) => text.clone(),
            Inline::Link { text, .. } => text.clone(),
            Inline::Symbol(symbol) => symbol.as_str().to_owned(),
            Inline::Quantity(quantity) => quantity.text(),
        };
        self.0.iter().map(plain).collect()
    }
}

impl From<&str> for Prose {
    fn from(text: &str) -> Self {
        let mut all = Vec::new();
        let mut rest = text;
        while let Some((start, length)) = next_symbol(rest) {
            if start > 0 {
                all.push(Inline::Text(rest[..start].to_owned()));
            }
            all.push(Inline::Symbol(Symbol::new(&rest[start..start + length])));
            rest = &rest[start + length..];
        }
        if !rest.is_empty() {
            all.push(Inline::Text(rest.to_owned()));
        }
        Prose(all)
    }
}

impl From<String> for Prose {
    fn from(text: String) -> Self {
        text.as_str().into()
    }
}

impl From<&String> for Prose {
    fn from(text: &String) -> Self {
        text.as_str().into()
    }
}

impl From<Symbol> for Prose {
    fn from(symbol: Symbol) -> Self {
        Prose(vec![Inline::Symbol(symbol)])
    }
}

impl From<Quantity> for Prose {
    fn from(quantity: Quantity) -> Self {
        Prose(vec![Inline::Quantity(quantity)])
    }
}

/// The first symbol in a text: where it starts and how long it is, in bytes.
pub(crate) fn next_symbol(text: &str) -> Option<(usize, usize)> {
    text.match_indices('_').find_map(|(at, _)| {
        let before = text[..at].chars().rev();
        let letters: Vec<char> = before.take_while(|c| c.is_alphanumeric() || JOINS.contains(*c)).collect();
        let is_symbol = match letters.as_slice() {
            [letter] => letter.is_alphabetic(),
            [letter, 'd' | 'Δ' | 'σ'] => letter.is_alphabetic(),
            _ => false,
        };
        let index = index_behind(&text[at + 1..])?;
        let start = at - letters.iter().map(|c| c.len_utf8()).sum::<usize>();
        let star = usize::from(text[at + 1 + index..].starts_with('*'));
        is_symbol.then_some((start, at + 1 + index + star - start))
    })
}

/// Characters that join letters to a file's name.
const JOINS: &str = "_-./\\";

/// The length of an index: letters, digits and commas between them, unless a name goes on behind.
fn index_behind(text: &str) -> Option<usize> {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != ',').unwrap_or(text.len());
    let index = text[..end].trim_end_matches(',');
    let mut after = text[index.len()..].chars();
    let goes_on = match after.next() {
        Some('_') => true,
        Some(c) if JOINS.contains(c) => after.next().is_some_and(char::is_alphanumeric),
        _ => false,
    };
    (!index.is_empty() && !goes_on).then_some(index.len())
}
