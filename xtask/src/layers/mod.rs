//! `cargo xtask layers`: which crates may use which, and no circles among the modules of a crate.

mod cycles;
mod names;
mod rooms;
mod source;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use self::cycles::{Arrows, Cycle, Kind};

/// Checks the dependencies of all crates, and the modules in each of them.
pub(crate) fn check() -> Result<(), String> {
    let metadata = metadata()?;
    let root = crate::folder::root();
    let architecture =
        std::fs::read_to_string(root.join("ARCHITECTURE.md")).map_err(|error| format!("ARCHITECTURE.md: {error}"))?;
    let house = rooms::House::read(&architecture)?;
    let mut faults = house.faults(&metadata)?;
    faults.extend(house.floors_without_a_sign(&root));
    for room in Room::all(&metadata)? {
        faults.extend(room.cycles.iter().map(|cycle| format!("`{}`: {cycle}", room.name)));
    }
    faults.extend(tests_never_run(&metadata)?);
    if faults.is_empty() { Ok(()) } else { Err(faults.join("\n")) }
}

/// Prints, for each crate, how many modules, arrows between them and circles it has; of one crate, every circle.
pub(crate) fn graph(chosen: Option<&str>) -> Result<(), String> {
    println!(
        "{:<16} {:>8} {:>8} {:>20} {:>20}",
        "crate", "modules", "arrows", "circles of siblings", "with the parent"
    );
    for room in Room::all(&metadata()?)? {
        if chosen.is_some_and(|name| name != room.name) {
            continue;
        }
        let [siblings, parents] = [Kind::Siblings, Kind::ParentAndChildren].map(|kind| room.cycles(kind).count());
        println!("{:<16} {:>8} {:>8} {siblings:>20} {parents:>20}", room.name, room.modules, room.arrows);
        if chosen.is_some() {
            room.cycles.iter().for_each(|cycle| println!("\n{}", cycle.in_full()));
        }
    }
    Ok(())
}

/// One library or program, its modules counted and its circles found.
struct Room {
    name: String,
    modules: usize,
    arrows: usize,
    cycles: Vec<Cycle>,
}

impl Room {
    fn all(metadata: &Value) -> Result<Vec<Self>, String> {
        let root = PathBuf::from(metadata["workspace_root"].as_str().unwrap_or_default());
        let mut rooms = Vec::new();
        for package in array(&metadata["packages"]) {
            for target in array(&package["targets"]).iter().filter(|target| is_product(target)) {
                let name = target["name"].as_str().unwrap_or_default();
                let file = Path::new(target["src_path"].as_str().unwrap_or_default());
                rooms.push(Self::read(name, file, &root)?);
            }
        }
        Ok(rooms)
    }

    fn read(name: &str, file: &Path, root: &Path) -> Result<Self, String> {
        let tree = source::Tree::read(file)?;
        let arrows = Arrows::of(&tree);
        let cycles = cycles::find(&tree, &arrows, root);
        Ok(Self { name: name.to_owned(), modules: tree.modules.len(), arrows: arrows.count(), cycles })
    }

    fn cycles(&self, kind: Kind) -> impl Iterator<Item = &Cycle> {
        self.cycles.iter().filter(move |cycle| cycle.kind == kind)
    }
}

/// A library or a program, not a test, an example or a benchmark.
fn is_product(target: &Value) -> bool {
    array(&target["kind"]).iter().any(|kind| matches!(kind.as_str(), Some("lib" | "bin" | "proc-macro")))
}

/// Tests beside the code of a crate that says it has none, which saves compiling it a second time.
fn tests_never_run(metadata: &Value) -> Result<Vec<String>, String> {
    let mut faults = Vec::new();
    for target in array(&metadata["packages"]).iter().flat_map(|package| array(&package["targets"])) {
        let Some(folder) = Path::new(target["src_path"].as_str().unwrap_or_default()).parent() else { continue };
        if target["test"] == false && is_product(target) && has_tests(folder)? {
            faults.push(format!("{}: tests that never run; remove `test = false` from Cargo.toml", folder.display()));
        }
    }
    Ok(faults)
}

fn has_tests(folder: &Path) -> Result<bool, String> {
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    for entry in folder.read_dir().map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let is_source = path.extension().is_some_and(|extension| extension == "rs");
        if path.is_dir() && has_tests(&path)? {
            return Ok(true);
        }
        if is_source && std::fs::read_to_string(&path).map_err(failed)?.contains("#[test]") {
            return Ok(true);
        }
    }
    Ok(false)
}

fn array(value: &Value) -> &[Value] {
    value.as_array().map(Vec::as_slice).unwrap_or_default()
}

fn metadata() -> Result<Value, String> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1"])
        .output()
        .map_err(|error| format!("cargo metadata could not be started: {error}"))?;
    serde_json::from_slice(&output.stdout).map_err(|error| format!("cargo metadata is not JSON: {error}"))
}
