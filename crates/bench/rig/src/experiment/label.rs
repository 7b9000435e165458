//! The name of an experiment: what was done, to what, in which control mode.

use std::fmt;
use std::str::FromStr;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::Test;

/// Quantity that is excited: the letter after the test's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Excitation {
    /// Torque (`T`).
    Torque,
    /// Speed (`N`).
    Speed,
}

/// Which quantity each side controls: the label's last two letters, dynamometer first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum ControlMode {
    /// The dynamometer controls speed, the engine torque (or throttle).
    Nt,
    /// The dynamometer controls torque, the engine speed.
    Tn,
}

/// The label of an experiment, `{test}_{T|N}_{NT|TN}`, e.g. `BS_T_NT` (thesis §4.1). Written and read as this text.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(with = "String"))]
pub struct ExperimentLabel {
    /// Test that is done.
    pub test: Test,
    /// Quantity that is excited.
    pub excitation: Excitation,
    /// Who controls what.
    pub mode: ControlMode,
}

impl fmt::Display for ExperimentLabel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let excitation = match self.excitation {
            Excitation::Torque => "T",
            Excitation::Speed => "N",
        };
        let mode = match self.mode {
            ControlMode::Nt => "NT",
            ControlMode::Tn => "TN",
        };
        write!(f, "{}_{excitation}_{mode}", self.test)
    }
}

impl Serialize for ExperimentLabel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for ExperimentLabel {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::from_written(&String::deserialize(deserializer)?).map_err(D::Error::custom)
    }
}

/// A text is not an experiment label.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` holds no experiment label of the form {{test}}_{{T|N}}_{{NT|TN}}, such as BS_T_NT")]
pub struct LabelError {
    /// The text that was searched.
    pub text: String,
}

impl FromStr for ExperimentLabel {
    type Err = LabelError;

    /// Finds the label in a text such as a file's name: `BS_T_NT`, `BS_T_NT_1200`, `2018-05-03 BS_T_NT 1200rpm`. The
    /// letter case of the test does not matter.
    fn from_str(text: &str) -> Result<Self, LabelError> {
        let words: Vec<&str> = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty()).collect();
        words.windows(3).find_map(label_from_words).ok_or_else(|| LabelError { text: text.to_owned() })
    }
}

impl ExperimentLabel {
    /// The label that is written so: all before the last two words is the test's name, whatever its characters. A text
    /// of another form is searched for a label.
    fn from_written(text: &str) -> Result<Self, LabelError> {
        let mut words = text.rsplitn(3, '_');
        let (mode, excitation, test) = (words.next(), words.next(), words.next());
        let whole = test.filter(|test| !test.is_empty()).and_then(|test| {
            let (excitation, mode) = (excitation.and_then(excitation_of)?, mode.and_then(mode_of)?);
            Some(ExperimentLabel { test: Test::from(test), excitation, mode })
        });
        whole.map_or_else(|| text.parse(), Ok)
    }

    /// Engine torque switched between two ignition angles.
    pub const BS_T_NT: Self = Self::new(Test::Bs, Excitation::Torque, ControlMode::Nt);
    /// Many levels and slopes of the speed.
    pub const LEVELS_N_NT: Self = Self::new(Test::Levels, Excitation::Speed, ControlMode::Nt);
    /// Sum of sines of the speed.
    pub const MULTISINE_N_NT: Self = Self::new(Test::Multisine, Excitation::Speed, ControlMode::Nt);
    /// Sum of sines of the torque.
    pub const MULTISINE_T_TN: Self = Self::new(Test::Multisine, Excitation::Torque, ControlMode::Tn);
    /// Ramps of the speed.
    pub const RAMP_N_NT: Self = Self::new(Test::Ramp, Excitation::Speed, ControlMode::Nt);
    /// Steps of the torque.
    pub const STEP_T_TN: Self = Self::new(Test::Step, Excitation::Torque, ControlMode::Tn);
    /// White torque.
    pub const WHITE_NOISE_T_TN: Self = Self::new(Test::WhiteNoise, Excitation::Torque, ControlMode::Tn);

    /// The label of a test that excites something in a mode.
    pub const fn new(test: Test, excitation: Excitation, mode: ControlMode) -> Self {
        ExperimentLabel { test, excitation, mode }
    }

    /// Tells whether the shaft is off: the dynamometer turns alone.
    pub fn is_without_shaft(&self) -> bool {
        self.test == Test::NoShaft
    }
}

fn excitation_of(word: &str) -> Option<Excitation> {
    match word {
        "T" => Some(Excitation::Torque),
        "N" => Some(Excitation::Speed),
        _ => None,
    }
}

fn mode_of(word: &str) -> Option<ControlMode> {
    match word {
        "NT" => Some(ControlMode::Nt),
        "TN" => Some(ControlMode::Tn),
        _ => None,
    }
}

fn label_from_words(words: &[&str]) -> Option<ExperimentLabel> {
    let [test, excitation, mode] = words else { return None };
    let (excitation, mode) = (excitation_of(excitation)?, mode_of(mode)?);
    test.starts_with(|c: char| c.is_ascii_alphabetic()).then(|| ExperimentLabel {
        test: Test::from(*test),
        excitation,
        mode,
    })
}
