//! What is said about data.

use bench::dataset::{Adjustment, Resampling};
use ident::{Advice, Dataset, Label};

use crate::cli::identify::Detrend;
use crate::commands::identify::words::significant;

/// What was done to a channel.
pub(super) fn adjustment(adjustment: &Adjustment) -> String {
    match adjustment {
        Adjustment::Jitter { channel, largest_s } => format!(
            "\"{channel}\": its time stamps are up to {largest_s:.3e} s off an even clock; values were found on straight lines between the samples"
        ),
        Adjustment::Resampled { channel, from_s, to_s, how } => {
            let (from, to) = (significant(*from_s), significant(*to_s));
            format!("\"{channel}\" was brought from a sample time of {from} s to {to} s{}", resampling(*how))
        }
        Adjustment::Sparse { channel, sample_time_s } => format!(
            "\"{channel}\" has a sample only every {} s and counts as missing between; methods that look at the simulated output (oe, tf, process, greybox) can use it so",
            significant(*sample_time_s)
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
        Resampling::Filtered => {
            ", through a low-pass filter without phase shift; for fast dynamics choose a fit to the simulated output (oe, tf, process, greybox), which takes the faster clock and filters nothing"
        }
        Resampling::Held => ", each value held until the next (--between)",
        Resampling::Straight => ", on straight lines from value to value (--between)",
        Resampling::BandLimited => ", as a band-limited signal (--between)",
    }
}

/// Whether advice is news: offsets are none where they are taken off, and missing samples have been counted already.
pub(super) fn matters(advice: &Advice, detrend: Detrend) -> bool {
    match advice {
        Advice::Missing { .. } => false,
        Advice::Offset { .. } => detrend == Detrend::None,
        Advice::Drift { .. } => detrend != Detrend::Line,
        Advice::Integrating { .. } => detrend != Detrend::None,
        _ => true,
    }
}

/// Advice by the names of channels and recordings.
pub(super) fn advice(advice: &Advice, data: &Dataset) -> String {
    let named = with_names(&advice.to_string(), data);
    match advice {
        Advice::Integrating { .. } => {
            format!("{named}, but a trend is taken off, and part of the response with it; try --detrend none")
        }
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
