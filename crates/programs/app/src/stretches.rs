//! Stretches of recordings: figures, histograms, spectra and pairs, as the library finds them.

use axum::extract::{Query, State};
use dynoid::stretches::RecordedStretch;

use crate::answer::{Answer, Fault};
use crate::blocking::cancellable;
use crate::recordings::{Asked, handle};
use crate::shared::Shared;

/// Columns and bands of a picture, at most.
const MOST_COLUMNS: usize = 2048;
/// Bins of a histogram, at most.
const MOST_BINS: usize = 10_000;

impl Asked {
    /// The one channel of an act that takes one.
    fn name(&self) -> Result<String, Fault> {
        let [name] = self.exactly("one channel")?;
        Ok(name)
    }

    fn exactly<const N: usize>(&self, wanted: &str) -> Result<[String; N], Fault> {
        self.names()?.try_into().map_err(|_| Fault::refused(format!("name {wanted}")))
    }

    fn stretch(&self, shared: &Shared) -> Result<RecordedStretch, Fault> {
        Ok(RecordedStretch::new(handle(shared, &self.file)?, &self.file, self.begin_s(), self.end_s()))
    }
}

/// Figures of each channel.
pub(crate) async fn figures(State(shared): State<Shared>, Query(asked): Query<Asked>) -> Answer {
    cancellable(move |context| {
        let stretch = asked.stretch(&shared)?;
        let of = |name: &String| stretch.figures(name, context).map_err(Fault::refused);
        asked.names()?.iter().map(of).collect::<Result<Vec<_>, _>>()
    })
    .await
}

/// Counts of the samples of a channel.
pub(crate) async fn histogram(State(shared): State<Shared>, Query(asked): Query<Asked>) -> Answer {
    cancellable(move |context| {
        let bins = asked.bins.map(|bins| bins.clamp(1, MOST_BINS));
        asked.stretch(&shared)?.histogram(&asked.name()?, bins, context).map_err(Fault::refused)
    })
    .await
}

/// Power spectrum of a channel.
pub(crate) async fn spectrum(State(shared): State<Shared>, Query(asked): Query<Asked>) -> Answer {
    cancellable(move |context| {
        asked.stretch(&shared)?.spectrum(&asked.name()?, asked.segment, context).map_err(Fault::refused)
    })
    .await
}

/// Power densities of a channel over time.
pub(crate) async fn spectrogram(State(shared): State<Shared>, Query(asked): Query<Asked>) -> Answer {
    cancellable(move |context| {
        let within = |wanted: Option<usize>, usual: usize| wanted.unwrap_or(usual).clamp(1, MOST_COLUMNS);
        let (columns, bands) = (within(asked.columns, 600), within(asked.bands, 300));
        let up_to_hz = asked.up_to_hz.unwrap_or(f64::INFINITY);
        let (stretch, name) = (asked.stretch(&shared)?, asked.name()?);
        stretch.spectrogram(&name, asked.segment, columns, bands, up_to_hz, context).map_err(Fault::refused)
    })
    .await
}

/// Values of two channels at the same instants.
pub(crate) async fn pairs(State(shared): State<Shared>, Query(asked): Query<Asked>) -> Answer {
    cancellable(move |context| {
        let [x, y] = asked.exactly("two channels")?;
        asked.stretch(&shared)?.pairs(&x, &y, context).map_err(Fault::refused)
    })
    .await
}
