//! `cargo xtask layers`: which crates may use which, no circles among the modules of a crate, and names of tests.

mod cycles;
mod names;
mod rooms;
mod source;
mod test_names;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use self::cycles::{Arrows, Cycle, Kind};

/// Checks the dependencies of all crates, the modules in each of them, and the names of their tests.
pub(crate) fn check() -> Result<(), String> {
    let metadata = metadata()?;
    let root = crate::folder::root();
    let document = |name| std::fs::read_to_string(root.join(name)).map_err(|error| format!("{name}: {error}"));
    let house = rooms::House::read(&document("ARCHITECTURE.md")?)?;
    let mut faults = house.faults(&metadata)?;
    faults.extend(house.floors_without_a_sign(&root));
    for room in Room::all(&metadata)? {
        faults.extend(room.cycles.iter().map(|cycle| format!("`{}`: {cycle}", room.name)));
    }
    faults.extend(tests_never_run(&metadata)?);
    let manifests = array(&metadata["packages"]).iter().filter_map(|package| package["manifest_path"].as_str());
    for package in manifests.filter_map(|manifest| Path::new(manifest).parent()) {
        faults.extend(test_names::without_prefix(package, &document("CONTRIBUTING.md")?)?);
    }
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
    for file in crate::folder::sources(folder)? {
        if std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?.contains("#[test]") {
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
