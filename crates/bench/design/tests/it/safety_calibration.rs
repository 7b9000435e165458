//! Predicted probabilities against what virtual benches do that are drawn from the same spread.

use bench_model::disturbances::Disturbances;
use bench_model::friction::DynoFriction;
use bench_model::model::BenchModel;
use bench_model::prediction::PredictionInputs;
use design::safety::{BenchSpread, FrictionSpread, Prior, Quantity, SafetyInputs, check};
use numerics::parallel;
use rig::bench_file::Limits;
use rig::bench_parameters::{BenchParameters, MechanicsParameters};
use rig::engine_pulses::KnownPulses;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, UPDATE_S, Waveform};
use signal::distributions::normal_quantile;
use signal::excitation::Random;
use signal::proportion::Proportion;
use virtual_bench::{Numerics, simulate_hidden};

const BENCHES: usize = 200;
const PREDICTED: usize = 400;
/// Shares of benches that reach the limits which are tried.
const REACHED: [f64; 3] = [0.8, 0.5, 0.2];
const SEED: u64 = 7;

/// One of the benches that [`Prior::default`] describes.
fn drawn(seed: u64) -> BenchParameters {
    let nominal = BenchParameters::default();
    let mut random = Random::new(seed);
    let prior = Prior::default();
    let mut factor = |reach: f64| (reach.ln_1p() / normal_quantile(0.975) * random.normal()).exp();
    let (resonance, damping, inertia) = (factor(prior.resonance), factor(prior.damping), factor(prior.engine_inertia));
    let own = &nominal.mechanics;
    let engine_inertia = own.engine_inertia_kg_m2 * inertia;
    let mobility = |engine: f64| 1.0 / own.dyno_inertia_kg_m2 + 1.0 / engine;
    let mechanics = MechanicsParameters {
        engine_inertia_kg_m2: engine_inertia,
        shaft_stiffness_nm_per_rad: own.shaft_stiffness_nm_per_rad
            * resonance.powi(2)
            * mobility(own.engine_inertia_kg_m2)
            / mobility(engine_inertia),
        shaft_damping_nm_s_per_rad: own.shaft_damping_nm_s_per_rad * damping,
        ..own.clone()
    };
    BenchParameters { mechanics, ..nominal }
}

/// The plan with what one seed draws for its demands, so that another seed changes the bench alone.
fn drawn_once(plan: ExperimentPlan) -> ExperimentPlan {
    let demands = Demands::of(&plan, SEED, DEMAND_HOLD_S);
    let sampled = |values| Waveform::Sampled { sample_time_s: UPDATE_S, values };
    ExperimentPlan {
        speed_rad_s: sampled(demands.speed_rad_s),
        dyno_torque_nm: sampled(demands.dyno_torque_nm),
        engine_torque_nm: sampled(demands.engine_torque_nm),
        ..plan
    }
}

/// The largest shaft torque that really occurs, Nm.
fn largest_shaft_torque_nm(parameters: &BenchParameters, seed: u64, plan: &ExperimentPlan) -> f64 {
    let run = simulate_hidden(parameters, plan, seed, Numerics::default()).unwrap();
    let truth = run.hidden.recording();
    let torque = truth.channels.iter().find(|channel| channel.name == "true_shaft_torque").unwrap();
    torque.samples.iter().fold(0.0, |most: f64, torque| most.max(torque.abs()))
}

fn of_prediction(plan: &ExperimentPlan) -> Vec<f64> {
    let parameters = BenchParameters::default();
    let model = BenchModel::of(&parameters);
    let prediction = PredictionInputs {
        plan,
        demands: &Demands::of(plan, SEED, DEMAND_HOLD_S),
        model: &model,
        engine: &parameters.engine,
        firing_seed: Some(SEED),
        friction: DynoFriction::default(),
        disturbances: Disturbances::default(),
        limits: Limits::default(),
    };
    let inputs = SafetyInputs {
        prediction,
        spread: BenchSpread::Prior(Prior::default()),
        pulses: &KnownPulses::Stated,
        slowest_engine_control: 1.0,
        friction: FrictionSpread::NONE,
        samples: PREDICTED,
        seed: SEED,
    };
    let checked = check(&inputs, &work::Context::new()).unwrap();
    let shaft = checked.checked.iter().find(|checked| checked.of == Quantity::ShaftTorque).unwrap();
    REACHED.iter().map(|share| shaft.quantile(1.0 - share)).collect()
}

#[test]
#[ignore = "slow: 1200 runs of virtual benches"]
fn stat_as_many_virtual_benches_reach_a_limit_as_are_predicted_to() {
    let plans = [
        ("BS_T_NT, 600 rpm", ExperimentPlan::bs_t_nt(600.0, 8.0)),
        ("BS_T_NT, 1500 rpm", ExperimentPlan::bs_t_nt(1500.0, 8.0)),
        ("WhiteNoise_T_TN, 1200 rpm", ExperimentPlan::white_noise_t_tn(1200.0, 8.0)),
        ("Step_T_TN, 1200 rpm", ExperimentPlan::step_t_tn(1200.0, 8.0)),
        ("Sine_T_TN, 2000 rpm", ExperimentPlan::sine_t_tn(2000.0, 20.0)),
        ("Levels_N_NT, 1500 rpm", ExperimentPlan::levels_n_nt(1500.0, 8.0)),
    ];
    let benches: Vec<(u64, BenchParameters)> = (0..BENCHES as u64).map(|seed| (seed, drawn(seed))).collect();
    let mut missed = Vec::new();
    for (name, plan) in &plans {
        let plan = &drawn_once(plan.clone());
        let limits = of_prediction(plan);
        let reached = parallel::map(&benches, |(seed, bench)| largest_shaft_torque_nm(bench, *seed, plan));
        for (share, limit) in REACHED.iter().zip(limits) {
            let predicted = Proportion::new((share * PREDICTED as f64).round() as usize, PREDICTED);
            let counted = Proportion::new(reached.iter().filter(|torque| **torque > limit).count(), BENCHES);
            println!(
                "{name}: {limit:.1} Nm predicted to be reached by {:.0} % ({:.0} … {:.0}), reached by {:.1} % ({:.0} … {:.0})",
                100.0 * predicted.estimate,
                100.0 * predicted.lower,
                100.0 * predicted.upper,
                100.0 * counted.estimate,
                100.0 * counted.lower,
                100.0 * counted.upper
            );
            if counted.lower > predicted.upper || counted.upper < predicted.lower {
                missed.push(format!("{name} at {limit:.1} Nm"));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}
