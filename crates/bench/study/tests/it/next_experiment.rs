//! Gain from a further recording: what is promised, and what comes true.

use rig::BenchFile;
use rig::bench_file::ShaftPrior;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::results::Quantity;
use study::{Gain, NextError, NextExperiments, NextOptions, Prepared, Source, next_experiments};
use virtual_bench::simulate;

use crate::study::source;
use bench_testkit::benches::{bench_file, default_bench};
use bench_testkit::recordings::BENCH_A;

const DURATION_S: f64 = 16.0;

fn asked(bench: &BenchFile, sources: Vec<Source>) -> Result<NextExperiments, NextError> {
    let options = NextOptions { duration_s: DURATION_S, enough: 0.002, ..NextOptions::default() };
    next_experiments(bench, Prepared::of(bench, sources, &work::Context::new()), options, &work::Context::new())
}

/// Recordings of a bench that no bench file tells all of: its clocks are apart and its speeds noisy.
fn recorded(file: &str, plan: &ExperimentPlan, seed: u64) -> Source {
    let mut parameters = BenchParameters::default();
    parameters.clocks.engine_speed_skew_s = 0.7e-3;
    parameters.sensors.speed_noise_rad_s *= 2.0;
    source(file, Ok(simulate(&parameters, plan, seed).unwrap()))
}

fn binary() -> Source {
    recorded("BS_T_NT_1200.mf4", &ExperimentPlan::bs_t_nt(1200.0, DURATION_S), 3)
}

fn gain<'a>(found: &'a NextExperiments, label: &str, quantity: Quantity) -> &'a Gain {
    let candidate = found.candidates.iter().find(|c| c.label.to_string() == label && !c.is_designed).unwrap();
    candidate.gains.iter().find(|gain| gain.quantity == quantity).unwrap()
}

/// The promise of an experiment is what a study states once it is recorded.
#[test]
#[ignore = "slow"]
fn stat_what_is_promised_is_kept() {
    let bench = default_bench();
    let promised = asked(&bench, vec![binary()]).unwrap();
    let white = ExperimentPlan::white_noise_t_tn(1200.0, DURATION_S);
    let then = asked(&bench, vec![binary(), recorded("WhiteNoise_T_TN_1200.mf4", &white, 5)]).unwrap();
    for quantity in [
        Quantity::ResonanceFrequency,
        Quantity::ResonanceGain,
        Quantity::ResonanceDampingRatio,
        Quantity::Stiffness,
        Quantity::Damping,
        Quantity::DynoInertia,
        Quantity::EngineInertia,
        Quantity::ProportionalGain,
        Quantity::IntegralGain,
    ] {
        let kept = then.now.iter().find(|p| p.quantity == quantity).unwrap();
        let kept = 0.5 * (kept.interval.1 - kept.interval.0);
        let ratio = gain(&promised, "WhiteNoise_T_TN", quantity).then / kept;
        // The interval of J_e scatters by an eighth from one recording to the next, and those of the resonance contain
        // it.
        let bound = match quantity {
            Quantity::EngineInertia => 1.7,
            Quantity::ResonanceFrequency | Quantity::ResonanceGain => 1.4,
            _ => 1.2,
        };
        assert!((1.0 / bound..bound).contains(&ratio), "{quantity}: {ratio}");
    }
}

/// After a binary sequence of the engine's torque alone, the inertias and the feed-forward are not known. White noise
/// tells the former, levels the latter; steps tell neither, and a shorter binary sequence nothing.
#[test]
#[ignore = "slow"]
fn stat_what_is_missing_is_recommended() {
    let found = asked(&default_bench(), vec![binary()]).unwrap();
    assert!(!found.now.iter().any(|p| [Quantity::EngineInertia, Quantity::SpeedFeedForward].contains(&p.quantity)));
    assert!(gain(&found, "WhiteNoise_T_TN", Quantity::EngineInertia).now.is_none());
    assert!(gain(&found, "Levels_N_NT", Quantity::SpeedFeedForward).is_worth_while());
    let best = &found.candidates[0];
    assert!(best.gains.iter().filter(|gain| gain.now.is_none()).count() >= 2, "{best:?}");
    let steps = found.candidates.iter().find(|c| c.label.to_string() == "Step_T_TN").unwrap();
    assert!(
        !steps
            .gains
            .iter()
            .any(|gain| gain.quantity == Quantity::EngineInertia || gain.quantity == Quantity::SpeedFeedForward)
    );
    assert!(found.candidates.windows(2).all(|pair| pair[0].worth(found.enough) >= pair[1].worth(found.enough)));
}

/// Within limits that leave room, a designed multisine tells the shaft better than white noise of the method's size.
#[test]
#[ignore = "slow"]
fn stat_a_designed_experiment_tells_the_shaft_best() {
    let mut bench = default_bench();
    bench.limits.shaft_torque_nm = Some(300.0);
    bench.shaft = ShaftPrior { resonance_hz: Some(18.0), ..ShaftPrior::default() };
    let found = asked(&bench, Vec::new()).unwrap();
    let designed = found.candidates.iter().find(|c| c.is_designed).unwrap();
    let of = |quantity: Quantity| designed.gains.iter().find(|gain| gain.quantity == quantity).unwrap().then;
    assert!(designed.peak_shaft_torque_nm < 300.0, "{}", designed.peak_shaft_torque_nm);
    for quantity in [Quantity::Stiffness, Quantity::Damping] {
        assert!(of(quantity) < gain(&found, "WhiteNoise_T_TN", quantity).then, "{quantity}");
    }
}

#[test]
fn exact_without_a_shaft_nothing_can_be_tried() {
    let bench = bench_file("0.6", "0.28", "400 Nm", BENCH_A);
    assert!(matches!(asked(&bench, Vec::new()), Err(NextError::UnknownShaft)));
}
