//! Parts of a course that are compared with limits, in checks of experiments and of tests alike.

use std::f64::consts::TAU;

use bench_model::model::Mechanics;
use numerics::order::largest_of_pairs;
use rig::bench_parameters::EngineParameters;
use rig::experiment::ExperimentPlan;
use rig::facts::Engine;

use super::ladder::Ladder;

/// Frequencies closer to the resonance than this part of it lie at the resonance.
const RESONANCE_BAND: f64 = 0.1;

/// The resonance of a bench, and what may stay near it: the firing frequency, and the sines of a sine test.
pub struct AtResonance<'a> {
    resonance_hz: f64,
    firings_per_rad: f64,
    sines: Option<Ladder<'a>>,
}

impl<'a> AtResonance<'a> {
    /// Of a bench with an engine, in a plan or in a cycle.
    pub fn of(mechanics: &Mechanics, engine: &EngineParameters, plan: Option<&'a ExperimentPlan>) -> Self {
        let cylinders = engine.cylinder_factors.len() as u32;
        let firings_per_turn = Engine { cylinders, strokes: engine.strokes }.firings_per_turn();
        AtResonance {
            resonance_hz: mechanics.resonance().frequency_hz,
            firings_per_rad: firings_per_turn / TAU,
            sines: plan.and_then(Ladder::of),
        }
    }

    /// The longest stay, in samples, and the sample at which it ends. Of a sine test, samples are the updates of its
    /// demands.
    pub fn longest_stay(&self, engine_speed_rad_s: &[f64]) -> (usize, usize) {
        let is_near = |hz: f64| (hz - self.resonance_hz).abs() <= RESONANCE_BAND * self.resonance_hz;
        let (mut longest, mut stay) = ((0, 0), 0);
        for (k, speed) in engine_speed_rad_s.iter().enumerate() {
            let sine_hz = self.sines.as_ref().map(|sines| sines.frequencies_hz[sines.rung(k)]);
            stay =
                if is_near(speed.abs() * self.firings_per_rad) || sine_hz.is_some_and(is_near) { stay + 1 } else { 0 };
            longest = if stay > longest.0 { (stay, k) } else { longest };
        }
        longest
    }
}

/// The largest change between values at most `apart` samples from each other, and the sample at which it begins.
pub fn largest_change(values: &[f64], apart: usize) -> (f64, usize) {
    let of = |apart: usize| {
        let later = values.get(apart..).unwrap_or_default();
        largest_of_pairs(values, later, |before, after| (after - before).abs())
    };
    (1..=apart).map(of).fold((0.0, 0), |most, one| if one.0 > most.0 { one } else { most })
}
