//! Estimates that are made once for each recording.

use std::sync::{Arc, OnceLock};

use crate::error::EstimateError;
use crate::experiment::{Choice, Experiment, PassedOver, Sought};
use crate::results::Reason;

type Cell<T> = Arc<OnceLock<Result<Arc<T>, EstimateError>>>;

/// An estimate from each of several recordings, made when it is first asked for.
#[derive(Debug)]
pub struct OncePerRecording<'a, T> {
    cells: Vec<(&'a Experiment, Cell<T>)>,
}

impl<'a, T> OncePerRecording<'a, T> {
    /// For these recordings.
    pub fn new(experiments: &[&'a Experiment]) -> Self {
        OncePerRecording { cells: experiments.iter().map(|experiment| (*experiment, Cell::default())).collect() }
    }

    /// With a further recording; what was estimated is kept.
    #[must_use]
    pub fn with<'b>(&self, further: &'b Experiment) -> OncePerRecording<'b, T>
    where
        'a: 'b,
    {
        let kept = self.cells.iter().map(|(experiment, cell)| (*experiment, Arc::clone(cell)));
        OncePerRecording { cells: kept.chain([(further, Cell::default())]).collect() }
    }

    /// The estimate from a recording, made by `estimate` unless it was made before.
    ///
    /// # Errors
    /// Those of `estimate`.
    pub fn get(
        &self,
        experiment: &Experiment,
        estimate: impl FnOnce() -> Result<T, EstimateError>,
    ) -> Result<Arc<T>, EstimateError> {
        match self.cells.iter().find(|(known, _)| std::ptr::eq(*known, experiment)) {
            Some((_, cell)) => once(cell, || estimate().map(Arc::new)).clone(),
            None => estimate().map(Arc::new),
        }
    }
}

/// Returns the content of a cell, made by `make` unless it was made before. Nothing waits while it is made: what is
/// made on many threads may in turn be part of it, and threads that ask at the same time make the same.
pub fn once<T>(cell: &OnceLock<T>, make: impl FnOnce() -> T) -> &T {
    match cell.get() {
        Some(made) => made,
        None => {
            let made = make();
            cell.get_or_init(|| made)
        }
    }
}

/// An estimate from the recording that was chosen for it.
#[derive(Debug)]
pub struct Chosen<'a, T> {
    /// The recording.
    pub experiment: &'a Experiment,
    /// The estimate.
    pub fit: Arc<T>,
    /// Why this recording.
    pub choice: Choice,
}

impl<T> Clone for Chosen<'_, T> {
    fn clone(&self) -> Self {
        Chosen { experiment: self.experiment, fit: Arc::clone(&self.fit), choice: self.choice.clone() }
    }
}

/// The first success among the recordings that may give what is sought.
///
/// # Errors
/// The need: a recording, or something of those that there are.
pub fn first<'a, T>(
    sought: Sought,
    experiments: &[&'a Experiment],
    mut estimate: impl FnMut(&'a Experiment) -> Result<Arc<T>, EstimateError>,
) -> Result<Chosen<'a, T>, Vec<Reason>> {
    let (mut needs, mut passed_over) = (Vec::new(), Vec::new());
    for experiment in sought.candidates(experiments) {
        match estimate(experiment) {
            Ok(fit) => {
                return Ok(Chosen { experiment, fit, choice: sought.choice(experiment, experiments, passed_over) });
            }
            Err(error) => {
                passed_over.push(PassedOver { file: experiment.file.clone(), error: error.clone().into() });
                needs.push(Reason::from(error));
            }
        }
    }
    if needs.is_empty() {
        needs.push(Reason::Recording { any_of: sought.missing().to_vec() });
    }
    Err(needs)
}
