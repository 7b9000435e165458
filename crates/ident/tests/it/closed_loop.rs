use faer::{Mat, MatMut};
use ident::closed_loop::{Indirect, JointInputOutput, TwoStage, direct};
use ident::{Bounds, Dataset, Fit, IdentError, NonlinearOptions, ResidualModel, Termination, least_squares, minimise};
use lti::{Complex64, PolynomialEquation, PolynomialModel, TransferFunction};

use crate::noise::Noise;

const REGULATOR: f64 = 0.8;

/// `y = 0.8 y(t−1) + 0.5 u(t−1) + e`, `u = r − 0.8 y`: inputs `u` and `r`.
fn closed_loop(seed: u64, rows: usize, sigma: f64) -> Dataset {
    let mut noise = Noise::new(seed);
    let r = noise.normals(rows);
    let (mut u, mut y) = (vec![0.0; rows], vec![0.0; rows]);
    for t in 0..rows {
        let before = if t > 0 { 0.8 * y[t - 1] + 0.5 * u[t - 1] } else { 0.0 };
        y[t] = before + sigma * noise.normal();
        u[t] = r[t] - REGULATOR * y[t];
    }
    Dataset::new(1.0, Mat::from_fn(rows, 2, |t, k| [u[t], r[t]][k]), Mat::from_fn(rows, 1, |t, _| y[t])).unwrap()
}

fn packed(model: PolynomialModel, covariance: Mat<f64>, variance: f64, samples: usize) -> Fit<PolynomialModel> {
    Fit {
        model: model.with_noise_covariance(Mat::full(1, 1, variance)).unwrap(),
        free_parameters: covariance.nrows(),
        degrees_of_freedom: (samples - covariance.nrows()) as f64,
        covariance,
        noise_covariance: Mat::full(1, 1, variance),
        loss: variance,
        samples,
        initial_states: Vec::new(),
        termination: Termination::Direct,
        iterations: 0,
        condition: 1.0,
        doubts: Vec::new(),
    }
}

/// ARX(1, 1, 1) by least squares: a1, b1.
fn arx(data: &Dataset) -> Result<Fit<PolynomialModel>, IdentError> {
    let e = &data.experiments()[0];
    let (u, y) = (e.input(0), e.output(0));
    let phi = Mat::from_fn(e.len() - 1, 2, |i, j| [-y[i], u[i]][j]);
    let fit = least_squares(phi.as_ref(), &y[1..])?;
    let (a, b) = (vec![vec![fit.parameters[0]]], vec![vec![fit.parameters[1]]]);
    let model = PolynomialModel::siso(1.0, 1, PolynomialEquation { a, b, ..Default::default() })?;
    Ok(packed(model, fit.covariance(), fit.noise_variance(), e.len() - 1))
}

/// `y(t) = b/(1 + f q⁻¹) u(t−1) + e(t)`.
struct FirstOrder<'a>(&'a [f64], &'a [f64]);

impl ResidualModel for FirstOrder<'_> {
    fn parameter_count(&self) -> usize {
        2
    }

    fn residual_count(&self) -> usize {
        self.1.len()
    }

    fn evaluate(&mut self, p: &[f64], out: &mut [f64], mut slopes: Option<MatMut<'_, f64>>) -> Result<(), IdentError> {
        let (mut w, mut to_b, mut to_f) = (0.0, 0.0, 0.0);
        for t in 0..out.len() {
            out[t] = w - self.1[t];
            if let Some(j) = slopes.as_mut() {
                (j[(t, 0)], j[(t, 1)]) = (to_b, to_f);
            }
            (to_b, to_f) = (self.0[t] - p[1] * to_b, -w - p[1] * to_f);
            w = p[0] * self.0[t] - p[1] * w;
        }
        Ok(())
    }
}

/// Output error OE(1, 1, 1): b1, f1.
fn output_error(data: &Dataset) -> Result<Fit<PolynomialModel>, IdentError> {
    let e = &data.experiments()[0];
    let mut model = FirstOrder(e.input(0), e.output(0));
    let bounds = [Bounds::NONE, Bounds::new(-0.999, 0.999)];
    let minimum = minimise(&mut model, &[0.3, -0.5], &bounds, NonlinearOptions::default())?;
    let (b, f) = (vec![vec![minimum.parameters[0]]], vec![vec![minimum.parameters[1]]]);
    let model = PolynomialModel::siso(1.0, 1, PolynomialEquation { b, f, ..Default::default() })?;
    Ok(packed(model, minimum.covariance(), minimum.noise_variance(), e.len()))
}

/// Pole and numerator of a first-order plant, whatever polynomial the pole is in.
fn plant(fit: &Fit<PolynomialModel>) -> [f64; 2] {
    let e = &fit.model.equations()[0];
    [if e.f[0].is_empty() { e.a[0][0] } else { e.f[0][0] }, e.b[0][0]]
}

/// The mean error of the pole over the runs in its standard errors.
fn bias(estimate: impl Fn(&Dataset) -> Fit<PolynomialModel>) -> f64 {
    let errors: Vec<f64> = (0..25).map(|seed| plant(&estimate(&closed_loop(seed, 2000, 2.0)))[0] + 0.8).collect();
    let mean = errors.iter().sum::<f64>() / 25.0;
    let spread = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / 24.0;
    mean / (spread / 25.0).sqrt()
}

fn proportional() -> Indirect {
    Indirect { regulator: TransferFunction::discrete(vec![REGULATOR], vec![1.0], 1.0).unwrap() }
}

#[test]
fn stat_the_direct_method_is_biased_by_a_poor_noise_model_alone() {
    let sufficient = bias(|data| direct(data, 1, arx).unwrap());
    let poor = bias(|data| direct(data, 1, output_error).unwrap());
    assert!(sufficient.abs() < 3.5 && poor.abs() > 10.0, "{sufficient} {poor}");
}

#[test]
fn stat_two_stages_need_no_noise_model() {
    let stages = TwoStage { lags: 30, leads: 0 };
    let found = bias(|data| stages.fit(data, output_error).unwrap());
    assert!(found.abs() < 3.5, "{found}");
    let projected = TwoStage { lags: 30, leads: 5 };
    assert!(bias(|data| projected.fit(data, output_error).unwrap()).abs() < 3.5);
    // Too few lags leave part of the input unexplained, which then is missing from the plant's input.
    let short = bias(|data| TwoStage { lags: 0, leads: 0 }.fit(data, output_error).unwrap());
    assert!(short.abs() > 10.0, "{short}");
}

#[test]
fn stat_the_indirect_method_is_unbiased_for_the_true_regulator_alone() {
    let found = bias(|data| proportional().fit(data, arx).unwrap());
    assert!(found.abs() < 3.5, "{found}");
    let wrong = Indirect { regulator: TransferFunction::discrete(vec![0.6], vec![1.0], 1.0).unwrap() };
    assert!(bias(|data| wrong.fit(data, arx).unwrap()).abs() > 10.0);
}

#[test]
fn stat_the_covariance_of_the_indirect_plant_is_that_of_its_errors() {
    let mut ratios = [0.0; 2];
    for seed in 0..200 {
        let fit = proportional().fit(&closed_loop(300 + seed, 500, 1.0), arx).unwrap();
        let e = &fit.model.equations()[0];
        // b1, b2 = 0 …, f1: the order of the model's coefficients.
        let pole = e.b[0].len();
        ratios[0] += (e.b[0][0] - 0.5).powi(2) / fit.covariance[(0, 0)] / 200.0;
        ratios[1] += (e.f[0][0] + 0.8).powi(2) / fit.covariance[(pole, pole)] / 200.0;
    }
    assert!(ratios.iter().all(|r| (r - 1.0).abs() < 0.35), "{ratios:?}");
}

#[test]
fn stat_the_joint_response_is_unbiased_and_as_certain_as_it_says() {
    let omega: Vec<f64> = (1..=15).map(|k| 0.2 * f64::from(k)).collect();
    let truth = |w: f64| 0.5 * Complex64::cis(-w) / (Complex64::new(1.0, 0.0) - 0.8 * Complex64::cis(-w));
    let runs = 40;
    let (mut ratio, mut sums) = (0.0, vec![Complex64::new(0.0, 0.0); omega.len()]);
    let mut variances = vec![0.0; omega.len()];
    for seed in 0..runs {
        let found = JointInputOutput { order: 6 }.fit(&closed_loop(600 + seed, 2000, 1.0), &omega).unwrap();
        for (i, w) in omega.iter().enumerate() {
            let error = found.plant.response[i] - truth(*w);
            ratio += error.norm_sqr() / found.variances[i] / (runs * omega.len() as u64) as f64;
            sums[i] += error / runs as f64;
            variances[i] += found.variances[i] / (runs * runs) as f64;
        }
    }
    assert!((ratio - 1.0).abs() < 0.25, "{ratio}");
    assert!(sums.iter().zip(&variances).all(|(mean, v)| mean.norm_sqr() < 9.0 * v));
}

#[test]
fn exact_noise_free_loops_give_the_plant_back() {
    let data = closed_loop(1, 400, 0.0);
    for found in [
        plant(&proportional().fit(&data, arx).unwrap()),
        plant(&direct(&data.channels(&[0], &[0]).unwrap(), 0, arx).unwrap()),
        plant(&TwoStage { lags: 60, leads: 0 }.fit(&data, arx).unwrap()),
    ] {
        assert!((found[0] + 0.8).abs() < 1e-6 && (found[1] - 0.5).abs() < 1e-6, "{found:?}");
    }
}

#[test]
fn exact_a_dynamic_regulator_is_solved_for() {
    // R = (0.3 − 0.2 q⁻¹)/(1 − q⁻¹), G = 0.5 q⁻²/(1 − 0.8 q⁻¹), so T = N/M with the polynomials below.
    let regulator = TransferFunction::discrete(vec![0.6, -0.4], vec![2.0, -2.0], 1.0).unwrap();
    // M = (1 − 0.8 q⁻¹)(1 − q⁻¹) + 0.5 q⁻² (0.3 − 0.2 q⁻¹), N = 0.5 q⁻² (1 − q⁻¹).
    let (b, f) = (vec![vec![0.5, -0.5]], vec![vec![-1.8, 0.95, -0.1]]);
    let closed = PolynomialModel::siso(1.0, 2, PolynomialEquation { b, f, ..Default::default() }).unwrap();
    let fit = Indirect { regulator }.solve(&packed(closed, Mat::identity(5, 5), 1.0, 100)).unwrap();
    let found = fit.model.transfer_function(0, 0).unwrap();
    let truth = TransferFunction::discrete(vec![0.5], vec![1.0, -0.8, 0.0], 1.0).unwrap();
    for w in [0.1_f64, 0.7, 2.0, 3.0] {
        let (z, g) = (Complex64::cis(w), |h: &TransferFunction, z| h.evaluate(z));
        assert!((g(&found, z) - g(&truth, z)).norm() < 1e-12);
    }
}

#[test]
fn prop_the_slopes_of_the_indirect_plant_are_finite_differences() {
    let regulator = TransferFunction::discrete(vec![0.3, -0.2], vec![1.0, -0.4], 1.0).unwrap();
    // With nk = 0 the denominator has to be made monic.
    let equation = PolynomialEquation {
        a: vec![vec![-0.5, 0.1]],
        b: vec![vec![0.7, 0.4]],
        c: vec![0.3],
        f: vec![vec![0.2]],
        ..Default::default()
    };
    let model = PolynomialModel::siso(1.0, 0, equation).unwrap();
    let theta = model.coefficients();
    let solve = |theta: &[f64], covariance: Mat<f64>| {
        let closed = packed(model.with_coefficients(theta).unwrap(), covariance, 1.0, 100);
        Indirect { regulator: regulator.clone() }.solve(&closed).unwrap()
    };
    for j in 0..theta.len() {
        let only = Mat::from_fn(6, 6, |a, b| f64::from(u8::from(a == j && b == j)));
        let covariance = solve(&theta, only).covariance;
        let moved = |step: f64| {
            let mut near = theta.clone();
            near[j] += step;
            solve(&near, Mat::zeros(6, 6)).model.coefficients()
        };
        let (above, below) = (moved(1e-6), moved(-1e-6));
        for i in 0..above.len() {
            let slope = (above[i] - below[i]) / 2e-6;
            assert!((covariance[(i, i)].sqrt() - slope.abs()).abs() < 1e-7, "{i} {j}");
        }
    }
}

#[test]
fn regress_unusable_loops_are_named() {
    let data = closed_loop(2, 200, 1.0);
    let plant_alone = data.channels(&[0], &[0]).unwrap();
    assert!(matches!(TwoStage::default().fit(&plant_alone, arx), Err(IdentError::Structure { .. })));
    assert!(matches!(JointInputOutput::default().fit(&plant_alone, &[0.1]), Err(IdentError::Structure { .. })));
    assert!(matches!(proportional().fit(&plant_alone, arx), Err(IdentError::Structure { .. })));
    assert!(matches!(JointInputOutput { order: 2 }.fit(&data, &[9.0]), Err(IdentError::Signal(_))));
    assert!(matches!(TwoStage { lags: 500, leads: 0 }.fit(&data, arx), Err(IdentError::TooFewSamples { .. })));
    // No reference: nothing to explain the input by, and nothing to tell the plant by.
    let e = &data.experiments()[0];
    let silent = Mat::from_fn(200, 2, |t, k| if k == 0 { -REGULATOR * e.output(0)[t] } else { 0.0 });
    let silent = Dataset::new(1.0, silent, e.outputs.clone()).unwrap();
    assert!(matches!(direct(&silent, 2, arx), Err(IdentError::RankDeficient { .. })));
    assert!(matches!(TwoStage { lags: 3, leads: 0 }.fit(&silent, arx), Err(IdentError::RankDeficient { .. })));
    assert!(matches!(JointInputOutput { order: 2 }.fit(&silent, &[0.1]), Err(IdentError::RankDeficient { .. })));
}
