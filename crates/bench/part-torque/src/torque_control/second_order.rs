//! Torque control beyond delay and lag: e^{−sτ}/(1 + s/a + κ (s/a)²), with κ = 1/(4ζ²) for a damping ζ.
//!
//! κ is zero for a lag, 1/4 for a critically damped loop, 1/2 for one of damping 0.7. Near zero it cannot be separated
//! from a delay: to first order a second pole far off is one, (s/a)²/(1 + s/a)² being the sum of what τ and a do. So κ
//! has no standard error at zero, and tests of it compare whole fits.

use std::ops::RangeInclusive;

use faer::Mat;
use ident::distributions::f_tail;
use ident::{Bounds, IdentError, Minimum, least_squares};
use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};
use signal::Complex64;

use super::held::{HeldDemand, Mode};
use super::model::statistics;
use super::observed::Observed;
use super::rippled::{DelayAndLag, Response, RippledModel};
use super::search::fit_with_lines;
use crate::torque_control::bounds::{EARLIEST_S, LAG_RAD_S, LONGEST_DELAY_S};

/// κ of a critically damped loop, two equal lags.
pub const CRITICALLY_DAMPED: f64 = 0.25;
/// Range of κ: below, the second pole is so fast that it is a delay.
const TERM: RangeInclusive<f64> = 0.01..=2.0;
/// κ from which it is looked for.
const STARTS: [f64; 3] = [0.05, 0.25, 0.6];
/// Two poles nearer to each other than this part of their size are taken apart by it: for equal ones there is no sum of
/// modes.
const APART: f64 = 1e-5;
/// Steps of the differences by τ (s), a and κ (in parts of them).
const STEPS: [f64; 3] = [1e-8, 1e-5, 1e-5];

/// A torque control of second order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SecondOrder {
    /// τ, s.
    pub delay_s: f64,
    /// a, rad/s.
    pub(crate) lag_rad_s: f64,
    /// κ.
    pub term: f64,
}

impl SecondOrder {
    /// T_d at any instants, from the present and the past of the demand.
    pub(crate) fn torque_at(&self, held: &HeldDemand, times_s: &[f64]) -> Vec<f64> {
        let mode = |rate: Complex64| -> Vec<Complex64> {
            let mut mode = Mode::new(held);
            mode.set_rate(rate);
            times_s.iter().map(|t| mode.at(*t, self.delay_s).value).collect()
        };
        if self.term == 0.0 {
            return mode(Complex64::from(self.lag_rad_s)).iter().map(|x| x.re).collect();
        }
        let (first, second) = self.rates();
        let (one, other) = (mode(first), mode(second));
        one.iter().zip(&other).map(|(x, y)| ((second * x - first * y) / (second - first)).re).collect()
    }

    /// The rates a_1 and a_2 of a_1 a_2/((s + a_1)(s + a_2)).
    fn rates(&self) -> (Complex64, Complex64) {
        let root = Complex64::from(1.0 - 4.0 * self.term).sqrt();
        let root = if root.norm() < APART { Complex64::from(APART) } else { root };
        let scale = self.lag_rad_s / (2.0 * self.term);
        ((1.0 - root) * scale, (1.0 + root) * scale)
    }

    fn of(parameters: &[f64]) -> Self {
        SecondOrder { delay_s: parameters[0], lag_rad_s: parameters[1], term: parameters[2] }
    }
}

/// [`SecondOrder`] as a response; θ = (τ, a, κ).
struct DelayAndSecondOrder<'a>(&'a HeldDemand);

impl Response for DelayAndSecondOrder<'_> {
    fn parameter_count(&self) -> usize {
        3
    }

    fn evaluate(
        &mut self,
        parameters: &[f64],
        times_s: &[f64],
        values: &mut [f64],
        derivatives: Option<&mut [Vec<f64>]>,
    ) {
        let at = |parameters: &[f64]| SecondOrder::of(parameters).torque_at(self.0, times_s);
        values.copy_from_slice(&at(parameters));
        for (j, column) in derivatives.into_iter().flatten().enumerate() {
            let step = if j == 0 { STEPS[0] } else { STEPS[j] * parameters[j] };
            let moved = |by: f64| {
                let mut moved = parameters.to_vec();
                moved[j] += by;
                at(&moved)
            };
            let (above, below) = (moved(step), moved(-step));
            column.iter_mut().zip(above.iter().zip(&below)).for_each(|(d, (a, b))| *d = (a - b) / (2.0 * step));
        }
    }
}

/// Test of a recording for more than delay and lag.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SecondOrderTest {
    /// τ of the fit with κ, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub delay_s: f64,
    /// a of the fit with κ, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub lag_rad_s: f64,
    /// κ, between 0.01 and 2.
    #[serde(deserialize_with = "nan_if_null")]
    pub term: f64,
    /// Probability that noise makes κ explain as much more as it does where the torque control is a delay and a lag.
    #[serde(deserialize_with = "nan_if_null")]
    pub lag_p_value: f64,
    /// The same where it is critically damped, κ = 1/4.
    #[serde(deserialize_with = "nan_if_null")]
    pub damped_p_value: f64,
    /// True where the residuals of the fit with κ are white, for which the probabilities hold.
    pub white: bool,
}

/// Tests κ = 0 and κ = 1/4 against any κ, on T_d without ripple, from this delay (s) and lag (rad/s) on.
///
/// # Errors
/// No fit.
///
/// # Source
/// Ljung 1999, §16.4 (F-test of a model within a larger one).
pub(super) fn test(
    held: &HeldDemand,
    observed: &Observed,
    delay_s: f64,
    lag_rad_s: f64,
) -> Result<SecondOrderTest, IdentError> {
    let lag = fit_with_lines(
        &mut RippledModel::new(DelayAndLag::new(held), observed),
        &[delay_s, lag_rad_s],
        &response_bounds(),
        &[],
    )?;
    let damped = with_term(held, observed, &lag, CRITICALLY_DAMPED, Bounds::new(CRITICALLY_DAMPED, CRITICALLY_DAMPED))?;
    let mut best = damped.clone();
    for start in STARTS {
        let found = with_term(held, observed, &lag, start, Bounds::new(*TERM.start(), *TERM.end()))?;
        best = if found.cost < best.cost { found } else { best };
    }
    let freedom = observed.len() as f64 - 4.0;
    let p_value = |smaller: &Minimum| f_tail((smaller.cost / best.cost - 1.0).max(0.0) * freedom, 1.0, freedom);
    let control = SecondOrder::of(&best.parameters);
    Ok(SecondOrderTest {
        delay_s: control.delay_s,
        lag_rad_s: control.lag_rad_s,
        term: control.term,
        lag_p_value: p_value(&lag),
        damped_p_value: p_value(&damped),
        white: statistics(&best.residuals, observed)?.white,
    })
}

fn response_bounds() -> Vec<Bounds> {
    vec![Bounds::new(-EARLIEST_S, LONGEST_DELAY_S), Bounds::new(*LAG_RAD_S.start(), *LAG_RAD_S.end())]
}

fn with_term(
    held: &HeldDemand,
    observed: &Observed,
    lag: &Minimum,
    start: f64,
    term: Bounds,
) -> Result<Minimum, IdentError> {
    let mut bounds = response_bounds();
    bounds.push(term);
    let start = [lag.parameters[0], lag.parameters[1], start];
    fit_with_lines(&mut RippledModel::new(DelayAndSecondOrder(held), observed), &start, &bounds, &[])
}

/// Standard errors of τ (s) and a (rad/s) beside each other and an offset, for white noise of one Nm on each sample.
///
/// # Errors
/// Instants that do not separate them.
///
/// # Source
/// Ljung 1999, §7.4 (Cramér–Rao bound).
pub(crate) fn lag_errors(
    held: &HeldDemand,
    times_s: &[f64],
    delay_s: f64,
    lag_rad_s: f64,
) -> Result<(f64, f64), IdentError> {
    let errors = standard_errors(&mut DelayAndLag::new(held), times_s, &[delay_s, lag_rad_s])?;
    Ok((errors[0], errors[1]))
}

/// Standard error of κ beside τ, a and an offset, for white noise of one Nm on each sample.
///
/// # Errors
/// Instants that do not separate them.
pub(crate) fn term_error(held: &HeldDemand, times_s: &[f64], truth: SecondOrder) -> Result<f64, IdentError> {
    let theta = [truth.delay_s, truth.lag_rad_s, truth.term];
    standard_errors(&mut DelayAndSecondOrder(held), times_s, &theta).map(|errors| errors[2])
}

/// Root of the sum of squares, in Nm, by which the torque differs from the delay and lag that come nearest to it: for
/// white noise of one Nm, the root of the noncentrality of the test of κ = 0.
///
/// # Errors
/// No fit.
pub(crate) fn distance_from_lag(held: &HeldDemand, times_s: &[f64], truth: SecondOrder) -> Result<f64, IdentError> {
    let sample_time_s = times_s.windows(2).next().map_or(1.0, |pair| pair[1] - pair[0]);
    let observed = Observed::of_samples(times_s, truth.torque_at(held, times_s), sample_time_s);
    let mut lag = RippledModel::new(DelayAndLag::new(held), &observed);
    let nearest = fit_with_lines(&mut lag, &[truth.delay_s, truth.lag_rad_s], &response_bounds(), &[])?;
    Ok(nearest.cost.sqrt())
}

fn standard_errors<R: Response>(response: &mut R, times_s: &[f64], parameters: &[f64]) -> Result<Vec<f64>, IdentError> {
    let (rows, count) = (times_s.len(), response.parameter_count());
    let (mut values, mut derivatives) = (vec![0.0; rows], vec![vec![0.0; rows]; count]);
    response.evaluate(parameters, times_s, &mut values, Some(&mut derivatives));
    let columns = Mat::from_fn(rows, count + 1, |i, j| derivatives.get(j).map_or(1.0, |column| column[i]));
    let solved = least_squares(columns.as_ref(), &vec![0.0; rows])?;
    Ok((0..count).map(|k| solved.unscaled_covariance[(k, k)].sqrt()).collect())
}

#[cfg(test)]
mod tests {
    use signal::Signal;

    use super::*;

    fn demand() -> HeldDemand {
        let mut random = signal::excitation::Random::new(3);
        let levels: Vec<f64> = (0..100).map(|_| random.normal()).collect();
        let samples = (0..900).map(|i| levels[i / 9]).collect();
        HeldDemand::new(&Signal { start_s: 0.0, sample_time_s: 1e-3, samples }, None)
    }

    fn times() -> Vec<f64> {
        (30..220).map(|i| 4e-3 * f64::from(i) + 1e-4).collect()
    }

    /// By small steps of the differential equation.
    #[test]
    fn exact_response_of_second_order_whatever_the_damping() {
        let held = demand();
        for term in [0.1, 0.25, 0.5, 1.5] {
            let control = SecondOrder { delay_s: 1.3e-3, lag_rad_s: 500.0, term };
            let modelled = control.torque_at(&held, &times());
            let (step, a) = (1e-6, 500.0);
            let (mut x, mut v, mut n) = (held.at(0.0), 0.0, 0_usize);
            for (t, m) in times().iter().zip(&modelled) {
                while (n as f64) * step < *t {
                    let u = held.at((n as f64 + 0.5) * step - control.delay_s);
                    v += step * ((u - x) * a * a / term - v * a / term);
                    x += step * v;
                    n += 1;
                }
                assert!((x - m).abs() < 6e-3, "{term}: {x}, {m} at {t}");
            }
        }
    }

    #[test]
    fn exact_term_of_noise_free_torque() {
        let held = demand();
        for term in [0.1, 0.25, 0.5] {
            let truth = SecondOrder { delay_s: 1.3e-3, lag_rad_s: 500.0, term };
            let torque = truth.torque_at(&held, &times());
            let observed = Observed::of_samples(&times(), torque, 4e-3);
            let found = super::test(&held, &observed, 1.3e-3, 500.0).unwrap();
            assert!((found.term - term).abs() < 1e-3 && (found.lag_rad_s - 500.0).abs() < 0.5, "{found:?}");
            assert!(found.lag_p_value < 1e-6);
        }
    }
}
