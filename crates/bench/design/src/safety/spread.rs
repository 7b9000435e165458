//! Benches that could be the one at hand.

use bench_model::disturbances::Disturbances;
use bench_model::friction::DynoFriction;
use bench_model::model::{BenchModel, Mechanics, ModelUncertainty};
use numerics::null::nan_if_null;
use numerics::random::Stream;
use rig::bench_parameters::EngineParameters;
use serde::{Deserialize, Serialize};
use signal::distributions::normal_quantile;

/// A bench that could be the one at hand.
pub(super) struct Drawn {
    pub(super) model: BenchModel,
    pub(super) engine: EngineParameters,
    pub(super) friction: DynoFriction,
    pub(super) disturbances: Disturbances,
    /// How its firings vary.
    pub(super) firing_seed: u64,
}

/// The engine with a share of its speed control's bandwidth, at the same damping: K_p by the share, K_i by its square.
pub fn slowed(engine: &EngineParameters, share: f64) -> EngineParameters {
    EngineParameters {
        speed_control_proportional_nm_s_per_rad: engine.speed_control_proportional_nm_s_per_rad * share,
        speed_control_integral_nm_per_rad: engine.speed_control_integral_nm_per_rad * share * share,
        ..engine.clone()
    }
}

/// How the benches drawn differ from the nominal one.
#[derive(Debug, Clone, Copy)]
pub enum BenchSpread<'a> {
    /// By the covariance of a study's estimates.
    Estimated(&'a ModelUncertainty),
    /// By what is known of benches in general.
    Prior(Prior),
}

/// Uncertainty without a study. Each number r says that the truth lies with 95 % probability between nominal/(1 + r)
/// and nominal · (1 + r): log-normal with the nominal value as median and σ = ln(1 + r)/1.96. They vary independently,
/// and with the engine's inertia the stiffness so that the resonance is what was drawn for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Prior {
    /// Of √(K(1/J_d + 1/J_e)), in torque control.
    #[serde(deserialize_with = "nan_if_null")]
    pub resonance: f64,
    /// Of B.
    #[serde(deserialize_with = "nan_if_null")]
    pub damping: f64,
    /// Of J_e.
    #[serde(deserialize_with = "nan_if_null")]
    pub engine_inertia: f64,
}

impl Default for Prior {
    /// Resonance ±20 %, damping ±50 %, inertia of the engine ±10 %.
    fn default() -> Self {
        Prior { resonance: 0.2, damping: 0.5, engine_inertia: 0.1 }
    }
}

impl BenchSpread<'_> {
    /// A bench; `None` where hardly any draw is possible.
    pub fn draw(&self, nominal: &BenchModel, random: &mut Stream) -> Option<BenchModel> {
        match self {
            BenchSpread::Estimated(uncertainty) => uncertainty.draw(nominal, random),
            BenchSpread::Prior(prior) => {
                Some(BenchModel { mechanics: prior.draw(&nominal.mechanics, random), ..nominal.clone() })
            }
        }
    }
}

impl Prior {
    fn draw(&self, nominal: &Mechanics, random: &mut Stream) -> Mechanics {
        let mut factor = |reach: f64| (reach.ln_1p() / normal_quantile(0.975) * random.normal()).exp();
        let (resonance, damping) = (factor(self.resonance), factor(self.damping));
        let drawn =
            Mechanics { engine_inertia_kg_m2: nominal.engine_inertia_kg_m2 * factor(self.engine_inertia), ..*nominal };
        let mobility = nominal.mobility() / drawn.mobility();
        Mechanics {
            stiffness_nm_per_rad: nominal.stiffness_nm_per_rad * resonance * resonance * mobility,
            damping_nm_s_per_rad: nominal.damping_nm_s_per_rad * damping,
            ..drawn
        }
    }
}
