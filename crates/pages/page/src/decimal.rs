//! Numbers in the characters of a keyboard, `-1.25e-5`: they can be copied into other programs. The commands for linear
//! models write them so, with the unit that a recording states.

/// Six significant digits.
pub fn significant(value: f64) -> String {
    digits(value, 6)
}

/// So many significant digits; zeros behind the point that say nothing are dropped.
pub fn digits(value: f64, count: i32) -> String {
    match value.abs() {
        _ if !value.is_finite() => format!("{value}"),
        0.0 => "0".to_owned(),
        size if (1e-4..1e6).contains(&size) => {
            let decimals = (count - 1 - size.log10().floor() as i32).max(0) as usize;
            let text = fixed(value, decimals);
            if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        }
        _ => scientific(value, count as usize - 1),
    }
}

/// So many digits behind the point.
pub fn fixed(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}")
}

/// A number with a power of ten, and so many digits behind the point: `1.2e-5`.
pub fn scientific(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$e}")
}

/// Six significant digits of each coefficient of a polynomial; what is rounding beside the largest is none.
pub fn coefficients(all: &[f64]) -> String {
    const ROUNDING: f64 = 1e-15;
    let largest = all.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
    let text = |v: &f64| if v.abs() < ROUNDING * largest { "0".to_owned() } else { significant(*v) };
    all.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// A fit in percent; a dash where nothing was measured, or nothing that varies.
pub fn percent(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "–".to_owned(),
        _ if value.abs() < 1e6 => format!("{} %", fixed(value, 2)),
        _ => format!("{} %", scientific(value, 1)),
    }
}

/// A probability; the smallest ones only as such.
pub fn probability(p: f64) -> String {
    if p < 0.001 { "p < 0.001".to_owned() } else { format!("p = {}", fixed(p, 3)) }
}

/// An interval; one-sided where an end is nowhere, and nothing where there is none.
pub fn range(interval: Option<(f64, f64)>) -> String {
    match interval {
        None => String::new(),
        Some((low, high)) if low.is_infinite() && high.is_infinite() => "anything".to_owned(),
        Some((low, high)) if high.is_infinite() => format!("above {}", digits(low, 4)),
        Some((low, high)) if low.is_infinite() => format!("below {}", digits(high, 4)),
        Some((low, high)) => {
            let decimals = decimals(low, high);
            format!("{} … {}", to_decimals(low, decimals, 4), to_decimals(high, decimals, 4))
        }
    }
}

/// A value with its unit and, in brackets, its interval.
pub fn with_range(value: f64, unit: &str, interval: Option<(f64, f64)>) -> String {
    let space = if unit.is_empty() { "" } else { " " };
    let decimals = interval.and_then(|(low, high)| decimals(low, high)).map(|decimals| decimals + 1);
    let range = interval.map(|_| format!(" ({})", range(interval)));
    format!("{}{space}{unit}{}", to_decimals(value, decimals, 5), range.unwrap_or_default())
}

/// Decimals after which an interval has two digits of its width; none where numbers are too small or too large for
/// that.
fn decimals(low: f64, high: f64) -> Option<usize> {
    // Of an interval without width, as of data without noise, −∞.
    let decimals = 1_i32.saturating_sub((high - low).abs().log10().floor() as i32);
    let largest = low.abs().max(high.abs());
    ((0..=6).contains(&decimals) && (1e-3..1e6).contains(&largest)).then_some(decimals as usize)
}

fn to_decimals(value: f64, decimals: Option<usize>, otherwise: i32) -> String {
    decimals.map_or_else(|| digits(value, otherwise), |decimals| fixed(value, decimals))
}
