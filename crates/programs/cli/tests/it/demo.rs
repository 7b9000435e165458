//! `dynoid demo`.

use crate::support::dynoid;

#[test]
fn stat_the_demo_finds_what_it_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let ran = dynoid(folder.path(), &["demo", "--json"]);
    let demo = ran.study();
    let rows = demo["comparison"].as_array().unwrap();
    assert_eq!(rows.len(), 9);
    let inside = rows.iter().filter(|row| row["contains_truth"] == true).count();
    // Of nine 95 % intervals, some of them of one fit, two or more miss in every tenth demo; three or more in one of a
    // hundred.
    assert!(inside >= 7, "{inside} of 9 intervals contain the truth: {}", ran.stdout);
    // Nothing is wrong with the bench.
    assert_eq!(demo["study"]["verdict"]["level"], "good", "{}", demo["study"]["findings"]);
    let files: Vec<_> = std::fs::read_dir(folder.path().join("dynoid-demo/recordings")).unwrap().collect();
    assert_eq!(files.len(), 9);
    let again = dynoid(folder.path(), &["study", "dynoid-demo/bench.toml", "--json"]).study();
    assert_eq!(again["estimates"], demo["study"]["estimates"]);
}

#[test]
fn regress_a_folder_with_other_things_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("thesis.txt"), "years of work").unwrap();
    dynoid(folder.path(), &["demo", "--out", "."]).assert_refused(4, &["thesis.txt", "--out"]);
    std::fs::write(folder.path().join("taken"), "").unwrap();
    dynoid(folder.path(), &["demo", "--out", "taken"]).assert_refused(4, &["taken", "a file of this name"]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
}
