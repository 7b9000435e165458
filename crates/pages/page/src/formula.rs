//! Formulas as they are typed, in pieces: `{over}/{under}` is a stacked fraction, `^(x)` a power, `T_d` a symbol with
//! an index.

/// A piece of a formula.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Piece<'a> {
    /// A stacked fraction.
    Fraction(Vec<Piece<'a>>, Vec<Piece<'a>>),
    /// Letters of a symbol.
    Symbol(&'a str),
    /// An index.
    Index(&'a str),
    /// A power.
    Power(Vec<Piece<'a>>),
    /// Signs, digits and names of functions.
    Upright(&'a str),
}

/// The pieces of a formula.
pub(crate) fn pieces(text: &str) -> Vec<Piece<'_>> {
    let Some((before, over, under, rest)) = first_fraction(text) else { return letters(text) };
    let mut all = letters(before);
    all.push(Piece::Fraction(pieces(over), pieces(under)));
    all.extend(pieces(rest));
    all
}

/// Text before the first fraction, over and under its line, and behind it.
fn first_fraction(text: &str) -> Option<(&str, &str, &str, &str)> {
    let start = text.find('{')?;
    let over = braced(&text[start..])?;
    let behind = &text[start + over.len() + 2..];
    let under = braced(behind.strip_prefix('/')?)?;
    Some((&text[..start], over, under, &behind[under.len() + 3..]))
}

/// The text between a brace at the start and the one that closes it.
fn braced(text: &str) -> Option<&str> {
    let mut depth = 0_usize;
    for (at, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth = depth.checked_sub(1)?,
            _ => {}
        }
        if depth == 0 {
            return (at > 0).then(|| &text[1..at]);
        }
    }
    None
}

/// Letters of a formula: single ones and symbols slant, words of three letters and more are names.
fn letters(text: &str) -> Vec<Piece<'_>> {
    let mut all = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let is_word = |c: char| c.is_alphabetic();
        let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
        if let Some((power, _)) = rest.strip_prefix("^(").and_then(|behind| behind.split_once(')')) {
            all.push(Piece::Power(letters(power)));
            rest = &rest[power.len() + 3..];
            continue;
        }
        if length == 0 {
            let first = rest.chars().next().map_or(1, char::len_utf8);
            let end = rest[first..].find(|c| is_word(c) || c == '^').map_or(rest.len(), |at| first + at);
            all.push(Piece::Upright(&rest[..end]));
            rest = &rest[end..];
            continue;
        }
        let index = match rest[length..].strip_prefix('_') {
            Some(behind) => 1 + behind.find(|c: char| !c.is_alphanumeric() && c != ',').unwrap_or(behind.len()),
            None => 0,
        };
        let (word, below) = (&rest[..length], rest[length..length + index].trim_start_matches('_'));
        all.push(if word.chars().count() < 3 { Piece::Symbol(word) } else { Piece::Upright(word) });
        if !below.is_empty() {
            all.push(Piece::Index(below));
        }
        rest = &rest[length + index..];
    }
    all
}
