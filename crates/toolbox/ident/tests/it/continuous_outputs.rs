//! Continuous models of several outputs, whose errors have something in common.
#![allow(clippy::print_stdout)]

use faer::{Mat, mat};
use ident::{
    ContinuousTransferFunction, Dataset, Fit, Intersample, LinearModel, ProcessFit, RationalChannel,
    TransferFunctionModel,
};

use crate::noise::Noise;

const TRUTH: [f64; 6] = [3.0, 2.0, 0.0, 1.5, 1.0, 0.0];

/// 3/(s + 2) and 1.5/(s + 1) of one input, errors with the correlation 0.9 at an instant and this memory.
fn record(count: usize, sd: f64, memory: f64, noise: &mut Noise) -> Dataset {
    let channel = |k: usize| RationalChannel::new(vec![TRUTH[k]], vec![TRUTH[k + 1]], 0.0).unwrap();
    let truth = TransferFunctionModel::new(vec![channel(0), channel(3)], 1, Mat::identity(2, 2)).unwrap();
    let model = truth.innovations(0.1, Intersample::ZeroOrderHold).unwrap().system().clone();
    let mut level = 0.0;
    let u = Mat::from_fn(count, 1, |_, _| {
        level = if noise.uniform() < 0.3 { noise.normal() } else { level };
        level
    });
    let mut y = model.simulate(u.as_ref(), &vec![0.0; model.states()]).unwrap();
    let (common, own) = (noise.coloured(count, sd, memory), noise.coloured(count, sd, memory));
    for t in 0..count {
        y[(t, 0)] += common[t];
        y[(t, 1)] += 0.9 * common[t] + 0.19_f64.sqrt() * own[t];
    }
    Dataset::new(0.1, u, y).unwrap()
}

/// The parameters, and the sums and differences of those of both outputs, in their 95 % intervals.
fn coverage(memory: f64, fit: impl Fn(&Dataset) -> Fit<TransferFunctionModel>) -> (Vec<usize>, [f64; 2]) {
    let mut inside = vec![0; 8];
    let mut noise = Noise::new(91);
    let mut squares = [0.0; 2];
    for _ in 0..1000 {
        // Noise that remembers leaves a tenth as many independent samples.
        let count = if memory > 0.0 { 1200 } else { 400 };
        let data = record(count, 0.3, memory, &mut noise);
        let found = fit(&data);
        let (values, p) = (found.parameters(), &found.covariance);
        let quantile = ident::distributions::student_t_quantile(0.975, found.degrees_of_freedom);
        let weights = |k: usize| -> [f64; 4] {
            [
                [1., 0., 0., 0.],
                [0., 1., 0., 0.],
                [0., 0., 1., 0.],
                [0., 0., 0., 1.],
                [1., 0., 1., 0.],
                [1., 0., -1., 0.],
                [0., 1., 0., 1.],
                [0., 1., 0., -1.],
            ][k]
        };
        let places = [0, 1, 3, 4];
        for (k, inside) in inside.iter_mut().enumerate() {
            let w = weights(k);
            let error: f64 = (0..4).map(|i| w[i] * (values[places[i]] - TRUTH[places[i]])).sum();
            let variance: f64 = (0..4)
                .flat_map(|i| (0..4).map(move |j| (i, j)))
                .map(|(i, j)| w[i] * w[j] * p[(places[i], places[j])])
                .sum();
            *inside += usize::from(error.abs() < quantile * variance.sqrt());
        }
        squares[0] += (values[1] - 2.0).powi(2) / 1000.0;
        squares[1] += (values[4] - 1.0).powi(2) / 1000.0;
    }
    (inside, squares.map(f64::sqrt))
}

#[test]
#[ignore = "slow"]
fn stat_errors_of_outputs_are_counted_together() {
    for memory in [0.0, 0.8] {
        let (inside, spread) = coverage(memory, |data| ContinuousTransferFunction::new(0, 1).fit(data).unwrap());
        let (apart, spread_apart) = coverage(memory, |data| {
            let one =
                |k: usize| ContinuousTransferFunction::new(0, 1).fit(&data.channels(&[0], &[k]).unwrap()).unwrap();
            let (first, second) = (one(0), one(1));
            let channels = [&first, &second].map(|f| f.model.channel(0, 0).unwrap().clone()).to_vec();
            let model = TransferFunctionModel::new(channels, 1, Mat::identity(2, 2)).unwrap();
            let mut covariance = Mat::zeros(6, 6);
            covariance.submatrix_mut(0, 0, 3, 3).copy_from(&first.covariance);
            covariance.submatrix_mut(3, 3, 3, 3).copy_from(&second.covariance);
            Fit { covariance, ..first.map(|_| model) }
        });
        println!("{memory}: {inside:?} {spread:?}; apart {apart:?} {spread_apart:?}");
        assert!(inside.iter().all(|n| (925..=975).contains(n)), "{memory}: {inside:?}");
    }
}

/// The loss is the determinant of the mean of ε εᵀ, smaller than that of estimates of each output.
#[test]
fn prop_the_loss_is_the_smallest_determinant() {
    let data = record(300, 0.3, 0.0, &mut Noise::new(4));
    let fit = ContinuousTransferFunction::new(0, 1).fit(&data).unwrap();
    let determinant = |model: &TransferFunctionModel| {
        let judged = ident::validate::judge(model, &data, None, &ident::prediction::InitialState::Estimated).unwrap();
        let e = &judged.response.outputs[0];
        let y = &data.experiments()[0].outputs;
        let mean = |i: usize, j: usize| {
            (0..300).map(|t| (y[(t, i)] - e[(t, i)]) * (y[(t, j)] - e[(t, j)])).sum::<f64>() / 300.0
        };
        mean(0, 0) * mean(1, 1) - mean(0, 1).powi(2)
    };
    assert!((fit.loss / determinant(&fit.model) - 1.0).abs() < 0.01, "{} {}", fit.loss, determinant(&fit.model));
    let apart: Vec<RationalChannel> = (0..2)
        .map(|k| {
            let one = ContinuousTransferFunction::new(0, 1).fit(&data.channels(&[0], &[k]).unwrap()).unwrap();
            one.model.channel(0, 0).unwrap().clone()
        })
        .collect();
    let apart = TransferFunctionModel::new(apart, 1, Mat::identity(2, 2)).unwrap();
    assert!(fit.loss < determinant(&apart), "{} {}", fit.loss, determinant(&apart));
    let p = &fit.covariance;
    let correlation = p[(0, 3)] / (p[(0, 0)] * p[(3, 3)]).sqrt();
    assert!(correlation > 0.7, "{correlation}");
    let noise = &fit.noise_covariance;
    assert!((noise[(0, 1)] / (noise[(0, 0)] * noise[(1, 1)]).sqrt() - 0.9).abs() < 0.05);
}

/// Noise-free data give the truth, also with gaps in one output; an output at every third sample stands by itself.
#[test]
fn exact_outputs_with_gaps_of_their_own() {
    let whole = record(400, 0.0, 0.0, &mut Noise::new(6));
    let e = &whole.experiments()[0];
    let blanked = |blank: &dyn Fn(usize, usize) -> bool| {
        let y = Mat::from_fn(400, 2, |t, k| if blank(t, k) { f64::NAN } else { e.outputs[(t, k)] });
        Dataset::new(0.1, e.inputs.clone(), y).unwrap()
    };
    let gaps = blanked(&|t, k| (k == 0 && (30..60).contains(&t)) || (k == 1 && t.is_multiple_of(11)));
    let slow = blanked(&|t, k| k == 1 && !t.is_multiple_of(3));
    for data in [&whole, &gaps, &slow] {
        let fit = ContinuousTransferFunction::new(0, 1).fit(data).unwrap();
        for (found, wanted) in fit.parameters().iter().zip(TRUTH) {
            assert!((found - wanted).abs() < 1e-7, "{found} {wanted}");
        }
        let process = ProcessFit::named("P1").unwrap().fit(data).unwrap();
        for (found, wanted) in process.parameters().iter().zip([1.5, 0.5, 1.5, 1.0]) {
            assert!((found - wanted).abs() < 1e-7, "{found} {wanted}");
        }
    }
}

/// The second output is three times the first: it says nothing new, and its parameters vary with those of the first.
#[test]
fn exact_an_output_that_is_three_times_another_adds_nothing() {
    let data = record(300, 0.3, 0.0, &mut Noise::new(8));
    let e = &data.experiments()[0];
    let double = Mat::from_fn(300, 2, |t, k| if k == 0 { e.outputs[(t, 0)] } else { 3.0 * e.outputs[(t, 0)] });
    let double = Dataset::new(0.1, e.inputs.clone(), double).unwrap();
    let fit = |data: &Dataset| ContinuousTransferFunction::new(0, 1).fit(data).unwrap();
    let (one, two) = (fit(&data.channels(&[0], &[0]).unwrap()), fit(&double));
    let scale = mat![[1.0, 1.0], [3.0, 1.0]];
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let ratio = two.parameters()[3 * i + j] / one.parameters()[j] / scale[(i, j)];
        assert!((ratio - 1.0).abs() < 1e-5, "{i} {j}: {ratio}");
        let ratio = two.standard_errors()[3 * i + j] / one.standard_errors()[j] / scale[(i, j)];
        // Errors that depend on each other have no autoregression, so colour that chance shows in one is not counted.
        assert!((ratio - 1.0).abs() < 0.1, "{i} {j}: {ratio}");
    }
}

/// The errors of short records look opposed from sample to sample; that makes no interval shorter beside another
/// output.
#[test]
fn regress_another_output_does_not_narrow_the_intervals_of_short_records() {
    let fit = |data: &Dataset| ContinuousTransferFunction::new(0, 1).with_offset().fit(data).unwrap().standard_errors();
    let ratio = |seed: u64| {
        let mut noise = Noise::new(seed);
        let clean = record(40, 0.0, 0.0, &mut noise);
        let e = &clean.experiments()[0];
        let y = Mat::from_fn(40, 2, |t, i| e.outputs[(t, i)] + 0.3 * noise.normal());
        let alone = fit(&Dataset::siso(0.1, e.input(0), &(0..40).map(|t| y[(t, 0)]).collect::<Vec<f64>>()).unwrap());
        fit(&Dataset::new(0.1, e.inputs.clone(), y).unwrap())[1] / alone[1]
    };
    let least = (0..20).map(ratio).fold(f64::INFINITY, f64::min);
    assert!(least > 0.85, "{least}");
}
