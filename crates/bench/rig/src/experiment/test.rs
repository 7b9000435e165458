//! Test of an experiment: the first part of its label.

use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// The test of an experiment (thesis §4.1). Written and read as its name, such as `BS`; letter case does not matter.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
pub enum Test {
    /// Engine torque switched between two ignition angles.
    Bs,
    /// White demand.
    WhiteNoise,
    /// Steps of the demand.
    Step,
    /// Ramps of the demand between two levels.
    Ramp,
    /// Demand over many levels and slopes.
    Levels,
    /// Sines, one after another.
    Sine,
    /// Motored engine, speed demand moved about one speed.
    Unfired,
    /// Shaft taken off.
    NoShaft,
    /// Sum of sines that repeats.
    Multisine,
    /// Binary demand of a designed spectrum.
    Binary,
    /// Demands of one's own.
    FreeForm,
    /// Any other, by its name.
    Other(String),
}

impl Test {
    /// The tests that have names of their own.
    const NAMED: [(Test, &'static str); 11] = [
        (Test::Bs, "BS"),
        (Test::WhiteNoise, "WhiteNoise"),
        (Test::Step, "Step"),
        (Test::Ramp, "Ramp"),
        (Test::Levels, "Levels"),
        (Test::Sine, "Sine"),
        (Test::Unfired, "Unfired"),
        (Test::NoShaft, "NoShaft"),
        (Test::Multisine, "Multisine"),
        (Test::Binary, "Binary"),
        (Test::FreeForm, "FreeForm"),
    ];

    /// Its name in a label.
    pub fn name(&self) -> &str {
        match self {
            Test::Other(name) => name,
            named => Self::NAMED.iter().find(|(test, _)| test == named).map_or("", |(_, name)| name),
        }
    }
}

impl From<&str> for Test {
    fn from(name: &str) -> Self {
        let named = Self::NAMED.into_iter().find(|(_, known)| known.eq_ignore_ascii_case(name));
        named.map_or_else(|| Test::Other(name.to_owned()), |(test, _)| test)
    }
}

impl From<String> for Test {
    fn from(name: String) -> Self {
        Test::from(name.as_str())
    }
}

impl From<Test> for String {
    fn from(test: Test) -> Self {
        test.name().to_owned()
    }
}

impl FromStr for Test {
    type Err = Infallible;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Ok(Test::from(name))
    }
}

impl fmt::Display for Test {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
