//! Stretches of recordings in numbers.

use dataset::inspection::Stretch;
use serde::Serialize;
use signal::window::Window;

/// Counts of the samples of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HistogramFacts {
    /// Unit of the channel.
    pub unit: String,
    /// Its figures.
    pub figures: Stretch,
    /// Lower edge of the first bin.
    pub low: f64,
    /// Width of a bin.
    pub width: f64,
    /// Samples in each bin.
    pub counts: Vec<u64>,
}

/// How a stretch was cut into segments for spectra.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SegmentsFacts {
    /// Instant of the first sample, s.
    pub from_s: f64,
    /// Instant of the last sample, s.
    pub to_s: f64,
    /// Samples on the channel's clock, those included that are missing.
    pub samples: usize,
    /// Samples that are missing.
    pub missing: usize,
    /// Time from sample to sample, s.
    pub sample_time_s: f64,
    /// Window that each segment is multiplied with.
    pub window: Window,
    /// Samples in a segment.
    pub segment: usize,
    /// Samples that two neighbours share.
    pub overlap: usize,
    /// Segments whose densities are averaged.
    pub segments: usize,
    /// Segments that are left out, since samples are missing in them.
    pub left_out: usize,
    /// Distance of the frequencies, Hz.
    pub spacing_hz: f64,
    /// Noise bandwidth of the window, Hz.
    pub bandwidth_hz: f64,
    /// Adjustments of the channel, in words.
    pub notes: Vec<String>,
}

/// Power spectrum of a channel by Welch's method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PowerFacts {
    /// Unit of the amplitudes: that of the channel.
    pub unit: String,
    /// Unit of the densities.
    pub density_unit: String,
    /// How the stretch was cut.
    pub segments: SegmentsFacts,
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Power density at each.
    pub density: Vec<f64>,
    /// Amplitude of a sine that has this density in its line.
    pub amplitude: Vec<f64>,
    /// Factors from a density to the ends of its 95 % interval, for noise.
    pub interval_95: [f64; 2],
}

/// Power densities of a channel over time and frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectrogramFacts {
    /// Unit of the densities.
    pub density_unit: String,
    /// How the stretch was cut.
    pub segments: SegmentsFacts,
    /// Time at which the first column begins, s.
    pub from_s: f64,
    /// Time at which the last column ends, s.
    pub to_s: f64,
    /// Lower edge of the first band of frequency, Hz.
    pub first_hz: f64,
    /// Width of a band, Hz.
    pub band_hz: f64,
    /// Frequencies in a band, of which the largest density is shown.
    pub frequencies_a_band: usize,
    /// Densities of each column in each band, dB; NaN where there is none.
    pub levels_db: Vec<Vec<f64>>,
    /// Levels between which most are, dB; none where there is no level.
    pub range_db: Option<[f64; 2]>,
}

/// Values of two channels at the same instants.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairsFacts {
    /// Units of both.
    pub units: [String; 2],
    /// Instant of the first pair, s.
    pub from_s: f64,
    /// Instant of the last pair, s.
    pub to_s: f64,
    /// Time from pair to pair, s.
    pub sample_time_s: f64,
    /// Pairs of which both values are numbers.
    pub pairs: usize,
    /// Pairs of which one is missing.
    pub missing: usize,
    /// True where the stretch was too long, and ends earlier.
    pub is_cut: bool,
    /// The pairs in the order of time; none where there are too many to be drawn one by one.
    pub points: Vec<[f64; 2]>,
    /// Counts of the pairs, where there are too many.
    pub cells: Option<CellsFacts>,
    /// Adjustments of the channels, in words.
    pub notes: Vec<String>,
}

/// Counts of pairs in cells of a plane.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CellsFacts {
    /// Lower edge of the first column, and width of a column.
    pub along_x: [f64; 2],
    /// Lower edge of the first row, and height of a row.
    pub along_y: [f64; 2],
    /// Of each column the counts of its rows.
    pub counts: Vec<Vec<u64>>,
}
