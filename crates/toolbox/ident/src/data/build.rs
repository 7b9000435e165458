//! Datasets of several channels from plain slices, and from `ndarray`'s arrays.

use faer::Mat;

use super::Dataset;
use crate::IdentError;

impl Dataset {
    /// One experiment from one slice a channel; no input for a time series.
    ///
    /// # Errors
    /// Those of [`Dataset::new`]; [`IdentError::Length`] where the channels differ in length.
    ///
    /// # Example
    /// ```
    /// let (u1, u2, y) = (vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 2.0, 1.0]);
    /// let data = ident::Dataset::from_channels(0.1, &[&u1, &u2], &[&y])?;
    /// assert_eq!((data.samples(), data.inputs(), data.outputs()), (3, 2, 1));
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn from_channels(sample_time_s: f64, inputs: &[&[f64]], outputs: &[&[f64]]) -> Result<Self, IdentError> {
        let samples = outputs.first().map_or(0, |y| y.len());
        for (what, channels) in [("samples of an input", inputs), ("samples of an output", outputs)] {
            if let Some(other) = channels.iter().find(|channel| channel.len() != samples) {
                return Err(IdentError::Length { what, expected: samples, found: other.len() });
            }
        }
        let table = |channels: &[&[f64]]| Mat::from_fn(samples, channels.len(), |t, k| channels[k][t]);
        Self::new(sample_time_s, table(inputs), table(outputs))
    }

    /// One experiment from two tables: samples × inputs and samples × outputs.
    ///
    /// # Errors
    /// Those of [`Dataset::new`].
    ///
    /// # Example
    /// ```
    /// let inputs = ndarray::array![[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
    /// let outputs = ndarray::array![[0.0], [2.0], [1.0]];
    /// let data = ident::Dataset::from_ndarray(0.1, inputs.view(), outputs.view())?;
    /// assert_eq!((data.samples(), data.inputs(), data.outputs()), (3, 2, 1));
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    #[cfg(feature = "ndarray")]
    pub fn from_ndarray(
        sample_time_s: f64,
        inputs: ndarray::ArrayView2<'_, f64>,
        outputs: ndarray::ArrayView2<'_, f64>,
    ) -> Result<Self, IdentError> {
        let table = |x: ndarray::ArrayView2<'_, f64>| Mat::from_fn(x.nrows(), x.ncols(), |t, k| x[[t, k]]);
        Self::new(sample_time_s, table(inputs), table(outputs))
    }
}
