//! Whether the speed of the dynamometer was recorded behind a low-pass filter.
//!
//! Above 200 Hz nothing of a bench moves N_d by as much as its encoder's noise, which is white. Behind a filter the noise falls.
//! N_e shows no such thing: multiples of the firing frequency are above its noise.

use signal::spectrum::{Welch, power_spectrum};

use crate::bench_file::BenchFile;
use crate::diagnostics::{Finding, Severity};
use crate::experiment::Experiment;
use crate::prepare::log::Log;
use crate::role::Role;

/// Samples of a segment.
const SEGMENT: usize = 512;
/// Bands that are compared, as parts of the sample rate.
const BANDS: [(f64, f64); 2] = [(0.20, 0.28), (0.40, 0.49)];
/// Slower rasters do not reach the encoder's noise, s.
const SLOWEST_S: f64 = 1.5e-3;
/// The ratio of the powers below which there is a filter. On 40 recordings of ten simulated benches it is 0.16 to 1.1; a filter of
/// second order makes it 0.001 at 100 Hz, and 0.03 at 300 Hz.
const FALLS: f64 = 0.03;

pub(super) fn check(experiment: &Experiment, bench_file: &BenchFile, log: &mut Log) {
    let role = Role::DynoSpeed;
    let Some(speed) = experiment.signal(role).filter(|speed| speed.sample_time_s < SLOWEST_S) else { return };
    let welch = Welch::half_overlapping(SEGMENT);
    let Ok(spectrum) = power_spectrum(&speed.samples, speed.sample_time_s, welch) else { return };
    let power = |(from, to): (f64, f64)| {
        let share = |hz: f64| hz * speed.sample_time_s;
        let lines = spectrum.freq_hz.iter().zip(&spectrum.density).filter(|(hz, _)| (from..to).contains(&share(**hz)));
        let mut powers: Vec<f64> = lines.map(|(_, power)| *power).collect();
        numerics::order::lower_median(&mut powers)
    };
    let (Some(middle), Some(high)) = (power(BANDS[0]), power(BANDS[1])) else { return };
    if high < FALLS * middle {
        let channel = bench_file.channels.get(&role).map_or(role.key(), |mapping| mapping.name.as_str());
        log.channel(Severity::Warning, channel, None, Finding::SamplesFiltered { ratio: high / middle });
    }
}
