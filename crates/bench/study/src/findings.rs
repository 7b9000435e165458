//! A study's data, the doubts about them, and what was used for what, as they grow.

use rig::experiment::{Choice, Sought, Test};
use rig::results::{Part, Validation};
use rig::{BenchFile, Diagnostic, Experiment, Finding, Place, Role, Severity};
use work::Context;

use crate::gather::Prepared;

/// The data of a study and the doubts about it, as they grow.
pub(super) struct Findings<'a> {
    pub(super) bench: &'a BenchFile,
    pub(super) experiments: &'a [Experiment],
    /// Parts of recordings that are kept for validation.
    pub(super) validation: &'a [Experiment],
    pub(super) diagnostics: Vec<Diagnostic>,
    /// The step of estimating.
    pub(super) context: &'a Context,
    /// File and what it was used for.
    uses: Vec<(String, Part)>,
}

impl<'a> Findings<'a> {
    pub(super) fn new(bench: &'a BenchFile, prepared: &'a Prepared, context: &'a Context) -> Self {
        let Prepared { experiments, validation, diagnostics, .. } = prepared;
        let diagnostics = diagnostics.iter().cloned().map(raised).collect();
        Findings { bench, experiments, validation, diagnostics, context, uses: Vec::new() }
    }

    /// Parts that a file was used for.
    pub(super) fn uses_of(&self, file: &str) -> Vec<Part> {
        self.uses.iter().filter(|(f, _)| f == file).map(|(_, part)| *part).collect()
    }

    /// Tells whether any part was estimated from a file.
    pub(super) fn is_seen(&self, file: &str) -> bool {
        self.uses.iter().any(|(f, _)| f == file)
    }

    /// The files that a part is estimated from.
    pub(super) fn files_of(&self, part: Part) -> Vec<String> {
        self.uses.iter().filter(|(_, of)| *of == part).map(|(file, _)| file.clone()).collect()
    }

    /// That a part is estimated from no file.
    pub(super) fn forget_use(&mut self, part: Part) {
        self.uses.retain(|(_, of)| *of != part);
    }

    pub(super) fn note_use(&mut self, choice: &Choice) {
        let part = match choice.sought {
            Sought::SpeedController => Part::SpeedController,
            Sought::FeedForward => Part::FeedForward,
            Sought::TorqueControl => Part::TorqueControl,
            Sought::Timing => Part::Timing,
            Sought::Shaft => Part::Shaft,
            Sought::Inertias => return,
        };
        self.uses.push((choice.file.clone(), part));
    }

    /// Doubts the bench file.
    pub(super) fn doubt_bench(&mut self, severity: Severity, finding: Finding) {
        self.diagnostics.push(Diagnostic { severity, place: Place::default(), finding });
    }

    pub(super) fn doubt(&mut self, file: &str, severity: Severity, finding: Finding) {
        let place = Place { file: Some(file.to_owned()), ..Place::default() };
        self.diagnostics.push(Diagnostic { severity, place, finding });
    }

    /// Warns of what was found in the channel of a role.
    pub(super) fn doubt_channel(&mut self, file: &str, role: Role, finding: Finding) {
        let channel = self.bench.channels.get(&role).map(|mapping| mapping.name.clone());
        let place = Place { file: Some(file.to_owned()), channel, ..Place::default() };
        self.diagnostics.push(Diagnostic { severity: Severity::Warning, place, finding });
    }

    /// Doubts a part whose residuals depend on its input on the held-out stretch.
    pub(super) fn doubt_residuals(&mut self, submodel: Part, validation: &Validation) {
        if let Some(test) = validation.residuals.as_ref().filter(|test| test.depends_on_input()) {
            let share_outside = test.share_outside();
            let finding = Finding::ResidualsCorrelated { submodel, share_outside };
            self.doubt(&validation.stretch.file, Severity::Warning, finding);
        }
    }

    /// Experiments of a test, the longest first.
    pub(super) fn of_test(&self, test: &Test) -> Vec<&'a Experiment> {
        let mut found: Vec<&Experiment> = self.experiments.iter().filter(|e| e.is_test(test)).collect();
        found.sort_by(|a, b| b.duration_s().total_cmp(&a.duration_s()));
        found
    }
}

/// Two ends of a shaft that do not turn alike are an error of the whole recording: nothing shows which of them is
/// wrong.
fn raised(found: Diagnostic) -> Diagnostic {
    match found.finding {
        Finding::SpeedsDisagree { role: Role::EngineSpeed, .. } => {
            let place = Place { channel: None, ..found.place };
            Diagnostic { severity: Severity::Error, place, ..found }
        }
        _ => found,
    }
}
