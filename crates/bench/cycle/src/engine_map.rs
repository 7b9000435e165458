//! The full-load curve of an engine, and the speeds that regulations derive from it.

use crate::error::CycleError;

/// Points of the finest grid on which a map is searched.
const GRID: usize = 20_000;

/// Motoring torque over full-load torque where no motoring curve is given: 40 CFR 1065.510(c).
const MOTORING_SHARE: f64 = -0.4;

/// Torque over speed at full load, straight between its points.
#[derive(Debug, Clone, PartialEq)]
pub struct EngineMap {
    speed_rad_s: Vec<f64>,
    torque_nm: Vec<f64>,
    motoring_nm: Option<Vec<f64>>,
    idle_rad_s: f64,
}

impl EngineMap {
    /// A map with speeds that rise, rad/s, full-load torques and, where they were measured, motoring torques
    /// (negative), Nm. The idle speed is the lowest one unless it is given.
    ///
    /// # Errors
    /// [`CycleError::Map`] names the row.
    pub fn new(
        speed_rad_s: &[f64],
        torque_nm: &[f64],
        motoring_nm: Option<&[f64]>,
        idle_rad_s: Option<f64>,
    ) -> Result<Self, CycleError> {
        let fault = |row: usize, problem| Err(CycleError::Map { row, problem });
        let motoring = motoring_nm.unwrap_or(torque_nm);
        if speed_rad_s.len() < 3 || speed_rad_s.len() != torque_nm.len() || motoring.len() != torque_nm.len() {
            return fault(speed_rad_s.len(), "a map needs three rows or more, each with a speed and a torque");
        }
        for row in 0..speed_rad_s.len() {
            let is_finite = [speed_rad_s[row], torque_nm[row], motoring[row]].iter().all(|value| value.is_finite());
            if !is_finite {
                return fault(row + 1, "a value is no number; fill it in, or delete the row");
            }
            if speed_rad_s[row] <= 0.0 || row > 0 && speed_rad_s[row] <= speed_rad_s[row - 1] {
                return fault(row + 1, "speeds must be above 0 and rise from row to row; sort the rows");
            }
            if torque_nm[row] < 0.0 {
                return fault(row + 1, "the full-load torque is negative; give the sign by which the engine drives");
            }
            if motoring_nm.is_some() && motoring[row] > 0.0 {
                return fault(row + 1, "the motoring torque is positive; give it with a minus sign");
            }
        }
        if torque_nm.iter().all(|torque| *torque == 0.0) {
            return fault(1, "no torque is above 0");
        }
        let idle_rad_s = idle_rad_s.unwrap_or(speed_rad_s[0]);
        if !(idle_rad_s > 0.0 && idle_rad_s < speed_rad_s[speed_rad_s.len() - 1]) {
            return fault(1, "the idle speed is outside the map");
        }
        Ok(EngineMap {
            speed_rad_s: speed_rad_s.to_vec(),
            torque_nm: torque_nm.to_vec(),
            motoring_nm: motoring_nm.map(<[f64]>::to_vec),
            idle_rad_s,
        })
    }

    /// Warm idle speed, rad/s.
    pub fn idle_rad_s(&self) -> f64 {
        self.idle_rad_s
    }

    /// Lowest speed of the map, rad/s.
    pub fn lowest_rad_s(&self) -> f64 {
        self.speed_rad_s[0]
    }

    /// Highest speed of the map, rad/s.
    pub fn highest_rad_s(&self) -> f64 {
        self.speed_rad_s[self.speed_rad_s.len() - 1]
    }

    /// Returns true if a motoring curve was measured.
    pub fn has_motoring(&self) -> bool {
        self.motoring_nm.is_some()
    }

    /// Full-load torque at a speed, Nm; beyond the map that of its end.
    pub fn full_load_nm(&self, speed_rad_s: f64) -> f64 {
        interpolated(&self.speed_rad_s, &self.torque_nm, speed_rad_s)
    }

    /// Motoring torque at a speed, Nm: the curve measured, or −40 % of the full load.
    pub fn motoring_nm(&self, speed_rad_s: f64) -> f64 {
        match &self.motoring_nm {
            Some(motoring) => interpolated(&self.speed_rad_s, motoring, speed_rad_s),
            None => MOTORING_SHARE * self.full_load_nm(speed_rad_s),
        }
    }

    /// Largest full-load torque, Nm.
    pub fn maximum_torque_nm(&self) -> f64 {
        self.torque_nm.iter().copied().fold(0.0, f64::max)
    }

    /// Speed of the largest torque, rad/s; the lowest one of several.
    pub fn peak_torque_speed_rad_s(&self) -> f64 {
        let most = self.maximum_torque_nm();
        self.torque_nm.iter().position(|torque| *torque >= most).map_or(self.speed_rad_s[0], |at| self.speed_rad_s[at])
    }

    /// Largest power, W.
    pub fn maximum_power_w(&self) -> f64 {
        self.grid().map(|speed| self.power_w(speed)).fold(0.0, f64::max)
    }

    /// Lowest speed at which the engine gives a share of its largest power, rad/s.
    pub fn lowest_with_power_rad_s(&self, share: f64) -> f64 {
        let least = share * self.maximum_power_w();
        self.grid().find(|speed| self.power_w(*speed) >= least).unwrap_or(self.speed_rad_s[0])
    }

    /// Highest speed at which the engine gives a share of its largest power, rad/s; the end of the map where it never
    /// falls below.
    pub fn highest_with_power_rad_s(&self, share: f64) -> f64 {
        let least = share * self.maximum_power_w();
        self.grid().filter(|speed| self.power_w(*speed) >= least).last().unwrap_or_else(|| self.highest_rad_s())
    }

    /// n_pref of the WHTC: below it lies 51 % of the integral of full-load torque from idle to the highest speed with
    /// 95 % of the power.
    pub fn preferred_rad_s(&self) -> f64 {
        let (from, to) = (self.idle_rad_s, self.highest_with_power_rad_s(0.95));
        let step = (to - from) / GRID as f64;
        let torque = |k: usize| self.full_load_nm(from + (k as f64 + 0.5) * step);
        let whole: f64 = (0..GRID).map(torque).sum();
        let mut below = 0.0;
        for k in 0..GRID {
            below += torque(k);
            if below >= 0.51 * whole {
                return from + (k as f64 + 1.0) * step;
            }
        }
        to
    }

    /// Maximum test speed of 40 CFR 1065.610(a): speed and power are divided by those of the largest power; the middle
    /// between the lowest and the highest speed at which the sum of their squares is at least 98 % of the largest one.
    pub fn maximum_test_speed_rad_s(&self) -> f64 {
        let most_w = self.maximum_power_w();
        let at_power = self.grid().find(|speed| self.power_w(*speed) >= most_w).unwrap_or_else(|| self.highest_rad_s());
        let squares = |speed: f64| (speed / at_power).powi(2) + (self.power_w(speed) / most_w).powi(2);
        let largest = self.grid().map(squares).fold(0.0, f64::max);
        let mut above = self.grid().filter(|speed| squares(*speed) >= 0.98 * largest);
        let lowest = above.next().unwrap_or(at_power);
        0.5 * (lowest + above.last().unwrap_or(lowest))
    }

    /// Intermediate test speed of 40 CFR 1065.610(c): that of the largest torque, within 60 … 75 % of the maximum test
    /// speed.
    pub fn intermediate_test_speed_rad_s(&self) -> f64 {
        let most = self.maximum_test_speed_rad_s();
        self.peak_torque_speed_rad_s().clamp(0.6 * most, 0.75 * most)
    }

    fn power_w(&self, speed_rad_s: f64) -> f64 {
        speed_rad_s * self.full_load_nm(speed_rad_s)
    }

    /// Speeds that cover the map, its points among them as near as the grid is fine.
    fn grid(&self) -> impl Iterator<Item = f64> {
        let (from, to) = (self.speed_rad_s[0], self.highest_rad_s());
        (0..=GRID).map(move |k| from + (to - from) * k as f64 / GRID as f64)
    }
}

/// A value between points, straight; beyond them that of the end.
fn interpolated(x: &[f64], y: &[f64], at: f64) -> f64 {
    let above = x.partition_point(|point| *point <= at);
    match (above, x.get(above)) {
        (0, _) => y[0],
        (_, None) => y[y.len() - 1],
        (_, Some(next)) => {
            let (low, share) = (above - 1, (at - x[above - 1]) / (next - x[above - 1]));
            y[low] + share * (y[above] - y[low])
        }
    }
}
