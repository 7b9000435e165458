//! Causes of lines.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

/// Where a line, or a broad peak, comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "cause", rename_all = "snake_case")]
pub enum Cause {
    /// A multiple of the engine's speed.
    Order {
        /// The multiple.
        #[serde(deserialize_with = "nan_if_null")]
        order: f64,
        /// True for the order of the firing, and for a multiple of it.
        is_firing: bool,
    },
    /// A multiple of the engine's speed above half the sample rate, which shows at another frequency.
    FoldedOrder {
        /// The multiple.
        #[serde(deserialize_with = "nan_if_null")]
        order: f64,
        /// Where it is, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        from_hz: f64,
    },
    /// In the demand itself: a sine of it, or what rounding makes of one.
    Demanded,
    /// An image of a sine, by a demand that is held: of a demanded one, or of an order to which a demand answers.
    HoldImage {
        /// The sine, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        of_hz: f64,
        /// How often the demand changes, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        held_hz: f64,
    },
    /// A sideband of the drive's ripple, in proportion to a torque that swings.
    RippleSideband {
        /// How it swings, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        of_hz: f64,
        /// The ripple, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        ripple_hz: f64,
    },
    /// A sideband of an order that swings with a demanded sine.
    OrderSideband {
        /// The order.
        #[serde(deserialize_with = "nan_if_null")]
        order: f64,
        /// The sine, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        demanded_hz: f64,
    },
    /// A multiple of the mains, such as the ripple of a rectifier.
    Mains {
        /// The multiple.
        multiple: u32,
        /// The mains, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        mains_hz: f64,
    },
    /// The resonance of the masses on the shaft: N_d and N_e swing against each other there as their inertias demand.
    StructuralResonance,
    /// A broad peak of what the masses move, whose cause the signals do not show.
    BroadHump,
    /// The resonance of a sensor.
    SensorResonance,
    /// One of several, or more of them at once.
    Undecided {
        /// Which.
        between: Vec<Cause>,
        /// A speed, rpm, at which they lie apart; none where no speed parts them.
        repeat_at_rpm: Option<f64>,
    },
    /// A frequency that does not follow the speed, and has no known cause.
    Unknown,
}
