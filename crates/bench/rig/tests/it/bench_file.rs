use proptest::prelude::*;
use rig::bench_file::{BenchFileError, Draft, DriveHeat, FaultKind, PLACEHOLDER, StretchUse};
use rig::bench_parameters::BenchParameters;
use rig::channels::guess_roles;
use rig::facts::BenchVariant;
use rig::{BenchFile, Role};
use units::RPM_RAD_S;
use virtual_bench::StatedBench;

use bench_testkit::recordings::{BENCH_A, named, recording};

const GOOD: &str = r#"[bench]
name = "Cell 4"
variant = "load-cell"
cylinders = 4
dynamometer_inertia = "0.6 kg m²"
dynamometer_inertia_uncertainty_percent = 2
engine_inertia = 0.2

[limits]
torque = "400 Nm"
speed = "6000 rpm"

[channels]
dyno_speed = { name = "DynoSpeed", unit = "rpm", gate_ms = 1.0 }
engine_speed = "EngineSpeed"
air_gap_torque = { name = "DynoTorqueCalc", sign = -1 }

[recordings]
files = ["*.mf4"]

[[recordings.label]]
file = "run_17.mf4"
label = "BS_T_NT"

[[recordings.stretch]]
file = "run_17.mf4"
leave_out = [12.5, 14]

[[recordings.stretch]]
file = "run_17.mf4"
leave_out = [14.0, 15.25]

[[recordings.stretch]]
file = "run_18.mf4"
estimate = [-1.0, 30.0]
"#;

fn parse(text: &str) -> Result<BenchFile, BenchFileError> {
    text.parse()
}

/// The one fault of a bench file in which `from` is replaced by `to`: its line, key, kind and words.
fn fault(from: &str, to: &str) -> (usize, String, FaultKind, String) {
    assert!(GOOD.contains(from), "{from}");
    let faults = parse(&GOOD.replace(from, to)).unwrap_err().faults;
    let [fault] = &faults[..] else { panic!("{faults:#?}") };
    (fault.line, fault.key.clone(), fault.kind.clone(), fault.to_string())
}

#[test]
fn exact_good_file() {
    let file = parse(GOOD).unwrap();
    assert_eq!(
        (file.name.as_str(), file.variant, file.cylinders, file.strokes),
        ("Cell 4", BenchVariant::LoadCell, 4, 4)
    );
    assert_eq!((file.dynamometer_inertia_kg_m2, file.engine_inertia_kg_m2), (0.6, 0.2));
    assert_eq!(file.dynamometer_inertia_uncertainty_percent, Some(2.0));
    assert_eq!((file.limits.torque_nm, file.limits.shaft_torque_nm), (Some(400.0), None));
    assert_eq!(file.limits.speed_rad_s, Some(6000.0 * RPM_RAD_S));
    let speed = &file.channels[&Role::DynoSpeed];
    assert_eq!((speed.name.as_str(), speed.gate_s, speed.signed_factor()), ("DynoSpeed", Some(1e-3), 1.0));
    assert_eq!(file.channels[&Role::AirGapTorque].signed_factor(), -1.0);
    assert_eq!(file.facts().torque_limit_nm, Some(400.0));
}

#[test]
fn exact_labels_from_override_and_name() {
    let file = parse(GOOD).unwrap();
    let label = |name: &str| file.label_of(name).map(|label| label.to_string());
    assert_eq!(label("data/run_17.mf4").as_deref(), Some("BS_T_NT"));
    assert_eq!(label("C:\\data\\Step_T_TN_1200.mf4").as_deref(), Some("Step_T_TN"));
    assert_eq!(label("BS_T_NT/other.mf4"), None);
}

#[test]
fn prop_toml_round_trip() {
    let file = parse(GOOD).unwrap();
    assert_eq!(parse(&file.to_toml()).unwrap(), file);
}

#[test]
fn exact_factor_and_angle_of_a_channel() {
    let text = GOOD
        .replace(
            "air_gap_torque = { name = \"DynoTorqueCalc\", sign = -1 }",
            "air_gap_torque = { name = \"iq\", unit = \"Nm\", sign = -1, factor = 0.42 }",
        )
        .replace("engine_speed = \"EngineSpeed\"", "engine_speed = { name = \"EngineAngle\", unit = \"deg\" }");
    let file = parse(&text).unwrap();
    assert_eq!(file.channels[&Role::AirGapTorque].signed_factor(), -0.42);
    assert_eq!(file.channels[&Role::EngineSpeed].unit.map(|unit| unit.spelling), Some("deg"));
    assert_eq!(parse(&file.to_toml()).unwrap(), file);
    // A torque is no angle, and no factor is negative.
    assert!(parse(&text.replace("unit = \"Nm\"", "unit = \"deg\"")).is_err());
    assert!(parse(&text.replace("factor = 0.42", "factor = -0.42")).is_err());
}

#[test]
fn exact_where_nothing_fires_the_dynamometer_s_speed_will_do() {
    let text = GOOD.replace("engine_speed = \"EngineSpeed\"\n", "").replace("cylinders = 4", "cylinders = 0");
    assert_eq!(parse(&text).unwrap().cylinders, 0);
}

#[test]
fn regress_not_toml() {
    let (line, _, kind, _) = fault("cylinders = 4", "cylinders = = 4");
    assert_eq!(line, 4);
    assert!(matches!(kind, FaultKind::Syntax { .. }));
}

#[test]
fn regress_misspelt_role_is_unknown_and_missing() {
    let error = parse(&GOOD.replace("engine_speed = ", "engin_speed = ")).unwrap_err();
    let words: Vec<String> = error.faults.iter().map(ToString::to_string).collect();
    assert_eq!(words.len(), 2, "{words:?}");
    assert!(words[0].starts_with("line 13: channels.engine_speed: this is missing"), "{words:?}");
    assert!(words[1].starts_with("line 15: channels.engin_speed") && words[1].contains("`engine_speed`"), "{words:?}");
}

#[test]
fn regress_unknown_keys_of_every_table() {
    for (from, to, line, key, meant) in [
        ("name = \"Cell 4\"", "name = \"Cell 4\"\nstroke = 4", 3, "bench.stroke", "strokes"),
        ("speed = \"6000 rpm\"", "sped = \"6000 rpm\"", 11, "limits.sped", "speed"),
        ("gate_ms", "gate", 14, "channels.dyno_speed.gate", "gate_ms"),
        ("files =", "file =", 19, "recordings.file", "files"),
    ] {
        let (found_line, found_key, kind, words) = fault(from, to);
        assert_eq!((found_line, found_key.as_str()), (line, key), "{words}");
        assert!(words.contains(&format!("did you mean `{meant}`?")), "{words}");
        assert!(matches!(kind, FaultKind::UnknownKey { .. }));
    }
}

#[test]
fn regress_missing_keys_name_key_and_remedy() {
    let (line, key, _, words) = fault("cylinders = 4\n", "");
    assert_eq!((line, key.as_str()), (1, "bench.cylinders"));
    assert!(words.contains("add cylinders = 4"), "{words}");
    let (line, key, _, words) = fault("engine_speed = \"EngineSpeed\"\n", "");
    assert_eq!((line, key.as_str()), (13, "channels.engine_speed"));
    assert!(words.contains("add engine_speed = \"NameInTheRecording\""), "{words}");
}

#[test]
fn exact_a_bench_that_is_only_simulated_needs_no_channels() {
    let start = GOOD.find("[channels]").unwrap();
    let end = GOOD.find("[recordings]").unwrap();
    let file = parse(&format!("{}{}", &GOOD[..start], &GOOD[end..])).unwrap();
    assert!(file.channels.is_empty());
    // With the table, roles are asked for.
    assert!(parse(&format!("{}[channels]\n", &GOOD[..start])).is_err());
}

#[test]
fn regress_torque_flange_needs_its_channel() {
    let (_, key, kind, _) = fault("\"load-cell\"", "\"torque-flange\"");
    assert_eq!(key, "channels.flange_torque");
    assert!(matches!(kind, FaultKind::Missing { .. }));
}

#[test]
fn regress_implausible_inertia_looks_like_another_unit() {
    for value in ["6000", "\"6000 kg m²\""] {
        let (line, key, kind, words) = fault("\"0.6 kg m²\"", value);
        assert_eq!((line, key.as_str()), (5, "bench.dynamometer_inertia"));
        assert!(matches!(kind, FaultKind::ImplausibleInertia { .. }));
        assert!(words.contains("looks like kg cm²"), "{words}");
    }
    for value in ["-0.6", "0", "\"0.00001 kg m²\""] {
        let (_, _, kind, words) = fault("\"0.6 kg m²\"", value);
        assert!(matches!(kind, FaultKind::ImplausibleInertia { .. }), "{words}");
    }
    let (_, _, kind, words) = fault("\"0.6 kg m²\"", "\"0.6 Nm\"");
    assert!(matches!(kind, FaultKind::Unit { .. }));
    assert!(words.contains("unit of torque") && words.contains("0.6 kg m²"), "{words}");
    let (_, _, _, words) = fault("\"0.6 kg m²\"", "\"1.03 kg\"");
    assert!(words.ends_with("write e.g. \"1.03 kg m²\""), "{words}");
}

#[test]
fn exact_friction_and_what_is_uncertain() {
    let stated = |lines: &str| parse(&GOOD.replace("engine_inertia", &format!("{lines}\nengine_inertia")));
    let file =
        stated("dynamometer_friction = \"0.02 Nm s/rad\"\ndynamometer_friction_uncertainty_percent = 300").unwrap();
    assert_eq!(file.dynamometer_friction_nm_s_per_rad, Some(0.02));
    assert_eq!(file.dynamometer_friction_uncertainty_percent, Some(300.0));
    let file = stated("dynamometer_coulomb_friction = \"1.2 Nm\"").unwrap();
    assert_eq!(file.dynamometer_coulomb_friction_nm, Some(1.2));
    assert_eq!(parse(&file.to_toml()).unwrap(), file);
    let engine = parse(&GOOD.replace("= 0.2\n", "= 0.2\nengine_inertia_uncertainty_percent = 5\n")).unwrap();
    assert_eq!(engine.engine_inertia_uncertainty_percent, Some(5.0));
    assert_eq!(parse(&engine.to_toml()).unwrap(), engine);
    for (lines, key) in [
        ("dynamometer_friction_uncertainty_percent = 50", "bench.dynamometer_friction"),
        ("dynamometer_friction = \"0.02 Nm\"", "bench.dynamometer_friction"),
        ("dynamometer_coulomb_friction = \"1 Nm s/rad\"", "bench.dynamometer_coulomb_friction"),
        ("dynamometer_friction = \"-0.02 Nm s/rad\"", "bench.dynamometer_friction"),
    ] {
        let faults = stated(lines).unwrap_err().faults;
        assert!(faults.len() == 1 && faults[0].key == key, "{lines}: {faults:#?}");
    }
}

#[test]
fn regress_values_out_of_range() {
    for (from, to, key) in [
        ("cylinders = 4", "cylinders = -1", "bench.cylinders"),
        ("cylinders = 4", "cylinders = 16", "bench.cylinders"),
        ("uncertainty_percent = 2", "uncertainty_percent = -2", "bench.dynamometer_inertia_uncertainty_percent"),
        ("0.2\n", "0.2\nengine_inertia_uncertainty_percent = 500\n", "bench.engine_inertia_uncertainty_percent"),
        ("\"400 Nm\"", "\"-400 Nm\"", "limits.torque"),
        ("gate_ms = 1.0", "gate_ms = -1.0", "channels.dyno_speed.gate_ms"),
    ] {
        let (_, found, kind, words) = fault(from, to);
        assert_eq!(found, key);
        assert!(matches!(kind, FaultKind::OutOfRange { .. }), "{words}");
    }
    for (from, to) in
        [("sign = -1", "sign = 2"), ("cylinders = 4", "cylinders = 4\nstrokes = 3"), ("load-cell", "loadcell")]
    {
        let (_, _, kind, words) = fault(from, to);
        assert!(matches!(kind, FaultKind::NotOneOf { .. }), "{words}");
    }
}

#[test]
fn regress_wrong_types_and_units() {
    for (from, to) in [
        ("\"Cell 4\"", "4"),
        ("cylinders = 4", "cylinders = \"four\""),
        ("cylinders = 4", "cylinders = 4.5"),
        ("\"400 Nm\"", "400"),
        ("\"EngineSpeed\"", "[\"EngineSpeed\"]"),
        ("[\"*.mf4\"]", "\"*.mf4\""),
        ("files = [\"*.mf4\"]", "files = [1]"),
    ] {
        let (_, _, kind, words) = fault(from, to);
        assert!(matches!(kind, FaultKind::WrongType { .. }), "{words}");
    }
    for (from, to) in
        [("\"400 Nm\"", "\"400 rpm\""), ("unit = \"rpm\"", "unit = \"Nm\""), ("\"400 Nm\"", "\"400 Nmm³\"")]
    {
        let (_, _, kind, words) = fault(from, to);
        assert!(matches!(kind, FaultKind::Unit { .. }), "{words}");
    }
}

#[test]
fn regress_control_characters_are_named() {
    let text = GOOD.replacen("name = \"", "name = \"a\\u001bb", 1);
    let error = text.parse::<BenchFile>().unwrap_err().to_string();
    assert!(error.contains("bench.name") && error.contains("U+001B"), "{error}");
    let text = format!("{GOOD}\n[report]\ntitle = \"a\\nb\"\n");
    let error = text.parse::<BenchFile>().unwrap_err().to_string();
    assert!(error.contains("report.title") && error.contains("U+000A"), "{error}");
}

#[test]
fn regress_one_channel_for_two_roles() {
    let (line, key, kind, _) = fault("\"EngineSpeed\"", "\"DynoSpeed\"");
    assert_eq!((line, key.as_str()), (15, "channels.engine_speed"));
    assert_eq!(kind, FaultKind::ChannelUsedTwice { channel: "DynoSpeed".to_owned(), other: "dyno_speed".to_owned() });
}

#[test]
fn regress_not_a_label() {
    let (line, _, kind, _) = fault("label = \"BS_T_NT\"", "label = \"BS\"");
    assert_eq!(line, 23);
    assert!(matches!(kind, FaultKind::NotALabel { .. }));
}

#[test]
fn exact_stretches_of_a_recording() {
    let file = parse(GOOD).unwrap();
    let of = |name: &str| {
        let stretches = file.stretches_of(name).into_iter();
        stretches.map(|stretch| (stretch.from_s, stretch.to_s, stretch.usage)).collect::<Vec<_>>()
    };
    let left_out = [(12.5, 14.0, StretchUse::LeaveOut), (14.0, 15.25, StretchUse::LeaveOut)];
    assert_eq!(of("measurements/run_17.mf4"), left_out);
    assert_eq!(of("run_18.mf4"), [(-1.0, 30.0, StretchUse::Estimate)]);
    assert!(of("run_1.mf4").is_empty());
}

#[test]
fn regress_faults_of_stretches_have_line_and_remedy() {
    let line = 1 + GOOD.lines().position(|line| line == "leave_out = [14.0, 15.25]").unwrap();
    let cases = [
        ("[14.0, 15.25]", "[15.25, 14.0]", "recordings.stretch.leave_out", "a later end"),
        ("[14.0, 15.25]", "[14.0, 14.0]", "recordings.stretch.leave_out", "a later end"),
        ("[14.0, 15.25]", "[13.0, 15.0]", "recordings.stretch.leave_out", "overlaps the stretch from 12.5 s to 14 s"),
        ("[14.0, 15.25]", "[14.0]", "recordings.stretch.leave_out", "leave_out = [12.5, 14.0]"),
        ("[14.0, 15.25]", "[14.0, nan]", "recordings.stretch.leave_out", "leave_out = [12.5, 14.0]"),
        ("leave_out = [14.0, 15.25]", "leave = [14.0, 15.25]", "recordings.stretch.leave", "leave_out"),
    ];
    for (from, to, key, words) in cases {
        let faults = parse(&GOOD.replace(from, to)).unwrap_err().faults;
        assert_eq!((faults[0].key.as_str(), faults[0].line.abs_diff(line) <= 2), (key, true), "{faults:?}");
        assert!(faults.iter().any(|fault| fault.to_string().contains(words)), "{faults:?}");
    }
    let (at, key, ..) = fault("leave_out = [14.0, 15.25]", "leave_out = [14.0, 15.25]\nestimate = [16, 17]");
    assert_eq!((at, key.as_str()), (line, "recordings.stretch"));
    let (at, key, ..) = fault("leave_out = [14.0, 15.25]", "");
    assert_eq!((at, key.as_str()), (line - 2, "recordings.stretch"));
}

#[test]
fn regress_all_faults_are_reported_in_order() {
    let text = GOOD
        .replace("cylinders = 4", "cylinders = 40")
        .replace("sign = -1", "sign = 0")
        .replace("\"0.6 kg m²\"", "6000");
    let error = parse(&text).unwrap_err();
    assert_eq!(error.faults.iter().map(|fault| fault.line).collect::<Vec<_>>(), [4, 5, 16]);
    assert_eq!(error.to_string().lines().count(), 3);
}

#[test]
fn exact_commented_file_is_refused_until_filled_in() {
    let recording = named(BENCH_A, "rpm", "Nm");
    let guess = guess_roles(&[("WhiteNoise_T_TN.mf4", &recording)]);
    let files = vec!["*.mf4".to_owned()];
    let unlabelled = vec!["run 17.mf4".to_owned()];
    let draft = Draft { name: "Cell \"4\"", guess: &guess, files: &files, unlabelled: &unlabelled };
    let text = BenchFile::to_commented_toml(&draft);
    let error = parse(&text).unwrap_err();
    let placeholders = error.faults.iter().filter(|fault| matches!(fault.kind, FaultKind::Placeholder { .. })).count();
    assert_eq!((placeholders, error.faults.len()), (4, 4), "{error}\n{text}");
    let filled = text
        .replace(&format!("cylinders = \"{PLACEHOLDER}\""), "cylinders = 4")
        .replace(&format!("label = \"{PLACEHOLDER}\""), "label = \"BS_T_NT\"")
        .replace(&format!("\"{PLACEHOLDER}\"\n"), "\"0.6 kg m²\"\n");
    let file = parse(&filled).unwrap();
    assert_eq!(file.name, "Cell \"4\"");
    assert_eq!(file.channels[&Role::AirGapTorque].name, "DynoTorqueCalc");
    assert_eq!(file.channels.len(), 7);
}

#[test]
fn regress_hostile_channel_names_survive_in_the_commented_file() {
    let name = "Dyno\"Speed\n[channels]\\ETK";
    let recording = recording(0.0, &[(name, "rpm\n", 1e-3, (0..100).map(f64::from).collect())]);
    let guess = guess_roles(&[("a.mf4", &recording)]);
    let text = BenchFile::to_commented_toml(&Draft { name: "x", guess: &guess, files: &[], unlabelled: &[] });
    let error = parse(&text).unwrap_err();
    assert!(error.faults.iter().all(|fault| !matches!(fault.kind, FaultKind::Syntax { .. })), "{error}\n{text}");
}

proptest! {
    #[test]
    fn prop_any_text_is_answered(text in "\\PC{0,200}") {
        let _ = parse(&text);
    }

    #[test]
    fn prop_cut_and_damaged_files_are_answered(at in 0_usize..600, byte in "[\\PC\\n]") {
        let start: String = GOOD.chars().take(at).collect();
        let end: String = GOOD.chars().skip(at + 1).collect();
        let _ = parse(&start);
        let _ = parse(&format!("{start}{byte}{end}"));
    }

    #[test]
    fn prop_round_trip_of_numbers(inertia in 0.001..100.0_f64, limit in 0.1..1e4_f64, gate in 0.01..50.0_f64) {
        let mut file = parse(GOOD).unwrap();
        file.dynamometer_inertia_kg_m2 = inertia;
        file.limits.shaft_torque_nm = Some(limit);
        let back = parse(&file.to_toml()).unwrap();
        prop_assert_eq!(&back, &file);
        file.channels.get_mut(&Role::DynoSpeed).unwrap().gate_s = Some(gate * 1e-3);
        let back = parse(&file.to_toml()).unwrap().channels[&Role::DynoSpeed].gate_s.unwrap();
        prop_assert!((back - gate * 1e-3).abs() < 1e-15);
    }
}

/// The good file with more text in front of its recordings.
fn with(more: &str) -> Result<BenchFile, BenchFileError> {
    parse(&GOOD.replace("[recordings]\n", &format!("{more}\n[recordings]\n")))
}

#[test]
fn exact_shaft_limits_and_virtual_bench() {
    let limits = "torque_slew = \"5 kNm/s\"\nshaft_torque_slew = \"800 Nm/s\"\ntime_at_resonance = \"500 ms\"\n";
    let more = "[shaft]\nresonance = \"18 Hz\"\ndamping = \"6 Nm s/rad\"\n\n[virtual_bench.mechanics]\n\
                shaft_backlash_rad = 0.002\n[virtual_bench.sensors]\nmoving_average = 8\n";
    let text = GOOD.replace("[channels]", &format!("{limits}[channels]"));
    let file = parse(&text.replace("[recordings]\n", &format!("{more}\n[recordings]\n"))).unwrap();
    assert_eq!(file.limits.torque_slew_nm_per_s, Some(5000.0));
    assert_eq!((file.limits.shaft_torque_slew_nm_per_s, file.limits.time_at_resonance_s), (Some(800.0), Some(0.5)));
    assert_eq!((file.shaft.resonance_hz, file.shaft.damping_nm_s_per_rad), (Some(18.0), Some(6.0)));
    let stated = StatedBench::of(&file, None).unwrap();
    let mechanics = &stated.parameters.mechanics;
    assert_eq!((mechanics.shaft_backlash_rad, stated.parameters.sensors.moving_average), (0.002, 8));
    assert_eq!((mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2), (0.6, 0.2));
    let resonance = bench_model::model::BenchModel::of(&stated.parameters).mechanics.resonance();
    assert!((resonance.natural_frequency_hz - 18.0).abs() < 1e-9);
    assert_eq!(parse(&file.to_toml()).unwrap(), file);
}

#[test]
fn regress_faults_of_the_new_tables_have_line_and_remedy() {
    let words = |more: &str| with(more).unwrap_err().to_string();
    assert!(words("[shaft]\nstifness = \"2400 Nm/rad\"").contains("did you mean `stiffness`"));
    assert!(words("[shaft]\nstiffness = \"2400 Nm\"").contains("unit of torque, where one of stiffness is needed"));
    assert!(words("[shaft]\nresonance = \"18 rpm\"").contains("the closest known ones are Hz"));
    assert!(words("[shaft]\nresonance = \"18 Hz\"\nstiffness = \"2400 Nm/rad\"").contains("say the same thing"));
    assert!(words("[shaft]\ndamping = \"-6 Nm s/rad\"").contains("a value above 0"));
    let found = words("[virtual_bench.mechanics]\nshaft_stifness_nm_per_rad = 2400.0");
    assert!(found.contains("line 19: virtual_bench.mechanics.shaft_stifness_nm_per_rad"), "{found}");
    assert!(found.contains("did you mean `shaft_stiffness_nm_per_rad`"), "{found}");
    assert!(words("[virtual_bench]\nmechanisc = 1").contains("did you mean `mechanics`"));
    let found = words("[virtual_bench.mechanics]\nshaft_stiffness_nm_per_rad = \"stiff\"");
    assert!(found.contains("line 19: virtual_bench: ") && found.contains("invalid type"), "{found}");
    let file = with("[virtual_bench.mechanics]\nshaft_stiffness_nm_per_rad = -1").unwrap();
    let error = StatedBench::of(&file, None).unwrap_err().to_string();
    assert!(error.contains("mechanics.shaft_stiffness_nm_per_rad = -1 is impossible"), "{error}");
}

#[test]
fn exact_the_heat_of_a_drive_is_stated_by_its_time_constant_or_by_an_overload() {
    let of = |more: &str| parse(&GOOD.replace("[channels]", &format!("{more}\n[channels]")));
    let file = of("continuous_torque = \"250 Nm\"\nthermal_time_constant = \"90 s\"").unwrap();
    let heat = DriveHeat { continuous_torque_nm: 250.0, time_constant_s: 90.0 };
    assert_eq!(file.limits.drive_heat, Some(heat));
    assert_eq!(parse(&file.to_toml()).unwrap(), file);
    // A cold drive gives 500 Nm, with 4 times the loss, for τ ln(4/3).
    let file = of("continuous_torque = \"250 Nm\"\noverload_torque = \"500 Nm\"\noverload_time = \"60 s\"").unwrap();
    let heat = file.limits.drive_heat.unwrap();
    assert!((heat.time_constant_s - 60.0 / (4.0_f64 / 3.0).ln()).abs() < 1e-9, "{heat:?}");
    let words = |more: &str| of(more).unwrap_err().to_string();
    assert!(words("thermal_time_constant = \"90 s\"").contains("limits.continuous_torque"));
    assert!(words("continuous_torque = \"250 Nm\"").contains("limits.overload_torque"));
    assert!(
        words("continuous_torque = \"250 Nm\"\noverload_torque = \"200 Nm\"\noverload_time = \"60 s\"")
            .contains("above")
    );
    let both = "continuous_torque = \"250 Nm\"\nthermal_time_constant = \"90 s\"\noverload_torque = \"400 Nm\"";
    assert!(words(both).contains("say the same thing"));
}

#[test]
fn exact_a_bench_of_which_nothing_is_stated_says_what_is_assumed() {
    let stated = StatedBench::of(&parse(GOOD).unwrap(), None).unwrap();
    assert!(!stated.knows_shaft());
    let mut model = bench_model::model::BenchModel::of(&BenchParameters::default());
    model.mechanics.engine_inertia_kg_m2 = 0.2831;
    let known = StatedBench::of(&parse(GOOD).unwrap(), Some(&model)).unwrap();
    assert!(known.knows_shaft());
    assert_eq!(known.assumptions, [virtual_bench::Assumption::Engine, virtual_bench::Assumption::Pulses]);
    assert_eq!(known.parameters.mechanics.shaft_stiffness_nm_per_rad, 2437.7);
    // The shaft of a model goes with the inertias that it was estimated with.
    assert_eq!(known.parameters.mechanics.engine_inertia_kg_m2, 0.2831);
}

/// A judgement takes the channels alone: neither the bench's numbers nor the roles that an estimate needs, and one
/// channel twice.
#[test]
fn exact_the_channels_of_a_judgement_need_nothing_else() {
    let text = "[bench]\nname = \"x\"\n[limits]\nspeed = \"6000 rpm\"\n[channels]\ndyno_speed = \"N\"\nengine_speed = \"N\"\n\
        flange_torque = { name = \"M\", sign = -1 }\nair_gap_torque = \"FILL IN\"\n";
    let text = text.replace("FILL IN", PLACEHOLDER);
    let run: rig::RunChannels = text.parse().unwrap();
    let names: Vec<(Role, &str)> = run.channels.iter().map(|(role, channel)| (*role, channel.name.as_str())).collect();
    assert_eq!(names.len(), 3, "{names:?}");
    assert!(names.contains(&(Role::DynoSpeed, "N")) && names.contains(&(Role::EngineSpeed, "N")), "{names:?}");
    assert!((run.speed_limit_rad_s.unwrap() - 6000.0 * RPM_RAD_S).abs() < 1e-9);
    assert!(parse(&text).is_err(), "an estimate needs the rest");
    let fault = "[channels]\nspeed = \"N\"\n".parse::<rig::RunChannels>().unwrap_err();
    assert!(fault.to_string().contains("line 2: channels.speed: there is no such key"), "{fault}");
}
