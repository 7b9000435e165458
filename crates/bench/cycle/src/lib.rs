#![doc = include_str!("../README.md")]
//!
//! Everything is SI: rad/s, Nm, W. A [`Reference`] is straight between its values. The means of a [`Feedback`] over
//! each second are compared with the means of the reference, or with its values at the seconds, as the requirement set
//! says.
//!
//! ```
//! use cycle::{EngineMap, builtin};
//! let rpm = units::RPM_RAD_S;
//! let map = EngineMap::new(&[600.0 * rpm, 1400.0 * rpm, 2400.0 * rpm], &[500.0, 900.0, 600.0], None, None)?;
//! let whtc = builtin("whtc")?.reference(&map)?;
//! assert_eq!(whtc.speed_rad_s.len(), 1800);
//! # Ok::<(), cycle::CycleError>(())
//! ```

mod align;
mod band;
mod builtin;
mod denormalise;
mod engine_map;
mod error;
mod feedback;
mod modes;
mod omission;
mod own;
mod reference;
mod regression;
mod requirement;
mod text;
mod tone;
mod validation;
mod vehicle;

pub use align::find_start;
pub use band::{Excursion, ModeDeviation, speed_band, steady_modes};
pub use builtin::{Builtin, Kind, all, builtin, denormalised};
pub use denormalise::{Rule, SpeedScale};
pub use engine_map::EngineMap;
pub use error::CycleError;
pub use feedback::{Feedback, Points};
pub use modes::{Mode, NamedSpeed, SetPoint};
pub use omission::{Omission, Omitted, Rows};
pub use own::{Course, Judged, Own, Sensor};
pub use reference::{Reference, Scales};
pub use regression::Regression;
pub use requirement::{
    BandTolerance, Criterion, Limit, ModeTolerance, Of, RequirementSet, Signal, Statistic, requirement, requirements,
};
pub use tone::Samples;
pub use validation::{Checked, Validation, validate};
pub use vehicle::{Driver, Gearbox, Vehicle, VehicleRun};
