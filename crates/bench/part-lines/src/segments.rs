//! Where a demand is a steady sine, and of which frequency.

use std::f64::consts::TAU;

use numerics::search;
use numerics::vector::{dot, norm, sum_of_squares};
use signal::Signal;

/// The demand is looked at in blocks of about this length, s.
const BLOCK_S: f64 = 5e-3;
const WINDOW_S: f64 = 1.0;
const HOP_S: f64 = 0.1;
const LOWEST_HZ: f64 = 0.75;
const HIGHEST_HZ: f64 = 45.0;
const GRID_HZ: f64 = 0.25;
/// Share of a window's variance that one sine must explain. A sine held at five levels a period explains 0.87.
const EXPLAINED: f64 = 0.7;
/// Windows quieter than this part of the loudest hold no test.
const QUIET: f64 = 0.1;
/// Windows of one piece agree in frequency within this, Hz.
const AGREEMENT_HZ: f64 = 0.05;
/// Part of the range about a piece's frequency to which that is refined.
const FINE: f64 = 8e-9;
/// Windows a piece must have.
const FEWEST_WINDOWS: usize = 4;

/// A steady sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Start, s of the recording's clock.
    pub start_s: f64,
    /// End, s.
    pub end_s: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
}

/// Finds the stretches of at least 1.3 s over which a demand is one sine of 0.75 to 45 Hz.
///
/// In windows of one second, every 0.1 s, the frequency is sought whose cosine and sine, beside a straight line,
/// explain most of the window; neighbouring windows that agree make a piece, whose frequency is then refined over all
/// of it. A window that spans a change of frequency explains less or disagrees with its neighbours.
///
/// # Source
/// Least-squares spectrum: Lomb, Astrophysics and Space Science 39 (1976) 447.
pub fn steady_sines(demand: &Signal) -> Vec<Segment> {
    let Some(track) = Track::new(demand) else { return Vec::new() };
    let mut found = Vec::new();
    let mut first = 0;
    while first < track.windows.len() {
        let count = track.agreeing(first);
        if count >= FEWEST_WINDOWS {
            found.push(track.segment(first, count));
        }
        first += count.max(1);
    }
    found
}

/// Frequency over time: `None` where a window holds no sine.
struct Track {
    start_s: f64,
    block_s: f64,
    blocks: Vec<f64>,
    hop: usize,
    length: usize,
    windows: Vec<Option<f64>>,
}

impl Track {
    fn new(demand: &Signal) -> Option<Self> {
        let per_block = ((BLOCK_S / demand.sample_time_s).round() as usize).max(1);
        let mean = |block: &[f64]| block.iter().sum::<f64>() / per_block as f64;
        let blocks: Vec<f64> = demand.samples.chunks_exact(per_block).map(mean).collect();
        let block_s = per_block as f64 * demand.sample_time_s;
        let (length, hop) = ((WINDOW_S / block_s).round() as usize, ((HOP_S / block_s).round() as usize).max(1));
        if length < 8 || blocks.len() < length {
            return None;
        }
        let mut track = Track { start_s: demand.start_s, block_s, blocks, hop, length, windows: Vec::new() };
        track.follow();
        Some(track)
    }

    fn follow(&mut self) {
        let highest = HIGHEST_HZ.min(0.25 / self.block_s);
        let count = ((highest - LOWEST_HZ) / GRID_HZ) as usize + 1;
        let frequencies: Vec<f64> = (0..count).map(|i| LOWEST_HZ + GRID_HZ * i as f64).collect();
        let bases: Vec<Basis> = frequencies.iter().map(|f| Basis::new(f * self.block_s, self.length)).collect();
        let windows: Vec<Vec<f64>> = self.blocks.windows(self.length).step_by(self.hop).map(detrended).collect();
        let powers: Vec<f64> = windows.iter().map(|w| sum_of_squares(w)).collect();
        let loudest = powers.iter().copied().fold(0.0, f64::max);
        let loud = |i: usize| powers[i] > QUIET * QUIET * loudest;
        self.windows = (0..windows.len())
            .map(|i| if loud(i) { peak(&windows[i], powers[i], &frequencies, &bases) } else { None })
            .collect();
    }

    /// How many windows from `first` on agree with it.
    fn agreeing(&self, first: usize) -> usize {
        let Some(frequency) = self.windows[first] else { return 0 };
        let agrees = |w: &&Option<f64>| w.is_some_and(|f| (f - frequency).abs() <= AGREEMENT_HZ);
        self.windows[first..].iter().take_while(agrees).count()
    }

    fn segment(&self, first: usize, count: usize) -> Segment {
        let from = first * self.hop;
        let to = from + (count - 1) * self.hop + self.length;
        let stretch = detrended(&self.blocks[from..to]);
        let start = self.windows[first].unwrap_or(LOWEST_HZ);
        let reach_hz = 2.0 * AGREEMENT_HZ;
        let explained = |f: f64| Basis::new(f * self.block_s, stretch.len()).explained(&stretch);
        Segment {
            start_s: self.start_s + from as f64 * self.block_s,
            end_s: self.start_s + to as f64 * self.block_s,
            frequency_hz: search::maximum((start - reach_hz, start + reach_hz), FINE * reach_hz, explained),
        }
    }
}

/// Orthonormal cosine and sine, both free of mean and slope.
struct Basis([Vec<f64>; 2]);

impl Basis {
    /// `frequency` in cycles a sample.
    fn new(frequency: f64, length: usize) -> Self {
        let wave = |phase: f64| -> Vec<f64> {
            let values: Vec<f64> = (0..length).map(|i| (TAU * frequency * i as f64 + phase).cos()).collect();
            detrended(&values)
        };
        let cosine = normalised(wave(0.0));
        let mut sine = wave(-TAU / 4.0);
        let overlap = dot(&cosine, &sine);
        sine.iter_mut().zip(&cosine).for_each(|(s, c)| *s -= overlap * c);
        Basis([cosine, normalised(sine)])
    }

    /// Sum of squares of `x` that the basis explains.
    fn explained(&self, x: &[f64]) -> f64 {
        self.0.iter().map(|b| dot(b, x).powi(2)).sum()
    }
}

/// The frequency that explains most, between the grid's points by a parabola; `None` where it explains too little.
fn peak(window: &[f64], power: f64, frequencies: &[f64], bases: &[Basis]) -> Option<f64> {
    let explained: Vec<f64> = bases.iter().map(|b| b.explained(window)).collect();
    let best = (0..explained.len()).max_by(|a, b| explained[*a].total_cmp(&explained[*b]))?;
    if explained[best] < EXPLAINED * power {
        return None;
    }
    if best == 0 || best + 1 == explained.len() {
        return Some(frequencies[best]);
    }
    let (low, top, high) = (explained[best - 1], explained[best], explained[best + 1]);
    Some(frequencies[best] + 0.5 * GRID_HZ * (low - high) / (low - 2.0 * top + high))
}

fn normalised(x: Vec<f64>) -> Vec<f64> {
    let norm = norm(&x);
    if norm > 0.0 { x.iter().map(|v| v / norm).collect() } else { x }
}

/// Less the straight line of least squares.
fn detrended(x: &[f64]) -> Vec<f64> {
    let n = x.len() as f64;
    let (mean, centre) = (x.iter().sum::<f64>() / n, 0.5 * (n - 1.0));
    let at = |i: usize| i as f64 - centre;
    let moment: f64 = x.iter().enumerate().map(|(i, v)| at(i) * v).sum();
    let slope = moment / (n * (n * n - 1.0) / 12.0);
    x.iter().enumerate().map(|(i, v)| v - mean - slope * at(i)).collect()
}
