//! A sine or a gradient that is wanted, compared with what the benches can do.

use std::str::FromStr;

use numerics::null::{infinite_if_null, nan_if_null};
use numerics::parallel;
use serde::{Deserialize, Serialize};
use signal::proportion::Proportion;
use units::{Quantity, parse_value};

use crate::error::CapabilityError;
use crate::extremes::LimitOf;
use crate::gradient::{self, Gradient};
use crate::map::{Braked, MapInputs, SineOf, benches, nominal, one_bench, quantiles};

/// From this share of the benches on a wish can be had.
const ENOUGH: f64 = 0.95;

/// Wish, from a text such as `100 rpm at 2 Hz`, `20 Nm at 8 Hz`, `4000 rpm/s`.
///
/// # Example
/// ```
/// use capability::map::SineOf;
/// let wanted: capability::wanted::Wanted = "20 Nm at 8 Hz".parse()?;
/// let sine = capability::wanted::Wanted::Sine { of: SineOf::Torque, amplitude: 20.0, frequency_hz: 8.0 };
/// assert_eq!(wanted, sine);
/// # Ok::<(), capability::CapabilityError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Wanted {
    /// A sine about the mean.
    Sine {
        /// Of which demand.
        of: SineOf,
        /// Its amplitude, rad/s or Nm.
        #[serde(deserialize_with = "nan_if_null")]
        amplitude: f64,
        /// Its frequency, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        frequency_hz: f64,
    },
    /// A gradient of the speed, upwards and downwards.
    Gradient {
        /// rad/s².
        #[serde(deserialize_with = "nan_if_null")]
        rad_s2: f64,
    },
}

/// Answer of the benches at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WantedPlace {
    /// The speed, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// How many benches can do it.
    pub kept: Proportion,
    /// Most that 95 %, 50 % and 5 % of them can do, in the unit of what is wanted.
    #[serde(deserialize_with = "infinite_if_null")]
    pub largest: [f64; 3],
    /// The limit that binds on the nominal bench.
    pub binds: Option<LimitOf>,
}

/// The answer to a wish.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WantedAnswer {
    /// The wish.
    pub wanted: Wanted,
    /// At each speed.
    pub places: Vec<WantedPlace>,
}

impl WantedPlace {
    /// Tells whether 95 % of the benches can do it.
    pub fn is_yes(&self) -> bool {
        self.kept.estimate >= ENOUGH
    }
}

impl WantedAnswer {
    /// Tells whether it can be had at every speed.
    pub fn is_yes(&self) -> bool {
        self.places.iter().all(WantedPlace::is_yes)
    }
}

/// Compares a wish with what the benches can do, at some speeds.
///
/// # Errors
/// As [`crate::map::map`].
pub fn answer(inputs: &MapInputs<'_>, wanted: Wanted, speed_rad_s: &[f64]) -> Result<WantedAnswer, CapabilityError> {
    let one = |bench: &Braked| match wanted {
        Wanted::Sine { of, frequency_hz, .. } => one_bench(inputs, bench, of, &[frequency_hz], speed_rad_s),
        Wanted::Gradient { .. } => {
            let least = |found: Gradient| match found.up_rad_s2 <= found.down_rad_s2 {
                true => (found.up_rad_s2, found.binds[0]),
                false => (found.down_rad_s2, found.binds[1]),
            };
            let all = gradient::of_bench(inputs, bench, speed_rad_s, &[inputs.torque_nm]);
            Ok(all.into_iter().map(least).collect())
        }
    };
    let all = parallel::map(&benches(inputs)?, one).into_iter().collect::<Result<Vec<_>, _>>()?;
    let nominal = one(&nominal(inputs))?;
    let least = match wanted {
        Wanted::Sine { amplitude, .. } => amplitude,
        Wanted::Gradient { rad_s2 } => rad_s2,
    };
    let place = |(k, speed): (usize, &f64)| {
        let values: Vec<f64> = all.iter().map(|bench| bench[k].0).collect();
        WantedPlace {
            speed_rad_s: *speed,
            kept: Proportion::new(values.iter().filter(|value| **value > least).count(), values.len()),
            largest: quantiles(values),
            binds: nominal[k].1,
        }
    };
    Ok(WantedAnswer { wanted, places: speed_rad_s.iter().enumerate().map(place).collect() })
}

impl FromStr for Wanted {
    type Err = CapabilityError;

    fn from_str(text: &str) -> Result<Self, CapabilityError> {
        let fault = || CapabilityError::Wanted { text: text.to_owned() };
        let above_zero = |value: f64| (value.is_finite() && value > 0.0).then_some(value).ok_or_else(fault);
        let parse = |text: &str, quantity| parse_value(text.trim(), quantity).ok();
        let Some((amplitude, frequency)) = text.split_once(" at ") else {
            let rad_s2 = parse(text, Quantity::AngularAcceleration).ok_or_else(fault)?;
            return Ok(Wanted::Gradient { rad_s2: above_zero(rad_s2)? });
        };
        let number = frequency.trim().strip_suffix("Hz").ok_or_else(fault)?;
        let frequency_hz = above_zero(number.trim().parse().map_err(|_| fault())?)?;
        let of_speed = parse(amplitude, Quantity::AngularSpeed).map(|value| (SineOf::Speed, value));
        let of_torque = || parse(amplitude, Quantity::Torque).map(|value| (SineOf::Torque, value));
        let (of, amplitude) = of_speed.or_else(of_torque).ok_or_else(fault)?;
        Ok(Wanted::Sine { of, amplitude: above_zero(amplitude)?, frequency_hz })
    }
}
