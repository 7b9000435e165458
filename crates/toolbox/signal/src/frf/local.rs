//! Local polynomial and local rational models: response, transient and noise from a few neighbouring bins.

use serde::{Deserialize, Serialize};

use super::least_squares::LeastSquares;
use super::{FrequencyResponse, check_records, check_some};
use crate::Complex64;
use crate::error::{SignalError, check_at_least, check_range};
use crate::spectrum::fft_real;

/// Local model of response and transient near a frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum LocalKind {
    /// Polynomials in frequency: unbiased by noise, right where the response is smooth over the window.
    Polynomial,
    /// Polynomials over a common one for each output: follows sharp resonances. Linear least squares with the noisy
    /// output among the regressors: the response scatters somewhat more than stated, at order two by about 20 % in
    /// variance at a resonance that stands out from the noise, and by 40 % where a polynomial would do and noise alone
    /// determines the denominator.
    Rational,
}

/// Frequency response, transient and noise variance at each bin `k` of the discrete Fourier transform, from the bins
/// `k − n ..= k + n`:
/// `Y(k+r) = G(k+r) U(k+r) + T(k+r) + V(k+r)`, with `G` and `T` polynomials of `order` in `r` (or such polynomials over
/// `1 + a₁r + … + a_R r^R`) by least squares.
///
/// The transient `T` is what makes a record of finite length not periodic; taking it along removes leakage. Estimates
/// closer than `2n` bins share data and so are correlated. At both ends of the frequency axis the window stays inside
/// and `k` is off its centre. The bins at rest and at half the sample rate are not used: offsets do no harm.
///
/// # Example
/// ```
/// use signal::excitation::{Random, Timing, held_noise};
/// use signal::frf::LocalModel;
/// let u = held_noise(&mut Random::new(1), Timing { sample_time_s: 0.01, length: 2000 }, 0.0, 1.0, 0.01)?;
/// let low = signal::Sos::butterworth_lowpass(2, 10.0, 0.01)?;
/// let y = low.filter(&u.samples, &mut low.state_at_rest());
/// let found = LocalModel::polynomial(2, 1).estimate(&[&u.samples], &[&y], 0.01)?.response;
/// let k = 200;
/// assert!((found.response[k] - low.response(found.freq_hz[k])).norm() < 1e-4);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Pintelon and Schoukens (2012), *System Identification: A Frequency Domain Approach*, ch. 7, (7-10) to (7-25);
/// rational: McKelvey and Guérin (2012), IFAC SYSID 16, 398–403.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct LocalModel {
    /// Polynomials, or polynomials over a common one.
    pub kind: LocalKind,
    /// Order `R` of every polynomial; two is usual.
    pub order: usize,
    /// Bins `n` on each side; `2n + 1` must exceed the number of unknowns.
    pub half_width: usize,
    /// True if the transient is modelled. Without it the record must be periodic or begin and end at rest.
    pub transient: bool,
}

/// Result of a [`LocalModel`].
#[derive(Debug, Clone, PartialEq)]
pub struct LocalEstimate {
    /// The response and its variance from noise on the outputs.
    pub response: FrequencyResponse,
    /// One-sided power density of the noise of each output, (unit of output)²/Hz; output `i` at frequency `k` is at
    /// `k · outputs + i`.
    pub noise_density: Vec<f64>,
    /// Complex degrees of freedom of each noise density: its relative standard deviation is one over their root.
    pub degrees_of_freedom: usize,
    /// The bin that the window of each frequency begins with.
    pub first_bin: Vec<usize>,
    /// The error of each response is a weighted sum of the noise in the bins of its window, `Σ_i w_i V(first_bin + i)`,
    /// which other windows share. That of output `i` from input `j` at frequency `k` has its `2 · half_width + 1`
    /// weights from `((k · outputs + i) · inputs + j) · (2 · half_width + 1)` on.
    pub noise_weights: Vec<Complex64>,
}

impl LocalModel {
    /// Local polynomials with transient, of this order for this many inputs, over a window with six or seven degrees of
    /// freedom.
    #[must_use]
    pub fn polynomial(order: usize, inputs: usize) -> Self {
        Self::with_enough_bins(LocalKind::Polynomial, order, inputs)
    }

    /// Local rational models with transient, of this order for this many inputs, over a window with six or seven
    /// degrees of freedom.
    #[must_use]
    pub fn rational(order: usize, inputs: usize) -> Self {
        Self::with_enough_bins(LocalKind::Rational, order, inputs)
    }

    fn with_enough_bins(kind: LocalKind, order: usize, inputs: usize) -> Self {
        let model = Self { kind, order, half_width: 0, transient: true };
        Self { half_width: (model.unknowns(inputs) + 6) / 2, ..model }
    }

    /// Unknowns an output.
    fn unknowns(self, inputs: usize) -> usize {
        let numerators = (self.order + 1) * (inputs + usize::from(self.transient));
        numerators + if self.kind == LocalKind::Rational { self.order } else { 0 }
    }

    /// The estimate from one record of inputs and outputs, each a slice of samples.
    ///
    /// Bins where the inputs do not determine the response (no power, or one input a combination of the others over the
    /// window) are left out of the result.
    ///
    /// # Errors
    /// [`SignalError::TooShort`] without an input or an output, or fewer bins than a window;
    /// [`SignalError::Parameter`] for an order above 20 or a window too narrow for the unknowns;
    /// [`SignalError::NotExcited`] where no bin is left; [`SignalError::LengthMismatch`], [`SignalError::NonFinite`],
    /// [`SignalError::SampleTime`].
    pub fn estimate(
        self,
        inputs: &[&[f64]],
        outputs: &[&[f64]],
        sample_time_s: f64,
    ) -> Result<LocalEstimate, SignalError> {
        check_some(inputs)?;
        check_some(outputs)?;
        let length = check_records(&[inputs, outputs].concat(), sample_time_s)?;
        check_range("order", self.order as f64, 0.0, 20.0)?;
        let least = (self.unknowns(inputs.len()) / 2).max(1);
        check_range("half_width", self.half_width as f64, least as f64, 1e6)?;
        check_at_least(4 * self.half_width + 3, length)?;
        let scale = 1.0 / (length as f64).sqrt();
        let transform = |x: &&[f64]| -> Result<Vec<Complex64>, SignalError> {
            Ok(fft_real(x)?.into_iter().map(|v| v * scale).collect())
        };
        let u = inputs.iter().map(transform).collect::<Result<Vec<_>, _>>()?;
        let y = outputs.iter().map(transform).collect::<Result<Vec<_>, _>>()?;
        self.run(&u, &y, length, sample_time_s)
    }

    fn run(
        self,
        u: &[Vec<Complex64>],
        y: &[Vec<Complex64>],
        length: usize,
        sample_time_s: f64,
    ) -> Result<LocalEstimate, SignalError> {
        let mut window = Window::new(self, u, y);
        let bin_hz = 1.0 / (length as f64 * sample_time_s);
        let mut response = FrequencyResponse::empty(y.len(), u.len());
        let (mut noise_density, mut first_bin, mut noise_weights) = (Vec::new(), Vec::new(), Vec::new());
        for k in work::checked(1..=(length - 1) / 2) {
            if window.solve(k, (length - 1) / 2) {
                response.freq_hz.push(k as f64 * bin_hz);
                response.response.extend_from_slice(&window.response);
                response.variance.extend_from_slice(&window.variance);
                first_bin.push(self.first_bin(k, (length - 1) / 2));
                noise_weights.extend_from_slice(&window.noise_weights);
                noise_density.extend(window.noise.iter().map(|v| 2.0 * sample_time_s * v));
            }
        }
        if response.freq_hz.is_empty() {
            return Err(SignalError::NotExcited { freq_hz: bin_hz });
        }
        let degrees_of_freedom = 2 * self.half_width + 1 - self.unknowns(u.len());
        response.degrees_of_freedom = vec![2.0 * degrees_of_freedom as f64; response.freq_hz.len()];
        Ok(LocalEstimate { response, noise_density, degrees_of_freedom, first_bin, noise_weights })
    }

    /// Where the window of bin `k` of `1 ..= last` begins.
    fn first_bin(self, k: usize, last: usize) -> usize {
        let width = 2 * self.half_width + 1;
        k.saturating_sub(self.half_width).clamp(1, last + 1 - width)
    }
}

/// The problem at one bin, with its memory.
struct Window<'a> {
    model: LocalModel,
    u: &'a [Vec<Complex64>],
    y: &'a [Vec<Complex64>],
    /// Power over a window below which an input counts as none: rounding.
    no_power: Vec<f64>,
    problem: LeastSquares,
    residual: Vec<Complex64>,
    unknowns: Vec<Complex64>,
    /// Factor on the noise at each bin in the equation's errors.
    denominators: Vec<Complex64>,
    weights: Vec<f64>,
    influence: Vec<Complex64>,
    response: Vec<Complex64>,
    variance: Vec<f64>,
    noise: Vec<f64>,
    noise_weights: Vec<Complex64>,
}

impl<'a> Window<'a> {
    fn new(model: LocalModel, u: &'a [Vec<Complex64>], y: &'a [Vec<Complex64>]) -> Self {
        let problem = LeastSquares::new(2 * model.half_width + 1, u.len());
        let strongest = |u: &Vec<Complex64>| u.iter().map(|v| v.norm_sqr()).fold(0.0, f64::max);
        let no_power = u.iter().map(|u| 1e-24 * strongest(u)).collect();
        Self {
            model,
            u,
            y,
            no_power,
            problem,
            residual: vec![],
            unknowns: vec![],
            denominators: vec![],
            weights: vec![],
            influence: vec![],
            response: vec![],
            variance: vec![],
            noise: vec![],
            noise_weights: vec![],
        }
    }

    /// Solves at bin `k` of `1 ..= last`; false where the response is not determined.
    fn solve(&mut self, k: usize, last: usize) -> bool {
        let first = self.model.first_bin(k, last);
        self.response.clear();
        self.variance.clear();
        self.noise.clear();
        self.noise_weights.clear();
        let shared = self.model.kind == LocalKind::Polynomial;
        for output in 0..self.y.len() {
            if (output == 0 || !shared) && !self.set_up(k, first, output) {
                return false;
            }
            self.solve_output(k, first, output);
        }
        true
    }

    /// Columns: inputs at order zero (their coefficients are the response at `k`), then the higher orders, the
    /// transient, and the common denominator.
    fn set_up(&mut self, k: usize, first: usize, output: usize) -> bool {
        let (model, width) = (self.model, 2 * self.model.half_width + 1);
        let power = |i: usize, s: usize| offset(k, first, i, model.half_width).powi(s as i32);
        let problem = &mut self.problem;
        problem.clear();
        let powered = |(u, least): (&Vec<Complex64>, &f64)| {
            u[first..first + width].iter().map(|v| v.norm_sqr()).sum::<f64>() > *least
        };
        let mut determined = self.u.iter().zip(&self.no_power).all(powered);
        for s in 0..=model.order {
            for u in self.u {
                determined &= problem.push(u[first..first + width].iter().enumerate().map(|(i, v)| v * power(i, s)));
            }
        }
        for s in 0..=model.order {
            if model.transient {
                determined &= problem.push((0..width).map(|i| Complex64::new(power(i, s), 0.0)));
            }
        }
        if model.kind == LocalKind::Rational {
            let y = &self.y[output][first..first + width];
            for s in 1..=model.order {
                determined &= problem.push(y.iter().enumerate().map(|(i, v)| -v * power(i, s)));
            }
        }
        determined
    }

    fn solve_output(&mut self, k: usize, first: usize, output: usize) {
        let (inputs, width) = (self.u.len(), 2 * self.model.half_width + 1);
        self.residual.clear();
        self.residual.extend_from_slice(&self.y[output][first..first + width]);
        self.problem.solve(&mut self.residual, &mut self.unknowns);
        let power: f64 = self.residual.iter().map(|v| v.norm_sqr()).sum();
        self.weigh(k, first);
        let noise = power / self.problem.expected_residual(&self.weights).max(f64::MIN_POSITIVE);
        self.response.extend_from_slice(&self.unknowns[..inputs]);
        for j in 0..inputs {
            self.problem.influence(j, &mut self.influence);
            self.influence.iter_mut().zip(&self.denominators).for_each(|(w, d)| *w *= d);
            self.variance.push(noise * self.influence.iter().map(|w| w.norm_sqr()).sum::<f64>());
            self.noise_weights.extend_from_slice(&self.influence);
        }
        self.noise.push(noise);
    }

    /// Variances of the equation's errors, for a noise of one: the errors are the noise times the denominator.
    fn weigh(&mut self, k: usize, first: usize) {
        let width = 2 * self.model.half_width + 1;
        let rational = self.model.kind == LocalKind::Rational;
        let order = if rational { self.model.order } else { 0 };
        let a = &self.unknowns[self.unknowns.len() - order..];
        let denominator = |i: usize| {
            let r = offset(k, first, i, self.model.half_width);
            a.iter().rev().fold(Complex64::ZERO, |sum, c| (sum + c) * r) + 1.0
        };
        self.denominators.clear();
        self.denominators.extend((0..width).map(denominator));
        self.weights.clear();
        self.weights.extend(self.denominators.iter().map(|d| d.norm_sqr()));
    }
}

/// Bin `first + i` as seen from `k`, in half widths: powers of it stay near one.
fn offset(k: usize, first: usize, i: usize, half_width: usize) -> f64 {
    ((first + i) as f64 - k as f64) / half_width.max(1) as f64
}
