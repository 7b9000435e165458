//! Filters that make the errors of a model white.

use faer::Mat;
use lti::PolynomialModel;

use super::Arx;
use crate::{Dataset, Experiment, IdentError};

/// `L(q) = 1 + l₁ q⁻¹ + …` of `order` coefficients, which makes the errors of one equation white: the autoregression of
/// `Σ_j A_ij y_j − Σ_k B_ik u_k`. One where the errors vanish or are too few.
pub(crate) fn whitening_filter(
    data: &Dataset,
    model: &PolynomialModel,
    equation: usize,
    order: usize,
) -> Result<Vec<f64>, IdentError> {
    let mut errors: Option<Dataset> = None;
    for experiment in data.experiments() {
        let e = equation_errors(model, experiment, equation);
        let outputs = Mat::from_fn(e.len(), 1, |t, _| e[t]);
        errors = Some(match errors {
            None => Dataset::new(data.sample_time_s(), Mat::new(), outputs)?,
            Some(data) => {
                let experiment = Experiment { name: String::new(), start_s: 0.0, inputs: Mat::new(), outputs };
                data.with_experiment(experiment)?
            }
        });
    }
    let fit = errors.filter(|_| order > 0).map(|e| Arx::autoregression(order).fit(&e)).transpose();
    let coefficients = match fit {
        Ok(fit) => fit.map_or_else(Vec::new, |f| f.parameters()),
        Err(IdentError::RankDeficient { .. } | IdentError::TooFewSamples { .. }) => Vec::new(),
        Err(error) => return Err(error),
    };
    Ok(std::iter::once(1.0).chain(coefficients).collect())
}

/// `Σ_j A_ij y_j − Σ_k B_ik u_k` for the rows with all their past.
fn equation_errors(model: &PolynomialModel, experiment: &Experiment, equation: usize) -> Vec<f64> {
    let e = &model.equations()[equation];
    let from_output = |(j, a): (usize, &Vec<f64>)| {
        let own = if j == equation { 1.0 } else { 0.0 };
        (std::iter::once(own).chain(a.iter().copied()).collect::<Vec<f64>>(), experiment.output(j))
    };
    let from_input = |k: usize| (e.delayed_b(k).iter().map(|b| -b).collect(), experiment.input(k));
    let outputs = e.a.iter().enumerate().filter(|(j, a)| *j == equation || !a.is_empty()).map(from_output);
    let inputs = (0..e.b.len()).filter(|k| !e.b[*k].is_empty()).map(from_input);
    let terms: Vec<(Vec<f64>, &[f64])> = outputs.chain(inputs).collect();
    let reach = terms.iter().map(|(p, _)| p.len()).max().unwrap_or(1);
    let mut errors = vec![0.0; (experiment.len() + 1).saturating_sub(reach)];
    for (p, signal) in &terms {
        errors.iter_mut().zip(filter(p, signal, reach)).for_each(|(e, v)| *e += v);
    }
    errors
}

/// `Σ l_k s(t − k)` from the first row on for which filters of `reach` coefficients have all their past.
pub(crate) fn filter(coefficients: &[f64], signal: &[f64], reach: usize) -> Vec<f64> {
    let skipped = reach.saturating_sub(1).min(signal.len());
    let mut filtered = vec![0.0; signal.len() - skipped];
    for (k, l) in coefficients.iter().enumerate().filter(|(k, _)| *k <= skipped) {
        filtered.iter_mut().zip(&signal[skipped - k..]).for_each(|(f, s)| *f += l * s);
    }
    filtered
}
