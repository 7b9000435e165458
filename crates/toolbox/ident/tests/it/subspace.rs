//! Subspace identification.
#![allow(clippy::print_stdout, clippy::disallowed_methods)]

use faer::{Mat, mat};
use ident::prediction::InitialState;
use ident::validate::{fit_percent, judge};
use ident::{Dataset, Doubt, Experiment, IdentError, Subspace, Trend, TrendScope, TrendShape, Weighting};
use lti::StateSpace;

use crate::noise::Noise;
use crate::systems::{data, gain_error, mimo, outputs, pole_near, siso, white_inputs};
use testdata::shared;

const ALL: [Weighting; 3] = [Weighting::N4sid, Weighting::Moesp, Weighting::Cva];

#[test]
fn exact_siso_of_every_weighting() {
    let truth = siso(0.0);
    let data = data(&truth, 300, &[1.0, -2.0, 0.5, 3.0], 1);
    for weighting in ALL {
        let fit = Subspace::new(4).with_weighting(weighting).fit(&data).unwrap();
        let error = gain_error(fit.model.system(), truth.system());
        assert!(error < 1e-9, "{weighting:?}: {error:e}");
        assert!(fit.noise_covariance[(0, 0)] < 1e-18, "{weighting:?}: {:e}", fit.noise_covariance[(0, 0)]);
    }
}

#[test]
fn regress_more_states_than_asked_for_without_noise() {
    let mut noise = Noise::new(5);
    let u = noise.normals(4000);
    let mut y = vec![0.0; 4000];
    for t in 3..4000 {
        y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + 0.1 * u[t - 2] + 0.1 * u[t - 3];
    }
    let data = Dataset::siso(0.01, &u, &y).unwrap();
    // The level that is taken off is one more state without noise.
    let data = Trend::estimate(&data, TrendShape::Mean, TrendScope::Common).unwrap().remove(&data).unwrap();
    let model = Subspace::new(3).fit(&data).unwrap().model;
    let judged = judge(&model, &data, None, &InitialState::Estimated).unwrap();
    let percent = fit_percent(data.experiments()[0].output(0), judged.response.outputs[0].col_as_slice(0)).unwrap();
    assert!(percent > 99.0, "{percent} %");
}

#[test]
fn exact_mimo_with_several_experiments() {
    let truth = mimo(0.0);
    let mut noise = Noise::new(2);
    let first = data(&truth, 200, &[5.0, 0.0, -1.0], 3);
    let u = white_inputs(150, 2, &mut noise);
    let y = outputs(&truth, &u, &[-3.0, 2.0, 0.0], &mut noise);
    let second = Experiment { name: "2".into(), start_s: 0.0, inputs: u, outputs: y };
    let both = first.with_experiment(second).unwrap();
    for weighting in ALL {
        let fit = Subspace::new(3).with_feedthrough().with_weighting(weighting).fit(&both).unwrap();
        let error = gain_error(fit.model.system(), truth.system());
        assert!(error < 1e-9, "{weighting:?}: {error:e}");
        assert_eq!(fit.initial_states.len(), 2);
    }
}

#[test]
fn exact_badly_scaled_channels() {
    let truth = mimo(0.0);
    let plain = data(&truth, 300, &[0.0; 3], 4);
    let e = &plain.experiments()[0];
    let (su, sy) = ([1e9, 1e-6], [1e-8, 1e5]);
    let scaled = Dataset::new(
        0.1,
        Mat::from_fn(300, 2, |i, j| su[j] * e.inputs[(i, j)]),
        Mat::from_fn(300, 2, |i, j| sy[j] * e.outputs[(i, j)]),
    )
    .unwrap();
    let fit = Subspace::new(3).with_feedthrough().fit(&scaled).unwrap();
    let (found, wanted) = (fit.model.system(), truth.system());
    let (g, h) = (&found.gains(&[3.0])[0], &wanted.gains(&[3.0])[0]);
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let back = g[(i, j)] * su[j] / sy[i];
        assert!((back - h[(i, j)]).norm() < 1e-8, "{i}{j}");
    }
}

#[test]
fn exact_near_the_unit_circle() {
    // Poles at 0.9999 e^{±0.01j}, as of a slow, lightly damped mode sampled fast.
    let (r, w) = (0.9999_f64, 0.01_f64);
    let a = faer::mat![[r * w.cos(), r * w.sin()], [-r * w.sin(), r * w.cos()]];
    let system =
        lti::StateSpace::discrete(a, faer::mat![[1.0], [0.5]], faer::mat![[1.0, 0.2]], faer::mat![[0.0]], 0.1).unwrap();
    let truth = lti::Innovations::output_error(system, faer::mat![[0.0]]).unwrap();
    let data = data(&truth, 3000, &[1.0, 1.0], 5);
    for weighting in ALL {
        let fit = Subspace::new(2).with_weighting(weighting).fit(&data).unwrap();
        let pole = pole_near(fit.model.system(), lti::Complex64::new(r * w.cos(), r * w.sin()));
        assert!((pole - lti::Complex64::new(r * w.cos(), r * w.sin())).norm() < 1e-9, "{weighting:?} {pole}");
    }
}

#[test]
fn stat_finds_system_and_noise_of_every_weighting() {
    let truth = siso(0.3);
    let data = data(&truth, 50_000, &[0.0; 4], 6);
    for weighting in ALL {
        let fit = Subspace::new(4).with_weighting(weighting).fit(&data).unwrap();
        let error = gain_error(fit.model.system(), truth.system());
        assert!(error < 0.01, "{weighting:?}: {error:e}");
        let noise = gain_error(&fit.model.innovations().noise_system().unwrap(), &truth.noise_system().unwrap());
        assert!(noise < 0.1, "{weighting:?}: {noise:e}");
        assert!((fit.noise_covariance[(0, 0)] / 0.09 - 1.0).abs() < 0.02);
    }
}

#[test]
fn stat_chooses_the_order() {
    for (truth, order) in [(siso(0.3), 4), (mimo(0.3), 3)] {
        let data = data(&truth, 20_000, &vec![0.0; order], 7);
        let fit = Subspace::auto(10).fit(&data).unwrap();
        assert_eq!(fit.model.system().states(), order, "{:?}", Subspace::auto(10).singular_values(&data));
    }
}

#[test]
fn stat_time_series_without_inputs() {
    let truth = siso(1.0);
    let mut noise = Noise::new(8);
    let y = outputs(&truth, &Mat::zeros(20_000, 1), &[0.0; 4], &mut noise);
    let data = Dataset::new(0.1, Mat::new(), y).unwrap();
    let fit = Subspace::new(4).fit(&data).unwrap();
    let noise = gain_error(&fit.model.innovations().noise_system().unwrap(), &truth.noise_system().unwrap());
    assert!(noise < 0.1, "{noise}");
    assert!((fit.noise_covariance[(0, 0)] - 1.0).abs() < 0.03);
}

#[test]
fn exact_smooth_input_that_the_gram_matrix_cannot_hold() {
    // Without noise, and with an input so smooth that its shifts hardly differ, the Gram matrix holds too few digits.
    let truth = siso(0.0);
    let mut noise = Noise::new(9);
    let mut u = white_inputs(2000, 1, &mut noise);
    for _ in 0..4 {
        for t in 1..2000 {
            u[(t, 0)] = 0.9 * u[(t - 1, 0)] + 0.1 * u[(t, 0)];
        }
    }
    let y = outputs(&truth, &u, &[0.0; 4], &mut noise);
    let smooth = Dataset::new(0.1, u, y).unwrap();
    for weighting in ALL {
        let fit = Subspace::new(4).with_weighting(weighting).fit(&smooth).unwrap();
        let error = gain_error(fit.model.system(), truth.system());
        assert!(error < 1e-5, "{weighting:?}: {error:e}");
    }
}

#[test]
fn prop_stability_when_asked_for() {
    // An unstable first-order system: growth 1.02 over 120 samples.
    let system =
        lti::StateSpace::discrete(faer::mat![[1.02]], faer::mat![[1.0]], faer::mat![[1.0]], faer::mat![[0.0]], 0.1)
            .unwrap();
    let truth = lti::Innovations::output_error(system, faer::mat![[0.0001]]).unwrap();
    let data = data(&truth, 120, &[0.0], 10);
    let free = Subspace::new(1).fit(&data).unwrap();
    assert!((free.model.system().a()[(0, 0)] - 1.02).abs() < 2e-3);
    assert!(free.doubts.contains(&ident::Doubt::Unstable));
    let stable = Subspace::new(1).with_stability().fit(&data).unwrap();
    assert!(stable.model.system().is_stable().unwrap());
}

/// Two states more than there are: what is estimated for them must neither grow nor spoil the others.
#[test]
fn regress_states_beyond_the_order_do_not_make_the_model_unstable() {
    let (g, h) = ([0.0, 1.0, 0.5], [1.0, -1.0, 0.2]);
    for seed in 1..6 {
        let mut noise = Noise::new(seed);
        let mut level = 1.0;
        let mut held = |t: usize, noise: &mut Noise| {
            if t.is_multiple_of(3) {
                level = if noise.uniform() < 0.5 { -1.0 } else { 1.0 };
            }
            level
        };
        let u: Vec<f64> = (0..10_000).map(|t| held(t, &mut noise)).collect();
        let e = noise.normals(u.len());
        let mut y = vec![0.0; u.len()];
        for t in 2..u.len() {
            let forced: f64 = (0..3).map(|l| g[l] * u[t - l] + 0.5 * h[l] * e[t - l]).sum();
            y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + forced;
        }
        let a = mat![[1.5, -0.7], [1.0, 0.0]];
        let truth = StateSpace::discrete(a, mat![[1.0], [0.0]], mat![[1.0, 0.5]], mat![[0.0]], 1.0).unwrap();
        let data = Dataset::siso(1.0, &u, &y).unwrap();
        for weighting in [Weighting::N4sid, Weighting::Moesp, Weighting::Cva] {
            let fit = Subspace::new(4).with_weighting(weighting).fit(&data).unwrap();
            let error = gain_error(fit.model.system(), &truth);
            assert!(!fit.doubts.contains(&Doubt::Unstable), "{seed} {weighting:?}");
            assert!(error < 0.02 && fit.loss < 0.26, "{seed} {weighting:?} {error} {}", fit.loss);
        }
    }
}

#[test]
fn prop_unusable_data_are_refused() {
    let truth = siso(0.1);
    let good = data(&truth, 500, &[0.0; 4], 11);
    let e = &good.experiments()[0];
    let with = |u: Mat<f64>, y: Mat<f64>| Subspace::new(4).fit(&Dataset::new(0.1, u, y).unwrap());
    let constant = with(Mat::full(500, 1, 1.0), e.outputs.clone());
    assert!(matches!(constant, Err(IdentError::RankDeficient { .. })), "{constant:?}");
    let silent = with(Mat::zeros(500, 1), e.outputs.clone());
    assert!(matches!(silent, Err(IdentError::Constant { .. })));
    let twice = with(Mat::from_fn(500, 2, |i, _| e.inputs[(i, 0)]), e.outputs.clone());
    assert!(matches!(twice, Err(IdentError::RankDeficient { .. })), "{twice:?}");
    let mut gap = e.outputs.clone();
    gap[(17, 0)] = f64::NAN;
    assert!(matches!(with(e.inputs.clone(), gap), Err(IdentError::Missing { index: 17, .. })));
    let cut = |m: &Mat<f64>| m.subrows(0, 20).to_owned();
    assert!(matches!(with(cut(&e.inputs), cut(&e.outputs)), Err(IdentError::TooFewSamples { .. })));
    assert!(matches!(with(Mat::zeros(0, 1), Mat::zeros(0, 1)), Err(IdentError::TooFewSamples { .. })));
    assert!(matches!(Subspace::new(0).fit(&good), Err(IdentError::Structure { .. })));
    assert!(matches!(Subspace::new(4).with_horizons(2, 2).fit(&good), Err(IdentError::Structure { .. })));
}

/// The hair dryer as SLICOT's examples have it: input, then output, a thousand of each after the first two lines.
pub(crate) fn slicot_dryer() -> Option<Dataset> {
    let text = std::fs::read_to_string(shared("reference/peers/slicot/IB01AD.dat")?).unwrap();
    let values: Vec<f64> = text.lines().skip(2).flat_map(str::split_whitespace).map(|v| v.parse().unwrap()).collect();
    Some(Dataset::siso(0.08, &values[..1000], &values[1000..2000]).unwrap())
}

#[test]
fn ref_slicot_dryer() {
    let Some(data) = slicot_dryer() else { return };
    let subspace = Subspace::new(4).with_horizons(15, 15).with_weighting(Weighting::Moesp).with_feedthrough();
    let published = [
        69.8841, 14.9963, 3.6675, 1.9677, 0.3000, 0.2078, 0.1651, 0.1373, 0.1133, 0.1059, 0.0856, 0.0784, 0.0733,
        0.0678, 0.0571,
    ];
    let values = subspace.singular_values(&data).unwrap();
    println!("{values:?}");
    for (value, published) in values.iter().zip(published) {
        assert!((value / values[0] / (published / published_first()) - 1.0).abs() < 2e-2, "{value} {published}");
    }
    let fit = subspace.fit(&data).unwrap();
    let a = mat![
        [0.8924, 0.3887, 0.1285, 0.1716],
        [-0.0837, 0.6186, -0.6273, -0.4582],
        [0.0052, 0.1307, 0.6685, -0.6755],
        [0.0055, 0.0734, -0.2148, 0.4788]
    ];
    let c = mat![[-0.4442, 0.6663, 0.3961, 0.4102]];
    // Input matrices from all of the outputs, as in IB01CD, and the noise gain of IB01BD.
    let system = |b: Mat<f64>, d: f64| lti::StateSpace::discrete(a.clone(), b, c.clone(), mat![[d]], 0.08).unwrap();
    let published = system(mat![[-0.2150], [-0.1962], [0.0511], [0.0373]], -0.0018);
    let noise = system(mat![[-1.9513], [-0.1867], [0.6348], [-0.3486]], 1.0);
    for pole in published.poles().unwrap() {
        assert!((pole_near(fit.model.system(), pole) - pole).norm() < 2e-3, "{pole}");
    }
    let (gain, noise_gain) = (
        gain_error(fit.model.system(), &published),
        gain_error(&fit.model.innovations().noise_system().unwrap(), &noise),
    );
    println!("{gain} {noise_gain} {:?}", fit.noise_covariance);
    assert!(gain < 0.01 && noise_gain < 0.005);
    assert!((fit.noise_covariance[(0, 0)] - 0.0012).abs() < 3e-4);
}

fn published_first() -> f64 {
    69.8841
}

#[test]
fn regress_an_order_is_chosen_on_few_samples() {
    let mut noise = crate::noise::Noise::new(2);
    let u: Vec<f64> = noise.normals(30);
    let mut y = vec![0.0; 30];
    for t in 1..30 {
        y[t] = 0.7 * y[t - 1] + u[t - 1] + 0.01 * noise.normal();
    }
    let fit = Subspace::auto(10).fit(&Dataset::siso(0.1, &u, &y).unwrap()).unwrap();
    assert!(
        fit.model.system().states() <= 3
            && fit.model.system().poles().unwrap().iter().any(|p| (p.re - 0.7).abs() < 0.1)
    );
}

/// Behind sines from rest, and without noise, the inputs alone explain the future: there are no states to be seen.
#[test]
fn regress_data_without_noise_and_with_few_frequencies_give_a_model_or_a_reason() {
    for input in [|k: f64| 5.0 * (0.3 * k).sin(), |k: f64| (0.3 * k).sin() + (0.7 * k).cos(), |k: f64| 0.01 * k] {
        let u: Vec<f64> = (0..400).map(|k| input(f64::from(k))).collect();
        let mut y = vec![0.0; 400];
        (2..400).for_each(|t| y[t] = -0.8 * y[t - 1] - 0.5 * y[t - 2] + u[t - 1]);
        let data = Dataset::siso(1.0, &u, &y).unwrap();
        for weighting in [Weighting::Automatic, Weighting::Cva, Weighting::N4sid, Weighting::Moesp, Weighting::Ssarx] {
            for subspace in [Subspace::new(2), Subspace::auto(10), Subspace::new(2).without_noise_model()] {
                match subspace.with_weighting(weighting).fit(&data) {
                    Ok(fit) => assert!(fit.loss.is_finite(), "{weighting:?}"),
                    Err(error) => assert!(matches!(error, IdentError::RankDeficient { .. }), "{weighting:?}: {error}"),
                }
            }
        }
    }
}
