//! Typesets the thesis's symbols: `T_d*` becomes T with a subscript d.

use page::markup;
use page::markup::Markup;

/// Symbols that are typeset where they stand in a sentence; a longer one before one it begins with.
const SYMBOLS: &[&str] = &[
    "T_d,shaft,calc",
    "T_shaft,meas",
    "T_d,calc",
    "T_d,meas",
    "T_shaft",
    "T_fric",
    "T_f",
    "T_d*",
    "T_d",
    "T_e",
    "T_g",
    "N_d*",
    "N_d",
    "N_e",
    "N_0",
    "ω_d",
    "ω_e",
    "ω_n",
    "K_p",
    "K_i",
    "K_d",
    "K_ii",
    "k_a",
    "I_0",
    "J_d",
    "J_e",
    "H_d",
    "H_e",
    "H_s",
    "b_0",
    "b_1",
    "α_e",
    "δ_e",
    "δ_T",
    "τ_total",
    "τ_cell",
    "τ_bend",
    "dω_d",
    "dω_e",
    "dN_d*",
];

/// A symbol such as `T_d,shaft,calc` or `τ_total`; what has no underscore stays as it is.
pub(crate) fn symbol(text: &str) -> Markup {
    let set = |(piece, below)| if below { markup!("<sub>{}</sub>", piece) } else { markup!("{}", piece) };
    pieces(text).into_iter().map(set).collect()
}

/// A symbol inside an SVG `text` element.
pub(crate) fn symbol_svg(text: &str) -> Markup {
    let set = |(piece, below)| match below {
        true => markup!("<tspan class=\"sub\" dy=\"3\">{}</tspan><tspan dy=\"-3\">\u{200b}</tspan>", piece),
        false => markup!("{}", piece),
    };
    pieces(text).into_iter().map(set).collect()
}

/// The text in pieces, each with whether it stands below the line: what follows an underscore does, up to the next
/// character that is neither letter, digit nor comma.
fn pieces(text: &str) -> Vec<(&str, bool)> {
    let mut all = Vec::new();
    let mut rest = text;
    while let Some((before, behind)) = rest.split_once('_') {
        let end = behind.find(|c: char| !c.is_alphanumeric() && c != ',').unwrap_or(behind.len());
        let (below, after) = behind.split_at(end);
        all.extend([(before, false), (below, true)]);
        rest = after;
    }
    all.push((rest, false));
    all
}

/// A sentence in which known symbols are typeset and everything else is plain text.
pub(crate) fn prose(text: &str) -> Markup {
    let text = text.replace(" %", "\u{a0}%");
    let mut set = Markup::default();
    let mut rest = text.as_str();
    while let Some((at, found)) = next_symbol(rest) {
        let (before, behind) = rest.split_at(at);
        set.push(markup!("{}", before));
        set.push(symbol(found));
        rest = behind.get(found.len()..).unwrap_or_default();
    }
    set.push(markup!("{}", rest));
    set
}

/// The first known symbol that stands as a word of its own, and where.
fn next_symbol(text: &str) -> Option<(usize, &'static str)> {
    text.char_indices().find_map(|(at, _)| {
        let (before, behind) = text.split_at(at);
        let starts_word = !before.chars().next_back().is_some_and(|c| c.is_alphanumeric() || "_-./\\".contains(c));
        let found = SYMBOLS.iter().find(|symbol| is_word(behind, symbol)).filter(|_| starts_word)?;
        Some((at, *found))
    })
}

fn is_word(text: &str, symbol: &str) -> bool {
    text.strip_prefix(symbol).is_some_and(|after| {
        let mut after = after.chars();
        match after.next() {
            Some('.') => !after.next().is_some_and(char::is_alphanumeric),
            Some(next) => !(next.is_alphanumeric() || next == '_' || next == '-'),
            None => true,
        }
    })
}
