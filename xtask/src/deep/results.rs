//! Results of the suites: the last of each is kept, so that a deep check may be run in pieces.

use std::collections::BTreeMap;
use std::fs;

use serde::{Deserialize, Serialize};

use crate::folder;

/// The page that a person commits.
pub(super) const PAGE: &str = "docs/deep-check.md";

/// The results from which the page is written.
const FILE: &str = "xtask/deep-check.json";

/// How a suite ended.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Outcome {
    /// Date and commit.
    pub(super) run: String,
    pub(super) tests: usize,
    pub(super) failed: usize,
    pub(super) time_s: f64,
    /// Tests that were skipped, and why.
    pub(super) skipped: String,
    /// Output of its tests.
    pub(super) figures: String,
}

/// The last outcome of each suite, or none where it has never run.
pub(super) struct Results {
    suites: BTreeMap<String, Option<Outcome>>,
}

impl Outcome {
    pub(super) fn passed(&self) -> bool {
        self.failed == 0
    }
}

impl Results {
    /// The results of the suites that there are. Those of suites that have been removed are dropped.
    pub(super) fn read<'a>(suites: impl Iterator<Item = &'a str>) -> Result<Self, String> {
        let file = folder::root().join(FILE);
        let mut kept: BTreeMap<String, Outcome> = match fs::read_to_string(&file) {
            Ok(text) => serde_json::from_str(&text).map_err(|error| format!("{FILE}: {error}"))?,
            Err(_) => BTreeMap::new(),
        };
        Ok(Self { suites: suites.map(|name| (name.to_owned(), kept.remove(name))).collect() })
    }

    /// Keeps the outcome of a suite, and writes the page.
    pub(super) fn put(&mut self, suite: String, outcome: Outcome) -> Result<(), String> {
        self.suites.insert(suite, Some(outcome));
        let kept: BTreeMap<_, _> = self.suites.iter().filter(|(_, outcome)| outcome.is_some()).collect();
        let text = serde_json::to_string_pretty(&kept).map_err(|error| error.to_string())?;
        write(FILE, &(text + "\n"))?;
        write(PAGE, &self.page())
    }

    fn page(&self) -> String {
        let mut text = String::from(
            "# The deep check\n\n`cargo xtask deep` runs the slow statistical suites and writes this page. \
             `cargo xtask deep NAME` runs the suites whose name contains NAME.\n\n\
             | suite | tests | failed | time, s | last run |\n| --- | --- | --- | --- | --- |\n",
        );
        let (mut tests, mut failed, mut time_s) = (0, 0, 0.0);
        for (suite, outcome) in &self.suites {
            let Some(outcome) = outcome else {
                text += &format!("| {suite} | | | | never |\n");
                continue;
            };
            (tests, failed, time_s) = (tests + outcome.tests, failed + outcome.failed, time_s + outcome.time_s);
            let Outcome { run, tests, failed, time_s, .. } = outcome;
            text += &format!("| {suite} | {tests} | {failed} | {time_s:.0} | {run} |\n");
        }
        text += &format!("| all | {tests} | {failed} | {time_s:.0} | |\n");
        let outcomes = || self.suites.iter().filter_map(|(suite, outcome)| Some((suite, outcome.as_ref()?)));
        for (suite, outcome) in outcomes().filter(|(_, outcome)| !outcome.skipped.ends_with("no test")) {
            text += &format!("\nIn {suite}, {}\n", outcome.skipped);
        }
        text += "\n## Figures that the tests print\n";
        for (suite, outcome) in outcomes().filter(|(_, outcome)| !outcome.figures.is_empty()) {
            text += &format!("\n### {suite}\n\n```text\n{}```\n", outcome.figures);
        }
        text
    }
}

fn write(path: &str, text: &str) -> Result<(), String> {
    let (file, new) = (folder::root().join(path), folder::root().join(format!("{path}.new")));
    let written = fs::write(&new, text).and_then(|()| fs::rename(&new, &file));
    written.map_err(|error| format!("{}: {error}", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snap_the_page_has_a_row_for_each_suite() {
        let outcome = |failed, skipped: &str| Outcome {
            run: "2026-11-24, abc".into(),
            tests: 2,
            failed,
            time_s: 1.6,
            skipped: skipped.into(),
            figures: "a::t\n  94.8 %\n".into(),
        };
        let suites = [
            ("x::a", Some(outcome(0, "skipped: no test"))),
            ("x::b", Some(outcome(1, "skipped: 1 tests\n  no Python: b::t"))),
            ("x::c", None),
        ];
        let results = Results { suites: suites.map(|(name, outcome)| (name.to_owned(), outcome)).into() };
        let text = results.page();
        let rows = "| x::a | 2 | 0 | 2 | 2026-11-24, abc |\n| x::b | 2 | 1 | 2 | 2026-11-24, abc |\n\
                    | x::c | | | | never |\n| all | 4 | 1 | 3 | |\n\nIn x::b, skipped: 1 tests\n  no Python: b::t\n";
        assert!(text.contains(rows), "{text}");
        assert!(text.contains("### x::a\n\n```text\na::t\n  94.8 %\n```\n"), "{text}");
    }
}
