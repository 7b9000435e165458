//! How well models reproduce measured outputs.

use std::fmt;

use faer::Mat;
use numerics::linalg;

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
    /// Response of the model.
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

/// Several models judged on the same data.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Names of the models.
    pub names: Vec<String>,
    /// How well it does, or why it cannot be judged.
    pub judgements: Vec<Result<Judgement, IdentError>>,
}

/// Compares the simulations of several models, or fits, with measured outputs; each model's initial state is estimated.
///
/// # Example
/// ```
/// use ident::validate::compare;
/// let u: Vec<f64> = (0..200).map(|t| if (t * t / 7) % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// let mut y = vec![0.0; 200];
/// (2..200).for_each(|t| y[t] = 1.2 * y[t - 1] - 0.5 * y[t - 2] + u[t - 1]);
/// let data = ident::Dataset::siso(0.1, &u, &y)?;
/// let (first, second) = (ident::Arx::new(1, 1, 1).fit(&data)?, ident::Arx::new(2, 1, 1).fit(&data)?);
/// let comparison = compare(&[&first, &second], &data).named(&["first order", "second order"]);
/// assert_eq!(comparison.best(), Some("second order"));
/// println!("{comparison}");
/// # Ok::<(), ident::IdentError>(())
/// ```
#[must_use]
pub fn compare(models: &[&dyn LinearModel], data: &Dataset) -> Comparison {
    compare_with(models, data, None, &InitialState::Estimated)
}

/// [`judge`]s several models on the same data, by their prediction over `horizon` samples or by their simulation.
#[must_use]
pub fn compare_with(
    models: &[&dyn LinearModel],
    data: &Dataset,
    horizon: Option<usize>,
    initial: &InitialState,
) -> Comparison {
    Comparison {
        names: (1..=models.len()).map(|k| format!("model {k}")).collect(),
        judgements: models.iter().map(|model| judge(*model, data, horizon, initial)).collect(),
    }
}

impl Comparison {
    /// With names for the models, in their order; a model beyond the names keeps its number.
    #[must_use]
    pub fn named(mut self, names: &[&str]) -> Self {
        self.names.iter_mut().zip(names).for_each(|(own, name)| (*name).clone_into(own));
        self
    }

    /// The name of the model whose worst output fits best; `None` where no model can be judged.
    #[must_use]
    pub fn best(&self) -> Option<&str> {
        let worst = |j: &Judgement| j.fit_percent.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        let judged =
            self.judgements.iter().zip(&self.names).filter_map(|(j, name)| Some((worst(j.as_ref().ok()?), name)));
        judged.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name.as_str())
    }
}

impl fmt::Display for Comparison {
    /// One line a model: the fit in percent of each output, of each experiment where there are several.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        for (name, judgement) in self.names.iter().zip(&self.judgements) {
            match judgement {
                Err(reason) => writeln!(f, "{name:<width$}  cannot be judged: {reason}")?,
                Ok(judgement) => {
                    let list = |values: &[f64]| values.iter().map(|v| format!("{v:7.2} %")).collect::<String>();
                    let fits: Vec<String> = judgement.fit_percent.iter().map(|e| list(e)).collect();
                    writeln!(f, "{name:<width$}  fit {}", fits.join("  |"))?;
                }
            }
        }
        Ok(())
    }
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
        for t in work::checked(0..experiment.len()) {
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
    (linalg::determinant((faer::Scale(1.0 / samples as f64) * sum).as_ref()), samples)
}
