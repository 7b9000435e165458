//! Test that a bench is still the same: two bench models from different recordings are compared.

use std::borrow::Cow;

use bench_model::document::{BenchModelDocument, Provenance, UsedRecording};
use bench_model::model::{BenchModel, ModelParameter, PartCovariance};
use faer::Mat;
use numerics::linalg::least_norm;
use numerics::null::{infinite_if_null, nan_if_null};
use serde::{Deserialize, Serialize};
use signal::distributions::{f_tail, interval};

/// The parts that are tested, each with its parameters.
const PARTS: [(ComparedPart, &[ModelParameter]); 4] = [
    (
        ComparedPart::Shaft,
        &[
            ModelParameter::DynoInertia,
            ModelParameter::EngineInertia,
            ModelParameter::Stiffness,
            ModelParameter::Damping,
        ],
    ),
    (
        ComparedPart::SpeedController,
        &[ModelParameter::Proportional, ModelParameter::Integral, ModelParameter::ControllerDelay],
    ),
    (ComparedPart::FeedForward, &[ModelParameter::SpeedFeedForward, ModelParameter::AccelerationFeedForward]),
    (ComparedPart::TorqueControl, &[ModelParameter::TorqueControlDelay, ModelParameter::TorqueControlBandwidth]),
];
/// A bench has changed if its models differ by chance with a smaller probability than this.
pub const CHANGED: f64 = 0.01;
/// Confidence of the intervals of differences.
const CONFIDENCE: f64 = 0.95;
/// Directions of the covariance with less than this part of the largest are left out.
const CERTAIN: f64 = 1e-12;

/// A part of the bench that is tested as a whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ComparedPart {
    /// Inertias, stiffness and damping.
    Shaft,
    /// PI and its delay.
    SpeedController,
    /// Feed-forward of the speed controller.
    FeedForward,
    /// Delay and bandwidth of the torque control.
    TorqueControl,
}

/// Two models, compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelComparison {
    /// The parts that both models have.
    pub parts: Vec<PartComparison>,
    /// Parameters that only one of the models has.
    pub only_in_one: Vec<ModelParameter>,
    /// Recordings that both come from: then they are not independent, and the test finds less than it should.
    pub shared_recordings: Vec<String>,
    /// Numbers that are no estimates, and differ.
    pub different_constants: Vec<Cow<'static, str>>,
    /// In what the models were made from, they differ so.
    pub sources: SourceChanges,
}

/// Changes beside the bench itself that may explain that two models differ.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SourceChanges {
    /// Recordings that only the first model comes from.
    pub only_first: Vec<String>,
    /// Recordings that only the second model comes from.
    pub only_second: Vec<String>,
    /// True where the bench files have different contents.
    pub bench_file: bool,
    /// The versions of dynoid, first and second, where they differ.
    pub dynoid_versions: Option<(String, String)>,
}

/// One part, compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PartComparison {
    /// Which part.
    pub part: ComparedPart,
    /// Its parameters.
    pub parameters: Vec<ParameterComparison>,
    /// Wald's test of all of them together; none where all count as exact.
    pub test: Option<WaldTest>,
}

/// Wald's test that two sets of parameters are the same.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WaldTest {
    /// δᵀ (P₁ + P₂)⁻¹ δ over the number of parameters.
    #[serde(deserialize_with = "nan_if_null")]
    pub statistic: f64,
    /// Number of parameters.
    pub parameters: usize,
    /// Degrees of freedom of the covariances; null where infinite.
    #[serde(deserialize_with = "infinite_if_null")]
    pub degrees_of_freedom: f64,
    /// The probability of so large a difference by chance.
    #[serde(deserialize_with = "nan_if_null")]
    pub p_value: f64,
    /// The same with allowance for all parts that are tested (Bonferroni).
    #[serde(deserialize_with = "nan_if_null")]
    pub adjusted_p_value: f64,
}

/// One parameter in both models, SI.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ParameterComparison {
    /// Which parameter.
    pub parameter: ModelParameter,
    /// In the first model.
    #[serde(deserialize_with = "nan_if_null")]
    pub first: f64,
    /// In the second.
    #[serde(deserialize_with = "nan_if_null")]
    pub second: f64,
    /// Standard error of the difference; zero where both count as exact.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error: f64,
    /// Degrees of freedom of it; null where infinite.
    #[serde(deserialize_with = "infinite_if_null")]
    pub degrees_of_freedom: f64,
    /// 95 % interval of the second less the first.
    #[serde(deserialize_with = "nan_if_null")]
    pub difference: (f64, f64),
    /// The probability of so large a difference by chance; none where both count as exact.
    pub p_value: Option<f64>,
}

impl ModelComparison {
    /// Tells whether any part differs by more than chance explains.
    #[must_use]
    pub fn has_changed(&self) -> bool {
        self.parts.iter().any(PartComparison::has_changed)
    }
}

impl PartComparison {
    /// Tells whether the part differs by more than chance explains, with allowance for the number of parts. Numbers
    /// that both models take as exact differ where their values do.
    #[must_use]
    pub fn has_changed(&self) -> bool {
        let is_stated_otherwise = |one: &ParameterComparison| one.standard_error == 0.0 && one.first != one.second;
        self.test.is_some_and(|test| test.adjusted_p_value < CHANGED) || self.parameters.iter().any(is_stated_otherwise)
    }
}

/// Compares two models. Their errors count as independent: what they share, such as a stated inertia or a torque scale,
/// makes the test find less, never more.
///
/// # Source
/// Wald's test; Satterthwaite, Biometrics Bulletin 2 (1946) 110, for the degrees of freedom of a sum of variances.
#[must_use]
pub fn compare_models(first: &BenchModelDocument, second: &BenchModelDocument) -> ModelComparison {
    let both = [Uncertain::new(first), Uncertain::new(second)];
    let mut parts: Vec<PartComparison> =
        PARTS.iter().filter_map(|(part, which)| compared(*part, which, &both)).collect();
    let tested = parts.iter().filter(|part| part.test.is_some()).count() as f64;
    for test in parts.iter_mut().filter_map(|part| part.test.as_mut()) {
        test.adjusted_p_value = (tested * test.p_value).min(1.0);
    }
    let is_in = |of: &BenchModelDocument, which| of.model.value(which).is_some();
    let only = |which: &ModelParameter| is_in(first, *which) != is_in(second, *which);
    let (shared, sources) = sources(&first.provenance, &second.provenance);
    ModelComparison {
        parts,
        only_in_one: ModelParameter::ALL.into_iter().filter(only).collect(),
        shared_recordings: shared,
        different_constants: constants(&first.model, &second.model),
        sources,
    }
}

/// The recordings that both come from, and in what their sources differ. Recordings are the same if their contents are.
fn sources(first: &Provenance, second: &Provenance) -> (Vec<String>, SourceChanges) {
    let of = |one: &Provenance, other: &Provenance, shared: bool| -> Vec<String> {
        let is_in_other = |file: &UsedRecording| other.recordings.iter().any(|other| other.sha256 == file.sha256);
        one.recordings.iter().filter(|file| is_in_other(file) == shared).map(|file| file.file.clone()).collect()
    };
    let versions = (first.dynoid_version.clone(), second.dynoid_version.clone());
    let changes = SourceChanges {
        only_first: of(first, second, false),
        only_second: of(second, first, false),
        bench_file: first.bench_file.sha256 != second.bench_file.sha256,
        dynoid_versions: Some(versions).filter(|(first, second)| first != second),
    };
    (of(second, first, true), changes)
}

/// A model with the parts of its covariance.
struct Uncertain<'a> {
    model: &'a BenchModel,
    parts: Vec<PartCovariance>,
}

impl<'a> Uncertain<'a> {
    fn new(document: &'a BenchModelDocument) -> Self {
        Uncertain { model: &document.model, parts: document.uncertainty.clone().into() }
    }

    /// An entry of the covariance, and the degrees of freedom behind it.
    fn entry(&self, row: ModelParameter, column: ModelParameter) -> (f64, f64) {
        let of = |part: &PartCovariance| {
            let place = |which| part.parameters.iter().position(|other| *other == which);
            Some((part.covariance[place(row)?][place(column)?], part.degrees_of_freedom))
        };
        self.parts.iter().find_map(of).unwrap_or((0.0, f64::INFINITY))
    }
}

fn compared(part: ComparedPart, which: &[ModelParameter], both: &[Uncertain<'_>; 2]) -> Option<PartComparison> {
    let parameters: Vec<ParameterComparison> = which.iter().filter_map(|which| parameter(*which, both)).collect();
    let test = wald(&parameters, both);
    (!parameters.is_empty()).then_some(PartComparison { part, parameters, test })
}

fn parameter(which: ModelParameter, both: &[Uncertain<'_>; 2]) -> Option<ParameterComparison> {
    let (first, second) = (both[0].model.value(which)?, both[1].model.value(which)?);
    let variances = [0, 1].map(|i| both[i].entry(which, which));
    let total: f64 = variances.iter().map(|(variance, _)| variance).sum();
    let weighted: f64 = variances.iter().map(|(variance, degrees)| variance * variance / degrees).sum();
    let degrees_of_freedom = if weighted > 0.0 { total * total / weighted } else { f64::INFINITY };
    let standard_error = total.sqrt();
    let p_value = (total > 0.0).then(|| f_tail((second - first).powi(2) / total, 1.0, degrees_of_freedom));
    let difference = interval(second - first, standard_error, degrees_of_freedom, CONFIDENCE);
    Some(ParameterComparison {
        parameter: which,
        first,
        second,
        standard_error,
        degrees_of_freedom,
        difference,
        p_value,
    })
}

/// Of all parameters that are uncertain in either model, in units of their standard errors.
fn wald(parameters: &[ParameterComparison], both: &[Uncertain<'_>; 2]) -> Option<WaldTest> {
    let uncertain: Vec<&ParameterComparison> = parameters.iter().filter(|one| one.standard_error > 0.0).collect();
    let n = uncertain.len();
    if n == 0 {
        return None;
    }
    let covariance = |i: usize, j: usize| {
        let (row, column) = (uncertain[i], uncertain[j]);
        let sum: f64 = both.iter().map(|model| model.entry(row.parameter, column.parameter).0).sum();
        sum / (row.standard_error * column.standard_error)
    };
    let scaled = |i: usize| (uncertain[i].second - uncertain[i].first) / uncertain[i].standard_error;
    let difference = Mat::from_fn(n, 1, |i, _| scaled(i));
    let solved = least_norm(Mat::from_fn(n, n, covariance).as_ref(), difference.as_ref(), CERTAIN).ok()?;
    let statistic = (0..n).map(|i| difference[(i, 0)] * solved[(i, 0)]).sum::<f64>() / n as f64;
    let degrees_of_freedom = uncertain.iter().map(|one| one.degrees_of_freedom).fold(f64::INFINITY, f64::min);
    let p_value = f_tail(statistic, n as f64, degrees_of_freedom);
    Some(WaldTest { statistic, parameters: n, degrees_of_freedom, p_value, adjusted_p_value: p_value })
}

/// Names of the constants that differ; they are no estimates.
fn constants(first: &BenchModel, second: &BenchModel) -> Vec<Cow<'static, str>> {
    let differs = |name: &'static str, of: fn(&BenchModel) -> Option<f64>| (of(first) != of(second)).then_some(name);
    let tick = differs("sample time of the controller", |model| model.speed_controller.map(|pi| pi.sample_time_s));
    let limit = differs("limit of the torque demand", |model| model.torque_limit_nm);
    let lags = (first.demand_lags() != second.demand_lags()).then_some("whole samples of the controller's delay");
    [tick, limit, lags].into_iter().flatten().map(Cow::from).collect()
}
