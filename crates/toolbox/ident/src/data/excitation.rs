//! Persistence of excitation: how many parameters the inputs can separate.

use faer::Mat;
use numerics::linalg;

use crate::data::check_range;
use crate::data::regression::{Lagged, Regression};
use crate::{Dataset, Experiment, IdentError};
use fitting::{Count, StructureError};

/// How to look for excitation.
///
/// The inputs `u` (m of them) are persistently exciting of order `n` where the covariance of `[u(t−1) … u(t−n)]`, m·n
/// wide, is non-singular: then the coefficients of any finite impulse response of `n` lags from each input can be
/// separated. With one input, k sines excite up to order 2k, and a constant adds one; means are left in, so take the
/// trend off first where the model does not have to explain it.
///
/// Inputs are scaled to a root mean square of one. An order counts while the smallest singular value of the scaled
/// regressor, divided by √rows, exceeds `tolerance` and, where the inputs carry noise (a quantised or measured input),
/// `√2` times the noise-to-signal ratio of the noisiest input: noise alone would give as much.
///
/// # Example
/// ```
/// let u: Vec<f64> = (0..500).map(|t| (0.3 * t as f64).sin() + (1.1 * t as f64).cos()).collect();
/// let data = ident::Dataset::siso(0.1, &u, &u)?;
/// assert_eq!(ident::ExcitationOptions::default().of_inputs(&data)?.order, 4);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, definition 13.2 and §13.2.
#[derive(Debug, Clone, PartialEq)]
pub struct ExcitationOptions {
    /// Highest order to look for; fewer where the data are short.
    pub highest_order: usize,
    /// Smallest singular value that counts, relative to inputs of a root mean square of one.
    pub tolerance: f64,
    /// Standard deviation of the noise in each input, in its unit; empty for none.
    pub noise: Vec<f64>,
}

impl Default for ExcitationOptions {
    /// Orders to 30, 1e-7, no noise.
    fn default() -> Self {
        ExcitationOptions { highest_order: 30, tolerance: 1e-7, noise: Vec::new() }
    }
}

/// How strongly the inputs excite.
#[derive(Debug, Clone, PartialEq)]
pub struct Excitation {
    /// The order up to which they are persistently exciting; zero where an input does not vary from zero or inputs are
    /// proportional to each other.
    pub order: usize,
    /// True if `order` is the highest that was looked for, so the true one may be higher.
    pub at_least: bool,
    /// For orders from one on, the smallest singular value of the scaled regressor divided by √rows: one for white
    /// independent inputs. Standard errors grow with its inverse.
    pub levels: Vec<f64>,
    /// Threshold that a level has to exceed.
    pub threshold: f64,
}

impl ExcitationOptions {
    /// The excitation by the inputs of the data. Rows with missing samples are left out.
    ///
    /// # Errors
    /// [`IdentError::Structure`] without inputs; [`IdentError::Length`] unless `noise` is empty or has one value an
    /// input; [`IdentError::TooFewSamples`]; [`signal::SignalError::Parameter`].
    pub fn of_inputs(&self, data: &Dataset) -> Result<Excitation, IdentError> {
        self.of(data, data.inputs(), |e| (0..e.inputs.ncols()).map(|k| e.input(k)).collect())
    }

    /// The excitation by inputs and outputs together: whether the data suffice for a model with past outputs among its
    /// regressors. Under feedback by a simple regulator without external signals they do not, however lively they look.
    ///
    /// # Errors
    /// Those of [`ExcitationOptions::of_inputs`].
    ///
    /// # Source
    /// Ljung 1999, §13.4 (informative experiments in closed loop).
    pub fn of_inputs_and_outputs(&self, data: &Dataset) -> Result<Excitation, IdentError> {
        self.of(data, data.inputs() + data.outputs(), |e| data.all_channels().map(|c| e.channel(c)).collect())
    }

    fn of(
        &self,
        data: &Dataset,
        width: usize,
        signals: impl Fn(&Experiment) -> Vec<&[f64]>,
    ) -> Result<Excitation, IdentError> {
        if width == 0 {
            return Err(StructureError::inputs("a judgement of excitation", Count::AtLeast(1), 0).into());
        }
        check_range("highest_order", self.highest_order as f64, 1.0, 1e4)?;
        check_range("tolerance", self.tolerance, 0.0, 1.0)?;
        if !self.noise.is_empty() {
            crate::data::check_count("noise of the inputs", data.inputs(), self.noise.len())?;
        }
        let signals: Vec<_> = data.experiments().iter().map(signals).collect();
        let longest = signals.iter().map(|s| s[0].len()).max().unwrap_or(0);
        let orders = self.highest_order.min(longest / (width + 1));
        if orders == 0 {
            return Err(IdentError::TooFewSamples { samples: longest, parameters: width + 1 });
        }
        // Lag by lag, so that each order is a leading block of the next.
        let columns: Vec<Lagged> =
            (1..=orders as isize).flat_map(|lag| (0..width).map(move |k| Lagged::new(k, lag - 1))).collect();
        let regression = Regression::new(&signals, columns);
        let rows = regression.rows;
        if rows < orders * width {
            return Err(IdentError::TooFewSamples { samples: rows, parameters: orders * width });
        }
        self.judge(&regression.factor(), width, rows)
    }

    fn judge(&self, factor: &Mat<f64>, width: usize, rows: usize) -> Result<Excitation, IdentError> {
        let orders = factor.ncols() / width;
        let root = (rows as f64).sqrt();
        let power: Vec<f64> = (0..width).map(|k| factor.col(k).norm_l2() / root).collect();
        let noise = self.noise.iter().zip(&power).map(|(noise, rms)| noise.abs() / rms).fold(0.0, f64::max);
        let threshold = self.tolerance.max(std::f64::consts::SQRT_2 * noise);
        let scale = |j: usize| if power[j % width] > 0.0 { 1.0 / (power[j % width] * root) } else { 0.0 };
        let mut levels = Vec::with_capacity(orders);
        for n in 1..=orders {
            let leading = Mat::from_fn(n * width, n * width, |i, j| factor[(i, j)] * scale(j));
            let values = linalg::singular_values(leading.as_ref())?;
            levels.push(values.last().copied().unwrap_or(0.0));
        }
        let order = levels.iter().take_while(|level| **level > threshold).count();
        Ok(Excitation { order, at_least: order == orders, levels, threshold })
    }
}
