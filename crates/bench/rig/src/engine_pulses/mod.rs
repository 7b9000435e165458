//! The firing pulses of an engine, with what is uncertain of them: as recordings show them, or as engines of the class
//! have them.

mod prior;

use faer::Mat;
use numerics::linalg;
use numerics::random::Stream;
use serde::{Deserialize, Serialize};

use crate::bench_parameters::{CycleHarmonic, EngineParameters};

/// Part of a variance by which rounding may make a direction of a covariance negative.
const ROUNDING: f64 = 1e-6;

/// The pulses of an engine as harmonics of its working cycle, see [`CycleHarmonic`]. No mark shows the cylinders, so
/// the angle 0 is any angle of the crank.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EnginePulses {
    /// Cylinders of the engine.
    pub cylinders: u32,
    /// Strokes of its working cycle.
    pub strokes: u32,
    /// J_e, kg m², that the torques belong to: recordings show speeds, and the torque is nearly proportional to J_e.
    pub engine_inertia_kg_m2: f64,
    /// Standard deviation of a firing from cycle to cycle, of its torque.
    pub cycle_variation: f64,
    /// The recordings that show them; none: what is known of the class alone.
    pub recordings: Vec<String>,
    /// The harmonics of the working cycle, the first first.
    pub harmonics: Vec<PulseHarmonic>,
}

/// One harmonic of the working cycle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PulseHarmonic {
    /// Multiple of the crank's speed.
    pub order: f64,
    /// α, β, γ.
    pub value: CycleHarmonic,
    /// Covariance of α, β and γ in Nm, 1 and Nm s²: the same of the real and of the imaginary parts, which are
    /// independent.
    pub covariance: [[f64; 3]; 3],
    /// True where recordings show it; otherwise it is the prior of the class.
    pub is_estimated: bool,
}

impl PulseHarmonic {
    /// Standard error of the real part of its amplitude, and of the imaginary part, at a mean torque and a speed, Nm.
    pub fn standard_error_nm(&self, torque_nm: f64, speed_rad_s: f64) -> f64 {
        let weights = [1.0, torque_nm, speed_rad_s * speed_rad_s];
        let of_row = |i: usize| (0..3).map(|j| weights[i] * self.covariance[i][j] * weights[j]).sum::<f64>();
        (0..3).map(of_row).sum::<f64>().max(0.0).sqrt()
    }

    /// With real and imaginary parts of α, β, γ moved along a root of the covariance.
    fn moved(&self, random: &mut Stream) -> CycleHarmonic {
        let Some(root) = root(&self.covariance) else { return self.value };
        let mut step = || -> [f64; 3] {
            let normal: [f64; 3] = std::array::from_fn(|_| random.normal());
            std::array::from_fn(|i| (0..3).map(|j| root[i][j] * normal[j]).sum())
        };
        let steps = [step(), step()];
        let CycleHarmonic { unloaded_nm, of_torque, of_speed_nm_s2 } = self.value;
        CycleHarmonic {
            unloaded_nm: std::array::from_fn(|k| unloaded_nm[k] + steps[k][0]),
            of_torque: std::array::from_fn(|k| of_torque[k] + steps[k][1]),
            of_speed_nm_s2: std::array::from_fn(|k| of_speed_nm_s2[k] + steps[k][2]),
        }
    }
}

/// R with R Rᵀ = P, by the eigenvectors of the correlations; `None` where P is no covariance.
fn root(covariance: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let deviation: [f64; 3] = std::array::from_fn(|i| covariance[i][i].sqrt());
    let correlation = |i: usize, j: usize| match deviation[i] * deviation[j] {
        0.0 => 0.0,
        scale => covariance[i][j] / scale,
    };
    let correlations = Mat::from_fn(3, 3, correlation);
    let is_symmetric = (0..9).all(|k| (correlations[(k / 3, k % 3)] - correlations[(k % 3, k / 3)]).abs() <= ROUNDING);
    if !is_symmetric || !correlations.is_all_finite() || deviation.iter().any(|one| !one.is_finite()) {
        return None;
    }
    let eigen = linalg::symmetric_eigen(correlations.as_ref()).ok()?;
    let is_positive = eigen.values.iter().all(|value| *value >= -ROUNDING);
    is_positive.then(|| {
        let entry = |i: usize, k: usize| deviation[i] * eigen.vectors[(i, k)] * eigen.values[k].max(0.0).sqrt();
        std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k)))
    })
}

/// Why pulses cannot be used.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpossiblePulses {
    /// The field.
    pub field: &'static str,
    /// Its value.
    pub value: f64,
    /// Condition that the value must meet.
    pub limit: &'static str,
}

/// Harmonics of a working cycle that a file may have: those of 24 cylinders up to four times the firing order.
const MOST_HARMONICS: usize = 96;

impl EnginePulses {
    /// An engine with the most probable pulses.
    #[must_use]
    pub fn nominal(&self, engine: &EngineParameters) -> EngineParameters {
        self.on(engine, 1.0, self.harmonics.iter().map(|harmonic| harmonic.value))
    }

    /// An engine with pulses drawn from what is known of them, on a bench that has this J_e.
    #[must_use]
    pub fn draw(&self, engine: &EngineParameters, engine_inertia_kg_m2: f64, random: &mut Stream) -> EngineParameters {
        let size = engine_inertia_kg_m2 / self.engine_inertia_kg_m2;
        self.on(engine, size, self.harmonics.iter().map(|harmonic| harmonic.moved(random)))
    }

    fn on(
        &self,
        engine: &EngineParameters,
        size: f64,
        harmonics: impl Iterator<Item = CycleHarmonic>,
    ) -> EngineParameters {
        let scaled = |parts: [f64; 2]| parts.map(|part| size * part);
        let sized = |h: CycleHarmonic| CycleHarmonic {
            unloaded_nm: scaled(h.unloaded_nm),
            of_torque: scaled(h.of_torque),
            of_speed_nm_s2: scaled(h.of_speed_nm_s2),
        };
        EngineParameters {
            cycle_harmonics: harmonics.map(sized).collect(),
            cycle_variation: self.cycle_variation,
            ..engine.clone()
        }
    }

    /// Checks that numbers from a file can be those of an engine.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self) -> Result<(), ImpossiblePulses> {
        let require = |field, value: f64, is_possible: bool, limit| match is_possible && value.is_finite() {
            true => Ok(()),
            false => Err(ImpossiblePulses { field, value, limit }),
        };
        let count = self.harmonics.len();
        require("engine_pulses.cylinders", self.cylinders.into(), (1..=24).contains(&self.cylinders), "1 to 24")?;
        require("engine_pulses.strokes", self.strokes.into(), [2, 4].contains(&self.strokes), "2 or 4")?;
        let (inertia, variation) = (self.engine_inertia_kg_m2, self.cycle_variation);
        require("engine_pulses.engine_inertia_kg_m2", inertia, inertia > 0.0, "above 0")?;
        require("engine_pulses.cycle_variation", variation, (0.0..=1.0).contains(&variation), "between 0 and 1")?;
        require("engine_pulses.harmonics", count as f64, (1..=MOST_HARMONICS).contains(&count), "a list of 1 to 96")?;
        for (harmonic, m) in self.harmonics.iter().zip(1..) {
            let CycleHarmonic { unloaded_nm, of_torque, of_speed_nm_s2 } = harmonic.value;
            let order = 2.0 * f64::from(m) / f64::from(self.strokes);
            let is_next = (harmonic.order - order).abs() < ROUNDING;
            require(
                "engine_pulses.harmonics.order",
                harmonic.order,
                is_next,
                "the next multiple of the cycle's order",
            )?;
            for part in [unloaded_nm, of_torque, of_speed_nm_s2].as_flattened() {
                require("engine_pulses.harmonics.value", *part, true, "a number")?;
            }
            let variance = harmonic.covariance[0][0];
            let is_covariance = root(&harmonic.covariance).is_some();
            require("engine_pulses.harmonics.covariance", variance, is_covariance, "the first number of a covariance")?;
        }
        Ok(())
    }
}

/// Knowledge of an engine's pulses.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "from", rename_all = "snake_case")]
pub enum KnownPulses {
    /// The bench file states them; they are those of its engine.
    Stated,
    /// Recordings show them.
    Estimated(EnginePulses),
    /// Nothing shows them: what is known of the class.
    Assumed(EnginePulses),
}

impl KnownPulses {
    /// An engine with pulses drawn from what is known of them, on a bench that has this J_e.
    #[must_use]
    pub fn draw(&self, engine: &EngineParameters, engine_inertia_kg_m2: f64, random: &mut Stream) -> EngineParameters {
        match self {
            KnownPulses::Stated => engine.clone(),
            KnownPulses::Estimated(pulses) | KnownPulses::Assumed(pulses) => {
                pulses.draw(engine, engine_inertia_kg_m2, random)
            }
        }
    }
}
