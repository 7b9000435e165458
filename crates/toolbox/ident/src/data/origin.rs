//! [`Origin`]: by which method an estimate was made, of data that vary how much.

use std::borrow::Cow;

use crate::{Dataset, Experiment};

/// How an estimate was made.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Origin {
    /// The method, such as `least squares`.
    pub method: Cow<'static, str>,
    /// Mean of `(y − ȳ)²` of each output over the estimation data, `ȳ` being the mean of an experiment. Empty for
    /// frequency data.
    pub output_variance: Vec<f64>,
}

impl Origin {
    /// An estimate by this method from sampled data.
    #[must_use]
    pub fn new(method: &'static str, data: &Dataset) -> Self {
        let output_variance = (0..data.outputs()).map(|i| variance(data.experiments(), i)).collect();
        Origin { method: Cow::Borrowed(method), output_variance }
    }
}

fn variance(experiments: &[Experiment], output: usize) -> f64 {
    let (mut sum, mut count) = (0.0, 0_usize);
    for experiment in experiments {
        let there = || experiment.output(output).iter().filter(|y| !y.is_nan());
        let rows = there().count();
        let mean = there().sum::<f64>() / rows as f64;
        sum += there().map(|y| (y - mean).powi(2)).sum::<f64>();
        count += rows;
    }
    sum / count as f64
}
