//! Which recording serves which estimate, and what is missing where none does.

use crate::estimate::shaft::{self, NoisyTorque, ShaftInputs};
use crate::estimate::speed_controller::{self, Encoder, SpeedControllerFit};
use crate::estimate::stretch::need;
use crate::estimate::torque_control::{self, InverterModel, TorqueControlFit};
use crate::estimate::{EstimateError, noise_floor, timing};
use crate::study::whole::{self, Pieces};
use crate::study::{
    BenchVariant, FeedForward, Need, Part, Progress, Replay, Shaft, SpeedController, Timing, TorqueControl, WholeModel,
};
use crate::{BenchFile, Diagnostic, Experiment, Finding, Place, Role, Severity};

/// Tests the shaft can be estimated from, best first.
const SHAFT_TESTS: [&str; 5] = ["BS", "WhiteNoise", "Levels", "Ramp", "Step"];
/// Disagreement of the inertia in the bench file with the data that is worth a warning: standard errors, and share.
const INERTIA_DOUBT: (f64, f64) = (5.0, 0.05);
/// A torque model whose residual is white is taken for this many times cleaner than the samples it was fitted to: its
/// errors are those of a handful of parameters.
const MODEL_ADVANTAGE: f64 = 30.0;

/// Everything that was estimated.
pub(super) struct Estimates {
    pub(super) timing: Part<Timing>,
    pub(super) speed_controller: Part<SpeedController>,
    pub(super) feed_forward: Part<FeedForward>,
    pub(super) torque_control: Part<TorqueControl>,
    pub(super) shaft: Part<Shaft>,
    pub(super) whole: Part<WholeModel>,
    pub(super) replays: Vec<Replay>,
}

/// The data of a study and the doubts about it, as they grow.
pub(super) struct Findings<'a> {
    pub(super) bench: &'a BenchFile,
    pub(super) experiments: &'a [Experiment],
    pub(super) diagnostics: Vec<Diagnostic>,
    pub(super) progress: &'a mut dyn FnMut(Progress),
    /// File and what it was used for.
    uses: Vec<(String, &'static str)>,
}

impl<'a> Findings<'a> {
    pub(super) fn new(
        bench: &'a BenchFile,
        experiments: &'a [Experiment],
        diagnostics: Vec<Diagnostic>,
        progress: &'a mut dyn FnMut(Progress),
    ) -> Self {
        Findings { bench, experiments, diagnostics, progress, uses: Vec::new() }
    }

    /// What a file was used for.
    pub(super) fn uses_of(&self, file: &str) -> Vec<String> {
        self.uses.iter().filter(|(f, _)| f == file).map(|(_, use_)| (*use_).to_owned()).collect()
    }

    /// Whether any part was estimated from a file.
    pub(super) fn is_seen(&self, file: &str) -> bool {
        self.uses.iter().any(|(f, _)| f == file)
    }

    fn note_use(&mut self, file: &str, part: &'static str) {
        self.uses.push((file.to_owned(), part));
    }

    pub(super) fn doubt(&mut self, file: &str, severity: Severity, finding: Finding) {
        let place = Place { file: Some(file.to_owned()), ..Place::default() };
        self.diagnostics.push(Diagnostic { severity, place, finding });
    }

    /// Experiments of a test, the longest first.
    fn of_test(&self, test: &str) -> Vec<&'a Experiment> {
        let mut found: Vec<&Experiment> = self.experiments.iter().filter(|e| e.is_test(test)).collect();
        found.sort_by(|a, b| duration_s(b).total_cmp(&duration_s(a)));
        found
    }

    pub(super) fn of_tests(&self, tests: &[&str]) -> Vec<&'a Experiment> {
        tests.iter().flat_map(|test| self.of_test(test)).collect()
    }

    /// The first success among candidates; otherwise what would have been needed.
    fn first<T>(
        &mut self,
        part: &'static str,
        candidates: &[&'a Experiment],
        labels: &[&str],
        mut estimate: impl FnMut(&'a Experiment) -> Result<T, EstimateError>,
    ) -> Result<T, Vec<Need>> {
        (self.progress)(Progress::Estimating { part });
        let mut needs = Vec::new();
        for candidate in candidates {
            match estimate(candidate) {
                Ok(value) => {
                    self.note_use(&candidate.file, part);
                    return Ok(value);
                }
                Err(error) => needs.push(need_of(&error, &candidate.file)),
            }
        }
        if needs.is_empty() {
            needs.push(Need::Recording { any_of: labels.iter().map(|l| (*l).to_owned()).collect() });
        }
        Err(needs)
    }
}

fn duration_s(experiment: &Experiment) -> f64 {
    experiment.signals.values().map(signal::Signal::duration_s).fold(0.0, f64::max)
}

fn need_of(error: &EstimateError, file: &str) -> Need {
    match error {
        EstimateError::MissingSignal { role, .. } => Need::Channel { file: file.to_owned(), role: *role },
        other => Need::UsableData { file: file.to_owned(), reason: other.to_string() },
    }
}

/// A part from the outcome of its estimate.
fn part<T>(outcome: Result<T, Vec<Need>>) -> Part<T> {
    match outcome {
        Ok(value) => Part::Estimated(value),
        Err(needs) => Part::NotEstimated { needs },
    }
}

pub(super) fn needs_part(name: &str) -> Vec<Need> {
    vec![Need::Part { name: name.to_owned() }]
}

/// Estimates every part the recordings allow.
pub(super) fn all(findings: &mut Findings<'_>) -> Estimates {
    let limit = findings.bench.limits.torque_nm;
    let controller = findings
        .first("speed controller", &findings.of_test("BS"), &["BS_T_NT"], |e| speed_controller::estimate(e, limit));
    let feed_forward = feed_forward(findings, controller.as_ref().ok());
    let torque_control = torque_control(findings);
    let timing = timing(findings, torque_control.as_ref().ok());
    let shaft = shaft(findings, controller.as_ref().ok(), torque_control.as_ref().ok());
    let (whole, replays) = match &shaft {
        Err(_) => (Err(needs_part("shaft")), Vec::new()),
        Ok(shaft) => whole::assemble(
            findings,
            &Pieces {
                shaft,
                controller: controller.as_ref().ok(),
                feed_forward: feed_forward.as_ref().ok(),
                torque_control: torque_control.as_ref().ok(),
            },
        ),
    };
    Estimates {
        timing: part(timing),
        speed_controller: part(controller.map(|c| c.result)),
        feed_forward: part(feed_forward),
        torque_control: part(torque_control.map(|t| t.result)),
        shaft: part(shaft),
        whole: part(whole),
        replays,
    }
}

fn feed_forward(
    findings: &mut Findings<'_>,
    controller: Option<&SpeedControllerFit>,
) -> Result<FeedForward, Vec<Need>> {
    let Some(controller) = controller else { return Err(needs_part("speed controller")) };
    let limit = findings.bench.limits.torque_nm;
    let recordings = findings.of_tests(&["Levels", "Ramp"]);
    let labels = ["Levels_N_NT", "Ramp_N_NT"];
    findings.first("feed-forward", &recordings, &labels, |candidate| {
        let judge = recordings.iter().find(|other| other.file != candidate.file).copied();
        speed_controller::estimate_feed_forward(candidate, judge, controller, limit)
    })
}

fn torque_control(findings: &mut Findings<'_>) -> Result<TorqueControlFit, Vec<Need>> {
    let limit = findings.bench.limits.torque_nm;
    let candidates = findings.of_tests(&["WhiteNoise", "Step", "BS"]);
    let fit = findings.first("torque control", &candidates, &["WhiteNoise_T_TN", "Step_T_TN", "BS_T_NT"], |e| {
        torque_control::estimate(e, limit)
    })?;
    findings.diagnostics.extend(fit.diagnostics.iter().cloned());
    Ok(fit)
}

fn timing(findings: &mut Findings<'_>, torque_control: Option<&TorqueControlFit>) -> Result<Timing, Vec<Need>> {
    let inertia = findings.bench.dynamometer_inertia_kg_m2;
    let candidates = findings.of_tests(&["WhiteNoise", "Step"]);
    findings.first("timing", &candidates, &["WhiteNoise_T_TN", "Step_T_TN"], |e| {
        timing::estimate(&[e], torque_control, inertia)
    })
}

fn shaft(
    findings: &mut Findings<'_>,
    controller: Option<&SpeedControllerFit>,
    torque_control: Option<&TorqueControlFit>,
) -> Result<Shaft, Vec<Need>> {
    let candidates = findings.of_tests(&SHAFT_TESTS);
    let bench = findings.bench;
    let mut used = None;
    let labels = ["BS_T_NT", "WhiteNoise_T_TN"];
    let mut shaft = findings.first("shaft", &candidates, &labels, |e| {
        let inputs = shaft_inputs(e, bench, controller, torque_control)?;
        let estimate = shaft::estimate(&inputs)?;
        used = Some((e, shaft::estimate_inertia(&inputs)?));
        Ok(estimate)
    })?;
    let Some((experiment, inertia)) = used else { return Ok(shaft) };
    for other in candidates.iter().filter(|e| e.file != experiment.file) {
        let inputs = shaft_inputs(other, bench, controller, torque_control);
        if let Ok(estimate) = inputs.and_then(|inputs| shaft::estimate_parameters(&inputs)) {
            shaft.cross_checks.push((other.file.clone(), estimate));
        }
    }
    doubt_shaft(findings, experiment, &shaft, inertia);
    Ok(shaft)
}

fn doubt_shaft(findings: &mut Findings<'_>, experiment: &Experiment, shaft: &Shaft, inertia: Option<(f64, f64)>) {
    let excluded = &shaft.residual_spectrum.excluded_hz;
    let finding = Finding::ExcludedLines { frequencies_hz: excluded.clone() };
    findings.doubt(&experiment.file, Severity::Note, finding);
    let given_kg_m2 = findings.bench.dynamometer_inertia_kg_m2;
    if let Some((estimated_kg_m2, standard_error_kg_m2)) = inertia {
        let difference = (estimated_kg_m2 - given_kg_m2).abs();
        if difference > INERTIA_DOUBT.0 * standard_error_kg_m2 && difference > INERTIA_DOUBT.1 * given_kg_m2 {
            let finding = Finding::ImplausibleInertia { given_kg_m2, estimated_kg_m2, standard_error_kg_m2 };
            findings.doubt(&experiment.file, Severity::Warning, finding);
        }
    }
    let checks: Vec<_> = ["K", "B"]
        .iter()
        .flat_map(|symbol| {
            let own = shaft.estimate.parameter(symbol);
            let others = shaft.cross_checks.iter().map(move |(file, e)| (file.clone(), e.parameter(symbol)));
            others.filter_map(move |(file, other)| Some((file, own?, other?)))
        })
        .filter(|(_, own, other)| {
            let spread = own.standard_error.hypot(other.standard_error);
            (own.value - other.value).abs() > 4.0 * spread
        })
        .map(|(file, own, other)| (file, own.clone(), other.clone()))
        .collect();
    for (file, own, other) in checks {
        let finding = Finding::RoutesDisagree {
            quantity: own.symbol,
            first: (own.value, own.standard_error),
            second: (other.value, other.standard_error),
        };
        findings.doubt(&file, Severity::Warning, finding);
    }
}

/// What the shaft's estimator needs of one recording, with the torque between its samples.
fn shaft_inputs<'a>(
    experiment: &'a Experiment,
    bench: &BenchFile,
    controller: Option<&SpeedControllerFit>,
    torque_control: Option<&TorqueControlFit>,
) -> Result<ShaftInputs<'a>, EstimateError> {
    let dyno_speed = need(experiment, Role::DynoSpeed)?;
    let encoder = Encoder::known_or_assumed(controller.map(|c| c.encoder), dyno_speed, stated_gate(bench));
    let inertia = bench.dynamometer_inertia_kg_m2;
    let uncertainty = bench.dynamometer_inertia_uncertainty_percent.unwrap_or(0.0) / 100.0 * inertia;
    let (torque, inertia_kg_m2) = match bench.variant {
        BenchVariant::TorqueFlange => (vec![sampled_torque(need(experiment, Role::FlangeTorque)?)], None),
        BenchVariant::LoadCell => (air_gap_torque(experiment, torque_control)?, Some((inertia, uncertainty))),
    };
    Ok(ShaftInputs {
        file: &experiment.file,
        dyno_speed,
        engine_speed: need(experiment, Role::EngineSpeed)?,
        torque,
        inertia_kg_m2,
        encoder_noise_rad_s: encoder.noise_rad_s,
        gate_s: (encoder.gate_s, encoder.gate_standard_error_s),
    })
}

fn stated_gate(bench: &BenchFile) -> Option<f64> {
    bench.channels.get(&Role::DynoSpeed).and_then(|mapping| mapping.gate_s)
}

/// T_d as a sampled record, its noise read from the top of its spectrum.
fn sampled_torque(torque: &signal::Signal) -> NoisyTorque {
    NoisyTorque { noise_nm: noise_floor(torque), signal: torque.clone() }
}

/// T_d between the samples of T_d,calc: the inverter's response to T_d*, which is known every millisecond, with the
/// ripple found in T_d,calc. T_d,calc itself folds everything above half its rate; it is used alone where there is no
/// model, and its difference from the model is added where that is not white.
fn air_gap_torque(
    experiment: &Experiment,
    torque_control: Option<&TorqueControlFit>,
) -> Result<Vec<NoisyTorque>, EstimateError> {
    let measured = need(experiment, Role::AirGapTorque)?;
    let Some((torque, inverter)) = modelled_torque(experiment, torque_control) else {
        return Ok(vec![sampled_torque(measured)]);
    };
    let noise = inverter.residual.standard_deviation_nm;
    let mut records = vec![NoisyTorque { signal: torque, noise_nm: noise / MODEL_ADVANTAGE }];
    if !inverter.residual.white {
        records.push(NoisyTorque { signal: difference(measured, &records[0].signal), noise_nm: noise });
    }
    Ok(records)
}

/// T_d on the clock of T_d*, from the inverter's model with the ripple of this recording.
pub(super) fn modelled_torque(
    experiment: &Experiment,
    torque_control: Option<&TorqueControlFit>,
) -> Option<(signal::Signal, InverterModel)> {
    let demand = experiment.signal(Role::DynoTorqueDemand)?;
    let measured = experiment.signal(Role::AirGapTorque)?;
    let inverter = torque_control?.inverter.refit_ripple(demand, measured).ok()?;
    Some((inverter.air_gap_torque(demand), inverter))
}

/// A sampled signal less another, held, at its own instants.
fn difference(measured: &signal::Signal, modelled: &signal::Signal) -> signal::Signal {
    let last = modelled.len().saturating_sub(1) as f64;
    let at = |i: usize| ((measured.time_s(i) - modelled.start_s) / modelled.sample_time_s).round().clamp(0.0, last);
    let values = measured.samples.iter().enumerate().map(|(i, m)| m - modelled.samples[at(i) as usize]).collect();
    measured.with_samples(values)
}
