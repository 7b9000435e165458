//! Places of parameters and signals in the equation of the shaft.

pub(super) const K: usize = 0;
pub(super) const B: usize = 1;
/// Skew of N_e, s: positive when it is dated later than N_d.
pub(super) const SKEW_ENGINE: usize = 2;
/// Skew of the torque, s: positive when it is dated later than N_d.
pub(super) const SKEW_TORQUE: usize = 3;
/// Gate of both encoders, s.
pub(super) const GATE: usize = 4;
/// J_d, kg m²; zero where the torque is the shaft's own, measured by a flange.
pub(super) const INERTIA: usize = 5;
/// Once-a-turn error of N_d, ω_d (a cos θ_d + b sin θ_d): a and b.
pub(super) const DYNO_TURN: [usize; 2] = [6, 7];
/// The same of N_e.
pub(super) const ENGINE_TURN: [usize; 2] = [8, 9];
/// Slope of the dynamometer's friction over speed, Nm s/rad; it is next to J_d and like it is zero behind a flange.
pub(super) const FRICTION: usize = 10;
/// Coefficient of a [`Term`].
pub(super) const TERM: usize = 11;
/// Of a [`Term::DualMass`], in place of a term's one: inertia of the mass, kg m², stiffness and damping of the spring
/// behind it.
pub(super) const DUAL_MASS: [usize; 3] = [11, 12, 13];
/// Lag 1/a of the torque control, s.
pub(super) const LAG: usize = 14;
/// The lag that the torque was computed with, s: known, and zero where the torque is no model's.
pub(super) const COMPUTED_LAG: usize = 15;
pub(super) const COUNT: usize = 16;
/// Places of the signals: N_d, N_e, torque.
pub(crate) const DYNO: usize = 0;
pub(crate) const ENGINE: usize = 1;
pub(crate) const TORQUE: usize = 2;
/// Wave that a term of the shaft multiplies where it is not linear; it is there with such a term alone.
pub(super) const TERM_WAVE: usize = 3;
