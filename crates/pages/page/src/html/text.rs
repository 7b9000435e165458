//! Text in a line, and formulas.

use crate::formula::{Piece, pieces};
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

/// A formula: letters of symbols slant, and names of functions do not.
pub(super) fn formula(text: &str) -> Markup {
    set_formula(&pieces(text))
}

fn set_formula(all: &[Piece<'_>]) -> Markup {
    let set = |piece: &Piece<'_>| match piece {
        Piece::Fraction(over, under) => {
            markup!("<span class=\"frac\"><span>{}</span><span>{}</span></span>", set_formula(over), set_formula(under))
        }
        Piece::Symbol(letters) => markup!("<i>{}</i>", letters),
        Piece::Index(below) => markup!("<sub>{}</sub>", below),
        Piece::Power(above) => markup!("<sup>{}</sup>", set_formula(above)),
        Piece::Upright(text) => markup!("{}", text),
    };
    all.iter().map(set).collect()
}
