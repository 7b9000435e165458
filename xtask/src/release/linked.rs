//! The crates that the program links, on any of its machines.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;
use toml::Table;

use super::files::read;
use super::targets::ALL;
use crate::folder;
use crate::steps::output;

/// Name and version of a crate.
pub(super) type Id = (String, String);

/// A crate.
pub(super) struct Crate {
    pub(super) licence: String,
    pub(super) repository: Option<String>,
    /// Where its sources are.
    pub(super) folder: PathBuf,
    /// SHA-256 of its package on crates.io; none for our own crates.
    pub(super) checksum: Option<String>,
    pub(super) uses: BTreeSet<Id>,
}

/// The crates, by name and version.
pub(super) struct Linked {
    pub(super) crates: BTreeMap<Id, Crate>,
}

impl Linked {
    /// Asks cargo for the normal dependencies of the program; macros, build scripts and tests are not in it.
    pub(super) fn find() -> Result<Self, String> {
        let mut ids = BTreeSet::new();
        for target in &ALL {
            let tree = ["tree", "--locked", "--package", "dynoid-cli", "--edges", "normal,no-proc-macro", "--prefix"];
            let mut cargo = Command::new(env!("CARGO"));
            cargo.args(tree).args(["none", "--format", "{p}", "--target", target.triple]).current_dir(folder::root());
            ids.extend(output(&mut cargo)?.lines().filter_map(id_in_tree));
        }
        let mut cargo = Command::new(env!("CARGO"));
        cargo.args(["metadata", "--locked", "--format-version", "1"]).current_dir(folder::root());
        let metadata =
            serde_json::from_str(&output(&mut cargo)?).map_err(|error| format!("cargo metadata: {error}"))?;
        let lock = folder::root().join("Cargo.lock");
        let text = String::from_utf8_lossy(&read(&lock)?).into_owned();
        let lock: Table = text.parse().map_err(|error| format!("{}: {error}", lock.display()))?;
        Ok(Linked { crates: described(&ids, &metadata, &lock) })
    }
}

/// Name and version in a line such as `clap v4.6.7 (*)`.
fn id_in_tree(line: &str) -> Option<Id> {
    let mut words = line.split_whitespace();
    Some((words.next()?.to_owned(), words.next()?.strip_prefix('v')?.to_owned()))
}

fn described(ids: &BTreeSet<Id>, metadata: &Value, lock: &Table) -> BTreeMap<Id, Crate> {
    let checksums = checksums(lock);
    let packages = metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
    let by_name: BTreeMap<&str, Id> = packages.iter().map(|package| (text(&package["id"]), id_of(package))).collect();
    let uses = uses(metadata, &by_name);
    let described = |package: &Value| {
        let id = id_of(package);
        let used = uses.get(&id).into_iter().flatten().filter(|used| ids.contains(*used));
        let made = Crate {
            licence: text(&package["license"]).replace('/', " OR "),
            repository: package["repository"].as_str().map(str::to_owned),
            folder: PathBuf::from(text(&package["manifest_path"])).parent().map(PathBuf::from).unwrap_or_default(),
            checksum: checksums.get(&id).cloned(),
            uses: used.cloned().collect(),
        };
        (id, made)
    };
    packages.iter().filter(|package| ids.contains(&id_of(package))).map(described).collect()
}

/// Normal dependencies of every crate.
fn uses(metadata: &Value, by_name: &BTreeMap<&str, Id>) -> BTreeMap<Id, BTreeSet<Id>> {
    let is_normal =
        |used: &&Value| used["dep_kinds"].as_array().into_iter().flatten().any(|kind| kind["kind"].is_null());
    let of = |node: &Value| {
        let used = node["deps"].as_array().into_iter().flatten().filter(is_normal);
        let used = used.filter_map(|used| by_name.get(text(&used["pkg"])).cloned()).collect();
        Some((by_name.get(text(&node["id"]))?.clone(), used))
    };
    metadata["resolve"]["nodes"].as_array().into_iter().flatten().filter_map(of).collect()
}

fn checksums(lock: &Table) -> BTreeMap<Id, String> {
    let packages = lock.get("package").and_then(|list| list.as_array()).map(Vec::as_slice).unwrap_or_default();
    let word = |package: &toml::Value, key: &str| Some(package.get(key)?.as_str()?.to_owned());
    let checksum =
        |package: &toml::Value| Some(((word(package, "name")?, word(package, "version")?), word(package, "checksum")?));
    packages.iter().filter_map(checksum).collect()
}

fn id_of(package: &Value) -> Id {
    (text(&package["name"]).to_owned(), text(&package["version"]).to_owned())
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_crates_have_licence_checksum_and_the_linked_crates_that_they_use() {
        let metadata = serde_json::from_str(
            r#"{"packages": [
                {"id": "1", "name": "a", "version": "1.0.0", "license": "MIT/Apache-2.0", "manifest_path": "/a/Cargo.toml"},
                {"id": "2", "name": "b", "version": "2.0.0", "license": "MIT", "manifest_path": "/b/Cargo.toml"},
                {"id": "3", "name": "c", "version": "3.0.0", "license": "MIT", "manifest_path": "/c/Cargo.toml"}],
              "resolve": {"nodes": [{"id": "1", "deps": [
                {"pkg": "2", "dep_kinds": [{"kind": null}]}, {"pkg": "3", "dep_kinds": [{"kind": "dev"}]}]}]}}"#,
        );
        let lock: Table = "[[package]]\nname = \"b\"\nversion = \"2.0.0\"\nchecksum = \"12ab\"".parse().unwrap();
        let id = |name: &str, version: &str| (name.to_owned(), version.to_owned());
        let ids = BTreeSet::from([id("a", "1.0.0"), id("b", "2.0.0")]);
        let crates = described(&ids, &metadata.unwrap(), &lock);
        assert_eq!(crates.keys().cloned().collect::<BTreeSet<_>>(), ids);
        let (a, b) = (&crates[&id("a", "1.0.0")], &crates[&id("b", "2.0.0")]);
        assert_eq!((a.licence.as_str(), &a.uses), ("MIT OR Apache-2.0", &BTreeSet::from([id("b", "2.0.0")])));
        assert_eq!((a.checksum.as_deref(), b.checksum.as_deref()), (None, Some("12ab")));
    }

    #[test]
    fn exact_lines_of_the_tree_name_crates() {
        let id = |line| id_in_tree(line);
        assert_eq!(id("clap v4.6.7 (*)"), Some(("clap".to_owned(), "4.6.7".to_owned())));
        assert_eq!(id("rig v0.1.0 (/r/rig)"), Some(("rig".to_owned(), "0.1.0".to_owned())));
        assert_eq!(id(""), None);
    }
}
