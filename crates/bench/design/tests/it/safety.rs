//! Safety of experiments on benches that are not known exactly.

use bench_model::disturbances::Disturbances;
use bench_model::friction::DynoFriction;
use bench_model::model::{ModelParameter, ModelUncertainty, PartCovariance};
use bench_model::prediction::PredictionInputs;
use design::safety::{
    BenchSpread, Checked, FrictionSpread, Prior, Quantity, Safety, SafetyCheck, SafetyError, SafetyInputs, check,
};
use numerics::random::Stream;
use rig::bench_file::Limits;
use rig::bench_parameters::{BenchParameters, EngineParameters, MechanicsParameters};
use rig::dyno_friction::{EstimatedFriction, ExpectedFriction};
use rig::engine_pulses::KnownPulses;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, TorqueTarget, Waveform};
use signal::distributions::{chi_squared_tail, normal_quantile};
use signal::proportion::Proportion;
use units::RPM_RAD_S;

/// A bench with a sharp resonance near 18 Hz, and an engine whose speed control does not damp it.
fn sharp() -> BenchParameters {
    let mechanics = MechanicsParameters { shaft_damping_nm_s_per_rad: 2.0, ..BenchParameters::default().mechanics };
    let engine = EngineParameters {
        speed_control_proportional_nm_s_per_rad: 0.1,
        speed_control_integral_nm_per_rad: 0.02,
        ..BenchParameters::default().engine
    };
    BenchParameters { mechanics, engine, ..BenchParameters::default() }
}

const EXACT: Prior = Prior { resonance: 0.0, damping: 0.0, engine_inertia: 0.0 };

/// A check on the sharp bench.
struct Case<'a> {
    plan: &'a ExperimentPlan,
    engine: EngineParameters,
    limits: Limits,
    spread: BenchSpread<'a>,
    slowest_engine_control: f64,
    friction: FrictionSpread,
    samples: usize,
    seed: u64,
}

impl<'a> Case<'a> {
    /// On the bench that is known exactly, once.
    fn of(plan: &'a ExperimentPlan, limits: Limits) -> Self {
        Case {
            plan,
            engine: sharp().engine,
            limits,
            spread: BenchSpread::Prior(EXACT),
            slowest_engine_control: 1.0,
            friction: FrictionSpread::NONE,
            samples: 1,
            seed: 5,
        }
    }

    fn check(&self) -> SafetyCheck {
        self.check_demands(&Demands::of(self.plan, 1, DEMAND_HOLD_S))
    }

    fn check_demands(&self, demands: &Demands) -> SafetyCheck {
        self.result(demands).unwrap()
    }

    fn result(&self, demands: &Demands) -> Result<SafetyCheck, SafetyError> {
        let model = bench_model::model::BenchModel::of(&sharp());
        let prediction = PredictionInputs {
            plan: self.plan,
            demands,
            model: &model,
            engine: &self.engine,
            firing_seed: None,
            friction: DynoFriction::default(),
            disturbances: Disturbances::default(),
            limits: self.limits,
        };
        let inputs = SafetyInputs {
            prediction,
            spread: self.spread,
            pulses: &KnownPulses::Stated,
            slowest_engine_control: self.slowest_engine_control,
            friction: self.friction,
            samples: self.samples,
            seed: self.seed,
        };
        check(&inputs, &work::Context::new())
    }
}

fn of(check: &SafetyCheck, quantity: Quantity) -> &Checked {
    check.checked.iter().find(|checked| checked.of == quantity).unwrap()
}

fn shaft_limit(limit_nm: f64) -> Limits {
    Limits { shaft_torque_nm: Some(limit_nm), ..Limits::default() }
}

fn sine(amplitude: f64) -> ExperimentPlan {
    let mut plan = ExperimentPlan::sine_t_tn(1200.0, 20.0);
    let frequencies_hz = (1..=20).map(f64::from).collect();
    plan.dyno_torque_nm = Waveform::SineLadder { mean: 60.0, amplitude, frequencies_hz, dwell_s: 1.0 };
    plan
}

#[test]
fn exact_a_sine_test_trips_near_the_resonance_alone() {
    let model = bench_model::model::BenchModel::of(&sharp());
    let resonance_hz = model.mechanics.resonance().frequency_hz;
    assert!((17.0..19.0).contains(&resonance_hz), "{resonance_hz}");
    // The amplitude at 18 Hz by the frequency response, for what 60 Nm of mean leave of 140 Nm.
    let omega = std::f64::consts::TAU * 18.0;
    let held = (0.5 * omega * DEMAND_HOLD_S).sin() / (0.5 * omega * DEMAND_HOLD_S);
    let steady_nm = (140.0 - 60.0) / (model.demand_to_shaft(omega).unwrap().norm() * held);
    let plan = sine(1.3 * steady_nm);
    let case = Case::of(&plan, shaft_limit(140.0));
    let checked = case.check();
    assert_eq!(checked.safety, Safety::Unsafe);
    let sines = checked.sines.unwrap();
    assert!(sines.holds);
    let trips: Vec<f64> =
        sines.sines.iter().filter(|sine| sine.reached.count > 0).map(|sine| sine.frequency_hz).collect();
    assert!(trips.contains(&18.0) && trips.iter().all(|f| (16.0..=20.0).contains(f)), "{trips:?}");
    let safe_nm = sines.sines.iter().find(|sine| sine.frequency_hz == 18.0).unwrap().safe_nm;
    assert!((safe_nm / steady_nm - 1.0).abs() < 0.1, "{safe_nm} against {steady_nm}");
}

#[test]
fn prop_proposed_amplitudes_pass_the_check() {
    let plan = sine(30.0);
    let limits = Limits { speed_rad_s: Some(2000.0 * RPM_RAD_S), ..shaft_limit(140.0) };
    let case = Case { spread: BenchSpread::Prior(Prior::default()), samples: 80, ..Case::of(&plan, limits) };
    let checked = case.check();
    assert_eq!(checked.safety, Safety::Unsafe);
    let sines = checked.sines.unwrap();
    assert!(sines.holds, "{sines:?}");
    let safe_nm = |f: f64| sines.sines.iter().find(|sine| sine.frequency_hz == f).unwrap().safe_nm;
    assert!(safe_nm(18.0) < 30.0 && safe_nm(18.0) < 0.5 * safe_nm(5.0), "{sines:?}");
    let demands = sines.demands(&plan, &Demands::of(&plan, 1, DEMAND_HOLD_S)).unwrap();
    let again = case.check_demands(&demands);
    assert_ne!(again.safety, Safety::Unsafe, "{:?}", of(&again, Quantity::ShaftTorque).reached);
    // Larger by half they do not.
    let larger: Vec<f64> = demands.dyno_torque_nm.iter().map(|torque| 60.0 + 1.5 * (torque - 60.0)).collect();
    let larger = Demands { dyno_torque_nm: larger, ..demands };
    assert_eq!(case.check_demands(&larger).safety, Safety::Unsafe);
}

#[test]
fn prop_a_gentle_experiment_is_safe_and_the_seed_decides() {
    let mut plan = ExperimentPlan::white_noise_t_tn(1200.0, 5.0);
    plan.dyno_torque_nm = Waveform::WhiteNoise { mean: 60.0, standard_deviation: 2.0 };
    let limits = Limits {
        torque_nm: Some(200.0),
        torque_slew_nm_per_s: Some(5000.0),
        shaft_torque_slew_nm_per_s: Some(20_000.0),
        speed_rad_s: Some(3000.0 * RPM_RAD_S),
        ..shaft_limit(150.0)
    };
    let case = Case { spread: BenchSpread::Prior(Prior::default()), samples: 80, ..Case::of(&plan, limits) };
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    let one = case.check_demands(&demands);
    assert_eq!(one.safety, Safety::Safe, "{one:?}");
    assert_eq!(one.sines, None);
    assert_eq!(one, case.check_demands(&demands));
    assert_ne!(one, Case { seed: 6, ..case }.check_demands(&demands));
    // A demand changes by the difference of two draws every 10 ms, on every bench by the same.
    let steps = demands.dyno_torque_nm.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    let slew = of(&one, Quantity::TorqueSlew);
    assert!((slew.quantile(0.5) - 100.0 * steps).abs() < 1e-6 && (slew.worst - 100.0 * steps).abs() < 1e-6);
}

#[test]
fn prop_what_is_not_stated_is_not_checked() {
    let plan = ExperimentPlan::step_t_tn(1200.0, 4.0);
    let prior = BenchSpread::Prior(Prior::default());
    let checked = Case { spread: prior, samples: 5, ..Case::of(&plan, Limits::default()) }.check();
    assert_eq!(checked.safety, Safety::NotChecked);
    assert!(checked.checked.iter().all(|checked| checked.reached.is_none()));
    let few = Case { spread: prior, samples: 5, ..Case::of(&plan, shaft_limit(500.0)) }.check();
    assert_eq!((few.safety, of(&few, Quantity::TorqueDemand).safety()), (Safety::Risky, Safety::NotChecked));
    let ignition = Waveform::Square { first: 1.0, second: 0.6, dwell_s: 2.0 };
    let late = ExperimentPlan { ignition_efficiency: ignition, ..ExperimentPlan::bs_t_nt(1200.0, 4.0) };
    let late = Case { spread: prior, samples: 2, ..Case::of(&late, shaft_limit(500.0)) }.check();
    let hint = late.thermal.unwrap();
    assert!((hint.below_80_percent_s - 2.0).abs() < 1e-9 && (hint.mean_loss - 0.2).abs() < 1e-9, "{hint:?}");
    assert_eq!(few.thermal, None);
}

#[test]
fn stat_probability_is_that_of_the_one_uncertain_parameter() {
    // A dwell of firing near the resonance: at 1200 rpm four cylinders fire at 40 Hz; a sine of 18 Hz is near the
    // resonance where |18 − f| ≤ 0.1 f, so for f from 18/1.1 to 18/0.9.
    let plan = ExperimentPlan {
        dyno_torque_nm: Waveform::SineLadder { mean: 60.0, amplitude: 1.0, frequencies_hz: vec![18.0], dwell_s: 0.5 },
        ..ExperimentPlan::sine_t_tn(1200.0, 0.5)
    };
    let limits = Limits { time_at_resonance_s: Some(0.4), ..Limits::default() };
    let prior = Prior { damping: 0.0, engine_inertia: 0.0, ..Prior::default() };
    let checked = Case { spread: BenchSpread::Prior(prior), samples: 2000, ..Case::of(&plan, limits) }.check();
    let found = of(&checked, Quantity::TimeAtResonance).reached.unwrap();
    // B is kept, so the peak lies a little below the natural frequency, by a factor that hardly changes.
    let nominal = bench_model::model::BenchModel::of(&sharp()).mechanics.resonance().frequency_hz;
    let sigma = 1.2_f64.ln() / normal_quantile(0.975);
    let below = |f: f64| normal_cdf((f / nominal).ln() / sigma);
    let truth = below(18.0 / 0.9) - below(18.0 / 1.1);
    assert!((found.lower..=found.upper).contains(&truth), "{truth} against {found:?}");
    assert!(found.upper - found.lower < 0.05);
}

/// Φ, by the distribution of its square.
fn normal_cdf(z: f64) -> f64 {
    let beyond = 0.5 * chi_squared_tail(z * z, 1.0);
    if z > 0.0 { 1.0 - beyond } else { beyond }
}

/// In torque control the shaft has T_d and the friction of the dynamometer.
#[test]
fn exact_friction_counts_in_torque_control() {
    let plan = ExperimentPlan::step_t_tn(3000.0, 4.0);
    let peak = |friction: FrictionSpread| {
        let engine = BenchParameters::default().engine;
        let checked = Case { engine, friction, samples: 200, seed: 3, ..Case::of(&plan, shaft_limit(140.0)) }.check();
        [0.05, 0.95].map(|share| of(&checked, Quantity::ShaftTorque).quantile(share))
    };
    let without = peak(FrictionSpread::NONE)[0];
    let exactly =
        FrictionSpread { coulomb_nm: (1.2, 1.2), viscous_nm_s_per_rad: (0.018, 0.018), ..FrictionSpread::NONE };
    let friction = exactly.middle().torque_nm(3000.0 * RPM_RAD_S);
    let [low, high] = peak(exactly);
    assert!((low - without - friction).abs() < 0.3 && high - low < 1e-9, "{low} {without} {friction}");
    // What nothing is known of is between none and the most.
    let most = FrictionSpread { coulomb_nm: (0.0, 2.4), viscous_nm_s_per_rad: (0.0, 0.03), ..FrictionSpread::NONE };
    let [low, high] = peak(most);
    assert!(
        low > without && low < without + 3.0 && high > without + 8.0 && high < without + 12.0,
        "{low} {high} {without}"
    );
}

/// Mean and standard deviation of drawn friction at a speed, Nm.
fn drawn(spread: &FrictionSpread, speed_rad_s: f64) -> (f64, f64) {
    let mut random = Stream::new(5, 0);
    let torques: Vec<f64> = (0..20_000).map(|_| spread.draw(&mut random).torque_nm(speed_rad_s)).collect();
    assert!(torques.iter().all(|torque| *torque >= 0.0));
    let mean = torques.iter().sum::<f64>() / 2e4;
    (mean, (torques.iter().map(|torque| (torque - mean).powi(2)).sum::<f64>() / 2e4).sqrt())
}

/// The draws of friction that run-outs show have its mean and its deviation at each speed, also where a part is
/// probably below zero. A bench file that states friction comes first.
#[test]
fn stat_estimated_friction_is_drawn_with_its_mean_and_spread() {
    let estimated = EstimatedFriction {
        coulomb_nm: 0.05,
        viscous_nm_s_per_rad: 0.012,
        covariance: [[0.04, -3.9e-4], [-3.9e-4, 4e-6]],
        speeds_rad_s: (50.0, 160.0),
        recordings: vec!["NoShaft_N_NT.mf4".into()],
    };
    let mut file = bench_testkit::benches::default_bench();
    file.dynamometer_friction_uncertainty_percent = Some(10.0);
    let spread = FrictionSpread::of(&file, 400.0, Some(&estimated));
    assert_eq!(spread.from, design::safety::FrictionFrom::Estimated);
    let expected = ExpectedFriction::of(&file, 400.0, Some(&estimated));
    for speed in [60.0, 100.0, 150.0, 250.0] {
        let (mean, deviation) = drawn(&spread, speed);
        let (wanted, of_day) = (expected.mean_nm(speed), expected.deviation_nm(speed));
        assert!((mean - wanted).abs() < 0.03 * of_day, "{speed}: {mean}, expected {wanted} ± {of_day}");
        assert!((deviation / of_day - 1.0).abs() < 0.03, "{speed}: {deviation}, expected {of_day}");
    }
    let (mean, deviation) = drawn(&spread, 100.0);
    assert!((mean - 1.25).abs() < 0.03 && deviation < 0.15, "{mean} {deviation}");
    file.dynamometer_friction_nm_s_per_rad = Some(0.01);
    assert_eq!(FrictionSpread::of(&file, 400.0, Some(&estimated)).from, design::safety::FrictionFrom::Estimated);
    file.dynamometer_coulomb_friction_nm = Some(1.0);
    assert_eq!(FrictionSpread::of(&file, 400.0, Some(&estimated)).from, design::safety::FrictionFrom::Stated);
}

/// A run-out that shows next to nothing draws as none would.
#[test]
fn regress_a_poor_run_out_neither_raises_nor_widens_friction() {
    let poor = EstimatedFriction {
        coulomb_nm: 0.1,
        viscous_nm_s_per_rad: 0.001,
        covariance: [[100.0, 0.0], [0.0, 0.01]],
        speeds_rad_s: (10.0, 50.0),
        recordings: vec!["NoShaft_T_TN.mf4".into()],
    };
    let file = bench_testkit::benches::default_bench();
    let [assumed, with] = [None, Some(&poor)].map(|one| FrictionSpread::of(&file, 400.0, one));
    for speed in [30.0, 100.0, 300.0] {
        let (without, with) = (drawn(&assumed, speed), drawn(&with, speed));
        assert!((with.0 / without.0 - 1.0).abs() < 0.03, "{speed}: {with:?} {without:?}");
        assert!((with.1 / without.1 - 1.0).abs() < 0.04, "{speed}: {with:?} {without:?}");
    }
}

#[test]
fn prop_an_engine_of_slow_speed_control_damps_less() {
    let plan = sine(20.0);
    let peak = |slowest_engine_control: f64| {
        let engine = BenchParameters::default().engine;
        let case = Case { engine, slowest_engine_control, samples: 20, seed: 3, ..Case::of(&plan, shaft_limit(140.0)) };
        let checked = case.check();
        let shaft = of(&checked, Quantity::ShaftTorque);
        (shaft.quantile(0.0), shaft.worst)
    };
    let (stated, slower) = (peak(1.0), peak(0.1));
    assert!((stated.1 - stated.0).abs() < 1e-9, "{stated:?}");
    assert!(slower.0 > stated.0 - 1e-9 && slower.1 > 1.1 * stated.1, "{slower:?} against {stated:?}");
}

#[test]
fn prop_a_study_narrows_what_the_prior_leaves_open() {
    let plan = sine(8.0);
    let stiffness = bench_model::model::BenchModel::of(&sharp()).mechanics.stiffness_nm_per_rad;
    let part = PartCovariance {
        parameters: vec![ModelParameter::Stiffness, ModelParameter::Damping],
        covariance: vec![vec![(0.005 * stiffness).powi(2), 0.0], vec![0.0, 1e-4]],
        degrees_of_freedom: 1000.0,
    };
    let estimated = ModelUncertainty::new(&[part]).unwrap();
    let spread = |spread: BenchSpread<'_>| {
        let checked = Case { spread, samples: 40, ..Case::of(&plan, shaft_limit(140.0)) }.check();
        let shaft = of(&checked, Quantity::ShaftTorque);
        shaft.quantile(0.95) - shaft.quantile(0.05)
    };
    let (narrow, wide) = (spread(BenchSpread::Estimated(&estimated)), spread(BenchSpread::Prior(Prior::default())));
    assert!(narrow > 0.0 && narrow < 0.2 * wide, "{narrow} against {wide}");
}

#[test]
fn ref_exact_binomial_intervals() {
    // Without a success, and with nothing else, the ends are roots of 2.5 %; 10 of 100 as tabulated (0.0490, 0.1762).
    let none = Proportion::new(0, 200);
    assert!((none.upper - (1.0 - 0.025_f64.powf(1.0 / 200.0))).abs() < 1e-12 && none.lower == 0.0);
    assert!((Proportion::new(0, 72).upper < 0.05) && (Proportion::new(0, 71).upper > 0.05));
    let all = Proportion::new(5, 5);
    assert!((all.lower - 0.025_f64.powf(0.2)).abs() < 1e-12 && all.upper == 1.0);
    let ten = Proportion::new(10, 100);
    assert!((ten.lower - 0.0490).abs() < 5e-5 && (ten.upper - 0.1762).abs() < 5e-5, "{ten:?}");
    let half = Proportion::new(1, 2);
    // 1 of 2: lower is 1 − √0.975, upper its mirror.
    assert!((half.lower - (1.0 - 0.975_f64.sqrt())).abs() < 1e-7 && (half.upper - 0.975_f64.sqrt()).abs() < 1e-7);
}

#[test]
fn regress_control_of_the_shaft_torque_is_refused() {
    let mut plan = ExperimentPlan::step_t_tn(1200.0, 1.0);
    plan.torque_target = TorqueTarget::Shaft;
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    assert!(Case { samples: 3, ..Case::of(&plan, Limits::default()) }.result(&demands).is_err());
    plan.torque_target = TorqueTarget::AirGap;
    assert!(Case { samples: 3, ..Case::of(&plan, Limits::default()) }.result(&demands).is_ok());
    assert!(Case { samples: 0, ..Case::of(&plan, Limits::default()) }.result(&demands).is_err());
}
