//! The help texts.

use crate::support::dynoid;

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
fn snap_help_look() {
    insta::assert_snapshot!("help_look", help(&["look", "--help"]));
}

#[test]
fn snap_help_shaft() {
    insta::assert_snapshot!("help_shaft", help(&["shaft", "--help"]));
}

#[test]
fn snap_help_torque() {
    insta::assert_snapshot!("help_torque", help(&["torque", "--help"]));
    insta::assert_snapshot!("help_inverter", help(&["inverter", "--help"]));
    insta::assert_snapshot!("help_friction", help(&["friction", "--help"]));
}

#[test]
fn snap_help_controller() {
    insta::assert_snapshot!("help_controller", help(&["controller", "--help"]));
    insta::assert_snapshot!("help_controller_study", help(&["controller", "study", "--help"]));
}

#[test]
fn snap_help_demo() {
    insta::assert_snapshot!("help_demo", help(&["demo", "--help"]));
}

#[test]
fn snap_help_study_run() {
    insta::assert_snapshot!("help_study_run", help(&["study", "run", "--help"]));
}

#[test]
fn snap_help_init() {
    insta::assert_snapshot!("help_init", help(&["init", "--help"]));
}

#[test]
fn snap_help_inspect() {
    insta::assert_snapshot!("help_inspect", help(&["inspect", "--help"]));
}

#[test]
fn snap_help_experiment() {
    insta::assert_snapshot!("help_experiment_design", help(&["experiment", "design", "--help"]));
    insta::assert_snapshot!("help_experiment_check", help(&["experiment", "check", "--help"]));
    insta::assert_snapshot!("help_simulate", help(&["simulate", "--help"]));
}

#[test]
fn a_wrong_command_line_ends_with_code_2() {
    for arguments in [&[][..], &["estimate"], &["study", "run"], &["demo", "--seed", "many"]] {
        assert_eq!(dynoid(&std::env::temp_dir(), arguments).code, Some(2), "{arguments:?}");
    }
}
