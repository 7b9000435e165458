//! Stretches of a recording that the bench file leaves out.

use demo::campaign::bench_file;
use part_controller::speed_controller::estimate;
use recording::Recording;
use rig::bench_file::{StatedStretch, StretchUse};
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::results::Quantity;
use rig::{BenchFile, prepare};
use virtual_bench::simulate;

/// The controller's gain with its interval, Nm s/rad.
fn gain(recording: &Recording, bench: &BenchFile) -> (f64, (f64, f64)) {
    let (experiment, _) = prepare("BS_T_NT.mf4", recording, bench, "BS_T_NT".parse().unwrap()).unwrap();
    let fit = estimate(&experiment, bench.limits.torque_nm).unwrap();
    let gain = fit.result.estimate.parameter(Quantity::ProportionalGain).unwrap();
    (gain.value, gain.interval)
}

/// For four seconds the encoder reads too much, by an error that moves with the engine's torque.
#[test]
fn stat_a_sensor_that_fails_spoils_no_estimate_where_its_stretch_is_left_out() {
    let parameters = BenchParameters::default();
    let truth = parameters.controller.proportional_nm_s_per_rad;
    let mut recording = simulate(&parameters, &ExperimentPlan::bs_t_nt(1200.0, 24.0), 3).unwrap();
    let clean = recording.clone();
    let speed = recording.channels.iter_mut().find(|channel| channel.name == "DynoSpeed").unwrap();
    speed.samples[4000..8000].iter_mut().for_each(|rpm| *rpm = 1200.0 + 1.5 * (*rpm - 1200.0));
    let mut bench = bench_file(&parameters, "*.mf4");
    let within = |(_, (low, high)): (f64, (f64, f64))| (low..=high).contains(&truth);
    assert!(within(gain(&clean, &bench)));
    let spoilt = gain(&recording, &bench);
    assert!(!within(spoilt), "{spoilt:?} {truth}");
    bench.recordings.stretches.push(StatedStretch {
        file: "BS_T_NT.mf4".to_owned(),
        from_s: 3.9,
        to_s: 8.1,
        usage: StretchUse::LeaveOut,
    });
    let mended = gain(&recording, &bench);
    assert!(within(mended), "{mended:?} {truth}");
    assert_eq!(mended, gain(&clean, &bench));
}
