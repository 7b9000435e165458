//! Predicted probabilities against virtual benches that run the test.
//!
//! Every bench is another one. What is known of it is an estimate with the covariance by which the estimate differs from the truth.
//! The virtual bench has firing cylinders, an encoder and sensors, which the prediction does not have or has in another form.

use bench_model::model::{BenchModel, ModelParameter, ModelUncertainty, PartCovariance};
use capability::{CanInputs, Demand, LimitOf, can, shapes};
use design::safety::{BenchSpread, Proportion};
use numerics::parallel;
use numerics::random::Stream;
use rig::bench_file::Limits;
use rig::bench_parameters::BenchParameters;
use rig::experiment::catalogue::Settings;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use virtual_bench::{Numerics, simulate_hidden};

pub(crate) const BENCHES: u64 = 200;
const DRAWS: usize = 80;
/// Standard errors of K, B and J_e, relative.
const ERRORS: [f64; 3] = [0.05, 0.3, 0.03];
/// Classes of predicted probabilities.
const CLASSES: usize = 5;
/// A class may be so far off.
const CAUTION: f64 = 0.06;

/// A bench unlike the others, and what a study would say of it.
pub(crate) fn drawn(seed: u64) -> (BenchParameters, BenchModel, ModelUncertainty) {
    let mut random = Stream::new(seed, 3);
    let mut truth = BenchParameters::default();
    let mut spread = |value: &mut f64, share: f64| *value *= (share * random.normal()).exp();
    spread(&mut truth.mechanics.shaft_stiffness_nm_per_rad, 0.2);
    spread(&mut truth.mechanics.shaft_damping_nm_s_per_rad, 0.3);
    spread(&mut truth.mechanics.engine_inertia_kg_m2, 0.1);
    let exact = BenchModel::of(&truth);
    let of = [ModelParameter::Stiffness, ModelParameter::Damping, ModelParameter::EngineInertia];
    let mut estimate = exact.clone();
    let mut variances = vec![vec![0.0; 3]; 3];
    for (k, (parameter, error)) in of.into_iter().zip(ERRORS).enumerate() {
        let sigma = error * exact.value(parameter).unwrap();
        let value = exact.value(parameter).unwrap() + sigma * random.normal();
        estimate = estimate.with(parameter, value.max(0.1 * sigma));
        variances[k][k] = sigma * sigma;
    }
    let part = PartCovariance { parameters: of.to_vec(), covariance: variances, degrees_of_freedom: f64::INFINITY };
    (truth, estimate, ModelUncertainty::new(&[part]).unwrap())
}

/// The largest shaft torque that really occurs, Nm.
fn reached_nm(truth: &BenchParameters, seed: u64, plan: &ExperimentPlan) -> f64 {
    let run = simulate_hidden(truth, plan, seed, Numerics::default()).unwrap();
    let truth = run.hidden.recording();
    let torque = truth.channels.iter().find(|channel| channel.name == "true_shaft_torque").unwrap();
    torque.samples.iter().fold(0.0, |most: f64, torque| most.max(torque.abs()))
}

/// What was predicted of one bench, and whether it happened; and whether the peak was in the stated 90 % band.
fn one(seed: u64, plan: &ExperimentPlan, limit_nm: f64) -> (f64, bool, bool) {
    let (truth, model, uncertainty) = drawn(seed);
    let demands = Demands::of(plan, seed, DEMAND_HOLD_S);
    let inputs = CanInputs {
        demand: Demand::Plan(plan, &demands),
        model: &model,
        engine: &truth.engine,
        limits: Limits { shaft_torque_nm: Some(limit_nm), ..Limits::default() },
        spread: BenchSpread::Estimated(&uncertainty),
        slowest_engine_control: 1.0,
        filter_hz: None,
        sets: &[],
        own: &[],
        samples: DRAWS,
        seed,
    };
    let verdict = can(&inputs, &|_, _| {}).unwrap();
    let shaft = verdict.limits.iter().find(|one| one.of == LimitOf::ShaftTorque).unwrap();
    let peak = reached_nm(&truth, seed, plan);
    let in_band = peak >= shaft.quantile(0.05) && peak <= shaft.quantile(0.95);
    (shaft.reached.unwrap().estimate, peak >= limit_nm, in_band)
}

#[test]
#[ignore = "slow: 16 000 predictions and 200 runs of virtual benches"]
fn stat_stated_probabilities_are_those_that_occur() {
    let tip_in = shapes::find("tip-in").unwrap();
    let given = [("to", "110"), ("speed", "1100"), ("duration", "3")];
    let plan = tip_in.plan(&Settings::parse(tip_in.parameters, &given).unwrap()).unwrap();
    let peaks = parallel::map(&(0..40_u64).collect::<Vec<_>>(), |seed| reached_nm(&drawn(*seed).0, *seed, &plan));
    let mut sorted = peaks;
    sorted.sort_by(f64::total_cmp);
    // Half of the benches reach it.
    let limit_nm = sorted[sorted.len() / 2];
    let seeds: Vec<u64> = (1000..1000 + BENCHES).collect();
    let all = parallel::map(&seeds, |seed| one(*seed, &plan, limit_nm));
    let brier = all.iter().map(|(p, reached, _)| (p - f64::from(*reached)).powi(2)).sum::<f64>() / all.len() as f64;
    let in_band = Proportion::new(all.iter().filter(|one| one.2).count(), all.len());
    println!(
        "limit {limit_nm:.1} Nm, Brier score {brier:.4}, peaks in the 90 % band: {:.1} %",
        100.0 * in_band.estimate
    );
    let mut wrong = Vec::new();
    for class in 0..CLASSES {
        let (from, to) = (class as f64 / CLASSES as f64, (class + 1) as f64 / CLASSES as f64);
        let inside: Vec<_> = all.iter().filter(|one| one.0 >= from && (one.0 < to || class + 1 == CLASSES)).collect();
        let stated = inside.iter().map(|one| one.0).sum::<f64>() / inside.len().max(1) as f64;
        let occurs = Proportion::new(inside.iter().filter(|one| one.1).count(), inside.len());
        println!(
            "stated {:3.0} … {:3.0} %: {} benches, mean {:.1} %, occurs on {:.1} % ({:.0} … {:.0} %)",
            100.0 * from,
            100.0 * to,
            inside.len(),
            100.0 * stated,
            100.0 * occurs.estimate,
            100.0 * occurs.lower,
            100.0 * occurs.upper
        );
        let is_off = stated < occurs.lower - CAUTION || stated > occurs.upper + CAUTION;
        wrong.extend((!inside.is_empty() && is_off).then_some(class));
    }
    assert!(wrong.is_empty(), "classes {wrong:?}");
    // Climatology, half and half, has 0.25.
    assert!(brier < 0.15, "{brier}");
}
