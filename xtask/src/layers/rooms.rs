//! The rule of rooms: which of our crates each crate may use, read from `cargo metadata`.

use serde_json::Value;

/// Crate, and the crates of ours it may use. The table of ARCHITECTURE.md.
const MAY_USE: &[(&str, &[&str])] = &[
    ("numerics", &[]),
    ("signal", &["numerics"]),
    ("lti", &["numerics", "signal"]),
    ("ident", &["numerics", "signal", "lti"]),
    ("mdf", &[]),
    ("recording", &["mdf"]),
    ("units", &["recording"]),
    ("cycle", &["units"]),
    ("dataset", &["recording", "signal", "ident", "units"]),
    ("rig", &["recording", "numerics", "signal", "ident", "units"]),
    ("bench-model", &["rig", "numerics", "signal", "lti", "ident", "units"]),
    ("export", &["bench-model", "rig", "numerics", "signal", "lti", "ident", "units"]),
    ("virtual-bench", &["rig", "bench-model", "recording", "numerics", "signal", "lti", "units"]),
    ("part-controller", &["rig", "numerics", "signal", "ident", "units"]),
    ("part-torque", &["rig", "bench-model", "part-controller", "numerics", "signal", "lti", "ident", "units"]),
    ("part-shaft", &["rig", "part-controller", "part-torque", "numerics", "signal", "lti", "ident", "units"]),
    ("part-engine", &["rig", "part-controller", "part-torque", "part-shaft", "numerics", "signal", "ident"]),
    ("part-friction", &["rig", "part-torque", "numerics", "signal", "lti", "ident", "units"]),
    ("part-lines", &["rig", "bench-model", "numerics", "signal", "ident"]),
    ("capability", &["cycle", "design", "rig", "bench-model", "numerics", "signal", "units"]),
    ("design", &["rig", "bench-model", "numerics", "signal", "units"]),
    ("study", STUDY),
    ("effects", &["study", "virtual-bench", "part-lines", "rig", "recording", "signal", "ident", "units"]),
    ("page", &[]),
    ("toolbox-report", &["signal", "lti", "ident", "dataset", "page"]),
    ("report", REPORT),
    ("dynoid", DYNOID),
    ("testdata", &[]),
    ("bench-testkit", &["numerics", "rig", "bench-model", "virtual-bench", "recording", "signal", "testdata"]),
    ("foreign-bench", &["recording"]),
    ("testkit", &["numerics", "signal", "lti", "ident"]),
    ("xtask", &[]),
];

/// Crates that the study may use: it sees the whole chain.
const STUDY: &[&str] = &[
    "recording",
    "numerics",
    "signal",
    "units",
    "rig",
    "bench-model",
    "virtual-bench",
    "part-controller",
    "part-torque",
    "part-shaft",
    "part-engine",
    "part-friction",
    "part-lines",
    "design",
];

/// Crates that reports may use: those whose results they show.
const REPORT: &[&str] = &[
    "recording",
    "dataset",
    "units",
    "rig",
    "bench-model",
    "virtual-bench",
    "part-controller",
    "part-torque",
    "part-shaft",
    "part-engine",
    "part-friction",
    "part-lines",
    "design",
    "cycle",
    "capability",
    "study",
    "effects",
    "page",
];

/// The program may use all.
const DYNOID: &[&str] = &[
    "numerics",
    "signal",
    "lti",
    "ident",
    "recording",
    "dataset",
    "units",
    "rig",
    "bench-model",
    "virtual-bench",
    "part-controller",
    "part-torque",
    "part-shaft",
    "part-engine",
    "part-friction",
    "part-lines",
    "design",
    "cycle",
    "capability",
    "study",
    "effects",
    "page",
    "toolbox-report",
    "report",
    "export",
];

/// Crates that write files, print, or serve, and who alone may use them.
const RESERVED: &[(&str, &[&str])] = &[
    ("clap", &["dynoid"]),
    ("indicatif", &["dynoid"]),
    ("tempfile", &["dynoid"]),
    ("hdf5-pure", &["recording"]),
    ("parquet", &["recording"]),
    ("rayon", &["mdf", "numerics"]),
    ("resvg", &["page"]),
];

/// Breaches of either table. Dependencies of tests are free.
pub(super) fn faults(metadata: &Value) -> Result<Vec<String>, String> {
    let packages = metadata["packages"].as_array().ok_or("cargo metadata lists no packages")?;
    let mut faults = Vec::new();
    for package in packages {
        let name = room(package["name"].as_str().unwrap_or_default());
        let Some((_, allowed)) = MAY_USE.iter().find(|(room, _)| *room == name) else {
            faults.push(format!("crate `{name}` has no row in the table of rooms"));
            continue;
        };
        for used in dependencies(package) {
            let ours = MAY_USE.iter().any(|(room, _)| *room == used);
            if ours && !allowed.contains(&used) {
                faults.push(format!("`{name}` may not use `{used}`"));
            }
            if RESERVED.iter().any(|(library, owners)| *library == used && !owners.contains(&name)) {
                faults.push(format!("`{name}` may not use the library `{used}`"));
            }
        }
    }
    Ok(faults)
}

fn dependencies(package: &Value) -> Vec<&str> {
    let all = package["dependencies"].as_array().map(Vec::as_slice).unwrap_or_default();
    let is_dev = |d: &Value| d["kind"].as_str() == Some("dev");
    all.iter().filter(|d| !is_dev(d)).filter_map(|d| d["name"].as_str().map(room)).collect()
}

/// The room of a package: published ones carry the project's name before their own.
fn room(package: &str) -> &str {
    package.strip_prefix("dynoid-").unwrap_or(package)
}
