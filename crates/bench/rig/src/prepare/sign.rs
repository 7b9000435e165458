//! The sign of the dynamometer's torque, from its effect on the speed.
//!
//! J_d dω_d/dt = T_shaft − T_d (6.1). Well below the shaft's resonance the train turns as one inertia, so −dω_d/dt
//! follows a torque that brakes with a positive sign. A speed controller moreover brakes when the dynamometer is too
//! fast: in control mode NT T_d follows ω_d itself when the disturbance comes from the engine.

use std::ops::RangeInclusive;

use signal::Signal;
use signal::derivative::central_difference;
use signal::resample::{Interpolation, interpolate_at};
use signal::spectrum::{Welch, cross_spectrum};

use crate::align::{common_window, cut};
use crate::bench_file::BenchFile;
use crate::diagnostics::{Finding, Severity};
use crate::estimation::EstimateError;
use crate::experiment::{ControlMode, Experiment};
use crate::prepare::log::Log;
use crate::role::Role;

/// Frequencies below every shaft's resonance and above thermal and reference drifts, Hz.
const BAND_HZ: RangeInclusive<f64> = 0.5..=4.0;
/// Length of the averaged segments, s.
const SEGMENT_S: f64 = 4.0;
/// Correlation beyond which the sign is certain.
const DECISIVE: f64 = 0.3;

/// Notes each torque of the dynamometer whose sign contradicts the convention.
pub(super) fn check(experiment: &Experiment, bench_file: &BenchFile, log: &mut Log) {
    for role in [Role::AirGapTorque, Role::LoadCellTorque, Role::DynoTorqueDemand] {
        if let Some(correlation) = wrong_sign(experiment, role) {
            let channel = bench_file.channels.get(&role).map_or(role.key(), |mapping| mapping.name.as_str());
            log.channel(Severity::Error, channel, None, Finding::WrongTorqueSign { correlation });
        }
    }
}

/// The correlation that contradicts the sign of a torque; none where it is right, or unknown.
pub fn wrong_sign(experiment: &Experiment, role: Role) -> Option<f64> {
    braking_correlation(experiment, role).filter(|correlation| *correlation < -DECISIVE)
}

/// Passes where the sign of T_d,calc is that of its effect on the speed, or is not known.
///
/// # Errors
/// It is the opposite one.
pub fn believable(experiment: &Experiment) -> Result<(), EstimateError> {
    let role = Role::AirGapTorque;
    match wrong_sign(experiment, role) {
        Some(_) => Err(EstimateError::WrongSign { file: experiment.file.clone(), role }),
        None => Ok(()),
    }
}

/// Correlation of a torque with what it does as a brake, positive if it brakes with a positive sign. Of the indicators
/// that the control mode allows, the clearer one.
fn braking_correlation(experiment: &Experiment, role: Role) -> Option<f64> {
    let window = common_window(experiment, &[role, Role::DynoSpeed])?;
    let torque = cut(experiment.signal(role)?, window.0, window.1);
    let times: Vec<f64> = (0..torque.len()).map(|i| torque.time_s(i)).collect();
    let speed = interpolate_at(experiment.signal(Role::DynoSpeed)?, &times, Interpolation::Linear).ok()?;
    let acceleration = central_difference(&speed, torque.sample_time_s).ok()?;
    let deceleration: Vec<f64> = acceleration.into_iter().map(|value| -value).collect();
    let by_inertia = correlation_in_band(&torque, &deceleration)?;
    let by_control = match experiment.label.mode {
        ControlMode::Nt => correlation_in_band(&torque, &speed).unwrap_or(0.0),
        ControlMode::Tn => 0.0,
    };
    Some(if by_control.abs() > by_inertia.abs() { by_control } else { by_inertia })
}

/// Σ Re S_xy / √(Σ S_xx Σ S_yy) over the band; `None` if the record is too short to hold it or does not move there.
fn correlation_in_band(x: &Signal, y: &[f64]) -> Option<f64> {
    let segment = ((SEGMENT_S / x.sample_time_s) as usize).min(x.len());
    if (segment as f64) * x.sample_time_s * BAND_HZ.start() < 1.0 {
        return None;
    }
    let spectrum = cross_spectrum(&x.samples, y, x.sample_time_s, Welch::half_overlapping(segment)).ok()?;
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (i, frequency) in spectrum.freq_hz.iter().enumerate() {
        if BAND_HZ.contains(frequency) {
            xx += spectrum.pxx[i];
            yy += spectrum.pyy[i];
            xy += spectrum.pxy[i].re;
        }
    }
    (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
}
