//! Measured against modelled, on data an estimate has not seen.

use serde::de::Error;
use serde::ser::SerializeStruct;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::estimate::Stretch;
use numerics::null::nan_if_null;

/// A uniformly sampled curve for plots, in the unit people use.
///
/// A document holds where it starts, its sample time and its number of samples; the values belong into a table beside
/// it. What is read from a document has NaN for each value until the table is read too.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "ReadTrace"))]
pub struct Trace {
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Sample time, s.
    pub sample_time_s: f64,
    /// Values.
    pub values: Vec<f64>,
}

/// A sample that is missing in both (NaN) counts as the same.
impl PartialEq for Trace {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
        (self.start_s, self.sample_time_s, self.values.len())
            == (other.start_s, other.sample_time_s, other.values.len())
            && self.values.iter().zip(&other.values).all(same)
    }
}

impl Serialize for Trace {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Trace", 3)?;
        fields.serialize_field("start_s", &self.start_s)?;
        fields.serialize_field("sample_time_s", &self.sample_time_s)?;
        fields.serialize_field("samples", &self.values.len())?;
        fields.end()
    }
}

/// A trace as a document has it.
#[derive(Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ReadTrace {
    start_s: f64,
    sample_time_s: f64,
    samples: usize,
}

/// Samples beyond which a trace is taken as damaged: 28 hours at 1 kHz. Its values take memory before the table is
/// read, so a damaged number must not ask for more than a machine has.
const MOST_SAMPLES: usize = 100_000_000;

impl<'de> Deserialize<'de> for Trace {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let ReadTrace { start_s, sample_time_s, samples } = ReadTrace::deserialize(deserializer)?;
        if samples > MOST_SAMPLES {
            let reason = format!("`samples` is {samples}, and a trace has at most {MOST_SAMPLES}");
            return Err(D::Error::custom(reason));
        }
        Ok(Trace { start_s, sample_time_s, values: vec![f64::NAN; samples] })
    }
}

/// Measured against modelled, on data the estimate has not seen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Validation {
    /// The held-out stretch.
    pub stretch: Stretch,
    /// Quantity that is compared, e.g. `T_d*`.
    pub quantity: String,
    /// Unit of the traces.
    pub unit: String,
    /// 100(1 − ‖y − ŷ‖/‖y − ȳ‖).
    #[serde(deserialize_with = "nan_if_null")]
    pub fit_percent: f64,
    /// Root of the mean squared error, in `unit`.
    #[serde(deserialize_with = "nan_if_null")]
    pub rms_error: f64,
    /// Measured.
    pub measured: Trace,
    /// Modelled.
    pub modelled: Trace,
    /// Residual tests, where the sampling makes them meaningful.
    pub residuals: Option<ResidualTest>,
}

/// Residual correlations with their region of confidence (Ljung 1999, §16.6; thesis §2.3.5).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ResidualTest {
    /// Sample time of the residuals, s.
    pub sample_time_s: f64,
    /// Level of the regions, e.g. 0.99.
    pub level: f64,
    /// Autocorrelation at lags 0…M, normalised to one at lag 0.
    #[serde(deserialize_with = "nan_if_null")]
    pub autocorrelation: Vec<f64>,
    /// Half-width of the region for the autocorrelation at lags 1…M.
    #[serde(deserialize_with = "nan_if_null")]
    pub autocorrelation_bound: f64,
    /// Cross-correlation of residual and past input at lags −M…M, normalised. Positive lags: the input comes first.
    #[serde(deserialize_with = "nan_if_null")]
    pub cross_correlation: Vec<f64>,
    /// Half-width of the region for each cross-correlation lag.
    #[serde(deserialize_with = "nan_if_null")]
    pub cross_correlation_bound: f64,
    /// Name of the input.
    pub input: String,
}

impl ResidualTest {
    /// Share of lags outside the region beyond which residuals may depend on the input. The lags of a slow input stand
    /// or fall together: by chance that happens in one recording of a hundred, whatever their number.
    const MANY_OUTSIDE: f64 = 0.05;
    /// A correlation that explains less than 1 % of the residual's variance moves no result, however certain many
    /// samples make it.
    const RELEVANT: f64 = 0.1;

    /// Tells whether the residual depends on present and past input, by more than chance and by enough to matter.
    pub fn depends_on_input(&self) -> bool {
        let matters = self.past().iter().any(|c| c.abs() > Self::RELEVANT);
        matters && self.has_many_outside()
    }

    /// Tells whether more lags are outside the region than chance puts there.
    pub fn has_many_outside(&self) -> bool {
        self.share_outside() > Self::MANY_OUTSIDE
    }

    fn past(&self) -> &[f64] {
        &self.cross_correlation[self.cross_correlation.len() / 2..]
    }

    /// Share of the lags 0…M at which the residual depends on present and past input beyond the region.
    pub fn share_outside(&self) -> f64 {
        let past = self.past();
        let outside = past.iter().filter(|c| c.abs() > self.cross_correlation_bound).count();
        outside as f64 / past.len().max(1) as f64
    }
}
