//! The resonance of the two masses in torque control, in closed form.

use std::f64::consts::TAU;

use super::Mechanics;

/// Resonance of T_d → T_shaft (7.2) and its pole pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// Frequency of the largest gain, Hz.
    pub frequency_hz: f64,
    /// The gain there.
    pub gain: f64,
    /// Damping ratio of the pole pair.
    pub damping_ratio: f64,
    /// Undamped natural frequency of the pole pair, √(K(1/J_d + 1/J_e))/2π, Hz.
    pub natural_frequency_hz: f64,
}

impl Mechanics {
    /// μ = 1/J_d + 1/J_e, 1/(kg m²).
    pub fn mobility(&self) -> f64 {
        1.0 / self.dyno_inertia_kg_m2 + 1.0 / self.engine_inertia_kg_m2
    }

    /// Static gain of T_d → T_shaft, J_e/(J_d + J_e).
    pub fn static_gain(&self) -> f64 {
        self.engine_inertia_kg_m2 / (self.dyno_inertia_kg_m2 + self.engine_inertia_kg_m2)
    }

    /// The resonance of (7.2), which is (K + B s)/J_d / (s² + B μ s + K μ) with μ = 1/J_d + 1/J_e.
    ///
    /// The poles have ω_0 = √(Kμ) and ζ = B ω_0/(2K). |·|² at x = ω² is (K² + B² x)/((Kμ − x)² + B²μ²x)/J_d²; its
    /// derivative vanishes where B²x² + 2K²x − 2K³μ = 0, so the peak is at ω² = 2Kμ/(1 + √(1 + 2B²μ/K)).
    ///
    /// # Example
    /// ```
    /// let bench = bench_model::model::Mechanics {
    ///     dyno_inertia_kg_m2: 0.6,
    ///     engine_inertia_kg_m2: 0.28,
    ///     stiffness_nm_per_rad: 2437.7,
    ///     damping_nm_s_per_rad: 5.8,
    /// };
    /// assert!((bench.resonance().natural_frequency_hz - 17.98).abs() < 0.01);
    /// ```
    pub fn resonance(&self) -> Resonance {
        let (k, b, mu) = (self.stiffness_nm_per_rad, self.damping_nm_s_per_rad, self.mobility());
        let natural_squared = k * mu;
        let peak_squared = 2.0 * natural_squared / (1.0 + (1.0 + 2.0 * b * b * mu / k).sqrt());
        let numerator = k * k + b * b * peak_squared;
        let denominator = (natural_squared - peak_squared).powi(2) + b * b * mu * mu * peak_squared;
        Resonance {
            frequency_hz: peak_squared.sqrt() / TAU,
            gain: (numerator / denominator).sqrt() / self.dyno_inertia_kg_m2,
            damping_ratio: 0.5 * b * natural_squared.sqrt() / k,
            natural_frequency_hz: natural_squared.sqrt() / TAU,
        }
    }
}
