//! Faults of channels and labels that are named.

use bench_testkit::recordings::{BENCH_A, bench_file, named, noise};
use recording::{Raster, Recording};
use rig::{Diagnostic, Experiment, Finding, LikelyUnit, PrepareError, Role, SeenInstead, Severity, prepare};

fn prepared(recording: &Recording) -> (Experiment, Vec<Diagnostic>) {
    labelled(recording, "WhiteNoise_T_TN").unwrap()
}

fn labelled(recording: &Recording, label: &str) -> Result<(Experiment, Vec<Diagnostic>), PrepareError> {
    prepare("a.mf4", recording, &bench_file("torque = \"200 Nm\"", &[]), label.parse().unwrap())
}

/// The simulated test with a channel on a raster of its own, `sample_time_s` apart.
fn with(name: &str, sample_time_s: f64, work: impl FnOnce(&[f64]) -> Vec<f64>) -> Recording {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    let index = recording.channels.iter().position(|channel| channel.name == name).unwrap();
    let samples = work(&recording.channels[index].samples);
    let time_s = (0..samples.len()).map(|i| i as f64 * sample_time_s).collect();
    recording.rasters.push(Raster { time_s, name: None });
    recording.channels[index].raster = recording.rasters.len() - 1;
    recording.channels[index].samples = samples;
    recording
}

fn scaled(name: &str, gain: f64, offset: f64) -> Recording {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    let channel = recording.channels.iter_mut().find(|channel| channel.name == name).unwrap();
    channel.samples.iter_mut().for_each(|x| *x = gain * *x + offset);
    recording
}

fn found<'a>(diagnostics: &'a [Diagnostic], channel: &str) -> Vec<&'a Finding> {
    diagnostics.iter().filter(|d| d.place.channel.as_deref() == Some(channel)).map(|d| &d.finding).collect()
}

#[test]
fn regress_of_a_slow_channel_on_a_fast_raster_its_own_samples_are_used() {
    let (plain, _) = prepared(&named(BENCH_A, "rpm", "Nm"));
    let plain = plain.signal(Role::EngineSpeed).unwrap();
    let held = with("EngineSpeed", 1e-3, |x| x.iter().flat_map(|x| [*x; 2]).collect());
    let straight = with("EngineSpeed", 1e-3, |x| x.windows(2).flat_map(|p| [p[0], 0.5 * (p[0] + p[1])]).collect());
    for (recording, interpolated) in [(held, false), (straight, true)] {
        let (experiment, diagnostics) = prepared(&recording);
        let speed = experiment.signal(Role::EngineSpeed).unwrap();
        assert!((speed.sample_time_s - 2e-3).abs() < 1e-12);
        let first = plain.samples.iter().position(|x| *x == speed.samples[0]).unwrap();
        assert_eq!(speed.samples[..3000], plain.samples[first..first + 3000]);
        assert!((speed.start_s - plain.time_s(first)).abs() < 1e-9);
        assert_eq!(found(&diagnostics, "EngineSpeed"), [&Finding::SamplesRaised { every: 2, interpolated }]);
    }
}

#[test]
fn regress_repeated_samples_are_left_out() {
    let recording = with("DynoSpeed", 1e-3, |x| {
        let mut repeated = x.to_vec();
        (1..x.len()).filter(|i| noise(*i, 11) > 0.6).for_each(|i| repeated[i] = repeated[i - 1]);
        repeated
    });
    let (_, diagnostics) = prepared(&recording);
    let found = found(&diagnostics, "DynoSpeed");
    assert!(matches!(found[0], Finding::SamplesRepeated { share, .. } if (share - 0.2).abs() < 0.03), "{found:?}");
}

#[test]
fn regress_repeated_samples_of_a_computed_demand_are_named() {
    let recording = with("DynoTorqueDemand", 1e-3, |x| {
        let mut repeated: Vec<f64> = (0..x.len()).map(|i| 20.0 + (0.7 * i as f64).sin()).collect();
        (1..x.len()).filter(|i| i * i % 7 == 1).for_each(|i| repeated[i] = repeated[i - 1]);
        repeated
    });
    let (_, diagnostics) = labelled(&recording, "BS_T_NT").unwrap();
    let found = found(&diagnostics, "DynoTorqueDemand");
    assert!(found.iter().any(|finding| matches!(finding, Finding::SamplesRepeated { .. })), "{found:?}");
}

/// N_d in steps repeats by chance, and T_d* of the controller that reads it then repeats too. Repeats of a logger are
/// named all the same.
#[test]
fn regress_a_demand_that_rests_where_the_speed_does_is_not_named() {
    let (step, gain) = (0.01, 0.047);
    let speed = |k: usize| 1200.0 + 0.9 * (0.01 * k as f64).sin() + 0.2 * (0.6 * k as f64).sin();
    let seen: Vec<f64> = (0..8000).map(|k| ((speed(k) + 0.02 * noise(k, 3)) / step).round() * step).collect();
    let mut integral = 0.0;
    let demand = |k: usize| {
        integral += 2e-5 * (seen[k] - 1200.0);
        ((20.0 + gain / step * (seen[k.saturating_sub(2)] - 1200.0) + integral) / step).round() * step
    };
    let demand: Vec<f64> = (0..8000).map(demand).collect();
    let named = |demand: Vec<f64>| {
        let mut recording = with("DynoTorqueDemand", 1e-3, |_| demand.clone());
        let of = recording.channels.iter_mut().find(|channel| channel.name == "DynoSpeed").unwrap();
        of.samples.clone_from(&seen);
        let (_, diagnostics) = labelled(&recording, "BS_T_NT").unwrap();
        let found = found(&diagnostics, "DynoTorqueDemand");
        found.iter().any(|finding| matches!(finding, Finding::SamplesRepeated { .. }))
    };
    assert!(!named(demand.clone()));
    let mut repeated = demand;
    (1..repeated.len()).filter(|i| i * i % 7 == 1).for_each(|i| repeated[i] = repeated[i - 1]);
    assert!(named(repeated));
}

#[test]
fn regress_spikes_are_left_out_of_speeds_and_of_torques_that_nobody_asked_for() {
    for (name, step_s) in [("DynoSpeed", 1e-3), ("EngineSpeed", 2e-3), ("DynoTorqueCalc", 4e-3)] {
        let recording = with(name, step_s, |x| {
            let mut spiked = x.to_vec();
            (1..8).for_each(|k| spiked[200 * k] = 0.0);
            spiked
        });
        let (experiment, diagnostics) = prepared(&recording);
        let found = found(&diagnostics, name);
        assert!(matches!(found[0], Finding::Spikes { count: 7, .. }), "{name}: {found:?}");
        assert!(experiment.signals.values().all(|signal| signal.samples.iter().all(|x| *x > 20.0)));
    }
}

/// A change of level, a ramp, and pulses that come often stay.
#[test]
fn regress_spikes_are_left_out_of_demands_that_are_held() {
    let held = |i: usize| 10.0 + 10.0 * ((i / 10) * 7 % 5) as f64;
    let spiked = |every: usize| move |i: usize| if i.is_multiple_of(every) { 3.0 * held(i) + 100.0 } else { held(i) };
    let demand = |value: &dyn Fn(usize) -> f64| {
        let mut length = 0;
        let recording = with("DynoTorqueDemand", 1e-3, |x| {
            length = x.len();
            (0..length).map(value).collect()
        });
        let (experiment, diagnostics) = prepared(&recording);
        let count = |finding: &&Finding| if let Finding::Spikes { count, .. } = finding { *count } else { 0 };
        let count: usize = found(&diagnostics, "DynoTorqueDemand").iter().map(count).sum();
        (experiment.signal(Role::DynoTorqueDemand).unwrap().samples.clone(), count, length)
    };
    let (clean, none, length) = demand(&held);
    assert_eq!(none, 0);
    for every in [137, 203] {
        let (mended, count, _) = demand(&spiked(every));
        assert_eq!(count, (2..length - 2).filter(|i| i.is_multiple_of(every)).count(), "{every}");
        // Between two levels a sample may belong to either.
        let differ: Vec<usize> = (2..clean.len()).filter(|i| mended[*i] != clean[*i]).collect();
        assert!(differ.iter().all(|i| (mended[*i] - clean[*i]).abs() <= 30.0), "{differ:?}");
        assert!(differ.len() <= count / 4, "{differ:?}");
    }
    assert_eq!(demand(&spiked(30)).1, 0);
    assert_eq!(demand(&|i| i.clamp(1000, 1200) as f64 / 10.0).1, 0);
}

#[test]
fn regress_torques_that_are_not_alike() {
    let kinds = |recording: &Recording| {
        let (_, diagnostics) = prepared(recording);
        let kind = |d: &Diagnostic| match &d.finding {
            Finding::TorquesDisagree { role, gain, offset_nm, looks_like } => {
                Some((*role, (100.0 * gain).round(), offset_nm.round(), *looks_like))
            }
            _ => None,
        };
        diagnostics.iter().filter_map(kind).collect::<Vec<_>>()
    };
    let (demand, cell) = (Role::DynoTorqueDemand, Role::LoadCellTorque);
    assert_eq!(kinds(&scaled("DynoTorqueDemand", 1.0, 0.0)), []);
    let percent = Some((demand, LikelyUnit::PercentOfLimit));
    assert_eq!(kinds(&scaled("DynoTorqueDemand", 0.5, 0.0)), [(demand, 50.0, 0.0, percent)]);
    let pound_foot = Some((cell, LikelyUnit::PoundFoot));
    assert_eq!(kinds(&scaled("DynoTorqueMeas", 1.0 / 1.3558, 0.0)), [(cell, 74.0, 0.0, pound_foot)]);
    assert_eq!(kinds(&scaled("DynoTorqueMeas", 1.0, 10.0)), [(cell, 100.0, 10.0, None)]);
}

#[test]
fn regress_labels_that_the_recording_contradicts() {
    let seen = |recording: &Recording, label: &str| match labelled(recording, label) {
        Ok((_, diagnostics)) => (false, contradiction(&diagnostics)),
        Err(PrepareError::Mislabelled { diagnostics, .. }) => (true, contradiction(&diagnostics)),
        Err(other) => panic!("{other}"),
    };
    let recording = named(BENCH_A, "rpm", "Nm");
    assert_eq!(seen(&recording, "WhiteNoise_T_TN"), (false, None));
    assert_eq!(seen(&recording, "BS_T_NT"), (true, Some(SeenInstead::TorqueControl)));
    assert_eq!(seen(&recording, "NoShaft_N_NT"), (true, Some(SeenInstead::ShaftOn)));
    // A controller that answers to every change of N_d.
    let speed = recording.channel("DynoSpeed").unwrap().samples.clone();
    let mut answering = recording.clone();
    let demand = answering.channels.iter_mut().find(|channel| channel.name == "DynoTorqueDemand").unwrap();
    demand.samples = speed.iter().map(|n| 60.0 + 0.9 * (n - 1200.0)).collect();
    assert_eq!(seen(&answering, "WhiteNoise_T_TN"), (true, Some(SeenInstead::SpeedControl)));
    assert_eq!(seen(&answering, "BS_T_NT"), (false, None));
    let demand = answering.channels.iter_mut().find(|channel| channel.name == "DynoSpeedDemand").unwrap();
    demand.samples.iter_mut().enumerate().for_each(|(i, n)| *n += 0.05 * i as f64);
    assert_eq!(seen(&answering, "BS_T_NT"), (false, Some(SeenInstead::SpeedDemandChanges)));
}

fn contradiction(diagnostics: &[Diagnostic]) -> Option<SeenInstead> {
    diagnostics.iter().find_map(|d| match d.finding {
        Finding::LabelContradicted { seen, .. } => Some(seen),
        _ => None,
    })
}

#[test]
fn regress_a_filter_a_slow_raster_and_coarse_steps_of_the_speed() {
    let filtered = with("DynoSpeed", 1e-3, |x| {
        let filter = signal::Sos::butterworth_lowpass(2, 60.0, 1e-3).unwrap();
        filter.filter(x, &mut filter.state_at_level(x[0]))
    });
    let (_, diagnostics) = prepared(&filtered);
    let of_speed = found(&diagnostics, "DynoSpeed");
    assert!(of_speed.iter().any(|f| matches!(f, Finding::SamplesFiltered { ratio } if *ratio < 0.01)), "{of_speed:?}");
    let (_, diagnostics) = prepared(&with("DynoSpeed", 0.01, |x| x.iter().step_by(10).copied().collect()));
    let slow = found(&diagnostics, "DynoSpeed");
    assert!(matches!(slow[0], Finding::SlowRaster { is_in_ms: false, .. }), "{slow:?}");
    let (_, diagnostics) = prepared(&with("DynoSpeed", 1e-3, |x| x.iter().map(|x| x.round()).collect()));
    let coarse = found(&diagnostics, "DynoSpeed");
    assert!(matches!(coarse[0], Finding::CoarseResolution { role: Role::DynoSpeed, .. }), "{coarse:?}");
}

#[test]
fn regress_a_clock_that_is_one_per_cent_off_is_named() {
    let mut recording = named(BENCH_A, "rpm", "Nm");
    let raster = recording.channel("DynoTorqueCalc").unwrap().raster;
    let rasters: Vec<usize> = recording.channels.iter().filter(|c| c.name == "EngineSpeed").map(|c| c.raster).collect();
    assert!(!rasters.contains(&raster));
    rasters.iter().for_each(|raster| recording.rasters[*raster].time_s.iter_mut().for_each(|t| *t *= 1.01));
    let (_, diagnostics) = prepared(&recording);
    let rate = diagnostics.iter().find_map(|d| match d.finding {
        Finding::ClockDrift { rate, .. } => Some((d.severity, rate)),
        _ => None,
    });
    assert!(matches!(rate, Some((Severity::Warning, rate)) if (rate - 0.01).abs() < 2e-4), "{diagnostics:?}");
}
