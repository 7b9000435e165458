//! Spectrum of an experiment's excitation.

use signal::SignalError;
use signal::spectrum::{Welch, power_spectrum};

use super::{DEMAND_HOLD_S, DemandKind, Demands, Excitation, ExperimentPlan, UPDATE_S};

/// Length of the segments over which powers are averaged, s: their inverse is the resolution.
const SEGMENT_S: f64 = 10.0;

/// Power density of the demand that excites a bench.
#[derive(Debug, Clone, PartialEq)]
pub struct ExcitationSpectrum {
    /// The demand.
    pub of: DemandKind,
    /// Frequencies above zero, Hz.
    pub frequency_hz: Vec<f64>,
    /// One-sided density, (unit of the demand)²/Hz.
    pub density: Vec<f64>,
}

impl Demands {
    /// The spectrum of what is excited: of the demands that change, the one the label speaks of first. None where no
    /// demand changes.
    ///
    /// # Errors
    /// An experiment too short for a spectrum.
    pub fn spectrum(&self, plan: &ExperimentPlan) -> Result<Option<ExcitationSpectrum>, SignalError> {
        let named = self.named(plan);
        let mut changing: Vec<_> =
            named.into_iter().filter(|demand| demand.values.windows(2).any(|pair| pair[0] != pair[1])).collect();
        changing.sort_by_key(|demand| demand.kind.is_speed() != (plan.label.excitation == Excitation::Speed));
        let Some(demand) = changing.first() else { return Ok(None) };
        let clock_s = if demand.kind.is_speed() { UPDATE_S } else { DEMAND_HOLD_S };
        let step = (clock_s / UPDATE_S).round() as usize;
        let scale = demand.kind.si_per_unit();
        let values: Vec<f64> = demand.values.iter().step_by(step).map(|value| value / scale).collect();
        let segment = ((SEGMENT_S / clock_s).round() as usize).min(values.len());
        let spectrum = power_spectrum(&values, clock_s, Welch::half_overlapping(segment))?;
        let (frequency_hz, density) =
            spectrum.freq_hz.into_iter().zip(spectrum.density).filter(|(f, _)| *f > 0.0).unzip();
        Ok(Some(ExcitationSpectrum { of: demand.kind, frequency_hz, density }))
    }
}
