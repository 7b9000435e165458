//! Disturbances of the bench in its recordings.

use bench_model::disturbances::Disturbances;
use numerics::order;
use part_shaft::Parts;
use rig::Role;
use rig::estimation::noise_floor;

/// Noise of N_d, the median of all recordings, and the strongest line of the drive's ripple, as the torque control's
/// recording shows it. What an encoder reads once a turn, the engine may do as well: that error is the one of encoders
/// in general.
pub(crate) fn disturbances(parts: &Parts<'_>) -> Disturbances {
    let speeds = parts.experiments.iter().filter_map(|experiment| experiment.signals.get(&Role::DynoSpeed));
    let mut floors: Vec<f64> = speeds.map(noise_floor).filter(|floor| *floor > 0.0).collect();
    floors.sort_by(f64::total_cmp);
    let assumed = Disturbances::assumed();
    Disturbances {
        speed_noise_rad_s: order::quantile_of_sorted(&floors, 0.5).unwrap_or(assumed.speed_noise_rad_s),
        ripple: parts.torque_controls.best().and_then(|fit| fit.model.ripple.lines.first().copied()),
        ..assumed
    }
}
