//! A bench model as the runtime holds it: its numbers in one order, where it starts, where it is valid, and its draws.

use bench_model::document::{BenchModelDocument, Range};
use bench_model::model::{BenchModel, ModelParameter};

use crate::draws::SEED;
use crate::numbers::{Number, Unit, all, demand_lead, name_of};
use crate::start::{start_nm, start_rad_s};
use crate::{ExportError, draws};

/// The names of the parameters in the runtime's order (`bench.h`).
const ORDER: [&str; 16] = [
    "J_d", "J_e", "K", "B", "K_p", "K_i", "tau_c", "tau_n", "k", "k_a", "tau_f", "tau_t", "a", "T_limit", "T_gate",
    "T_s",
];
/// Samples that the runtime remembers.
const LONGEST_SAMPLES: f64 = 508.0;
/// Sample time of a bench whose controller is not known, s.
const SAMPLE_TIME_S: f64 = 1e-3;
/// Draws of the covariance that an FMU holds.
pub const DRAWS: usize = 200;

/// One parameter of the runtime.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RuntimeParameter {
    pub(super) name: &'static str,
    pub(super) description: &'static str,
    pub(super) unit: Unit,
    pub(super) value: f64,
}

/// A bench model as the runtime holds it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BenchNumbers {
    /// In the runtime's order.
    pub(super) parameters: Vec<RuntimeParameter>,
    pub(super) has_speed_control: bool,
    /// ω_d at the start, rad/s.
    pub(super) start_rad_s: f64,
    /// Torque through the whole bench at the start, Nm: none, unless the model is not valid there.
    pub(super) start_nm: f64,
    /// By how much a recorded speed demand is to be advanced, in words.
    pub(super) demand_lead: Option<String>,
    pub(super) speed_range_rad_s: Option<Range>,
    pub(super) torque_range_nm: Option<Range>,
    /// The parameters of a draw.
    pub(super) drawn: Vec<&'static str>,
    /// One row a draw.
    pub(super) draws: Vec<Vec<f64>>,
}

impl BenchNumbers {
    /// All of it, with draws.
    pub(super) fn of(document: &BenchModelDocument) -> Result<Self, ExportError> {
        let mut numbers = Self::without_draws(document)?;
        let drawn: Vec<ModelParameter> = document.uncertainty.parameters().collect();
        if drawn.is_empty() {
            return Ok(numbers);
        }
        let models = draws(document, DRAWS, SEED);
        if models.len() < DRAWS {
            return Err(ExportError::NoDraws);
        }
        let row = |model: &BenchModel| drawn.iter().map(|p| model.value(*p).unwrap_or(0.0)).collect();
        numbers.draws = models.iter().map(row).collect();
        numbers.drawn = drawn.iter().map(|parameter| name_of(*parameter).0).collect();
        Ok(numbers)
    }

    /// The estimate alone.
    pub(super) fn without_draws(document: &BenchModelDocument) -> Result<Self, ExportError> {
        let model = &document.model;
        let known = all(model);
        let parameters: Vec<RuntimeParameter> = ORDER.into_iter().filter_map(|name| of_runtime(name, &known)).collect();
        let validity = document.validity;
        let numbers = BenchNumbers {
            parameters,
            has_speed_control: model.speed_controller.is_some() && model.torque_control.is_some(),
            start_rad_s: start_rad_s(&validity),
            start_nm: start_nm(&validity),
            demand_lead: demand_lead(model),
            speed_range_rad_s: validity.dyno_speed_rad_s,
            torque_range_nm: validity.air_gap_torque_nm,
            drawn: Vec::new(),
            draws: Vec::new(),
        };
        numbers.check_delays()?;
        Ok(numbers)
    }

    /// The value of a parameter by its name.
    pub(super) fn value(&self, name: &str) -> f64 {
        self.parameters.iter().find(|parameter| parameter.name == name).map_or(0.0, |parameter| parameter.value)
    }

    /// Delays that the runtime can hold.
    fn check_delays(&self) -> Result<(), ExportError> {
        let sample_s = self.value("T_s");
        // These count in whole samples, so that a little below zero is zero.
        let lowest = |name| if matches!(name, "tau_n" | "tau_f") { -0.5 * sample_s } else { 0.0 };
        for name in ["tau_c", "tau_n", "tau_f", "tau_t", "T_gate"] {
            let delay_s = self.value(name);
            let added_s = if matches!(name, "tau_c" | "tau_n") { self.value("tau_t") } else { 0.0 };
            let fits = delay_s >= lowest(name) && delay_s + added_s <= LONGEST_SAMPLES * sample_s;
            if !fits {
                return Err(ExportError::Delay { name, delay_s, longest_s: LONGEST_SAMPLES * sample_s });
            }
        }
        Ok(())
    }
}

/// A number of the model, or what stands for a part that the model lacks: no delay, no lag, no gain, no limit.
fn of_runtime(name: &'static str, known: &[Number]) -> Option<RuntimeParameter> {
    let number = known.iter().find(|number| number.name == name)?;
    let absent = if name == "T_s" { SAMPLE_TIME_S } else { 0.0 };
    let Number { description, unit, value, .. } = *number;
    Some(RuntimeParameter { name, description, unit, value: value.unwrap_or(absent) })
}
