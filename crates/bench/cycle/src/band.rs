//! Speed bands of vehicles, and tolerances of steady modes.

use numerics::null::nan_if_null;
use serde::{Deserialize, Serialize};

use crate::error::CycleError;
use crate::requirement::{BandTolerance, ModeTolerance};

/// m/s of a mile an hour.
const MPH_M_S: f64 = 0.447_04;

/// A time outside the band.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Excursion {
    /// When it begins, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub start_s: f64,
    /// How long it lasts, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub duration_s: f64,
    /// Largest distance from the band, m/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub beyond_m_s: f64,
    /// True if it is short enough.
    pub is_allowed: bool,
}

/// Every excursion of a vehicle's speed from the band about its schedule: at any moment the speed may be as far above
/// the highest and below the lowest scheduled speed within the time around that moment as the tolerance says.
///
/// `schedule_m_s` has a value each second from 0 on, straight in between; `speed_m_s` a value each `sample_time_s`.
///
/// # Errors
/// Too few values, a value that is no number.
///
/// # Source
/// 40 CFR 1066.425(b).
pub fn speed_band(
    schedule_m_s: &[f64],
    sample_time_s: f64,
    speed_m_s: &[f64],
    tolerance: &BandTolerance,
) -> Result<Vec<Excursion>, CycleError> {
    if schedule_m_s.len() < 2 || speed_m_s.is_empty() {
        return Err(CycleError::Length { what: "vehicle speed", expected: 2, found: schedule_m_s.len() });
    }
    if let Some(sample) = speed_m_s.iter().position(|value| !value.is_finite()) {
        return Err(CycleError::NotFinite { what: "vehicle speed", sample });
    }
    let mut excursions: Vec<Excursion> = Vec::new();
    let mut was_outside = false;
    for (k, speed) in speed_m_s.iter().enumerate() {
        let time_s = k as f64 * sample_time_s;
        let (low, high) = extremes(schedule_m_s, time_s - tolerance.around_s, time_s + tolerance.around_s);
        let room = tolerance.mph * MPH_M_S;
        let beyond_m_s = (speed - high - room).max(low - room - speed);
        let is_outside = beyond_m_s > 0.0;
        match (is_outside, was_outside, excursions.last_mut()) {
            (true, true, Some(last)) => {
                last.duration_s = time_s - last.start_s;
                last.beyond_m_s = last.beyond_m_s.max(beyond_m_s);
            }
            (true, ..) => {
                excursions.push(Excursion { start_s: time_s, duration_s: 0.0, beyond_m_s, is_allowed: true });
            }
            (false, true, Some(last)) => last.duration_s = time_s - last.start_s,
            _ => {}
        }
        was_outside = is_outside;
    }
    excursions.iter_mut().for_each(|one| one.is_allowed = one.duration_s <= tolerance.excursion_s);
    Ok(excursions)
}

/// Lowest and highest scheduled speed from one time to another; they are at seconds or at the ends.
fn extremes(schedule: &[f64], from_s: f64, to_s: f64) -> (f64, f64) {
    let last = (schedule.len() - 1) as f64;
    let (from, to) = (from_s.clamp(0.0, last), to_s.clamp(0.0, last));
    let at = |time: f64| {
        let (low, share) = (time.floor() as usize, time.fract());
        schedule[low] + share * (schedule[(low + 1).min(schedule.len() - 1)] - schedule[low])
    };
    let seconds = schedule[from.ceil() as usize..=to.floor() as usize].iter().copied();
    seconds
        .chain([at(from), at(to)])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// A mode's mean against its set point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ModeDeviation {
    /// Mean speed less its set point, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// Largest that is allowed, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_limit_rad_s: f64,
    /// Mean torque less its set point, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_nm: f64,
    /// Largest that is allowed, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torque_limit_nm: f64,
}

impl ModeDeviation {
    /// Returns true if both are allowed.
    pub fn passes(&self) -> bool {
        self.speed_rad_s.abs() <= self.speed_limit_rad_s && self.torque_nm.abs() <= self.torque_limit_nm
    }
}

/// The deviation of one mode: means and set points of speed and torque, the maximum test speed, and the largest torque
/// at the speed of the mode; rad/s and Nm.
pub fn steady_modes(
    mean_rad_s: f64,
    mean_nm: f64,
    set_rad_s: f64,
    set_nm: f64,
    maximum_test_speed_rad_s: f64,
    largest_nm: f64,
    tolerance: &ModeTolerance,
) -> ModeDeviation {
    let of_speed = 0.01 * tolerance.speed_percent * maximum_test_speed_rad_s;
    ModeDeviation {
        speed_rad_s: mean_rad_s - set_rad_s,
        speed_limit_rad_s: of_speed.max(tolerance.speed_rpm * units::RPM_RAD_S),
        torque_nm: mean_nm - set_nm,
        torque_limit_nm: 0.01 * tolerance.torque_percent * largest_nm,
    }
}
