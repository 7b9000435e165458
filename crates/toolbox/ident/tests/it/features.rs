//! Modes of roots and features of responses, with their uncertainty.

use std::f64::consts::TAU;

use faer::{Mat, mat};
use ident::uncertainty::{Dynamics, Features};
use ident::{Fit, RationalChannel, TransferFunctionModel};
use lti::{LtiError, Mode, PolynomialEquation, PolynomialModel, TimeGrid};

use crate::uncertainty::fit_of;

const T: f64 = 0.1;
/// Student's t at 97.5 % with very many degrees of freedom.
const REACH: f64 = 1.959_963_985;

/// `B(q)/A(q)` with a covariance of this scale for [a₁, a₂, b₀, b₁].
fn fit(a: &[f64], scale: f64) -> Fit<PolynomialModel> {
    let equation = PolynomialEquation { a: vec![a.to_vec()], b: vec![vec![1.0, 0.5]], ..Default::default() };
    let factor = mat![[1.0, 0.2, 0.1], [-0.7, 0.6, 0.0], [0.3, 0.1, 0.9], [0.2, -0.4, 0.5]];
    let n = a.len() + 2;
    let covariance = faer::Scale(scale * scale) * (&factor * factor.transpose());
    fit_of(PolynomialModel::siso(T, 1, equation).unwrap(), covariance.get(..n, ..n).to_owned())
}

#[track_caller]
fn assert_half_width(interval: Option<(f64, f64)>, value: f64, error: f64) {
    let (low, high) = interval.unwrap();
    assert!((0.5 * (low + high) / value - 1.0).abs() < 1e-3, "{low} … {high} about {value}");
    assert!((0.5 * (high - low) / (REACH * error) - 1.0).abs() < 2e-3, "{low} … {high}, error {error}");
}

/// A number of the first pole, differentiated by differences of the whole computation.
fn error_of(fit: &Fit<PolynomialModel>, number: impl Fn(&Mode) -> f64) -> f64 {
    let of = |m: &PolynomialModel| {
        let poles = m.system()?.poles()?;
        let pole = poles.iter().filter(|p| p.norm() > 0.1).max_by(|a, b| a.im.total_cmp(&b.im));
        Ok(vec![pole.map_or(f64::NAN, |p| number(&Mode::new(*p, Some(T))))])
    };
    fit.derive(of).unwrap().standard_errors()[0]
}

#[test]
fn exact_intervals_of_a_mode_are_those_of_the_delta_method() {
    let fit = fit(&[-1.5, 0.7], 1e-4);
    let poles = fit.poles(0, 0).unwrap();
    let mode = poles.iter().find(|p| p.value.im > 0.0).unwrap().mode(Some(T));
    let known = mode.mode;
    let omega = error_of(&fit, |m| m.natural_frequency_rad_s);
    assert_half_width(mode.natural_frequency_rad_s(0.95), known.natural_frequency_rad_s, omega);
    assert_half_width(mode.damping(0.95), known.damping, error_of(&fit, |m| m.damping));
    assert_half_width(mode.time_constant_s(0.95), known.time_constant_s(), error_of(&fit, Mode::time_constant_s));
    let mirrored = poles.iter().find(|p| p.value.im < 0.0).unwrap().mode(Some(T));
    assert_eq!(mirrored.damping(0.95).map(|d| d.0 as f32), mode.damping(0.95).map(|d| d.0 as f32));
}

#[test]
fn exact_a_real_pole_has_the_interval_of_its_own_carried_over() {
    let fit = fit(&[-0.9, 0.0], 1e-3);
    let pole = fit.poles(0, 0).unwrap().into_iter().find(|p| p.value.norm() > 0.1).unwrap();
    let (mode, error) = (pole.mode(Some(T)), pole.covariance[0][0].sqrt());
    let of_root = |z: f64| -T / z.ln();
    let (low, high) = mode.time_constant_s(0.95).unwrap();
    assert!((low / of_root(0.9 - REACH * error) - 1.0).abs() < 1e-6);
    assert!((high / of_root(0.9 + REACH * error) - 1.0).abs() < 1e-6);
    let (slow, fast) = mode.natural_frequency_rad_s(0.95).unwrap();
    assert!((slow * high - 1.0).abs() < 1e-12 && (fast * low - 1.0).abs() < 1e-12);
    assert_eq!(mode.damping(0.95), None, "1 by definition");
}

#[test]
fn regress_a_pole_that_may_be_at_rest_has_a_time_constant_without_end() {
    let fit = fit(&[-0.999, 0.0], 0.01);
    let pole = fit.poles(0, 0).unwrap().into_iter().find(|p| p.value.norm() > 0.1).unwrap();
    let mode = pole.mode(Some(T));
    let (low, high) = mode.time_constant_s(0.95).unwrap();
    assert!(low > 0.0 && low < mode.mode.time_constant_s() && high == f64::INFINITY, "{low} … {high}");
    assert_eq!(mode.natural_frequency_rad_s(0.95).unwrap().0, 0.0);
}

#[test]
fn exact_roots_that_run_together_and_certain_ones_have_no_interval() {
    let near = fit(&[-1.8, 0.811], 0.01);
    let root = &near.poles(0, 0).unwrap()[0];
    assert!(root.near_multiple);
    assert_eq!(root.mode(Some(T)).natural_frequency_rad_s(0.95), None);
    let certain = fit(&[-1.5, 0.7], 0.0);
    assert_eq!(certain.poles(0, 0).unwrap()[0].mode(Some(T)).damping(0.95), None);
}

#[test]
fn exact_gain_bandwidth_and_resonance_are_those_of_the_formulas() {
    // 1/(1 − 0.9/q): |H|² = 1/(1.81 − 1.8 cos ωT) is half of that at rest, 100, where cos ωT = (1.81 − 0.02)/1.8.
    let equation = PolynomialEquation { a: vec![vec![-0.9]], b: vec![vec![1.0]], ..Default::default() };
    let lag = fit_of(PolynomialModel::siso(T, 1, equation).unwrap(), mat![[1e-8, 0.0], [0.0, 1e-8]]);
    let features = Features::of_fit(&lag, 0, 0);
    let omega = lag.model.system().unwrap().frequency_grid(200).unwrap();
    let gain = features.dc_gain().unwrap().unwrap();
    // H(0) = b/(1 + a): errors b/(1 + a)² of a, and 1/(1 + a) of b.
    assert_half_width(gain.interval(0.95), 10.0, 1e-4 * 100.0_f64.hypot(10.0));
    let bandwidth = features.bandwidth_rad_s(&omega).unwrap().unwrap();
    let angle = |a: f64| ((1.0 + a * a - 2.0 * (1.0 - a) * (1.0 - a)) / (2.0 * a)).acos() / T;
    assert!((bandwidth.value / angle(0.9) - 1.0).abs() < 1e-9, "{}", bandwidth.value);
    let slope = (angle(0.9 + 1e-6) - angle(0.9 - 1e-6)) / 2e-6;
    assert_half_width(bandwidth.interval(0.95), angle(0.9), 1e-4 * slope.abs());
    assert!(features.resonances(&omega).unwrap().is_empty());
}

#[test]
fn exact_a_resonance_moves_as_its_whole_search_does() {
    let fit = fit(&[-1.6, 0.9], 1e-4);
    let omega = fit.model.system().unwrap().frequency_grid(400).unwrap();
    let found = Features::of_fit(&fit, 0, 0).resonances(&omega).unwrap();
    assert_eq!(found.len(), 1);
    let top = |m: &PolynomialModel| {
        let found = Features::of_model(m, 0, 0).resonances(&omega).map_err(|_| LtiError::AlgebraicLoop)?;
        Ok(found.iter().flat_map(|r| [r.omega_rad_s.value, r.gain.value]).collect())
    };
    let whole = fit.derive(top).unwrap();
    let errors = whole.standard_errors();
    assert_half_width(found[0].omega_rad_s.interval(0.95), whole.values[0], errors[0]);
    assert_half_width(found[0].gain.interval(0.95), whole.values[1], errors[1]);
    let fine: Vec<f64> = (0..20_000).map(|n| omega[0] + n as f64 * 1e-3).collect();
    let response = fit.model.frequency_response(0, 0, &fine).unwrap();
    let peak = response.peak(1.0, 19.0).unwrap();
    assert!((found[0].omega_rad_s.value / peak.omega_rad_s - 1.0).abs() < 1e-4, "{}", peak.omega_rad_s / TAU);
    assert_eq!(Features::of_model(&fit.model, 0, 0).resonances(&omega).unwrap()[0].gain.interval(0.95), None);
}

/// ω₀²/(s² + 2ζω₀s + ω₀²) peaks at ω₀√(1 − 2ζ²), whatever points the grid has beside it.
#[test]
fn exact_resonances_of_any_damping() {
    for damping in [0.001, 0.01, 0.05, 0.096, 0.098, 0.1, 0.102, 0.104, 0.106, 0.108, 0.2, 0.3] {
        let channel = RationalChannel::new(vec![100.0], vec![20.0 * damping, 100.0], 0.0).unwrap();
        let model = TransferFunctionModel::new(vec![channel], 1, Mat::identity(1, 1)).unwrap();
        let omega = lti::TransferFunction::continuous(vec![100.0], vec![1.0, 20.0 * damping, 100.0]).unwrap();
        let omega = omega.frequency_grid(400).unwrap();
        let found = Features::of_model(&model, 0, 0).resonances(&omega).unwrap();
        let peak = 10.0 * (1.0 - 2.0 * damping * damping).sqrt();
        assert!((found[0].omega_rad_s.value / peak - 1.0).abs() < 1e-8, "{damping}: {:?}", found[0].omega_rad_s);
    }
}

#[test]
fn exact_steps_are_summed_up_where_they_end() {
    let fitted = fit(&[-1.5, 0.7], 1e-4);
    let grid = TimeGrid { step_s: T, points: 200 };
    let step = Features::of_fit(&fitted, 0, 0).step(&grid).unwrap().unwrap();
    assert!((step.final_value.value - 7.5).abs() < 1e-9);
    let rise = step.rise_time_s.unwrap();
    let (low, high) = rise.interval(0.95).unwrap();
    assert!(low < rise.value && rise.value < high && high / low < 1.01);
    assert!(step.overshoot_percent.value > 20.0 && step.settling_time_s.is_some());
    let unstable = fit(&[-2.1, 1.2], 1e-6);
    assert_eq!(Features::of_fit(&unstable, 0, 0).step(&grid).unwrap(), None);
    let integrating = fit(&[-1.0, 0.0], 0.0);
    assert_eq!(Features::of_fit(&integrating, 0, 0).dc_gain().unwrap(), None);
    assert_eq!(Features::of_fit(&integrating, 0, 0).step(&grid).unwrap(), None);
}

/// Two inertias on a shaft turn freely: rounding puts a pole beside zero.
#[test]
fn regress_the_pole_of_an_integrator_is_at_rest() {
    let a = faer::mat![[-8.0, 8.0, -3333.3], [16.0, -16.0, 6666.7], [1.0, -1.0, 0.0]];
    let system =
        lti::StateSpace::continuous(a, faer::mat![[1.7], [0.0], [0.0]], faer::mat![[1.0, 0.0, 0.0]], faer::mat![[0.0]])
            .unwrap();
    assert!(system.has_pole_at_rest().unwrap() && system.growing_mode().unwrap().is_none());
    let settled = lti::settled(&system.poles().unwrap(), None);
    assert_eq!(settled.iter().filter(|(pole, is_at_rest)| *is_at_rest && pole.norm() == 0.0).count(), 1);
}
