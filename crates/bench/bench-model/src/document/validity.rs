//! Where a model is valid: the range of the recordings that it was estimated from.

use serde::{Deserialize, Serialize};

/// The lowest and the highest value.
pub type Range = (f64, f64);

/// The range of the recordings that a model was estimated from; null where they do not show it. Outside of it the model
/// is an extrapolation that no recording has tested.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Validity {
    /// N_d, rad/s.
    #[serde(default)]
    pub dyno_speed_rad_s: Option<Range>,
    /// T_d, Nm.
    #[serde(default)]
    pub air_gap_torque_nm: Option<Range>,
    /// Frequencies that the shaft was estimated from, Hz.
    #[serde(default)]
    pub frequency_hz: Option<Range>,
}

impl Validity {
    /// Tells whether speed and torque are within the range; a value without a range is not tested.
    ///
    /// # Example
    /// ```
    /// use bench_model::document::Validity;
    /// let validity = Validity { dyno_speed_rad_s: Some((80.0, 320.0)), ..Validity::default() };
    /// assert!(validity.contains(100.0, 500.0));
    /// assert!(!validity.contains(60.0, 0.0));
    /// ```
    #[must_use]
    pub fn contains(&self, dyno_speed_rad_s: f64, air_gap_torque_nm: f64) -> bool {
        let within = |range: Option<Range>, value: f64| range.is_none_or(|(low, high)| low <= value && value <= high);
        within(self.dyno_speed_rad_s, dyno_speed_rad_s) && within(self.air_gap_torque_nm, air_gap_torque_nm)
    }

    /// The range of several values, NaN left out; `None` if there is none.
    #[must_use]
    pub fn range_of(values: impl IntoIterator<Item = f64>) -> Option<Range> {
        let finite = values.into_iter().filter(|value| value.is_finite());
        finite.fold(None, |range, value| match range {
            None => Some((value, value)),
            Some((low, high)) => Some((value.min(low), value.max(high))),
        })
    }
}
