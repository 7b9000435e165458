//! The help texts.

use crate::support::{Campaign, dynoid};

fn help(arguments: &[&str]) -> String {
    let ran = dynoid(&std::env::temp_dir(), arguments);
    assert_eq!(ran.code, Some(0));
    // The program's file name ends in .exe on Windows.
    ran.stdout.replace("dynoid.exe", "dynoid")
}

#[test]
fn snap_help() {
    insta::assert_snapshot!("help", help(&["--help"]));
}

#[test]
fn snap_help_of_the_whole_bench() {
    insta::assert_snapshot!("help_init", help(&["init", "--help"]));
    insta::assert_snapshot!("help_study", help(&["study", "--help"]));
    insta::assert_snapshot!("help_export", help(&["export", "--help"]));
    insta::assert_snapshot!("help_diff", help(&["diff", "--help"]));
    insta::assert_snapshot!("help_demo", help(&["demo", "--help"]));
}

#[test]
fn snap_help_of_parts() {
    insta::assert_snapshot!("help_lines", help(&["lines", "--help"]));
    insta::assert_snapshot!("help_torque_signals", help(&["torque-signals", "--help"]));
    insta::assert_snapshot!("help_torque_control", help(&["torque-control", "--help"]));
    insta::assert_snapshot!("help_controller", help(&["controller", "--help"]));
    insta::assert_snapshot!("help_controller_noise_test", help(&["controller", "noise-test", "--help"]));
    insta::assert_snapshot!("help_shaft", help(&["shaft", "--help"]));
    insta::assert_snapshot!("help_engine", help(&["engine", "--help"]));
    insta::assert_snapshot!("help_friction", help(&["friction", "--help"]));
}

#[test]
fn snap_help_of_experiments() {
    insta::assert_snapshot!("help_experiment", help(&["help", "experiment"]));
    insta::assert_snapshot!("help_experiment_design", help(&["experiment", "design", "--help"]));
    insta::assert_snapshot!("help_experiment_check", help(&["experiment", "check", "--help"]));
    insta::assert_snapshot!("help_experiment_simulate", help(&["experiment", "simulate", "--help"]));
    insta::assert_snapshot!("help_experiment_next", help(&["experiment", "next", "--help"]));
}

#[test]
fn snap_help_of_recordings_and_models() {
    insta::assert_snapshot!("help_inspect", help(&["inspect", "--help"]));
    insta::assert_snapshot!("help_convert", help(&["convert", "--help"]));
    insta::assert_snapshot!("help_data", help(&["help", "data"]));
    insta::assert_snapshot!("help_fit", help(&["help", "fit"]));
    insta::assert_snapshot!("help_model", help(&["help", "model"]));
}

/// Every command, and every command of a group.
pub(crate) fn commands() -> Vec<Vec<String>> {
    let named_in = |list: &str| -> Vec<String> {
        let lines = list.lines().filter_map(|line| line.strip_prefix("  ").filter(|rest| !rest.starts_with(' ')));
        lines.map(|line| line.split(' ').next().unwrap_or_default().to_owned()).collect()
    };
    let mut commands = Vec::new();
    for command in named_in(help(&["--help"]).split("Examples:").next().unwrap_or_default()) {
        let page = help(&["help", &command]);
        let list = page.split("Commands:\n").nth(1).and_then(|rest| rest.split("\n\n").next()).unwrap_or_default();
        let inner = named_in(list).into_iter().filter(|name| name != "help");
        commands.extend(inner.map(|name| vec![command.clone(), name]));
        commands.push(vec![command]);
    }
    commands
}

#[test]
fn exact_every_command_has_examples() {
    let commands = commands();
    assert!(commands.len() > 35, "{commands:?}");
    for command in commands {
        let words: Vec<&str> = std::iter::once("help").chain(command.iter().map(String::as_str)).collect();
        let example = format!("\n  dynoid {} ", command.join(" "));
        let page = format!("{} ", help(&words).replace('\n', " \n"));
        assert!(page.contains(&example), "{command:?}: {page}");
    }
}

#[test]
fn snap_every_shell_completes_and_every_command_has_a_manual_page() {
    let campaign = Campaign::empty();
    for shell in ["bash", "zsh", "fish", "powershell"] {
        let ran = campaign.run(&["shell", "completions", shell]);
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        assert!(["torque-signals", "noise-test", "allow-unchecked"].iter().all(|word| ran.stdout.contains(word)));
    }
    assert_eq!(campaign.run(&["shell", "manual", "man1"]).code, Some(0));
    for command in commands() {
        let page = campaign.read(&format!("man1/dynoid-{}.1", command.join("-")));
        assert!(page.contains("SYNOPSIS") && page.contains("Examples:"), "{command:?}: {page}");
    }
    assert_ne!(campaign.run(&["shell", "completions", "cobol"]).code, Some(0));
}

#[test]
fn regress_a_wrong_command_line_ends_with_code_2() {
    for arguments in [&[][..], &["estimate"], &["study"], &["demo", "--seed", "many"]] {
        assert_eq!(dynoid(&std::env::temp_dir(), arguments).code, Some(2), "{arguments:?}");
    }
}

#[test]
fn exact_a_command_that_is_not_there_leads_to_one_that_is() {
    for (line, meant) in [
        ("bode model.json", "'model bode'"),
        ("look bench.toml", "'lines'"),
        ("inverter bench.toml", "'torque-control'"),
        ("simulate bench.toml", "'experiment simulate'"),
        ("resid model.json", "'model residuals'"),
        ("studdy bench.toml", "'study'"),
        ("study run bench.toml", "dynoid study BENCH.toml"),
        ("study bench.toml --pdf letter", "--pdf=letter"),
        ("experiment run bench.toml BS_T_NT", "'experiment simulate'"),
        ("export model.json --to simulink", "--to fmu2"),
        ("export model.json --to Matlab", "--to mat"),
    ] {
        let arguments: Vec<&str> = line.split(' ').collect();
        dynoid(&std::env::temp_dir(), &arguments).assert_refused(2, &["tip:", meant]);
    }
}
