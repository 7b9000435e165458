//! Statements about data.

use dataset::{Adjustment, Resampling};
use ident::{Advice, Channel, Dataset, Intersample, Label, TrendShape};
use page::decimal::{scientific, significant};

/// Purpose of data, which bears on the facts to know about them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// A model is to be estimated from them, after this trend was taken off.
    Estimate(Option<TrendShape>),
    /// A model that is there is compared with them.
    Judgement,
}

/// Describes the change of a channel and, where the data are for an estimate, how to avoid it. The clock was `given` or
/// is that of the method.
pub fn adjustment(adjustment: &Adjustment, purpose: Purpose, given: bool) -> String {
    match adjustment {
        Adjustment::Jitter { channel, largest_s } => format!(
            "\"{channel}\": its time stamps are up to {} s off an even clock; values were found on straight lines between the samples",
            scientific(*largest_s, 3)
        ),
        Adjustment::Resampled { channel, from_s, to_s, how } => {
            let (from, to) = (significant(*from_s), significant(*to_s));
            let remedy = match (how, purpose) {
                (Resampling::Filtered, Purpose::Estimate(_)) => filter_remedy(given),
                _ => "",
            };
            format!("\"{channel}\" was brought from a sample time of {from} s to {to} s{}{remedy}", resampling(*how))
        }
        Adjustment::Sparse { channel, sample_time_s } => format!(
            "\"{channel}\" has a sample only every {} s and counts as missing between; methods that look at the simulated output (oe, tf, process, greybox) can use it so",
            significant(*sample_time_s)
        ),
        Adjustment::Mixed { filtered, other } => format!(
            "between samples \"{filtered}\" is band-limited, as the low-pass filter left it, and \"{other}\" is not; a continuous model takes both for band-limited, so choose a --sample-time that filters neither or both"
        ),
        Adjustment::State { channel, from_s } => format!(
            "\"{channel}\", every {} s, takes few different whole values; each was held until the next",
            significant(*from_s)
        ),
        Adjustment::Missing { channel, count, of } => format!("\"{channel}\": {count} of {of} samples are missing"),
    }
}

fn resampling(how: Resampling) -> &'static str {
    match how {
        Resampling::Filtered => ", through a low-pass filter without phase shift, and is band-limited since",
        Resampling::Held => ", each value held until the next (--between)",
        Resampling::Straight => ", on straight lines from value to value (--between)",
        Resampling::Beside => ", on straight lines between its samples, which lie beside those of the others",
        Resampling::BandLimited => ", as a band-limited signal (--between)",
    }
}

/// Remedy that spares a channel the filter.
fn filter_remedy(given: bool) -> &'static str {
    if given {
        "; without --sample-time, fits to the simulated output (oe, tf, process, greybox) take the faster clock and filter nothing"
    } else {
        "; for fast dynamics choose a fit to the simulated output (oe, tf, process, greybox), which takes the faster clock and filters nothing"
    }
}

/// Returns true if advice is news. Offsets are none where they are taken off, and missing samples have been counted
/// already. How well data suit an estimate is no matter where none is made.
pub fn matters(advice: &Advice, purpose: Purpose) -> bool {
    match (advice, purpose) {
        (Advice::Missing { .. }, _) => false,
        (Advice::Constant { .. } | Advice::Clipped { .. } | Advice::Outliers { .. }, _) => true,
        (_, Purpose::Judgement) => false,
        (Advice::Offset { .. }, Purpose::Estimate(detrend)) => detrend.is_none(),
        (Advice::Drift { .. }, Purpose::Estimate(detrend)) => detrend != Some(TrendShape::Line),
        (Advice::Integrating { .. }, Purpose::Estimate(detrend)) => detrend.is_some(),
        _ => true,
    }
}

/// Returns true if the adjustment of a channel to the clock explains the advice. Values between samples are found from
/// those on either side, so that values to come show in them.
pub fn is_explained(advice: &Advice, adjustments: &[Adjustment], data: &Dataset) -> bool {
    let (Advice::Feedback { input, output, .. } | Advice::Feedthrough { input, output, .. }) = advice else {
        return false;
    };
    let sees_ahead = |label: &Label| {
        adjustments.iter().any(|adjustment| match adjustment {
            Adjustment::Jitter { channel, .. } => *channel == label.name,
            Adjustment::Resampled { channel, how, .. } => *channel == label.name && *how != Resampling::Held,
            _ => false,
        })
    };
    sees_ahead(&data.input_labels()[*input]) || sees_ahead(&data.output_labels()[*output])
}

/// Advice by the names of channels and recordings.
pub fn advice(advice: &Advice, data: &Dataset) -> String {
    let named = with_names(&advice.to_string(), data);
    match advice {
        Advice::Integrating { .. } => {
            format!("{named}, but a trend is taken off, and part of the response with it; try --detrend none")
        }
        Advice::Drift { channel: Channel::Output(_), .. } => {
            format!("{named}; if the inputs do not explain it, take it off with --detrend line")
        }
        Advice::Feedback { .. } if data.intersample() == Intersample::ZeroOrderHold => {
            format!("{named}, or where the input is not held between its samples (--between)")
        }
        Advice::Feedthrough { .. } if data.intersample() == Intersample::ZeroOrderHold => format!(
            "{named}, or the input is not held between its samples and the delay is below one; then choose --between straight \
             or band-limited"
        ),
        _ => named,
    }
}

/// Advice counts channels and experiments; people know them by name.
fn with_names(text: &str, data: &Dataset) -> String {
    let quoted = |labels: &[Label]| labels.iter().map(|label| format!("\"{}\"", label.name)).collect::<Vec<_>>();
    let experiments = data.experiments().iter().map(|e| e.name.clone()).collect();
    let kinds = [
        ("input ", quoted(data.input_labels())),
        ("output ", quoted(data.output_labels())),
        ("experiment ", experiments),
    ];
    // From the left, so that a name that reads like a count is not taken for one.
    let (mut named, mut rest) = (String::new(), text);
    while let Some((at, kind)) = kinds.iter().filter_map(|kind| Some((rest.find(kind.0)?, kind))).min_by_key(|k| k.0) {
        let after = &rest[at + kind.0.len()..];
        let digits = after.bytes().take_while(u8::is_ascii_digit).count();
        let name = after[..digits].parse::<usize>().ok().and_then(|count| kind.1.get(count.checked_sub(1)?));
        named.push_str(&rest[..at]);
        named.push_str(name.map_or(&rest[at..at + kind.0.len() + digits], String::as_str));
        rest = &after[digits..];
    }
    named + rest
}
