//! No line of any command is wider than the terminal.

use std::collections::BTreeSet;

use unicode_width::UnicodeWidthStr;

use crate::help::commands;
use crate::support::{Campaign, command};

const WIDTHS: [usize; 3] = [60, 80, 120];

/// A run of every command, in an order in which each finds what it reads. Some end with a message: those lines count
/// too.
const RUNS: [&str; 47] = [
    "app nowhere --no-browser",
    "init recordings --out proposed.toml --force",
    "study bench.toml",
    "study proposed.toml",
    "study mistyped.toml --out mistyped",
    "lines bench.toml",
    "torque-signals bench.toml",
    "torque-control bench.toml",
    "controller bench.toml",
    "controller noise-test bench.toml --draws 2",
    "shaft bench.toml",
    "engine bench.toml",
    "friction bench.toml",
    "can bench.toml tip-in --samples 72",
    "can bench.toml map --samples 72",
    "can bench.toml map --want 100rpm",
    "experiment list",
    "experiment list BS_T_NT",
    "experiment design bench.toml BS_T_NT --duration 4s",
    "experiment design bench.toml BS_T_NT --duration 4s --out a_rather_long_name_of_a_file_for_the_demands_of_a_bench.csv",
    "experiment check bench.toml BS_T_NT --duration 4s --samples 72",
    "experiment simulate bench.toml BS_T_NT --duration 1s --out run.mf4",
    "experiment next nowhere.toml",
    "report study/study.json",
    "diff study/model.json study/model.json",
    "export study/model.json --to c --out exported",
    "inspect recordings",
    "inspect recordings/BS_T_NT_1200.mf4",
    "convert recordings/BS_T_NT_1200.mf4 --out table.csv",
    "data spectrum table.csv -u DynoTorqueDemand -y DynoSpeed --sample-time 10ms",
    "data delay table.csv -u DynoTorqueDemand -y DynoTorqueCalc --sample-time 10ms",
    "data order table.csv -u DynoTorqueDemand -y DynoTorqueCalc --sample-time 10ms",
    "fit arx table.csv -u DynoTorqueDemand -y DynoTorqueCalc --sample-time 10ms --na 2 --nb 2 --nk 1 --out arx.json",
    "fit oe table.csv -u DynoTorqueDemand -y DynoTorqueCalc --sample-time 10ms --nb 1 --nf 1 --nk 1 --out oe.json",
    "model bode arx.json oe.json",
    "model step arx.json --table",
    "model poles arx.json oe.json study/model.json",
    "model compare arx.json oe.json --on table.csv --sample-time 10ms",
    "model residuals arx.json --on table.csv --sample-time 10ms",
    "model predict arx.json --on table.csv --sample-time 10ms",
    "model simulate arx.json --on table.csv --sample-time 10ms",
    "model convert arx.json --to ss",
    "fit arx table.csv -u DynoTorqueDemnd -y DynoTorqueCalc",
    "study a_folder_that_is_not_there/and_another_one_with_a_long_name/and_a_bench_file_in_it.toml",
    "demo --out recordings",
    "schema",
    "shell manual pages",
];

/// Commands that think for long: every day they are left to the tests of their own numbers.
const SLOW: [&str; 5] = ["torque-control ", "shaft ", "engine ", "lines ", "torque-signals "];

/// The lines that are wider than the terminal, in columns.
fn too_wide(text: &str, columns: usize) -> Vec<String> {
    text.lines().filter(|line| line.width() > columns).map(str::to_owned).collect()
}

fn run(campaign: &Campaign, arguments: &[&str], columns: usize) -> (Option<i32>, String) {
    let output = command(&campaign.path(""), arguments).env("COLUMNS", columns.to_string()).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout) + &text(&output.stderr))
}

fn check_all(columns: usize, is_run: impl Fn(&str) -> bool) {
    let campaign = Campaign::whole();
    let bench = campaign.read("bench.toml");
    campaign.write("mistyped.toml", bench.replace("DynoTorqueCalc", "DynoTorqeCalc").as_bytes());
    for line in RUNS.into_iter().filter(|line| is_run(line)) {
        let arguments: Vec<&str> = line.split(' ').collect();
        let (code, text) = run(&campaign, &arguments, columns);
        assert!(matches!(code, Some(0 | 1 | 3 | 4)), "dynoid {line}: {code:?}\n{text}");
        let wide = too_wide(&text, columns);
        assert!(wide.is_empty(), "dynoid {line} at {columns} columns: {wide:#?}");
    }
}

#[test]
fn snap_no_line_of_a_result_or_a_message_is_wider_than_the_narrowest_terminal() {
    check_all(WIDTHS[0], |line| !SLOW.iter().any(|slow| line.starts_with(slow)));
}

#[test]
#[ignore = "slow"]
fn snap_no_line_of_any_command_is_wider_than_any_terminal() {
    WIDTHS.iter().for_each(|columns| check_all(*columns, |_| true));
}

#[test]
fn snap_no_line_of_a_help_page_is_wider_than_the_terminal() {
    let campaign = Campaign::empty();
    for columns in WIDTHS {
        for command in commands() {
            let arguments: Vec<&str> = command.iter().map(String::as_str).chain(["--help"]).collect();
            let (code, text) = run(&campaign, &arguments, columns);
            // The usage of a command is one line to be read, not folded.
            let folded = text.lines().filter(|line| !line.starts_with("Usage:")).collect::<Vec<_>>().join("\n");
            let wide = too_wide(&folded, columns);
            assert!(code == Some(0) && wide.is_empty(), "dynoid {command:?} --help at {columns} columns: {wide:#?}");
        }
    }
}

#[test]
fn exact_every_command_is_run() {
    let is_run =
        |command: &&Vec<String>| RUNS.iter().any(|line| format!("{line} ").starts_with(&(command.join(" ") + " ")));
    let missing: BTreeSet<String> =
        commands().iter().filter(|command| !is_run(command)).map(|command| command.join(" ")).collect();
    assert!(
        missing.iter().all(|name| ["fit ", "help", "shell completions"].iter().any(|group| name.starts_with(group))),
        "{missing:?}"
    );
}
