//! Campbell maps, and where frequencies show at other sample rates.

use axum::extract::{Query, State};
use serde::Deserialize;

use crate::answer::{Answer, Fault, json};
use crate::blocking::cancellable;
use crate::models::{files, refused};
use crate::shared::Shared;

/// A recording of a bench.
#[derive(Deserialize)]
pub(crate) struct Wanted {
    bench: String,
    recording: String,
}

/// The maps of the signals of a recording.
pub(crate) async fn maps(State(shared): State<Shared>, Query(wanted): Query<Wanted>) -> Answer {
    cancellable(move |context| {
        let [bench, recording] = [shared.folder.existing(&wanted.bench)?, shared.folder.existing(&wanted.recording)?];
        dynoid::campbell(&bench, &recording, &files(), context).map_err(|fault| refused(fault, &shared))
    })
    .await
}

/// Frequencies at a sample rate.
#[derive(Deserialize)]
pub(crate) struct Sampled {
    /// Frequencies in Hz, as a list in JSON.
    hz: String,
    rate_hz: f64,
}

/// Where frequencies show at a sample rate, Hz.
pub(crate) async fn folded(Query(sampled): Query<Sampled>) -> Answer {
    let hz: Vec<f64> = serde_json::from_str(&sampled.hz).map_err(Fault::refused)?;
    if !(sampled.rate_hz.is_finite() && sampled.rate_hz > 0.0) {
        return Err(Fault::refused("a sample rate is a number above zero"));
    }
    json(&hz.iter().map(|hz| dynoid::folded_hz(*hz, sampled.rate_hz)).collect::<Vec<_>>())
}
