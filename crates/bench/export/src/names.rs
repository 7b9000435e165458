//! Names that other programs take.

/// Name where a bench has none that can be written in ASCII.
const FALLBACK: &str = "bench";

/// Words that no module of Python and no function of MATLAB or Octave can be called, and packages that the module
/// itself imports.
const TAKEN: [&str; 61] = [
    "and",
    "as",
    "assert",
    "async",
    "await",
    "break",
    "case",
    "catch",
    "class",
    "classdef",
    "continue",
    "control",
    "def",
    "del",
    "do",
    "elif",
    "else",
    "elseif",
    "end",
    "end_try_catch",
    "end_unwind_protect",
    "endfor",
    "endfunction",
    "endif",
    "endswitch",
    "endwhile",
    "except",
    "finally",
    "for",
    "from",
    "function",
    "global",
    "if",
    "import",
    "in",
    "is",
    "lambda",
    "math",
    "nonlocal",
    "not",
    "numpy",
    "or",
    "otherwise",
    "parfor",
    "pass",
    "persistent",
    "raise",
    "return",
    "spmd",
    "switch",
    "sys",
    "try",
    "types",
    "until",
    "unwind_protect",
    "while",
    "with",
    "yield",
    "true",
    "false",
    "none",
];

/// One bench or model by names for files and programs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Names {
    /// Name of files and modules: ASCII letters in lower case, digits and `_`.
    pub file: String,
    /// Name of a class: ASCII letters and digits, each word with a capital.
    pub class: String,
}

impl Names {
    /// The names of a bench or a model.
    #[must_use]
    pub fn of(name: &str) -> Self {
        let name = in_ascii(name);
        let mut words: Vec<&str> = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty()).collect();
        if !words.first().is_some_and(|word| word.starts_with(|c: char| c.is_ascii_alphabetic())) {
            words.insert(0, FALLBACK);
        }
        let mut file = words.join("_").to_ascii_lowercase();
        if TAKEN.contains(&file.as_str()) {
            file.push_str("_model");
        }
        Names { file, class: words.into_iter().map(capitalised).collect() }
    }
}

/// Tells whether parsers of XML and of programs refuse it: control characters, and what is no character.
///
/// # Source
/// Extensible Markup Language (XML) 1.0, 5th ed., production 2.
pub(crate) fn is_refused(c: char) -> bool {
    c.is_control() || ['\u{fffe}', '\u{ffff}'].contains(&c)
}

/// A text in one line, without control characters: for comments and strings of programs.
pub(crate) fn one_line(text: &str) -> String {
    let words = text.split(|c: char| c.is_whitespace() || is_refused(c)).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(" ")
}

/// The text with Latin letters in ASCII: umlauts as German spells them without, all others without their accents. An
/// accent that is a character of its own is left out.
fn in_ascii(text: &str) -> String {
    let is_accent = |c: &char| ('\u{300}'..='\u{36f}').contains(c);
    // The letter may come before its accent as two characters: ä as a and ¨.
    let composed = UMLAUTS.iter().fold(text.to_owned(), |text, (two, one)| text.replace(two, one));
    composed.chars().filter(|c| !is_accent(c)).flat_map(|c| letter(c).chars().collect::<Vec<_>>()).collect()
}

/// Umlauts as two characters, and what stands for them.
const UMLAUTS: [(&str, &str); 6] = [
    ("a\u{308}", "ae"),
    ("o\u{308}", "oe"),
    ("u\u{308}", "ue"),
    ("A\u{308}", "Ae"),
    ("O\u{308}", "Oe"),
    ("U\u{308}", "Ue"),
];

/// Latin letters with accents, row by row for one letter of ASCII or two.
const LETTERS: [(&str, &str); 54] = [
    ("ae", "äæǽ"),
    ("Ae", "Ä"),
    ("AE", "ÆǼ"),
    ("oe", "öœ"),
    ("Oe", "Ö"),
    ("OE", "Œ"),
    ("ue", "ü"),
    ("Ue", "Ü"),
    ("ss", "ß"),
    ("SS", "ẞ"),
    ("th", "þ"),
    ("Th", "Þ"),
    ("a", "áàâãåāăąǎ"),
    ("A", "ÁÀÂÃÅĀĂĄǍ"),
    ("c", "çćĉċč"),
    ("C", "ÇĆĈĊČ"),
    ("d", "ďđð"),
    ("D", "ĎĐÐ"),
    ("e", "éèêëēĕėęěẽ"),
    ("E", "ÉÈÊËĒĔĖĘĚẼ"),
    ("g", "ĝğġģ"),
    ("G", "ĜĞĠĢ"),
    ("h", "ĥħ"),
    ("H", "ĤĦ"),
    ("i", "íìîïĩīĭįıǐ"),
    ("I", "ÍÌÎÏĨĪĬĮİǏ"),
    ("j", "ĵ"),
    ("J", "Ĵ"),
    ("k", "ķ"),
    ("K", "Ķ"),
    ("l", "ĺļľŀł"),
    ("L", "ĹĻĽĿŁ"),
    ("n", "ñńņňŉ"),
    ("N", "ÑŃŅŇ"),
    ("o", "óòôõøōŏőǒ"),
    ("O", "ÓÒÔÕØŌŎŐǑ"),
    ("r", "ŕŗř"),
    ("R", "ŔŖŘ"),
    ("s", "śŝşšșſ"),
    ("S", "ŚŜŞŠȘ"),
    ("t", "ţťŧț"),
    ("T", "ŢŤŦȚ"),
    ("u", "úùûũūŭůűųǔ"),
    ("U", "ÚÙÛŨŪŬŮŰŲǓ"),
    ("w", "ŵẁẃẅ"),
    ("W", "ŴẀẂẄ"),
    ("y", "ýÿŷỳ"),
    ("Y", "ÝŸŶỲ"),
    ("z", "źżž"),
    ("Z", "ŹŻŽ"),
    ("2", "²"),
    ("3", "³"),
    ("1", "¹"),
    ("u", "µμ"),
];

/// Letters that stand for a character: itself where none do.
fn letter(c: char) -> String {
    let found = LETTERS.iter().find(|(_, letters)| letters.contains(c));
    found.map_or_else(|| c.to_string(), |(ascii, _)| (*ascii).to_owned())
}

fn capitalised(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map(|first| first.to_ascii_uppercase()).into_iter().chain(letters).collect()
}
