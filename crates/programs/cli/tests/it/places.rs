//! Outputs that are links, protected files or pipes.

use std::fs::Permissions;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

use crate::identify::{folder, run};
use crate::support::Ran;

const FIT: &str = "fit arx run.csv -u valve -y speed --na 2 --nb 2 --nk 1";

fn mode(path: &Path) -> u32 {
    path.metadata().unwrap().permissions().mode() & 0o777
}

fn is_link(path: &Path) -> bool {
    path.symlink_metadata().unwrap().is_symlink()
}

#[track_caller]
fn done(ran: &Ran) {
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
}

#[test]
fn regress_a_link_stays_and_its_file_gets_the_result() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir(at("elsewhere")).unwrap();
    done(&run(&folder, &format!("{FIT} --out elsewhere/model.json")));
    std::fs::set_permissions(at("elsewhere/model.json"), Permissions::from_mode(0o600)).unwrap();
    let before = std::fs::read(at("elsewhere/model.json")).unwrap();
    symlink("elsewhere/model.json", at("second.json")).unwrap();
    symlink("second.json", at("first.json")).unwrap();
    done(&run(&folder, "fit arx run.csv -u valve -y speed --na 1 --nb 1 --nk 1 --out first.json"));
    assert!(is_link(&at("first.json")) && is_link(&at("second.json")));
    assert!(std::fs::read(at("elsewhere/model.json")).unwrap() != before, "the file behind both links is the new one");
    assert_eq!(mode(&at("elsewhere/model.json")), 0o600, "the mode stays");
    // A link to a file that is not there yet.
    symlink("elsewhere/new.mf4", at("link.mf4")).unwrap();
    done(&run(&folder, "convert run.csv --out link.mf4"));
    assert!(is_link(&at("link.mf4")) && at("elsewhere/new.mf4").is_file());
    // Among several files.
    done(&run(&folder, "shell manual man1"));
    std::fs::rename(at("man1/dynoid-study.1"), at("elsewhere/page.1")).unwrap();
    symlink("../elsewhere/page.1", at("man1/dynoid-study.1")).unwrap();
    done(&run(&folder, "shell manual man1"));
    assert!(is_link(&at("man1/dynoid-study.1")) && at("elsewhere/page.1").is_file());
    assert_eq!(std::fs::read_dir(at("elsewhere")).unwrap().count(), 3, "nothing else is left");
}

#[test]
fn regress_links_that_lead_nowhere_are_refused() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    symlink("b.json", at("a.json")).unwrap();
    symlink("a.json", at("b.json")).unwrap();
    run(&folder, &format!("{FIT} --out a.json")).assert_refused(4, &["a.json", "leads back to itself"]);
    symlink("nowhere/model.json", at("c.json")).unwrap();
    run(&folder, &format!("{FIT} --out c.json"))
        .assert_refused(4, &["nowhere/model.json", "the folder does not exist"]);
    assert!(["a.json", "b.json", "c.json"].iter().all(|name| is_link(&at(name))));
}

#[test]
fn regress_a_link_to_a_file_that_is_not_ours_is_as_the_file() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("package.json"), "{}").unwrap();
    symlink("package.json", at("model.json")).unwrap();
    run(&folder, &format!("{FIT} --out model.json")).assert_refused(4, &["model.json", "--overwrite"]);
    assert_eq!(std::fs::read_to_string(at("package.json")).unwrap(), "{}");
    symlink("run.csv", at("a.csv")).unwrap();
    run(&folder, "convert run.csv --overwrite --out a.csv").assert_refused(2, &["a.csv", "this file is read"]);
}

#[test]
fn regress_a_protected_file_is_replaced_only_on_request() {
    let folder = folder();
    let path = folder.path().join("model.json");
    done(&run(&folder, &format!("{FIT} --out model.json")));
    let before = std::fs::read(&path).unwrap();
    std::fs::set_permissions(&path, Permissions::from_mode(0o444)).unwrap();
    let other = "fit arx run.csv -u valve -y speed --na 1 --nb 1 --nk 1 --out model.json";
    run(&folder, other).assert_refused(4, &["model.json", "read-only", "--overwrite"]);
    assert!(std::fs::read(&path).unwrap() == before);
    done(&run(&folder, &format!("{other} --overwrite")));
    assert!(std::fs::read(&path).unwrap() != before);
    assert_eq!(mode(&path), 0o444);
}

fn with_pipe(name: &str) -> TempDir {
    let folder = folder();
    assert!(Command::new("mkfifo").arg(folder.path().join(name)).status().unwrap().success());
    folder
}

#[test]
fn regress_the_reader_of_a_pipe_gets_the_whole_result() {
    let folder = with_pipe("pipe.json");
    let pipe = folder.path().join("pipe.json");
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read(pipe).unwrap()
    });
    done(&run(&folder, &format!("{FIT} --out pipe.json")));
    done(&run(&folder, &format!("{FIT} --out file.json")));
    assert!(reader.join().unwrap() == std::fs::read(folder.path().join("file.json")).unwrap());
    assert!(!pipe.metadata().unwrap().is_file(), "the pipe stays one");
}

#[test]
fn regress_a_pipe_without_a_reader_is_refused() {
    let folder = with_pipe("pipe.json");
    run(&folder, &format!("{FIT} --out pipe.json")).assert_refused(4, &["pipe.json", "no program reads", "start"]);
}
