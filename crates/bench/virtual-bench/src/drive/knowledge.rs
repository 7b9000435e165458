//! How the torque that the drive computes differs from the machine's.

use rig::bench_parameters::{BenchParameters, MachineKnowledge};
use rig::facts::BenchVariant;

/// Torque below which the adaptation slows down, Nm: at no torque there is nothing to learn from.
const SLOW_BELOW_NM: f64 = 5.0;

/// g of [`MachineKnowledge`], stepped exactly for torques held between updates.
#[derive(Debug, Clone)]
pub(crate) struct Knowledge {
    parameters: MachineKnowledge,
    update_s: f64,
    /// e^{−T/τ_ϑ}.
    stays: f64,
    temperature_rise_k: f64,
    adapted: f64,
}

impl Knowledge {
    /// A cold machine that the drive has not yet adapted to.
    pub(crate) fn new(parameters: &BenchParameters, update_s: f64) -> Self {
        let mut knowledge = parameters.drive.knowledge;
        if parameters.variant == BenchVariant::TorqueFlange {
            knowledge.adaptation_time_s = 0.0;
        }
        let stays = (-update_s / knowledge.thermal_time_s).exp();
        Self { parameters: knowledge, update_s, stays, temperature_rise_k: 0.0, adapted: 0.0 }
    }

    /// g = T_d/T_d,calc.
    pub(crate) fn gain(&self) -> f64 {
        let error = self.parameters.cold_error + self.parameters.error_per_k * self.temperature_rise_k;
        (1.0 + error) / (1.0 + self.adapted)
    }

    /// One update with the torque as it is, as computed, and as the load cell reads it.
    pub(crate) fn update(&mut self, air_gap_nm: f64, computed_nm: f64, cell_nm: f64) {
        let towards_k = self.parameters.heating_k_per_nm2 * air_gap_nm * air_gap_nm;
        self.temperature_rise_k = towards_k + (self.temperature_rise_k - towards_k) * self.stays;
        if self.parameters.adaptation_time_s > 0.0 {
            let size = computed_nm * computed_nm + SLOW_BELOW_NM * SLOW_BELOW_NM;
            let error = (cell_nm - computed_nm) * computed_nm / size;
            self.adapted += error * self.update_s / self.parameters.adaptation_time_s;
        }
    }
}
