//! How precise samples and their instants can be.

/// Standard deviation of the white noise on a signal's samples, from the median of its spectrum between 0.6 and 0.95 of
/// half its rate, where motion of the bench has died away; zero for a signal too short.
pub fn noise_floor(signal: &signal::Signal) -> f64 {
    let segment = (signal.len() / 8).min(4096);
    let welch = signal::spectrum::Welch::half_overlapping(segment);
    let Ok(spectrum) = signal::spectrum::power_spectrum(&signal.samples, signal.sample_time_s, welch) else {
        return 0.0;
    };
    let nyquist = signal.nyquist_hz();
    let band = |f: &f64| (0.6 * nyquist..0.95 * nyquist).contains(f);
    let mut density: Vec<f64> =
        spectrum.freq_hz.iter().zip(&spectrum.density).filter(|(f, _)| band(f)).map(|(_, d)| *d).collect();
    density.sort_by(f64::total_cmp);
    // A white signal of variance σ² has the one-sided density 2σ²T; over some 15 segments the median is within a few
    // per cent of the mean.
    density.get(density.len() / 2).map_or(0.0, |d| (d / (2.0 * signal.sample_time_s)).sqrt())
}

/// Standard uncertainty of the instant a time stamp stands for, s.
///
/// A sample is dated no better than to a twentieth of the fastest raster either way (when in its cycle a controller
/// latches a value is not recorded); taken as uniform, that is T/(20 √3). It bounds what any delay or skew can claim,
/// however long the recording.
pub fn timing_floor_s(sample_time_s: f64) -> f64 {
    sample_time_s / (20.0 * 3f64.sqrt())
}
