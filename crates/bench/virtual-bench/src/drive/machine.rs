//! The induction machine, stepped exactly for a speed and a voltage that stay over the step.

use lti::Complex64;
use rig::bench_parameters::InductionMachine;

/// Modulus of q h below which sinh(q h)/q is taken from its series.
const SMALL: f64 = 1e-4;

/// Stator current and rotor flux, d + jq in the frame of the control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Electrical {
    pub(super) current_a: Complex64,
    pub(super) flux_vs: Complex64,
}

/// The machine's constants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Machine {
    pub(super) pole_pairs: f64,
    pub(super) stator_resistance: f64,
    /// R_s + (L_m/L_r)² R_r.
    pub(super) resistance: f64,
    /// σL_s.
    pub(super) leakage: f64,
    /// L_m/L_r.
    pub(super) coupling: f64,
    pub(super) magnetising: f64,
    /// R_r/L_r.
    pub(super) rotor_rate: f64,
}

impl Machine {
    pub(super) fn new(parameters: &InductionMachine) -> Self {
        let rotor = parameters.magnetising_h + parameters.rotor_leakage_h;
        let stator = parameters.magnetising_h + parameters.stator_leakage_h;
        let coupling = parameters.magnetising_h / rotor;
        Self {
            pole_pairs: f64::from(parameters.pole_pairs),
            stator_resistance: parameters.stator_resistance_ohm,
            resistance: parameters.stator_resistance_ohm + coupling * coupling * parameters.rotor_resistance_ohm,
            leakage: stator - parameters.magnetising_h * coupling,
            coupling,
            magnetising: parameters.magnetising_h,
            rotor_rate: parameters.rotor_resistance_ohm / rotor,
        }
    }

    /// (3/2) p L_m/L_r, Nm/(Vs A).
    pub(super) fn torque_constant(&self) -> f64 {
        1.5 * self.pole_pairs * self.coupling
    }

    /// The torque that brakes, T_d, Nm.
    pub(super) fn braking_nm(&self, state: &Electrical) -> f64 {
        -self.torque_constant() * (state.flux_vs.conj() * state.current_a).im
    }

    /// dx/dt = A x + b u of (i, ψ): rows of A, and b of i.
    fn equations(&self, frame_rad_s: f64, speed_rad_s: f64) -> [[Complex64; 2]; 2] {
        let turning = Complex64::new(0.0, frame_rad_s);
        let rotor = Complex64::new(self.rotor_rate, -self.pole_pairs * speed_rad_s);
        [
            [-(turning + self.resistance / self.leakage), rotor * (self.coupling / self.leakage)],
            [Complex64::new(self.rotor_rate * self.magnetising, 0.0), -(rotor + turning)],
        ]
    }

    /// The state a step later: x∞ + e^{Ah} (x − x∞) with A x∞ + b u = 0; e^{Ah} = e^{mh} (cosh qh I + sinh(qh)/q (A −
    /// mI)) with m half the trace and q² = m² − det A.
    pub(super) fn advance(
        &self,
        state: &Electrical,
        voltage_v: Complex64,
        frame_rad_s: f64,
        speed_rad_s: f64,
        step_s: f64,
    ) -> Electrical {
        let [[a, b], [c, d]] = self.equations(frame_rad_s, speed_rad_s);
        let drive = voltage_v / self.leakage;
        let determinant = a * d - b * c;
        let (rest_current, rest_flux) = (-d * drive / determinant, c * drive / determinant);
        let (current, flux) = (state.current_a - rest_current, state.flux_vs - rest_flux);
        let middle = (a + d) * 0.5;
        let q = (middle * middle - determinant).sqrt();
        let z = q * step_s;
        let ratio = if z.norm() < SMALL { (z * z / 6.0 + 1.0) * step_s } else { z.sinh() / q };
        let (grown, cosh) = ((middle * step_s).exp(), z.cosh());
        Electrical {
            current_a: rest_current + grown * (cosh * current + ratio * ((a - middle) * current + b * flux)),
            flux_vs: rest_flux + grown * (cosh * flux + ratio * (c * current + (d - middle) * flux)),
        }
    }
}
