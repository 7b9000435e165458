//! Plain English: the worst patterns of wording, counted in everything that people read.
//!
//! Each room (a crate, or a folder of documents) has a ceiling for each pattern, recorded in `wording.json`. A room may
//! not exceed its ceiling. A ceiling above the count fails too, so that the ceilings only fall. A pattern without an
//! entry is at zero.

mod expression;
mod patterns;
mod texts;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use patterns::Finding;

/// Ceilings by room and pattern.
type Ceilings = BTreeMap<String, BTreeMap<String, usize>>;

/// Compares the counts with the recorded ceilings.
pub(crate) fn check() -> Result<(), String> {
    let findings = findings()?;
    let recorded = recorded()?;
    let complaints = complaints(&findings, &recorded);
    if complaints.is_empty() {
        println!("wording: {} places are left to rewrite", findings.len());
        return Ok(());
    }
    Err(complaints.join("\n"))
}

/// Prints each finding whose path contains `filter`, or whose pattern it names, with a suggestion.
pub(crate) fn list(filter: &str) -> Result<(), String> {
    for finding in findings()? {
        if finding.path.contains(filter) || finding.pattern.name == filter {
            println!("{finding}");
        }
    }
    Ok(())
}

/// Records the present counts as ceilings. No pattern may become more frequent in the whole project.
pub(crate) fn record() -> Result<(), String> {
    let present = counts(&findings()?);
    let recorded = recorded()?;
    let (before, after) = (totals(&recorded), totals(&present));
    for (pattern, &count) in &after {
        let ceiling = before.get(pattern).copied().unwrap_or(0);
        if count > ceiling && !before.is_empty() {
            return Err(format!("{pattern}: {count} places, {ceiling} were recorded; reword the new ones first"));
        }
    }
    let text = serde_json::to_string_pretty(&present).map_err(|error| error.to_string())?;
    fs::write(ceilings_path(), text + "\n").map_err(|error| format!("{}: {error}", ceilings_path().display()))
}

fn findings() -> Result<Vec<Finding>, String> {
    let root = root();
    let mut findings = Vec::new();
    for path in texts::files(&root)? {
        let name = path.strip_prefix(&root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
        let content = fs::read_to_string(&path).map_err(|error| format!("{name}: {error}"))?;
        for text in texts::of_file(&name, &content)? {
            findings.extend(patterns::find(&name, &text));
        }
        findings.extend(patterns::unmerged(&name, &content));
        if name.ends_with(".rs") {
            findings.extend(patterns::lines(&name, &content));
        }
    }
    Ok(findings)
}

fn complaints(findings: &[Finding], recorded: &Ceilings) -> Vec<String> {
    let present = counts(findings);
    let of = |ceilings: &Ceilings, room: &str, pattern: &str| {
        ceilings.get(room).and_then(|patterns| patterns.get(pattern)).copied().unwrap_or(0)
    };
    let mut complaints = Vec::new();
    for (room, patterns) in &present {
        for (pattern, &count) in patterns {
            let ceiling = of(recorded, room, pattern);
            if count > ceiling {
                let mut places = findings.iter().filter(|f| f.room() == *room && f.pattern.name == pattern.as_str());
                let shown: Vec<String> = places.by_ref().take(8).map(|finding| format!("  {finding}")).collect();
                complaints.push(format!(
                    "{room}: {pattern} in {count} places, at most {ceiling} allowed; \
                     `cargo xtask wording {room}` lists all\n{}",
                    shown.join("\n")
                ));
            }
        }
    }
    for (room, patterns) in recorded {
        for (pattern, &ceiling) in patterns {
            let count = of(&present, room, pattern);
            if count < ceiling {
                complaints.push(format!(
                    "{room}: {pattern} has fallen to {count}, but {ceiling} is recorded; run `cargo xtask wording --record`"
                ));
            }
        }
    }
    complaints
}

fn counts(findings: &[Finding]) -> Ceilings {
    let mut counts = Ceilings::new();
    for finding in findings {
        let room = counts.entry(finding.room().to_owned()).or_default();
        *room.entry(finding.pattern.name.to_owned()).or_default() += 1;
    }
    counts
}

fn totals(ceilings: &Ceilings) -> BTreeMap<&str, usize> {
    let mut totals = BTreeMap::new();
    for (pattern, count) in ceilings.values().flatten() {
        *totals.entry(pattern.as_str()).or_default() += count;
    }
    totals
}

fn recorded() -> Result<Ceilings, String> {
    let path = ceilings_path();
    if !path.exists() {
        return Ok(Ceilings::new());
    }
    let text = fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    serde_json::from_str(&text).map_err(|error| format!("{}: {error}", path.display()))
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(".")).to_path_buf()
}

fn ceilings_path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("wording.json")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_markdown(path: &str, text: &str) -> Vec<Finding> {
        let texts = texts::of_file(path, text).unwrap_or_default();
        texts.iter().flat_map(|text| patterns::find(path, text)).collect()
    }

    #[test]
    fn exact_a_room_may_neither_exceed_its_ceiling_nor_keep_one_that_is_too_high() {
        let one = in_markdown("docs/a.md", "The delay is told by a step.\n");
        let ceilings = |count| Ceilings::from([("docs".to_owned(), BTreeMap::from([("told".to_owned(), count)]))]);
        assert_eq!(one.len(), 1);
        assert!(complaints(&one, &ceilings(1)).is_empty());
        assert!(complaints(&one, &ceilings(0))[0].contains("docs/a.md:1"));
        assert!(complaints(&one, &ceilings(2))[0].contains("has fallen to 1"));
        assert!(complaints(&[], &Ceilings::new()).is_empty());
    }

    #[test]
    fn exact_rust_strings_and_docs_are_read_and_comments_are_not() {
        let source =
            "//! It tells the delay.\n// told\nfn f() {\n    // untold\n    g(\"cannot be \\\n     told\");\n}\n";
        let found = in_markdown("crates/toolbox/lti/src/a.rs", source);
        let lines: Vec<usize> = found.iter().map(|finding| finding.line).collect();
        assert_eq!(lines, [1, 5]);
        assert_eq!(found[0].room(), "lti");
    }

    #[test]
    fn exact_a_doc_comment_begins_with_what_a_thing_is() {
        let of = |path: &str, source: &str| -> Vec<(usize, &str)> {
            in_markdown(path, source).iter().map(|finding| (finding.line, finding.pattern.name)).collect()
        };
        let source = "//! What a room holds.\n\n/// Whether it is\n/// open.\nconst A: bool = true;\n// What it is.\nconst B: &str = \"What?\";\n";
        assert_eq!(of("crates/toolbox/lti/src/a.rs", source), [(1, "what first"), (3, "what first")]);
        let right = "//! Content of a room: what it holds.\n\n/// Tells whether it is open.\nfn is_open() {}\n";
        assert!(of("crates/toolbox/lti/src/a.rs", right).is_empty());
        assert_eq!(of("crates/toolbox/lti/src/a.rs", "/// Open: it tells whether.\nfn f() {}\n"), [(1, "told")]);
        let help = "struct A {\n    /// What to export to\n    to: u8,\n}\n";
        assert_eq!(of("crates/bench/export/src/a.rs", help), [(2, "what first")]);
        assert!(of("crates/programs/cli/src/cli/export.rs", help).is_empty());
        assert!(of("docs/a.md", "What a room holds.\n").is_empty());
    }

    #[test]
    fn exact_lines_of_comments_have_at_most_120_columns() {
        let comment = |columns: usize| format!("/// {}\n", "τ".repeat(columns - 4));
        let source = format!(
            "{}{}    // {}\nconst A: &str = \"{}\";\n",
            comment(120),
            comment(121),
            "a".repeat(120),
            "a".repeat(200)
        );
        let lines: Vec<usize> =
            patterns::lines("crates/toolbox/lti/src/a.rs", &source).iter().map(|f| f.line).collect();
        assert_eq!(lines, [2, 3]);
    }

    #[test]
    fn exact_an_unfinished_merge_is_found() {
        let page = "one\n<<<<<<< HEAD\ntwo\n=======\nthree\n>>>>>>> branch\n";
        let lines: Vec<usize> = patterns::unmerged("docs/src/a.md", page).iter().map(|finding| finding.line).collect();
        assert_eq!(lines, [2, 6]);
        assert!(patterns::unmerged("docs/src/a.md", "Title\n=======\n> quoted\n").is_empty());
    }

    #[test]
    fn exact_the_parts_of_a_constant_have_names() {
        let source = "const A: (f64, f64) = (1.0, 2.0);\nconst B: f64 = 1.0;\nstruct C;\n    pub(super) const D: (usize, f64) =\n        (1, 2.0);\nlet e: (f64, f64) = A;\nconst F: [(f64, f64); 1] = [A];\n";
        let found = patterns::lines("crates/toolbox/lti/src/a.rs", source);
        let found: Vec<_> = found.iter().map(|finding| (finding.line, finding.pattern.name)).collect();
        assert_eq!(found, [(1, "tuple constant"), (4, "tuple constant")]);
    }

    #[test]
    fn exact_long_sentences_are_counted_without_code_and_tables() {
        let long = "word ".repeat(26);
        assert_eq!(in_markdown("README.md", &format!("Short one.\n{long}\nend.\n"))[0].pattern.name, "long sentence");
        assert!(in_markdown("README.md", &format!("```\n{long}\n```\n")).is_empty());
        assert!(
            in_markdown("README.md", &format!("`{long}` is code.\n\n{}", "- six words in this item\n".repeat(6)))
                .is_empty()
        );
        let options = "  --quick  so few samples\n".repeat(8);
        assert!(in_markdown("crates/toolbox/lti/src/a.rs", &format!("const HELP: &str = {options:?};\n")).is_empty());
    }
}
