use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::cycles::{self, Arrows, Kind};
use super::rooms::House;
use super::source::Tree;
use super::test_names;

/// A crate written to the build's folder, from files' names and contents.
fn written(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = crate::folder::target().unwrap().join("xtask-tests").join(name);
    for (file, text) in files {
        let path = folder.join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

/// The circles of a crate, as they are printed.
fn circles(name: &str, files: &[(&str, &str)]) -> Vec<(Kind, String)> {
    let folder = written(name, files);
    let tree = Tree::read(&folder.join("lib.rs")).unwrap();
    let found = cycles::find(&tree, &Arrows::of(&tree), Path::new(&folder));
    found.iter().map(|cycle| (cycle.kind, cycle.to_string())).collect()
}

#[test]
fn exact_a_circle_of_siblings_is_found_with_its_places() {
    let found = circles(
        "siblings",
        &[
            ("lib.rs", "mod a;\nmod b;\nmod c;\npub use a::Alpha;\npub use c::last;"),
            ("a.rs", "use crate::b::Beta;\npub struct Alpha(Beta);"),
            ("b.rs", "pub struct Beta;\nfn f() {\n    let _ = crate::a::Alpha;\n}"),
            ("c.rs", "pub fn last() { let _ = crate::b::Beta; }"),
        ],
    );
    assert_eq!(found.len(), 1);
    let text = "2 modules use one another in a circle: crate::a, crate::b\n  the shortest way around:\n    \
                crate::a -> crate::b\n      a.rs:1 crate::b::Beta\n      a.rs:2 Beta\n    \
                crate::b -> crate::a\n      b.rs:3 crate::a::Alpha";
    assert!(found[0] == (Kind::Siblings, text.into()), "{}", found[0].1);
}

#[test]
fn exact_a_re_export_leads_to_the_module_that_defines() {
    let found = circles(
        "re_export",
        &[
            ("lib.rs", "mod facade;\nmod leaf;\nmod user;\npub use facade::*;"),
            ("facade.rs", "pub use crate::leaf::Leaf;\npub use crate::user::User;"),
            ("leaf.rs", "pub struct Leaf;"),
            ("user.rs", "use crate::facade;\npub struct User(facade::Leaf);\nfn f(_: crate::Leaf) {}"),
        ],
    );
    assert!(found.is_empty(), "{}", found[0].1);
}

#[test]
fn exact_a_parent_and_its_child_may_not_use_one_another() {
    let files = [
        ("lib.rs", "mod outer;\npub use outer::Outer;"),
        ("outer/mod.rs", "mod inner;\npub struct Outer(inner::Inner);"),
        ("outer/inner.rs", "use super::*;\npub struct Inner;\nfn f(_: Option<Outer>) {}"),
    ];
    let found = circles("parent", &files);
    assert!(found.len() == 1 && found[0].0 == Kind::ParentAndChildren);
    assert!(found[0].1.contains("outer/inner.rs:3 Outer"), "{}", found[0].1);
    let apart = [files[0], ("outer/mod.rs", "mod inner;\npub use inner::Inner;\npub struct Outer;"), files[2]];
    assert!(circles("parent_apart", &apart).is_empty());
}

#[test]
fn exact_tests_are_left_out() {
    let found = circles(
        "tests_left_out",
        &[
            ("lib.rs", "mod a;\nmod b;"),
            ("a.rs", "pub fn a() {}\n#[cfg(test)]\nmod tests { use crate::b::b; }\n#[test]\nfn t() { crate::b::b(); }"),
            ("b.rs", "pub fn b() { crate::a::a() }\n#[cfg(not(test))]\nfn c() {}"),
        ],
    );
    assert!(found.is_empty(), "{}", found[0].1);
}

#[test]
fn exact_paths_in_macros_attributes_and_functions_count() {
    for (place, use_of_a) in [
        ("macro", "pub fn f() { println!(\"{}\", crate::a::A) }"),
        (
            "attribute",
            "#[derive(Serialize)]\nstruct S { #[serde(with = \"crate::a\", default = \"crate::a::A\")] x: f64 }",
        ),
        ("function", "pub fn f() { use crate::a::A; A.g() }"),
        ("renamed", "use crate::a::A as Other;\npub fn f() { Other.g() }"),
        ("super", "pub mod deep { fn f() { super::super::a::A; } }"),
    ] {
        let files = [
            ("lib.rs", "mod a;\nmod b;"),
            ("a.rs", "use crate::b;\npub const A: f64 = b::B;"),
            ("b.rs", &format!("pub const B: f64 = 1.0;\n{use_of_a}")),
        ];
        assert_eq!(circles(&format!("place_{place}"), &files).len(), 1, "{place}");
    }
}

#[test]
fn exact_a_variable_is_no_use_of_a_function_of_that_name() {
    let found = circles(
        "variable",
        &[
            ("lib.rs", "pub mod a;"),
            ("a/mod.rs", "mod fit;\npub use fit::fit;\npub struct A;\npub fn f() -> f64 { let fit = 1.0; fit }"),
            ("a/fit.rs", "pub fn fit(_: super::A) {}"),
        ],
    );
    assert!(found.is_empty(), "{}", found[0].1);
}

const TABLES: &str = "# Architecture

## Rooms

### low: the lowest

| room | what it is | may use (ours) | may not know |
| --- | --- | --- | --- |
| a | first | – | all |
| b | second | a (its names) | – |

### high: the highest

| room | what it is | may use (ours) | may not know |
| --- | --- | --- | --- |
| c | third | all | – |

## What follows
";

/// Faults of crates, each with its folder and what it uses.
fn faults(crates: &[(&str, &str, &[&str])]) -> Vec<String> {
    let package = |(name, folder, uses): &(&str, &str, &[&str])| {
        let dependencies: Vec<_> = uses.iter().map(|used| json!({"name": used, "kind": null})).collect();
        json!({"name": name, "manifest_path": format!("/x/{folder}/Cargo.toml"), "dependencies": dependencies})
    };
    let packages: Vec<_> = crates.iter().map(package).collect();
    House::read(TABLES).unwrap().faults(&json!({ "packages": packages })).unwrap()
}

#[test]
fn exact_the_tables_say_who_may_use_whom() {
    let right = [
        ("dynoid-a", "crates/low/a", &[][..]),
        ("b", "crates/low/b", &["a", "serde"]),
        ("c", "crates/high/c", &["a", "b"]),
    ];
    assert_eq!(faults(&right), Vec::<String>::new());
    let wrong = [("a", "crates/low/a", &["c", "b"][..]), ("b", "crates/high/b", &["clap"]), ("d", "crates/low/d", &[])];
    let expected = [
        "`a` uses `c` of a higher floor",
        "`a` may not use `b`",
        "`b` belongs into the folder crates/low/b",
        "`b` may not use the library `clap`",
        "crate `d` has no row in the tables of ARCHITECTURE.md",
        "ARCHITECTURE.md has a room `c`, which no crate has",
    ];
    assert_eq!(faults(&wrong), expected);
}

#[test]
fn exact_a_test_is_named_after_what_it_proves() {
    let contributing = "# Contributing\n\n## Tests\n\n| prefix | proves |\n| --- | --- |\n| `exact_` | values |\n\n## Code\n\n| `other` |\n";
    assert_eq!(test_names::prefixes(contributing), ["exact_"]);
    let mark = "#[test]";
    let source = format!(
        "fn helper() {{}}\n\n{mark}\nfn exact_a() {{}}\n\nproptest! {{\n    {mark}\n    #[ignore]\n    fn b(x in 0..2) {{}}\n}}\n"
    );
    assert_eq!(test_names::names(&source).collect::<Vec<_>>(), [(4, "exact_a"), (9, "b")]);
    let faults = test_names::without_prefix(&written("unnamed", &[("src/lib.rs", &source)]), contributing).unwrap();
    assert!(matches!(&faults[..], [one] if one.contains("lib.rs:9: the test `b`")), "{faults:?}");
}
