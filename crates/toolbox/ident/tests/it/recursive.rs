use faer::Mat;
use ident::recursive::{Adaptation, Recursive, RecursiveStructure};
use ident::{Dataset, IdentError};

use crate::noise::Noise;

/// `y = 1.5 y(t−1) − 0.7 y(t−2) + u(t−1) + 0.5 u(t−2) + e + c e(t−1)`, or the same plant with noise on the output
/// alone.
fn simulate(seed: u64, rows: usize, c: f64, sigma: f64, output_error: bool) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = noise.normals(rows);
    let e: Vec<f64> = noise.normals(rows).iter().map(|v| sigma * v).collect();
    let mut x = vec![0.0; rows];
    for t in 2..rows {
        let disturbance = if output_error { 0.0 } else { e[t] + c * e[t - 1] };
        x[t] = 1.5 * x[t - 1] - 0.7 * x[t - 2] + u[t - 1] + 0.5 * u[t - 2] + disturbance;
    }
    let y: Vec<f64> = (0..rows).map(|t| if output_error { x[t] + e[t] } else { x[t] }).collect();
    Dataset::siso(0.1, &u, &y).unwrap()
}

fn arx() -> RecursiveStructure {
    RecursiveStructure::Arx { na: 2, nb: vec![2], nk: vec![1] }
}

fn armax() -> RecursiveStructure {
    RecursiveStructure::Armax { na: 2, nb: vec![2], nc: 1, nk: vec![1] }
}

fn output_error() -> RecursiveStructure {
    RecursiveStructure::OutputError { nb: vec![2], nf: vec![2], nk: vec![1] }
}

/// Weighted least squares over all rows of which the past is known, and the covariance of its parameters,
/// `s² P Φᵀ W² Φ P` with `P = (Φᵀ W Φ)⁻¹` and `s² = εᵀ W ε/(tr W − tr P Φᵀ W² Φ)`.
fn batch(data: &Dataset, forgetting: f64) -> (ident::LinearFit, Mat<f64>) {
    let e = &data.experiments()[0];
    let (u, y) = (e.input(0), e.output(0));
    let rows = e.len() - 2;
    let weight = |i: usize| forgetting.powf((rows - 1 - i) as f64);
    let regressors = |i: usize| [-y[i + 1], -y[i], u[i + 1], u[i]];
    let phi = Mat::from_fn(rows, 4, |i, j| weight(i).sqrt() * regressors(i)[j]);
    let target: Vec<f64> = (0..rows).map(|i| weight(i).sqrt() * y[i + 2]).collect();
    let fit = ident::least_squares(phi.as_ref(), &target).unwrap();
    let squared = Mat::from_fn(4, 4, |a, b| {
        (0..rows).map(|i| weight(i).powi(2) * regressors(i)[a] * regressors(i)[b]).sum::<f64>()
    });
    let p = &fit.unscaled_covariance;
    let taken = p * &squared;
    let freedom = (0..rows).map(weight).sum::<f64>() - (0..4).map(|i| taken[(i, i)]).sum::<f64>();
    let covariance = faer::Scale(fit.cost / freedom) * (p * &squared * p);
    (fit, covariance)
}

#[test]
fn exact_recursive_least_squares_equals_batch_least_squares() {
    for (scale_u, scale_y) in [(1.0, 1.0), (1e-6, 1e5), (1e6, 1e-3)] {
        let plain = simulate(1, 500, 0.0, 0.3, false);
        let e = &plain.experiments()[0];
        let scaled = |x: &[f64], s: f64| -> Vec<f64> { x.iter().map(|v| v * s).collect() };
        let data = Dataset::siso(0.1, &scaled(e.input(0), scale_u), &scaled(e.output(0), scale_y)).unwrap();
        for forgetting in [1.0, 0.98] {
            let mut recursive = Recursive::new(arx(), Adaptation::Forgetting(forgetting)).unwrap();
            recursive.run(&data).unwrap();
            let (batch, expected_covariance) = batch(&data, forgetting);
            let covariance = recursive.covariance().unwrap();
            for (j, (found, expected)) in recursive.parameters().iter().zip(&batch.parameters).enumerate() {
                assert!((found / expected - 1.0).abs() < 1e-9, "{forgetting}: {found} {expected}");
                assert!((covariance[(j, j)] / expected_covariance[(j, j)] - 1.0).abs() < 1e-7);
            }
        }
    }
}

#[test]
fn exact_noise_free_data_give_the_truth_by_every_structure() {
    let data = simulate(2, 400, 0.0, 0.0, false);
    for structure in [arx(), armax(), output_error()] {
        for adaptation in [
            Adaptation::Forgetting(1.0),
            Adaptation::Forgetting(0.95),
            Adaptation::RandomWalk { drift: vec![0.0; if structure == armax() { 5 } else { 4 }], noise_variance: 1e-6 },
        ] {
            let mut recursive = Recursive::new(structure.clone(), adaptation.clone()).unwrap();
            recursive.run(&data).unwrap();
            let model = recursive.model(0.1).unwrap();
            let e = &model.equations()[0];
            let poles = if e.f[0].is_empty() { &e.a[0] } else { &e.f[0] };
            let found = [poles[0], poles[1], e.b[0][0], e.b[0][1]];
            for (found, truth) in found.iter().zip([-1.5, 0.7, 1.0, 0.5]) {
                assert!((found - truth).abs() < 1e-6, "{structure:?} {adaptation:?}: {found} {truth}");
            }
        }
    }
}

/// Of the final parameters over many runs: the mean normalised square of the errors, the largest error, how often each
/// lies in its 95 % interval, and the mean of its standardised errors.
fn consistency(
    runs: u64,
    structure: &RecursiveStructure,
    forgetting: f64,
    truth: &[f64],
    make: impl Fn(u64) -> Dataset,
) -> (f64, f64, Vec<f64>, Vec<f64>) {
    let (mut squares, mut worst) = (0.0, 0.0_f64);
    let (mut inside, mut mean) = (vec![0.0; truth.len()], vec![0.0; truth.len()]);
    for seed in 0..runs {
        let mut recursive = Recursive::new(structure.clone(), Adaptation::Forgetting(forgetting)).unwrap();
        recursive.run(&make(seed)).unwrap();
        let covariance = recursive.covariance().unwrap();
        for (j, (found, truth)) in recursive.parameters().iter().zip(truth).enumerate() {
            let standardised = (found - truth) / covariance[(j, j)].sqrt();
            squares += standardised.powi(2);
            inside[j] += f64::from(u8::from(standardised.abs() < 1.96)) / runs as f64;
            mean[j] += standardised / runs as f64;
            worst = worst.max((found - truth).abs());
        }
    }
    (squares / (runs as f64 * truth.len() as f64), worst, inside, mean)
}

#[test]
fn stat_errors_are_as_large_as_the_covariance_says() {
    let (arx_ratio, ..) = consistency(30, &arx(), 1.0, &[-1.5, 0.7, 1.0, 0.5], |s| simulate(s, 2000, 0.0, 0.5, false));
    assert!((arx_ratio - 1.0).abs() < 0.4, "{arx_ratio}");
    let truth = [-1.5, 0.7, 1.0, 0.5, 0.6];
    let (armax_ratio, worst, ..) = consistency(30, &armax(), 1.0, &truth, |s| simulate(100 + s, 4000, 0.6, 0.5, false));
    assert!((armax_ratio - 1.0).abs() < 0.4 && worst < 0.1, "{armax_ratio} {worst}");
    let truth = [1.0, 0.5, -1.5, 0.7];
    let (oe_ratio, worst, ..) =
        consistency(30, &output_error(), 1.0, &truth, |s| simulate(200 + s, 4000, 0.0, 2.0, true));
    assert!((oe_ratio - 1.0).abs() < 0.4 && worst < 0.2, "{oe_ratio} {worst}");
}

/// Three standard deviations of the binomial: 3 √(0.95 · 0.05 / 200); the mean of standardised errors has the deviation
/// 0.07.
fn judge(structure: &RecursiveStructure, truth: &[f64], make: impl Fn(u64) -> Dataset) {
    let (_, _, inside, mean) = consistency(200, structure, 1.0, truth, make);
    assert!(inside.iter().all(|c| (c - 0.95).abs() < 0.047), "{inside:?} {mean:?}");
    assert!(mean.iter().all(|m| m.abs() < 0.3), "{inside:?} {mean:?}");
}

/// In steady state the covariance with forgetting is `1/(1 + λ)` of what `σ² P` would be: intervals of σ² P would hold
/// the truth in 99.4 % of the draws.
#[test]
fn stat_intervals_with_forgetting_hold_the_truth_in_steady_state() {
    for (forgetting, rows) in [(0.98, 400), (0.99, 800)] {
        let make = |s| simulate(7000 + s, rows, 0.0, 0.5, false);
        let (ratio, _, inside, _) = consistency(1000, &arx(), forgetting, &[-1.5, 0.7, 1.0, 0.5], make);
        assert!(inside.iter().all(|c| (0.925..=0.975).contains(c)), "{forgetting}: {inside:?} {ratio}");
    }
}

#[test]
#[ignore = "slow"]
fn stat_intervals_with_forgetting_hold_the_truth_for_other_structures() {
    let truth = [-1.5, 0.7, 1.0, 0.5, 0.6];
    let armax_inside = consistency(1000, &armax(), 0.998, &truth, |s| simulate(8000 + s, 6000, 0.6, 0.5, false)).2;
    assert!(armax_inside.iter().all(|c| (0.925..=0.975).contains(c)), "{armax_inside:?}");
    let truth = [1.0, 0.5, -1.5, 0.7];
    let make = |s| simulate(9000 + s, 6000, 0.0, 1.0, true);
    let output_error_inside = consistency(1000, &output_error(), 0.998, &truth, make).2;
    assert!(output_error_inside.iter().all(|c| (0.925..=0.975).contains(c)), "{output_error_inside:?}");
}

#[test]
#[ignore = "slow"]
fn stat_recursive_least_squares_cover_the_truth() {
    judge(&arx(), &[-1.5, 0.7, 1.0, 0.5], |s| simulate(1000 + s, 2000, 0.0, 0.5, false));
}

#[test]
#[ignore = "slow"]
fn stat_recursive_maximum_likelihood_covers_the_truth() {
    judge(&armax(), &[-1.5, 0.7, 1.0, 0.5, 0.6], |s| simulate(2000 + s, 4000, 0.6, 0.5, false));
}

#[test]
#[ignore = "slow"]
fn stat_recursive_output_error_covers_the_truth() {
    judge(&output_error(), &[1.0, 0.5, -1.5, 0.7], |s| simulate(3000 + s, 4000, 0.0, 2.0, true));
}

/// A small gain comes near the truth, slowly where others of the signals that share it are larger; it knows nothing of
/// how certain it is.
#[test]
fn stat_normalised_gradients_lead_to_the_truth() {
    for (structure, data, truth) in [
        (armax(), simulate(8, 40_000, 0.6, 0.1, false), vec![-1.5, 0.7, 1.0, 0.5, 0.6]),
        (output_error(), simulate(9, 40_000, 0.0, 0.1, true), vec![1.0, 0.5, -1.5, 0.7]),
    ] {
        let mut recursive = Recursive::new(structure.clone(), Adaptation::NormalisedGradient(0.02)).unwrap();
        let trajectory = recursive.run(&data).unwrap();
        for (j, (found, truth)) in recursive.parameters().iter().zip(&truth).enumerate() {
            // C is driven by errors a thirtieth as large as the output.
            let tolerance = if j == 4 { 0.1 } else { 0.05 };
            assert!((found - truth).abs() < tolerance, "{structure:?} {j}: {found} {truth}");
        }
        assert!(recursive.covariance().is_none() && trajectory.standard_errors[(39_999, 0)].is_nan());
    }
}

#[test]
fn stat_least_squares_is_biased_by_output_noise_and_the_output_error_model_is_not() {
    let data = simulate(3, 8000, 0.0, 2.0, true);
    let last = |structure| {
        let mut recursive = Recursive::new(structure, Adaptation::Forgetting(1.0)).unwrap();
        recursive.run(&data).unwrap();
        recursive.parameters().to_vec()
    };
    assert!((last(arx())[0] + 1.5).abs() > 0.2);
    assert!((last(output_error())[2] + 1.5).abs() < 0.03);
}

#[test]
fn stat_changing_parameters_are_followed() {
    let mut noise = Noise::new(4);
    let rows = 3000;
    let u = noise.normals(rows);
    let gain = |t: usize| if t < 1500 { 1.0 } else { 2.0 };
    let mut y = vec![0.0; rows];
    (1..rows).for_each(|t| y[t] = 0.5 * y[t - 1] + gain(t) * u[t - 1] + 0.1 * noise.normal());
    let data = Dataset::siso(1.0, &u, &y).unwrap();
    let structure = RecursiveStructure::Arx { na: 1, nb: vec![1], nk: vec![1] };
    for adaptation in [
        Adaptation::Forgetting(0.97),
        Adaptation::RandomWalk { drift: vec![0.0, 0.03], noise_variance: 0.01 },
        Adaptation::NormalisedGradient(0.05),
    ] {
        let trajectory = Recursive::new(structure.clone(), adaptation.clone()).unwrap().run(&data).unwrap();
        for (t, truth) in [(1499, 1.0), (1800, 2.0), (2999, 2.0)] {
            assert!((trajectory.parameters[(t, 1)] - truth).abs() < 0.12, "{adaptation:?} at {t}");
        }
        assert_eq!(trajectory.names, ["a1", "b1"]);
        let known = trajectory.standard_errors[(2999, 1)];
        assert!(if matches!(adaptation, Adaptation::NormalisedGradient(_)) { known.is_nan() } else { known < 0.1 });
    }
}

#[test]
fn exact_missing_samples_teach_nothing_and_do_no_harm() {
    let whole = simulate(5, 600, 0.0, 0.0, false);
    let e = &whole.experiments()[0];
    let (mut u, mut y) = (e.input(0).to_vec(), e.output(0).to_vec());
    (u[300], y[200]) = (f64::NAN, f64::NAN);
    let data = Dataset::siso(0.1, &u, &y).unwrap();
    let mut recursive = Recursive::new(arx(), Adaptation::Forgetting(1.0)).unwrap();
    let trajectory = recursive.run(&data).unwrap();
    assert!((recursive.parameters()[0] + 1.5).abs() < 1e-9);
    assert!(trajectory.updates[300].prediction.is_nan() && trajectory.updates[302].prediction.is_nan());
    assert!(trajectory.updates[303].error.abs() < 1e-9 && trajectory.updates[200].error.is_nan());
    assert!(trajectory.updates[200].prediction.is_finite());
}

#[test]
fn regress_a_signal_that_falls_silent_does_not_blow_up() {
    let active = simulate(6, 300, 0.0, 0.1, false);
    let mut recursive = Recursive::new(arx(), Adaptation::Forgetting(0.9)).unwrap();
    recursive.run(&active).unwrap();
    let before = recursive.parameters().to_vec();
    for _ in 0..100_000 {
        recursive.step(&[0.0], 0.0).unwrap();
    }
    assert!(recursive.parameters().iter().zip(&before).all(|(a, b)| (a - b).abs() < 0.5));
    assert!(recursive.covariance().unwrap()[(0, 0)].is_finite());
    recursive.run(&active).unwrap();
    assert!((recursive.parameters()[0] + 1.5).abs() < 0.1);
    // A constant never determines more than one parameter: nothing starts, nothing breaks.
    let mut constant = Recursive::new(arx(), Adaptation::Forgetting(1.0)).unwrap();
    constant.run(&Dataset::siso(0.1, &[1.0; 100], &[2.0; 100]).unwrap()).unwrap();
    assert_eq!((constant.parameters(), constant.covariance()), (&[0.0; 4][..], None));
}

#[test]
fn regress_impossible_requests_are_named() {
    let twos = |nk: Vec<usize>| RecursiveStructure::Arx { na: 1, nb: vec![1], nk };
    assert!(matches!(Recursive::new(twos(vec![]), Adaptation::Forgetting(1.0)), Err(IdentError::Structure { .. })));
    assert!(matches!(Recursive::new(twos(vec![1]), Adaptation::Forgetting(1.1)), Err(IdentError::Signal(_))));
    let walk = Adaptation::RandomWalk { drift: vec![0.1], noise_variance: 1.0 };
    assert!(matches!(Recursive::new(twos(vec![1]), walk), Err(IdentError::Length { .. })));
    let mut recursive = Recursive::new(twos(vec![1]), Adaptation::Forgetting(1.0)).unwrap();
    assert!(matches!(recursive.step(&[], 0.0), Err(IdentError::Length { .. })));
    assert!(matches!(recursive.step(&[0.0], f64::INFINITY), Err(IdentError::NotFinite { .. })));
    let two = Dataset::new(0.1, Mat::zeros(9, 1), Mat::zeros(9, 2)).unwrap();
    assert!(matches!(recursive.run(&two), Err(IdentError::Structure { .. })));
}

#[test]
fn stat_two_inputs_share_their_poles_at_the_start_and_part_later() {
    let mut noise = Noise::new(7);
    let rows = 6000;
    let inputs = Mat::from_fn(rows, 2, |_, _| noise.normal());
    let (mut fast, mut slow) = (0.0, 0.0);
    let y: Vec<f64> = (0..rows)
        .map(|t| {
            let now = fast + slow + 0.1 * noise.normal();
            fast = 0.3 * fast + inputs[(t, 0)];
            slow = 0.9 * slow + 0.5 * inputs[(t, 1)];
            now
        })
        .collect();
    let data = Dataset::new(0.1, inputs, Mat::from_fn(rows, 1, |t, _| y[t])).unwrap();
    let structure = RecursiveStructure::OutputError { nb: vec![1, 1], nf: vec![1, 1], nk: vec![1, 1] };
    let mut recursive = Recursive::new(structure, Adaptation::Forgetting(1.0)).unwrap();
    recursive.run(&data).unwrap();
    for (found, truth) in recursive.parameters().iter().zip([1.0, 0.5, -0.3, -0.9]) {
        assert!((found - truth).abs() < 0.03, "{:?}", recursive.parameters());
    }
}
