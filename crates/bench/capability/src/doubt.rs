//! Parts of the model that decide an answer that is no yes and no no.

use bench_model::model::ModelParameter;
use numerics::null::nan_if_null;
use rig::experiment::{ControlMode, Excitation, ExperimentLabel, Test};
use serde::{Deserialize, Serialize};

use crate::outcome::Drawn;

/// Classes of equal size into which the benches are sorted by a number.
const CLASSES: usize = 5;
/// A number that explains less of the variance than this is not named.
const LEAST: f64 = 0.05;

/// A number that is not known exactly, and with which the answer changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Doubt {
    /// Which one.
    pub of: Uncertain,
    /// Share of the variance of yes and no that goes if it is known, 0 … 1.
    #[serde(deserialize_with = "nan_if_null")]
    pub explained: f64,
    /// Median of the number in the lowest and the highest fifth of the benches, SI.
    #[serde(deserialize_with = "nan_if_null")]
    pub values: [f64; 2],
    /// Share of each that keep everything.
    #[serde(deserialize_with = "nan_if_null")]
    pub kept: [f64; 2],
    /// The experiment of the method that estimates it.
    pub settled_by: Option<ExperimentLabel>,
}

/// A number that is not known exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Uncertain {
    /// One of the bench model.
    Parameter(ModelParameter),
    /// The bandwidth of the engine's speed control, as a share of the one stated.
    EngineSpeedControl,
}

/// The numbers that decide whether a bench keeps everything, the one that decides most first.
pub(crate) fn doubts(benches: &[Drawn], kept: &[bool]) -> Vec<Doubt> {
    let parameters = ModelParameter::ALL.into_iter().filter_map(|parameter| {
        let values: Option<Vec<f64>> = benches.iter().map(|bench| bench.model.value(parameter)).collect();
        Some((Uncertain::Parameter(parameter), values?))
    });
    let engine = (Uncertain::EngineSpeedControl, benches.iter().map(|bench| bench.engine_speed).collect());
    let mut found: Vec<Doubt> =
        parameters.chain([engine]).filter_map(|(of, values)| doubt(of, &values, kept)).collect();
    found.sort_by(|a, b| b.explained.total_cmp(&a.explained));
    found
}

/// The correlation ratio of the answer with a number, less what chance gives.
///
/// # Source
/// Kelley, Proc. Nat. Acad. Sci. 21 (1935) 554: ε².
fn doubt(of: Uncertain, values: &[f64], kept: &[bool]) -> Option<Doubt> {
    let count = values.len();
    if count < 4 * CLASSES {
        return None;
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let (first, last) = (values[order[0]], values[order[count - 1]]);
    if last - first <= 1e-12 * last.abs() {
        return None;
    }
    let share = |places: &[usize]| places.iter().filter(|k| kept[**k]).count() as f64 / places.len() as f64;
    let classes: Vec<&[usize]> = (0..CLASSES).map(|k| &order[k * count / CLASSES..(k + 1) * count / CLASSES]).collect();
    let within: f64 = classes.iter().map(|class| class.len() as f64 * share(class) * (1.0 - share(class))).sum();
    let total = count as f64 * share(&order) * (1.0 - share(&order));
    let chance = (count as f64 - 1.0) / (count - CLASSES) as f64;
    let explained = 1.0 - within / total * chance;
    let ends = [classes[0], classes[CLASSES - 1]];
    (explained > LEAST).then(|| Doubt {
        of,
        explained,
        values: ends.map(|class| values[class[class.len() / 2]]),
        kept: ends.map(share),
        settled_by: settled_by(of),
    })
}

fn settled_by(of: Uncertain) -> Option<ExperimentLabel> {
    let Uncertain::Parameter(parameter) = of else { return None };
    Some(match parameter {
        ModelParameter::Stiffness
        | ModelParameter::Damping
        | ModelParameter::EngineInertia
        | ModelParameter::TorqueControlDelay
        | ModelParameter::TorqueControlBandwidth => ExperimentLabel::WHITE_NOISE_T_TN,
        ModelParameter::Proportional | ModelParameter::Integral | ModelParameter::ControllerDelay => {
            ExperimentLabel::BS_T_NT
        }
        ModelParameter::SpeedFeedForward | ModelParameter::AccelerationFeedForward => ExperimentLabel::LEVELS_N_NT,
        ModelParameter::DynoInertia => ExperimentLabel::new(Test::NoShaft, Excitation::Speed, ControlMode::Nt),
    })
}
