//! The strongest lines of the recordings of two simulated benches, where they are present beside the project, against
//! what made them. The engine has four unequal cylinders, which give half orders beside multiples of order 2; the drive
//! has a ripple at 100 Hz, part of it in proportion to its torque; torque demands are held for 10 ms.

use part_lines::lines::{Cause, Line, RecordingLines, find_lines};
use rig::{BenchFile, Role, prepare};

use bench_testkit::benches::bench_file;
use bench_testkit::recordings::{BENCH_A, recordings};

const BENCH_B: [&str; 7] =
    ["nBremse", "nMotor", "nBremse_Soll", "MdBremse_Soll", "MdLuftspalt", "MdKraftdose", "MdWelle"];

/// A recording, a signal of it, and the causes of its strongest lines: of each the one, or those that it is undecided
/// between, among others.
type Strongest = (&'static str, Role, &'static [&'static [&'static str]]);

fn code(cause: &Cause) -> Vec<String> {
    let one = match cause {
        Cause::Order { order, .. } => format!("order {order}"),
        Cause::FoldedOrder { order, .. } => format!("folded order {order}"),
        Cause::Mains { multiple, mains_hz } => format!("{multiple} × {mains_hz} Hz"),
        Cause::Undecided { between, .. } => return between.iter().flat_map(code).collect(),
        other => format!("{other:?}"),
    };
    vec![one]
}

fn is_named(line: &Line, expected: &[&str]) -> bool {
    let named = code(&line.cause);
    let is_among = expected.iter().all(|one| named.iter().any(|name| name == one));
    is_among && (expected.len() > 1) == (named.len() > 1)
}

fn looked(bench: &str, file: &BenchFile, is_meant: impl Fn(&str) -> bool) -> Vec<RecordingLines> {
    let meant = recordings(bench).into_iter().filter(|(name, _)| is_meant(name));
    let looks = meant.map(|(name, recording)| {
        let (experiment, _) = prepare(&name, &recording, file, file.label_of(&name).unwrap()).unwrap();
        find_lines(&experiment, file)
    });
    looks.collect()
}

fn check(bench: &str, file: &BenchFile, expected: &[Strongest]) {
    let looks = looked(bench, file, |name| expected.iter().any(|(meant, ..)| name.starts_with(meant)));
    for look in &looks {
        for (_, role, causes) in expected.iter().filter(|(name, ..)| look.file.starts_with(name)) {
            let signal = look.parts[0].signals.iter().find(|signal| signal.role == *role).unwrap();
            let strongest: Vec<_> = signal.lines.iter().filter(|line| line.standard_error.is_some()).collect();
            for (line, causes) in strongest.iter().zip(*causes) {
                assert!(is_named(line, causes), "{} {role:?}: {line:?}, not {causes:?}", look.file);
            }
            assert!(strongest.len() >= causes.len(), "{} {role:?}: {strongest:?}", look.file);
        }
    }
}

#[test]
fn ref_strongest_lines_of_bench_a() {
    check(
        "bench-a",
        &bench_file("0.6", "0.28", "400 Nm", BENCH_A),
        &[
            ("BS_T_NT_1200", Role::EngineSpeed, &[&["order 2"], &["order 4"], &["order 6"]]),
            ("BS_T_NT_1200", Role::DynoSpeed, &[&["order 2"], &["order 1"], &["order 0.5"], &["order 4"]]),
            ("BS_T_NT_1200", Role::AirGapTorque, &[&["2 × 50 Hz"], &["order 2"], &["order 0.5"], &["order 1"]]),
            ("BS_T_NT_1200", Role::SystemShaftTorque, &[&["order 2"], &["order 1"], &["2 × 50 Hz"], &["order 0.5"]]),
            // At 3000 rpm order 2 is the ripple's frequency, at 4500 rpm order 4 folds at 500 Hz.
            ("BS_T_NT_3000", Role::EngineSpeed, &[&["order 2", "2 × 50 Hz"]]),
            ("BS_T_NT_4500", Role::EngineSpeed, &[&["order 2", "3 × 50 Hz"], &["order 1"], &["folded order 4"]]),
            ("Unfired_N_NT_1200", Role::EngineSpeed, &[&["order 2"], &["order 4"]]),
            // Order 5 lies within a hundredth of a hertz of the ripple, but wanders with the speed: the phase tells
            // them apart.
            ("Unfired_N_NT_1200", Role::AirGapTorque, &[&["2 × 50 Hz"]]),
            ("NoShaft_N_NT_1200", Role::AirGapTorque, &[&["2 × 50 Hz"]]),
        ],
    );
}

#[test]
fn ref_strongest_lines_of_bench_b() {
    check(
        "bench-b",
        &bench_file("0.41", "0.19", "260 Nm", BENCH_B),
        &[
            (
                "BS_T_NT_1500",
                Role::EngineSpeed,
                &[&["order 2", "1 × 50 Hz"], &["order 4", "2 × 50 Hz"], &["order 1.5"]],
            ),
            ("BS_T_NT_1500", Role::SystemShaftTorque, &[&["order 2", "1 × 50 Hz"], &["order 0.5"], &["order 1.5"]]),
            ("Step_T_TN_1500", Role::EngineSpeed, &[&["order 2"], &["order 4"], &["order 1.5"], &["order 6"]]),
            ("Step_T_TN_1500", Role::AirGapTorque, &[&["2 × 50 Hz"]]),
        ],
    );
}
