//! Names, units, and names that mean time, as headings and names of variables spell them.

/// Names that mean the clock, the longer first.
const WORDS: [&str; 21] = [
    "samplinginstants",
    "absolute time",
    "datum/uhrzeit",
    "datum uhrzeit",
    "relative time",
    "elapsed time",
    "timestamps",
    "date/time",
    "date time",
    "zeitstempel",
    "time stamp",
    "timestamp",
    "datetime",
    "sim time",
    "messzeit",
    "zeitpunkt",
    "uhrzeit",
    "time",
    "zeit",
    "tout",
    "t",
];

/// The word for time that a name consists of, apart from a number or a rate at its end: `time`, `Zeit`, `time_2`,
/// `timestamp 100 Hz`. A capital `T` is a temperature or a torque.
pub(crate) fn time_word(name: &str) -> Option<&'static str> {
    let name = name.trim();
    let lower = name.to_lowercase();
    let word = WORDS.into_iter().find(|word| lower.starts_with(word))?;
    let rest = &lower[word.len()..];
    let number = rest.trim_start_matches(['_', ' ', '.', '-', '#']);
    let rate = number.trim_start_matches(|c: char| c.is_ascii_digit());
    let numbered = rate.len() < number.len() && matches!(rate.trim(), "" | "hz" | "khz" | "ms" | "us" | "s");
    ((rest.is_empty() || numbered) && !(word == "t" && name.starts_with('T'))).then_some(word)
}

/// Returns true if a word of a name means time: `time_fast`, `DynoSpeed_time`, `Time 1ms raster`, `zeitLangsam`. A `t`
/// is one as the first word. A name that ends in `_channel` is no clock.
pub(crate) fn mentions_time(name: &str) -> bool {
    if name.trim_end().ends_with("_channel") {
        return false;
    }
    let mut words = words(name).into_iter();
    words.next().is_some_and(|first| first == "t" || is_time(&first)) || words.any(|word| is_time(&word))
}

fn is_time(word: &str) -> bool {
    let word = word.to_lowercase();
    word != "t" && WORDS.contains(&word.as_str())
}

/// The words of a name, which anything but letters separates, or a capital after a small letter.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut is_small = false;
    for letter in name.chars() {
        if !letter.is_alphabetic() || (is_small && letter.is_uppercase()) {
            words.push(String::new());
        }
        is_small = letter.is_lowercase();
        if let (true, Some(word)) = (letter.is_alphabetic(), words.last_mut()) {
            word.push(letter);
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Seconds per unit as a fraction; no unit means seconds.
pub(crate) fn seconds(unit: &str) -> Option<(f64, f64)> {
    Some(match unit.trim() {
        "" | "s" | "S" | "sec" | "Sec" | "SEC" | "second" | "seconds" | "Seconds" | "Sekunden" | "sec.ms" => (1.0, 1.0),
        "ms" | "msec" | "millisecond" | "milliseconds" | "Millisekunden" => (1.0, 1e3),
        "us" | "µs" | "μs" | "usec" | "microsecond" | "microseconds" => (1.0, 1e6),
        "ns" | "nsec" | "nanosecond" | "nanoseconds" => (1.0, 1e9),
        "min" | "minutes" | "Minuten" => (60.0, 1.0),
        "h" | "hours" | "Stunden" => (3600.0, 1.0),
        "d" | "days" | "Tage" => (86400.0, 1.0),
        _ => return None,
    })
}

/// Splits `Name [unit]` and `Name (unit)`.
pub(crate) fn name_and_unit(cell: &str) -> (&str, &str) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let inner = cell.strip_suffix(close).and_then(|c| c.rsplit_once(open));
        if let Some((name, unit)) = inner
            && !name.trim().is_empty()
        {
            return (name.trim(), unit.trim());
        }
    }
    (cell, "")
}

/// Splits the heading of a clock also where its unit is spelled `t/s`, `Zeit in ms` or `time_us`, and where pandas has
/// added a number to a repeated name, as in `Time (s).1`.
pub(crate) fn clock_and_unit(cell: &str) -> (&str, &str) {
    let (name, unit) = name_and_unit(without_number(cell));
    if !unit.is_empty() || time_word(name).is_some() {
        return (name, unit);
    }
    let parts = ["/", " in ", "_"].into_iter().filter_map(|between| name.rsplit_once(between));
    let mut clocks = parts.map(|(stem, unit)| (stem.trim(), unit.trim()));
    let is_clock =
        |(stem, unit): &(&str, &str)| time_word(stem).is_some() && !unit.is_empty() && seconds(unit).is_some();
    clocks.find(is_clock).unwrap_or((name, unit))
}

/// A heading without the number that pandas adds after a bracket.
fn without_number(cell: &str) -> &str {
    let is_number = |number: &str| !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
    let parts = cell.rsplit_once('.').filter(|(stem, number)| stem.ends_with([')', ']']) && is_number(number));
    parts.map_or(cell, |(stem, _)| stem)
}

/// Text that brackets around a whole cell enclose.
pub(crate) fn unbracketed(cell: &str) -> &str {
    let cell = cell.trim();
    let inner = |open, close| cell.strip_prefix(open)?.strip_suffix(close);
    inner('[', ']').or_else(|| inner('(', ')')).unwrap_or(cell).trim()
}

/// `name [unit]`; a name that ends in a bracket needs the unit even if it is empty.
pub(crate) fn heading(name: &str, unit: &str) -> String {
    match unit.is_empty() && !name.ends_with([']', ')']) {
        true => name.to_owned(),
        false => format!("{name} [{unit}]"),
    }
}
