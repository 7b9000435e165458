//! The worked examples run.

use std::path::Path;
use std::process::Command;

/// Each example asserts its own result. They are built by `cargo test` unless it is limited to some targets.
#[test]
fn regress_examples_run() {
    let own = std::env::current_exe().unwrap();
    let built = own.ancestors().nth(2).unwrap().join("examples");
    let sources = std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")).unwrap();
    let mut missing = 0;
    for name in sources.map(|file| file.unwrap().path().file_stem().unwrap().to_owned()) {
        let program = built.join(&name);
        if !program.exists() {
            missing += 1;
            continue;
        }
        let output = Command::new(program).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !output.stdout.is_empty(), "{}: {said}", name.display());
    }
    if missing > 0 {
        testdata::skip(&format!("{missing} examples were not built"));
    }
}
