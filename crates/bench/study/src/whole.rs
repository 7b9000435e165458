//! The assembled model: analysed, and replayed on recordings.

use bench_model::analysis::{WholeInputs, WholeModel, whole_model};
use bench_model::drive_ripple::RecordedTorque;
use bench_model::model::{AssembledModel, BenchModel};
use bench_model::replay::Replay;
use bench_model::skews::SignalSkews;
use part_controller::speed_controller::SpeedControllerFit;
use part_lines::sine::{SineTest, sine_points};
use part_torque::air_gap_torque::modelled_torque;
use part_torque::torque_control::TorqueControlFit;
use rig::experiment::Test;
use rig::facts::BenchFacts;
use rig::results::{FeedForward, Part, Quantity, Reason, Shaft};
use rig::{ControlMode, Experiment, Finding, Severity};

use crate::assemble::{StudyParts, assemble as assemble_model};
use crate::findings::Findings;
use crate::replayed::{ReplayModel, replayed_stretch};

/// Tests worth replaying in each control mode, best first.
const REPLAYED_NT: [Test; 4] = [Test::Bs, Test::Ramp, Test::Levels, Test::Unfired];
const REPLAYED_TN: [Test; 3] = [Test::Step, Test::WhiteNoise, Test::Sine];
/// Recordings replayed in each mode.
const REPLAYS_PER_MODE: usize = 2;

/// The parts that were estimated.
pub(super) struct Pieces<'a> {
    pub(super) shaft: &'a Shaft,
    pub(super) controller: Option<&'a SpeedControllerFit>,
    pub(super) feed_forward: Option<&'a FeedForward>,
    pub(super) torque_control: Option<&'a TorqueControlFit>,
}

impl Pieces<'_> {
    /// Skews of N_e and T_d against N_d.
    pub(super) fn skews(&self) -> SignalSkews {
        let value = |quantity| self.shaft.estimate.parameter(quantity).map_or(0.0, |p| p.value);
        SignalSkews {
            engine_speed_s: value(Quantity::EngineSpeedSkew),
            torque_s: value(Quantity::AirGapTorqueSkew) - self.gate_s() / 2.0,
        }
    }

    /// How the recordings show T_d.
    pub(super) fn recorded_torque(&self) -> Option<RecordedTorque> {
        let found = &self.torque_control?.model;
        let ripple_hz = found.ripple.lines.iter().map(|line| line.frequency_hz).collect();
        Some(RecordedTorque { delay_s: found.delay_s, ripple_hz })
    }

    fn gate_s(&self) -> f64 {
        self.shaft.estimate.parameter(Quantity::EncoderGates).map_or(0.0, |p| p.value)
    }
}

/// The model that the parts make up, and its analysis.
pub(super) struct Whole {
    pub(super) model: Option<AssembledModel>,
    pub(super) analysis: Result<WholeModel, Vec<Reason>>,
}

impl Whole {
    /// Without a shaft there is no model.
    pub(super) fn missing() -> Self {
        Whole { model: None, analysis: Err(vec![Reason::Part { part: Part::Shaft }]) }
    }
}

/// The model that the parts make up; none where they lack what a model needs.
pub(super) fn model_of(facts: &BenchFacts, pieces: &Pieces<'_>) -> Option<AssembledModel> {
    assemble_model(&StudyParts {
        facts,
        shaft: pieces.shaft,
        speed_controller: pieces.controller.map(|c| &c.result),
        feed_forward: pieces.feed_forward,
        torque_control: pieces.torque_control.map(|t| &t.result),
        encoder_gate_s: pieces.gate_s(),
    })
}

/// The model that the parts make up, analysed.
pub(super) fn assemble(findings: &mut Findings<'_>, pieces: &Pieces<'_>) -> Whole {
    let _step = findings.context.step("estimating: whole model", 0);
    let facts = findings.bench.facts();
    let Some(assembled) = model_of(&facts, pieces) else { return Whole::missing() };
    let AssembledModel { model, uncertainty, .. } = &assembled;
    let sines = findings.of_test(&Test::Sine);
    let torque_control = pieces.torque_control.map(|fit| &fit.model);
    let torques: Vec<_> = sines.iter().map(|e| modelled_torque(e, torque_control).map(|(t, _)| t)).collect();
    let skews = pieces.skews();
    let engine = findings.bench.engine();
    let measured = sines.iter().zip(&torques).map(|(experiment, torque)| {
        sine_points(model, engine, &SineTest { experiment, air_gap_torque: torque.as_ref(), skews })
    });
    let points = measured.collect::<Result<Vec<_>, _>>().map(|points| points.concat());
    let analysed = |sine_points: &[_]| whole_model(&WholeInputs { model, uncertainty, engine, sine_points });
    let whole = points.map(|points| analysed(&points)).map_err(|error| vec![Reason::from(error)]);
    Whole { model: Some(assembled), analysis: whole }
}

/// The recordings of a mode to replay, and whether parts were estimated from them: first those kept for validation,
/// then one of each test, those first that nothing was estimated from.
fn replayed<'a>(findings: &Findings<'a>, mode: ControlMode, tests: &[Test]) -> Vec<(&'a Experiment, bool)> {
    let kept: Vec<&Experiment> = findings.validation.iter().filter(|e| e.label.mode == mode).collect();
    let unseen_first = |mut found: Vec<&'a Experiment>| {
        found.retain(|e| e.label.mode == mode && !kept.iter().any(|own| own.file == e.file));
        found.sort_by_key(|e| findings.is_seen(&e.file));
        found
    };
    let of_each = tests.iter().filter_map(|test| unseen_first(findings.of_test(test)).first().copied());
    let others = unseen_first(of_each.collect()).into_iter().map(|e| (e, findings.is_seen(&e.file)));
    let mut chosen: Vec<_> = kept.iter().map(|e| (*e, false)).chain(others).collect();
    chosen.truncate(REPLAYS_PER_MODE.max(kept.len()));
    chosen
}

/// Replays recordings in both modes.
pub(super) fn replays(findings: &mut Findings<'_>, pieces: &Pieces<'_>, model: &BenchModel) -> Vec<Replay> {
    let recorded_torque = pieces.recorded_torque();
    let replays_on = ReplayModel { model, skews: pieces.skews(), recorded_torque: recorded_torque.as_ref() };
    let mut done = Vec::new();
    let modes = [(ControlMode::Nt, &REPLAYED_NT[..]), (ControlMode::Tn, &REPLAYED_TN[..])];
    let chosen: Vec<(&Experiment, bool)> =
        modes.into_iter().flat_map(|(mode, tests)| replayed(findings, mode, tests)).collect();
    let step = findings.context.step("replaying", chosen.len() as u64);
    for (experiment, is_seen) in chosen {
        let _part = step.step(format!("replaying {}", experiment.file), 0);
        match replays_on.replay(experiment, replayed_stretch(experiment), is_seen) {
            Ok(replay) => done.push(replay),
            Err(error) => {
                let finding = Finding::NotReplayed { reason: error.into() };
                findings.doubt(&experiment.file, Severity::Note, finding);
            }
        }
    }
    done
}
