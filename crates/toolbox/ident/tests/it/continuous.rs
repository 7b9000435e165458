//! Continuous-time transfer functions from sampled data.
#![allow(clippy::print_stdout)]

use faer::Mat;
use ident::{
    ContinuousTransferFunction, Dataset, Fit, IdentError, Intersample, LinearModel, Parametric, RationalChannel,
    TransferFunctionMethod, TransferFunctionModel,
};
use lti::Simulator;

use crate::noise::Noise;

/// A model of one output from (num, den without its leading one, delay), one an input.
const INSTRUMENTS: TransferFunctionMethod = TransferFunctionMethod::InstrumentalVariables;

fn model(channels: &[(&[f64], &[f64], f64)]) -> TransferFunctionModel {
    let made =
        channels.iter().map(|(num, den, delay)| RationalChannel::new(num.to_vec(), den.to_vec(), *delay).unwrap());
    TransferFunctionModel::new(made.collect(), channels.len(), Mat::identity(1, 1)).unwrap()
}

/// Inputs that change at random every few samples, or white ones.
fn inputs(noise: &mut Noise, count: usize, channels: usize, hold: usize) -> Mat<f64> {
    let mut u = Mat::zeros(count, channels);
    for j in 0..channels {
        let mut value = 0.0;
        for i in 0..count {
            if i % hold == 0 {
                value = noise.normal();
            }
            u[(i, j)] = value;
        }
    }
    u
}

/// The model's output from a state other than zero, with white noise on it; the input's past is simulated and cut off.
fn record(
    model: &TransferFunctionModel,
    u: &Mat<f64>,
    t: f64,
    hold: Intersample,
    sd: f64,
    noise: &mut Noise,
) -> Dataset {
    let white = noise.normals(u.nrows()).into_iter().map(|v| sd * v).collect();
    disturbed(model, u, (t, hold), white)
}

/// As [`record`], with this noise.
fn disturbed(model: &TransferFunctionModel, u: &Mat<f64>, (t, hold): (f64, Intersample), v: Vec<f64>) -> Dataset {
    let system = model.innovations(t, hold).unwrap().system().clone();
    let cut = u.nrows() / 10;
    let mut simulator = Simulator::new(&system, &vec![0.0; system.states()]).unwrap();
    let mut y = Mat::zeros(u.nrows(), 1);
    let mut out = [0.0];
    for k in 0..u.nrows() {
        let row: Vec<f64> = (0..u.ncols()).map(|j| u[(k, j)]).collect();
        simulator.output(&row, &mut out);
        simulator.advance(&row);
        y[(k, 0)] = out[0] + v[k];
    }
    let cut_off = |m: &Mat<f64>| m.subrows(cut, m.nrows() - cut).to_owned();
    Dataset::new(t, cut_off(u), cut_off(&y)).unwrap().with_intersample(hold)
}

fn worst(found: &[f64], truth: &[f64]) -> f64 {
    found.iter().zip(truth).map(|(f, t)| (f - t).abs() / t.abs().max(1e-12)).fold(0.0, f64::max)
}

fn exact(
    truth: &TransferFunctionModel,
    options: &ContinuousTransferFunction,
    t: f64,
    hold: Intersample,
    each: usize,
) -> Fit<TransferFunctionModel> {
    let noise = &mut Noise::new(5);
    let u = inputs(noise, 1500, truth.inputs(), each);
    let data = record(truth, &u, t, hold, 0.0, noise);
    options.fit(&data).unwrap()
}

#[test]
fn exact_second_order_with_a_zero() {
    let truth = model(&[(&[2.0, 30.0], &[4.0, 25.0], 0.0)]);
    for hold in [Intersample::ZeroOrderHold, Intersample::FirstOrderHold] {
        let fit = exact(&truth, &ContinuousTransferFunction::new(1, 2), 0.05, hold, 3);
        let (found, wanted) = (fit.parameters(), truth.parameters());
        assert!(worst(&found[..4], &wanted[..4]) < 1e-8, "{hold:?} {found:?}");
        assert!(fit.loss < 1e-18, "{}", fit.loss);
    }
}

/// Instrumental variables alone, with a known delay of a fraction of a sample and with an integrator and an offset.
#[test]
fn exact_by_instrumental_variables() {
    let truth = model(&[(&[2.0, 30.0], &[4.0, 25.0], 0.137)]);
    for hold in [Intersample::ZeroOrderHold, Intersample::FirstOrderHold] {
        let options = ContinuousTransferFunction::new(1, 2).with_delay(&[0.137]).by(INSTRUMENTS);
        let fit = exact(&truth, &options, 0.05, hold, 3);
        assert!(worst(&fit.parameters()[..4], &truth.parameters()[..4]) < 1e-6, "{hold:?} {:?}", fit.parameters());
        assert!(fit.termination.converged());
    }
    let truth = model(&[(&[3.0], &[2.0, 0.0], 0.0)]);
    let options = ContinuousTransferFunction::new(0, 2).with_integrators(1).by(INSTRUMENTS);
    let fit = exact(&truth, &options, 0.1, Intersample::ZeroOrderHold, 5);
    assert!(worst(&fit.parameters()[..2], &truth.parameters()[..2]) < 1e-6, "{:?}", fit.parameters());
}

#[test]
fn regress_what_instrumental_variables_do_not_take_is_refused() {
    let truth = model(&[(&[2.0, 30.0], &[4.0, 25.0], 0.0)]);
    let u = inputs(&mut Noise::new(5), 300, 1, 3);
    let data = disturbed(&truth, &u, (0.05, Intersample::ZeroOrderHold), vec![0.0; 300]);
    let options = ContinuousTransferFunction::new(1, 2).by(INSTRUMENTS);
    for refused in [
        options.clone().with_delay_between(&[(0.0, 0.1)]),
        options.clone().from_rest(),
        options.clone().allow_unstable(),
    ] {
        assert!(matches!(refused.fit(&data), Err(IdentError::Structure { .. })));
    }
}

#[test]
fn exact_lightly_damped_fourth_order() {
    // Two modes of damping 0.005 at 330 and 480 rad/s.
    let pair = |w: f64| vec![1.0, 2.0 * 0.005 * w, w * w];
    let den = lti::polynomial::multiply(&pair(330.0), &pair(480.0));
    let truth = model(&[(&[200.0, 0.0, 3e7], &den[1..], 0.0)]);
    let fit = exact(&truth, &ContinuousTransferFunction::new(2, 4), 4e-4, Intersample::ZeroOrderHold, 2);
    let poles = fit.model.transfer_function(0, 0).unwrap();
    let wanted = truth.transfer_function(0, 0).unwrap();
    assert!(worst(poles.den(), wanted.den()) < 1e-8, "{:?} {:?}", poles.den(), wanted.den());
}

#[test]
fn exact_over_eight_decades_of_time() {
    for speed in [1e-4, 1.0, 1e4] {
        let truth = model(&[(&[2.0 * speed], &[1.2 * speed, speed * speed], 0.0)]);
        let fit = exact(&truth, &ContinuousTransferFunction::new(0, 2), 0.3 / speed, Intersample::ZeroOrderHold, 2);
        assert!(worst(&fit.parameters()[..3], &truth.parameters()[..3]) < 1e-8, "{speed} {:?}", fit.parameters());
    }
}

#[test]
fn exact_stiff_fast_and_slow_sampling() {
    // Poles at −1 and −1000.
    let stiff = model(&[(&[5000.0], &[1001.0, 1000.0], 0.0)]);
    let fit = exact(&stiff, &ContinuousTransferFunction::new(0, 2), 5e-4, Intersample::ZeroOrderHold, 40);
    assert!(worst(&fit.parameters()[..3], &stiff.parameters()[..3]) < 1e-7, "{:?}", fit.parameters());
    // A pole of the sampled system at 0.9999.
    let slow = model(&[(&[1.0], &[0.3, 0.02], 0.0)]);
    let fit = exact(&slow, &ContinuousTransferFunction::new(0, 2), 1e-3, Intersample::ZeroOrderHold, 100);
    assert!(worst(&fit.parameters()[..3], &slow.parameters()[..3]) < 1e-6, "{:?}", fit.parameters());
    // Sampled one and a half times a time constant.
    let coarse = model(&[(&[3.0, 1.0], &[2.5, 1.5], 0.0)]);
    let fit = exact(&coarse, &ContinuousTransferFunction::new(1, 2), 1.5, Intersample::ZeroOrderHold, 1);
    assert!(worst(&fit.parameters()[..4], &coarse.parameters()[..4]) < 1e-8, "{:?}", fit.parameters());
}

#[test]
fn exact_delay_to_a_millionth_of_a_sample() {
    for (delay, hold) in [
        (0.237, Intersample::ZeroOrderHold),
        (0.85, Intersample::ZeroOrderHold),
        (0.3, Intersample::ZeroOrderHold),
        (0.0312, Intersample::FirstOrderHold),
        (0.4444, Intersample::FirstOrderHold),
    ] {
        for (num, den) in [(&[3.0][..], &[2.0][..]), (&[10.0], &[3.0, 16.0])] {
            let truth = model(&[(num, den, delay)]);
            let options = ContinuousTransferFunction::new(0, den.len()).with_delay_between(&[(0.0, 1.5)]);
            let fit = exact(&truth, &options, 0.1, hold, 3);
            let (found, wanted) = (fit.parameters(), truth.parameters());
            assert!((found.last().unwrap() - delay).abs() < 1e-7, "{hold:?} {found:?} {wanted:?}");
            assert!(worst(&found, &wanted) < 1e-6, "{hold:?} {found:?} {wanted:?}");
        }
    }
}

#[test]
fn exact_two_inputs_with_different_dynamics() {
    let truth = model(&[(&[2.0], &[1.5], 0.0), (&[-4.0, 6.0], &[1.0, 9.0], 0.0)]);
    let options = ContinuousTransferFunction::per_input(vec![0, 1], vec![1, 2]);
    let fit = exact(&truth, &options, 0.1, Intersample::ZeroOrderHold, 3);
    assert!(fit.loss < 1e-16, "{:?} {:?}", fit.parameters(), truth.parameters());
    assert_eq!(fit.model.parameter_names()[0], "b0[1]");
}

#[test]
fn exact_integrator_and_offset() {
    let truth = model(&[(&[3.0], &[2.0, 0.0], 0.0)]);
    let fit =
        exact(&truth, &ContinuousTransferFunction::new(0, 2).with_integrators(1), 0.1, Intersample::ZeroOrderHold, 5);
    let (found, wanted) = (fit.parameters(), truth.parameters());
    assert!((found[0] - wanted[0]).abs() < 1e-8 && (found[1] - wanted[1]).abs() < 1e-8 && found[2] == 0.0, "{found:?}");
    assert_eq!(fit.free_parameters, 2);
}

#[test]
fn exact_initial_state_reproduces_the_output() {
    let truth = model(&[(&[3.0], &[2.0, 9.0], 0.25)]);
    let noise = &mut Noise::new(3);
    let u = inputs(noise, 600, 1, 4);
    let data = record(&truth, &u, 0.1, Intersample::ZeroOrderHold, 0.0, noise);
    let fit = ContinuousTransferFunction::new(0, 2).with_delay(&[0.25]).fit(&data).unwrap();
    let system = fit.model.innovations(0.1, Intersample::ZeroOrderHold).unwrap().system().clone();
    let y = system.simulate(data.experiments()[0].inputs.as_ref(), &fit.initial_states[0]).unwrap();
    for (k, measured) in data.experiments()[0].output(0).iter().enumerate() {
        assert!((y[(k, 0)] - measured).abs() < 1e-7, "{k}");
    }
}

#[test]
fn regress_missing_outputs_are_left_out_and_missing_inputs_refused() {
    let truth = model(&[(&[3.0], &[2.0, 9.0], 0.0)]);
    let noise = &mut Noise::new(3);
    let u = inputs(noise, 600, 1, 4);
    let data = record(&truth, &u, 0.1, Intersample::ZeroOrderHold, 0.0, noise);
    let mut experiment = data.experiments()[0].clone();
    for k in (7..500).step_by(9) {
        experiment.outputs[(k, 0)] = f64::NAN;
    }
    let gappy = Dataset::new(0.1, experiment.inputs.clone(), experiment.outputs.clone()).unwrap();
    let fit = ContinuousTransferFunction::new(0, 2).fit(&gappy).unwrap();
    assert!(worst(&fit.parameters()[..3], &truth.parameters()[..3]) < 1e-8, "{:?}", fit.parameters());
    assert_eq!(fit.doubts.len(), 1);
    experiment.inputs[(40, 0)] = f64::NAN;
    let broken = Dataset::new(0.1, experiment.inputs, experiment.outputs).unwrap();
    let refused = ContinuousTransferFunction::new(0, 2).fit(&broken);
    assert!(matches!(refused, Err(IdentError::Missing { index: 40, .. })));
}

#[test]
fn regress_hopeless_data_are_refused() {
    let constant = Dataset::siso(0.1, &[1.0; 50], &[2.0; 50]).unwrap();
    let options = ContinuousTransferFunction::new(0, 1);
    assert!(matches!(options.fit(&constant), Err(IdentError::Constant { .. })));
    let short = Dataset::siso(0.1, &[1.0, 0.0, 1.0], &[2.0, 1.0, 3.0]).unwrap();
    assert!(matches!(options.fit(&short), Err(IdentError::TooFewSamples { .. })));
    let empty = Dataset::siso(0.1, &[], &[]).unwrap();
    assert!(options.fit(&empty).is_err());
    let series = Dataset::new(0.1, Mat::zeros(50, 0), Mat::zeros(50, 1)).unwrap();
    assert!(options.fit(&series).is_err());
    assert!(ContinuousTransferFunction::new(2, 1).fit(&constant).is_err());
    assert!(options.clone().with_delay_between(&[(0.3, 0.1)]).fit(&constant).is_err());
    let silent = Dataset::siso(0.1, &Noise::new(1).normals(80), &[0.0; 80]).unwrap();
    assert!(options.fit(&silent).is_err(), "an output that is zero determines no pole");
    for m in 0..=3 {
        let noise = Dataset::siso(0.1, &Noise::new(1).normals(80), &Noise::new(2).normals(80)).unwrap();
        let _ = ContinuousTransferFunction::new(m, 3).fit(&noise);
    }
}

#[test]
fn regress_too_many_poles_are_told() {
    let truth = model(&[(&[3.0], &[2.0], 0.0)]);
    for seed in 3..8 {
        let noise = &mut Noise::new(seed);
        let u = inputs(noise, 800, 1, 4);
        let data = record(&truth, &u, 0.1, Intersample::ZeroOrderHold, 0.05, noise);
        // Poles and zeros that cancel are seen in standard errors as large as the coefficients, or refused.
        match ContinuousTransferFunction::new(2, 3).fit(&data) {
            Ok(fit) => {
                let ratio =
                    fit.parameters().iter().zip(fit.standard_errors()).map(|(p, e)| e / p.abs()).fold(0.0, f64::max);
                assert!(!fit.doubts.is_empty() || ratio > 0.2, "{:?} {:?}", fit.parameters(), fit.standard_errors());
            }
            Err(error) => assert!(matches!(error, IdentError::RankDeficient { .. }), "{error}"),
        }
    }
}

fn searched() -> ContinuousTransferFunction {
    ContinuousTransferFunction::new(1, 2).with_delay_between(&[(0.0, 0.4)])
}

/// Bias and coverage where the noise remembers a sample by this part of its size.
fn judge(memory: f64, options: &ContinuousTransferFunction, judged: usize) {
    let truth = model(&[(&[2.0, 30.0], &[4.0, 25.0], 0.137)]);
    let wanted = truth.parameters();
    let (runs, mut covered, mut mean) = (100, vec![0; judged], vec![0.0; judged]);
    let mut noise = Noise::new(51);
    for _ in 0..runs {
        let u = inputs(&mut noise, 600, 1, 3);
        let v = noise.coloured(600, 0.05, memory);
        let fit = options.fit(&disturbed(&truth, &u, (0.05, Intersample::ZeroOrderHold), v)).unwrap();
        let errors = fit.standard_errors();
        for (j, (low, high)) in fit.intervals(0.95).into_iter().take(judged).enumerate() {
            covered[j] += usize::from(low < wanted[j] && wanted[j] < high);
            mean[j] += (fit.parameters()[j] - wanted[j]) / errors[j] / f64::from(runs);
        }
    }
    println!("{memory} {covered:?} {mean:?}");
    // 95 expected, deviation 2.2; the mean of standardised errors has the deviation 0.1.
    assert!(covered.iter().all(|n| (88..=100).contains(n)), "{covered:?}");
    assert!(mean.iter().all(|m| m.abs() < 0.3), "{mean:?}");
}

#[test]
#[ignore = "slow"]
fn stat_intervals_cover_the_truth_under_white_noise() {
    judge(0.0, &searched(), 5);
}

#[test]
#[ignore = "slow"]
fn stat_intervals_cover_the_truth_under_coloured_noise() {
    judge(0.8, &searched(), 5);
}

/// By instrumental variables, all but the delay, which is known.
#[test]
#[ignore = "slow"]
fn stat_intervals_of_instrumental_variables_cover_the_truth() {
    let options = ContinuousTransferFunction::new(1, 2).with_delay(&[0.137]).by(INSTRUMENTS);
    judge(0.0, &options, 4);
    judge(0.8, &options, 4);
}

/// Both ways come to the same estimate but for a part of its standard error.
#[test]
fn stat_instrumental_variables_agree_with_output_error() {
    let truth = model(&[(&[2.0, 30.0], &[4.0, 25.0], 0.137)]);
    let mut noise = Noise::new(52);
    for _ in 0..10 {
        let u = inputs(&mut noise, 600, 1, 3);
        let v = noise.coloured(600, 0.05, 0.0);
        let data = disturbed(&truth, &u, (0.05, Intersample::ZeroOrderHold), v);
        let options = ContinuousTransferFunction::new(1, 2).with_delay(&[0.137]);
        let (searched, settled) = (options.fit(&data).unwrap(), options.by(INSTRUMENTS).fit(&data).unwrap());
        assert!(settled.termination.converged(), "{:?}", settled.termination);
        let errors = searched.standard_errors();
        for j in 0..4 {
            let apart = (searched.parameters()[j] - settled.parameters()[j]).abs() / errors[j];
            assert!(apart < 0.5, "{j}: {apart}");
            assert!((settled.standard_errors()[j] / errors[j] - 1.0).abs() < 0.1);
        }
    }
}

#[test]
#[ignore = "slow"]
fn stat_a_hundred_thousand_samples_of_a_fast_sampled_resonance() {
    let truth = model(&[(&[30.0], &[0.02, 4.0], 0.0)]);
    let noise = &mut Noise::new(61);
    let u = inputs(noise, 110_000, 1, 500);
    let data = record(&truth, &u, 1e-3, Intersample::ZeroOrderHold, 5.0, noise);
    let fit = ContinuousTransferFunction::new(0, 2).fit(&data).unwrap();
    for ((found, wanted), error) in fit.parameters().iter().zip(truth.parameters()).zip(fit.standard_errors()).take(3) {
        assert!((found - wanted).abs() < 4.0 * error && error < 0.05 * wanted, "{found} {wanted} {error}");
    }
    assert!((fit.noise_covariance[(0, 0)] / 25.0 - 1.0).abs() < 0.02);
}

/// An output that answers in the same row: the errors over a range of delays have a second minimum at its far end.
#[test]
fn regress_the_least_over_a_range_of_delays_is_none_above_that_at_its_ends() {
    for seed in 0..3 {
        let mut noise = Noise::new(40 + seed);
        let u = noise.coloured(1500, 1.0, 0.9);
        let y: Vec<f64> = u.iter().map(|u| 0.4 * u + 0.05 * noise.normal()).collect();
        let data = Dataset::siso(0.001, &u, &y).unwrap();
        let searched = |range: (f64, f64)| {
            let options = ContinuousTransferFunction::new(0, 1).with_delay_between(&[range]).with_offset();
            options.fit(&data).unwrap().loss
        };
        let (short, long) = (searched((0.0, 0.004)), searched((0.0, 0.05)));
        assert!(long <= 1.05 * short, "{seed}: {long} {short}");
    }
}

/// The same of an input without the highest frequencies, where the pole that is best without delay is far away.
#[test]
fn regress_ranges_of_delays_are_no_worse_than_no_delay_under_a_smooth_input() {
    const T: f64 = 0.004;
    for seed in 0..3 {
        let mut noise = Noise::new(70 + seed);
        let white: Vec<f64> = (0..1804).map(|_| noise.normal()).collect();
        let smooth = |w: &[f64]| 0.066 * (w[0] + 2.0 * w[1] + 3.0 * w[2] + 2.0 * w[3] + w[4]);
        let u: Vec<f64> = white.windows(5).map(smooth).collect();
        let errors: Vec<f64> = (0..u.len()).map(|_| 0.056 * noise.normal()).collect();
        let y: Vec<f64> = u.iter().zip(&errors).map(|(u, e)| 0.4 * u + e).collect();
        let data = Dataset::siso(T, &u, &y).unwrap().with_intersample(Intersample::FirstOrderHold);
        let loss = |range: (f64, f64)| {
            ContinuousTransferFunction::new(0, 1).with_delay_between(&[range]).fit(&data).map(|fit| fit.loss)
        };
        // Of a pole that is far away.
        let without = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        for longest in [T, 12.5 * T] {
            // A pole that the data do not show is an error, and no other model is given in its place.
            match loss((0.0, longest)) {
                Ok(found) => assert!(found <= 1.05 * without, "{seed}, {longest} s: {found} {without}"),
                Err(error) => assert!(matches!(error, IdentError::RankDeficient { .. }), "{error}"),
            }
        }
    }
}
