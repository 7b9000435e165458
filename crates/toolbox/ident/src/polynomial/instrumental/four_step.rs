//! [`Iv4`]: nearly optimal instruments in four steps.

use lti::PolynomialModel;

use super::equations::{Instrumented, simulate, stabilised};
use super::{check_inputs, usual_batches};
use crate::polynomial::arx::{Arx, ArxOrders, Noise, whitening_filter};
use crate::{Dataset, Fit, IdentError};

/// Estimates an ARX model (see [`Arx`]) by the four-step instrumental-variable method: consistent whatever the colour
/// of the noise in open loop, and nearly as accurate as a model of the noise would allow where `A v` is close to
/// autoregressive.
///
/// 1. Least squares; its model simulated gives instruments.
/// 2. Instrumental variables; the new model simulated gives better ones.
/// 3. The equation errors, of this model, as an autoregression of `na + nb` coefficients: the filter `L`.
/// 4. Instrumental variables with all signals filtered by `L`.
///
/// The covariance comes from the scatter of the last step between 20 stretches of the data (fewer where they are
/// short): a short `L` seldom makes the errors white. See [`Iv4::white_errors`] for the textbook's. Noise and loss are
/// those of the ARX model itself, so they are larger than a model of the noise would leave.
///
/// # Example
/// ```
/// use ident::{Dataset, Iv4};
/// let mut random = signal::excitation::Random::new(1);
/// let u: Vec<f64> = (0..5000).map(|_| random.normal()).collect();
/// let mut x = vec![0.0; 5000];
/// for t in 2..5000 {
///     x[t] = 1.5 * x[t - 1] - 0.7 * x[t - 2] + u[t - 1];
/// }
/// let y: Vec<f64> = x.iter().map(|x| x + random.normal()).collect();
/// let fit = Iv4::new(2, 1, 1).fit(&Dataset::siso(1.0, &u, &y)?)?;
/// assert!((fit.parameters()[0] + 1.5).abs() < 4.0 * fit.standard_errors()[0]);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §15.3 (IV4); Söderström & Stoica, *System Identification*, 1989, §8.2 for optimal instruments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Iv4 {
    orders: ArxOrders,
    white_errors: bool,
}

impl Iv4 {
    /// One input and one output: `na` and `nb` coefficients, delay `nk`.
    #[must_use]
    pub fn new(na: usize, nb: usize, nk: usize) -> Self {
        Self::with_orders(ArxOrders::siso(na, nb, nk))
    }

    /// Several inputs or outputs.
    #[must_use]
    pub fn with_orders(orders: ArxOrders) -> Self {
        Iv4 { orders, white_errors: false }
    }

    /// Takes the filtered errors of the last step as white for the covariance: right, and less scattered, where `A v`
    /// is an autoregression of at most `na + nb` coefficients.
    #[must_use]
    pub fn white_errors(mut self) -> Self {
        self.white_errors = true;
        self
    }

    /// Fits the model to data.
    ///
    /// # Errors
    /// Those of [`Arx::fit`]; [`IdentError::Structure`] for a model without inputs.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<PolynomialModel>, IdentError> {
        self.orders.check(data)?;
        check_inputs(&self.orders)?;
        let first = Arx::with_orders(self.orders.clone()).fit(data)?.model;
        let unfiltered = vec![vec![1.0]; data.outputs()];
        let second = self.refined(data, &first, &unfiltered)?.model;
        let filter = |i: usize| whitening_filter(data, &second, i, self.orders.regressors(i).len());
        let filters = (0..data.outputs()).map(filter).collect::<Result<Vec<_>, _>>()?;
        self.refined(data, &second, &filters)
    }

    /// Instrumental variables with the simulated outputs of `model`.
    fn refined(
        &self,
        data: &Dataset,
        model: &PolynomialModel,
        filters: &[Vec<f64>],
    ) -> Result<Fit<PolynomialModel>, IdentError> {
        let instruments = simulate(&stabilised(model)?, data);
        Instrumented::new(data, &self.orders, Some(&instruments), filters)
            .fit(|rows, parameters| if self.white_errors { Noise::White } else { usual_batches(rows, parameters) })
    }
}
