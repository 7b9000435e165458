//! ARX models by instrumental variables: consistent where the equation errors are coloured.

mod equations;
mod four_step;

use faer::Mat;
use lti::PolynomialModel;

use self::equations::{Instrumented, simulate, stabilised};
use crate::polynomial::arx::{ArxOrders, Noise};
use crate::{Dataset, Fit, IdentError};
use fitting::{Count, StructureError};

pub use four_step::Iv4;

/// Batches the covariance is taken from, where the data are long enough.
const BATCHES: usize = 20;

/// Where instruments come from: signals that move with the outputs but not with the noise.
#[derive(Debug, Clone, PartialEq)]
pub enum Instruments {
    /// Given signals in place of the outputs: for each experiment, samples × outputs, without missing samples.
    Signals(Vec<Mat<f64>>),
    /// The outputs of a model, simulated from the inputs and from rest. A model that is not stable has its poles pulled
    /// into the unit circle.
    Model(PolynomialModel),
    /// Inputs from further back. Nothing has to be known, but they are weak where the system remembers for long.
    DelayedInputs,
}

/// Estimates an ARX model (see [`crate::Arx`]) with instruments: `θ` solves `Σ ζ(t) L(q) (y(t) − φᵀ(t) θ) = 0`, where
/// `ζ` holds the instruments `L(q) x(t − l)` in place of the outputs `y(t − l)`. The instruments have to be independent
/// of the noise, so `u` must not be fed back from `y` unless they are chosen accordingly.
///
/// With more instruments than parameters it is two-stage least squares. The covariance comes from the scatter between
/// 20 stretches of the data (fewer where they are short), whatever the colour of the noise.
///
/// # Example
/// ```
/// use ident::{ArxOrders, Dataset, InstrumentalVariables, Instruments};
/// let mut random = signal::excitation::Random::new(1);
/// let u: Vec<f64> = (0..5000).map(|_| random.normal()).collect();
/// // x(t) = 0.8 x(t−1) + u(t−1), measured with white noise: least squares would be biased.
/// let mut x = vec![0.0; 5000];
/// for t in 1..5000 {
///     x[t] = 0.8 * x[t - 1] + u[t - 1];
/// }
/// let y: Vec<f64> = x.iter().map(|x| x + random.normal()).collect();
/// let orders = ArxOrders::siso(1, 1, 1);
/// let fit = InstrumentalVariables::new(orders, Instruments::DelayedInputs).fit(&Dataset::siso(1.0, &u, &y)?)?;
/// assert!((fit.parameters()[0] + 0.8).abs() < 0.05);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §7.6, with filter and extended instruments; Söderström & Stoica, *System Identification*, 1989, ch. 8.
#[derive(Debug, Clone, PartialEq)]
pub struct InstrumentalVariables {
    orders: ArxOrders,
    instruments: Instruments,
    prefilter: Vec<f64>,
    batches: Option<usize>,
}

impl InstrumentalVariables {
    /// A model of these orders by these instruments, without a filter.
    #[must_use]
    pub fn new(orders: ArxOrders, instruments: Instruments) -> Self {
        InstrumentalVariables { orders, instruments, prefilter: vec![1.0], batches: None }
    }

    /// Filters all signals by `L(q) = l₀ + l₁ q⁻¹ + …`.
    #[must_use]
    pub fn prefilter(mut self, coefficients: Vec<f64>) -> Self {
        self.prefilter = coefficients;
        self
    }

    /// Takes the covariance from this many stretches of the data.
    #[must_use]
    pub fn batches(mut self, batches: usize) -> Self {
        self.batches = Some(batches);
        self
    }

    /// Fits the model to data.
    ///
    /// # Errors
    /// Those of [`crate::Arx::fit`]; [`IdentError::Structure`] where there is no input to make instruments of, or the
    /// filter is zero; [`IdentError::Length`], [`IdentError::NotFinite`] for instruments not made for these data;
    /// [`IdentError::RankDeficient`] where instruments and regressors are hardly correlated.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<PolynomialModel>, IdentError> {
        self.orders.check(data)?;
        if self.prefilter.iter().all(|l| *l == 0.0) {
            return Err(StructureError::ZeroPrefilter.into());
        }
        if let Some(index) = self.prefilter.iter().position(|l| !l.is_finite()) {
            return Err(IdentError::NotFinite { what: "the prefilter", index });
        }
        let signals = match &self.instruments {
            Instruments::Signals(given) => Some(checked(given, data)?),
            Instruments::Model(model) => {
                check_inputs(&self.orders)?;
                crate::fit::check_channels(model, data)?;
                Some(simulate(&stabilised(model)?, data))
            }
            Instruments::DelayedInputs => {
                check_inputs(&self.orders)?;
                None
            }
        };
        let filters = vec![self.prefilter.clone(); data.outputs()];
        let whole = Instrumented::new(data, &self.orders, signals.as_deref(), &filters);
        whole.fit(|rows, parameters| match self.batches {
            Some(batches) => Noise::Coloured { batches },
            None => usual_batches(rows, parameters),
        })
    }
}

/// As many batches as the data are long enough for.
fn usual_batches(rows: usize, parameters: usize) -> Noise {
    Noise::Coloured { batches: (rows / (2 * (parameters + 1))).clamp(2, BATCHES) }
}

/// Instruments made of inputs need some.
fn check_inputs(orders: &ArxOrders) -> Result<(), IdentError> {
    if orders.nb.iter().flatten().all(|count| *count == 0) {
        return Err(StructureError::inputs("a model with instruments", Count::AtLeast(1), 0).into());
    }
    Ok(())
}

fn checked(given: &[Mat<f64>], data: &Dataset) -> Result<Vec<Mat<f64>>, IdentError> {
    let same = |what, expected, found| {
        if expected == found { Ok(()) } else { Err(IdentError::Length { what, expected, found }) }
    };
    same("experiments with instruments", data.experiments().len(), given.len())?;
    for (x, experiment) in given.iter().zip(data.experiments()) {
        same("rows of instruments", experiment.len(), x.nrows())?;
        same("columns of instruments", data.outputs(), x.ncols())?;
        for j in 0..x.ncols() {
            if let Some(index) = x.col(j).iter().position(|v| !v.is_finite()) {
                return Err(IdentError::NotFinite { what: "the instruments", index });
            }
        }
    }
    Ok(given.to_vec())
}
