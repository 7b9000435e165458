//! The notation of the embedded series: values with blanks between them, `value*n` for a value that repeats.

use crate::error::CycleError;

/// Lines that say where the data are from.
pub(crate) fn source(text: &str) -> String {
    let comments = text.lines().filter_map(|line| line.strip_prefix("# "));
    comments
        .collect::<Vec<_>>()
        .join(" ")
        .split_once("Source: ")
        .map_or_else(String::new, |(_, source)| source.to_owned())
}

/// Every value, repeated as often as it says.
pub(crate) fn values<T: Clone>(
    name: &'static str,
    text: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, CycleError> {
    let mut all = Vec::new();
    let words = text.lines().filter(|line| !line.starts_with('#')).flat_map(str::split_whitespace);
    for word in words {
        let damaged = || CycleError::Data { name, near: word.to_owned() };
        let (value, times) = word.split_once('*').unwrap_or((word, "1"));
        let times: usize = times.parse().map_err(|_| damaged())?;
        let value = parse(value).ok_or_else(damaged)?;
        all.extend(std::iter::repeat_n(value, times));
    }
    Ok(all)
}

/// A finite number.
pub(crate) fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|value: &f64| value.is_finite())
}
