//! Doubts as they are found in one recording.

use recording::Recording;

use crate::diagnostics::{Diagnostic, Finding, Place, Severity};

/// The diagnostics of one file.
pub(super) struct Log {
    pub(super) file: String,
    pub(super) diagnostics: Vec<Diagnostic>,
}

impl Log {
    pub(super) fn new(file: &str) -> Self {
        Log { file: file.to_owned(), diagnostics: Vec::new() }
    }

    /// Notes a finding about the whole file.
    pub(super) fn file(&mut self, severity: Severity, time_s: Option<f64>, finding: Finding) {
        let place = Place { file: Some(self.file.clone()), channel: None, time_s };
        self.diagnostics.push(Diagnostic { severity, place, finding });
    }

    /// Notes a finding about a channel.
    pub(super) fn channel(&mut self, severity: Severity, channel: &str, time_s: Option<f64>, finding: Finding) {
        let place = Place { file: Some(self.file.clone()), channel: Some(channel.to_owned()), time_s };
        self.diagnostics.push(Diagnostic { severity, place, finding });
    }

    /// Takes over what the reader found.
    pub(super) fn reader_findings(&mut self, recording: &Recording) {
        for finding in &recording.findings {
            let severity = if finding.is_loss() { Severity::Warning } else { Severity::Note };
            self.file(severity, None, Finding::ReaderDoubt { doubt: finding.clone().into() });
        }
    }
}
