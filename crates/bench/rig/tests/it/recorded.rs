//! The recordings of two simulated benches, where they are present beside the project.

use recording::Recording;
use rig::channels::guess_roles;
use rig::{BenchFile, Finding, Role, Severity, prepare};

use bench_testkit::recordings::{BENCH_A, recordings};

const BENCH_B: [&str; 7] =
    ["nBremse", "nMotor", "nBremse_Soll", "MdBremse_Soll", "MdLuftspalt", "MdKraftdose", "MdWelle"];
const ROLES: [Role; 7] = [
    Role::DynoSpeed,
    Role::EngineSpeed,
    Role::DynoSpeedDemand,
    Role::DynoTorqueDemand,
    Role::AirGapTorque,
    Role::LoadCellTorque,
    Role::SystemShaftTorque,
];

fn check_guess(recordings: &[(String, Recording)], names: [&str; 7]) {
    let all: Vec<(&str, &Recording)> = recordings.iter().map(|(name, recording)| (name.as_str(), recording)).collect();
    let guess = guess_roles(&all);
    for (role, name) in ROLES.iter().zip(names) {
        assert_eq!(guess.choices[role].channel, name, "{role:?}");
        assert!(guess.choices[role].confidence > 0.8, "{role:?} {}", guess.choices[role].confidence);
    }
    assert_eq!((guess.choices.len(), guess.ambiguous.len()), (7, 0), "{guess:#?}");
    for single in &all {
        let guess = guess_roles(std::slice::from_ref(single));
        for (role, choice) in &guess.choices {
            let expected = ROLES.iter().position(|known| known == role).map(|index| names[index]);
            assert_eq!(Some(choice.channel.as_str()), expected, "{}: {role:?}", single.0);
        }
    }
}

fn bench_file(names: [&str; 7], limit: &str, inverted: bool) -> BenchFile {
    let mut text = format!(
        "[bench]\nname = \"x\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = 0.6\nengine_inertia = 0.2\n\
         [limits]\ntorque = \"{limit}\"\n[channels]\n"
    );
    for (role, name) in ROLES.iter().zip(names) {
        let is_dyno_torque = matches!(role, Role::DynoTorqueDemand | Role::AirGapTorque | Role::LoadCellTorque);
        let sign = if inverted && is_dyno_torque { -1 } else { 1 };
        text.push_str(&format!("{} = {{ name = \"{name}\", sign = {sign} }}\n", role.key()));
    }
    text.parse().unwrap()
}

/// Checks that clean recordings show nothing but saturation, and in NoShaft the absence of channels that are not there.
fn check_prepared(recordings: &[(String, Recording)], file: &BenchFile) {
    for (name, recording) in recordings {
        let label = file.label_of(name).unwrap();
        let (experiment, diagnostics) = prepare(name, recording, file, label.clone()).unwrap();
        let expected = if label.is_without_shaft() { 6 } else { 7 };
        assert_eq!(experiment.signals.len(), expected, "{name}: {diagnostics:#?}");
        for diagnostic in &diagnostics {
            let is_expected =
                matches!(diagnostic.finding, Finding::Saturated { .. }) || diagnostic.severity == Severity::Note;
            assert!(is_expected, "{name}: {diagnostic:#?}");
        }
        let saturated = diagnostics.iter().any(|d| matches!(d.finding, Finding::Saturated { .. }));
        let expected = label.is_without_shaft() || name.starts_with("Unfired");
        assert_eq!(saturated, expected, "{name}");
    }
}

fn check_inverted(recordings: &[(String, Recording)], file: &BenchFile) {
    for (name, recording) in recordings {
        let (_, diagnostics) = prepare(name, recording, file, file.label_of(name).unwrap()).unwrap();
        let wrong = diagnostics.iter().filter(|d| matches!(d.finding, Finding::WrongTorqueSign { .. })).count();
        assert_eq!(wrong, 3, "{name}: {diagnostics:#?}");
    }
}

#[test]
fn ref_bench_a() {
    let recordings = recordings("bench-a");
    if recordings.is_empty() {
        return;
    }
    check_guess(&recordings, BENCH_A);
    check_prepared(&recordings, &bench_file(BENCH_A, "400 Nm", false));
    check_inverted(&recordings, &bench_file(BENCH_A, "400 Nm", true));
}

#[test]
fn ref_bench_b() {
    let recordings = recordings("bench-b");
    if recordings.is_empty() {
        return;
    }
    check_guess(&recordings, BENCH_B);
    check_prepared(&recordings, &bench_file(BENCH_B, "260 Nm", false));
    check_inverted(&recordings, &bench_file(BENCH_B, "260 Nm", true));
}
