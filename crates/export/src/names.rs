//! Names that other programs take.

/// What is left where a bench has no name that can be written in ASCII.
const FALLBACK: &str = "bench";

/// Words that no module of Python and no function of MATLAB or Octave can be called, and packages that the module itself imports.
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

fn capitalised(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map(|first| first.to_ascii_uppercase()).into_iter().chain(letters).collect()
}
