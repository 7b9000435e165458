//! Printed form of a fit and a model: [`Fit`] and every model implement `Display`.

mod doubts;
mod models;
mod residuals;

use std::fmt;

use lti::text::{Written, indented, number};
use numerics::linalg;

use crate::{Criteria, Fit, Parametric, SpectralFit};

/// The model's equations with standard errors, then the method, how well it describes the estimation data, criteria,
/// how the search ended, and what to doubt.
///
/// # Example
/// ```
/// let u: Vec<f64> = (0..200).map(|t| if (t * t / 7) % 2 == 0 { 1.0 } else { -1.0 }).collect();
/// let mut y = vec![0.0; 200];
/// (1..200).for_each(|t| y[t] = 0.8 * y[t - 1] + 0.5 * u[t - 1] + 0.01 * (t as f64 * 1.7).sin());
/// let fit = ident::Arx::new(1, 1, 1).fit(&ident::Dataset::siso(0.1, &u, &y)?)?;
/// assert!(fit.to_string().starts_with("ARX model in discrete time, sample time 0.1 s\n  A(q) y(t) = B(q) u(t) + e(t)"));
/// # Ok::<(), ident::IdentError>(())
/// ```
impl<M: Written + Parametric> fmt::Display for Fit<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n", self.model.written(Some(&self.standard_errors())))?;
        let facts = [self.method(), self.quality(), self.search()].concat();
        f.write_str(&aligned(&facts))?;
        f.write_str(&doubts::list(&self.doubts, &self.model.parameter_names()))
    }
}

impl<M: Written + Parametric> fmt::Display for SpectralFit<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (fit, cost) = (&self.fit, &self.cost);
        writeln!(f, "{}\n", fit.model.written(Some(&fit.standard_errors())))?;
        let verdict = if cost.passed() { "within" } else { "outside" };
        let range = format!("{verdict} {} to {}", number(cost.lower), number(cost.upper));
        let facts = [("Cost", format!("{}, {range}; {} expected", number(cost.cost), number(cost.expected)))];
        f.write_str(&aligned(&[fit.method(), facts.to_vec(), fit.search()].concat()))?;
        f.write_str(&doubts::list(&fit.doubts, &fit.model.parameter_names()))
    }
}

type Facts = Vec<(&'static str, String)>;

impl<M> Fit<M> {
    /// How well the model predicts each output of the estimation data one step ahead, in percent:
    /// `100 (1 − √(mean of ε² / mean of (y − ȳ)²))`. NaN for an output that does not vary; empty where the estimate was
    /// read from a file or made from frequency data.
    ///
    /// The means are over the samples of the estimation data that the estimate rests on.
    /// [`judge`](crate::validate::judge) counts the first samples too, and simulates.
    #[must_use]
    pub fn fit_percent(&self) -> Vec<f64> {
        let Some(origin) = &self.origin else { return Vec::new() };
        let ratio = |(error, whole): (f64, &f64)| if *whole > 0.0 { (error / whole).sqrt() } else { f64::NAN };
        let errors = self.mean_squared_errors().into_iter().zip(&origin.output_variance);
        errors.map(ratio).map(|ratio| 100.0 * (1.0 - ratio)).collect()
    }

    /// Mean squared one-step prediction error of each output on the estimation data.
    #[must_use]
    pub fn mean_squared_errors(&self) -> Vec<f64> {
        let outputs = self.noise_covariance.nrows();
        if outputs == 1 {
            return vec![self.loss];
        }
        // The noise covariance has the degrees of freedom taken off, by which the loss is smaller.
        let scale = (self.loss / linalg::determinant(self.noise_covariance.as_ref())).powf(1.0 / outputs as f64);
        let scale = if scale.is_finite() && scale < 1.0 { scale } else { 1.0 };
        (0..outputs).map(|i| scale * self.noise_covariance[(i, i)]).collect()
    }

    /// The information criteria of the estimate.
    #[must_use]
    pub fn criteria(&self) -> Criteria {
        Criteria::of(self.loss, self.free_parameters, self.samples, self.noise_covariance.nrows())
    }

    fn method(&self) -> Facts {
        let basis = format!("{} samples, {} free parameters", self.samples, self.free_parameters);
        match &self.origin {
            Some(origin) => vec![("Method", origin.method.to_string()), ("Data", basis)],
            None => vec![("Data", basis)],
        }
    }

    /// Fit, mean squared error and criteria.
    fn quality(&self) -> Facts {
        let list = |values: &[f64], unit: &str| {
            values.iter().map(|value| format!("{}{unit}", number(*value))).collect::<Vec<_>>().join(", ")
        };
        let percent: Vec<f64> = self.fit_percent().iter().map(|p| (100.0 * p).round() / 100.0).collect();
        let mut facts = Vec::new();
        if !percent.is_empty() {
            facts.push(("Fit", format!("{} to the estimation data, one step ahead", list(&percent, " %"))));
        }
        let criteria = self.criteria();
        facts.push(("MSE", list(&self.mean_squared_errors(), "")));
        facts.push(("FPE", number(criteria.fpe)));
        let others = [("AICc", criteria.aicc), ("BIC", criteria.bic)];
        let others = others.map(|(name, value)| format!("{name} {}", number(value))).join(", ");
        facts.push(("AIC", format!("{}, {others}", number(criteria.aic))));
        facts
    }

    fn search(&self) -> Facts {
        let after = match self.iterations {
            0 => String::new(),
            1 => ", 1 iteration".to_owned(),
            count => format!(", {count} iterations"),
        };
        vec![("Search", format!("{}{after}", self.termination))]
    }
}

fn aligned(facts: &[(&'static str, String)]) -> String {
    let width = facts.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let lines: Vec<String> = facts.iter().map(|(name, value)| format!("{name:<width$}  {value}")).collect();
    indented(&lines.join("\n"))
}
