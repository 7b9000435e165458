//! Uncertainty of what follows from an estimate.

use faer::{Mat, mat};
use ident::uncertainty::{Dynamics, agreement, nested};
use ident::{Fit, Parametric, Termination};
use lti::{Complex64, LtiError, PolynomialEquation, PolynomialModel, StateSpace, TimeGrid};
use proptest::prelude::*;
use signal::excitation::Random;
use testkit::system::{self, SAMPLE_TIME_S};

use crate::stand_in;

/// A fit made by hand.
pub(crate) fn fit_of<M: Parametric>(model: M, covariance: Mat<f64>) -> Fit<M> {
    Fit {
        model,
        covariance,
        degrees_of_freedom: 1e9,
        noise_covariance: mat![[1.0]],
        loss: 1.0,
        samples: 1000,
        free_parameters: 2,
        initial_states: Vec::new(),
        levels: Vec::new(),
        termination: Termination::Direct,
        iterations: 0,
        condition: 1.0,
        doubts: Vec::new(),
        origin: None,
    }
}

fn ar(a: &[f64]) -> PolynomialModel {
    let equation = PolynomialEquation { a: vec![a.to_vec()], b: vec![vec![1.0, 0.5]], ..Default::default() };
    PolynomialModel::siso(SAMPLE_TIME_S, 3, equation).unwrap()
}

/// A covariance of [a₁, a₂, b₀, b₁] from a factor.
fn covariance(scale: f64) -> Mat<f64> {
    let factor = mat![[1.0, 0.2, 0.1], [-0.7, 0.6, 0.0], [0.3, 0.1, 0.9], [0.2, -0.4, 0.5]];
    faer::Scale(scale * scale) * (&factor * factor.transpose())
}

/// z² + a₁ z + a₂ = 0 differentiated by hand: ∂z/∂a₁ = −z/(2z + a₁), ∂z/∂a₂ = −1/(2z + a₁).
#[test]
fn exact_covariance_of_a_complex_pole_is_that_of_the_formula() {
    let p = covariance(1e-4);
    let fit = fit_of(ar(&[-1.5, 0.7]), p.clone());
    let poles = fit.poles(0, 0).unwrap();
    assert_eq!(poles.len(), 2, "delays are no poles");
    for pole in poles {
        let z = pole.value;
        let slope = [-z / (2.0 * z - 1.5), -Complex64::ONE / (2.0 * z - 1.5)];
        let sum = |part: fn(Complex64) -> f64, other: fn(Complex64) -> f64| {
            let term = |i: usize, j: usize| part(slope[i]) * p[(i, j)] * other(slope[j]);
            term(0, 0) + term(0, 1) + term(1, 0) + term(1, 1)
        };
        fn re(z: Complex64) -> f64 {
            z.re
        }
        fn im(z: Complex64) -> f64 {
            z.im
        }
        for (found, expected) in [
            (pole.covariance[0][0], sum(re, re)),
            (pole.covariance[0][1], sum(re, im)),
            (pole.covariance[1][1], sum(im, im)),
        ] {
            assert!((found - expected).abs() < 1e-9 * p[(0, 0)], "{found} {expected}");
        }
        assert!(!pole.near_multiple);
    }
    let zero = &fit.zeros(0, 0).unwrap()[0];
    // z = −b₁/b₀
    let (b0, b1) = (1.0, 0.5);
    let slope = [b1 / (b0 * b0), -1.0 / b0];
    let term = |i: usize, j: usize| slope[i] * p[(i + 2, j + 2)] * slope[j];
    let variance = term(0, 0) + term(0, 1) + term(1, 0) + term(1, 1);
    assert!((zero.covariance[0][0] - variance).abs() < 1e-7 * variance && zero.ellipse(0.95).semi_minor == 0.0);
}

/// A discrete system whose A is written in other coordinates; roots by eigenvectors agree with those by polynomials.
#[derive(Clone)]
struct Turned(PolynomialModel);

impl Parametric for Turned {
    fn parameters(&self) -> Vec<f64> {
        self.0.coefficients()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.0.coefficient_names()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        Ok(Turned(self.0.with_coefficients(parameters)?))
    }
}

impl Dynamics for Turned {
    fn system(&self) -> Result<StateSpace, LtiError> {
        let whole = self.0.innovations()?;
        let s = whole.system();
        let t = mat![[1.0, 2.0], [-0.5, 3.0]];
        let inverse = faer::linalg::solvers::DenseSolveCore::inverse(&t.partial_piv_lu());
        StateSpace::discrete(&t * s.a() * &inverse, &t * s.b(), s.c() * &inverse, s.d().to_owned(), SAMPLE_TIME_S)
    }
}

#[test]
fn exact_roots_by_eigenvectors_equal_roots_by_polynomials() {
    let arx = system::arx().unwrap();
    let by_polynomial = fit_of(arx.clone(), covariance(1e-3));
    let by_vectors = fit_of(Turned(arx), covariance(1e-3));
    let pairs = [
        (by_polynomial.poles(0, 0).unwrap(), by_vectors.poles(0, 0).unwrap()),
        (by_polynomial.zeros(0, 0).unwrap(), by_vectors.zeros(0, 0).unwrap()),
    ];
    for (one, other) in pairs {
        assert_eq!(one.len(), other.len());
        for root in &one {
            let near = |r: &&ident::uncertainty::UncertainRoot| (r.value - root.value).norm() < 1e-10;
            let same = other.iter().find(near).unwrap();
            for (a, b) in root.covariance.iter().flatten().zip(same.covariance.iter().flatten()) {
                assert!((a - b).abs() < 1e-9 * root.covariance[0][0].abs(), "{root:?} {same:?}");
            }
        }
    }
}

/// Two masses and a spring in continuous time, torque to the speed of the first: θ = [J₁, J₂, k, d].
#[derive(Clone)]
struct TwoMass([f64; 4]);

impl Parametric for TwoMass {
    fn parameters(&self) -> Vec<f64> {
        self.0.to_vec()
    }

    fn parameter_names(&self) -> Vec<String> {
        ["J1", "J2", "k", "d"].map(String::from).to_vec()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        let found: [f64; 4] = parameters.try_into().map_err(|_| LtiError::NonFinite { what: "parameters" })?;
        Ok(TwoMass(found))
    }
}

impl Dynamics for TwoMass {
    fn system(&self) -> Result<StateSpace, LtiError> {
        let [j1, j2, k, d] = self.0;
        let a = mat![[0.0, 1.0, -1.0], [-k / j1, -d / j1, d / j1], [k / j2, d / j2, -d / j2]];
        StateSpace::continuous(a, mat![[0.0], [1.0 / j1], [0.0]], mat![[0.0, 1.0, 0.0]], mat![[0.0]])
    }
}

/// The resonance is √(k (1/J₁ + 1/J₂)) and the anti-resonance √(k/J₂) where there is no damping; their deviations
/// follow.
#[test]
fn exact_resonances_of_a_continuous_model_have_the_deviations_of_the_formulas() {
    let (j1, j2, k) = (0.02, 0.05, 400.0);
    let p = Mat::from_fn(4, 4, |i, j| if i == j { [4e-8, 1e-6, 16.0, 0.0][i] } else { 0.0 });
    let fit = fit_of(TwoMass([j1, j2, k, 0.0]), p.clone());
    let resonance: f64 = (k * (1.0 / j1 + 1.0 / j2)).sqrt();
    let slopes = [-k / (j1 * j1), -k / (j2 * j2), 1.0 / j1 + 1.0 / j2].map(|s| s / (2.0 * resonance));
    let variance: f64 = (0..3).map(|i| slopes[i].powi(2) * p[(i, i)]).sum();
    let poles = fit.poles(0, 0).unwrap();
    let pole = poles.iter().find(|p| p.value.im > 1.0).unwrap();
    assert!((pole.value.im - resonance).abs() < 1e-9 * resonance);
    assert!((pole.covariance[1][1] - variance).abs() < 1e-3 * variance, "{pole:?} {variance}");
    let rigid = poles.iter().find(|p| p.value.norm() < 1.0).unwrap();
    assert!(rigid.covariance[0][0] < 1e-12 * variance);
    let zeros = fit.zeros(0, 0).unwrap();
    let zero = zeros.iter().find(|z| z.value.im > 1.0).unwrap();
    let anti: f64 = (k / j2).sqrt();
    let variance = (anti / (2.0 * j2)).powi(2) * p[(1, 1)] + (anti / (2.0 * k)).powi(2) * p[(2, 2)];
    assert!((zero.value.im - anti).abs() < 1e-8 * anti);
    assert!((zero.covariance[1][1] - variance).abs() < 1e-3 * variance);
}

proptest! {
    /// A function that is linear in the parameters has the covariance G P Gᵀ, whatever the rank and units of P.
    #[test]
    fn prop_linear_functions_have_their_exact_covariance(
        factor in prop::collection::vec(-1.0_f64..1.0, 8),
        g in prop::collection::vec(-1.0_f64..1.0, 8),
        units in prop::collection::vec(-6.0_f64..6.0, 4),
    ) {
        let unit = |i: usize| 10_f64.powf(units[i]);
        let factor = Mat::from_fn(4, 2, |i, j| 1e-3 * unit(i) * factor[2 * i + j]);
        let p = &factor * factor.transpose();
        let g = Mat::from_fn(2, 4, |i, j| g[4 * i + j] / unit(j));
        let theta: Vec<f64> = (0..4).map(unit).collect();
        let fit = fit_of(ar(&[-1.5, 0.7]).with_coefficients(&theta).unwrap(), p.clone());
        let linear = |m: &PolynomialModel| {
            let c = m.coefficients();
            Ok((0..2).map(|i| (0..4).map(|j| g[(i, j)] * c[j]).sum()).collect())
        };
        let found = fit.derive(linear).unwrap().covariance();
        let expected = &g * &p * g.transpose();
        prop_assert!((&found - &expected).norm_max() < 1e-14 + 1e-7 * expected.norm_max());
    }
}

#[test]
fn exact_near_multiple_poles_are_flagged() {
    let exact = fit_of(ar(&[-1.0, 0.25]), covariance(1e-3));
    assert!(exact.poles(0, 0).unwrap().iter().all(|p| p.near_multiple));
    // 0.5 and 0.51: far apart for a covariance of 1e-6, too near for 1e-3.
    let pair = [-1.01, 0.255];
    assert!(fit_of(ar(&pair), covariance(1e-3)).poles(0, 0).unwrap().iter().all(|p| p.near_multiple));
    assert!(fit_of(ar(&pair), covariance(1e-6)).poles(0, 0).unwrap().iter().all(|p| !p.near_multiple));
}

#[test]
fn exact_frequency_band_is_that_of_the_formula() {
    let p = covariance(1e-4);
    let fit = fit_of(ar(&[-1.5, 0.7]), p.clone());
    let omega = [0.5, 5.0, 20.0];
    let band = fit.frequency_band(0, 0, &omega).unwrap();
    for (k, w) in omega.iter().enumerate() {
        let back = Complex64::cis(-w * SAMPLE_TIME_S);
        let (a, b) = (Complex64::ONE - 1.5 * back + 0.7 * back * back, back.powi(3) * (1.0 + 0.5 * back));
        let slope = [-b * back / (a * a), -b * back * back / (a * a), back.powi(3) / a, back.powi(4) / a];
        let sum = |f: fn(Complex64) -> f64| {
            let pairs = (0..4).flat_map(|i| (0..4).map(move |j| (i, j)));
            pairs.map(|(i, j)| f(slope[i]) * p[(i, j)] * f(slope[j])).sum::<f64>()
        };
        let size = sum(|s| s.re).max(sum(|s| s.im));
        assert!((band.covariance[k][0][0] - sum(|s| s.re)).abs() < 1e-5 * size);
        assert!((band.covariance[k][1][1] - sum(|s| s.im)).abs() < 1e-5 * size);
        let (low, high) = band.magnitude(0.95)[k];
        assert!(low < band.response.response[k].norm() && band.response.response[k].norm() < high);
    }
}

#[test]
fn exact_derived_values_of_a_singular_badly_scaled_covariance() {
    // Two parameters that move together, in units twelve orders apart.
    let p = mat![[1e-12, 1e-6, 0.0, 0.0], [1e-6, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 4.0]];
    let fit = fit_of(ar(&[-1.5, 0.7]), p);
    let derived = fit
        .derive(|m| {
            let c = m.coefficients();
            Ok(vec![1e6 * c[0] - c[1], c[2], 3.0 * c[3]])
        })
        .unwrap();
    let errors = derived.standard_errors();
    assert!(errors[0] < 1e-6 && errors[1] == 0.0 && (errors[2] - 6.0).abs() < 1e-9, "{errors:?}");
}

#[test]
fn stat_ellipses_and_bands_cover_as_they_promise() {
    let truth = system::arx().unwrap();
    let (pole, omega) = (truth.transfer_function(0, 0).unwrap().poles().unwrap(), [1.0, 5.0, 9.0]);
    let response = truth.transfer_function(0, 0).unwrap().frequency_response(&omega).unwrap();
    let grid = TimeGrid { step_s: SAMPLE_TIME_S, points: 12 };
    let step = fit_of(truth.clone(), Mat::zeros(4, 4)).step_band(0, 0, &grid).unwrap().values;
    let (mut in_pole, mut in_zero, mut in_gain, mut in_magnitude, mut in_phase, mut in_step) = (0, 0, 0, 0, 0, 0);
    let runs = 400;
    for seed in 0..runs {
        let fit = stand_in::arx(&system::data(&truth, SAMPLE_TIME_S, 400, 1.0, seed).unwrap(), 2, 2).unwrap();
        let upper = pole.iter().find(|p| p.im > 0.0).unwrap();
        let poles = fit.poles(0, 0).unwrap();
        in_pole += usize::from(poles.iter().any(|p| p.value.im > 0.0 && p.ellipse(0.95).contains(*upper)));
        in_zero += usize::from(fit.zeros(0, 0).unwrap()[0].ellipse(0.95).contains(Complex64::new(-0.5, 0.0)));
        let band = fit.frequency_band(0, 0, &omega).unwrap();
        in_gain += usize::from(band.ellipses(0.95)[1].contains(response.response[1]));
        let inside = |(low, high): (f64, f64), value: f64| usize::from(low < value && value < high);
        in_magnitude += inside(band.magnitude(0.95)[0], response.response[0].norm());
        in_phase += inside(band.phase_deg(0.95)[2], response.phase_deg()[2]);
        in_step += inside(fit.step_band(0, 0, &grid).unwrap().intervals(0.95)[9], step[9]);
    }
    for (name, count) in [
        ("pole", in_pole),
        ("zero", in_zero),
        ("gain", in_gain),
        ("magnitude", in_magnitude),
        ("phase", in_phase),
        ("step", in_step),
    ] {
        // 380 expected, with a deviation of 4.4.
        assert!((365..=394).contains(&count), "{name}: {count} of {runs}");
    }
}

#[test]
fn stat_samples_have_the_covariance_they_are_drawn_from() {
    let p = covariance(1e-2);
    let fit = fit_of(system::arx().unwrap(), p.clone());
    let drawn = fit.sample(20_000, &mut Random::new(5)).unwrap();
    assert_eq!((drawn.models.len(), drawn.refused), (20_000, 0));
    let theta = fit.parameters();
    for i in 0..4 {
        for j in 0..4 {
            let product = |m: &PolynomialModel| (m.coefficients()[i] - theta[i]) * (m.coefficients()[j] - theta[j]);
            let mean = drawn.models.iter().map(|s| product(&s.model)).sum::<f64>() / 20_000.0;
            assert!((mean - p[(i, j)]).abs() < 5e-2 * (p[(i, i)] * p[(j, j)]).sqrt());
        }
    }
    assert!(drawn.models.iter().all(|s| s.stable));
    let wide = fit_of(system::arx().unwrap(), covariance(1.0)).sample(100, &mut Random::new(5)).unwrap();
    assert!(wide.models.iter().any(|s| !s.stable));
}

#[test]
fn stat_tests_between_estimates_hold_their_level_and_have_power() {
    let truth = system::arx().unwrap();
    let (mut refused, mut disagree, runs) = (0, 0, 300);
    for seed in 0..runs {
        let data = system::data(&truth, SAMPLE_TIME_S, 300, 1.0, seed).unwrap();
        let other = system::data(&truth, SAMPLE_TIME_S, 500, 1.0, seed + 9000).unwrap();
        // Rows are the same where the delays reach as far back.
        let small = stand_in::arx(&data, 2, 3).unwrap();
        let large = stand_in::arx(&data, 3, 3).unwrap();
        refused += usize::from(!nested(&small, &large).unwrap().passes(0.95));
        let plain = stand_in::arx(&data, 2, 2).unwrap();
        disagree += usize::from(!agreement(&plain, &stand_in::arx(&other, 2, 2).unwrap()).unwrap().passes(0.95));
        let poor = stand_in::arx(&data, 1, 3).unwrap();
        assert!(!nested(&poor, &small).unwrap().passes(0.9999));
    }
    // 15 expected, with a deviation of 3.8.
    assert!((4..=27).contains(&refused), "{refused}");
    assert!((4..=27).contains(&disagree), "{disagree}");
    let moved = fit_of(truth.with_coefficients(&[-1.4, 0.6, 1.0, 0.5]).unwrap(), covariance(1e-4));
    assert!(!agreement(&fit_of(truth, covariance(1e-4)), &moved).unwrap().passes(0.99));
}

/// A regression on the input alone with coloured noise: least squares is right, its own covariance is not.
#[test]
#[ignore = "slow"]
fn stat_robust_covariance_covers_where_the_own_one_does_not() {
    let (mut own, mut robust, runs) = (0, 0, 300);
    let gain = PolynomialEquation { b: vec![vec![1.0]], f: vec![vec![]], ..Default::default() };
    let noise = PolynomialEquation { d: vec![-0.9], ..gain.clone() };
    let truth = PolynomialModel::siso(SAMPLE_TIME_S, 1, noise).unwrap();
    for seed in 0..runs {
        let mut state = 0.0;
        let white = system::white(1500, 1, seed + 40);
        let u = Mat::from_fn(1500, 1, |t, _| {
            state = 0.9 * state + white[(t, 0)];
            state
        });
        let y = system::outputs(&truth, SAMPLE_TIME_S, &u, 1.0, seed).unwrap();
        let data = ident::Dataset::new(SAMPLE_TIME_S, u, y).unwrap();
        let fit = stand_in::arx(&data, 0, 1).unwrap();
        let inside = |variance: f64| usize::from((fit.parameters()[0] - 1.0).abs() < 1.96 * variance.sqrt());
        own += inside(fit.covariance[(0, 0)]);
        robust += inside(fit.robust_covariance(&data, 40).unwrap()[(0, 0)]);
    }
    assert!(own < 220, "{own}");
    assert!(robust > 265, "{robust}");
}

#[test]
fn regress_unusable_covariances_are_errors() {
    let fit = fit_of(system::arx().unwrap(), Mat::identity(3, 3));
    assert!(fit.poles(0, 0).is_err() && fit.sample(1, &mut Random::new(1)).is_err());
    let fit = fit_of(system::arx().unwrap(), Mat::full(4, 4, f64::NAN));
    assert!(fit.poles(0, 0).is_err() && fit.frequency_band(0, 0, &[1.0]).is_err());
    let fit = fit_of(system::arx().unwrap(), covariance(1e-3));
    assert!(fit.poles(1, 0).is_err() && fit.frequency_band(0, 3, &[1.0]).is_err());
    assert!(fit.frequency_band(0, 0, &[]).unwrap().covariance.is_empty());
    assert!(Dynamics::system(&system::two_mass_sampled().unwrap()).is_ok());
}
