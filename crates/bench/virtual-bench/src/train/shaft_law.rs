//! Torque that backlash and stiffening add to the linear shaft.

use rig::bench_parameters::MechanicsParameters;

/// Penetration over which the damping of a shaft with play sets in, rad: without it the torque would jump at the stop.
const CONTACT_RAD: f64 = 5e-4;

/// T = K p + K_3 p³ + B φ̇ with p the twist beyond the play. Where there is play, the damping sets in over the first
/// [`CONTACT_RAD`] and never makes a stop pull; so the law is continuous.
///
/// # Source
///
/// Nordin & Gutman, *Controlling mechanical systems with backlash – a survey*, Automatica 38 (2002), §2: dead zone. The
/// damping that sets in with penetration is that of Hunt & Crossley, J. Appl. Mech. 42 (1975), bounded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ShaftLaw {
    stiffness: f64,
    damping: f64,
    half_play_rad: f64,
    stiffening: f64,
}

impl ShaftLaw {
    /// The law of a shaft with a static stiffness K.
    pub(super) fn new(parameters: &MechanicsParameters, stiffness: f64, damping: f64) -> Self {
        Self {
            stiffness,
            damping,
            half_play_rad: 0.5 * parameters.shaft_backlash_rad,
            stiffening: parameters.shaft_stiffening_nm_per_rad3,
        }
    }

    /// Tells whether the shaft is K φ + B φ̇ and nothing else.
    pub(super) fn is_linear(&self) -> bool {
        self.half_play_rad == 0.0 && self.stiffening == 0.0
    }

    /// The torque minus K φ + B φ̇, Nm.
    pub(super) fn beyond_linear_nm(&self, twist_rad: f64, rate_rad_s: f64) -> f64 {
        let beyond_rad = twist_rad - twist_rad.clamp(-self.half_play_rad, self.half_play_rad);
        let spring_nm = self.spring_nm(beyond_rad);
        if self.half_play_rad == 0.0 {
            return spring_nm - self.stiffness * twist_rad;
        }
        let damper_nm = self.damping * rate_rad_s * (beyond_rad.abs() / CONTACT_RAD).min(1.0);
        let pushed_nm = (beyond_rad.signum() * (spring_nm + damper_nm)).max(0.0) * beyond_rad.signum();
        let torque_nm = if beyond_rad == 0.0 { 0.0 } else { pushed_nm };
        torque_nm - self.stiffness * twist_rad - self.damping * rate_rad_s
    }

    /// The twist that carries a torque at rest, rad.
    pub(super) fn twist_at_rad(&self, torque_nm: f64) -> f64 {
        let mut beyond_rad = torque_nm / self.stiffness;
        // Newton's method on a convex, growing function, from the side where it falls to the root.
        for _ in 0..50 {
            let slope = self.stiffness + 3.0 * self.stiffening * beyond_rad * beyond_rad;
            beyond_rad -= (self.spring_nm(beyond_rad) - torque_nm) / slope;
        }
        beyond_rad + if torque_nm == 0.0 { 0.0 } else { self.half_play_rad * torque_nm.signum() }
    }

    fn spring_nm(&self, beyond_rad: f64) -> f64 {
        (self.stiffness + self.stiffening * beyond_rad * beyond_rad) * beyond_rad
    }
}
