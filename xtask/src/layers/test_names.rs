//! Names of tests: each begins with a prefix that states what the test proves. The table of CONTRIBUTING.md lists them.

use std::path::Path;

use crate::folder::sources;

/// Folders of a package that have tests.
const FOLDERS: [&str; 2] = ["src", "tests"];

/// Tests of the package in a folder without a prefix.
pub(super) fn without_prefix(package: &Path, contributing: &str) -> Result<Vec<String>, String> {
    let prefixes = prefixes(contributing);
    if prefixes.is_empty() {
        return Err("CONTRIBUTING.md has no table of prefixes in its section Tests".to_owned());
    }
    let mut faults = Vec::new();
    for folder in FOLDERS.iter().map(|folder| package.join(folder)).filter(|folder| folder.is_dir()) {
        for file in sources(&folder)? {
            let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
            let unnamed = names(&text).filter(|(_, name)| !has_prefix(name, &prefixes));
            faults.extend(unnamed.map(|(line, name)| {
                format!(
                    "{}:{line}: the test `{name}` needs one of the prefixes {}",
                    file.display(),
                    prefixes.join(", ")
                )
            }));
        }
    }
    Ok(faults)
}

/// The first column of the table in the section Tests.
pub(super) fn prefixes(contributing: &str) -> Vec<&str> {
    let tests = contributing.split("\n## ").find(|section| section.starts_with("Tests\n")).unwrap_or_default();
    tests.lines().filter_map(|row| row.strip_prefix("| `")?.split('`').next()).collect()
}

fn has_prefix(name: &str, prefixes: &[&str]) -> bool {
    prefixes.iter().any(|prefix| name.starts_with(prefix))
}

/// Name of each test, and its line, from 1. Tests inside of macros count too, so this reads lines.
pub(super) fn names(source: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_test = false;
    source.lines().zip(1..).filter_map(move |(line, number)| {
        let line = line.trim_start();
        is_test |= line.starts_with("#[test]");
        let name = line.strip_prefix("fn ").filter(|_| is_test)?;
        is_test = false;
        Some((number, name.split(['(', '<']).next().unwrap_or_default()))
    })
}
