//! Cycles of modes that are joined by ramps.

use serde::Deserialize;

use crate::denormalise::{Rule, SpeedScale};
use crate::engine_map::EngineMap;
use crate::error::CycleError;

const DATA: &str = include_str!("../data/modes.toml");

/// The speed of a mode.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum SetPoint {
    /// In % of the rule's scale.
    Percent(f64),
    /// By name.
    Named(NamedSpeed),
}

/// Speeds with names of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NamedSpeed {
    /// Warm idle.
    Idle,
    /// Intermediate test speed.
    Intermediate,
    /// Maximum test speed; for engines of constant speed the governed one.
    Maximum,
}

/// One mode.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mode {
    /// Its speed.
    pub speed: SetPoint,
    /// Its torque, % of the maximum.
    pub torque: f64,
    /// How long it lasts, ramp included, s.
    pub seconds: f64,
    /// How long the way from the mode before takes, s.
    pub ramp: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Modes {
    pub(crate) source: String,
    pub(crate) rule: Rule,
    #[serde(default)]
    of_test_torque: bool,
    pub(crate) modes: Vec<Mode>,
}

impl Modes {
    pub(crate) fn of(name: &'static str) -> Result<Self, CycleError> {
        let damaged = |near: String| CycleError::Data { name, near };
        let mut table: toml::Table = DATA.parse().map_err(|error: toml::de::Error| damaged(error.to_string()))?;
        let modes = table.remove(name).ok_or_else(|| damaged(name.to_owned()))?;
        modes.try_into().map_err(|error: toml::de::Error| damaged(error.to_string()))
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.modes.iter().map(|mode| mode.seconds).sum()
    }

    /// Speed and torque of each second from 0 on; what is between two modes is a ramp of speeds and torques.
    pub(crate) fn course(&self, map: &EngineMap) -> Vec<(f64, f64)> {
        let levels: Vec<(f64, f64)> = self.modes.iter().map(|mode| self.level(mode, map)).collect();
        let mut course = Vec::new();
        let mut begins = 0.0;
        for (k, mode) in self.modes.iter().enumerate() {
            let (to, from) = (levels[k], levels[k.saturating_sub(1)]);
            while (course.len() as f64) < begins + mode.seconds {
                let into = course.len() as f64 - begins;
                let share = if mode.ramp > 0.0 { (into / mode.ramp).min(1.0) } else { 1.0 };
                course.push((from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1)));
            }
            begins += mode.seconds;
        }
        course.extend(levels.last());
        course
    }

    fn level(&self, mode: &Mode, map: &EngineMap) -> (f64, f64) {
        let speed = match mode.speed {
            SetPoint::Percent(percent) => SpeedScale::of(self.rule, map).speed_rad_s(percent),
            SetPoint::Named(NamedSpeed::Idle) => map.idle_rad_s(),
            SetPoint::Named(NamedSpeed::Intermediate) => map.intermediate_test_speed_rad_s(),
            SetPoint::Named(NamedSpeed::Maximum) => map.maximum_test_speed_rad_s(),
        };
        let most_at = if self.of_test_torque { map.maximum_test_speed_rad_s() } else { speed };
        (speed, 0.01 * mode.torque * map.full_load_nm(most_at))
    }
}
