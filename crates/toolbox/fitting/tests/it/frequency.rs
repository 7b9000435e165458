//! Errors in variables by modulating functions, on dy/dt + a y = b u(t − δ) with y and u on clocks of their own.

use faer::Mat;
use fitting::frequency::{
    Equation, ErrorsInVariables, FrequencyFit, Modulated, NoisySpectrum, ORDERS, Prior, Slope, Window,
};
use fitting::{Bounds, IdentError, ResidualModel};
use numerics::random::Stream;
use signal::{Complex64, Signal};

const TRUTH: [f64; 3] = [12.0, 30.0, 0.004];
const WINDOW: Window = Window { start_s: 0.0, duration_s: 16.0 };
const LAST_BIN: usize = 400;

/// P_y = s + a, P_u = −b e^{−s(δ − d)}, d being the delay by which u was dated later beforehand.
struct Lag {
    dated_s: f64,
}

impl Equation for Lag {
    const SIGNALS: usize = 2;
    const PARAMETERS: usize = 3;

    fn coefficients(
        &self,
        s: Complex64,
        theta: &[f64],
        polynomials: &mut [[Complex64; ORDERS]],
        slopes: Option<&mut Vec<Slope>>,
    ) {
        let (zero, one) = (Complex64::default(), Complex64::from(1.0));
        let late = (-s * (theta[2] - self.dated_s)).exp();
        polynomials[0] = [theta[0].into(), one, zero];
        polynomials[1] = [-theta[1] * late, zero, zero];
        let by = |parameter, signal, first| Slope { parameter, signal, by_order: [first, zero, zero] };
        if let Some(slopes) = slopes {
            slopes.extend([by(0, 0, one), by(1, 1, -late), by(2, 1, theta[1] * s * late)]);
        }
    }
}

/// Standard normal, by Box and Muller: one of two uniform numbers.
fn normal(noise: &mut Stream) -> f64 {
    let radius = (-2.0 * (1.0 - noise.uniform()).ln()).sqrt();
    radius * (std::f64::consts::TAU * noise.uniform()).cos()
}

/// A sum of sines that do not fit the window, with y computed in closed form: u at 100 Hz, y at 250 Hz.
fn records(noise: &mut Stream, sd: f64) -> [Signal; 2] {
    let tones: Vec<(f64, f64)> = (0..40)
        .map(|k| (2.0 + 0.47 * f64::from(k) + 0.1 * noise.uniform(), std::f64::consts::TAU * noise.uniform()))
        .collect();
    let mut sample = |rate: f64, gain: &dyn Fn(f64) -> Complex64| {
        let value =
            |t: f64| -> f64 { tones.iter().map(|(w, phase)| (gain(*w) * Complex64::cis(w * t + phase)).re).sum() };
        // A little more than the window on both sides leaves room for dating.
        let (start_s, count) = (-0.1, ((WINDOW.duration_s + 0.2) * rate) as usize);
        let samples = (0..count).map(|i| value(start_s + i as f64 / rate) + sd * normal(noise)).collect();
        Signal::new(start_s, 1.0 / rate, samples).unwrap()
    };
    let response = |w: f64| TRUTH[1] * Complex64::cis(-w * TRUTH[2]) / (Complex64::new(TRUTH[0], w));
    [sample(250.0, &response), sample(100.0, &|_| Complex64::from(1.0))]
}

/// Transforms of y, and of u dated later by `dated_s`.
fn spectra(signals: &[Signal; 2], sd: f64, dated_s: f64) -> Vec<NoisySpectrum> {
    let of = |signal: &Signal, later_s: f64| {
        let dated = Signal { start_s: signal.start_s + later_s, ..signal.clone() };
        let noise_density = sd * sd * signal.sample_time_s;
        NoisySpectrum {
            modulated: Modulated::new(&dated, WINDOW, LAST_BIN).unwrap(),
            errors: Vec::new(),
            noise_density,
        }
    };
    vec![of(&signals[0], 0.0), of(&signals[1], dated_s)]
}

/// Two rounds: the second on u dated by the delay that the first found.
fn fit(signals: &[Signal; 2], sd: f64, priors: &[Prior]) -> FrequencyFit {
    let first = fit_dated(&spectra(signals, sd, 0.0), 0.0, priors);
    let dated_s = first.fit.parameters[2];
    fit_dated(&spectra(signals, sd, dated_s), dated_s, priors)
}

fn fit_dated(signals: &[NoisySpectrum], dated_s: f64, priors: &[Prior]) -> FrequencyFit {
    let bins: Vec<usize> = WINDOW.bins(0.2, 4.0).collect();
    let bounds = [Bounds::new(0.0, 1e3), Bounds::new(0.0, 1e3), Bounds::new(-0.1, 0.1)];
    ErrorsInVariables::new(&Lag { dated_s }, signals, WINDOW, &bins, priors).fit(&[5.0, 5.0, 0.0], &bounds).unwrap()
}

#[test]
fn exact_noise_free_records_on_two_clocks_return_the_truth() {
    let signals = records(&mut Stream::new(1, 0), 0.0);
    let found = fit(&signals, 1e-3, &[]);
    for (estimate, truth) in found.fit.parameters.iter().zip(TRUTH) {
        assert!((estimate / truth - 1.0).abs() < 1e-5, "{:?}", found.fit.parameters);
    }
}

#[test]
fn exact_transform_of_a_derivative_is_the_derivative_of_the_transform() {
    // Whole periods: a mean that is taken away from a record is not there in its derivative.
    let omega = std::f64::consts::TAU * 18.0 / WINDOW.duration_s;
    let sample =
        |f: &dyn Fn(f64) -> f64| Signal::new(0.0, 0.005, (0..3200).map(|i| f(f64::from(i) * 0.005)).collect()).unwrap();
    let sine = Modulated::new(&sample(&|t| (omega * t).sin()), WINDOW, 60).unwrap();
    let cosine = Modulated::new(&sample(&|t| omega * (omega * t).cos()), WINDOW, 60).unwrap();
    for k in 3..60 {
        // The window's second derivative jumps, between samples too: the sum differs from the integral by some 10⁻⁵.
        let size = omega * WINDOW.duration_s;
        assert!((sine.orders[1][k] - cosine.orders[0][k]).norm() < 1e-5 * size);
        assert!((sine.orders[2][k] - cosine.orders[1][k]).norm() < 1e-5 * omega * size);
    }
}

#[test]
fn prop_gradient_equals_differences() {
    let signals = spectra(&records(&mut Stream::new(2, 0), 0.05), 0.05, 0.0);
    let bins: Vec<usize> = WINDOW.bins(0.2, 4.0).collect();
    let priors = [Prior { parameter: 2, value: 0.0, standard_uncertainty: 1e-3 }];
    let mut problem = ErrorsInVariables::new(&Lag { dated_s: 0.0 }, &signals, WINDOW, &bins, &priors);
    let rows = problem.residual_count();
    let theta = [10.0, 25.0, 0.002];
    let mut jacobian = Mat::zeros(rows, 3);
    problem.evaluate(&theta, &mut vec![0.0; rows], Some(jacobian.as_mut())).unwrap();
    let mut at = |theta: &[f64]| {
        let mut residuals = vec![0.0; rows];
        problem.evaluate(theta, &mut residuals, None).unwrap();
        residuals
    };
    for j in 0..3 {
        let step = 1e-6 * theta[j];
        let moved = |sign: f64| {
            let mut point = theta;
            point[j] += sign * step;
            point
        };
        let (above, below) = (at(&moved(1.0)), at(&moved(-1.0)));
        let scale = jacobian.col(j).norm_max();
        for i in 0..rows {
            let difference = (above[i] - below[i]) / (2.0 * step);
            assert!((difference - jacobian[(i, j)]).abs() < 1e-6 * scale, "row {i}, parameter {j}");
        }
    }
}

#[test]
fn stat_intervals_cover_the_truth_with_noise_on_both_signals() {
    let runs = 300;
    let mut noise = Stream::new(3, 0);
    let (mut covered, mut scale) = ([0; 3], 0.0);
    for _ in 0..runs {
        let found = fit(&records(&mut noise, 0.3), 0.3, &[]);
        scale += found.scale / f64::from(runs);
        for (j, count) in covered.iter_mut().enumerate() {
            let error = found.covariance[(j, j)].sqrt();
            let (low, high) =
                signal::distributions::interval(found.fit.parameters[j], error, found.degrees_of_freedom, 0.95);
            *count += usize::from(low < TRUTH[j] && TRUTH[j] < high);
        }
    }
    assert!((scale - 1.0).abs() < 0.05, "the noise levels were given, so the scale is one, not {scale}");
    for count in covered {
        // At least the binomial bound; the sandwich may make intervals somewhat longer.
        let share = count as f64 / f64::from(runs);
        assert!((0.91..=0.995).contains(&share), "coverage {share}");
    }
}

#[test]
fn exact_prior_alone_gives_its_own_uncertainty_back() {
    let signals = records(&mut Stream::new(4, 0), 0.3);
    let tight = Prior { parameter: 2, value: 0.004, standard_uncertainty: 1e-7 };
    let found = fit(&signals, 0.3, &[tight]);
    let error = found.covariance[(2, 2)].sqrt();
    assert!((found.fit.parameters[2] - 0.004).abs() < 1e-6);
    assert!((error / 1e-7 - 1.0).abs() < 0.01, "{error}");
}

/// A prior as strong as the data, which the noise levels stated must not weaken or strengthen: what is known beforehand
/// is in units of its own.
#[test]
fn exact_prior_and_data_combine_whatever_the_stated_noise() {
    let signals = records(&mut Stream::new(6, 0), 0.3);
    let data = fit(&signals, 0.3, &[]);
    let deviation = data.covariance[(2, 2)].sqrt();
    let prior =
        Prior { parameter: 2, value: data.fit.parameters[2] + 2.0 * deviation, standard_uncertainty: deviation };
    for stated in [0.003, 0.3, 30.0] {
        let found = fit(&signals, stated, &[prior]);
        let moved = (found.fit.parameters[2] - data.fit.parameters[2]) / deviation;
        let narrower = found.covariance[(2, 2)].sqrt() / deviation;
        assert!((moved - 1.0).abs() < 0.05, "stated {stated}: moved by {moved} deviations");
        assert!((narrower - 0.5_f64.sqrt()).abs() < 0.03, "stated {stated}: {narrower}");
    }
}

/// The truth is drawn from the prior, and the noise levels are three times what they are: 95 % intervals still hold the
/// truth in 95 % of the draws.
#[test]
fn stat_intervals_with_a_prior_hold_the_truth_where_the_noise_is_overstated() {
    let (runs, uncertainty) = (300, 2e-4);
    let (mut noise, mut held) = (Stream::new(7, 0), 0);
    for _ in 0..runs {
        let error = uncertainty * normal(&mut noise);
        let prior = Prior { parameter: 2, value: TRUTH[2] + error, standard_uncertainty: uncertainty };
        let found = fit(&records(&mut noise, 0.3), 0.9, &[prior]);
        let deviation = found.covariance[(2, 2)].sqrt();
        held += usize::from((found.fit.parameters[2] - TRUTH[2]).abs() < 1.96 * deviation);
    }
    let share = held as f64 / f64::from(runs);
    // Three standard deviations of the binomial; the sandwich may make intervals somewhat longer.
    assert!((0.912..=0.995).contains(&share), "{share}");
}

#[test]
fn regress_windows_that_do_not_fit_are_refused() {
    let signal = Signal::new(0.0, 0.01, vec![1.0; 1600]).unwrap();
    let long = Window { start_s: 8.0, duration_s: 16.0 };
    assert!(matches!(Modulated::new(&signal, long, 10), Err(IdentError::Length { .. })));
    assert!(matches!(Modulated::new(&signal, WINDOW, 800), Err(IdentError::TooFewSamples { .. })));
}

#[test]
fn exact_a_drifting_clock_is_as_good_as_a_true_one() {
    let mut signals = records(&mut Stream::new(1, 0), 0.0);
    // u again, on a clock that gains 20 µs a second.
    let times: Vec<f64> = (0..1610).map(|i| -0.05 + f64::from(i) * 0.01 * (1.0 - 2e-5)).collect();
    let samples = signal::resample::interpolate_at(&signals[1], &times, signal::resample::Interpolation::BandLimited);
    signals[1] = Signal::new(-0.05, 0.01 * (1.0 - 2e-5), samples.unwrap()).unwrap();
    let found = fit(&signals, 1e-3, &[]);
    for (estimate, truth) in found.fit.parameters.iter().zip(TRUTH) {
        assert!((estimate / truth - 1.0).abs() < 1e-4, "{:?}", found.fit.parameters);
    }
}
