//! Predictions of the program for a test, from the study of the bench, as its commands ask.

use bench_model::disturbances::Disturbances;
use bench_model::document::Validity;
use bench_model::model::BenchModel;
use bench_model::prediction::PredictionInputs;
use capability::{CanInputs, FollowingSpread, Verdict, can};
use design::safety::{ASSUMED_ENGINE, BenchSpread, FrictionSpread, Prior, SafetyCheck, SafetyInputs, check};
use rig::bench_file::Limits;
use rig::bench_parameters::EngineParameters;
use rig::engine_pulses::KnownPulses;
use virtual_bench::StatedBench;

use super::asked::Asked;
use crate::known::Known;

/// Benches drawn for an answer.
pub(crate) const SAMPLES: usize = 80;

/// A bench as the program knows it.
pub(crate) struct Predictor<'a> {
    /// Limits that its bench file states.
    pub(crate) limits: Limits,
    spread: BenchSpread<'a>,
    pulses: KnownPulses,
    friction: FrictionSpread,
    disturbances: Disturbances,
    following: FollowingSpread,
    model: BenchModel,
    engine: EngineParameters,
}

impl<'a> Predictor<'a> {
    /// None where the study gives no model.
    pub(crate) fn of(known: &'a Known) -> Option<Self> {
        let assembled = known.study.model.as_ref()?;
        let stated =
            StatedBench::of(&known.file, Some(&assembled.model)).unwrap().with_pulses(assembled.engine_pulses.as_ref());
        let of_stated = BenchModel::of(&stated.parameters);
        let model = BenchModel {
            speed_controller: assembled.model.speed_controller.or(of_stated.speed_controller),
            encoder_gate_s: assembled.model.encoder_gate_s,
            ..of_stated
        };
        // The user knows how late the air path is.
        let engine = EngineParameters { intake_lag_s: known.bench.engine.air_lag_s, ..stated.parameters.engine };
        let spread = BenchSpread::Estimated(&assembled.uncertainty);
        let friction =
            FrictionSpread::of(&known.file, stated.parameters.drive.torque_limit_nm, assembled.dyno_friction.as_ref());
        let following = FollowingSpread { lag_s: 0.0, ..FollowingSpread::ASSUMED };
        let disturbances = assembled.disturbances.unwrap_or_else(Disturbances::assumed);
        let (limits, pulses) = (known.file.limits, stated.pulses);
        Some(Predictor { limits, spread, pulses, friction, disturbances, following, model, engine })
    }

    /// Of a bench that is known exactly, but for its speed control in torque control.
    pub(crate) fn exact(model: BenchModel, engine: EngineParameters) -> Self {
        let spread = BenchSpread::Prior(Prior { resonance: 0.0, damping: 0.0, engine_inertia: 0.0 });
        let (pulses, friction) = (KnownPulses::Stated, FrictionSpread::NONE);
        let (following, disturbances) = (FollowingSpread::NONE, Disturbances::default());
        Predictor { limits: Limits::default(), spread, pulses, friction, disturbances, following, model, engine }
    }

    /// J_e as the program knows it, kg m².
    pub(crate) fn engine_inertia_kg_m2(&self) -> f64 {
        self.model.mechanics.engine_inertia_kg_m2
    }

    pub(crate) fn can(&self, asked: &Asked, limits: Limits, samples: usize, seed: u64) -> Verdict {
        let inputs = CanInputs {
            demand: asked.demand(),
            model: &self.model,
            engine: &self.engine,
            limits,
            spread: self.spread,
            pulses: &self.pulses,
            friction: self.friction,
            disturbances: self.disturbances,
            following: self.following,
            // Shares and bands are compared, also beyond the recordings' range.
            validity: Validity::default(),
            slowest_engine_control: ASSUMED_ENGINE,
            filter_hz: None,
            sets: &asked.sets,
            own: &asked.own,
            samples,
            seed,
        };
        can(&inputs, &work::Context::new()).unwrap()
    }

    /// Answer of `experiment check`; none of a cycle.
    pub(crate) fn check(&self, asked: &Asked, limits: Limits, seed: u64) -> Option<SafetyCheck> {
        let (plan, demands) = asked.plan()?;
        let inputs = SafetyInputs {
            prediction: PredictionInputs {
                plan,
                demands,
                model: &self.model,
                engine: &self.engine,
                firing_seed: Some(seed),
                friction: self.friction.middle(),
                disturbances: self.disturbances,
                limits,
            },
            spread: self.spread,
            pulses: &self.pulses,
            friction: self.friction,
            slowest_engine_control: ASSUMED_ENGINE,
            samples: SAMPLES,
            seed,
        };
        Some(check(&inputs, &work::Context::new()).unwrap())
    }
}
