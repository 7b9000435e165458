//! How often the residual tests of estimates fail where there is nothing to find, and where there is.
#![allow(clippy::print_stdout, reason = "sizes of tests are for whoever reads the deep check")]

use faer::Mat;
use ident::validate::{ResidualTest, TestData};
use ident::{
    AnyModel, Armax, Arx, BoxJenkins, Dataset, Experiment, Fit, Focus, IdentError, Iv4, OutputError, StateSpacePem,
    Subspace,
};

use crate::noise::Noise;

pub(crate) type Estimator = fn(&Dataset) -> Result<Fit<AnyModel>, IdentError>;

/// How the noise of the data comes about.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Disturbance {
    /// On the output, remembering this part of its last value.
    Output(f64),
    /// Through the poles of the system, after `1 + c q⁻¹`.
    Equation(f64),
}

/// `y = (q⁻¹ + 0.5 q⁻²)/(1 − 1.5 q⁻¹ + 0.7 q⁻²) u + v`, with an input that remembers 0.7 of itself.
pub(crate) fn record(samples: usize, disturbance: Disturbance, noise: &mut Noise) -> Dataset {
    let (u, e) = (noise.coloured(samples, 1.0, 0.7), noise.normals(samples));
    let v = match disturbance {
        Disturbance::Output(memory) => noise.coloured(samples, 1.0, memory),
        Disturbance::Equation(_) => vec![0.0; samples],
    };
    let (mut x, mut y) = (vec![0.0; samples], vec![0.0; samples]);
    for t in 0..samples {
        let past = |s: &[f64], k: usize| if t >= k { s[t - k] } else { 0.0 };
        x[t] = 1.5 * past(&x, 1) - 0.7 * past(&x, 2) + past(&u, 1) + 0.5 * past(&u, 2);
        if let Disturbance::Equation(c) = disturbance {
            x[t] += e[t] + c * past(&e, 1);
        }
        y[t] = x[t] + v[t];
    }
    Dataset::siso(0.1, &u, &y).unwrap()
}

/// Draws of short records.
const RUNS: u64 = 1000;

/// Failures of `dynamics` and `feedback` at 1 % and at 5 %, and lags outside their region at 99 %.
#[derive(Debug, Default, Clone, Copy)]
struct Alarms {
    dynamics: [usize; 2],
    feedback: [usize; 2],
    outside: usize,
    lags: usize,
}

impl Alarms {
    fn count(&mut self, fit: &Fit<AnyModel>, data: &Dataset, which: TestData) {
        let report = ResidualTest::default().run(fit, data, which).unwrap();
        let test = &report.independence[0][0];
        for (k, level) in [0.99, 0.95].into_iter().enumerate() {
            self.dynamics[k] += usize::from(!test.dynamics.passes(level));
            self.feedback[k] += usize::from(!test.feedback.passes(level));
        }
        self.outside += test.cross.iter().zip(&test.bounds).filter(|(c, bound)| c.abs() > **bound).count();
        self.lags += test.cross.len();
    }
}

/// Alarms on the estimates' own data and on others.
fn alarms(estimate: Estimator, disturbance: Disturbance, samples: usize, runs: u64) -> [Alarms; 2] {
    let mut all = [Alarms::default(); 2];
    for seed in 0..runs {
        let mut noise = Noise::new(1000 + seed);
        let (own, unseen) = (record(samples, disturbance, &mut noise), record(samples, disturbance, &mut noise));
        let fit = estimate(&own).unwrap();
        all[0].count(&fit, &own, TestData::Own);
        all[1].count(&fit, &unseen, TestData::Unseen);
    }
    all
}

pub(crate) fn oe(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    OutputError::new(2, 2, 1).fit(data).map(|fit| fit.map(Into::into))
}

pub(crate) fn arx(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    Arx::new(2, 2, 1).fit(data).map(|fit| fit.map(Into::into))
}

pub(crate) fn armax(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    Armax::new(2, 2, 1, 1).fit(data).map(|fit| fit.map(Into::into))
}

pub(crate) fn bj(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    BoxJenkins::new(2, 0, 1, 2, 1).fit(data).map(|fit| fit.map(Into::into))
}

pub(crate) fn state_space(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    StateSpacePem::new(2).fit(data).map(|fit| fit.map(Into::into))
}

fn simulating_state_space(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    StateSpacePem::new(2).with_focus(Focus::Simulation).fit(data).map(|fit| fit.map(Into::into))
}

pub(crate) fn instruments(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    Iv4::new(2, 2, 1).fit(data).map(|fit| fit.map(Into::into))
}

fn subspace(data: &Dataset) -> Result<Fit<AnyModel>, IdentError> {
    Subspace::new(2).fit(data).map(|fit| fit.map(Into::into))
}

/// Counts within binomial bounds of one in a thousand; from below also half of 5 %, and only where `exact`, since the
/// colour of noise that remembers longer than a short record is seen with a wide margin. Tests of feedback on unseen
/// data are a little cautious.
fn check(name: &str, alarms: [Alarms; 2], runs: u64, exact: bool) {
    let (mut report, mut good) = (String::new(), true);
    for (which, found) in ["own", "unseen"].iter().zip(alarms) {
        report += &format!("{name} {which} of {runs}: {found:?}\n");
        let n = runs as f64;
        let limits = |share: f64| (n * share, 3.1 * (n * share * (1.0 - share)).sqrt());
        let ((one, one_off), (five, five_off)) = (limits(0.01), limits(0.05));
        for counts in [found.dynamics, found.feedback] {
            good &= counts[0] as f64 <= one + one_off + 1.0 && counts[1] as f64 <= five + five_off;
            good &= !exact || counts[1] as f64 >= (0.5 * five).min(five - five_off);
        }
        // Lags move together where the input is not white.
        good &= (found.outside as f64) < 0.03 * found.lags as f64;
    }
    println!("{report}");
    assert!(good, "{report}");
}

fn holds_its_level(name: &str, estimate: Estimator, disturbance: Disturbance, exact: bool) {
    check(name, alarms(estimate, disturbance, 300, RUNS), RUNS, exact);
}

#[test]
#[ignore = "slow"]
fn stat_output_error_holds_its_level_under_white_noise() {
    holds_its_level("oe", oe, Disturbance::Output(0.0), true);
}

#[test]
#[ignore = "slow"]
fn stat_output_error_holds_its_level_under_coloured_noise() {
    holds_its_level("oe", oe, Disturbance::Output(0.95), false);
}

#[test]
#[ignore = "slow"]
fn stat_output_error_holds_its_level_under_coloured_noise_on_long_records() {
    check("oe", alarms(oe, Disturbance::Output(0.95), 5000, 100), 100, true);
}

#[test]
#[ignore = "slow"]
fn stat_state_space_without_noise_model_holds_its_level_under_coloured_noise() {
    holds_its_level("ss by simulation", simulating_state_space, Disturbance::Output(0.95), false);
}

#[test]
#[ignore = "slow"]
fn stat_box_jenkins_holds_its_level_under_coloured_noise() {
    holds_its_level("bj", bj, Disturbance::Output(0.95), true);
}

#[test]
#[ignore = "slow"]
fn stat_equation_errors_hold_their_level() {
    holds_its_level("arx", arx, Disturbance::Equation(0.0), true);
    holds_its_level("armax", armax, Disturbance::Equation(0.7), true);
}

#[test]
#[ignore = "slow"]
fn stat_equation_errors_hold_their_level_on_long_records() {
    check("armax", alarms(armax, Disturbance::Equation(0.7), 5000, 400), 400, true);
}

#[test]
#[ignore = "slow"]
fn stat_state_space_holds_its_level() {
    holds_its_level("state space", state_space, Disturbance::Equation(0.7), true);
}

#[test]
#[ignore = "slow"]
fn stat_estimates_that_are_no_minimum_hold_their_level() {
    holds_its_level("instruments", instruments, Disturbance::Equation(0.0), true);
    // A subspace estimate from few data is too far from the minimum for a step to be linear: unseen data alone.
    let [_, unseen] = alarms(subspace, Disturbance::Equation(0.7), 300, RUNS);
    check("subspace", [unseen, unseen], RUNS, false);
}

/// A delay that is a sample too long, and a pole too few, show in every record.
#[test]
fn stat_missing_dynamics_are_found() {
    let late: Estimator = |data| OutputError::new(2, 2, 2).fit(data).map(|fit| fit.map(Into::into));
    let first: Estimator = |data| OutputError::new(2, 1, 1).fit(data).map(|fit| fit.map(Into::into));
    for (name, estimate) in [("a delay", late), ("a pole", first)] {
        for memory in [0.0, 0.95] {
            let found = alarms(estimate, Disturbance::Output(memory), 600, 20);
            let missed: Vec<usize> = found.iter().map(|alarms| 20 - alarms.dynamics[0]).collect();
            assert!(missed.iter().all(|missed| *missed <= 1), "{name} under noise of {memory}: missed {missed:?}");
        }
    }
}

/// A correlation that the estimate makes zero on its own data has no degree of freedom, and the rest holds its level.
#[test]
fn exact_lags_that_the_estimate_holds_do_not_count() {
    let mut noise = Noise::new(4);
    let (u, e) = (noise.coloured(400, 1.0, 0.5), noise.normals(400));
    let at = |t: usize, k: usize| if t >= k { u[t - k] } else { 0.0 };
    let y: Vec<f64> = (0..400).map(|t| at(t, 1) + 0.5 * at(t, 2) + e[t]).collect();
    let data = Dataset::siso(1.0, &u, &y).unwrap();
    let test = ResidualTest { lags: 10, ..Default::default() };
    for (coefficients, freedom) in [(2, 9.0), (10, 1.0)] {
        let fit = OutputError::new(coefficients, 0, 1).fit(&data).unwrap();
        let own = test.run(&fit, &data, TestData::Own).unwrap().independence.remove(0).remove(0);
        assert_eq!(own.dynamics.degrees_of_freedom, freedom);
        assert!(own.cross[11..11 + coefficients].iter().all(|c| c.abs() < 1e-9), "{:?}", own.cross);
        let unseen = test.run(&fit, &data, TestData::Unseen).unwrap().independence.remove(0).remove(0);
        let known = test.run_known(&fit.model, &data).unwrap().independence.remove(0).remove(0);
        assert_eq!(unseen.dynamics.degrees_of_freedom, 11.0);
        for ((own, unseen), known) in own.bounds.iter().zip(&unseen.bounds).zip(&known.bounds) {
            // The variance is that of 400 residuals which lost as many degrees of freedom as there are parameters.
            assert!(*own <= known * (1.0 + 1e-9) * (399.0 / (399.0 - coefficients as f64)).sqrt(), "{own} {known}");
            assert!(known * (1.0 - 1e-9) <= *unseen, "{known} {unseen}");
        }
    }
}

/// Two outputs with errors that depend on each other, missing at instants of their own or not at all; two inputs.
#[test]
#[ignore = "slow"]
fn stat_several_outputs_hold_their_level() {
    let runs = 150;
    for gaps in [false, true] {
        let mut alarms = [[0; 2]; 2];
        for seed in 0..runs {
            let mut noise = Noise::new(500 + seed);
            let mut record = || {
                let (u, e) = (noise.normals(800), noise.normals(800));
                let (mut x, mut y) = ([0.0; 2], Mat::zeros(400, 2));
                for t in 0..400 {
                    y[(t, 0)] = x[0] + 0.3 * x[1] + e[2 * t];
                    y[(t, 1)] = x[1] + 0.8 * e[2 * t] + 0.6 * e[2 * t + 1];
                    x = [0.8 * x[0] + u[2 * t], 0.3 * x[0] + 0.6 * x[1] + 0.5 * u[2 * t + 1]];
                }
                Dataset::new(0.1, Mat::from_fn(400, 2, |t, k| u[2 * t + k]), y).unwrap()
            };
            let (own, unseen) = (record(), record());
            let fit = StateSpacePem::new(2).with_focus(Focus::Simulation).fit(&own).unwrap();
            for (counts, (data, which)) in alarms.iter_mut().zip([(&own, TestData::Own), (&unseen, TestData::Unseen)]) {
                let with_gaps = |e: &Experiment| {
                    let mut outputs = e.outputs.clone();
                    (3..400).step_by(7).for_each(|t| outputs[(t, 0)] = f64::NAN);
                    Ok(Experiment { outputs, ..e.clone() })
                };
                let data = if gaps { data.map_experiments(with_gaps).unwrap() } else { data.clone() };
                let report = ResidualTest::default().run(&fit, &data, which).unwrap();
                for test in report.independence.iter().flatten() {
                    counts[0] += usize::from(!test.dynamics.passes(0.99));
                    counts[1] += usize::from(!test.dynamics.passes(0.95));
                }
            }
        }
        // 600 tests, of which those of one output share their noise.
        assert!(alarms.iter().all(|a| a[0] <= 18 && (10..=55).contains(&a[1])), "gaps {gaps}: {alarms:?}");
    }
}

/// An hour at 16 Hz up to lags of ten minutes stays a matter of seconds.
#[test]
fn regress_many_lags_hold_their_level() {
    let mut noise = Noise::new(9);
    let (own, unseen) =
        (record(20_000, Disturbance::Output(0.95), &mut noise), record(20_000, Disturbance::Output(0.95), &mut noise));
    let fit = oe(&own).unwrap();
    let test = ResidualTest { lags: 3000, ..Default::default() };
    for (data, which) in [(&own, TestData::Own), (&unseen, TestData::Unseen)] {
        let found = test.run(&fit, data, which).unwrap().independence.remove(0).remove(0);
        assert!(found.dynamics.passes(0.999) && found.dynamics.p_value < 0.999, "{which:?} {:?}", found.dynamics);
        assert!(found.feedback.passes(0.999) && found.feedback.p_value < 0.999, "{which:?} {:?}", found.feedback);
        let outside = found.cross.iter().zip(&found.bounds).filter(|(c, bound)| c.abs() > **bound).count();
        assert!(outside < 250, "{which:?} {outside}");
    }
}
