//! ARX models.

use faer::Mat;
use ident::{Arx, ArxOrders, Dataset, Doubt, Experiment, IdentError};
use proptest::prelude::*;

use crate::noise::Noise;
use testdata::shared;

/// `y(t) = Σ (−a) y + Σ b u + e` from rest, with the given delay.
pub(crate) fn respond(a: &[f64], b: &[f64], nk: usize, u: &[f64], e: &[f64]) -> Vec<f64> {
    let mut y: Vec<f64> = Vec::with_capacity(u.len());
    for t in 0..u.len() {
        let past = |x: &[f64], lag: usize| t.checked_sub(lag).map_or(0.0, |i| x[i]);
        let from_y: f64 = a.iter().enumerate().map(|(l, a)| -a * past(&y, l + 1)).sum();
        let from_u: f64 = b.iter().enumerate().map(|(l, b)| b * past(u, nk + l)).sum();
        y.push(from_y + from_u + e[t]);
    }
    y
}

/// Two comma-separated columns below a heading, of a file in the shared folder; says so where it is absent.
#[allow(clippy::disallowed_methods)]
pub(crate) fn two_columns(path: &str) -> Option<(Vec<f64>, Vec<f64>)> {
    let text = std::fs::read_to_string(shared(path)?).unwrap();
    let row = |line: &str| {
        let (u, y) = line.split_once(',').unwrap();
        (u.trim().parse::<f64>().unwrap(), y.trim().parse::<f64>().unwrap())
    };
    Some(text.lines().skip(1).map(row).unzip())
}

fn centred(x: &[f64]) -> Vec<f64> {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|v| v - mean).collect()
}

fn close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance * e.abs().max(1.0), "{found:?} for {expected:?}");
    }
}

#[test]
fn exact_orders_and_delays_are_recovered_from_any_initial_state() {
    let mut noise = Noise::new(1);
    let u = noise.normals(300);
    for nk in [0, 1, 4] {
        let y = respond(&[-1.5, 0.7], &[1.0, 0.5, -0.2], nk, &u, &[0.0; 300]);
        // Cut into the motion: what went before is not known.
        let data = Dataset::siso(0.1, &u[50..], &y[50..]).unwrap();
        let fit = Arx::new(2, 3, nk).fit(&data).unwrap();
        close(&fit.parameters(), &[-1.5, 0.7, 1.0, 0.5, -0.2], 1e-11);
        assert_eq!(fit.samples, 250 - (nk + 2).max(2));
        assert!(fit.loss < 1e-25 && fit.doubts.is_empty());
    }
}

#[test]
fn exact_missing_samples_and_several_experiments() {
    let mut noise = Noise::new(2);
    let u = noise.normals(200);
    let mut y = respond(&[-0.8], &[2.0], 1, &u, &[0.0; 200]);
    let (first, second) = (y[..100].to_vec(), y.split_off(100));
    let mut holed = first.clone();
    holed[40] = f64::NAN;
    let mut u_holed = u[..100].to_vec();
    u_holed[70] = f64::NAN;
    let column = |x: &[f64]| Mat::from_fn(x.len(), 1, |i, _| x[i]);
    let data = Dataset::siso(0.1, &u_holed, &holed).unwrap();
    let further = Experiment { name: "2".into(), start_s: 0.0, inputs: column(&u[100..]), outputs: column(&second) };
    let fit = Arx::new(1, 1, 1).fit(&data.with_experiment(further).unwrap()).unwrap();
    close(&fit.parameters(), &[-0.8, 2.0], 1e-12);
    // y(40) stands in two rows, u(70) in one.
    assert_eq!(fit.samples, 2 * 99 - 3);
    assert_eq!(fit.doubts, vec![Doubt::RowsLeftOut { rows: 3, of: 198 }]);
}

/// Two outputs coupled through A, two inputs with orders and delays of their own.
fn coupled(samples: usize, spread: f64, seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = Mat::from_fn(samples, 2, |_, _| noise.normal());
    let mut y = Mat::<f64>::zeros(samples, 2);
    for t in 0..samples {
        let yy = |y: &Mat<f64>, lag: usize, j: usize| if t >= lag { y[(t - lag, j)] } else { 0.0 };
        let uu = |lag: usize, j: usize| if t >= lag { u[(t - lag, j)] } else { 0.0 };
        let shared = spread * noise.normal();
        let e = [shared, 0.8 * shared + 0.6 * spread * noise.normal()];
        let first = 1.2 * yy(&y, 1, 0) - 0.5 * yy(&y, 2, 0) - 0.3 * yy(&y, 1, 1) + uu(1, 0) + 0.4 * uu(2, 0);
        let second = 0.7 * yy(&y, 1, 1) + 0.5 * uu(0, 0) - 1.5 * uu(3, 1);
        y[(t, 0)] = first + e[0];
        y[(t, 1)] = second + e[1];
    }
    Dataset::new(0.5, u, y).unwrap()
}

fn coupled_orders() -> ArxOrders {
    ArxOrders { na: vec![vec![2, 1], vec![0, 1]], nb: vec![vec![2, 0], vec![1, 1]], nk: vec![vec![1, 0], vec![0, 3]] }
}

const COUPLED: [f64; 8] = [-1.2, 0.5, 0.3, 1.0, 0.4, -0.7, 0.5, -1.5];

#[test]
fn exact_several_inputs_and_coupled_outputs() {
    let fit = Arx::with_orders(coupled_orders()).fit(&coupled(200, 0.0, 3)).unwrap();
    close(&fit.parameters(), &COUPLED, 1e-11);
    assert_eq!(fit.model.coefficient_names()[2], "a1[1,2]");
}

#[test]
fn exact_badly_scaled_channels() {
    let mut noise = Noise::new(4);
    let u: Vec<f64> = noise.normals(400).iter().map(|v| 1e9 * v).collect();
    let y: Vec<f64> = respond(&[-1.5, 0.7], &[1e-18, 0.5e-18], 1, &u, &[0.0; 400]);
    let fit = Arx::new(2, 2, 1).fit(&Dataset::siso(0.1, &u, &y).unwrap()).unwrap();
    let theta = fit.parameters();
    for (found, expected) in theta.iter().zip([-1.5, 0.7, 1e-18, 0.5e-18]) {
        assert!((found / expected - 1.0).abs() < 1e-11, "{theta:?}");
    }
    assert!(fit.condition < 100.0);
}

#[test]
fn exact_poles_near_the_unit_circle() {
    // Poles at 0.99999 ± a small angle: a slow, barely damped mode, sampled fast.
    let (radius, angle) = (0.99999_f64, 1e-3_f64);
    let a = [-2.0 * radius * angle.cos(), radius * radius];
    let u = Noise::new(5).normals(20_000);
    let y = respond(&a, &[1e-6, 1e-6], 1, &u, &vec![0.0; u.len()]);
    let fit = Arx::new(2, 2, 1).fit(&Dataset::siso(1e-3, &u, &y).unwrap()).unwrap();
    close(&fit.parameters()[..2], &a, 1e-10);
    assert!(fit.condition > 1e2);
}

#[test]
fn exact_inputs_that_are_nearly_the_same() {
    let mut noise = Noise::new(12);
    let u = Mat::from_fn(2000, 2, |_, _| noise.normal());
    let pair = |gap: f64| Mat::from_fn(2000, 2, |t, k| u[(t, 0)] + if k == 1 { gap * u[(t, 1)] } else { 0.0 });
    let fit = |gap: f64| {
        let u = pair(gap);
        let mut y = Mat::<f64>::zeros(2000, 1);
        (1..2000).for_each(|t| y[(t, 0)] = 0.5 * y[(t - 1, 0)] + u[(t, 0)] - 2.0 * u[(t, 1)]);
        Arx::with_orders(ArxOrders::miso(1, &[1, 1], &[0, 0])).fit(&Dataset::new(1.0, u, y).unwrap())
    };
    let near = fit(1e-9).unwrap();
    close(&near.parameters(), &[-0.5, 1.0, -2.0], 1e-5);
    assert!(near.doubts.iter().any(|doubt| matches!(doubt, Doubt::IllConditioned { condition } if *condition > 5e8)));
    // What lies below the digits of a file may be its rounding.
    let is_dependent =
        |fit: &ident::Fit<_>| fit.doubts.iter().any(|doubt| matches!(doubt, Doubt::DependentInputs { .. }));
    assert!(is_dependent(&near) && !is_dependent(&fit(1e-3).unwrap()));
    assert!(matches!(fit(0.0), Err(IdentError::RankDeficient { rank: 2, parameters: 3, .. })));
}

#[test]
fn regress_sizes_at_the_ends_of_the_range_do_not_panic() {
    let mut noise = Noise::new(13);
    let (u, e) = (noise.normals(100), noise.normals(100));
    let y = respond(&[-0.5], &[1.0], 1, &u, &e);
    for (from_u, from_y) in [(1e150, 1e-150), (1e200, 1e200), (1e-200, 1e-200), (1e300, 1.0), (1e-310, 1e308)] {
        let scaled = |x: &[f64], by: f64| x.iter().map(|v| (v * by).clamp(-1e308, 1e308)).collect::<Vec<f64>>();
        let data = Dataset::siso(1.0, &scaled(&u, from_u), &scaled(&y, from_y)).unwrap();
        if let Ok(fit) = Arx::new(1, 1, 1).fit(&data) {
            assert!((fit.parameters()[0] + 0.5).abs() < 0.5, "{from_u:e} {from_y:e} {:?}", fit.parameters());
        }
        let _ = ident::OrderScan::new(1..=2, 1..=2, 1..=1).run(&data);
        let _ = ident::Iv4::new(1, 1, 1).fit(&data);
        let _ = ident::ImpulseResponse::new(5).fit(&data);
        let _ = ident::ImpulseResponse::new(5).unregularised().fit(&data);
    }
}

#[test]
fn ref_hair_dryer() {
    let Some((u, y)) = two_columns("reference/peers/dryer_slicot.csv") else {
        return;
    };
    let data = Dataset::siso(0.08, &centred(&u[..300]), &centred(&y[..300])).unwrap();
    let fit = Arx::new(2, 2, 3).fit(&data).unwrap();
    close(&fit.parameters(), &[-1.27374, 0.39355, 0.06662, 0.04448], 6e-6);
    // The errors by numpy.linalg.lstsq on the same rows.
    close(&fit.standard_errors(), &[0.02090649, 0.01909563, 0.0021378, 0.00331701], 1e-8);
}

#[test]
fn ref_same_numbers_as_numpy() {
    let Some((u, y)) = two_columns("reference/peers/r_arxsim.csv") else {
        return;
    };
    let fit = Arx::new(1, 2, 2).fit(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
    // numpy.linalg.lstsq on the same rows.
    close(&fit.parameters(), &[-0.5260029, 0.58811164, -0.22563208], 1e-8);
    close(&fit.standard_errors(), &[0.01633978, 0.00637176, 0.01146325], 1e-8);
}

/// Share of runs in which the intervals of 95 % hold each true parameter.
pub(crate) fn coverage(runs: u64, truth: &[f64], fit: impl Fn(u64) -> ident::Fit<lti::PolynomialModel>) -> Vec<f64> {
    let mut covered = vec![0_u32; truth.len()];
    for seed in 0..runs {
        for ((low, high), (count, truth)) in fit(seed).intervals(0.95).iter().zip(covered.iter_mut().zip(truth)) {
            *count += u32::from(low < truth && truth < high);
        }
    }
    covered.iter().map(|c| f64::from(*c) / runs as f64).collect()
}

pub(crate) fn assert_covers(shares: &[f64], runs: u64) {
    let bound = 3.5 * (0.95 * 0.05 / runs as f64).sqrt();
    assert!(shares.iter().all(|s| (s - 0.95).abs() < bound), "coverage {shares:?}");
}

#[test]
fn stat_white_noise_unbiased_and_covered() {
    let truth = [-1.5, 0.7, 1.0, 0.5];
    let (runs, mut mean) = (600, [0.0; 4]);
    let data = |seed| {
        let mut noise = Noise::new(100 + seed);
        let (u, e) = (noise.normals(600), noise.normals(600));
        Dataset::siso(1.0, &u, &respond(&truth[..2], &truth[2..], 1, &u, &e)).unwrap()
    };
    assert_covers(&coverage(runs, &truth, |seed| Arx::new(2, 2, 1).fit(&data(seed)).unwrap()), runs);
    for seed in 0..runs {
        let fit = Arx::new(2, 2, 1).fit(&data(seed)).unwrap();
        fit.parameters().iter().zip(&mut mean).for_each(|(v, m)| *m += v / runs as f64);
    }
    let errors = Arx::new(2, 2, 1).fit(&data(0)).unwrap().standard_errors();
    for ((m, t), e) in mean.iter().zip(truth).zip(errors) {
        // Four standard errors of the mean, and the known bias of order 1/N.
        assert!((m - t).abs() < 4.0 * e / (runs as f64).sqrt() + 3.0 / 600.0, "{mean:?}");
    }
}

#[test]
fn stat_coupled_outputs_are_covered_and_their_noise_found() {
    let fit = |seed| Arx::with_orders(coupled_orders()).fit(&coupled(400, 0.5, 1000 + seed)).unwrap();
    assert_covers(&coverage(600, &COUPLED, fit), 600);
    let noise = Arx::with_orders(coupled_orders()).fit(&coupled(50_000, 0.5, 7)).unwrap().noise_covariance;
    for ((i, j), expected) in [((0, 0), 0.25), ((0, 1), 0.2), ((1, 0), 0.2), ((1, 1), 0.25)] {
        assert!((noise[(i, j)] - expected).abs() < 0.006, "{noise:?}");
    }
}

#[test]
fn stat_parameters_of_different_equations_vary_together_as_stated() {
    let orders = coupled_orders();
    let (runs, pair) = (800, (3, 6));
    let (mut sum, mut stated) = (0.0, 0.0);
    for seed in 0..runs {
        let fit = Arx::with_orders(orders.clone()).fit(&coupled(300, 0.5, 5000 + seed)).unwrap();
        let theta = fit.parameters();
        sum += (theta[pair.0] - COUPLED[pair.0]) * (theta[pair.1] - COUPLED[pair.1]) / runs as f64;
        stated += fit.covariance[pair] / runs as f64;
    }
    let spread = 0.25 / 300.0;
    assert!((sum - stated).abs() < 4.0 * spread / (runs as f64).sqrt(), "{sum:.3e} for {stated:.3e}");
}

#[test]
fn stat_robust_intervals_hold_under_coloured_noise_where_others_fail() {
    // A gain: consistent whatever the noise, which here is slow, as is the input.
    let truth = [1.0];
    let data = |seed| {
        let mut noise = Noise::new(20_000 + seed);
        let slow = |x: &[f64]| respond(&[-0.9], &[1.0], 0, x, &vec![0.0; x.len()]);
        let u = slow(&noise.normals(4000));
        let e = slow(&noise.normals(4000));
        Dataset::siso(1.0, &u, &respond(&[], &truth, 0, &u, &e)).unwrap()
    };
    let runs = 400;
    let robust = coverage(runs, &truth, |seed| Arx::new(0, 1, 0).robust(20).fit(&data(seed)).unwrap());
    let bound = 3.5 * (0.95 * 0.05 / runs as f64).sqrt();
    assert!(robust.iter().all(|s| (s - 0.95).abs() < bound), "robust coverage {robust:?}");
    let plain = coverage(runs, &truth, |seed| Arx::new(0, 1, 0).fit(&data(seed)).unwrap());
    assert!(plain.iter().all(|s| *s < 0.9), "coverage {plain:?} under the assumption of white noise");
}

#[test]
fn stat_autoregression() {
    let e = Noise::new(8).normals(20_000);
    let y = respond(&[-1.2, 0.6], &[], 0, &e, &e);
    let data = Dataset::new(1.0, Mat::new(), Mat::from_fn(y.len(), 1, |i, _| y[i])).unwrap();
    let fit = Arx::autoregression(2).fit(&data).unwrap();
    for ((v, t), e) in fit.parameters().iter().zip([-1.2, 0.6]).zip(fit.standard_errors()) {
        assert!((v - t).abs() < 4.0 * e);
    }
    assert!((fit.noise_covariance[(0, 0)] - 1.0).abs() < 0.04);
}

#[test]
fn stat_million_samples() {
    let n = 1_000_000;
    let mut noise = Noise::new(9);
    let (u, e) = (noise.normals(n), noise.normals(n));
    let data = Dataset::siso(1.0, &u, &respond(&[-1.5, 0.7], &[1.0, 0.5], 1, &u, &e)).unwrap();
    let fit = Arx::new(2, 2, 1).fit(&data).unwrap();
    for ((v, t), e) in fit.parameters().iter().zip([-1.5, 0.7, 1.0, 0.5]).zip(fit.standard_errors()) {
        assert!((v - t).abs() < 4.0 * e && e < 2e-3);
    }
}

#[test]
fn regress_bad_data_are_named() {
    let u = Noise::new(10).normals(100);
    let y = respond(&[-0.5], &[1.0], 1, &u, &[0.0; 100]);
    let data = Dataset::siso(1.0, &u, &y).unwrap();
    // Free of noise, a common factor can be added at will.
    assert!(matches!(Arx::new(2, 2, 1).fit(&data), Err(IdentError::RankDeficient { rank: 3, parameters: 4, .. })));
    assert!(matches!(Arx::new(0, 0, 1).fit(&data), Err(IdentError::Structure { .. })));
    assert!(matches!(Arx::new(60, 60, 1).fit(&data), Err(IdentError::TooFewSamples { .. })));
    assert!(matches!(Arx::new(usize::MAX, 1, 1).fit(&data), Err(IdentError::TooFewSamples { .. })));
    assert!(matches!(Arx::autoregression(1).fit(&data), Err(IdentError::Length { .. })));
    assert!(matches!(Arx::new(1, 1, 1).robust(1).fit(&data), Err(IdentError::TooFewSamples { .. })));
    let constant = Dataset::siso(1.0, &[0.0; 50], &y[..50]).unwrap();
    assert!(matches!(Arx::new(1, 1, 1).fit(&constant), Err(IdentError::RankDeficient { .. })));
    let missing = Dataset::siso(1.0, &[f64::NAN; 50], &y[..50]).unwrap();
    assert!(matches!(Arx::new(1, 1, 1).fit(&missing), Err(IdentError::TooFewSamples { samples: 0, .. })));
    let empty = Dataset::siso(1.0, &[], &[]).unwrap();
    assert!(matches!(Arx::new(1, 1, 1).fit(&empty), Err(IdentError::TooFewSamples { .. })));
}

#[test]
fn regress_an_unstable_model_is_doubted() {
    let u = Noise::new(11).normals(60);
    let y = respond(&[-1.1], &[1.0], 1, &u, &[0.0; 60]);
    let fit = Arx::new(1, 1, 1).fit(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
    assert!(fit.doubts.contains(&Doubt::Unstable));
}

proptest! {
    #[test]
    fn prop_scaling_a_channel_scales_its_coefficients(seed in 0_u64..1000, power in -12_i32..12) {
        let mut noise = Noise::new(seed);
        let (u, e) = (noise.normals(150), noise.normals(150));
        let y = respond(&[-0.6], &[1.0, 0.3], 1, &u, &e);
        let scale = 10_f64.powi(power);
        let scaled: Vec<f64> = u.iter().map(|v| v * scale).collect();
        let plain = Arx::new(1, 2, 1).fit(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap();
        let other = Arx::new(1, 2, 1).fit(&Dataset::siso(1.0, &scaled, &y).unwrap()).unwrap();
        let (p, o) = (plain.parameters(), other.parameters());
        prop_assert!((p[0] - o[0]).abs() < 1e-10);
        prop_assert!((p[1] - o[1] * scale).abs() < 1e-10);
        prop_assert!((plain.loss / other.loss - 1.0).abs() < 1e-10);
        let (s, t) = (plain.standard_errors(), other.standard_errors());
        prop_assert!((s[2] / (t[2] * scale) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn prop_rows_and_columns_give_the_same_triangle(rows in 1_usize..5000, columns in 1_usize..6, seed in 0_u64..100) {
        let mut noise = Noise::new(seed);
        let table: Vec<Vec<f64>> = (0..columns).map(|_| noise.normals(rows)).collect();
        let (mut by_row, mut by_column) = (ident::Triangle::new(columns), ident::Triangle::new(columns));
        (0..rows).for_each(|i| by_row.push_row(&table.iter().map(|c| c[i]).collect::<Vec<_>>()));
        let cut = rows / 3;
        by_column.push_columns(cut, |j, start, to| to.copy_from_slice(&table[j][start..start + to.len()]));
        let mut rest = ident::Triangle::new(columns);
        rest.push_columns(rows - cut, |j, start, to| to.copy_from_slice(&table[j][cut + start..cut + start + to.len()]));
        by_column.merge(rest);
        prop_assert_eq!(by_row.rows(), by_column.rows());
        let (a, b) = (by_row.finish(), by_column.finish());
        let difference = a.transpose() * &a - b.transpose() * &b;
        prop_assert!(difference.norm_max() < 1e-10 * rows as f64);
    }
}
