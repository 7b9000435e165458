//! The patterns, and what to write in their place.

use std::fmt;
use std::sync::LazyLock;

use regex_lite::Regex;

use super::expression::compiled;
use super::texts::Text;

/// A sentence has at most so many words.
const LONGEST_SENTENCE: usize = 25;
/// A line of comments has at most so many columns, as lines of code have.
const LONGEST_LINE: usize = 120;

/// Something that should be reworded wherever it is found.
pub(super) struct Pattern {
    pub(super) name: &'static str,
    expression: Regex,
    suggestion: &'static str,
}

/// One place to reword.
pub(super) struct Finding {
    pub(super) path: String,
    pub(super) line: usize,
    pub(super) pattern: &'static Pattern,
    excerpt: String,
}

impl Finding {
    /// The crate or folder that the ceiling belongs to.
    pub(super) fn room(&self) -> &str {
        let parts: Vec<&str> = self.path.split('/').collect();
        match parts[..] {
            ["crates", _, room, _, ..] => room,
            ["crates", ..] | [_] => "documents",
            [folder, ..] => folder,
            [] => "documents",
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, line, pattern, excerpt } = self;
        write!(f, "{path}:{line}: {}: \"{excerpt}\" → {}", pattern.name, pattern.suggestion)
    }
}

static PATTERNS: LazyLock<Vec<Pattern>> = LazyLock::new(|| {
    let table = [
        (
            "told",
            r"(?i)\b(untold|told|tells?|telling)\b",
            "show, estimate, state; \"cannot be distinguished from\"; \"the recordings cannot show\"",
        ),
        (
            "held against",
            r"(?i)\b((is|are|be|was|were|been) held against|hold(s|ing)?\b[^.,;:]{0,60}\bagainst)\b",
            "compare with, check against",
        ),
        (
            "stands",
            r"(?i)\bst(ands?|anding|ood) (in|beside|with|behind|between|there)\b",
            "is in, is next to, is listed in",
        ),
        (
            "inverted",
            r"(?:^|[.:;!?] |\n)(By which|Of which|From which|To which|So it is|So is|So are|Of these)\b",
            "begin with the subject",
        ),
        (
            "what, verb",
            r"\b[Ww]hat [^.,;:]{3,80}, (says?|is|are|was|has|have|gives?|needs?|stays?|shows?|goes|stands?)\b",
            "\"X gives what Y\": subject, verb, object",
        ),
    ];
    let pattern = |(name, expression, suggestion)| Pattern { name, expression: compiled(expression), suggestion };
    table.into_iter().map(pattern).collect()
});

/// Its expression finds where a sentence ends.
static LONG_SENTENCE: LazyLock<Pattern> = LazyLock::new(|| Pattern {
    name: "long sentence",
    expression: compiled(r"[.!?;:](?:\s|$)|\n\n"),
    suggestion: "two sentences, of at most 25 words each",
});

static WHAT_FIRST: LazyLock<Pattern> = LazyLock::new(|| Pattern {
    name: "what first",
    expression: compiled(r"^\s*(What|Whether)\b"),
    suggestion: "what the thing is or does: a noun, \"Returns …\", \"Tells whether …\", \"True where …\"",
});

/// Its expression finds the lines of comments, short ones too.
static LONG_LINE: LazyLock<Pattern> = LazyLock::new(|| Pattern {
    name: "long line",
    expression: compiled(r"(?m)^[ \t]*//.*$"),
    suggestion: "lines of at most 120 columns",
});

/// Its expression finds constants whose parts have no names.
static TUPLE_CONSTANT: LazyLock<Pattern> = LazyLock::new(|| Pattern {
    name: "tuple constant",
    expression: compiled(r"(?m)^[ \t]*(pub(\([a-z ]+\))? )?const [A-Z0-9_]+: \(.*$"),
    suggestion: "a constant for each part with its own name and unit, a range, or a struct",
});

/// Its expression finds where a merge was left unfinished.
static UNMERGED: LazyLock<Pattern> = LazyLock::new(|| Pattern {
    name: "unmerged",
    expression: compiled(r"(?m)^(<{7}|>{7}|\|{7}) .*$"),
    suggestion: "the one of the two texts that is right, without the marks",
});

/// Beginning of the doc comment of a predicate, in which the word is right.
const PREDICATE: &str = "Tells whether";

/// Where a pattern is right: the place, the pattern (all of them if empty), and why.
const ALLOWED: &[(&str, &str, &str)] = &[
    ("CONTRIBUTING.md", "told", "the style sheet quotes what it forbids"),
    ("CONTRIBUTING.md", "held against", "the style sheet quotes what it forbids"),
    ("CONTRIBUTING.md", "stands", "the style sheet quotes what it forbids"),
    ("CONTRIBUTING.md", "inverted", "the style sheet quotes what it forbids"),
    ("CONTRIBUTING.md", "what, verb", "the style sheet quotes what it forbids"),
    ("crates/programs/cli/src/cli/", "what first", "doc comments of arguments are the texts of --help"),
    ("docs/src/glossary.md", "told", "a column has the words that are not used"),
    ("xtask/src/wording/", "", "the patterns themselves"),
];

/// The findings in one text.
pub(super) fn find(path: &str, text: &Text) -> Vec<Finding> {
    let finding = |pattern: &'static Pattern, at: usize, excerpt: &str| Finding {
        path: path.to_owned(),
        line: text.line + text.words[..at].matches('\n').count(),
        pattern,
        excerpt: excerpt.split_whitespace().collect::<Vec<_>>().join(" "),
    };
    let mut findings = Vec::new();
    for pattern in PATTERNS.iter() {
        let places = pattern.expression.find_iter(&text.words).filter(|place| !is_predicate(text, place.start()));
        findings.extend(places.map(|place| finding(pattern, place.start(), around(&text.words, place.range()))));
    }
    if let Some(place) = WHAT_FIRST.expression.find(&text.words).filter(|_| text.is_doc) {
        findings.push(finding(&WHAT_FIRST, place.end(), around(&text.words, place.range())));
    }
    if text.sentences {
        let mut start = 0;
        let ends = LONG_SENTENCE.expression.find_iter(&text.words).map(|place| place.end());
        for end in ends.chain([text.words.len()]) {
            let sentence = &text.words[start..end];
            if words(sentence) > LONGEST_SENTENCE {
                let first = start + sentence.len() - sentence.trim_start().len();
                findings.push(finding(&LONG_SENTENCE, first, around(&text.words, first..first)));
            }
            start = end;
        }
    }
    findings.retain(|finding| !allowed(path, finding.pattern.name));
    findings
}

/// The lines of a source that are to be written another way: comments that are too long, constants that are tuples.
pub(super) fn lines(path: &str, source: &str) -> Vec<Finding> {
    let is_long = |line: &regex_lite::Match<'_>| line.as_str().chars().count() > LONGEST_LINE;
    let long = LONG_LINE.expression.find_iter(source).filter(is_long).map(|line| (&*LONG_LINE, line));
    let tuples = TUPLE_CONSTANT.expression.find_iter(source).map(|line| (&*TUPLE_CONSTANT, line));
    long.chain(tuples).map(|(pattern, line)| on_line(path, source, pattern, &line)).collect()
}

/// The marks of an unfinished merge in a file of any kind.
pub(super) fn unmerged(path: &str, content: &str) -> Vec<Finding> {
    UNMERGED.expression.find_iter(content).map(|line| on_line(path, content, &UNMERGED, &line)).collect()
}

fn on_line(path: &str, source: &str, pattern: &'static Pattern, line: &regex_lite::Match<'_>) -> Finding {
    Finding {
        path: path.to_owned(),
        line: 1 + source[..line.start()].matches('\n').count(),
        pattern,
        excerpt: line.as_str().trim_start().chars().take(70).collect(),
    }
}

/// Tells whether the doc comment of a predicate begins here.
fn is_predicate(text: &Text, at: usize) -> bool {
    text.is_doc && text.words[..at].trim().is_empty() && text.words[at..].starts_with(PREDICATE)
}

fn allowed(path: &str, pattern: &str) -> bool {
    ALLOWED.iter().any(|&(place, of, _)| path.starts_with(place) && (of.is_empty() || of == pattern))
}

/// Words hold a letter: numbers, signs and symbols are none.
fn words(sentence: &str) -> usize {
    sentence.split_whitespace().filter(|word| word.chars().filter(|c| c.is_alphabetic()).count() > 1).count()
}

fn around(text: &str, place: std::ops::Range<usize>) -> &str {
    let start = text[..place.start].char_indices().rev().nth(30).map_or(0, |(at, _)| at);
    let end = text[place.end..].char_indices().nth(40).map_or(text.len(), |(at, _)| place.end + at);
    &text[start..end]
}
