//! Tests of terms that may be in a shaft beyond K and B, each held against the data by itself.
//!
//! A term enters the equation with one parameter that is zero in the simple shaft; it is estimated with K, B and the
//! timing, and tested by its own standard error. Stiffness and damping that change with torque or speed multiply a
//! weight of time: dT_shaft/dt = K (1 + p w(t)) Δω + d(B Δω)/dt, K (1 + p w) being the tangent of the spring, or B + p
//! w in place of B.
//!
//! # Source
//! Loss factor: Den Hartog, *Mechanical Vibrations*, 1956, §8.2 (structural damping); score and Wald tests: Ljung 1999,
//! §16.4; several tests at once: Holm, *A simple sequentially rejective multiple test procedure*, 1979.

use ident::distributions::{f_tail, interval};
use ident::frequency::FrequencyFit;
use numerics::null::nan_if_null;
use rig::results::{Parameter, Quantity};
use serde::{Deserialize, Serialize};
use signal::Signal;
use signal::zero_phase::{Wanted, ZeroPhase};
use units::RPM_RAD_S;

use super::equation::Dating;
use super::inputs::ShaftInputs;
use super::spectra::highest_hz;
use super::term::{Term, Weight};
use crate::shaft::places;

/// Changes with torque are stated for so many Nm.
const PER_NM: f64 = 100.0;
/// Changes with speed are stated for so many rad/s (1000 rpm).
const PER_RAD_S: f64 = 1000.0 * RPM_RAD_S;
/// Within so much of zero torque, Nm, a shaft with backlash is loose: several times what noise leaves of the torque.
const LOOSE_NM: f64 = 5.0;
/// The least share of a recording within that band, and outside, in which backlash could be found.
const LOOSE_SHARE: f64 = 0.005;
/// A weight that hardly moves (standard deviation) shows nothing.
const STILL: f64 = 1e-3;

impl Term {
    /// All that are tested by one parameter.
    pub const ALL: [Term; 8] = [
        Term::LossFactor,
        Term::SecondMass,
        Term::OfStiffness(Weight::Torque),
        Term::OfStiffness(Weight::TorqueSquared),
        Term::OfStiffness(Weight::NearZeroTorque),
        Term::OfStiffness(Weight::Speed),
        Term::OfDamping(Weight::Torque),
        Term::OfDamping(Weight::Speed),
    ];

    /// Its weight times Δω on the clock of N_d, where it has one and the recording moves it; `dating` undoes the skews.
    pub(super) fn wave(self, inputs: &ShaftInputs<'_>, dating: Dating) -> Option<Signal> {
        let (Term::OfStiffness(weight) | Term::OfDamping(weight)) = self else { return None };
        let motion = Motion::of(inputs, dating);
        let weights = motion.weights(weight)?;
        Some(inputs.dyno_speed.with_samples(weights.iter().zip(&motion.difference).map(|(w, d)| w * d).collect()))
    }

    fn quantity(self) -> Quantity {
        match self {
            Term::LossFactor => Quantity::LossFactor,
            Term::SecondMass => Quantity::SecondMassOverSpring,
            Term::DualMass => Quantity::SecondMass,
            Term::OfStiffness(Weight::Torque) => Quantity::StiffnessWithTorque,
            Term::OfStiffness(Weight::TorqueSquared) => Quantity::StiffnessWithTorqueSquared,
            Term::OfStiffness(Weight::NearZeroTorque) => Quantity::StiffnessNearZeroTorque,
            Term::OfStiffness(Weight::Speed) => Quantity::StiffnessWithSpeed,
            Term::OfDamping(Weight::Torque) => Quantity::DampingWithTorque,
            Term::OfDamping(Weight::TorqueSquared) => Quantity::DampingWithTorqueSquared,
            Term::OfDamping(Weight::NearZeroTorque) => Quantity::DampingNearZeroTorque,
            Term::OfDamping(Weight::Speed) => Quantity::DampingWithSpeed,
        }
    }
}

/// Terms beyond the simple shaft, held against one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Beyond {
    /// Mean of |error|²/σ² of the simple shaft: one where it and the noise levels are right.
    #[serde(deserialize_with = "nan_if_null")]
    pub simple_misfit: f64,
    /// Each term, in the order of [`Term::ALL`].
    pub tests: Vec<TermTest>,
}

/// A term held against the data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TermTest {
    /// The term.
    pub term: Term,
    /// Its value, estimated with K, B and timing; none where the recording does not move what it depends on.
    pub value: Option<Parameter>,
    /// How likely so large a value is without the term.
    pub p_value: Option<f64>,
    /// K with it, Nm/rad.
    pub stiffness_nm_per_rad: Option<f64>,
    /// Mean of |error|²/σ² with it.
    pub misfit: Option<f64>,
    /// True where it is there at [`Beyond::LEVEL`], all terms tested at once (Holm).
    pub found: bool,
    /// The value's interval at the level of that test: it contains zero if, and only if, the term is not found.
    #[serde(deserialize_with = "nan_if_null")]
    pub joint_interval: Option<(f64, f64)>,
}

impl TermTest {
    /// From a fit and the standard error of the term in it.
    pub(super) fn new(term: Term, outcome: Option<(&FrequencyFit, f64)>) -> Self {
        let Some((fit, error)) = outcome else {
            let nothing = None;
            return TermTest {
                term,
                value: None,
                p_value: nothing,
                stiffness_nm_per_rad: nothing,
                misfit: nothing,
                found: false,
                joint_interval: None,
            };
        };
        let (value, freedom) = (fit.fit.parameters[places::TERM], fit.degrees_of_freedom);
        TermTest {
            term,
            value: Some(Parameter::new(term.quantity(), value, error, freedom)),
            p_value: Some(f_tail((value / error).powi(2), 1.0, freedom)),
            stiffness_nm_per_rad: Some(fit.fit.parameters[places::K]),
            misfit: Some(fit.scale),
            found: false,
            joint_interval: None,
        }
    }
}

impl Beyond {
    /// Probability that any term is found in a shaft without one.
    pub const LEVEL: f64 = 0.01;

    /// Marks the terms that are found: the smallest of n p-values against LEVEL/n, the next against LEVEL/(n − 1), …
    pub(super) fn judged(simple_misfit: f64, mut tests: Vec<TermTest>) -> Self {
        let mut order: Vec<usize> = (0..tests.len()).filter(|i| tests[*i].p_value.is_some()).collect();
        let p_value = |test: &TermTest| test.p_value.unwrap_or(1.0);
        order.sort_by(|a, b| p_value(&tests[*a]).total_cmp(&p_value(&tests[*b])));
        let level = |rank: usize| Self::LEVEL / (order.len() - rank) as f64;
        let count = (0..order.len()).find(|rank| p_value(&tests[order[*rank]]) > level(*rank)).unwrap_or(order.len());
        for (rank, test) in order.iter().enumerate() {
            let test = &mut tests[*test];
            test.found = rank < count;
            let of_value = |value: &Parameter| {
                let confidence = 1.0 - level(rank.min(count));
                interval(value.value, value.standard_error, value.degrees_of_freedom, confidence)
            };
            test.joint_interval = test.value.as_ref().map(of_value);
        }
        Beyond { simple_misfit, tests }
    }

    /// Of the terms that are found the one that explains most; the others may be the same seen through another term.
    #[must_use]
    pub fn best(&self) -> Option<&TermTest> {
        let misfit = |test: &TermTest| test.misfit.unwrap_or(f64::INFINITY);
        self.tests.iter().filter(|test| test.found).min_by(|a, b| misfit(a).total_cmp(&misfit(b)))
    }
}

/// The shaft's motion on the clock of N_d, timing undone.
struct Motion {
    speed: Vec<f64>,
    /// ω_e − ω_d.
    difference: Vec<f64>,
    /// T_shaft = J_d dω_d/dt + T_d (6.1).
    torque: Vec<f64>,
}

impl Motion {
    fn of(inputs: &ShaftInputs<'_>, dating: Dating) -> Self {
        let band_hz = highest_hz(inputs);
        let Signal { start_s, sample_time_s, .. } = *inputs.dyno_speed;
        let count = inputs.dyno_speed.len();
        let at = |signal: &Signal, later_s: f64, gate_s: f64, wanted: Wanted| {
            ZeroPhase { band_hz, gate_s, wanted }.at(signal, start_s + later_s, sample_time_s, count)
        };
        let gate_s = inputs.gate_s.0;
        let speed = at(inputs.dyno_speed, 0.0, gate_s, Wanted::Value);
        let engine = at(inputs.engine_speed, dating.engine_s, gate_s, Wanted::Value);
        let rate = at(inputs.dyno_speed, 0.0, gate_s, Wanted::Derivative);
        let inertia = inputs.inertia_kg_m2.map_or(0.0, |(value, _)| value);
        let mut torque: Vec<f64> = rate.iter().map(|a| inertia * a).collect();
        for part in &inputs.torque {
            let values = at(&part.signal, dating.torque_s, 0.0, Wanted::Value);
            torque.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        let difference = engine.iter().zip(&speed).map(|(e, d)| e - d).collect();
        Motion { speed, difference, torque }
    }

    /// The weight over time; none where it hardly moves.
    fn weights(&self, weight: Weight) -> Option<Vec<f64>> {
        let scaled = |values: &[f64], unit: f64| -> Vec<f64> {
            let mean = mean(values);
            values.iter().map(|v| (v - mean) / unit).collect()
        };
        let weights = match weight {
            Weight::Torque => scaled(&self.torque, PER_NM),
            Weight::TorqueSquared => {
                let squares: Vec<f64> = scaled(&self.torque, PER_NM).iter().map(|t| t * t).collect();
                scaled(&squares, 1.0)
            }
            Weight::Speed => scaled(&self.speed, PER_RAD_S),
            Weight::NearZeroTorque => {
                let near: Vec<f64> = self.torque.iter().map(|t| (-(t / LOOSE_NM).powi(2)).exp()).collect();
                let share = mean(&near);
                if !(LOOSE_SHARE..=1.0 - LOOSE_SHARE).contains(&share) {
                    return None;
                }
                near
            }
        };
        let deviation = mean(&weights.iter().map(|w| w * w).collect::<Vec<_>>()).sqrt();
        (deviation > STILL).then_some(weights)
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}
