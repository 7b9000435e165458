//! How well models reproduce measured outputs.

use faer::Mat;

use super::{fit_percent, rms_error};
use crate::prediction::{InitialState, Response, predict, simulate};
use crate::{Dataset, Experiment, IdentError, LinearModel};

/// How well one model reproduces the outputs of a dataset.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// [`fit_percent`] for each experiment and output, `[experiment][output]`; NaN where every sample is missing,
    /// and where the output does not vary.
    pub fit_percent: Vec<Vec<f64>>,
    /// [`rms_error`] likewise, in units of the output.
    pub rms_error: Vec<Vec<f64>>,
    /// The determinant of the mean of `(y − ŷ)(y − ŷ)ᵀ` over the rows without a missing output; NaN without any.
    pub loss: f64,
    /// The rows that the loss rests on.
    pub samples: usize,
    /// What the model gave.
    pub response: Response,
}

/// Judges a model by its prediction over `horizon` samples, or by its simulation where that is `None`.
///
/// Every sample of every experiment counts, the first ones too, and so does the same rule for the initial state: the
/// numbers are the same wherever the same model meets the same data.
///
/// # Errors
/// Those of [`predict`] and [`simulate`].
///
/// # Example
/// ```
/// use ident::prediction::InitialState;
/// use lti::{PolynomialEquation, PolynomialModel};
/// let equation = PolynomialEquation { a: vec![vec![-0.5]], b: vec![vec![2.0]], ..Default::default() };
/// let model = PolynomialModel::siso(0.1, 1, equation)?;
/// let data = ident::Dataset::siso(0.1, &[1.0, 0.0, 0.0], &[0.0, 2.0, 1.0])?;
/// let judged = ident::validate::judge(&model, &data, None, &InitialState::Zero)?;
/// assert_eq!(judged.fit_percent, [[100.0]]);
/// # Ok::<(), ident::IdentError>(())
/// ```
pub fn judge<M: LinearModel + ?Sized>(
    model: &M,
    data: &Dataset,
    horizon: Option<usize>,
    initial: &InitialState,
) -> Result<Judgement, IdentError> {
    let response = match horizon {
        None => simulate(model, data, initial)?,
        Some(steps) => predict(model, data, steps, initial)?,
    };
    let pairs = || data.experiments().iter().zip(&response.outputs);
    let (loss, samples) = loss(data, &response.outputs);
    Ok(Judgement {
        fit_percent: pairs().map(|(e, m)| each_output(e, m, fit_percent)).collect(),
        rms_error: pairs().map(|(e, m)| each_output(e, m, rms_error)).collect(),
        loss,
        samples,
        response,
    })
}

/// [`judge`]s several models on the same data: each name with its judgement, or with the reason why there is none.
pub fn compare(
    models: &[(&str, &dyn LinearModel)],
    data: &Dataset,
    horizon: Option<usize>,
    initial: &InitialState,
) -> Vec<(String, Result<Judgement, IdentError>)> {
    models.iter().map(|(name, model)| ((*name).to_string(), judge(*model, data, horizon, initial))).collect()
}

/// A measure over the samples of each output that are there.
fn each_output(
    experiment: &Experiment,
    modelled: &Mat<f64>,
    measure: impl Fn(&[f64], &[f64]) -> Result<f64, IdentError>,
) -> Vec<f64> {
    let of = |i: usize| {
        let there = experiment.output(i).iter().zip(modelled.col_as_slice(i)).filter(|(y, _)| !y.is_nan());
        let (y, m): (Vec<f64>, Vec<f64>) = there.map(|(y, m)| (*y, *m)).unzip();
        measure(&y, &m).unwrap_or(f64::NAN)
    };
    (0..modelled.ncols()).map(of).collect()
}

fn loss(data: &Dataset, modelled: &[Mat<f64>]) -> (f64, usize) {
    let outputs = data.outputs();
    let mut sum = Mat::<f64>::zeros(outputs, outputs);
    let mut samples = 0;
    for (experiment, m) in data.experiments().iter().zip(modelled) {
        for t in 0..experiment.len() {
            let error = |i: usize| experiment.outputs[(t, i)] - m[(t, i)];
            if (0..outputs).any(|i| error(i).is_nan()) {
                continue;
            }
            samples += 1;
            for i in 0..outputs {
                for j in 0..outputs {
                    sum[(i, j)] += error(i) * error(j);
                }
            }
        }
    }
    ((faer::Scale(1.0 / samples as f64) * sum).determinant(), samples)
}
