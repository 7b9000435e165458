//! Requirements that a test must meet.

use cycle::{Own, RequirementSet, Sensor, Signal, requirement};

use super::test::Test;
use crate::cli::can::CanArguments;
use crate::error::CliError;

/// Requirements that a test must meet.
pub(super) struct Wanted {
    pub(super) sets: Vec<RequirementSet>,
    pub(super) own: Vec<Own>,
}

impl Wanted {
    pub(super) fn of(arguments: &CanArguments, test: &Test) -> Result<Self, CliError> {
        let usage = |error: cycle::CycleError| CliError::Usage { what: error.to_string() };
        let names: Vec<&str> = match arguments.by.is_empty() {
            true => test.usual_set().into_iter().collect(),
            false => arguments.by.iter().map(String::as_str).collect(),
        };
        let sets = names.into_iter().map(requirement).collect::<Result<Vec<_>, _>>().map_err(usage)?;
        if let Some(set) = sets.iter().find(|set| !set.has_regressions()) {
            let what = format!(
                "--by {}: this set has no regressions; give one of 1065.514, 1036.545, whtc, nrtc, whsc",
                set.name
            );
            return Err(CliError::Usage { what });
        }
        let own = arguments.require.iter().map(|text| text.parse()).collect::<Result<Vec<_>, _>>().map_err(usage)?;
        Ok(Wanted { sets, own })
    }

    /// Tells whether a requirement uses the speed, or the torque, that follows the demand.
    pub(super) fn uses(&self, signal: Signal) -> bool {
        let sensor = if signal == Signal::Speed { Sensor::Speed } else { Sensor::Torque };
        self.sets.iter().any(|set| set.uses(signal)) || self.own.iter().any(|own| own.sensor() == sensor)
    }
}
