//! Models in continuous time under band-limited inputs.
#![allow(clippy::print_stdout)]

use faer::{Mat, mat};
use ident::prediction::{InitialState, predict, residuals, simulate};
use ident::validate::{ResidualTest, TestData, judge};
use ident::{
    ContinuousTransferFunction, Dataset, Doubt, Experiment, Fit, GreyBox, GreyNoise, GreyParameter, IdentError,
    Intersample, LinearModel, Parametric, ProcessFit, RationalChannel, Structure, TransferFunctionModel,
};
use lti::{LtiError, StateSpace, TransferFunction};

use crate::noise::Noise;

const T: f64 = 0.01;

/// Tones at random frequencies up to a part of the sample rate, of mean square one together.
struct Tones(Vec<(f64, f64)>);

impl Tones {
    fn new(count: usize, up_to: f64, noise: &mut Noise) -> Self {
        let highest = std::f64::consts::TAU * up_to / T;
        Tones((0..count).map(|_| (highest * noise.uniform(), std::f64::consts::TAU * noise.uniform())).collect())
    }

    /// Response of a system to them, from ever on.
    fn through(&self, system: &TransferFunction, samples: usize) -> Vec<f64> {
        let omega: Vec<f64> = self.0.iter().map(|tone| tone.0).collect();
        let gains = system.frequency_response(&omega).unwrap().response;
        let size = (2.0 / omega.len() as f64).sqrt();
        let at = |t: f64| {
            let each = self.0.iter().zip(&gains).map(|((w, phase), g)| g.norm() * (w * t + phase + g.arg()).cos());
            size * each.sum::<f64>()
        };
        (0..samples).map(|k| at(T * k as f64)).collect()
    }
}

fn rational(num: &[f64], den: &[f64], delay_s: f64) -> RationalChannel {
    RationalChannel::new(num.to_vec(), den.to_vec(), delay_s).unwrap()
}

fn transfer_function(num: &[f64], den: &[f64], delay_s: f64) -> TransferFunction {
    let den = [&[1.0], den].concat();
    TransferFunction::continuous(num.to_vec(), den).unwrap().with_delay(delay_s).unwrap()
}

fn gain(k: f64) -> TransferFunction {
    TransferFunction::continuous(vec![k], vec![1.0]).unwrap()
}

/// A record of a system under tones, with white noise of this deviation on the output.
fn record(system: &TransferFunction, up_to: f64, samples: usize, deviation: f64, noise: &mut Noise) -> Dataset {
    let tones = Tones::new(40, up_to, noise);
    let (u, mut y) = (tones.through(&gain(1.0), samples), tones.through(system, samples));
    y.iter_mut().for_each(|y| *y += deviation * noise.normal());
    Dataset::siso(T, &u, &y).unwrap().with_intersample(Intersample::BandLimited)
}

fn assert_found<M: Parametric>(fit: &Fit<M>, wanted: &[f64], tolerance: f64) {
    let off = |(found, wanted): (&f64, &f64)| (found - wanted).abs() / wanted.abs().max(1e-2);
    let worst = fit.parameters().iter().zip(wanted).map(off).fold(0.0, f64::max);
    assert!(worst < tolerance, "{worst:e}: {:?} for {wanted:?}", fit.parameters());
}

#[test]
fn exact_continuous_models_of_band_limited_inputs() {
    let lag = transfer_function(&[50.0], &[50.0], 0.0);
    let late = transfer_function(&[3.0, 900.0], &[20.0, 2500.0], 0.0237);
    let through = transfer_function(&[0.5, 80.0], &[40.0], 0.0);
    for (up_to, tolerance) in [(0.1, 1e-5), (0.3, 1e-4), (0.45, 2e-3)] {
        let noise = &mut Noise::new(3);
        let data = record(&lag, up_to, 600, 0.0, noise);
        assert_found(&ContinuousTransferFunction::new(0, 1).fit(&data).unwrap(), &[50.0, 50.0, 0.0], tolerance);
        let process = ProcessFit::named("P1").unwrap().fit(&data).unwrap();
        assert_found(&process, &[1.0, 0.02], tolerance);
        let data = record(&through, up_to, 600, 0.0, noise);
        assert_found(&ContinuousTransferFunction::new(1, 1).fit(&data).unwrap(), &[0.5, 80.0, 40.0, 0.0], tolerance);
        let data = record(&late, up_to, 900, 0.0, noise);
        let options = ContinuousTransferFunction::new(1, 2).with_delay_between(&[(0.0, 0.06)]);
        assert_found(&options.fit(&data).unwrap(), &[3.0, 900.0, 20.0, 2500.0, 0.0237], 10.0 * tolerance);
    }
}

/// Two inputs with a delay each to two outputs, over two records.
#[test]
fn exact_several_inputs_outputs_and_records() {
    let delays = [0.031, 0.0];
    let systems = [
        [transfer_function(&[50.0], &[50.0], delays[0]), transfer_function(&[20.0], &[10.0], delays[1])],
        [transfer_function(&[9.0], &[30.0], delays[0]), transfer_function(&[-40.0], &[80.0], delays[1])],
    ];
    let noise = &mut Noise::new(5);
    let mut experiment = |samples: usize| {
        let tones = [Tones::new(20, 0.3, noise), Tones::new(20, 0.25, noise)];
        let inputs = tones.each_ref().map(|t| t.through(&gain(1.0), samples));
        let output = |i: usize| {
            let parts = [0, 1].map(|j| tones[j].through(&systems[i][j], samples));
            (0..samples).map(|k| parts[0][k] + parts[1][k]).collect::<Vec<f64>>()
        };
        let outputs = [output(0), output(1)];
        let table = |columns: &[Vec<f64>; 2]| Mat::from_fn(samples, 2, |k, j| columns[j][k]);
        (table(&inputs), table(&outputs))
    };
    let (inputs, outputs) = experiment(500);
    let data = Dataset::new(T, inputs, outputs).unwrap().with_intersample(Intersample::BandLimited);
    let (inputs, outputs) = experiment(400);
    let data = data.with_experiment(Experiment { name: "two".into(), start_s: 0.0, inputs, outputs }).unwrap();
    let fit = ContinuousTransferFunction::new(0, 1).with_delay(&delays).fit(&data).unwrap();
    let wanted = [[50.0, 50.0, 0.031], [20.0, 10.0, 0.0], [9.0, 30.0, 0.031], [-40.0, 80.0, 0.0]].concat();
    assert_found(&fit, &wanted, 1e-3);
    // The first rows, where delayed inputs are those of before the record, count too.
    let judged = judge(&fit.model, &data, None, &InitialState::Estimated).unwrap();
    assert!(judged.fit_percent.iter().flatten().all(|fit| *fit > 90.0), "{:?}", judged.fit_percent);
}

/// The judgement of a model follows the inputs as the estimate does: the truth leaves next to nothing.
#[test]
fn exact_the_truth_leaves_no_residual_but_near_the_ends() {
    let truth = TransferFunctionModel::new(vec![rational(&[50.0], &[50.0], 0.0)], 1, Mat::identity(1, 1)).unwrap();
    let data = record(&transfer_function(&[50.0], &[50.0], 0.0), 0.3, 400, 0.0, &mut Noise::new(8));
    let left = residuals(&truth, &data, &InitialState::Estimated).unwrap().outputs.remove(0);
    for t in 0..400 {
        let known = (32..400 - 32).contains(&t);
        assert!(if known { left[(t, 0)].abs() < 1e-4 } else { left[(t, 0)].is_nan() }, "{t} {}", left[(t, 0)]);
    }
    let simulated = simulate(&truth, &data, &InitialState::Estimated).unwrap().outputs.remove(0);
    let predicted = predict(&truth, &data, 3, &InitialState::Estimated).unwrap().outputs.remove(0);
    assert!((0..400).all(|t| simulated[(t, 0)].is_finite() && simulated[(t, 0)] == predicted[(t, 0)]));
    // The samples as they are, on straight lines, are another system: what the form for samples is documented to be.
    let straight = truth.innovations(T, Intersample::BandLimited).unwrap();
    assert_eq!(straight.system(), truth.innovations(T, Intersample::FirstOrderHold).unwrap().system());
}

/// From rest the record begins with what is known, and keeps its first rows.
#[test]
fn exact_from_rest() {
    // A pulse without content above 0.2 of the sample rate to 1e-6, well after the beginning.
    let pulse = |t: f64| (-0.5 * ((t - 0.8) / 0.04).powi(2)).exp();
    let count = 300;
    let u: Vec<f64> = (0..count).map(|k| pulse(T * f64::from(k))).collect();
    // ẏ = 30 (u − y), by fine steps of the exact solution for straight inputs.
    let fine = StateSpace::continuous(mat![[-30.0]], mat![[30.0]], mat![[1.0]], mat![[0.0]]).unwrap();
    let input = Mat::from_fn(count as usize * 200, 1, |k, _| pulse(T / 200.0 * k as f64));
    let response = fine.to_discrete_foh(T / 200.0).unwrap().simulate(input.as_ref(), &[0.0]).unwrap();
    let y: Vec<f64> = (0..count as usize).map(|k| response[(200 * k, 0)]).collect();
    let data = Dataset::siso(T, &u, &y).unwrap().with_intersample(Intersample::BandLimited);
    let fit = ContinuousTransferFunction::new(0, 1).from_rest().fit(&data).unwrap();
    assert_found(&fit, &[30.0, 30.0, 0.0], 1e-5);
    assert_eq!(fit.samples, 300 - 32);
    assert!(fit.doubts.contains(&Doubt::RowsLeftOut { rows: 32, of: 300 }), "{:?}", fit.doubts);
}

/// A lag whose state is disturbed, or whose output is.
#[derive(Debug, Clone)]
struct Lag {
    noise: bool,
    delay_s: f64,
}

impl Structure for Lag {
    fn parameters(&self) -> Vec<GreyParameter> {
        vec![GreyParameter::new("a", 30.0), GreyParameter::new("b", 70.0)]
    }

    fn system(&self, p: &[f64]) -> Result<StateSpace, LtiError> {
        StateSpace::continuous(mat![[-p[0]]], mat![[p[1]]], mat![[1.0]], mat![[0.0]])
    }

    fn noise(&self, _: &[f64]) -> GreyNoise {
        match self.noise {
            true => GreyNoise::Covariances { process: mat![[0.04]], measurement: mat![[4e-4]] },
            false => GreyNoise::OutputError,
        }
    }

    fn input_delays_s(&self, _: &[f64]) -> Vec<f64> {
        if self.delay_s == 0.0 { Vec::new() } else { vec![self.delay_s] }
    }
}

const PLAIN: Lag = Lag { noise: false, delay_s: 0.0 };

#[test]
fn exact_grey_box() {
    let data = record(&transfer_function(&[50.0], &[50.0], 0.0), 0.3, 600, 0.0, &mut Noise::new(21));
    let fit = GreyBox::new(PLAIN).fit(&data).unwrap();
    assert_found(&fit, &[50.0, 50.0], 1e-4);
    assert!(fit.doubts.contains(&Doubt::RowsLeftOut { rows: 64, of: 600 }), "{:?}", fit.doubts);
    let judged = judge(&fit.model, &data, None, &InitialState::Given(fit.initial_states.clone())).unwrap();
    assert!(judged.fit_percent[0][0] > 95.0, "{:?}", judged.fit_percent);
    let late = GreyBox::new(Lag { delay_s: 0.013, ..PLAIN });
    assert!(matches!(late.fit(&data), Err(IdentError::Lti(LtiError::DelayPresent { .. }))));
    let short = record(&transfer_function(&[50.0], &[50.0], 0.0), 0.3, 60, 0.0, &mut Noise::new(21));
    assert!(matches!(GreyBox::new(PLAIN).fit(&short), Err(IdentError::TooFewSamples { .. })));
}

/// How often each interval holds the truth, and the mean error in standard deviations.
#[derive(Default)]
struct Tally {
    runs: usize,
    covered: Vec<usize>,
    mean: Vec<f64>,
}

impl Tally {
    fn add<M: Parametric>(&mut self, fit: &Fit<M>, wanted: &[f64], which: &[usize]) {
        self.covered.resize(which.len(), 0);
        self.mean.resize(which.len(), 0.0);
        let (errors, intervals) = (fit.standard_errors(), fit.intervals(0.95));
        for (i, j) in which.iter().enumerate() {
            self.covered[i] += usize::from(intervals[*j].0 < wanted[*j] && wanted[*j] < intervals[*j].1);
            self.mean[i] += (fit.parameters()[*j] - wanted[*j]) / errors[*j];
        }
        self.runs += 1;
    }

    /// 95 of 100 expected, deviation 2.2; the mean has the deviation 0.1.
    fn check(&self, what: &str) {
        let mean: Vec<f64> = self.mean.iter().map(|m| m / self.runs as f64).collect();
        println!("{what}: {:?} of {}, mean {mean:?}", self.covered, self.runs);
        assert_eq!(self.runs, 100);
        assert!(self.covered.iter().all(|n| (88..=100).contains(n)), "{what}: {:?}", self.covered);
        assert!(mean.iter().all(|m| m.abs() < 0.35), "{what}: {mean:?}");
    }
}

/// At 0.3 of the sample rate nothing of the inputs' description shows; at 0.45 its part of 1e-4 must stay below the
/// noise, here of a tenth of the output's size.
#[test]
#[ignore = "slow"]
fn stat_transfer_functions_and_process_models() {
    let truth = transfer_function(&[50.0], &[50.0], 0.0);
    let late = transfer_function(&[2.0 / 0.03], &[1.0 / 0.03], 0.0137);
    let noise = &mut Noise::new(71);
    for (up_to, deviation) in [(0.3, 0.01), (0.45, 0.05)] {
        let (mut rational, mut process) = (Tally::default(), Tally::default());
        for _ in 0..100 {
            let data = record(&truth, up_to, 500, deviation, noise);
            let fit = ContinuousTransferFunction::new(0, 1).fit(&data).unwrap();
            rational.add(&fit, &[50.0, 50.0, 0.0], &[0, 1]);
            let data = record(&late, up_to, 500, deviation, noise);
            let fit = ProcessFit::named("P1D").unwrap().with_delay_between(&[(0.0, 0.05)]).fit(&data).unwrap();
            process.add(&fit, &[2.0, 0.03, 0.0137], &[0, 1, 2]);
        }
        rational.check(&format!("transfer function up to {up_to}"));
        process.check(&format!("process model up to {up_to}"));
    }
}

/// A grey box without a noise model, and with one whose noise enters between the samples.
#[test]
#[ignore = "slow"]
fn stat_grey_box() {
    let truth = transfer_function(&[50.0], &[50.0], 0.0);
    let (mut output_error, mut disturbed) = (Tally::default(), Tally::default());
    let noise = &mut Noise::new(72);
    // Of the state's noise over a sample: q (1 − e^{−2 a T})/(2 a).
    let deviation = (0.04 * (1.0 - (-2.0 * 50.0 * T).exp()) / 100.0_f64).sqrt();
    for _ in 0..100 {
        let data = record(&truth, 0.3, 500, 0.01, noise);
        output_error.add(&GreyBox::new(PLAIN).fit(&data).unwrap(), &[50.0, 50.0], &[0, 1]);
        let mut state = 0.0;
        let data = record(&truth, 0.3, 500, 0.02, noise).map_experiments(|e| {
            let outputs = Mat::from_fn(e.len(), 1, |t, _| {
                state = (-50.0 * T).exp() * state + deviation * noise.normal();
                e.outputs[(t, 0)] + state
            });
            Ok(Experiment { outputs, ..e.clone() })
        });
        let fit = GreyBox::new(Lag { noise: true, ..PLAIN }).fit(&data.unwrap()).unwrap();
        disturbed.add(&fit, &[50.0, 50.0], &[0, 1]);
    }
    output_error.check("output error");
    disturbed.check("noise in the state");
}

/// The tests of residuals take what the estimate did for what it is: the truth passes as often as their level says.
#[test]
#[ignore = "slow"]
fn stat_residual_tests() {
    let truth = transfer_function(&[50.0], &[50.0], 0.0);
    let noise = &mut Noise::new(73);
    let mut passed = [0; 2];
    for _ in 0..100 {
        let (data, other) = (record(&truth, 0.3, 400, 0.02, noise), record(&truth, 0.3, 400, 0.02, noise));
        let fit = ContinuousTransferFunction::new(0, 1).fit(&data).unwrap();
        let test = ResidualTest { lags: 20, ..ResidualTest::default() };
        for (count, (data, which)) in passed.iter_mut().zip([(&data, TestData::Own), (&other, TestData::Unseen)]) {
            let report = test.run(&fit, data, which).unwrap();
            *count += usize::from(report.independence[0][0].dynamics.p_value > 0.05);
        }
    }
    println!("{passed:?}");
    assert!(passed.iter().all(|n| (86..=100).contains(n)), "{passed:?}");
}
