use recording::Recording;
use rig::bench_file::{StatedStretch, StretchUse};
use rig::prepare::saturated_stretches;
use rig::{BenchFile, Diagnostic, Experiment, Finding, PrepareError, Role, Severity, prepare, prepare_validation};
use units::RPM_RAD_S;

use bench_testkit::recordings::{BENCH_A, bench_file, named, noise, recording};

fn run_with(recording: &Recording, file: &BenchFile, label: &str) -> (Experiment, Vec<Diagnostic>) {
    prepare("a.mf4", recording, file, label.parse().unwrap()).unwrap()
}

fn run(recording: &Recording) -> (Experiment, Vec<Diagnostic>) {
    run_with(recording, &bench_file("", &[]), "WhiteNoise_T_TN")
}

/// The simulated test on bench A, with one channel changed.
fn changed(name: &str, change: impl FnOnce(&mut Vec<f64>, &mut Vec<f64>)) -> Recording {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    let index = recording.channels.iter().position(|channel| channel.name == name).unwrap();
    let raster = recording.channels[index].raster;
    let (mut time_s, mut samples) =
        (recording.rasters[raster].time_s.clone(), recording.channels[index].samples.clone());
    change(&mut time_s, &mut samples);
    recording.rasters[raster].time_s = time_s;
    recording.channels[index].samples = samples;
    recording
}

fn with_unit(name: &str, unit: &str) -> Recording {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    recording.channels.iter_mut().find(|channel| channel.name == name).unwrap().unit = unit.to_owned();
    recording
}

fn only(diagnostics: &[Diagnostic]) -> &Diagnostic {
    let [diagnostic] = diagnostics else { panic!("{diagnostics:#?}") };
    diagnostic
}

#[test]
fn exact_clean_recording_has_no_diagnostics() {
    let recording = named(BENCH_A, "rpm", "Nm");
    let (experiment, diagnostics) = run(&recording);
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    assert_eq!(experiment.signals.len(), 7);
    let speed = experiment.signal(Role::DynoSpeed).unwrap();
    assert_eq!(speed.samples[5], recording.channel("DynoSpeed").unwrap().samples[5] * RPM_RAD_S);
    assert!((speed.sample_time_s - 1e-3).abs() < 1e-12);
}

#[test]
fn exact_a_speed_may_be_recorded_as_an_angle_that_starts_anew_with_every_turn() {
    let speeds = named(BENCH_A, "rpm", "Nm");
    let (plain, _) = run(&speeds);
    let plain = plain.signal(Role::DynoSpeed).unwrap();
    let mut angles = changed("DynoSpeed", |time_s, samples| {
        let mut turned_deg = 0.0;
        for i in 1..samples.len() {
            samples[i - 1] = f64::rem_euclid(turned_deg, 360.0);
            turned_deg += 6.0 * samples[i] * (time_s[i] - time_s[i - 1]);
        }
        if let Some(last) = samples.last_mut() {
            *last = turned_deg.rem_euclid(360.0);
        }
    });
    angles.channels.iter_mut().find(|channel| channel.name == "DynoSpeed").unwrap().unit = "deg".to_owned();
    let (experiment, diagnostics) = run(&angles);
    let speed = experiment.signal(Role::DynoSpeed).unwrap();
    assert_eq!((speed.len(), speed.start_s), (plain.len() - 1, plain.start_s + plain.sample_time_s));
    let apart = speed.samples.iter().zip(&plain.samples[1..]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-6, "{apart} {diagnostics:#?}");
}

#[test]
fn exact_skewed_starts_and_units_are_kept() {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    let raster = recording.channel("DynoTorqueCalc").unwrap().raster;
    recording.rasters[raster].time_s.iter_mut().for_each(|time| *time += 2.5017);
    let (experiment, _) = run(&recording);
    assert_eq!(experiment.signal(Role::AirGapTorque).unwrap().start_s, 2.5017);
    assert_eq!(experiment.signal(Role::DynoSpeed).unwrap().start_s, 0.0);
}

#[test]
fn exact_sign_and_unit_of_the_bench_file() {
    let file = bench_file("", &[("air_gap_torque", "{ name = \"DynoTorqueCalc\", unit = \"kNm\", sign = -1 }")]);
    let recording = changed("DynoTorqueCalc", |_, samples| samples.iter_mut().for_each(|value| *value *= -1e-3));
    let (experiment, diagnostics) = run_with(&recording, &file, "WhiteNoise_T_TN");
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
    let mean = experiment.signal(Role::AirGapTorque).unwrap().mean().unwrap();
    assert!((mean - 60.0).abs() < 2.0, "{mean}");
}

#[test]
fn regress_missing_channel_names_the_closest() {
    let file = bench_file("", &[("load_cell_torque", "\"DynoTorqueMess\"")]);
    let (experiment, diagnostics) = run_with(&named(BENCH_A, "rpm", "Nm"), &file, "WhiteNoise_T_TN");
    let Finding::MissingChannel { role, closest } = &only(&diagnostics).finding else { panic!("{diagnostics:?}") };
    assert_eq!((*role, closest[0].as_str()), (Role::LoadCellTorque, "DynoTorqueMeas"));
    assert_eq!(diagnostics[0].place.file.as_deref(), Some("a.mf4"));
    assert_eq!(experiment.signals.len(), 6);
}

#[test]
fn regress_no_engine_speed_without_shaft_is_nothing_to_mention() {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    recording.channels.retain(|channel| channel.name != "EngineSpeed");
    let (_, diagnostics) = run_with(&recording, &bench_file("", &[]), "NoShaft_T_TN");
    assert_eq!(diagnostics, []);
}

#[test]
fn regress_unfit_units_are_refused() {
    for unit in ["Nm", "furlong", "", "Hz"] {
        let (experiment, diagnostics) = run(&with_unit("EngineSpeed", unit));
        let expected = Finding::UnfitUnit { role: Role::EngineSpeed, unit: unit.to_owned() };
        assert_eq!(only(&diagnostics).finding, expected);
        assert_eq!(experiment.signal(Role::EngineSpeed), None);
    }
}

#[test]
fn regress_time_that_repeats_or_runs_backwards_is_refused() {
    for (index, value) in [(100, 0.099), (100, 0.050), (100, f64::NAN)] {
        let recording = changed("DynoSpeed", |time_s, _| time_s[index] = value);
        let (experiment, diagnostics) = run(&recording);
        let refused = only(&diagnostics);
        assert_eq!((&refused.finding, refused.severity), (&Finding::TimeNotIncreasing, Severity::Error));
        assert_eq!(refused.place.channel.as_deref(), Some("DynoSpeed"));
        assert_eq!(refused.place.time_s, Some(value).filter(|time| time.is_finite()));
        assert_eq!(experiment.signal(Role::DynoSpeed), None);
    }
}

#[test]
fn regress_jitter_is_noted_and_straightened() {
    let recording = changed("EngineSpeed", |time_s, samples| {
        for (i, time) in time_s.iter_mut().enumerate() {
            *time += 0.3e-3 * noise(i, 9);
            samples[i] = 1198.0 + 0.5 * *time;
        }
    });
    let (experiment, diagnostics) = run(&recording);
    let Finding::Jitter { largest_s, .. } = diagnostics[0].finding else { panic!("{diagnostics:?}") };
    assert!((0.2e-3..0.61e-3).contains(&largest_s), "{largest_s}");
    let speed = experiment.signal(Role::EngineSpeed).unwrap();
    for i in [10, 1000, 3000] {
        assert!((speed.samples[i] / RPM_RAD_S - 1198.0 - 0.5 * speed.time_s(i)).abs() < 1e-9);
    }
}

#[test]
fn exact_rasters_that_count_from_elsewhere_are_noted() {
    for (offset_s, expected) in [(2.5017, true), (-0.3, true), (0.01, false)] {
        let recording = changed("DynoTorqueCalc", |time_s, _| time_s.iter_mut().for_each(|time| *time += offset_s));
        let (_, diagnostics) = run(&recording);
        let found = diagnostics.iter().find_map(|d| match &d.finding {
            Finding::ClockOffset { against, offset_s } => Some((against.as_str(), *offset_s)),
            _ => None,
        });
        assert_eq!(found.is_some(), expected, "{offset_s}: {diagnostics:#?}");
        assert!(found.is_none_or(|(against, found_s)| against == "DynoSpeed" && (found_s - offset_s).abs() < 0.01));
    }
}

#[test]
fn regress_clock_that_runs_apart_is_noted() {
    for rate in [4e-4, -4e-4] {
        let recording = changed("DynoTorqueCalc", |time_s, _| time_s.iter_mut().for_each(|time| *time *= 1.0 + rate));
        let (_, diagnostics) = run(&recording);
        let Finding::ClockDrift { rate: found, standard_error, apart_s, .. } = only(&diagnostics).finding else {
            panic!("{diagnostics:#?}")
        };
        assert!((found - rate).abs() < 4.0 * standard_error && standard_error < 5e-5, "{found} ± {standard_error}");
        assert!((apart_s - 8.0 * found).abs() < 0.1 * (8.0 * rate).abs());
        assert_eq!(diagnostics[0].place.channel.as_deref(), Some("DynoTorqueCalc"));
    }
}

#[test]
fn regress_short_gap_is_interpolated() {
    let recording = changed("DynoSpeed", |time_s, samples| {
        time_s.drain(1000..1015);
        samples.drain(1000..1015);
    });
    let (experiment, diagnostics) = run(&recording);
    let Finding::Gap { duration_s, mended: true } = only(&diagnostics).finding else { panic!("{diagnostics:?}") };
    assert!((duration_s - 0.016).abs() < 1e-9);
    assert_eq!(diagnostics[0].severity, Severity::Note);
    let speed = experiment.signal(Role::DynoSpeed).unwrap();
    assert_eq!(speed.samples.len(), 8000);
    assert!((speed.sample_time_s - 1e-3).abs() < 1e-12);
}

#[test]
fn regress_many_short_gaps_are_one_finding() {
    let keep = |i: usize| i % 20 != 7;
    let recording = changed("DynoTorqueCalc", |time_s, samples| {
        *time_s = time_s.iter().enumerate().filter(|(i, _)| keep(*i)).map(|(_, t)| *t).collect();
        *samples = samples.iter().enumerate().filter(|(i, _)| keep(*i)).map(|(_, x)| *x).collect();
    });
    let (_, diagnostics) = run(&recording);
    let Finding::ShortGaps { count, share, .. } = only(&diagnostics).finding else { panic!("{diagnostics:?}") };
    assert_eq!(count, 100);
    assert!((share - 0.05).abs() < 1e-3 && diagnostics[0].severity == Severity::Warning);
}

#[test]
fn regress_long_gap_leaves_the_longest_common_stretch() {
    let recording = changed("DynoSpeed", |time_s, samples| {
        time_s.drain(2000..2500);
        samples.drain(2000..2500);
    });
    let (experiment, diagnostics) = run(&recording);
    let [gap, cut] = &diagnostics[..] else { panic!("{diagnostics:#?}") };
    assert!(matches!(gap.finding, Finding::Gap { mended: false, .. }));
    assert_eq!(gap.place.time_s, Some(1.999));
    let Finding::Cut { kept_s, lost_s } = cut.finding else { panic!("{cut:?}") };
    assert!((kept_s.0 - 2.5).abs() < 1e-9 && (lost_s - 2.5).abs() < 0.01, "{kept_s:?} {lost_s}");
    assert_eq!(experiment.signals.len(), 7);
    for signal in experiment.signals.values() {
        assert!(signal.start_s >= 2.5 - 1e-9 && signal.start_s < 2.505);
    }
}

fn with_stretches(stretches: &[(&str, f64, f64, StretchUse)]) -> BenchFile {
    let mut file = bench_file("", &[]);
    file.recordings.stretches = stretches
        .iter()
        .map(|(file, from_s, to_s, usage)| StatedStretch {
            file: (*file).to_owned(),
            from_s: *from_s,
            to_s: *to_s,
            usage: *usage,
        })
        .collect();
    file
}

#[test]
fn exact_stretches_of_others_change_no_bit() {
    let recording = named(BENCH_A, "rpm", "Nm");
    let other = with_stretches(&[("b.mf4", 1.0, 2.0, StretchUse::LeaveOut)]);
    assert_eq!(run_with(&recording, &other, "WhiteNoise_T_TN"), run(&recording));
    // Nor does a stretch that holds all of the recording.
    let all = with_stretches(&[("a.mf4", -1.0, 100.0, StretchUse::Estimate)]);
    assert_eq!(run_with(&recording, &all, "WhiteNoise_T_TN").0, run(&recording).0);
}

/// A sensor that fails from 2 s to 3 s, and what is kept beside it.
#[test]
fn exact_nothing_looks_at_what_is_left_out() {
    let (clean, _) = run(&named(BENCH_A, "rpm", "Nm"));
    let damaged = changed("DynoSpeed", |_, samples| samples[2000..=3000].fill(1e9));
    let refused = prepare("a.mf4", &damaged, &bench_file("", &[]), "WhiteNoise_T_TN".parse().unwrap());
    assert!(!refused.unwrap().0.signals.contains_key(&Role::DynoSpeed));
    let file = with_stretches(&[("a.mf4", 2.0, 3.0, StretchUse::LeaveOut)]);
    let (experiment, diagnostics) = run_with(&damaged, &file, "WhiteNoise_T_TN");
    let Finding::LeftOut { stretches_s, used_s, unused_s } = &only(&diagnostics).finding else {
        panic!("{diagnostics:#?}")
    };
    assert_eq!(stretches_s, &[(2.0, 3.0)]);
    assert!((used_s.0 - 3.001).abs() < 0.004 && (unused_s - 2.0).abs() < 0.02, "{used_s:?} {unused_s}");
    assert_eq!(diagnostics[0].severity, Severity::Warning);
    for (role, signal) in &experiment.signals {
        let whole = clean.signal(*role).unwrap();
        let first = ((signal.start_s - whole.start_s) / whole.sample_time_s).round() as usize;
        assert!(signal.start_s > 3.0 - 1e-9, "{role:?}");
        assert!(signal.samples == whole.samples[first..][..signal.len()], "{role:?}");
        assert!(signal.end_s() > 7.99, "{role:?}");
    }
}

#[test]
fn exact_only_stretches_for_estimation_are_used() {
    let recording = named(BENCH_A, "rpm", "Nm");
    let file = with_stretches(&[("a.mf4", 1.0, 4.0, StretchUse::Estimate)]);
    let (experiment, diagnostics) = run_with(&recording, &file, "WhiteNoise_T_TN");
    let Finding::LeftOut { stretches_s, unused_s, .. } = &only(&diagnostics).finding else {
        panic!("{diagnostics:#?}")
    };
    assert_eq!((stretches_s.len(), *unused_s, diagnostics[0].severity), (2, 0.0, Severity::Note));
    let speed = experiment.signal(Role::DynoSpeed).unwrap();
    assert!((speed.start_s - 1.0).abs() < 1e-9 && (speed.end_s() - 4.0).abs() < 1e-9);
}

#[test]
fn exact_a_stretch_for_validation_is_kept_apart() {
    let recording = named(BENCH_A, "rpm", "Nm");
    let file = with_stretches(&[("a.mf4", 5.0, 7.0, StretchUse::Validate)]);
    let label = || "WhiteNoise_T_TN".parse().unwrap();
    let (experiment, diagnostics) = run_with(&recording, &file, "WhiteNoise_T_TN");
    let Finding::LeftOut { stretches_s, .. } = &only(&diagnostics).finding else { panic!("{diagnostics:#?}") };
    assert_eq!(stretches_s, &[(5.0, 7.0)]);
    assert!(experiment.signal(Role::DynoSpeed).unwrap().end_s() < 5.0);
    let (kept, _) = prepare_validation("a.mf4", &recording, &file, label()).unwrap().unwrap();
    let speed = kept.signal(Role::DynoSpeed).unwrap();
    assert!((speed.start_s - 5.0).abs() < 1e-9 && (speed.end_s() - 7.0).abs() < 1e-9);
    let whole = run(&recording).0;
    let first =
        ((speed.start_s - whole.signal(Role::DynoSpeed).unwrap().start_s) / speed.sample_time_s).round() as usize;
    assert_eq!(speed.samples, whole.signal(Role::DynoSpeed).unwrap().samples[first..][..speed.len()]);
    assert!(prepare_validation("b.mf4", &recording, &file, label()).is_none());
}

#[test]
fn regress_a_stretch_outside_its_recording_is_an_error() {
    let recording = named(BENCH_A, "rpm", "Nm");
    let file = with_stretches(&[("a.mf4", 50.0, 60.0, StretchUse::LeaveOut)]);
    let refused = prepare("a.mf4", &recording, &file, "WhiteNoise_T_TN".parse().unwrap());
    let Err(PrepareError::NothingUsable { diagnostics, .. }) = refused else { panic!("{refused:?}") };
    assert!(matches!(only(&diagnostics).finding, Finding::StretchOutside { from_s: 50.0, to_s: 60.0, .. }));
}

#[test]
fn regress_gaps_that_leave_nothing_in_common() {
    let mut recording = changed("DynoSpeed", |time_s, samples| {
        time_s.truncate(1000);
        samples.truncate(1000);
    });
    let raster = recording.channel("EngineSpeed").unwrap().raster;
    recording.rasters[raster].time_s.iter_mut().enumerate().for_each(|(i, t)| *t += if i < 100 { 2.0 } else { 3.0 });
    let result = prepare("a.mf4", &recording, &bench_file("", &[]), "BS_T_NT".parse().unwrap());
    assert!(matches!(result, Err(PrepareError::NoCommonStretch { .. })), "{result:?}");
}

#[test]
fn regress_few_nan_are_interpolated_and_many_refused() {
    let few = changed("DynoTorqueMeas", |_, samples| {
        samples[500] = f64::NAN;
        samples[501] = f64::INFINITY;
    });
    let (experiment, diagnostics) = run(&few);
    assert!(
        diagnostics.iter().any(|d| d.finding == Finding::NotANumber { count: 2, mended: true }),
        "{diagnostics:#?}"
    );
    assert_eq!(diagnostics[0].place.time_s, Some(2.0));
    let torque = experiment.signal(Role::LoadCellTorque).unwrap();
    assert!(torque.samples.len() == 2000 && torque.samples.iter().all(|value| value.is_finite()));

    let many = changed("DynoTorqueMeas", |_, samples| samples[500..900].fill(f64::NAN));
    let (experiment, diagnostics) = run(&many);
    assert_eq!(only(&diagnostics).finding, Finding::NotANumber { count: 400, mended: false });
    assert_eq!(experiment.signal(Role::LoadCellTorque), None);
}

#[test]
fn regress_dead_signals_are_refused_and_dull_demands_noted() {
    let (experiment, diagnostics) = run(&changed("DynoTorqueCalc", |_, samples| samples.fill(3.0)));
    assert_eq!(only(&diagnostics).finding, Finding::Constant { value: 3.0 });
    assert_eq!(experiment.signal(Role::AirGapTorque), None);
    let (experiment, diagnostics) = run(&changed("DynoTorqueDemand", |_, samples| samples.fill(3.0)));
    assert_eq!(
        (&only(&diagnostics).finding, only(&diagnostics).severity),
        (&Finding::Constant { value: 3.0 }, Severity::Warning)
    );
    assert!(experiment.signal(Role::DynoTorqueDemand).is_some());
    let recording = named(BENCH_A, "rpm", "Nm");
    let (_, diagnostics) = run_with(&recording, &bench_file("", &[]), "Ramp_N_NT");
    assert!(diagnostics.iter().any(|d| matches!(d.finding, Finding::Constant { .. })), "{diagnostics:#?}");
}

#[test]
fn regress_clipped_signal() {
    let recording =
        changed("DynoTorqueMeas", |_, samples| samples.iter_mut().for_each(|value| *value = value.min(63.0)));
    let (_, diagnostics) = run(&recording);
    let Finding::Clipped { value, share } = only(&diagnostics).finding else { panic!("{diagnostics:?}") };
    assert!(value == 63.0 && share > 0.05);
}

#[test]
fn regress_rpm_labelled_rad_s() {
    let fast = |recording: &Recording| {
        let mut recording = recording.clone();
        for channel in recording.channels.iter_mut().filter(|channel| channel.unit == "rpm") {
            channel.unit = "rad/s".to_owned();
            channel.samples.iter_mut().for_each(|value| *value *= 3.0);
        }
        recording
    };
    let (experiment, diagnostics) = run(&fast(&named(BENCH_A, "rpm", "Nm")));
    let magnitude = |d: &&Diagnostic| matches!(&d.finding, Finding::ImplausibleMagnitude { looks_like: Some(unit), .. } if unit == "rpm");
    assert_eq!(diagnostics.iter().filter(magnitude).count(), 2, "{diagnostics:#?}");
    assert_eq!(experiment.signal(Role::DynoSpeed), None);

    let mut slow = named(BENCH_A, "rad/s", "Nm");
    slow.channels.retain(|channel| channel.name != "DynoSpeedDemand" && channel.name != "EngineSpeed");
    let (experiment, diagnostics) = run(&slow);
    let found = diagnostics.iter().find(magnitude).unwrap();
    assert_eq!(found.severity, Severity::Warning);
    assert!(experiment.signal(Role::DynoSpeed).is_some());
    let (experiment, _) = run_with(&slow, &bench_file("speed = \"5000 rpm\"", &[]), "WhiteNoise_T_TN");
    assert_eq!(experiment.signal(Role::DynoSpeed), None);
}

#[test]
fn regress_one_speed_in_another_unit_or_geared() {
    let (_, diagnostics) = run(&with_unit("EngineSpeed", "rad/s"));
    let ratio = diagnostics.iter().find_map(|d| match d.finding {
        Finding::SpeedsDisagree { role: Role::EngineSpeed, ratio_to_dyno_speed } => Some(ratio_to_dyno_speed),
        _ => None,
    });
    assert!((ratio.unwrap() - 9.549).abs() < 0.1, "{diagnostics:#?}");
    let geared = changed("EngineSpeed", |_, samples| samples.iter_mut().for_each(|value| *value *= 1.7));
    assert!(matches!(only(&run(&geared).1).finding, Finding::SpeedsDisagree { .. }));
}

#[test]
fn regress_saturated_demand() {
    let recording = changed("DynoTorqueDemand", |_, samples| {
        samples[3000..3100].fill(80.0);
        samples[3105..3150].fill(-80.0);
        samples[7000..7002].fill(90.0);
    });
    let file = bench_file("torque = \"80 Nm\"", &[]);
    let (experiment, diagnostics) = run_with(&recording, &file, "WhiteNoise_T_TN");
    let saturated = diagnostics.iter().find(|d| matches!(d.finding, Finding::Saturated { .. })).unwrap();
    let Finding::Saturated { share, limit_nm } = saturated.finding else { panic!() };
    assert_eq!((saturated.place.time_s, limit_nm), (Some(3.0), 80.0));
    assert!((share - 147.0 / 8000.0).abs() < 1e-12);
    let stretches = saturated_stretches(&experiment, 80.0);
    let [first, second] = stretches[..] else { panic!("{stretches:?}") };
    assert!((first.0 - 3.0).abs() < 1e-9 && (first.1 - 3.15).abs() < 1e-9);
    assert!((second.0 - 7.0).abs() < 1e-9 && (second.1 - 7.002).abs() < 1e-9);
}

#[test]
fn regress_wrong_torque_sign() {
    for name in ["DynoTorqueCalc", "DynoTorqueMeas", "DynoTorqueDemand"] {
        let recording = changed(name, |_, samples| samples.iter_mut().for_each(|value| *value = -*value));
        let (_, diagnostics) = run(&recording);
        let found = only(&diagnostics);
        assert!(matches!(found.finding, Finding::WrongTorqueSign { correlation } if correlation < -0.3), "{found:?}");
        assert_eq!(found.place.channel.as_deref(), Some(name));
    }
}

#[test]
fn regress_nothing_usable() {
    let result = prepare("a.mf4", &recording(0.0, &[]), &bench_file("", &[]), "BS_T_NT".parse().unwrap());
    let Err(PrepareError::NothingUsable { file, diagnostics }) = result else { panic!("{result:?}") };
    assert_eq!((file.as_str(), diagnostics.len()), ("a.mf4", 7));
    for count in [0, 1, 2, 3] {
        let short = recording(0.0, &[("DynoSpeed", "rpm", 1e-3, vec![1200.0; count])]);
        let _ = prepare("a.mf4", &short, &bench_file("", &[]), "BS_T_NT".parse().unwrap());
    }
}

#[test]
fn regress_reader_findings_are_passed_on() {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    recording.findings.push(recording::Finding::NotFinalised);
    let (_, diagnostics) = run(&recording);
    assert!(matches!(only(&diagnostics).finding, Finding::ReaderDoubt { .. }));
    assert_eq!(diagnostics[0].severity, Severity::Warning);
}

/// Of each list the first role that is there; a gap in a channel that is not compared costs nothing.
#[test]
fn exact_a_run_is_prepared_from_what_is_compared_alone() {
    let mut text = String::from("time [s],N [rpm],M [Nm],other [Nm]\n");
    for row in 0..400 {
        let other = if (100..200).contains(&row) { String::new() } else { "5".to_owned() };
        // A torque that rests for seconds is that of those seconds.
        let torque = if row < 200 { 0 } else { row };
        text.push_str(&format!("{:.2},{},{torque},{other}\n", 0.05 * f64::from(row), 1000 + row));
    }
    let recording = recording::decode("run.csv", text.as_bytes(), &recording::Selection::All).unwrap();
    let channels = "[channels]\nengine_speed = \"absent\"\ndyno_speed = \"N\"\nflange_torque = \"M\"\nair_gap_torque = \"other\"\n";
    let run: rig::RunChannels = channels.parse().unwrap();
    let compared: [&[Role]; 2] = [&[Role::EngineSpeed, Role::DynoSpeed], &[Role::FlangeTorque, Role::AirGapTorque]];
    let label = || "FreeForm_N_NT".parse().unwrap();
    let (experiment, found) = rig::prepare_run("run.csv", &recording, &run, &compared, label()).unwrap();
    assert_eq!(experiment.signals.keys().copied().collect::<Vec<_>>(), [Role::DynoSpeed, Role::FlangeTorque]);
    assert!(experiment.signals.values().all(|signal| signal.len() == 400), "{found:?}");
    assert!(found.iter().all(|one| matches!(one.finding, Finding::MissingChannel { .. })), "{found:?}");
    let none: [&[Role]; 1] = [&[Role::Throttle]];
    assert!(rig::prepare_run("run.csv", &recording, &run, &none, label()).is_err());
}
