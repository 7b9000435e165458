//! White noise, which a design is compared with.

use signal::excitation::Random;

use super::task::DesignTask;
use super::trial::{HeldDemand, Trials};
use crate::excitation_design::error::DesignError;

/// Realisations averaged over.
const REALISATIONS: u64 = 6;

/// Relative variances after white noise whose T_shaft peaks at 1 Nm.
pub(super) struct White {
    variances: Vec<f64>,
}

impl White {
    /// Of parameter `index`, after noise whose T_shaft peaks at `peak_nm`.
    pub(super) fn relative_variance(&self, index: usize, peak_nm: f64) -> f64 {
        self.variances[index] / (peak_nm * peak_nm)
    }
}

/// Normal noise at the rate of the demand, as long as the experiment, on the nominal model: the mean over realisations
/// of the variance it leaves at a peak of T_shaft of 1 Nm, each realisation scaled by its own peak.
///
/// Prior knowledge of nuisances does not shrink with the demand. Where there is a limit of T_shaft, the variances are
/// those at the peak that the limits allow.
pub(super) fn variances(task: &DesignTask, trials: &mut Trials<'_>) -> Result<White, DesignError> {
    let Some(nominal) = task.models.first() else { return Err(DesignError::Task { requirement: "a model is needed" }) };
    let peak = task.limits.shaft_torque_nm.unwrap_or(1.0);
    let mut variances = vec![0.0; task.of_interest.len()];
    for seed in 0..REALISATIONS {
        let mut random = Random::new(seed);
        let values = (0..task.all_steps()).map(|_| random.normal()).collect();
        let noise = HeldDemand { values };
        let reached = noise.peaks_on(task, nominal, 1)?.shaft_torque_nm;
        let judged = trials.judged(&noise.scaled(peak / reached), 0)?;
        for (i, variance) in variances.iter_mut().enumerate() {
            *variance += judged.covariance[(i, i)] * peak * peak / REALISATIONS as f64;
        }
    }
    Ok(White { variances })
}
