use rig::Role;
use rig::channels::{Guess, Reason, guess_roles};
use rig::facts::BenchVariant;

use bench_testkit::recordings::{BENCH_A, bench, named, recording};

const ROLES: [Role; 7] = [
    Role::DynoSpeed,
    Role::EngineSpeed,
    Role::DynoSpeedDemand,
    Role::DynoTorqueDemand,
    Role::AirGapTorque,
    Role::LoadCellTorque,
    Role::SystemShaftTorque,
];

fn assert_right(guess: &Guess, names: [&str; 7]) {
    for (role, name) in ROLES.iter().zip(names) {
        let choice = guess.choices.get(role).unwrap_or_else(|| panic!("{role:?} is missing: {guess:#?}"));
        assert_eq!(choice.channel, name, "{role:?}: {guess:#?}");
        assert!(!choice.reasons.is_empty());
    }
    assert_eq!(guess.choices.len(), 7, "{guess:#?}");
    assert_eq!(guess.missing, [Role::FlangeTorque, Role::Throttle]);
    assert_eq!(guess.variant(), BenchVariant::LoadCell);
}

fn check(names: [&str; 7], speed_unit: &str, torque_unit: &str) -> Guess {
    let recording = named(names, speed_unit, torque_unit);
    let guess = guess_roles(&[("WhiteNoise_T_TN.mf4", &recording)]);
    assert_right(&guess, names);
    guess
}

#[test]
fn exact_names_of_two_benches() {
    let guess = check(BENCH_A, "rpm", "Nm");
    assert!(guess.ambiguous.is_empty(), "{:?}", guess.ambiguous);
    let guess = check(
        ["nBremse", "nMotor", "nBremse_Soll", "MdBremse_Soll", "MdLuftspalt", "MdKraftdose", "MdWelle"],
        "1/min",
        "N.m",
    );
    assert!(guess.ambiguous.is_empty(), "{:?}", guess.ambiguous);
    assert!(guess.choices.values().all(|choice| choice.confidence > 0.7), "{guess:#?}");
}

#[test]
fn exact_other_naming_schemes() {
    check(["N_DYNO", "N_ENG", "N_DYNO_SP", "TQ_DYNO_SP", "TQ_AIRGAP", "TQ_LOADCELL", "TQ_SHAFT"], "rpm", "Nm");
    check(
        ["nBelast_Ist", "nVKM_Ist", "nBelast_Soll", "MBelast_Soll", "MLuftspalt", "MBelast_Ist", "MWelle"],
        "U/min",
        "Nm",
    );
    check(
        [
            "INCA: DynoSpd_rpm\\ETK",
            "INCA: EngSpd_rpm\\ETK",
            "INCA: DynoSpdDmd_rpm\\ETK",
            "INCA: DynoTrqDmd_Nm\\ETK",
            "INCA: DynoTrqCalc_Nm\\ETK",
            "INCA: DynoTrqMeas_Nm\\ETK",
            "INCA: ShaftTrqCalc_Nm\\ETK",
        ],
        "",
        "",
    );
    check(
        [
            "Drehzahl_Bremse",
            "Drehzahl_Verbrenner",
            "Drehzahl_Sollwert",
            "Drehmoment_Sollwert",
            "Drehmoment_Umrichter",
            "Drehmoment_Kraftmessung",
            "Drehmoment_Welle_berechnet",
        ],
        "min-1",
        "N·m",
    );
    check(
        [
            "Istdrehzahl Leistungsbremse",
            "Drehzahlistwert Verbrennungsmotor",
            "Solldrehzahl Leistungsbremse",
            "Solldrehmoment Leistungsbremse",
            "Istdrehmoment Umrichter",
            "Istdrehmoment Kraftmessdose",
            "Drehmoment Welle berechnet",
        ],
        "U/min",
        "Nm",
    );
    check(
        [
            "Brake/Speed [actual]",
            "Engine/Speed [actual]",
            "Brake/Speed [setpoint]",
            "Brake/Torque [setpoint]",
            "Brake/Torque [inverter]",
            "Brake/Torque [load cell]",
            "Shaft/Torque [estimated]",
        ],
        "r/min",
        "N*m",
    );
    check(["N_d", "N_e", "N_d_ref", "T_d_ref", "T_d_calc", "T_d_meas", "T_shaft_calc"], "rad/s", "Nm");
}

#[test]
fn exact_unit_in_the_name_is_proposed() {
    let guess = check(
        [
            "DynoSpd_rpm",
            "EngSpd_rpm",
            "DynoSpdRef_rpm",
            "DynoTrqRef_Nm",
            "DynoTrqCalc_Nm",
            "DynoTrqCell_Nm",
            "ShaftTrq_Nm",
        ],
        "",
        "",
    );
    let spelling = |role| guess.mappings()[&role].unit.map(|unit| unit.spelling);
    assert_eq!((spelling(Role::DynoSpeed), spelling(Role::AirGapTorque)), (Some("rpm"), Some("Nm")));
}

#[test]
fn exact_torque_flange_and_throttle() {
    let b = bench();
    let pedal: Vec<f64> = (0..800).map(|i| 30.0 + f64::from(i % 7)).collect();
    let recording = recording(
        0.0,
        &[
            ("DynoSpeed", "rpm", 1e-3, b.dyno_rpm),
            ("EngineSpeed", "rpm", 2e-3, b.engine_rpm),
            ("DynoTorqueCalc", "Nm", 4e-3, b.air_gap),
            ("MdMessflansch", "Nm", 4e-3, b.shaft),
            ("PedalPosition", "%", 1e-2, pedal.clone()),
            ("EngineLoad", "%", 1e-2, pedal),
        ],
    );
    let guess = guess_roles(&[("a.mf4", &recording)]);
    assert_eq!(guess.choices[&Role::FlangeTorque].channel, "MdMessflansch");
    assert_eq!(guess.choices[&Role::Throttle].channel, "PedalPosition");
    assert_eq!(guess.variant(), BenchVariant::TorqueFlange);
    assert_eq!(
        guess.missing,
        [Role::DynoSpeedDemand, Role::DynoTorqueDemand, Role::LoadCellTorque, Role::SystemShaftTorque]
    );
}

#[test]
fn regress_unrelated_channels_get_no_role() {
    let ramp: Vec<f64> = (0..500).map(f64::from).collect();
    let names = [
        ("T_Oil", "°C"),
        ("EngineTorqueDemand", "Nm"),
        ("MdMotor_Ist", "Nm"),
        ("DynoTorqueLimitMax", "Nm"),
        ("nMotor_Soll", "rpm"),
        ("p_boost", "bar"),
        ("VehicleSpeed", "km/h"),
        ("Lambda", "-"),
    ];
    let channels: Vec<(&str, &str, f64, Vec<f64>)> =
        names.iter().map(|(name, unit)| (*name, *unit, 1e-2, ramp.clone())).collect();
    let guess = guess_roles(&[("a.mf4", &recording(0.0, &channels))]);
    assert!(guess.choices.is_empty(), "{guess:#?}");
    assert_eq!(guess.missing.len(), Role::ALL.len());
}

#[test]
fn regress_two_channels_for_one_role_are_ambiguous() {
    let b = bench();
    let recording =
        recording(0.0, &[("DynoSpeed1", "rpm", 1e-3, b.dyno_rpm.clone()), ("DynoSpeed2", "rpm", 1e-3, b.dyno_rpm)]);
    let guess = guess_roles(&[("a.mf4", &recording)]);
    assert_eq!(guess.ambiguous.len(), 1, "{guess:#?}");
    assert_eq!(guess.ambiguous[0].role, Role::DynoSpeed);
    assert_eq!(guess.ambiguous[0].channels.len(), 2);
    assert!(guess.choices[&Role::DynoSpeed].confidence < 0.8);
}

#[test]
fn regress_names_that_say_nothing_are_named_by_samples_with_low_confidence() {
    let recording = named(["n1", "n2", "n3", "T1", "T2", "T3", "T4"], "rpm", "Nm");
    let guess = guess_roles(&[("a.mf4", &recording)]);
    let channel = |role: Role| guess.choices.get(&role).map(|choice| choice.channel.as_str());
    assert_eq!(channel(Role::DynoSpeed), Some("n1"), "{guess:#?}");
    assert_eq!(channel(Role::EngineSpeed), Some("n2"));
    assert_eq!(channel(Role::DynoSpeedDemand), Some("n3"));
    assert_eq!(channel(Role::DynoTorqueDemand), Some("T1"));
    assert_eq!(channel(Role::AirGapTorque), Some("T2"), "{guess:#?}");
    assert!(guess.choices[&Role::DynoSpeed].confidence < 0.8, "{guess:#?}");
    assert!(!guess.ambiguous.is_empty());
}

#[test]
fn regress_speed_of_another_unit_is_doubted() {
    let b = bench();
    let wrong = b.engine_rpm.iter().map(|rpm| rpm * std::f64::consts::TAU / 60.0).collect();
    let recording = recording(0.0, &[("DynoSpeed", "rpm", 1e-3, b.dyno_rpm), ("EngineSpeed", "rpm", 2e-3, wrong)]);
    let guess = guess_roles(&[("a.mf4", &recording)]);
    let choice = &guess.choices[&Role::EngineSpeed];
    assert!(choice.reasons.iter().any(|reason| matches!(reason, Reason::MeanDisagrees { .. })), "{guess:#?}");
    assert!(choice.confidence < 0.6);
}

#[test]
fn regress_empty_and_broken_recordings_are_answered() {
    assert_eq!(guess_roles(&[]).missing.len(), Role::ALL.len());
    let nan = recording(0.0, &[("DynoSpeed", "rpm", 1e-3, vec![f64::NAN; 50]), ("EngineSpeed", "rpm", 1e-3, vec![])]);
    let guess = guess_roles(&[("a.mf4", &nan)]);
    assert_eq!(guess.choices.len(), 2, "{guess:#?}");
}

#[test]
fn regress_values_that_no_bench_reaches_speak_against_a_channel() {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    let mut raw = recording.channel("DynoTorqueCalc").unwrap().clone();
    raw.name = "DynoTorqueAirgapCalc".to_owned();
    raw.samples.iter_mut().for_each(|value| *value *= 1000.0);
    recording.channels.push(raw);
    let guess = guess_roles(&[("WhiteNoise_T_TN.mf4", &recording)]);
    assert_right(&guess, BENCH_A);
    let reasons = &guess.choices[&Role::AirGapTorque].reasons;
    assert!(reasons.iter().any(|r| matches!(r, Reason::InRange { unit: "Nm", .. })), "{reasons:?}");
}

#[test]
fn regress_rasters_tell_two_unnamed_speeds_apart() {
    let guess = guess_roles(&[("WhiteNoise_T_TN.mf4", &named(BENCH_A, "rpm", "Nm"))]);
    let faster = Reason::Sampled { faster: true, than: "EngineSpeed".to_owned() };
    assert!(guess.choices[&Role::DynoSpeed].reasons.contains(&faster), "{guess:#?}");
}

#[test]
fn regress_units_of_other_quantities_are_no_candidates() {
    let wave: Vec<f64> = (0..2000).map(|i| 80.0 + (i as f64 * 0.1).sin()).collect();
    let recording = recording(
        0.0,
        &[
            ("DynoTorque_W", "°C", 1e-3, wave.clone()),
            ("DynoSpeed", "1/min", 1e-3, wave.clone()),
            ("TqDyno", "kW", 1e-3, wave),
        ],
    );
    let guess = guess_roles(&[("a.csv", &recording)]);
    assert_eq!(guess.choices.keys().copied().collect::<Vec<_>>(), [Role::DynoSpeed], "{guess:#?}");
}
