//! Helpers that the tests share.

use bench_model::disturbances::Disturbances;
use bench_model::document::Validity;
use bench_model::model::BenchModel;
use capability::{CanInputs, Demand, FollowingSpread};
use cycle::EngineMap;
use design::safety::{BenchSpread, FrictionSpread, Prior};
use rig::bench_file::Limits;
use rig::bench_parameters::{BenchParameters, EngineParameters};
use rig::engine_pulses::KnownPulses;
use units::RPM_RAD_S;

/// Benches drawn in a test.
pub(crate) const SAMPLES: usize = 40;

pub(crate) struct Bench {
    pub(crate) model: BenchModel,
    pub(crate) engine: EngineParameters,
    pub(crate) limits: Limits,
}

/// The default virtual bench with limits that a passenger car's engine keeps.
pub(crate) fn bench() -> Bench {
    let parameters = BenchParameters::default();
    let limits = Limits {
        torque_nm: Some(400.0),
        shaft_torque_nm: Some(600.0),
        speed_rad_s: Some(7000.0 * RPM_RAD_S),
        ..Limits::default()
    };
    Bench { model: BenchModel::of(&parameters), engine: parameters.engine, limits }
}

impl Bench {
    pub(crate) fn inputs<'a>(&'a self, demand: Demand<'a>) -> CanInputs<'a> {
        CanInputs {
            demand,
            model: &self.model,
            engine: &self.engine,
            pulses: &KnownPulses::Stated,
            limits: self.limits,
            validity: Validity::default(),
            spread: BenchSpread::Prior(Prior::default()),
            slowest_engine_control: 1.0,
            friction: FrictionSpread::NONE,
            disturbances: Disturbances::default(),
            following: FollowingSpread::NONE,
            filter_hz: None,
            sets: &[],
            own: &[],
            samples: SAMPLES,
            seed: 1,
        }
    }
}

/// A two-litre engine.
pub(crate) fn map() -> EngineMap {
    let rpm = [700.0, 1000.0, 1500.0, 2000.0, 3000.0, 4000.0, 5000.0, 5800.0, 6200.0];
    let torque = [120.0, 150.0, 175.0, 190.0, 200.0, 190.0, 170.0, 140.0, 60.0];
    EngineMap::new(&rpm.map(|rpm: f64| rpm * RPM_RAD_S), &torque, None, None).unwrap()
}
