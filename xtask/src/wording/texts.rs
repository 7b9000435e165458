//! Texts that people read: documents, string literals, doc comments, texts of pages.

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::LazyLock;

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use regex_lite::Regex;

use super::expression::compiled;

static CODE: LazyLock<Regex> = LazyLock::new(|| compiled("`[^`]*`"));
/// A line with a gap inside: an option with its meaning, or a value with its comment.
static COLUMNS: LazyLock<Regex> = LazyLock::new(|| compiled(r"(?m)^(.*\S {2,}\S.*)$"));
static COMMAND: LazyLock<Regex> = LazyLock::new(|| compiled(r"(?m)^\s+(dynoid|cargo) .*$"));
static LINK: LazyLock<Regex> = LazyLock::new(|| compiled(r"!?\[([^\]]*)\]\([^)]*\)"));
static PLACEHOLDER: LazyLock<Regex> = LazyLock::new(|| compiled(r"`[^`]*`|\{[^{}]*\}"));
static QUOTED: LazyLock<Regex> = LazyLock::new(|| compiled(r#""[^"]*"|'[^']*'|`[^`]*`"#));
static TAG: LazyLock<Regex> = LazyLock::new(|| compiled("<[^<>]*>|&[a-z]+;"));

/// A passage of one file.
pub(super) struct Text {
    /// Where it begins, from 1.
    pub(super) line: usize,
    pub(super) words: String,
    /// True where the length of its sentences counts: not in doc comments of code.
    pub(super) sentences: bool,
    /// True for doc comments of code.
    pub(super) is_doc: bool,
}

/// Every file of the project that has words for people, sorted. Tests and their data are left out.
pub(super) fn files(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    gather(root, &mut found).map_err(|error| format!("{}: {error}", root.display()))?;
    found.sort();
    Ok(found)
}

fn gather(folder: &Path, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            let left_out = ["target", "dynoid-demo", "tests", "testkit", "fuzz", "node_modules", "book"];
            if !name.starts_with('.') && !left_out.contains(&name.as_str()) {
                gather(&path, found)?;
            }
        } else if name == "methods.txt" || matches!(name.rsplit('.').next(), Some("rs" | "md" | "js" | "html")) {
            found.push(path);
        }
    }
    Ok(())
}

/// The passages of a file, by its kind.
pub(super) fn of_file(name: &str, content: &str) -> Result<Vec<Text>, String> {
    match name.rsplit('.').next() {
        Some("rs") => of_rust(name, content),
        Some("md" | "txt") => Ok(vec![of_markdown(content)]),
        Some("html") => Ok(vec![Text { line: 1, words: without(&TAG, content), sentences: true, is_doc: false }]),
        _ => Ok(of_script(content)),
    }
}

fn of_rust(name: &str, content: &str) -> Result<Vec<Text>, String> {
    let tokens = TokenStream::from_str(content).map_err(|error| format!("{name}: {error}"))?;
    let mut texts = Vec::new();
    // The help of the commands is made of doc comments.
    literals(tokens, name.starts_with("crates/programs/cli/src/cli"), &mut texts);
    Ok(texts)
}

fn literals(tokens: TokenStream, docs_are_help: bool, texts: &mut Vec<Text>) {
    let mut last_doc_line = 0;
    for token in tokens {
        match token {
            TokenTree::Literal(literal) => {
                let line = literal.span().start().line;
                let words = spoken(&literal.to_string());
                if let Some(words) = words {
                    texts.push(Text {
                        line,
                        words: without(&TAG, &without(&PLACEHOLDER, &in_sentences(&words))),
                        sentences: true,
                        is_doc: false,
                    });
                }
            }
            TokenTree::Group(group) => match doc_comment(&group) {
                Some((line, words)) => {
                    let words = without(&CODE, &words);
                    match texts.last_mut().filter(|_| line == last_doc_line + 1) {
                        Some(comment) => comment.words.push_str(&format!("\n{words}")),
                        None => texts.push(Text { line, words, sentences: docs_are_help, is_doc: true }),
                    }
                    last_doc_line = line;
                }
                None => literals(group.stream(), docs_are_help, texts),
            },
            TokenTree::Ident(_) | TokenTree::Punct(_) => {}
        }
    }
}

/// The line and the words of `[doc = "…"]`.
fn doc_comment(group: &proc_macro2::Group) -> Option<(usize, String)> {
    let tokens: Vec<TokenTree> = group.stream().into_iter().collect();
    match (group.delimiter(), tokens.as_slice()) {
        (Delimiter::Bracket, [TokenTree::Ident(name), TokenTree::Punct(_), TokenTree::Literal(words)])
            if name == "doc" =>
        {
            Some((group.span_open().start().line, spoken(&words.to_string())?))
        }
        _ => None,
    }
}

/// The value of a string literal; `None` for numbers, characters and bytes.
fn spoken(literal: &str) -> Option<String> {
    syn::parse_str::<syn::LitStr>(literal).ok().map(|literal| literal.value())
}

/// Headings, items and cells end a sentence; code is one word; fenced code and formulas are none. Every line keeps its
/// place.
fn of_markdown(content: &str) -> Text {
    let mut fenced = false;
    let mut words = String::new();
    for line in content.lines() {
        let trimmed = line.trim_start();
        let fence = trimmed.starts_with("```");
        fenced ^= fence;
        let formula = trimmed.starts_with("= ");
        if !fenced && !fence && !formula {
            let own = trimmed.starts_with(['-', '#', '|', '*', '>', '!', '~'])
                || trimmed.starts_with(|c: char| c.is_ascii_digit()) && trimmed.contains(". ");
            if own && !words.is_empty() {
                words.pop();
                words.push_str(". \n");
            }
            words.push_str(&trimmed.replace('|', ". "));
        } else if !words.is_empty() {
            words.pop();
            words.push_str(". \n");
        }
        words.push('\n');
    }
    let words = without(&CODE, &words);
    Text { line: 1, words: LINK.replace_all(&words, "$1").into_owned(), sentences: true, is_doc: false }
}

fn of_script(content: &str) -> Vec<Text> {
    let quoted = |(number, line): (usize, &str)| -> Vec<Text> {
        let strings = QUOTED.find_iter(line).map(|quoted| quoted.as_str().to_owned());
        strings.map(|words| Text { line: number + 1, words, sentences: true, is_doc: false }).collect()
    };
    content.lines().enumerate().flat_map(quoted).collect()
}

/// Commands in help are no words. They end a sentence, as lines with columns do.
fn in_sentences(text: &str) -> String {
    let text = COMMAND.replace_all(text, ". ");
    COLUMNS.replace_all(&text, ". $1. ").into_owned()
}

/// With one word in place of each match.
fn without(expression: &Regex, text: &str) -> String {
    expression.replace_all(text, "x").into_owned()
}
