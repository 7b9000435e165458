//! Results are written whole or not at all, under the one rule of each run.

use dynoid::{Error, Files, check_replaceable, replace_file};

const PAGE: &str = "<meta name=\"generator\" content=\"";

#[test]
fn exact_two_runs_in_one_process_do_not_know_of_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("notes.txt");
    std::fs::write(&path, "mine").unwrap();
    let (reader, writer) = (Files::new("reader", true), Files::new("writer", true));
    assert_eq!(reader.read_text(&path, "text").unwrap(), "mine");
    assert!(matches!(replace_file(&path, b"new", &reader), Err(Error::IsRead { .. })));
    replace_file(&path, b"new", &writer).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
}

#[test]
fn exact_a_run_replaces_the_results_of_its_own_maker_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    let page = |files: &Files| format!("{PAGE}{}\">", files.generator());
    let (fleet, other) = (Files::new("fleet report", false), Files::new("other", false));
    replace_file(&path, page(&fleet).as_bytes(), &fleet).unwrap();
    replace_file(&path, page(&fleet).as_bytes(), &fleet).unwrap();
    let refused = replace_file(&path, page(&other).as_bytes(), &other).unwrap_err();
    assert!(matches!(&refused, Error::Occupied { maker: Some(maker), .. } if maker == "`dynoid fleet report`"));
    assert!(!refused.to_string().contains("--"), "no option of a command line: {refused}");
    check_replaceable(&path, None, &Files::new("other", true)).unwrap();
}
