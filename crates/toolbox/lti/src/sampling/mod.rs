//! From continuous to discrete time, back, and from one sample time to another.

mod hold;
mod matched;
mod roots;
mod state_space;
mod transfer_function;
mod tustin;
mod zero_pole_gain;

use serde::{Deserialize, Serialize};

/// Property that a discrete system keeps of its continuous one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Discretisation {
    /// The response to inputs held between the samples.
    ZeroOrderHold,
    /// The response to inputs that run straight between the samples.
    FirstOrderHold,
    /// The bilinear map `s = (2/T)(z − 1)/(z + 1)`: stability and the shape of the frequency response. With a frequency
    /// `ω`, `s = ω/tan(ωT/2) · (z − 1)/(z + 1)`, so that the response is right there as well as at rest.
    Tustin {
        /// Where the response is kept, in rad/s, below the Nyquist frequency.
        prewarp_rad_s: Option<f64>,
    },
    /// The impulse response at the samples, times the sample time.
    ImpulseInvariant,
    /// Poles and zeros by `z = e^{sT}` and the gain at rest. Zeros at infinity go to −1, all but one.
    Matched,
}
