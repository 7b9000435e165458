//! Tests that were skipped for want of something outside the project: counted, never passed over in silence.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;

/// Names the file to which `testdata` adds a line for each skipped test.
const VARIABLE: &str = "DYNOID_SKIPPED";

/// The skipped tests of one run.
pub(crate) struct Skipped {
    file: PathBuf,
}

impl Skipped {
    /// Begins a run, with none skipped.
    pub(crate) fn start() -> Result<Self, String> {
        let folder = crate::folder::target()?;
        let file = folder.join("skipped.txt");
        let emptied = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&file, ""));
        emptied.map_err(|error| format!("{}: {error}", file.display()))?;
        Ok(Self { file })
    }

    /// Has the tests that a command runs write down what they skip.
    pub(crate) fn gather<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command.env(VARIABLE, &self.file)
    }

    /// How many tests were skipped, and how many for each reason.
    pub(crate) fn summary(&self) -> String {
        summary(&std::fs::read_to_string(&self.file).unwrap_or_default())
    }

    /// Prints the summary.
    pub(crate) fn print(&self) {
        println!("{}", self.summary());
    }
}

/// Lines are `reason<tab>test`. A test that lacks several things counts once, and once for each of them.
fn summary(lines: &str) -> String {
    let mut reasons: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let mut tests: Vec<&str> = Vec::new();
    for (reason, test) in lines.lines().filter_map(|line| line.split_once('\t')) {
        reasons.entry(reason).or_default().push(test);
        tests.push(test);
    }
    tests.sort_unstable();
    tests.dedup();
    if tests.is_empty() {
        return "skipped: no test".into();
    }
    let mut text = format!("skipped: {} tests", tests.len());
    for (reason, mut tests) in reasons {
        tests.sort_unstable();
        tests.dedup();
        text += &format!("\n  {reason}: {}", tests.join(", "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_each_skipped_test_counts_once() {
        assert_eq!(summary(""), "skipped: no test");
        let lines = "no Python\tb::t\nno shared x\ta::t\nno Python\ta::t\nno shared x\ta::t\n";
        assert_eq!(summary(lines), "skipped: 2 tests\n  no Python: a::t, b::t\n  no shared x: a::t");
    }
}
