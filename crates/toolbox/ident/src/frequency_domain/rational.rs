//! Transfer functions, continuous or discrete, from frequency data.

use faer::Mat;
use lti::{FrequencyResponse, LtiError, StateSpace, TransferFunction};
use signal::Complex64;

use super::basis::Basis;
use super::data::{Lines, Measured};
use super::misfit::{Misfit, Response, SpectralFit, search, spectral_fit};
use super::start;
use crate::continuous::RationalChannel;
use crate::uncertainty::{Dynamics, Ratio};
use crate::{Bounds, Doubt, IdentError, NonlinearOptions, Parametric};
use fitting::{StructureError, UnstablePart};

/// Delays tried to start from.
const DELAYS: usize = 41;

/// A transfer function by its coefficients, continuous or discrete:
/// `G(x) = (b_m x^m + … + b₀) / (x^n + a_{n−1} x^{n−1} + … + a₀) · e^{−jω·delay}`, `x = jω` or `x = e^{jωT}`.
#[derive(Debug, Clone, PartialEq)]
pub struct RationalResponse {
    coefficients: RationalChannel,
    sample_time_s: Option<f64>,
}

impl RationalResponse {
    /// The transfer function.
    ///
    /// # Errors
    /// None for an estimate; the type is that of [`TransferFunction::new`].
    pub fn transfer_function(&self) -> Result<TransferFunction, LtiError> {
        self.coefficients.on_clock(self.sample_time_s)
    }
}

impl Dynamics for RationalResponse {
    fn system(&self) -> Result<StateSpace, LtiError> {
        self.transfer_function()?.with_delay(0.0)?.to_state_space()
    }

    fn delay_s(&self, _output: usize, _input: usize) -> Result<f64, LtiError> {
        Ok(self.transfer_function()?.delay_s())
    }

    fn polynomials(&self, _output: usize, _input: usize) -> Result<Option<Ratio>, LtiError> {
        let g = self.transfer_function()?;
        Ok(Some(Ratio { numerator: g.num().to_vec(), denominator: g.den().to_vec() }))
    }

    fn frequency_response(
        &self,
        _output: usize,
        _input: usize,
        omega_rad_s: &[f64],
    ) -> Result<FrequencyResponse, LtiError> {
        self.transfer_function()?.frequency_response(omega_rad_s)
    }
}

impl Parametric for RationalResponse {
    fn parameters(&self) -> Vec<f64> {
        self.coefficients.parameters()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.coefficients.parameter_names()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        let changed = RationalResponse { coefficients: self.coefficients.with_parameters(parameters)?, ..self.clone() };
        changed.transfer_function().map(|_| changed)
    }
}

/// Estimates a transfer function from a frequency response or from spectra, weighted by their noise: the maximum
/// likelihood, which minimises `Σ_k |Y_k − G(ω_k) U_k|²/σ_k²`, `σ² = σ_y² + |G|² σ_u² − 2 Re(G* σ_yu)`.
///
/// Iterated weighted linear least squares in polynomials orthogonal over the data give the starting values, and the
/// search runs in such polynomials, so that orders of six to eight over several decades are well conditioned. The delay
/// is given, or found between bounds.
///
/// # Example
/// ```
/// use ident::{FrequencyData, FrequencyTransferFunction};
/// let truth = lti::TransferFunction::continuous(vec![5.0], vec![1.0, 0.4, 4.0])?;
/// let omega_rad_s: Vec<f64> = (1..60).map(|k| 0.1 * f64::from(k)).collect();
/// let response = truth.frequency_response(&omega_rad_s)?.response;
/// let data = FrequencyData { variance: vec![1e-4; 59], averages: None, shared_noise: None, omega_rad_s, response };
/// let found = FrequencyTransferFunction::continuous(0, 2).fit(&data)?;
/// let g = found.fit.model.transfer_function()?;
/// assert!((g.den()[1] - 0.4).abs() < 1e-9 && (g.num()[0] - 5.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Source
/// Pintelon & Schoukens 2012, ch. 9 (maximum likelihood, iterative weighted linear least squares); Sanathanan &
/// Koerner, IEEE Trans. Autom. Control 8, 1963.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyTransferFunction {
    numerator_degree: usize,
    poles: usize,
    sample_time_s: Option<f64>,
    delay_s: (f64, f64),
    stable: bool,
    search: NonlinearOptions,
}

impl FrequencyTransferFunction {
    /// In s, with a numerator of this degree and so many poles.
    pub fn continuous(numerator_degree: usize, poles: usize) -> Self {
        let search = NonlinearOptions::default();
        FrequencyTransferFunction {
            numerator_degree,
            poles,
            sample_time_s: None,
            delay_s: (0.0, 0.0),
            stable: false,
            search,
        }
    }

    /// In z, on a sample time in seconds.
    pub fn discrete(numerator_degree: usize, poles: usize, sample_time_s: f64) -> Self {
        FrequencyTransferFunction { sample_time_s: Some(sample_time_s), ..Self::continuous(numerator_degree, poles) }
    }

    /// A known delay in seconds.
    #[must_use]
    pub fn with_delay(self, delay_s: f64) -> Self {
        FrequencyTransferFunction { delay_s: (delay_s, delay_s), ..self }
    }

    /// A delay to be found between bounds in seconds.
    #[must_use]
    pub fn with_delay_between(self, low_s: f64, high_s: f64) -> Self {
        FrequencyTransferFunction { delay_s: (low_s, high_s), ..self }
    }

    /// Keeps every pole stable.
    #[must_use]
    pub fn stable(self) -> Self {
        FrequencyTransferFunction { stable: true, ..self }
    }

    /// How far and how exactly to search.
    #[must_use]
    pub fn with_search(self, search: NonlinearOptions) -> Self {
        FrequencyTransferFunction { search, ..self }
    }

    /// Estimates the transfer function.
    ///
    /// # Errors
    /// Those of [`Measured::lines`]; [`IdentError::TooFewSamples`]; [`IdentError::SampleTime`];
    /// [`IdentError::Structure`] for bounds that are no range, or where no (stable) starting value is found;
    /// [`IdentError::RankDeficient`] where the data do not determine every coefficient.
    pub fn fit(&self, data: &impl Measured) -> Result<SpectralFit<RationalResponse>, IdentError> {
        let lines = data.lines()?;
        self.check(&lines)?;
        let points = self.points(&lines);
        let start = self.start(&lines, &points)?;
        let rational = Rational::about(&lines, &start, self.stable.then_some(self.sample_time_s.is_some()));
        let theta = rational.theta(&start);
        let mut bounds = vec![Bounds::NONE; theta.len() - 1];
        bounds.push(Bounds::new(self.delay_s.0, self.delay_s.1));
        let mut misfit = Misfit::new(&lines, rational);
        let (minimum, covariance) = search(&mut misfit, &theta, &bounds, self.search)?;
        let (parameters, jacobian) = misfit.response.coefficients(&minimum.parameters, self.scale(&lines))?;
        let m = self.numerator_degree + 1;
        let model = RationalResponse {
            coefficients: RationalChannel::new(
                parameters[..m].to_vec(),
                parameters[m..m + self.poles].to_vec(),
                parameters[m + self.poles],
            )?,
            sample_time_s: self.sample_time_s,
        };
        let covariance = &jacobian * covariance * jacobian.transpose();
        let inside = |p: &Complex64| if self.sample_time_s.is_some() { p.norm() < 1.0 } else { p.re < 0.0 };
        let stable = model.transfer_function()?.poles()?.iter().all(inside);
        let mut found = spectral_fit(&lines, model, covariance, &minimum);
        if !stable {
            found.fit.doubts.push(Doubt::Unstable);
        }
        if minimum.at_bound[theta.len() - 1] && self.delay_s.0 < self.delay_s.1 {
            found.fit.doubts.push(Doubt::AtBound { parameter: m + self.poles });
        }
        Ok(found)
    }

    fn check(&self, lines: &Lines) -> Result<(), IdentError> {
        let parameters = self.numerator_degree + 1 + self.poles + usize::from(self.delay_s.0 < self.delay_s.1);
        let samples = 2 * lines.lines.len();
        if samples <= parameters {
            return Err(IdentError::TooFewSamples { samples, parameters });
        }
        if let Some(sample_time_s) = self.sample_time_s
            && !(sample_time_s > 0.0 && sample_time_s.is_finite())
        {
            return Err(IdentError::SampleTime { sample_time_s });
        }
        crate::continuous::check_delays(&[self.delay_s])
    }

    /// Frequency that continuous ones are counted in.
    fn scale(&self, lines: &Lines) -> f64 {
        let highest = lines.lines.iter().map(|l| l.omega).fold(0.0, f64::max);
        if self.sample_time_s.is_some() || highest == 0.0 { 1.0 } else { highest }
    }

    fn points(&self, lines: &Lines) -> Vec<Complex64> {
        let scale = self.scale(lines);
        let point = |l: &super::data::Line| match self.sample_time_s {
            None => Complex64::new(0.0, l.omega / scale),
            Some(t) => Complex64::cis(l.omega * t),
        };
        lines.lines.iter().map(point).collect()
    }

    /// The best start over a grid of delays.
    fn start(&self, lines: &Lines, points: &[Complex64]) -> Result<start::Start, IdentError> {
        let (low, high) = self.delay_s;
        let count = if low < high { DELAYS } else { 1 };
        let step = if low < high { (high - low) / (DELAYS - 1) as f64 } else { 0.0 };
        let stable = self.stable.then_some(self.sample_time_s.is_some());
        let mut best: Option<start::Start> = None;
        for i in 0..count {
            let delay_s = (low + i as f64 * step).min(high);
            let orders = (self.numerator_degree, self.poles);
            let Some(found) = start::start(lines, points, orders, delay_s, stable) else { continue };
            if best.as_ref().is_none_or(|b| found.cost < b.cost) {
                best = Some(found);
            }
        }
        best.ok_or(StructureError::NoStart.into())
    }
}

/// `Σ θ_j p_j / Σ θ_j q_j e^{−jωτ}` in orthonormal polynomials, one denominator coefficient being held.
pub(crate) struct Rational {
    num: Basis,
    den: Basis,
    pivot: usize,
    held: f64,
    omega: Vec<f64>,
    /// Poles must be stable; in z where true.
    stable: Option<bool>,
}

impl Rational {
    fn about(lines: &Lines, start: &start::Start, stable: Option<bool>) -> Self {
        let (num, den) = (start.num.clone(), start.den.clone());
        let pivot = (0..start.a.len()).max_by(|i, j| start.a[*i].abs().total_cmp(&start.a[*j].abs())).unwrap_or(0);
        let omega = lines.lines.iter().map(|l| l.omega).collect();
        Rational { num, den, pivot, held: start.a[pivot], omega, stable }
    }

    fn theta(&self, start: &start::Start) -> Vec<f64> {
        let free = start.a.iter().enumerate().filter(|(j, _)| *j != self.pivot).map(|(_, a)| *a);
        start.b.iter().copied().chain(free).chain([start.delay_s]).collect()
    }

    /// Coefficients of numerator and denominator in the bases, and the delay.
    fn split<'t>(&self, theta: &'t [f64]) -> (&'t [f64], Vec<f64>, f64) {
        let m = self.num.values.len();
        let mut a = theta[m..theta.len() - 1].to_vec();
        a.insert(self.pivot, self.held);
        (&theta[..m], a, theta[theta.len() - 1])
    }

    /// `b_m … b₀, a_{n−1} … a₀, delay` in SI, and their derivatives by θ.
    fn coefficients(&self, theta: &[f64], scale: f64) -> Result<(Vec<f64>, Mat<f64>), IdentError> {
        let (b, a, delay_s) = self.split(theta);
        let (m, n) = (b.len(), a.len());
        let power = |basis: &Basis, j: usize, i: usize| {
            basis.coefficients[j].get(i).copied().unwrap_or(0.0) / scale.powi(i as i32)
        };
        let sum = |basis: &Basis, theta: &[f64], i: usize| -> f64 {
            theta.iter().enumerate().map(|(j, t)| t * power(basis, j, i)).sum()
        };
        let lead = sum(&self.den, &a, n - 1);
        let mut values: Vec<f64> = (0..m).rev().map(|i| sum(&self.num, b, i) / lead).collect();
        values.extend((0..n - 1).rev().map(|i| sum(&self.den, &a, i) / lead));
        values.push(delay_s);
        if values.iter().any(|v| !v.is_finite()) {
            return Err(StructureError::LostDegree.into());
        }
        let mut jacobian = Mat::zeros(m + n, m + n);
        for j in 0..m {
            (0..m).for_each(|i| jacobian[(m - 1 - i, j)] = power(&self.num, j, i) / lead);
        }
        for (column, j) in (0..n).filter(|j| *j != self.pivot).enumerate() {
            let of_lead = power(&self.den, j, n - 1) / lead;
            (0..m).for_each(|i| jacobian[(i, m + column)] = -values[i] * of_lead);
            for i in 0..n - 1 {
                let row = m + n - 2 - i;
                jacobian[(row, m + column)] = power(&self.den, j, i) / lead - values[row] * of_lead;
            }
        }
        jacobian[(m + n - 1, m + n - 1)] = 1.0;
        Ok((values, jacobian))
    }
}

impl Response for Rational {
    fn parameter_count(&self) -> usize {
        self.num.values.len() + self.den.values.len()
    }

    fn respond(
        &mut self,
        theta: &[f64],
        gains: &mut [Complex64],
        slopes: Option<&mut Mat<Complex64>>,
    ) -> Result<(), IdentError> {
        let (b, a, delay_s) = self.split(theta);
        if let Some(discrete) = self.stable
            && !start::is_stable(&self.den, &a, discrete)
        {
            return Err(StructureError::Unstable(UnstablePart::Model).into());
        }
        let mut slopes = slopes;
        for k in 0..gains.len() {
            let late = Complex64::cis(-self.omega[k] * delay_s);
            let den = self.den.at(&a, k);
            let gain = self.num.at(b, k) / den * late;
            gains[k] = gain;
            let Some(slopes) = slopes.as_mut() else { continue };
            let m = b.len();
            (0..m).for_each(|j| slopes[(k, j)] = self.num.values[j][k] / den * late);
            let free = (0..a.len()).filter(|j| *j != self.pivot);
            free.enumerate().for_each(|(column, j)| slopes[(k, m + column)] = -gain * self.den.values[j][k] / den);
            slopes[(k, theta.len() - 1)] = Complex64::new(0.0, -self.omega[k]) * gain;
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::ResidualModel;
    use crate::frequency_domain::SpectralData;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn prop_gradient_equals_differences(
            zeros in 0_usize..2, poles in 1_usize..3, delay in 0.0_f64..0.03, slow in 0.6_f64..0.8, fast in 1.0_f64..1.2,
        ) {
            check(FrequencyTransferFunction::continuous(zeros.min(poles), poles).with_delay(delay), slow, fast);
        }
    }

    /// The slopes at the start of a search through spectra that wave at these rates.
    fn check(options: FrequencyTransferFunction, slow: f64, fast: f64) {
        let count = 40;
        let wave = |k: usize, a: f64| Complex64::new((a * k as f64).sin() + 1.5, (a * k as f64).cos());
        let data = SpectralData {
            omega_rad_s: (1..=count).map(|k| 0.3 * k as f64).collect(),
            input: (0..count).map(|k| wave(k, slow)).collect(),
            output: (0..count).map(|k| wave(k, fast)).collect(),
            input_variance: vec![0.3; count],
            output_variance: vec![0.2; count],
            covariance: (0..count).map(|k| 0.05 * wave(k, 0.2)).collect(),
            averages: None,
        };
        let lines = data.lines().unwrap();
        let points = options.points(&lines);
        let start = options.start(&lines, &points).unwrap();
        let rational = Rational::about(&lines, &start, None);
        let theta = rational.theta(&start);
        let mut misfit = Misfit::new(&lines, rational);
        let mut jacobian = Mat::zeros(2 * count, theta.len());
        misfit.evaluate(&theta, &mut vec![0.0; 2 * count], Some(jacobian.as_mut())).unwrap();
        let mut at = |point: &[f64]| {
            let mut residuals = vec![0.0; 2 * count];
            misfit.evaluate(point, &mut residuals, None).unwrap();
            residuals
        };
        for j in 0..theta.len() {
            let step = 1e-6 * theta[j].abs().max(1e-3);
            let moved = |sign: f64| {
                let mut point = theta.clone();
                point[j] += sign * step;
                point
            };
            let (above, below) = (at(&moved(1.0)), at(&moved(-1.0)));
            for i in 0..2 * count {
                let difference = (above[i] - below[i]) / (2.0 * step);
                assert!((difference - jacobian[(i, j)]).abs() < 1e-5 * jacobian.col(j).norm_max(), "{i} {j}");
            }
        }
    }
}
