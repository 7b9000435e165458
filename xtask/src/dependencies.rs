//! The crates of others that we build on: their licences and sources, as `deny.toml` allows them.

use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use spdx::Expression;
use toml::Table;

use crate::{folder, steps};

const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// Checks licences and sources; with cargo-deny, where it is installed, all of `deny.toml`. True if security advisories
/// were looked up too.
pub(crate) fn check() -> Result<bool, String> {
    let file = folder::root().join("deny.toml");
    let text = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let rules: Table = text.parse().map_err(|error| format!("{}: {error}", file.display()))?;
    let metadata = steps::output(Command::new(env!("CARGO")).args(["metadata", "--locked", "--format-version", "1"]))?;
    let metadata: Value = serde_json::from_str(&metadata).map_err(|error| format!("cargo metadata: {error}"))?;
    let faults = faults(&metadata, &allowed(&rules)?);
    if !faults.is_empty() {
        return Err(faults.join("\n"));
    }
    let deny = || Command::new("cargo-deny").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success());
    if !deny() {
        return Ok(false);
    }
    steps::run("cargo-deny", Command::new(env!("CARGO")).args(["deny", "--workspace", "check"]))?;
    Ok(true)
}

/// The licences that `deny.toml` allows.
fn allowed(rules: &Table) -> Result<Vec<&str>, String> {
    let list = rules.get("licenses").and_then(|licences| licences.get("allow")).and_then(|list| list.as_array());
    let list = list.ok_or("deny.toml has no list licenses.allow")?;
    Ok(list.iter().filter_map(|name| name.as_str()).collect())
}

/// Crates of others with a licence that is not allowed, or from elsewhere than the registry.
fn faults(metadata: &Value, allowed: &[&str]) -> Vec<String> {
    let packages = metadata["packages"].as_array().map(Vec::as_slice).unwrap_or_default();
    let ours = metadata["workspace_root"].as_str().unwrap_or_default();
    let mut faults = Vec::new();
    for package in packages {
        let name = format!("{} {}", package["name"].as_str().unwrap_or_default(), package["version"]);
        match package["source"].as_str() {
            Some(REGISTRY) => {}
            Some(source) => faults.push(format!("{name} comes from {source}, not from the registry")),
            None if is_below(ours, package) => {}
            None => faults.push(format!("{name} comes from a folder outside the repository")),
        }
        let licence = package["license"].as_str().unwrap_or_default();
        if !is_allowed(licence, allowed) {
            faults.push(format!("{name} has the licence {licence:?}, which deny.toml does not allow"));
        }
    }
    faults
}

fn is_below(root: &str, package: &Value) -> bool {
    package["manifest_path"].as_str().is_some_and(|path| Path::new(path).starts_with(root))
}

/// Tells whether an expression such as `MIT OR Apache-2.0` can be met by allowed licences. `MIT/Apache-2.0` is an older
/// form of it.
fn is_allowed(licence: &str, allowed: &[&str]) -> bool {
    let expression = Expression::parse(&licence.replace('/', " OR "));
    expression.is_ok_and(|e| e.evaluate(|needed| allowed.contains(&needed.to_string().as_str())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_a_licence_is_allowed_if_one_of_its_choices_is() {
        let allowed = ["MIT", "Apache-2.0 WITH LLVM-exception", "BSD-3-Clause"];
        for licence in
            ["MIT", "GPL-3.0-only OR MIT", "MIT/Apache-2.0", "Apache-2.0 WITH LLVM-exception", "MIT AND BSD-3-Clause"]
        {
            assert!(is_allowed(licence, &allowed), "{licence}");
        }
        for licence in ["", "GPL-3.0-only", "Apache-2.0", "MIT AND GPL-3.0-only", "our own"] {
            assert!(!is_allowed(licence, &allowed), "{licence}");
        }
    }

    #[test]
    fn exact_a_crate_from_elsewhere_is_refused() {
        let text = r#"{"workspace_root": "/r", "packages": [
            {"name": "a", "version": "1.0.0", "license": "MIT", "source": null, "manifest_path": "/r/a/Cargo.toml"},
            {"name": "b", "version": "1.0.0", "license": "MIT", "source": "git+https://example.org/b"},
            {"name": "c", "version": "1.0.0", "license": "MIT", "source": null, "manifest_path": "/elsewhere/Cargo.toml"}]}"#;
        let found = faults(&serde_json::from_str(text).unwrap(), &["MIT"]);
        assert_eq!(found.len(), 2, "{found:?}");
    }
}
