//! The plant from the part of its input that the reference made.

use faer::Mat;

use super::{INPUT, REFERENCE, check_loop};
use crate::data::check_range;
use crate::data::regression::{Lagged, Regression};
use crate::{Dataset, Doubt, Experiment, Fit, IdentError};

/// Regresses `u` on present, past and, where asked, future values of `r`, and fits the plant from the input so
/// explained, `û`, to `y = G û + noise`, noise that is independent of `û`.
///
/// The second fit may be of any kind: with a fixed noise model such as output error the plant is consistent whatever
/// the noise. The covariance is that of the second fit by itself, and no measure of the errors: the noise that
/// circulates in the loop, `u − û`, was made orthogonal to `r`, so that it shapes the residuals, `H e/(1 + G R)` to
/// first order, but takes little part in the estimate, whose noise is nearer to `H e`. Where the loop suppresses noise
/// the intervals are too short, whether colour is allowed for or modelled: of a first-order plant with `1 + G R = 3` at
/// rest, those of 95 % hold the pole in two thirds of all cases. [`Doubt::CovarianceIsLowerBound`] says so.
///
/// `û` holds the part of the noise that as many coefficients as there are lags and leads follow by chance: a bias that
/// vanishes with the length of the data over their number. The first `lags` rows of each experiment are spent, and as
/// many at the end as there are `leads`.
///
/// # Source
/// Van den Hof & Schrama 1993; with future values, for loops that are not linear, the projection method of Forssell &
/// Ljung, *A projection method for closed-loop identification*, 2000.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TwoStage {
    /// Past values of `r`, beyond the present one: longer than the sensitivity rings.
    pub lags: usize,
    /// Future values of `r`: zero for a linear loop.
    pub leads: usize,
}

impl Default for TwoStage {
    /// Fifty lags, no leads.
    fn default() -> Self {
        TwoStage { lags: 50, leads: 0 }
    }
}

impl TwoStage {
    /// The plant, from data with the inputs `u`, `r` and one output.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for other channels; [`IdentError::RankDeficient`] where `r` excites fewer orders than
    /// there are lags; [`IdentError::TooFewSamples`]; those of `estimate`.
    pub fn fit<M>(
        &self,
        data: &Dataset,
        estimate: impl Fn(&Dataset) -> Result<Fit<M>, IdentError>,
    ) -> Result<Fit<M>, IdentError> {
        let mut fit = estimate(&self.explained(data)?)?;
        fit.doubts.push(Doubt::CovarianceIsLowerBound);
        Ok(fit)
    }

    /// Data of `û` and `y` on the rows for which `û` exists. A missing `r` makes a run of missing `û`.
    ///
    /// # Errors
    /// Those of [`TwoStage::fit`] but for the estimate's.
    pub fn explained(&self, data: &Dataset) -> Result<Dataset, IdentError> {
        check_loop(data)?;
        check_range("lags", self.lags as f64, 0.0, 1e5)?;
        check_range("leads", self.leads as f64, 0.0, 1e5)?;
        let signals = data.experiments().iter().map(|e| vec![e.input(INPUT), e.input(REFERENCE)]).collect();
        let lags = -(self.leads as isize)..=self.lags as isize;
        let columns = Lagged::each(1, lags).chain([Lagged::new(0, 0)]).collect();
        let response = Regression::new(&signals, columns).least_squares()?.parameters;
        let plant = data.channels(&[INPUT], &[0])?;
        let ends: Vec<_> = plant.experiments().iter().map(|e| self.lags..e.len().saturating_sub(self.leads)).collect();
        let parts = plant.experiments().iter().zip(data.experiments()).zip(ends).filter(|(_, rows)| !rows.is_empty());
        let experiments = parts.map(|((e, whole), rows)| {
            let r = whole.input(REFERENCE);
            let first = self.leads;
            let explained = |t: usize| response.iter().enumerate().map(|(j, g)| g * r[t + first - j]).sum::<f64>();
            Experiment {
                name: e.name.clone(),
                start_s: e.start_s + rows.start as f64 * data.sample_time_s(),
                inputs: Mat::from_fn(rows.len(), 1, |i, _| explained(rows.start + i)),
                outputs: Mat::from_fn(rows.len(), 1, |i, _| e.output(0)[rows.start + i]),
            }
        });
        plant.with_experiments(experiments.collect())
    }
}
