//! Text in a line, and formulas.

use crate::markup;
use crate::markup::Markup;
use crate::prose::{Inline, Prose, Symbol};
use crate::tone::Tone;

/// Text in a line.
pub(super) fn prose(text: &Prose) -> Markup {
    text.0.iter().map(inline).collect()
}

fn inline(piece: &Inline) -> Markup {
    match piece {
        Inline::Text(text) => plain(text),
        Inline::Strong(text) => markup!("<strong>{}</strong>", prose(&text.into())),
        Inline::Symbol(typed) => symbol(typed),
        Inline::Quantity(quantity) => markup!("<span class=\"n\">{}</span>", plain(&quantity.text())),
        Inline::Code(text) => markup!("<span class=\"file\">{}</span>", text),
        Inline::Tag(tone, text) => markup!("<span class=\"tag {}\">{}</span>", class(*tone), text),
        Inline::Link { text, target } => markup!("<a href=\"{}\">{}</a>", target, text),
    }
}

/// A per cent sign stays with its number.
fn plain(text: &str) -> Markup {
    markup!("{}", text.replace(" %", "\u{a0}%"))
}

/// A symbol with its index below the line.
fn symbol(symbol: &Symbol) -> Markup {
    let set = |(piece, below)| if below { markup!("<sub>{}</sub>", piece) } else { markup!("{}", piece) };
    symbol.pieces().into_iter().map(set).collect()
}

/// The class of a tone.
pub(super) fn class(tone: Tone) -> &'static str {
    match tone {
        Tone::Plain => "plain",
        Tone::Strong => "strong",
        Tone::Faint => "faint",
        Tone::Good => "good",
        Tone::Caution => "caution",
        Tone::Bad => "bad",
    }
}

/// A formula; `{over}/{under}` is a stacked fraction. Letters of symbols slant, and names of functions do not.
pub(super) fn formula(text: &str) -> Markup {
    let Some((before, over, under, rest)) = first_fraction(text) else { return letters(text) };
    let mut all = letters(before);
    all.push(markup!("<span class=\"frac\"><span>{}</span><span>{}</span></span>", formula(over), formula(under)));
    all.push(formula(rest));
    all
}

/// What stands before the first fraction, over and under its line, and behind it.
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

/// Letters of a formula: single ones and symbols slant, words of three letters and more are names, and `^(x)` is a power.
fn letters(text: &str) -> Markup {
    let mut all = Markup::default();
    let mut rest = text;
    while !rest.is_empty() {
        let is_word = |c: char| c.is_alphabetic();
        let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
        if let Some(power) = rest.strip_prefix("^(").and_then(|behind| behind.split_once(')')).map(|(power, _)| power) {
            all.push(markup!("<sup>{}</sup>", letters(power)));
            rest = &rest[power.len() + 3..];
            continue;
        }
        if length == 0 {
            let first = rest.chars().next().map_or(1, char::len_utf8);
            let end = rest[first..].find(|c| is_word(c) || c == '^').map_or(rest.len(), |at| first + at);
            all.push(markup!("{}", &rest[..end]));
            rest = &rest[end..];
            continue;
        }
        let index = match rest[length..].strip_prefix('_') {
            Some(behind) => 1 + behind.find(|c: char| !c.is_alphanumeric() && c != ',').unwrap_or(behind.len()),
            None => 0,
        };
        let (word, below) = (&rest[..length], rest[length..length + index].trim_start_matches('_'));
        let below = match below {
            "" => Markup::default(),
            _ => markup!("<sub>{}</sub>", below),
        };
        all.push(match word.chars().count() < 3 {
            true => markup!("<i>{}</i>{}", word, below),
            false => markup!("{}{}", word, below),
        });
        rest = &rest[length + index..];
    }
    all
}
