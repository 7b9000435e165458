//! From per cent to speeds and torques.

use serde::Deserialize;

use crate::engine_map::EngineMap;

/// By which rule a speed in % becomes one in rad/s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Rule {
    /// 40 CFR 1065.610(c): n = % (n_test − n_idle) + n_idle.
    #[serde(rename = "1065")]
    Cfr1065,
    /// GTR 4 and R49: n = % (0.45 n_lo + 0.45 n_pref + 0.1 n_hi − n_idle) 2.0327 + n_idle.
    #[serde(rename = "whtc")]
    Whtc,
    /// NRTC of the EU: as 1065.610, with the maximum test speed of that text.
    #[serde(rename = "nrtc")]
    Nrtc,
}

/// 100 % and 0 % of a speed scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedScale {
    idle_rad_s: f64,
    span_rad_s: f64,
}

impl SpeedScale {
    /// The scale of a rule on an engine.
    pub fn of(rule: Rule, map: &EngineMap) -> Self {
        let idle_rad_s = map.idle_rad_s();
        match rule {
            Rule::Cfr1065 | Rule::Nrtc => SpeedScale::between(idle_rad_s, map.maximum_test_speed_rad_s()),
            Rule::Whtc => SpeedScale::whtc(
                map.lowest_with_power_rad_s(0.55),
                map.preferred_rad_s(),
                map.highest_with_power_rad_s(0.7),
                idle_rad_s,
            ),
        }
    }

    /// Straight from idle at 0 % to a speed at 100 %, rad/s.
    pub fn between(idle_rad_s: f64, full_rad_s: f64) -> Self {
        SpeedScale { idle_rad_s, span_rad_s: full_rad_s - idle_rad_s }
    }

    /// By n_lo, n_pref and n_hi of the WHTC, rad/s.
    pub fn whtc(low: f64, preferred: f64, high: f64, idle_rad_s: f64) -> Self {
        SpeedScale { idle_rad_s, span_rad_s: 2.0327 * (0.45 * low + 0.45 * preferred + 0.1 * high - idle_rad_s) }
    }

    /// The speed of a per cent, rad/s.
    pub fn speed_rad_s(&self, percent: f64) -> f64 {
        self.idle_rad_s + 0.01 * percent * self.span_rad_s
    }
}
