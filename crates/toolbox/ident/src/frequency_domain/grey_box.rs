//! Models with physical parameters from frequency data.

use faer::Mat;
use lti::{LtiError, ProcessModel, TransferFunction};
use signal::Complex64;

use super::data::Measured;
use super::misfit::{Misfit, Response, SpectralFit, search, spectral_fit};
use crate::continuous::{ContinuousChannel, RationalChannel};
use crate::{Bounds, Doubt, IdentError, NonlinearOptions, Parametric};

/// Step of the differences that stand for derivatives, as part of a parameter.
const STEP: f64 = 1e-5;

/// A model with parameters that has a frequency response.
pub trait FrequencyModel: Parametric {
    /// The gain at an angular frequency in rad/s.
    fn response(&self, omega_rad_s: f64) -> Complex64;
}

impl FrequencyModel for ProcessModel {
    fn response(&self, omega_rad_s: f64) -> Complex64 {
        of_transfer_function(self.to_transfer_function(), omega_rad_s)
    }
}

impl FrequencyModel for RationalChannel {
    fn response(&self, omega_rad_s: f64) -> Complex64 {
        of_transfer_function(self.transfer_function(), omega_rad_s)
    }
}

fn of_transfer_function(system: Result<TransferFunction, LtiError>, omega_rad_s: f64) -> Complex64 {
    system.map_or(Complex64::new(f64::NAN, 0.0), |g| g.evaluate(Complex64::new(0.0, omega_rad_s)))
}

/// A frequency response written as a function of θ and ω (rad/s), with the parameters' names.
///
/// # Example
/// ```
/// use ident::ResponseFunction;
/// use signal::Complex64;
/// // One over stiffness − mass ω² + jω damping.
/// let names = ["mass_kg", "damping_n_s_m", "stiffness_n_m"];
/// let spring = ResponseFunction::new(&names, &[1.0, 0.1, 50.0], |theta: &[f64], w| {
///     1.0 / Complex64::new(theta[2] - theta[0] * w * w, theta[1] * w)
/// });
/// # let _ = spring;
/// ```
#[derive(Debug, Clone)]
pub struct ResponseFunction<F> {
    names: Vec<String>,
    parameters: Vec<f64>,
    function: F,
}

impl<F: Fn(&[f64], f64) -> Complex64 + Clone> ResponseFunction<F> {
    /// From the names of the parameters, their values to start from, and the function.
    pub fn new(names: &[&str], parameters: &[f64], function: F) -> Self {
        let names = names.iter().map(|n| (*n).to_owned()).collect();
        ResponseFunction { names, parameters: parameters.to_vec(), function }
    }
}

impl<F: Fn(&[f64], f64) -> Complex64 + Clone> Parametric for ResponseFunction<F> {
    fn parameters(&self) -> Vec<f64> {
        self.parameters.clone()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.names.clone()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        let expected = self.parameters.len();
        if parameters.len() != expected {
            return Err(LtiError::shape("parameters", (expected, 1), (parameters.len(), 1)));
        }
        Ok(ResponseFunction { parameters: parameters.to_vec(), ..self.clone() })
    }
}

impl<F: Fn(&[f64], f64) -> Complex64 + Clone> FrequencyModel for ResponseFunction<F> {
    fn response(&self, omega_rad_s: f64) -> Complex64 {
        (self.function)(&self.parameters, omega_rad_s)
    }
}

/// Fits any [`FrequencyModel`] to a frequency response or to spectra, weighted by their noise, from its own parameters
/// on.
///
/// Minimises `Σ_k |Y_k − G(ω_k, θ) U_k|²/σ_k²(θ)`, `σ² = σ_y² + |G|² σ_u² − 2 Re(G* σ_yu)`: maximum likelihood for
/// normal noise of the given variances on input and output. Derivatives are central differences.
///
/// # Example
/// ```
/// use ident::{FrequencyData, FrequencyGreyBox, ResponseFunction};
/// use signal::Complex64;
/// let lag = |theta: &[f64], w: f64| theta[0] / Complex64::new(1.0, w * theta[1]);
/// let omega_rad_s: Vec<f64> = (1..30).map(f64::from).collect();
/// let response = omega_rad_s.iter().map(|w| lag(&[3.0, 0.2], *w)).collect();
/// let data = FrequencyData { variance: vec![1e-4; 29], averages: None, shared_noise: None, omega_rad_s, response };
/// let found = FrequencyGreyBox::default().fit(&ResponseFunction::new(&["K", "T"], &[1.0, 1.0], lag), &data)?;
/// assert!((found.fit.parameters()[1] - 0.2).abs() < 1e-8);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Pintelon & Schoukens 2012, ch. 9 (maximum likelihood with measured noise).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrequencyGreyBox {
    bounds: Vec<Bounds>,
    search: NonlinearOptions,
}

impl FrequencyGreyBox {
    /// Bounds of every parameter, in their order.
    #[must_use]
    pub fn with_bounds(self, bounds: &[Bounds]) -> Self {
        FrequencyGreyBox { bounds: bounds.to_vec(), ..self }
    }

    /// How far and how exactly to search.
    #[must_use]
    pub fn with_search(self, search: NonlinearOptions) -> Self {
        FrequencyGreyBox { search, ..self }
    }

    /// Estimates the parameters, starting from those of `model`.
    ///
    /// # Errors
    /// Those of [`Measured::lines`] and of [`minimise`](crate::minimise).
    pub fn fit<M: FrequencyModel>(&self, model: &M, data: &impl Measured) -> Result<SpectralFit<M>, IdentError> {
        let lines = data.lines()?;
        let start = model.parameters();
        let bounds = if self.bounds.is_empty() { vec![Bounds::NONE; start.len()] } else { self.bounds.clone() };
        let omega: Vec<f64> = lines.lines.iter().map(|l| l.omega).collect();
        let response = Differences { model, omega: &omega, sizes: sizes(&start, &bounds), bounds: &bounds };
        let mut misfit = Misfit::new(&lines, response);
        let (minimum, covariance) = search(&mut misfit, &start, &bounds, self.search)?;
        let mut found = spectral_fit(&lines, model.with_parameters(&minimum.parameters)?, covariance, &minimum);
        let resting = (0..start.len()).filter(|j| minimum.at_bound[*j] && bounds[*j].lower < bounds[*j].upper);
        found.fit.doubts.extend(resting.map(|parameter| Doubt::AtBound { parameter }));
        Ok(found)
    }
}

/// How large each parameter is where it passes through zero.
fn sizes(start: &[f64], bounds: &[Bounds]) -> Vec<f64> {
    let width = |b: &Bounds| if (b.upper - b.lower).is_finite() { b.upper - b.lower } else { 1.0 };
    start.iter().zip(bounds).map(|(v, b)| if *v == 0.0 { 1e-2 * width(b) } else { v.abs() }).collect()
}

struct Differences<'a, M> {
    model: &'a M,
    omega: &'a [f64],
    sizes: Vec<f64>,
    bounds: &'a [Bounds],
}

impl<M: FrequencyModel> Response for Differences<'_, M> {
    fn parameter_count(&self) -> usize {
        self.sizes.len()
    }

    fn respond(
        &mut self,
        theta: &[f64],
        gains: &mut [Complex64],
        slopes: Option<&mut Mat<Complex64>>,
    ) -> Result<(), IdentError> {
        let model = self.model.with_parameters(theta)?;
        gains.iter_mut().zip(self.omega).for_each(|(gain, w)| *gain = model.response(*w));
        let Some(slopes) = slopes else {
            return Ok(());
        };
        for j in 0..theta.len() {
            let step = STEP * theta[j].abs().max(1e-3 * self.sizes[j]);
            // Not beyond a bound, where the model may not exist.
            let high = if theta[j] + step > self.bounds[j].upper { theta[j] } else { theta[j] + step };
            let low = if theta[j] - step < self.bounds[j].lower { theta[j] } else { theta[j] - step };
            if high <= low {
                continue;
            }
            let at = |value: f64| -> Result<M, IdentError> {
                let mut point = theta.to_vec();
                point[j] = value;
                Ok(self.model.with_parameters(&point)?)
            };
            let (above, below) = (at(high)?, at(low)?);
            for (k, w) in self.omega.iter().enumerate() {
                slopes[(k, j)] = (above.response(*w) - below.response(*w)) / (high - low);
            }
        }
        Ok(())
    }
}
