//! Bode curves of the connected model with their bands.

use std::f64::consts::TAU;

use lti::FrequencyResponse;
use rig::ControlMode;
use signal::Complex64;
use signal::distributions::student_t_quantile;
use units::RPM_RAD_S;

use crate::analysis::BodeCurve;
use crate::model::{BenchModel, ModelUncertainty};

const LOWEST_HZ: f64 = 0.1;
const HIGHEST_HZ: f64 = 200.0;
const POINTS: usize = 150;
/// Extra points about the resonance, and how far on each side they reach, as a part of it.
const RESONANCE_POINTS: usize = 61;
const RESONANCE_REACH: f64 = 0.3;
/// Probability below the upper edge of a two-sided 95 % band.
const UPPER: f64 = 0.975;

/// A curve's gain at ω; `None` where the model lacks a part.
type Gain = fn(&BenchModel, f64) -> Option<Complex64>;

struct Kind {
    input: &'static str,
    output: &'static str,
    variant: Option<&'static str>,
    mode: ControlMode,
    unit: &'static str,
    gain: Gain,
}

const fn torque_curve(input: &'static str, gain: Gain) -> Kind {
    Kind { input, output: "T_shaft", variant: None, mode: ControlMode::Tn, unit: "Nm/Nm", gain }
}

const fn speed_curve(input: &'static str, variant: Option<&'static str>, unit: &'static str, gain: Gain) -> Kind {
    Kind { input, output: "N_d", variant, mode: ControlMode::Nt, unit, gain }
}

const KINDS: [Kind; 6] = [
    speed_curve("N_d*", Some("without feed-forward"), "rpm/rpm", |m, w| {
        m.without_feed_forward().speed_demand_to_speed(w)
    }),
    speed_curve("N_d*", Some("with feed-forward"), "rpm/rpm", |m, w| {
        m.feed_forward.and_then(|_| m.speed_demand_to_speed(w))
    }),
    speed_curve("T_e", None, "rpm/Nm", |m, w| Some(m.engine_to_speed_controlled(w)? / RPM_RAD_S)),
    torque_curve("T_d", |m, w| Some(m.mechanics.torque_to_shaft(w))),
    torque_curve("T_e", |m, w| Some(m.mechanics.engine_to_shaft(w))),
    torque_curve("T_d*", |m, w| m.demand_to_shaft(w)),
];

/// Every curve the model's parts allow.
pub(super) fn curves(model: &BenchModel, uncertainty: &ModelUncertainty) -> Vec<BodeCurve> {
    let omega = frequencies_rad_s(model.mechanics.resonance().frequency_hz);
    KINDS.iter().filter_map(|kind| curve(model, uncertainty, kind, &omega)).collect()
}

/// 0.1 to 200 Hz, evenly on a logarithmic axis, and more densely about the resonance; rad/s.
fn frequencies_rad_s(resonance_hz: f64) -> Vec<f64> {
    let spaced = |low: f64, high: f64, points: usize| {
        let ratio = (high / low).ln() / (points - 1) as f64;
        (0..points).map(move |i| low * (ratio * i as f64).exp())
    };
    let near = spaced(resonance_hz * (1.0 - RESONANCE_REACH), resonance_hz * (1.0 + RESONANCE_REACH), RESONANCE_POINTS);
    let inside = near.filter(|f| (LOWEST_HZ..HIGHEST_HZ).contains(f));
    let mut all: Vec<f64> = spaced(LOWEST_HZ, HIGHEST_HZ, POINTS).chain(inside).map(|f| TAU * f).collect();
    all.sort_by(f64::total_cmp);
    all
}

fn curve(model: &BenchModel, uncertainty: &ModelUncertainty, kind: &Kind, omega: &[f64]) -> Option<BodeCurve> {
    let gains = omega.iter().map(|w| (kind.gain)(model, *w)).collect::<Option<Vec<Complex64>>>()?;
    let response = FrequencyResponse::new(omega.to_vec(), gains).ok()?;
    let gain_db = response.magnitude_db();
    let reach: Vec<f64> = omega.iter().map(|w| half_band_db(model, uncertainty, kind.gain, *w)).collect();
    let shifted = |sign: f64| gain_db.iter().zip(&reach).map(|(g, r)| g + sign * r).collect();
    Some(BodeCurve {
        input: kind.input.to_owned(),
        output: kind.output.to_owned(),
        variant: kind.variant.map(str::to_owned),
        mode: kind.mode,
        frequencies_hz: response.freq_hz(),
        phase_deg: response.phase_deg(),
        gain_band_db: (shifted(-1.0), shifted(1.0)),
        gain_db,
        unit: kind.unit.to_owned(),
    })
}

/// Half the width of the 95 % band, dB: the delta method on 20 lg |G|.
fn half_band_db(model: &BenchModel, uncertainty: &ModelUncertainty, gain: Gain, omega: f64) -> f64 {
    let decibels = |m: &BenchModel| gain(m, omega).map_or(f64::NAN, |g| 20.0 * g.norm().log10());
    let derived = uncertainty.propagate(model, decibels);
    student_t_quantile(UPPER, derived.degrees_of_freedom) * derived.standard_error
}
