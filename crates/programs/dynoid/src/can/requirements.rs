//! Requirements that a test must meet.

use cycle::{Own, RequirementSet, Sensor, Signal, requirement};

use super::test::Test;
use crate::error::Error;

/// Requirements that a test must meet.
#[derive(Debug, Clone)]
pub struct Requirements {
    /// Requirement sets of the law.
    pub sets: Vec<RequirementSet>,
    /// Requirements of one's own.
    pub own: Vec<Own>,
}

impl Requirements {
    /// The sets of these names, or that of the test where none is named, and requirements of one's own, such as
    /// `speed overshoot below 5 %`.
    ///
    /// # Errors
    /// A set that is not known or has no regressions, and a text that is no requirement.
    pub fn of(test: &Test, sets: &[String], own: &[String]) -> Result<Self, Error> {
        let refused = |source: cycle::CycleError| Error::Requirement { source };
        let names: Vec<&str> = match sets {
            [] => test.usual_set().into_iter().collect(),
            named => named.iter().map(String::as_str).collect(),
        };
        let sets = names.into_iter().map(requirement).collect::<Result<Vec<_>, _>>().map_err(refused)?;
        if let Some(set) = sets.iter().find(|set| !set.has_regressions()) {
            return Err(Error::NoRegressions { set: set.name.to_string() });
        }
        let own = own.iter().map(|text| text.parse()).collect::<Result<Vec<_>, _>>().map_err(refused)?;
        Ok(Requirements { sets, own })
    }

    /// Tells whether a requirement uses the speed, or the torque, that follows the demand.
    pub(super) fn uses(&self, signal: Signal) -> bool {
        let sensor = if signal == Signal::Speed { Sensor::Speed } else { Sensor::Torque };
        self.sets.iter().any(|set| set.uses(signal)) || self.own.iter().any(|own| own.sensor() == sensor)
    }
}
