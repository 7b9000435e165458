//! Colour, quiet, closed pipes.

use std::io::Read;
use std::process::Stdio;

use crate::support::{Campaign, bs, command};

#[test]
fn snap_a_pipe_gets_no_escape_codes() {
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &bs());
    let ran = campaign.run(&["inspect", "recordings/BS_T_NT_1200.mf4"]);
    assert_eq!(ran.code, Some(0));
    assert!(!ran.stdout.contains('\u{1b}') && !ran.stderr.contains('\u{1b}'));
    let ran = campaign.run(&["inspect", "nowhere.mf4"]);
    assert!(!ran.stderr.contains('\u{1b}'));
}

#[test]
fn snap_colour_can_be_asked_for() {
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &bs());
    let ran = campaign.run(&["inspect", "--color", "always", "recordings/BS_T_NT_1200.mf4"]);
    assert!(ran.stdout.contains("\u{1b}[1m"));
    let ran = campaign.run(&["inspect", "--color", "never", "recordings/BS_T_NT_1200.mf4"]);
    assert!(!ran.stdout.contains('\u{1b}'));
}

#[test]
fn regress_escape_codes_in_a_recording_do_not_reach_the_terminal() {
    let mut recording = bs();
    recording.channels[0].name = "Speed\u{1b}[2J\u{7}".to_owned();
    recording.comment = Some("harmless\u{1b}]0;title\u{7}".to_owned());
    let campaign = Campaign::empty().with("BS_T_NT_1200.mf4", &recording);
    let ran = campaign.run(&["inspect", "recordings/BS_T_NT_1200.mf4"]);
    assert_eq!(ran.code, Some(0));
    assert!(!ran.stdout.contains(['\u{1b}', '\u{7}']), "{}", ran.stdout);
}

#[test]
fn snap_quiet_leaves_standard_output_empty() {
    let campaign = Campaign::whole();
    let ran = campaign.run(&["study", "bench.toml", "--quiet"]);
    assert!(matches!(ran.code, Some(0 | 1)), "{}", ran.stderr);
    assert_eq!((ran.stdout.as_str(), ran.stderr.as_str()), ("", ""));
    assert_eq!(campaign.results(), ["model.json", "report.html", "study-series.parquet", "study.json"]);
}

#[test]
fn regress_a_reader_that_goes_away_is_no_fault() {
    let campaign = Campaign::empty();
    let names: Vec<String> = (0..40).map(|i| format!("BS_T_NT_{i}.csv")).collect();
    for name in &names {
        let columns: Vec<String> = (0..60).map(|i| format!("a channel with a long name, number {i}")).collect();
        let head = format!("time [s];{}\n", columns.join(";"));
        let values = "1;".repeat(59) + "2";
        campaign.write(&format!("recordings/{name}"), format!("{head}0;{values}\n1;{values}\n").as_bytes());
    }
    let folder = campaign.path("");
    let mut child = command(&folder, &["inspect", "recordings"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut first = [0_u8; 16];
    let mut stdout = child.stdout.take().expect("a pipe");
    stdout.read_exact(&mut first).expect("some output");
    drop(stdout);
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}
