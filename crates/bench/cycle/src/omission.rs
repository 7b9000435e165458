//! Which points may be left out of the regressions: 40 CFR 1065.514, Table 1.

use serde::{Deserialize, Serialize};

use crate::feedback::Points;
use crate::reference::Scales;

/// Operator's demand at or below this counts as least, at or above its mirror image as most.
const LEAST: f64 = 0.01;
/// Part of the largest torque within which a torque counts as reached.
const TORQUE_SHARE: f64 = 0.02;
/// Part of the reference speed within which a speed counts as reached.
const SPEED_SHARE: f64 = 0.02;
/// Speeds nearer to idle than this part of it are idle.
const IDLE_SHARE: f64 = 1e-6;

/// Part that a row with a choice leaves out beside power.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Omitted {
    /// The row is not used.
    Nothing,
    /// Power and torque.
    Torque,
    /// Power and speed.
    Speed,
}

/// One choice among the rows of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Omission {
    /// Least demand, negative reference torque: torque and power are left out.
    pub motoring: bool,
    /// Least demand at idle, torque within 2 % of the largest: speed and power are left out.
    pub idle: bool,
    /// Least demand, speed or torque above the reference.
    pub above: Omitted,
    /// Most demand, speed or torque below the reference.
    pub below: Omitted,
}

/// The rows that fit a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Rows {
    /// Motored at least demand.
    pub motoring: bool,
    /// Idle at least demand.
    pub idle: bool,
    /// Least demand, and above the reference.
    pub above: bool,
    /// Most demand, and below the reference.
    pub below: bool,
}

impl Omission {
    /// No point is left out.
    pub const NONE: Omission =
        Omission { motoring: false, idle: false, above: Omitted::Nothing, below: Omitted::Nothing };

    /// Every choice, the one that leaves out least first.
    pub(crate) fn choices() -> Vec<Omission> {
        const WHICH: [Omitted; 3] = [Omitted::Nothing, Omitted::Torque, Omitted::Speed];
        let mut all = Vec::with_capacity(36);
        for motoring in [false, true] {
            for idle in [false, true] {
                for above in WHICH {
                    all.extend(WHICH.map(|below| Omission { motoring, idle, above, below }));
                }
            }
        }
        all.sort_by_key(Omission::rows_used);
        all
    }

    fn rows_used(&self) -> usize {
        let which = |omitted: Omitted| usize::from(omitted != Omitted::Nothing);
        usize::from(self.motoring) + usize::from(self.idle) + which(self.above) + which(self.below)
    }

    /// Returns true if the point's speed stays in the regression.
    pub(crate) fn keeps_speed(&self, rows: Rows) -> bool {
        !(self.idle && rows.idle || self.leaves(rows, Omitted::Speed))
    }

    /// Returns true if its torque stays.
    pub(crate) fn keeps_torque(&self, rows: Rows) -> bool {
        !(self.motoring && rows.motoring || self.leaves(rows, Omitted::Torque))
    }

    /// Returns true if its power stays.
    pub(crate) fn keeps_power(&self, rows: Rows) -> bool {
        self.keeps_speed(rows) && self.keeps_torque(rows)
    }

    fn leaves(&self, rows: Rows, what: Omitted) -> bool {
        rows.above && self.above == what || rows.below && self.below == what
    }
}

impl Points {
    /// The rows that fit each point. Without a recorded demand it is least where the reference motors the engine or
    /// lets it idle, and never most.
    pub fn rows(&self, scales: &Scales) -> Vec<Rows> {
        (0..self.time_s.len()).map(|k| self.rows_of(k, scales)).collect()
    }

    fn rows_of(&self, k: usize, scales: &Scales) -> Rows {
        let (n_ref, t_ref) = (self.speed_reference_rad_s[k], self.torque_reference_nm[k]);
        let (n, t) = (self.speed_rad_s[k], self.torque_nm[k]);
        let near_nm = TORQUE_SHARE * scales.maximum_torque_nm;
        let at_idle = t_ref == 0.0 && n_ref <= scales.idle_rad_s * (1.0 + IDLE_SHARE);
        let is_least = self.demand.get(k).map_or(t_ref < 0.0 || at_idle, |demand| *demand <= LEAST);
        let is_most = self.demand.get(k).is_some_and(|demand| *demand >= 1.0 - LEAST);
        let far_above = n > (1.0 + SPEED_SHARE) * n_ref && t > t_ref + near_nm;
        let far_below = n < (1.0 - SPEED_SHARE) * n_ref && t < t_ref - near_nm;
        Rows {
            motoring: is_least && t_ref < 0.0,
            idle: is_least && at_idle && (t - t_ref).abs() < near_nm,
            above: is_least && (n > n_ref || t > t_ref) && !far_above,
            below: is_most && (n < n_ref || t < t_ref) && !far_below,
        }
    }
}
