//! The licences of all crates in the program, with their texts.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use super::files::read;
use super::linked::{Crate, Linked};

/// The name of the list.
pub(super) const FILE: &str = "THIRD-PARTY.txt";
/// Beginnings of the names of files with licences.
const NAMES: [&str; 6] = ["license", "licence", "copying", "copyright", "notice", "unlicense"];
/// Endings of sources, which may have such names too.
const SOURCES: [&str; 5] = ["rs", "c", "h", "py", "toml"];
const RULE: &str = "--------------------------------------------------------------------------------";
const HEAD: &str = "\
Crates of others in the program dynoid
======================================

The licences of dynoid itself are in LICENSE-MIT and LICENSE-APACHE. Beside the
crates below, the program contains the standard library of Rust (MIT OR
Apache-2.0, Copyright The Rust Project Contributors). On Linux it contains musl
too (MIT, Copyright 2005-2020 Rich Felker, et al.). On Windows it contains the
start-up code of mingw-w64 (Zope Public License 2.1, Copyright the mingw-w64
project). On both it contains libunwind of LLVM (Apache-2.0 WITH LLVM-exception).

";

/// The list: each crate with its licence, then each text once with the crates that have it.
pub(super) fn text(linked: &Linked) -> Result<String, String> {
    let others = || linked.crates.iter().filter(|(_, one)| one.checksum.is_some());
    let mut list = HEAD.to_owned();
    for ((name, version), one) in others() {
        let _ = writeln!(list, "{name} {version}: {}", one.licence);
    }
    let mut texts: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut without = Vec::new();
    for ((name, version), one) in others() {
        let found = texts_of(one)?;
        if found.is_empty() {
            without.push(format!("{name} {version}: {}", one.licence));
        }
        found.into_iter().for_each(|text| {
            texts.entry(text).or_default().insert(format!("{name} {version}"));
        });
    }
    if !without.is_empty() {
        let _ = writeln!(list, "\nThe packages of these crates have no text of their licence:\n");
        without.iter().for_each(|line| list.push_str(&format!("{line}\n")));
    }
    let mut sections: Vec<(BTreeSet<String>, String)> =
        texts.into_iter().map(|(text, crates)| (crates, text)).collect();
    sections.sort();
    for (crates, text) in sections {
        let crates = crates.into_iter().collect::<Vec<_>>().join(", ");
        let _ = writeln!(list, "\n{RULE}\n{crates}\n{RULE}\n\n{text}");
    }
    Ok(list)
}

/// Texts in the folder of a crate and in the folders below it, such as those of a C library.
fn texts_of(one: &Crate) -> Result<BTreeSet<String>, String> {
    let mut files = Vec::new();
    gather(&one.folder, 2, &mut files)?;
    let text = |file: &PathBuf| {
        let text = String::from_utf8_lossy(&read(file)?).replace('\r', "");
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        Ok(lines.join("\n").trim_matches('\n').to_owned())
    };
    files.iter().map(text).collect()
}

fn gather(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}; run `cargo fetch`", folder.display());
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.is_dir() && depth > 0 {
            gather(&path, depth - 1, files)?;
        } else if path.is_file() && is_licence(&path) {
            files.push(path);
        }
    }
    Ok(())
}

fn is_licence(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_source = path.extension().is_some_and(|ending| SOURCES.iter().any(|source| ending == *source));
    !is_source && NAMES.iter().any(|beginning| name.starts_with(beginning))
}

#[cfg(test)]
mod tests {
    use super::super::linked::Id;
    use super::*;

    #[test]
    fn exact_files_with_licences_are_known_by_their_names() {
        let found = ["LICENSE-MIT", "license.txt", "COPYING", "UNLICENSE", "LICENSE.md"];
        assert!(found.iter().all(|name| is_licence(Path::new(name))));
        assert!(!["README.md", "licences.rs", "Cargo.toml"].iter().any(|name| is_licence(Path::new(name))));
    }

    #[test]
    fn exact_a_text_of_two_crates_is_there_once() {
        let folder = std::env::temp_dir().join(format!("dynoid-licences-{}", std::process::id()));
        fs::create_dir_all(folder.join("c")).unwrap();
        fs::write(folder.join("c/COPYING"), "As is. \r\n").unwrap();
        let one = |folder: &Path| Crate {
            licence: "MIT".to_owned(),
            repository: None,
            folder: folder.to_owned(),
            checksum: Some(String::new()),
            uses: BTreeSet::new(),
        };
        let id = |name: &str| -> Id { (name.to_owned(), "1.0.0".to_owned()) };
        let crates = BTreeMap::from([(id("a"), one(&folder)), (id("b"), one(&folder))]);
        let text = text(&Linked { crates });
        fs::remove_dir_all(&folder).unwrap();
        let text = text.unwrap();
        assert!(text.ends_with(&format!("b 1.0.0: MIT\n\n{RULE}\na 1.0.0, b 1.0.0\n{RULE}\n\nAs is.\n")), "{text}");
    }
}
