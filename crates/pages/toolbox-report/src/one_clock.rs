//! Effects on channels of bringing them onto one clock, in words.

use dataset::{Adjustment, DatasetError, Resampling};
use page::decimal::{scientific, significant};

/// Adjustments of channels, one sentence for all with the same one.
pub fn adjustments(adjustments: &[Adjustment]) -> Vec<String> {
    together(adjustments.iter().map(sentence))
}

/// Channels that could not be brought onto a clock, those for the same reason together.
pub fn left_out(reasons: &[DatasetError]) -> Vec<String> {
    together(reasons.iter().map(reason))
}

/// One sentence for all channels of which the same is to be said.
fn together<'a>(said: impl Iterator<Item = (&'a str, String)>) -> Vec<String> {
    let mut groups: Vec<(String, Vec<&str>)> = Vec::new();
    for (channel, what) in said {
        match groups.iter_mut().find(|(known, _)| *known == what) {
            Some((_, channels)) => channels.push(channel),
            None => groups.push((what, vec![channel])),
        }
    }
    groups.into_iter().map(|(what, channels)| format!("{} {what}", named(&channels))).collect()
}

/// The first names, and how many more there are.
fn named(channels: &[&str]) -> String {
    const MOST: usize = 3;
    let shown: Vec<String> = channels.iter().take(MOST).map(|name| format!("\"{name}\"")).collect();
    match channels.len().saturating_sub(MOST) {
        0 => format!("{}:", shown.join(", ")),
        more => format!("{} and {more} more:", shown.join(", ")),
    }
}

/// A channel and why it was left out.
fn reason(error: &DatasetError) -> (&str, String) {
    match error {
        DatasetError::NothingLeft { channel, .. } => (channel, "left out: fewer than two samples are numbers".into()),
        DatasetError::TimeNotRising { channel, .. } => (channel, "left out: the time stamps do not rise".into()),
        DatasetError::MostlyGaps { channel, samples, of, .. } => {
            (channel, format!("left out: {samples} samples where the clock would have {of} are too few to filter"))
        }
        DatasetError::Signal { channel, source, .. } => (channel, format!("left out: {source}")),
        other => ("", format!("left out: {other}")),
    }
}

/// A channel and what was done to it.
fn sentence(adjustment: &Adjustment) -> (&str, String) {
    match adjustment {
        Adjustment::Jitter { channel, largest_s } => (
            channel,
            format!(
                "time stamps are up to {} s off an even clock; values were found between the samples",
                scientific(*largest_s, 1)
            ),
        ),
        Adjustment::Resampled { channel, from_s, to_s, how } => {
            (channel, format!("from {} s to {} s, {}", significant(*from_s), significant(*to_s), resampling(*how)))
        }
        Adjustment::State { channel, from_s } => {
            (channel, format!("from {} s, few different whole values, each held until the next", significant(*from_s)))
        }
        Adjustment::Sparse { channel, sample_time_s } => {
            (channel, format!("a sample only every {} s", significant(*sample_time_s)))
        }
        Adjustment::Mixed { filtered, other } => (filtered, format!("filtered, and {other} is not")),
        Adjustment::Missing { channel, count, of } => (channel, format!("{count} of {of} samples are missing (NaN)")),
    }
}

fn resampling(how: Resampling) -> &'static str {
    match how {
        Resampling::Filtered => "through a low-pass filter without phase shift",
        Resampling::Held => "each value held until the next (--between)",
        Resampling::Straight => "on straight lines from value to value (--between)",
        Resampling::Beside => "on straight lines between its samples, which lie beside the ticks",
        Resampling::BandLimited => "as a band-limited signal (--between)",
    }
}
