//! Prior of an engine's pulses, before anything was recorded of them.
//!
//! The class: three to six cylinders, petrol and diesel, at part and full load. Each part of a harmonic is a complex
//! normal number about zero, since nothing shows its phase. The torque of a cylinder falls off with the harmonic, its
//! gas torque grows with the load, and only integer orders have a torque of the reciprocating masses (Taylor, *The
//! Internal-Combustion Engine in Theory and Practice*, vol. 2, ch. 8).

use super::{EnginePulses, PulseHarmonic};
use crate::bench_parameters::CycleHarmonic;
use crate::facts::Engine;

/// Multiples of the firing order.
const FIRINGS: u32 = 4;
/// Root mean square of |β| at the firing order: nine in ten engines are then between 0.4 and 2.9 of the mean torque.
/// Each further multiple has [`DECAY`] of that.
const LOADED: f64 = 1.7;
const DECAY: f64 = 0.5;
/// The same of harmonics between, which unequal cylinders make: cylinders that differ by some 5 to 10 %.
const UNEQUAL: f64 = 0.12;
/// A flywheel is made so that pulses without load move the speed at idle by some 1/20 from crest to trough:
/// |α| is δ/2 · J_e · order · ω².
const IRREGULARITY: f64 = 0.05;
const IDLE_RAD_S: f64 = 80.0;
/// |γ| over J_e: reciprocating masses turn with some 1 % of the inertia of an engine with its flywheel; of the higher orders, which come
/// with the ratio of crank and rod alone, some 0.3 %. At the first two orders of a turn, unequal masses,
/// auxiliaries and joints have less than a fifth of that of the masses.
const MASSES: f64 = 0.01;
const HIGHER_MASSES: f64 = 0.003;
const OTHER_MASSES: f64 = 0.0015;
/// Part of α that differs between cylinders.
const UNEQUAL_COMPRESSION: f64 = 0.05;
/// Orders of reciprocating masses that need no ratio of crank and rod.
const LOW_ORDER: f64 = 2.0;
/// The torque of friction and pumping that a charge without load overcomes, for each cylinder, Nm: about 1 bar of mean
/// pressure on 0.3 to 0.6 litres (Heywood, *Internal Combustion Engine Fundamentals*, ch. 13). Gas torques that are in
/// proportion to the torque have none.
const IDLE_NM: f64 = 4.0;
/// How far α over the class's β is from that, root mean square for each cylinder, Nm.
const IDLE_SPREAD_NM: f64 = 4.0;
/// Standard deviation from cycle to cycle.
const CYCLE_VARIATION: f64 = 0.03;

impl EnginePulses {
    /// Prior of an engine with spark ignition. Its charge grows with the torque from the one on that friction and
    /// pumping need. So α is T_0 β, to within some Nm of T_0 for each cylinder.
    #[must_use]
    pub fn prior_of_spark_ignition(engine: Engine, engine_inertia_kg_m2: f64) -> Self {
        let general = EnginePulses::prior(engine, engine_inertia_kg_m2);
        let [idle_nm, spread_nm] =
            [IDLE_NM, IDLE_SPREAD_NM].map(|of_cylinder| of_cylinder * f64::from(engine.cylinders));
        let of_charge = |harmonic: PulseHarmonic| {
            let mut covariance = harmonic.covariance;
            let of_torque = covariance[1][1];
            covariance[0][0] = (idle_nm * idle_nm + spread_nm * spread_nm) * of_torque;
            (covariance[0][1], covariance[1][0]) = (idle_nm * of_torque, idle_nm * of_torque);
            PulseHarmonic { covariance, ..harmonic }
        };
        EnginePulses { harmonics: general.harmonics.into_iter().map(of_charge).collect(), ..general }
    }

    /// Prior of an engine with an inertia, kg m², flywheel included.
    #[must_use]
    pub fn prior(engine: Engine, engine_inertia_kg_m2: f64) -> Self {
        let harmonic = |m: u32| {
            let order = 2.0 * f64::from(m) / f64::from(engine.strokes);
            let sizes = sizes(engine, m, order).map(|size| 0.5 * size * size);
            let inertia_squared = engine_inertia_kg_m2 * engine_inertia_kg_m2;
            let variances = [sizes[0] * inertia_squared, sizes[1], sizes[2] * inertia_squared];
            let entry = |i: usize, j: usize| if i == j { variances[i] } else { 0.0 };
            PulseHarmonic {
                order,
                value: CycleHarmonic::default(),
                covariance: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
                is_estimated: false,
            }
        };
        EnginePulses {
            cylinders: engine.cylinders,
            strokes: engine.strokes,
            engine_inertia_kg_m2,
            cycle_variation: CYCLE_VARIATION,
            recordings: Vec::new(),
            harmonics: (1..=FIRINGS * engine.cylinders).map(harmonic).collect(),
        }
    }
}

/// Root mean squares of |α|, |β|, |γ| at a harmonic of the working cycle; α and γ over J_e.
fn sizes(engine: Engine, m: u32, order: f64) -> [f64; 3] {
    let unloaded = 0.5 * IRREGULARITY * engine.firings_per_turn() * IDLE_RAD_S * IDLE_RAD_S;
    if m.is_multiple_of(engine.cylinders) {
        let falls = DECAY.powi((m / engine.cylinders) as i32 - 1);
        let masses = if order <= LOW_ORDER { MASSES } else { HIGHER_MASSES };
        return [unloaded * falls, LOADED * falls, if order.fract() == 0.0 { masses } else { 0.0 }];
    }
    let falls = DECAY.powi((m / engine.cylinders).saturating_sub(1) as i32);
    let is_of_turn = order == 1.0 || order == LOW_ORDER;
    [UNEQUAL_COMPRESSION * unloaded * falls, UNEQUAL * falls, if is_of_turn { OTHER_MASSES } else { 0.0 }]
}
