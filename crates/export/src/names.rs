//! Names that other programs take.

/// What is left where a bench has no name that can be written in ASCII.
const FALLBACK: &str = "bench";

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
        Names { file: words.join("_").to_ascii_lowercase(), class: words.into_iter().map(capitalised).collect() }
    }
}

fn capitalised(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map(|first| first.to_ascii_uppercase()).into_iter().chain(letters).collect()
}
