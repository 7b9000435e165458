//! Predicted probabilities against virtual benches that run the test.
//!
//! Every bench is another one. The virtual bench has firing cylinders, an encoder and sensors; drive ripple, noise and
//! eccentric encoders are no part of the prediction.

use std::ops::RangeInclusive;

use bench_model::disturbances::Disturbances;
use bench_model::document::Validity;
use bench_model::model::{AssembledModel, BenchModel, ModelParameter, ModelUncertainty, PartCovariance};
use bench_testkit::benches::bench_file;
use bench_testkit::recordings::BENCH_A;
use capability::{CanInputs, Demand, FollowingSpread, LimitOf, can, shapes};
use design::safety::{BenchSpread, FrictionSpread};
use numerics::parallel;
use numerics::random::Stream;
use rig::bench_file::Limits;
use rig::bench_parameters::BenchParameters;
use rig::engine_pulses::KnownPulses;
use rig::experiment::catalogue::Settings;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use signal::proportion::Proportion;
use study::{Campaign, Prepared, Source};
use virtual_bench::{Numerics, simulate, simulate_hidden};

/// Benches with an estimate drawn, and benches that are identified from recordings.
const DRAWN: u64 = 1000;
const IDENTIFIED: u64 = 200;
/// Draws of each prediction.
const DRAWS: usize = 80;
/// Standard errors of K, B and J_e, relative.
const ERRORS: [f64; 3] = [0.05, 0.3, 0.03];
/// Standard deviation of the stated inertias of dynamometer and engine about the true ones, relative.
const STATED: [f64; 2] = [0.008, 0.015];
/// Length of the recordings of a bench that is identified, s.
const RECORDED_S: f64 = 16.0;
/// Classes of predicted probabilities.
const CLASSES: usize = 5;
/// Standard deviations by which what occurs in a class may differ from what was stated.
const DEVIATIONS: f64 = 3.0;

/// A bench, and what is known of it.
pub(crate) struct Known {
    pub(crate) truth: BenchParameters,
    pub(crate) model: BenchModel,
    pub(crate) uncertainty: ModelUncertainty,
}

/// A bench unlike the others.
fn unlike(random: &mut Stream) -> BenchParameters {
    let mut bench = BenchParameters::default();
    let mut spread = |value: &mut f64, share: f64| *value *= (share * random.normal()).exp();
    spread(&mut bench.mechanics.shaft_stiffness_nm_per_rad, 0.2);
    spread(&mut bench.mechanics.shaft_damping_nm_s_per_rad, 0.3);
    spread(&mut bench.mechanics.engine_inertia_kg_m2, 0.1);
    bench
}

/// An estimate, and the bench that it is of. The estimate comes first and the truth from its covariance, which is what
/// the covariance says. An estimate about the truth would not do: B of these benches spreads as far as its estimate
/// errs, so that the truth behind an unusual estimate is nearer to the usual, and exact predictions of 49 % occur on 30
/// to 42 %.
pub(crate) fn drawn(seed: u64) -> Known {
    let mut random = Stream::new(seed, 3);
    let mut bench = unlike(&mut random);
    let model = BenchModel::of(&bench);
    let of = [ModelParameter::Stiffness, ModelParameter::Damping, ModelParameter::EngineInertia];
    let mut covariance = vec![vec![0.0; 3]; 3];
    for (k, (parameter, error)) in of.into_iter().zip(ERRORS).enumerate() {
        covariance[k][k] = (error * model.value(parameter).unwrap()).powi(2);
    }
    let part = PartCovariance { parameters: of.to_vec(), covariance, degrees_of_freedom: f64::INFINITY };
    let uncertainty = ModelUncertainty::new(&[part]).unwrap();
    let true_model = uncertainty.draw(&model, &mut random).unwrap();
    bench.mechanics.shaft_stiffness_nm_per_rad = true_model.mechanics.stiffness_nm_per_rad;
    bench.mechanics.shaft_damping_nm_s_per_rad = true_model.mechanics.damping_nm_s_per_rad;
    bench.mechanics.engine_inertia_kg_m2 = true_model.mechanics.engine_inertia_kg_m2;
    Known { truth: bench, model, uncertainty }
}

/// A bench, and what the study of two recordings of it gives.
fn identified(seed: u64) -> Known {
    let mut random = Stream::new(seed, 3);
    let truth = unlike(&mut random);
    let mechanics = &truth.mechanics;
    let mut stated = |inertia: f64, error: f64| (inertia * (1.0 + error * random.normal())).to_string();
    let dyno = stated(mechanics.dyno_inertia_kg_m2, STATED[0]);
    let engine = stated(mechanics.engine_inertia_kg_m2, STATED[1]);
    let file = bench_file(&dyno, &engine, "400 Nm", BENCH_A);
    let plans = [
        ("BS_T_NT.mf4", ExperimentPlan::bs_t_nt(1200.0, RECORDED_S)),
        ("WhiteNoise_T_TN.mf4", ExperimentPlan::white_noise_t_tn(1200.0, RECORDED_S)),
    ];
    let recorded = |((name, plan), seed): (&(&str, ExperimentPlan), u64)| Source {
        file: (*name).to_owned(),
        sha256: format!("hash of {name}"),
        recording: Ok(simulate(&truth, plan, seed).unwrap()),
    };
    let sources = plans.iter().zip(2 * seed + 1_000_000..).map(recorded).collect();
    let recordings = Prepared::of(&file, sources, &work::Context::new());
    let campaign = Campaign { bench: &file, bench_file: ("bench.toml", "as written"), recordings, seed: Some(3) };
    let AssembledModel { model, uncertainty, .. } = study::run(campaign, &work::Context::new()).unwrap().model.unwrap();
    Known { truth, model, uncertainty }
}

/// The largest shaft torque that really occurs, Nm.
fn reached_nm(truth: &BenchParameters, seed: u64, plan: &ExperimentPlan) -> f64 {
    let torque = simulate_hidden(truth, plan, seed, Numerics::default()).unwrap().hidden.shaft_torque_nm;
    torque.iter().fold(0.0, |most: f64, torque| most.max(torque.abs()))
}

/// Prediction for one bench, and what happened.
struct One {
    stated: f64,
    is_reached: bool,
    is_in_band: bool,
    /// Median of the prediction less the peak, Nm.
    above_nm: f64,
}

fn one(known: &Known, seed: u64, plan: &ExperimentPlan, limit_nm: f64) -> One {
    let demands = Demands::of(plan, seed, DEMAND_HOLD_S);
    let inputs = CanInputs {
        demand: Demand::Plan(plan, &demands),
        model: &known.model,
        engine: &known.truth.engine,
        pulses: &KnownPulses::Stated,
        limits: Limits { shaft_torque_nm: Some(limit_nm), ..Limits::default() },
        validity: Validity::default(),
        spread: BenchSpread::Estimated(&known.uncertainty),
        slowest_engine_control: 1.0,
        friction: FrictionSpread::NONE,
        disturbances: Disturbances::default(),
        following: FollowingSpread::NONE,
        filter_hz: None,
        sets: &[],
        own: &[],
        samples: DRAWS,
        seed,
    };
    let verdict = can(&inputs, &work::Context::new()).unwrap();
    let shaft = verdict.limits.iter().find(|one| one.of == LimitOf::ShaftTorque).unwrap();
    // Of another engine run than any that was predicted.
    let peak = reached_nm(&known.truth, seed + 2_000_000, plan);
    One {
        stated: shaft.reached.unwrap().estimate,
        is_reached: peak >= limit_nm,
        is_in_band: peak >= shaft.values.quantile(0.05) && peak <= shaft.values.quantile(0.95),
        above_nm: shaft.values.quantile(0.5) - peak,
    }
}

/// A tip-in whose pulses of order 1 meet the resonance, and the peak that half of the benches reach, Nm.
fn tip_in() -> (ExperimentPlan, f64) {
    let tip_in = shapes::find("tip-in").unwrap();
    let given = [("to", "110"), ("speed", "1100"), ("duration", "3")];
    let plan = tip_in.plan(&Settings::parse(tip_in.parameters, &given).unwrap()).unwrap();
    let seeds: Vec<u64> = (0..40).collect();
    let mut peaks = parallel::map(&seeds, |seed| reached_nm(&unlike(&mut Stream::new(*seed, 3)), *seed, &plan));
    peaks.sort_by(f64::total_cmp);
    let limit_nm = peaks[peaks.len() / 2];
    (plan, limit_nm)
}

/// Prints what was found, and checks it; so many peaks are to be in the 90 % band.
fn judge(all: &[One], largest_brier: f64, shares: RangeInclusive<f64>) {
    let count = all.len() as f64;
    let brier = all.iter().map(|one| (one.stated - f64::from(one.is_reached)).powi(2)).sum::<f64>() / count;
    let in_band = Proportion::new(all.iter().filter(|one| one.is_in_band).count(), all.len());
    let above_nm = all.iter().map(|one| one.above_nm).sum::<f64>() / count;
    println!(
        "Brier score {brier:.4}, peaks in the 90 % band: {:.1} %, medians {above_nm:+.2} Nm above the peaks",
        100.0 * in_band.estimate
    );
    let mut wrong = Vec::new();
    for class in 0..CLASSES {
        let (from, to) = (class as f64 / CLASSES as f64, (class + 1) as f64 / CLASSES as f64);
        let inside: Vec<_> =
            all.iter().filter(|one| one.stated >= from && (one.stated < to || class + 1 == CLASSES)).collect();
        let stated: f64 = inside.iter().map(|one| one.stated).sum();
        let deviation = inside.iter().map(|one| one.stated * (1.0 - one.stated)).sum::<f64>().sqrt();
        let occurs = inside.iter().filter(|one| one.is_reached).count() as f64;
        let percent = |sum: f64| 100.0 * sum / inside.len().max(1) as f64;
        println!(
            "stated {:3.0} … {:3.0} %: {} benches, mean {:.1} %, occurs on {:.1} % (± {:.1} %)",
            100.0 * from,
            100.0 * to,
            inside.len(),
            percent(stated),
            percent(occurs),
            percent(deviation)
        );
        wrong.extend(((occurs - stated).abs() > DEVIATIONS * deviation.max(1.0)).then_some(class));
    }
    assert!(wrong.is_empty(), "classes {wrong:?}");
    assert!(brier < largest_brier, "{brier}");
    assert!(shares.contains(&in_band.estimate), "{in_band:?}");
}

#[test]
#[ignore = "slow: 80 000 predictions and 1000 runs of virtual benches"]
fn stat_stated_probabilities_are_those_that_occur() {
    let (plan, limit_nm) = tip_in();
    let seeds: Vec<u64> = (1000..1000 + DRAWN).collect();
    // Climatology, half and half, has 0.25.
    judge(&parallel::map(&seeds, |seed| one(&drawn(*seed), *seed, &plan, limit_nm)), 0.15, 0.87..=0.93);
}

#[test]
#[ignore = "slow: 200 studies of two recordings, 16 000 predictions"]
fn stat_probabilities_of_identified_benches_are_those_that_occur() {
    let (plan, limit_nm) = tip_in();
    let seeds: Vec<u64> = (5000..5000 + IDENTIFIED).collect();
    // Measured: 94.5 %. A study takes stated inertias as known to 1 and 2 %, and these are known to 0.8 and 1.5 %.
    judge(&parallel::map(&seeds, |seed| one(&identified(*seed), *seed, &plan, limit_nm)), 0.05, 0.87..=0.97);
}
