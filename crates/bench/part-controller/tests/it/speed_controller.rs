//! Speed controller and feed-forward against a controller written down here: T_d* from a speed that is known in closed
//! form, logged as the mean over a gate with noise and a once-a-turn error.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use part_controller::speed_controller::{estimate, estimate_feed_forward};
use rig::estimation::EstimateError;
use rig::results::{DelayPlace, Estimate, Quantity};
use rig::{Experiment, Role};
use signal::Signal;
use signal::excitation::Random;
use units::RPM_RAD_S;

const T: f64 = 1e-3;
const K_P: f64 = 0.94 / RPM_RAD_S;
const K_I: f64 = 1.9 / RPM_RAD_S;
const K: f64 = 0.012 / RPM_RAD_S;
const K_A: f64 = -0.085 / RPM_RAD_S;

/// Signals that are recorded, and how.
#[derive(Clone, Copy)]
struct Case {
    seconds: f64,
    delay_s: f64,
    gate_s: f64,
    noise_rad_s: f64,
    eccentricity: f64,
    ramps: bool,
    /// Where the delay acts.
    place: DelayPlace,
    /// True where dN_d*/dt is the change to the next sample, not from the last.
    looks_ahead: bool,
    /// The recorded T_d* is rounded to multiples of this, Nm; zero: not rounded.
    demand_step_nm: f64,
    seed: u64,
}

impl Default for Case {
    fn default() -> Self {
        Case {
            seconds: 12.0,
            delay_s: T,
            gate_s: T,
            noise_rad_s: 0.0,
            eccentricity: 0.0,
            ramps: false,
            place: DelayPlace::SpeedError,
            looks_ahead: false,
            demand_step_nm: 0.0,
            seed: 1,
        }
    }
}

/// N_d* at update k, rad/s: constant, or a triangle of 40 rad/s.
fn reference(case: &Case, k: usize) -> f64 {
    let time = k as f64 * T;
    let swing = if case.ramps { 40.0 * (2.0 * (time / 4.0 - (time / 4.0 + 0.5).floor())).abs() } else { 0.0 };
    125.0 + swing
}

/// The speed itself, and its mean over a gate that ends at `time`.
struct Speed {
    tones: Vec<(f64, f64, f64)>,
    case: Case,
}

impl Speed {
    fn new(case: Case) -> Self {
        let mut random = Random::new(case.seed);
        let tones =
            (0..30).map(|k| (TAU * (0.3 + 1.1 * f64::from(k)), 1.0 / (2.0 + f64::from(k)), TAU * random.uniform()));
        Speed { tones: tones.collect(), case }
    }

    fn at(&self, time: f64) -> f64 {
        let k = (time / T).max(0.0);
        let (low, part) = (k.floor() as usize, k.fract());
        let follows = reference(&self.case, low) * (1.0 - part) + reference(&self.case, low + 1) * part;
        follows + self.tones.iter().map(|(w, a, phase)| a * (w * time + phase).sin()).sum::<f64>()
    }

    fn logged(&self, time: f64) -> f64 {
        if self.case.gate_s == 0.0 {
            return self.at(time);
        }
        // Simpson's rule over the gate: exact for what matters here.
        let middle = self.at(time - self.case.gate_s / 2.0);
        (self.at(time - self.case.gate_s) + 4.0 * middle + self.at(time)) / 6.0
    }
}

fn record(case: Case) -> Experiment {
    let speed = Speed::new(case);
    let count = (case.seconds / T) as usize;
    let lag = (case.delay_s / T).round() as usize;
    let mut random = Random::new(case.seed + 1000);
    let (mut integral, mut angle) = (30.0, 0.0);
    let (mut demand, mut logged, mut set) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..count {
        let time = k as f64 * T;
        let in_error = if case.place == DelayPlace::MeasuredSpeed { 0 } else { lag };
        let error = speed.at(time - case.delay_s) - reference(&case, k.saturating_sub(in_error));
        let fed = if case.place == DelayPlace::WholeOutput { k.saturating_sub(lag) } else { k };
        let (from, to) = if case.looks_ahead { (fed, fed + 1) } else { (fed.saturating_sub(1), fed) };
        let step = reference(&case, to) - reference(&case, from);
        let feed = if case.ramps { K * reference(&case, fed) + K_A * step / T } else { 0.0 };
        let torque = K_P * error + integral + feed;
        let step = case.demand_step_nm;
        demand.push(if step > 0.0 { (torque / step).round() * step } else { torque });
        integral += K_I * T * error;
        let clean = speed.logged(time);
        angle += clean * T;
        logged.push(clean * (1.0 + case.eccentricity * f64::sin(angle + 0.7)) + case.noise_rad_s * random.normal());
        set.push(reference(&case, k));
    }
    let signal = |samples| Signal::new(3.0, T, samples).unwrap();
    let signals = BTreeMap::from([
        (Role::DynoTorqueDemand, signal(demand)),
        (Role::DynoSpeed, signal(logged)),
        (Role::DynoSpeedDemand, signal(set)),
    ]);
    let label = if case.ramps { "Ramp_N_NT" } else { "BS_T_NT" };
    Experiment { file: format!("{label}.mf4"), label: label.parse().unwrap(), signals }
}

/// In the unit people read.
fn value(estimate: &Estimate, quantity: Quantity) -> f64 {
    estimate.parameter(quantity).unwrap().written().value
}

#[test]
fn exact_noise_free_controller_is_found() {
    let found = estimate(&record(Case::default()), None).unwrap();
    let estimate = &found.result.estimate;
    assert!((value(estimate, Quantity::ProportionalGain) / 0.94 - 1.0).abs() < 1e-5, "{estimate:?}");
    assert!((value(estimate, Quantity::IntegralGain) / 1.9 - 1.0).abs() < 1e-4);
    assert!((value(estimate, Quantity::ControllerDelay) - T).abs() < 2e-6);
    assert!((value(estimate, Quantity::DynoEncoderGate) - T).abs() < 2e-6);
    assert!(found.result.validation.fit_percent > 99.9);
    assert!(found.result.without_delay.fit_percent < found.result.validation.fit_percent);
}

#[test]
fn exact_four_minutes_of_a_long_recording_are_used() {
    let found = estimate(&record(Case { seconds: 300.0, ..Case::default() }), None).unwrap();
    let (used, judged) = (&found.result.estimate.stretches[0], &found.result.validation.stretch);
    assert!((judged.end_s - used.start_s - 240.0).abs() < 0.01, "{used:?} {judged:?}");
    assert!((value(&found.result.estimate, Quantity::ProportionalGain) / 0.94 - 1.0).abs() < 1e-5);
}

#[test]
fn exact_delays_between_samples_are_found() {
    for delay_s in [0.4e-3, 1.6e-3, 2.0e-3, 3.3e-3] {
        let found = estimate(&record(Case { delay_s, ..Case::default() }), None).unwrap();
        assert!((value(&found.result.estimate, Quantity::ControllerDelay) - delay_s).abs() < 3e-6, "{delay_s}");
    }
}

#[test]
fn exact_controller_that_reads_the_logged_speed_shows_no_gate() {
    let found = estimate(&record(Case { gate_s: 0.0, ..Case::default() }), None).unwrap();
    let gate = found.result.estimate.parameter(Quantity::DynoEncoderGate).map_or(0.0, |p| p.value);
    assert!(gate < 0.1 * T, "{gate}");
    assert!((value(&found.result.estimate, Quantity::ProportionalGain) / 0.94 - 1.0).abs() < 1e-4);
}

/// N_d behind a mean of five samples, or behind a lag of 2 ms, is not what the controller answers to.
#[test]
fn exact_a_speed_behind_a_filter_is_told_from_an_encoder() {
    let is_behind_a_filter = |work: &dyn Fn(&[f64]) -> Vec<f64>| {
        let mut experiment = record(Case { noise_rad_s: 1e-3, ..Case::default() });
        let speed = experiment.signals.get_mut(&Role::DynoSpeed).unwrap();
        speed.samples = work(&speed.samples);
        estimate(&experiment, None).unwrap().encoder.is_behind_a_filter(T)
    };
    assert!(!is_behind_a_filter(&|x| x.to_vec()));
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    assert!(is_behind_a_filter(&|x| (0..x.len()).map(|k| mean(&x[k.saturating_sub(4)..=k])).collect()));
    assert!(is_behind_a_filter(&|x| {
        let mut state = x[0];
        let lagged = x.iter().map(|x| {
            state += (x - state) / 3.0;
            state
        });
        lagged.collect()
    }));
}

/// Noise that hides the gate does not make a controller of whole delays one that reads the samples half way between two
/// of them.
#[test]
fn stat_a_gate_that_noise_hides_leaves_the_delay_right() {
    let mut held = 0;
    for seed in 0..20 {
        // Stamps that jitter: noise of the angle, whose difference is noise of the speed that rises with frequency.
        let mut random = Random::new(seed + 50);
        let angle: Vec<f64> = (0..12_003).map(|_| random.normal()).collect();
        let mut experiment = record(Case { seed, ..Case::default() });
        let speed = experiment.signals.get_mut(&Role::DynoSpeed).unwrap();
        let rising = |k: usize| angle[k + 3] - 3.0 * angle[k + 2] + 3.0 * angle[k + 1] - angle[k];
        speed.samples.iter_mut().enumerate().for_each(|(k, x)| *x += 0.4 * rising(k));
        let found = estimate(&experiment, None).unwrap();
        let delay = found.result.estimate.parameter(Quantity::ControllerDelay).unwrap().clone();
        let off = (delay.value - T).abs() / (0.5 * (delay.interval.1 - delay.interval.0));
        println!("{seed}: τ {:.3e} in {:?}, gate {:.2e} s", delay.value, delay.interval, found.encoder.gate_s);
        assert!(off < 2.0, "{delay:?}");
        held += usize::from(off <= 1.0);
    }
    assert!(held >= 17, "{held} of 20");
}

#[test]
fn exact_once_a_turn_error_is_separated_from_the_gains() {
    let found = estimate(&record(Case { eccentricity: 3e-4, ..Case::default() }), None).unwrap();
    assert!((found.encoder.eccentricity() / 3e-4 - 1.0).abs() < 0.01, "{:?}", found.encoder);
    assert!((value(&found.result.estimate, Quantity::ProportionalGain) / 0.94 - 1.0).abs() < 1e-4);
}

#[test]
fn exact_feed_forward_is_found_beside_the_controller() {
    let controller = estimate(&record(Case::default()), None).unwrap();
    let ramp = record(Case { ramps: true, seconds: 16.0, ..Case::default() });
    let found = estimate_feed_forward(&ramp, None, &controller, None).unwrap();
    assert!((value(&found.estimate, Quantity::SpeedFeedForward) / 0.012 - 1.0).abs() < 1e-2, "{:?}", found.estimate);
    assert!((value(&found.estimate, Quantity::AccelerationFeedForward) / -0.085 - 1.0).abs() < 1e-2);
    assert!(found.validation.fit_percent > found.pi_alone.fit_percent + 5.0);
}

#[test]
fn exact_the_place_of_the_delay_is_found_or_its_doubt_is_in_the_intervals() {
    for (place, looks_ahead) in [
        (DelayPlace::MeasuredSpeed, false),
        (DelayPlace::MeasuredSpeed, true),
        (DelayPlace::SpeedError, false),
        (DelayPlace::SpeedError, true),
        (DelayPlace::WholeOutput, false),
        (DelayPlace::WholeOutput, true),
    ] {
        for samples in 1..=3 {
            let case =
                Case { delay_s: f64::from(samples) * T, place, looks_ahead, noise_rad_s: 1e-3, ..Case::default() };
            let controller = estimate(&record(case), None).unwrap();
            let ramp = record(Case { ramps: true, seconds: 16.0, seed: 2, ..case });
            let found = estimate_feed_forward(&ramp, None, &controller, None).unwrap();
            let what = format!(
                "{place:?}, {looks_ahead}, {samples} ms: {found:?}",
                found = (&found.lags, &found.delay_places, &found.estimate)
            );
            assert!(found.delay_places.contains(&place), "{what}");
            // Beside a delay of one sample some places look the same.
            assert!(samples == 1 || found.delay_places == [place], "{what}");
            for (quantity, truth) in [(Quantity::SpeedFeedForward, 0.012), (Quantity::AccelerationFeedForward, -0.085)]
            {
                let parameter = found.estimate.parameter(quantity).unwrap().written();
                let (low, high) = parameter.interval;
                assert!(low < truth && truth < high, "{what}");
                assert!(samples == 1 || high - low < 0.05 * f64::abs(truth), "{what}");
            }
        }
    }
}

#[test]
fn stat_residuals_betray_a_missing_delay_and_nothing_else() {
    let found = estimate(&record(Case { noise_rad_s: 3e-3, ..Case::default() }), None).unwrap();
    let outside = |validation: &rig::results::Validation| {
        let test = validation.residuals.clone().unwrap();
        test.cross_correlation.iter().filter(|c| c.abs() > test.cross_correlation_bound).count()
    };
    assert!(outside(&found.result.validation) <= 3);
    assert!(outside(&found.result.without_delay) > 10);
}

#[test]
fn regress_a_rounded_demand_moves_no_delay_out_of_its_interval() {
    for demand_step_nm in [0.01, 0.05, 0.1, 0.5] {
        let case = Case { noise_rad_s: 3e-3, demand_step_nm, seconds: 20.0, ..Case::default() };
        let found = estimate(&record(case), None).unwrap();
        let delay = found.result.estimate.parameter(Quantity::ControllerDelay).unwrap();
        assert!(delay.interval.0 < T && T < delay.interval.1, "{demand_step_nm} Nm: {delay:?}");
        assert!((value(&found.result.estimate, Quantity::ProportionalGain) / 0.94 - 1.0).abs() < 2e-3);
        assert_eq!(found.coarse_demand_nm.is_some(), demand_step_nm > 0.03, "{demand_step_nm} Nm");
    }
}

#[test]
fn stat_intervals_of_the_gains_cover_the_truth() {
    let runs = 120;
    let mut covered = [0; 2];
    for seed in 0..runs {
        let case = Case { seconds: 6.0, noise_rad_s: 3e-3, eccentricity: 2e-4, seed, ..Case::default() };
        let found = estimate(&record(case), None).unwrap();
        for (count, (quantity, truth)) in
            covered.iter_mut().zip([(Quantity::ProportionalGain, 0.94), (Quantity::IntegralGain, 1.9)])
        {
            let (low, high) = found.result.estimate.parameter(quantity).unwrap().written().interval;
            *count += usize::from(low < truth && truth < high);
        }
    }
    for count in covered {
        // Three binomial standard deviations below 0.95; intervals may be longer, as the robust covariance is never
        // smaller than the plain one.
        assert!(count as f64 / runs as f64 > 0.89, "{covered:?} of {runs}");
    }
}

#[test]
fn regress_unusable_recordings_are_refused_with_their_reason() {
    let whole = record(Case::default());
    let mut headless = whole.clone();
    headless.signals.remove(&Role::DynoSpeedDemand);
    assert!(matches!(estimate(&headless, None), Err(EstimateError::MissingSignal { role: Role::DynoSpeedDemand, .. })));
    assert!(matches!(estimate(&whole.within((3.0, 4.0)), None), Err(EstimateError::TooShort { .. })));
    assert!(matches!(estimate(&whole, Some(20.0)), Err(EstimateError::Saturated { .. })));
    let controller = estimate(&whole, None).unwrap();
    assert!(matches!(
        estimate_feed_forward(&whole, None, &controller, None),
        Err(EstimateError::WeakExcitation { role: Role::DynoSpeedDemand, .. })
    ));
}

#[test]
fn regress_a_constant_speed_is_an_error_and_no_number() {
    let mut still = record(Case::default());
    for role in [Role::DynoSpeed, Role::DynoTorqueDemand] {
        if let Some(signal) = still.signals.get_mut(&role) {
            signal.samples.fill(125.0);
        }
    }
    assert!(estimate(&still, None).is_err());
}
