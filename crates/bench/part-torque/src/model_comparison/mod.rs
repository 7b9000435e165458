//! Models of the torque control: a delay, a delay and a lag, or a black box; each compared with the reference that T_d
//! is T_d* one sample of T_d,calc ago, on recordings that the dynamometer moved and on such that the engine moved
//! (thesis §6.3.2).
//!
//! Of each recording the first half gives models of all orders, the next fifth chooses among them, both together give
//! the chosen ones, and the rest judges: what was searched for among hundreds is judged by what it has not seen. The
//! drive's ripple is taken out first, so that no model has to explain what T_d* cannot. A black box from T_d* − T_d
//! (6.3) is judged with its loop closed, by T_d* alone: fed with T_d* − T_d as measured, it knows T_d before it
//! predicts it.
//!
//! Black boxes know T_d* at the samples of T_d,calc alone, where a demand may have changed since the last. Delay and
//! lag know when it changed; what they find below a sample is what black boxes cannot.

mod black_box;
mod excited;
mod orders;
mod paired;
mod record;
mod scan;
mod visibility;

use numerics::null::nan_if_null;
use rig::estimation::EstimateError;
use rig::experiment::Sought;
use rig::results::{Parameter, Reason, ResidualTest, Stretch, Trace};
use rig::{ControlMode, Excitation, Experiment, ExperimentLabel};
use serde::{Deserialize, Serialize};
use work::Context;

use crate::TorqueControls;
use crate::torque_control::SecondOrderTest;
pub use black_box::{ASKED_HZ, BlackBox, ChosenBy, Closed, ELLIPSE_LEVEL, Family, Root, Scanned, Structure};
pub use excited::Excited;
pub use orders::Input;
pub use orders::OrdersTried;
pub use paired::PairedTest;
use record::{Record, rms};
pub use visibility::{RECORDING_S, Visibility, VisibilityCase, visibility};

/// Level at which a model is said to be better or worse than the bar, of all that are judged on a recording together.
pub const LEVEL: f64 = 0.99;
/// Movers of T_d*, each with the mode in which it acts.
const MOVED: [(Excited, ControlMode); 2] =
    [(Excited::Dynamometer, ControlMode::Tn), (Excited::Engine, ControlMode::Nt)];

/// Findings of recordings on the torque control.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelComparison {
    /// One entry a recording that was used: at most one that the dynamometer moved and one that the engine moved.
    pub recordings: Vec<ComparedRecording>,
    /// Every model on the held-out part of every recording.
    pub judgements: Vec<Judgement>,
    /// Responses of the models on a part of every recording's held-out part.
    pub shown: Vec<Shown>,
    /// Visibility at other rates and demands, from the recording that the dynamometer moved, or else the other; none
    /// where delay and lag are not found.
    pub visibility: Option<Visibility>,
    /// Recordings that were meant but do not show it, by file.
    pub unusable: Vec<(String, Reason)>,
}

/// Findings of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ComparedRecording {
    /// Mover of T_d*.
    pub excited: Excited,
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// Sample time of T_d,calc, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// Stretch that the chosen models are estimated from.
    pub estimation: Stretch,
    /// Stretch that all models are judged by.
    pub held_out: Stretch,
    /// Frequencies of the ripple that was taken out, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub ripple_hz: Vec<f64>,
    /// Delay alone, τ.
    pub pure_delay: Parameter,
    /// Residual test of the delay alone, on the held-out part.
    pub pure_delay_residuals: Option<ResidualTest>,
    /// τ, a, τ + 1/a of delay and lag.
    pub delay_and_lag: Vec<Parameter>,
    /// Residual test of delay and lag, on the held-out part.
    pub delay_and_lag_residuals: Option<ResidualTest>,
    /// Test for more than delay and lag; none where no lag was found, or no fit beyond it.
    pub second_order: Option<SecondOrderTest>,
    /// Root mean square of what the bar leaves of the held-out part, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub bar_rms_nm: f64,
    /// The bar's fit there, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub bar_fit_percent: f64,
    /// The bar's fit on the part that orders are chosen by, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub bar_choice_percent: f64,
    /// All structures that the data determine.
    pub scanned: Vec<Scanned>,
    /// The chosen ones.
    pub black_boxes: Vec<BlackBox>,
}

/// A model that is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Model {
    /// T_d*, a time ago.
    PureDelay,
    /// T_d* through delay and lag.
    DelayAndLag,
    /// A black box.
    BlackBox {
        /// Its structure.
        structure: Structure,
    },
}

/// A model against the bar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Its errors are smaller.
    Better,
    /// Its errors are larger.
    Worse,
    /// The two are not separated.
    NotSeparated,
    /// It does not settle.
    NoModel,
}

/// A model on the held-out part of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Judgement {
    /// The model.
    pub model: Model,
    /// Mover of T_d* in the recording it was estimated from.
    pub estimated_on: Excited,
    /// Mover of T_d* in the recording it is judged by.
    pub judged_on: Excited,
    /// Root mean square of its errors, Nm; none where it does not settle.
    pub rms_nm: Option<f64>,
    /// Its fit, %.
    pub fit_percent: Option<f64>,
    /// Its root mean square error over the bar's.
    pub ratio: Option<f64>,
    /// The pairs of squared errors.
    pub test: Option<PairedTest>,
    /// The test's probability, raised for all models that are judged on the recording.
    pub p_value: Option<f64>,
    /// Better or worse than the bar.
    pub verdict: Verdict,
}

/// The beginning of the held-out part of a recording, as it was and as models have it: the bar, delay and lag, and of
/// the black boxes of each recording that which errs least there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Shown {
    /// Mover of T_d*.
    pub judged_on: Excited,
    /// T_d,calc without its mean and ripple, Nm.
    pub measured: Trace,
    /// T_d* one sample of T_d,calc ago, Nm.
    pub bar: Trace,
    /// Models, what moved T_d* in the recording each was estimated from, and what they make of it, Nm.
    pub models: Vec<(Model, Excited, Trace)>,
}

impl ModelComparison {
    /// The recording that was moved so.
    #[must_use]
    pub fn recording(&self, excited: Excited) -> Option<&ComparedRecording> {
        self.recordings.iter().find(|recording| recording.excited == excited)
    }

    /// Judgements on a recording.
    pub fn judged_on(&self, excited: Excited) -> impl Iterator<Item = &Judgement> {
        self.judgements.iter().filter(move |judgement| judgement.judged_on == excited)
    }
}

/// Why there is nothing to study.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelComparisonError {
    /// No recording moves T_d*.
    #[error(
        "no recording moves T_d* fast enough to show the torque control; run WhiteNoise_T_TN, for the engine's side BS_T_NT"
    )]
    NoRecording,
    /// No recording that does can be used.
    #[error("{error}")]
    NoneUsable {
        /// Why the first of them cannot.
        error: EstimateError,
    },
}

/// Studies the torque control on one recording that the dynamometer moved (WhiteNoise_T_TN, else Multisine_T_TN,
/// Binary_T_TN, Step_T_TN) and one that the engine moved (BS_T_NT), the first of each that can be used; either may be
/// missing.
///
/// Needs T_d* and T_d,calc. Each recording is a part of a step of the work.
///
/// # Errors
/// No such recording, or none that can be used.
///
/// # Source
/// Glans & Kärnell 2018, §6.3.2; Ljung 1999, §16.5–16.6 (cross-validation).
pub fn compare_models(
    controls: &TorqueControls<'_>,
    orders: OrdersTried,
    context: &Context,
) -> Result<ModelComparison, ModelComparisonError> {
    let limit = controls.torque_limit_nm;
    let (mut records, mut unusable, mut first) = (Vec::new(), Vec::new(), None);
    let candidates = Sought::TorqueControl.candidates(&controls.experiments);
    for (excited, mode) in MOVED {
        let meant = |e: &&&Experiment| e.label.excitation == Excitation::Torque && e.label.mode == mode;
        for experiment in candidates.iter().filter(meant) {
            match Record::new(experiment, excited, controls, limit) {
                Ok(record) => {
                    records.push(record);
                    break;
                }
                Err(error) => {
                    first.get_or_insert_with(|| error.clone());
                    unusable.push((experiment.file.clone(), Reason::from(error)));
                }
            }
        }
    }
    if records.is_empty() {
        return Err(match first {
            Some(error) => ModelComparisonError::NoneUsable { error },
            None => ModelComparisonError::NoRecording,
        });
    }
    let step = context.step("trying orders", records.len() as u64);
    let recordings: Vec<ComparedRecording> = records.iter().map(|record| studied(record, orders, &step)).collect();
    let (mut judgements, mut shown) = (Vec::new(), Vec::new());
    for record in &records {
        let responses = responses(record, &records, &recordings);
        let judged = judge_all(record, &responses);
        shown.push(shown_of(record, &responses, &judged));
        judgements.extend(judged);
    }
    let visibility = records.iter().find_map(Visibility::of);
    Ok(ModelComparison { recordings, judgements, shown, visibility, unusable })
}

fn studied(record: &Record, orders: OrdersTried, context: &Context) -> ComparedRecording {
    let scanned = scan::scan(record, orders, context);
    let result = &record.control.result;
    let bar = record.one_sample_late();
    let fit = |range: std::ops::Range<usize>| {
        100.0 * (1.0 - rms(&record.errors(&bar, range.clone())) / record.spread_nm(range))
    };
    ComparedRecording {
        excited: record.excited,
        file: record.file.clone(),
        label: record.label.clone(),
        sample_time_s: record.sample_time_s,
        estimation: record.stretch(record.estimation()),
        held_out: record.stretch(record.held_out()),
        ripple_hz: record.control.model.ripple.lines.iter().map(|line| line.frequency_hz).collect(),
        pure_delay: result.pure_delay.parameters[0].clone(),
        pure_delay_residuals: result.pure_delay_validation.residuals.clone(),
        delay_and_lag: result.delay_and_lag.parameters.clone(),
        delay_and_lag_residuals: result.delay_and_lag_validation.residuals.clone(),
        second_order: record.second_order,
        bar_rms_nm: rms(&record.errors(&bar, record.held_out())),
        bar_fit_percent: fit(record.held_out()),
        bar_choice_percent: fit(record.second()),
        black_boxes: choose(&scanned).into_iter().filter_map(|(s, by)| s.estimate(record, by)).collect(),
        scanned,
    }
}

/// Of each family and input the best by fit and by criterion, each once.
fn choose(scanned: &[Scanned]) -> Vec<(Structure, Vec<ChosenBy>)> {
    let mut chosen: Vec<(Structure, Vec<ChosenBy>)> = Vec::new();
    for family in [Family::Arx, Family::OutputError] {
        for input in [Input::Demand, Input::Error] {
            let own = || scanned.iter().filter(|s| s.structure.family == family && s.structure.input == input);
            let fit = |s: &&Scanned| s.fit_percent.unwrap_or(f64::NEG_INFINITY);
            let by_fit = own().filter(|s| s.fit_percent.is_some()).max_by(|a, b| fit(a).total_cmp(&fit(b)));
            let by_bic = own().min_by(|a, b| a.bic.total_cmp(&b.bic));
            for (best, by) in [(by_fit, ChosenBy::Fit), (by_bic, ChosenBy::Bic)] {
                let Some(best) = best else { continue };
                match chosen.iter_mut().find(|(structure, _)| *structure == best.structure) {
                    Some((_, reasons)) => reasons.push(by),
                    None => chosen.push((best.structure, vec![by])),
                }
            }
        }
    }
    chosen
}

/// A model and what moved T_d* in the recording that it was estimated from, with its T_d in another recording; `None`
/// where it does not settle.
type Response = ((Model, Excited), Option<Vec<f64>>);

/// Responses of all models of all recordings to the demand of one.
fn responses(record: &Record, records: &[Record], recordings: &[ComparedRecording]) -> Vec<Response> {
    let of_source = |(source, studied): (&Record, &ComparedRecording)| {
        let model = &source.control.model;
        let black_box = |one: &BlackBox| {
            let response = one.follows.as_ref().map(|way| way.response(&record.demand));
            (Model::BlackBox { structure: one.structure }, response)
        };
        let delayed = (Model::PureDelay, Some(record.delayed(studied.pure_delay.value)));
        let lagged = (Model::DelayAndLag, Some(record.lagged(model.delay_s, model.lag_rad_s)));
        let all = [delayed, lagged].into_iter().chain(studied.black_boxes.iter().map(black_box));
        all.map(|(model, response)| ((model, source.excited), response)).collect::<Vec<_>>()
    };
    records.iter().zip(recordings).flat_map(of_source).collect()
}

/// All models on the held-out part of a recording.
fn judge_all(record: &Record, responses: &[Response]) -> Vec<Judgement> {
    let bar = record.errors(&record.one_sample_late(), record.held_out());
    let judge =
        |((model, excited), response): &Response| judgement(record, &bar, *model, *excited, response.as_deref());
    let mut judgements: Vec<Judgement> = responses.iter().map(judge).collect();
    raise(&mut judgements);
    judgements
}

fn shown_of(record: &Record, responses: &[Response], judged: &[Judgement]) -> Shown {
    let is_black_box = |model: &Model| matches!(model, Model::BlackBox { .. });
    let least = |source: Excited| {
        let own = judged.iter().filter(move |j| is_black_box(&j.model) && j.estimated_on == source);
        own.filter_map(|j| Some((j.rms_nm?, j.model))).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, model)| model)
    };
    let is_shown = |(model, source): (Model, Excited)| match model {
        Model::PureDelay => false,
        Model::DelayAndLag => source == record.excited,
        Model::BlackBox { .. } => least(source) == Some(model),
    };
    let models = responses.iter().filter(|((model, source), _)| is_shown((*model, *source)));
    Shown {
        judged_on: record.excited,
        measured: record.beginning(&record.torque),
        bar: record.beginning(&record.with_offset(&record.one_sample_late())),
        models: models
            .filter_map(|((m, source), r)| Some((*m, *source, record.beginning(&record.with_offset(r.as_ref()?)))))
            .collect(),
    }
}

fn judgement(record: &Record, bar: &[f64], model: Model, estimated_on: Excited, modelled: Option<&[f64]>) -> Judgement {
    let errors = modelled.map(|modelled| record.errors(modelled, record.held_out()));
    let rms_nm = errors.as_ref().map(|errors| rms(errors));
    Judgement {
        model,
        estimated_on,
        judged_on: record.excited,
        rms_nm,
        fit_percent: rms_nm.map(|rms_nm| 100.0 * (1.0 - rms_nm / record.spread_nm(record.held_out()))),
        ratio: rms_nm.map(|rms_nm| rms_nm / rms(bar)),
        test: errors.map(|errors| paired::compare(bar, &errors, record.sample_time_s)),
        p_value: None,
        verdict: Verdict::NoModel,
    }
}

/// Raises the probabilities of the tests of one recording, and judges by them.
fn raise(judgements: &mut [Judgement]) {
    let tested: Vec<(usize, f64)> =
        judgements.iter().enumerate().filter_map(|(n, j)| Some((n, j.test?.p_value))).collect();
    let raised = ident::distributions::holm(&tested.iter().map(|t| t.1).collect::<Vec<_>>());
    for ((n, _), p_value) in tested.into_iter().zip(raised) {
        let judgement = &mut judgements[n];
        judgement.p_value = Some(p_value);
        let difference = judgement.test.map_or(0.0, |test| test.difference_nm2);
        judgement.verdict = match difference {
            d if p_value < 1.0 - LEVEL && d > 0.0 => Verdict::Better,
            _ if p_value < 1.0 - LEVEL => Verdict::Worse,
            _ => Verdict::NotSeparated,
        };
    }
}
