//! A folder as the only argument, as when it is dropped on the program.

use std::os::unix::fs::PermissionsExt;

use crate::ended::within_a_minute;
use crate::support::{Campaign, Ran, command};

/// A program in place of the browser's: it writes down the page that it is to open.
const BROWSER: &str = "#!/bin/sh\nprintf '%s' \"$1\" > \"$OPENED.new\" && /bin/mv \"$OPENED.new\" \"$OPENED\"\n";

/// Runs the program on a folder where it finds no other programs than this browser.
fn drop_on(campaign: &Campaign, folder: &str) -> Ran {
    std::fs::create_dir_all(campaign.path("programs")).unwrap();
    campaign.write("programs/xdg-open", BROWSER.as_bytes());
    let executable = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(campaign.path("programs/xdg-open"), executable).unwrap();
    let mut command = command(&campaign.path(""), &[folder]);
    Ran::of(command.env("PATH", campaign.path("programs")).env("OPENED", campaign.path("opened")))
}

#[test]
fn exact_a_folder_with_a_bench_file_is_studied_and_its_report_opened() {
    let campaign = Campaign::whole();
    let folder = campaign.path("").display().to_string();
    let ran = drop_on(&campaign, &folder);
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""), "{}", ran.stdout);
    assert!(ran.stdout.contains("Written") && campaign.results().contains(&"report.html".to_owned()), "{}", ran.stdout);
    within_a_minute(|| campaign.path("opened").exists());
    let opened = campaign.read("opened");
    assert_eq!(std::path::Path::new(&opened), campaign.path("study/report.html"));
}

#[test]
fn exact_a_folder_of_recordings_gets_a_bench_file_to_fill_in_first() {
    let campaign = Campaign::whole();
    std::fs::rename(campaign.path("recordings"), campaign.path("-of cell 4")).unwrap();
    let ran = drop_on(&campaign, "-of cell 4");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert!(ran.stdout.contains("bench.toml"), "{}", ran.stdout);
    assert!(["bench.toml", "bench.cylinders", "fill"].iter().all(|word| ran.stderr.contains(word)), "{}", ran.stderr);
    assert!(campaign.read("-of cell 4/bench.toml").contains("files = [\"*.mf4\"]"));
    assert!(!campaign.path("opened").exists(), "there is no report to open");
}

#[test]
fn regress_a_folder_without_recordings_is_refused() {
    let campaign = Campaign::empty();
    drop_on(&campaign, "recordings").assert_refused(3, &["recordings: this folder has no recordings"]);
    assert!(!campaign.path("recordings/bench.toml").exists());
}

#[test]
fn regress_a_command_stays_one_where_a_folder_has_its_name() {
    let campaign = Campaign::empty();
    std::fs::create_dir(campaign.path("study")).unwrap();
    drop_on(&campaign, "study").assert_refused(2, &["BENCH.toml"]);
}

#[test]
fn exact_without_a_browser_the_report_is_named() {
    let campaign = Campaign::whole();
    let folder = campaign.path("").display().to_string();
    let ran = Ran::of(command(&campaign.path(""), &[&folder]).env("PATH", campaign.path("recordings")));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stderr.contains("warning: study/report.html: no browser opens the report"), "{}", ran.stderr);
}
