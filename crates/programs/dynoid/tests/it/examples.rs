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

/// The book prints each example whole, below its attributes.
#[test]
fn exact_the_cookbook_prints_the_examples() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in ["study", "verdict", "fit", "export", "convert"] {
        let example = std::fs::read_to_string(root.join(format!("examples/{name}.rs"))).unwrap();
        let code = &example[example.find("\nuse ").unwrap() + 1..];
        let page = std::fs::read_to_string(root.join(format!("../../../docs/src/cookbook/{name}.md"))).unwrap();
        assert!(
            page.contains(&format!("```rust\n{code}```\n")),
            "docs/src/cookbook/{name}.md: another text than the example"
        );
    }
}

/// The README prints the example of the crate's documentation, which is compiled.
#[test]
fn exact_the_readme_prints_the_example_of_the_documentation() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let library = std::fs::read_to_string(root.join("src/lib.rs")).unwrap();
    let readme = std::fs::read_to_string(root.join("../../../README.md")).unwrap();
    let printed = readme.split_once("```rust\n").unwrap().1.split_once("```").unwrap().0;
    let compiled: Vec<&str> = library.lines().filter_map(|line| line.strip_prefix("//! ")).collect();
    let missing: Vec<&str> = printed.lines().filter(|line| !line.is_empty() && !compiled.contains(line)).collect();
    assert!(printed.lines().count() > 5 && missing.is_empty(), "{missing:?}");
}
