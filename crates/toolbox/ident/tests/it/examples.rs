//! The worked examples of the toolbox run, and a program of somebody else's compiles against the published names.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The folder of the profile that this test was built in, such as `target/debug`.
fn profile_folder() -> PathBuf {
    let own = std::env::current_exe().unwrap();
    own.ancestors().nth(2).unwrap().to_owned()
}

fn shown(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// Each example asserts its own result. They are built by `cargo test` unless it is limited to some targets.
#[test]
fn regress_examples_run() {
    let packages = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let sources = ["signal", "lti", "ident"].map(|package| std::fs::read_dir(packages.join(package).join("examples")));
    let names = sources.into_iter().flat_map(|folder| folder.unwrap()).map(|file| file.unwrap().path());
    let (mut run, mut missing) = (0, Vec::new());
    for name in names.map(|path| path.file_stem().unwrap().to_owned()) {
        let program = profile_folder().join("examples").join(&name);
        if !program.exists() {
            missing.push(name);
            continue;
        }
        let output = Command::new(program).output().unwrap();
        assert!(output.status.success(), "{}: {}", name.display(), shown(&output));
        assert!(!output.stdout.is_empty(), "{} prints nothing", name.display());
        run += 1;
    }
    if !missing.is_empty() {
        testdata::skip(&format!("{} examples were not built", missing.len()));
    }
    assert!(run == 0 || run >= 10, "only {run} examples were built");
}

/// The program has a workspace of its own, and shares the target folder for its own builds from one run to the next.
#[test]
#[ignore = "slow: compiles the dependencies once more"]
fn regress_an_outside_program_compiles_and_runs() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join("outsider");
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(3).unwrap();
    let target = profile_folder().parent().unwrap().join("outsider");
    // The versions that the workspace has locked.
    std::fs::copy(workspace.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let output = Command::new(env!("CARGO"))
        .args(["run", "--quiet"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", target)
        .env_remove("RUSTFLAGS")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", shown(&output));
    let printed = String::from_utf8_lossy(&output.stdout);
    for expected in ["ARX model in discrete time", "State-space model of order 1", "u2 to y1", "white residuals: "] {
        assert!(printed.contains(expected), "`{expected}` is missing in\n{printed}");
    }
}
