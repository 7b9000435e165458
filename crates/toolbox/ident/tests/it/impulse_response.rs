//! Impulse responses.

use faer::Mat;
use ident::{Dataset, IdentError, ImpulseFit, ImpulseResponse, Kernel};

use crate::arx::respond;
use crate::noise::Noise;

const KERNELS: [Kernel; 4] =
    [Kernel::TunedCorrelated, Kernel::DiagonalCorrelated, Kernel::StableSpline, Kernel::Diagonal];
const A: [f64; 2] = [-1.5, 0.7];
const B: [f64; 2] = [1.0, 0.5];

fn truth(taps: usize) -> Vec<f64> {
    let pulse: Vec<f64> = (0..taps).map(|t| f64::from(u8::from(t == 0))).collect();
    respond(&A, &B, 0, &pulse, &vec![0.0; taps])
}

fn data(samples: usize, spread: f64, seed: u64) -> Dataset {
    let mut noise = Noise::new(seed);
    let u = noise.normals(samples);
    let x = respond(&A, &B, 1, &u, &vec![0.0; samples]);
    let y: Vec<f64> = x.iter().map(|x| x + spread * noise.normal()).collect();
    Dataset::siso(0.1, &u, &y).unwrap()
}

fn square_error(fit: &ImpulseFit) -> f64 {
    let g = fit.impulse(0, 0).unwrap().value;
    g.iter().zip(truth(g.len())).map(|(g, t)| (g - t).powi(2)).sum()
}

#[test]
fn exact_finite_responses_without_noise() {
    let mut noise = Noise::new(1);
    let u = noise.normals(200);
    let g = [0.0, 1.0, 2.0, -0.5, 0.25];
    let data = Dataset::siso(0.5, &u, &respond(&[], &g, 3, &u, &[0.0; 200])).unwrap();
    let options = ImpulseResponse::new(5).delay(3);
    let plain = options.clone().unregularised().fit(&data).unwrap();
    let all = KERNELS.map(|kernel| options.clone().kernel(kernel).fit(&data).unwrap());
    for (fit, tolerance) in all.iter().map(|f| (f, 1e-7)).chain([(&plain, 1e-12)]) {
        let found = fit.impulse(0, 0).unwrap();
        assert!(found.value.iter().zip(g).all(|(v, t)| (v - t).abs() < tolerance), "{found:?}");
        assert_eq!(found.time_s[0], 1.5);
        let step = fit.step(0, 0).unwrap();
        assert!((step.value[4] - 2.75).abs() < 10.0 * tolerance);
    }
}

#[test]
fn exact_least_squares_is_arx_without_a() {
    let data = data(300, 0.5, 2);
    let response = ImpulseResponse::new(20).delay(1).unregularised().fit(&data).unwrap();
    let arx = ident::Arx::new(0, 20, 1).fit(&data).unwrap();
    let difference = &response.fit.covariance - &arx.covariance;
    assert!(difference.norm_max() < 1e-12 * arx.covariance.norm_max());
    assert!(response.fit.parameters().iter().zip(arx.parameters()).all(|(r, a)| (r - a).abs() < 1e-12));
    assert!((response.fit.loss / arx.loss - 1.0).abs() < 1e-12);
}

/// The covariance of a kernel of scale one, by its definition.
fn unit_prior(kernel: Kernel, taps: usize, decay: f64, correlation: f64) -> Mat<f64> {
    Mat::from_fn(taps, taps, |i, j| {
        let (i, j) = (i as f64 + 1.0, j as f64 + 1.0);
        let (l, m) = (decay, i.max(j));
        match kernel {
            Kernel::TunedCorrelated => l.powf(m),
            Kernel::DiagonalCorrelated => l.powf((i + j) / 2.0) * correlation.powf((i - j).abs()),
            Kernel::StableSpline => l.powf(i + j + m) / 2.0 - l.powf(3.0 * m) / 6.0,
            Kernel::Diagonal if i == j => l.powf(i),
            Kernel::Diagonal => 0.0,
        }
    })
}

/// Regressors and target of a response that begins after one sample.
fn regression(data: &Dataset, taps: usize) -> (Mat<f64>, Mat<f64>) {
    let (u, y) = (data.experiments()[0].input(0), data.experiments()[0].output(0));
    let rows = y.len() - taps;
    (Mat::from_fn(rows, taps, |t, l| u[t + taps - 1 - l]), Mat::from_fn(rows, 1, |t, _| y[t + taps]))
}

/// Minus twice the logarithm of the marginal likelihood, up to a constant, where `c` is so many noise variances and
/// that variance makes the data most likely: `N ln yᵀ S⁻¹ y + ln det S`, `S = I + c Φ K Φᵀ`.
fn unlikelihood(spread: &Mat<f64>, target: &Mat<f64>, ratio: f64) -> f64 {
    use faer::linalg::solvers::Solve;
    let rows = target.nrows();
    let factor = (faer::Scale(ratio) * spread + Mat::<f64>::identity(rows, rows)).llt(faer::Side::Lower).unwrap();
    let squares = (target.transpose() * factor.solve(target))[(0, 0)];
    rows as f64 * squares.ln() + 2.0 * (0..rows).map(|i| factor.L()[(i, i)].ln()).sum::<f64>()
}

/// The hyperparameters found make the data most likely: no slope is left, and no point of a grid is better.
#[test]
fn exact_hyperparameters_maximise_the_marginal_likelihood() {
    let (taps, data) = (20, data(80, 0.5, 3));
    let (phi, target) = regression(&data, taps);
    for kernel in KERNELS {
        let h = ImpulseResponse::new(taps).delay(1).kernel(kernel).fit(&data).unwrap().hyperparameters[0][0];
        let logistic = |p: f64| 1.0 / (1.0 + (-p).exp());
        let at = |p: &[f64; 3]| {
            let prior = unit_prior(kernel, taps, logistic(p[1]), p[2].tanh());
            unlikelihood(&(&phi * prior * phi.transpose()), &target, p[0].exp())
        };
        // c in noise variances, the variance that which makes the data most likely.
        let shape = [(h.decay / (1.0 - h.decay)).ln(), h.correlation.atanh()];
        let ratio = scale_in_variances(&phi, &target, &unit_prior(kernel, taps, h.decay, h.correlation), h.scale);
        let found = [ratio.ln(), shape[0], shape[1]];
        let least = at(&found);
        for j in 0..if kernel == Kernel::DiagonalCorrelated { 3 } else { 2 } {
            let moved = |by: f64| {
                let mut p = found;
                p[j] += by;
                at(&p)
            };
            let (above, below) = (moved(1e-3), moved(-1e-3));
            let (slope, bend) = ((above - below) / 2e-3, (above + below - 2.0 * least) / 1e-6);
            // What a step along the slope could still gain of a likelihood whose unit is one.
            assert!(bend > 0.0 && slope * slope / (2.0 * bend) < 1e-3, "{kernel:?} {j}: {slope} {bend}");
        }
        let steps = |from: f64, to: f64, count: i32| {
            (0..=count).map(move |k| from + (to - from) * f64::from(k) / f64::from(count))
        };
        let correlations: Vec<f64> =
            if kernel == Kernel::DiagonalCorrelated { steps(-2.0, 4.0, 6).collect() } else { vec![0.0] };
        for (scale, decay) in steps(-6.0, 24.0, 30).flat_map(|c| steps(-3.0, 5.0, 16).map(move |l| (c, l))) {
            for correlation in &correlations {
                let other = at(&[scale, decay, *correlation]);
                assert!(
                    other > least - 1e-3,
                    "{kernel:?}: {other} at {scale} {decay} {correlation}, {least} at {found:?}"
                );
            }
        }
    }
}

/// `c` over the noise variance that makes the data most likely with it.
fn scale_in_variances(phi: &Mat<f64>, target: &Mat<f64>, unit: &Mat<f64>, scale: f64) -> f64 {
    use faer::linalg::solvers::Solve;
    let (rows, mut variance) = (target.nrows(), 0.25);
    let spread = faer::Scale(scale) * (phi * unit * phi.transpose());
    for _ in 0..200 {
        let whole = &spread + faer::Scale(variance) * Mat::<f64>::identity(rows, rows);
        let solved = whole.llt(faer::Side::Lower).unwrap().solve(target);
        variance *= (target.transpose() * &solved)[(0, 0)] / rows as f64;
    }
    scale / variance
}

#[test]
fn exact_posterior_of_a_kernel_by_its_definition() {
    // θ̂ = P Φᵀ (Φ P Φᵀ + σ² I)⁻¹ y and its covariance, written out for the covariance the fit settled on.
    use faer::linalg::solvers::Solve;
    let (taps, data) = (12, data(80, 0.5, 3));
    for kernel in KERNELS {
        let estimate = ImpulseResponse::new(taps).delay(1).kernel(kernel).fit(&data).unwrap();
        let h = estimate.hyperparameters[0][0];
        let prior = faer::Scale(h.scale) * unit_prior(kernel, taps, h.decay, h.correlation);
        let (phi, target) = regression(&data, taps);
        let rows = phi.nrows();
        let spread = &phi * &prior * phi.transpose();
        // The noise variance follows from the likelihood's own stationarity: σ̂² = yᵀ (Φ P Φᵀ/σ² + I)⁻¹ y / N.
        let (mut variance, mut inverse) = (0.25, Mat::new());
        for _ in 0..200 {
            inverse = (&spread + faer::Scale(variance) * Mat::<f64>::identity(rows, rows))
                .llt(faer::Side::Lower)
                .unwrap()
                .solve(&target);
            variance *= (target.transpose() * &inverse)[(0, 0)] / rows as f64;
        }
        let mean = &prior * phi.transpose() * &inverse;
        let found = estimate.fit.parameters();
        for l in 0..taps {
            assert!((found[l] - mean[(l, 0)]).abs() < 1e-6, "{kernel:?}: {} for {}", found[l], mean[(l, 0)]);
        }
    }
}

#[test]
fn stat_a_prior_beats_least_squares_on_short_noisy_data() {
    let (mut plain, mut with) = (0.0, [0.0; 4]);
    for seed in 0..10 {
        let data = data(120, 2.0, 100 + seed);
        let options = ImpulseResponse::new(40).delay(1);
        plain += square_error(&options.clone().unregularised().fit(&data).unwrap());
        for (sum, kernel) in with.iter_mut().zip(KERNELS) {
            *sum += square_error(&options.clone().kernel(kernel).fit(&data).unwrap());
        }
    }
    assert!(with[..3].iter().all(|e| *e < 0.25 * plain) && with[3] < 0.6 * plain, "{with:?} against {plain}");
}

#[test]
fn stat_bands_hold_the_truth_over_systems_of_the_prior() {
    // Responses drawn from the kernel itself: then the posterior's bands have to hold on average.
    let (runs, taps, mut inside, mut of) = (60, 30, 0_u32, 0_u32);
    let mut noise = Noise::new(77);
    for _ in 0..runs {
        let (mut g, mut sum) = (vec![0.0; taps], 0.0);
        for i in (0..taps).rev() {
            let step = 0.8_f64.powi(i as i32 + 1) * if i + 1 == taps { 1.0 } else { 0.2 };
            sum += step.sqrt() * noise.normal();
            g[i] = sum;
        }
        let u = noise.normals(200);
        let e: Vec<f64> = noise.normals(200).iter().map(|v| 0.3 * v).collect();
        let data = Dataset::siso(1.0, &u, &respond(&[], &g, 0, &u, &e)).unwrap();
        let found = ImpulseResponse::new(taps).fit(&data).unwrap().impulse(0, 0).unwrap();
        for ((v, t), s) in found.value.iter().zip(&g).zip(&found.standard_error) {
            inside += u32::from((v - t).abs() < 1.96 * s);
            of += 1;
        }
    }
    let share = f64::from(inside) / f64::from(of);
    assert!((share - 0.95).abs() < 0.03, "coverage {share}");
}

#[test]
fn stat_prewhitening_gives_sharper_responses_with_honest_errors() {
    let (taps, runs) = (10, 200);
    let g = truth(taps);
    let (mut plain, mut white, mut inside) = (0.0, 0.0, 0_u32);
    for seed in 0..runs {
        let mut noise = Noise::new(600 + seed);
        let slow = |x: &[f64]| respond(&[-0.95], &[1.0], 0, x, &vec![0.0; x.len()]);
        let u = slow(&noise.normals(600));
        let e = slow(&noise.normals(600));
        let data = Dataset::siso(1.0, &u, &respond(&[], &g, 0, &u, &e)).unwrap();
        let options = ImpulseResponse::new(taps).unregularised();
        plain += square_error(&options.clone().fit(&data).unwrap());
        let fit = options.prewhitening(2).fit(&data).unwrap();
        white += square_error(&fit);
        let step = fit.step(0, 0).unwrap();
        let sum: f64 = g.iter().sum();
        inside += u32::from((step.value[taps - 1] - sum).abs() < 1.97 * step.standard_error[taps - 1]);
    }
    assert!(white < 0.9 * plain, "{white} against {plain}");
    let share = f64::from(inside) / runs as f64;
    assert!((share - 0.95).abs() < 3.5 * (0.95 * 0.05 / runs as f64).sqrt(), "coverage of the gain {share}");
}

#[test]
fn stat_several_channels_of_very_different_scales() {
    let mut noise = Noise::new(5);
    let u = Mat::from_fn(400, 2, |_, k| noise.normal() * [1e-6, 1e6][k]);
    let part = |k: usize, a: f64, gain: f64| {
        let column: Vec<f64> = (0..400).map(|t| u[(t, k)]).collect();
        respond(&[-a], &[gain], 1, &column, &[0.0; 400])
    };
    let (first, second) = (part(0, 0.8, 1e6), part(1, 0.5, 2e-6));
    let y = Mat::from_fn(400, 2, |t, i| [1.0, 1e9][i] * (first[t] + second[t] + 0.1 * noise.normal()));
    let fit = ImpulseResponse::new(30).delay(1).fit(&Dataset::new(1.0, u, y).unwrap()).unwrap();
    for (output, scale) in [(0, 1.0), (1, 1e9)] {
        for (input, a, gain) in [(0, 0.8_f64, 1e6), (1, 0.5, 2e-6)] {
            let g = fit.impulse(output, input).unwrap();
            for (l, value) in g.value.iter().enumerate() {
                assert!((value / (scale * gain) - a.powi(l as i32)).abs() < 0.04, "{output} {input} {l}");
            }
        }
    }
    assert!(fit.impulse(2, 0).is_err() && fit.step(0, 2).is_err());
}

#[test]
fn stat_more_taps_than_samples() {
    let fit = ImpulseResponse::new(60).delay(1).fit(&data(100, 0.1, 6)).unwrap();
    assert!(fit.fit.samples == 40 && square_error(&fit) < 1.0);
}

#[test]
fn regress_bad_data_are_named() {
    let data = data(100, 0.1, 7);
    let u = data.experiments()[0].input(0);
    assert!(matches!(ImpulseResponse::new(0).fit(&data), Err(IdentError::Structure { .. })));
    assert!(matches!(ImpulseResponse::new(100).fit(&data), Err(IdentError::TooFewSamples { .. })));
    assert!(matches!(ImpulseResponse::new(60).unregularised().fit(&data), Err(IdentError::TooFewSamples { .. })));
    let still = Dataset::siso(1.0, u, &[0.0; 100]).unwrap();
    assert!(matches!(ImpulseResponse::new(10).fit(&still), Err(IdentError::Constant { .. })));
    let undriven = Dataset::siso(1.0, &[0.0; 100], u).unwrap();
    assert!(matches!(ImpulseResponse::new(10).fit(&undriven), Err(IdentError::Constant { .. })));
    let constant = Dataset::siso(1.0, &[1.0; 100], u).unwrap();
    let plain = ImpulseResponse::new(10).unregularised();
    assert!(matches!(plain.fit(&constant), Err(IdentError::RankDeficient { .. })));
    assert!(ImpulseResponse::new(10).fit(&constant).unwrap().fit.parameters().iter().all(|v| v.is_finite()));
}
