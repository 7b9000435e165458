//! Meaning of the names of variables and fields, and the texts that describe an array beside them.

use std::collections::HashMap;

use super::value::Value;
use crate::SkipReason;
use crate::heading::{seconds, time_word, unbracketed};

/// Seconds per unit, as a fraction.
pub(super) type Factor = (f64, f64);

/// Names that mean the clock, and nothing but the clock.
const TIME: [&str; 8] = ["time", "t", "zeit", "timestamps", "timestamp", "zeitstempel", "tout", "samplinginstants"];

/// Returns true if a name is one of a clock without number or unit. A capital `T` is a temperature or a torque.
pub(super) fn is_plain_time(name: &str) -> bool {
    name != "T" && TIME.contains(&name.to_lowercase().as_str())
}

/// The unit of a vector that is named like a clock: `t`, `Time`, `time_2`, `time_ms`.
pub(super) fn clock_unit(name: &str) -> Option<Factor> {
    if is_plain_time(name) || time_word(name).is_some() {
        return Some((1.0, 1.0));
    }
    unit_in_name(name)
}

/// The unit at the end of `time_ms`.
fn unit_in_name(name: &str) -> Option<Factor> {
    let (stem, unit) = name.rsplit_once('_')?;
    seconds(unit).filter(|_| is_plain_time(stem) && !unit.is_empty())
}

/// The unit that a clock has by its name or by a text beside it; none where neither gives one.
pub(super) fn stated_unit(members: &Members, clock: &Member) -> Result<Option<Factor>, SkipReason> {
    let by_name = unit_in_name(&clock.name);
    let text = unit_beside(members, &clock.name).and_then(|unit| unit.value.text());
    let Some(text) = text.map(unbracketed).filter(|text| !text.is_empty()) else { return Ok(by_name) };
    match (long_unit(text), by_name) {
        (Some(stated), None) => Ok(Some(stated)),
        (Some(stated), Some(named)) if stated == named => Ok(Some(stated)),
        _ => Err(SkipReason::TimeUnit { clock: clock.path.clone(), unit: text.escape_debug().to_string() }),
    }
}

/// The text that states the unit of a clock: `t_unit` of `t`, or one of any clock (`time_unit` is `time`'s where there
/// is one).
fn unit_beside<'m>(members: &'m Members, clock: &str) -> Option<&'m Member> {
    let lower = clock.to_lowercase();
    let own = ["unit", "units"].map(|word| format!("{lower}_{word}"));
    let of_time: &[&str] = if members.named(&["time"]).is_none() { &["time_unit", "time_units"] } else { &[] };
    members.named(&own.each_ref().map(String::as_str)).or_else(|| members.named(&[&["timeunit"], of_time].concat()))
}

/// Seconds per unit, spelled also as in the `TimeUnit` of MATLAB's data objects.
fn long_unit(text: &str) -> Option<Factor> {
    Some(match text.to_lowercase().as_str() {
        "nanoseconds" => (1.0, 1e9),
        "microseconds" => (1.0, 1e6),
        "milliseconds" => (1.0, 1e3),
        "minutes" => (60.0, 1.0),
        "hours" => (3600.0, 1.0),
        "days" => (86400.0, 1.0),
        _ => return seconds(text),
    })
}

/// A variable, field, or cell in one.
pub(super) struct Member {
    pub(super) path: String,
    /// The name of the variable or field, without the index of a cell in it.
    pub(super) name: String,
    pub(super) value: Value,
}

impl Member {
    /// Returns true if this is a variable or field, not a cell in one.
    pub(super) fn is_whole(&self) -> bool {
        self.path.ends_with(&self.name)
    }
}

/// The members of a scope in the order of the file.
pub(super) struct Members {
    pub(super) list: Vec<Member>,
    /// Where the first member of a name is; names in lower case.
    places: HashMap<String, usize>,
}

impl Members {
    pub(super) fn new(list: Vec<Member>) -> Self {
        let mut places = HashMap::new();
        for (place, member) in list.iter().enumerate() {
            places.entry(member.name.to_lowercase()).or_insert(place);
        }
        Self { list, places }
    }

    /// The member at `index`; what may describe others stays too.
    pub(super) fn take(&mut self, index: usize) -> Member {
        let Member { path, name, value } = &mut self.list[index];
        let stays = value.texts().is_some() || value.scalar().is_some();
        let value = if stays { value.clone() } else { std::mem::replace(value, Value::Text(Vec::new())) };
        Member { path: path.clone(), name: name.clone(), value }
    }

    /// The first member that has one of these names, in any case.
    fn named(&self, names: &[&str]) -> Option<&Member> {
        names.iter().find_map(|name| self.places.get(*name)).map(|&place| &self.list[place])
    }

    /// The number of this name; none where cells hold several.
    fn number(&self, name: &str) -> Option<f64> {
        let member = self.named(&[name])?;
        let several = || self.list.iter().any(|m| m.name == member.name && m.value != member.value);
        member.value.scalar().filter(|n| n.is_finite() && (member.is_whole() || !several()))
    }
}

/// The longest text that is taken for a name, unit or comment.
const MAX_LABEL: usize = 256;

/// Texts that describe an array.
#[derive(Default)]
pub(super) struct Labels {
    pub(super) names: Vec<String>,
    pub(super) units: Vec<String>,
    pub(super) comment: String,
}

impl Labels {
    /// The unit of a column.
    pub(super) fn unit(&self, column: usize) -> String {
        let unit = if self.units.len() == 1 { self.units.first() } else { self.units.get(column) };
        unit.cloned().unwrap_or_default()
    }

    /// The texts beside the array `name`: labels of Simulink's signals, names and units of inputs and outputs,
    /// otherwise `name_unit`, or `unit` where the scope holds no other array.
    pub(super) fn find(members: &Members, index: usize, is_only_array: bool) -> Self {
        let member = &members.list[index];
        let Value::Numbers(array) = &member.value else { return Self::default() };
        let texts = |names: &[&str]| -> Vec<String> {
            let texts = members.named(names).and_then(|m| m.value.texts()).unwrap_or_default();
            let fit = [1, array.rows, array.columns].contains(&texts.len());
            let short = texts.iter().all(|text| text.len() <= MAX_LABEL);
            if fit && short { texts.into_iter().map(str::to_owned).collect() } else { Vec::new() }
        };
        let lower = member.name.to_lowercase();
        let own: Vec<String> = ["unit", "units"].map(|word| format!("{lower}_{word}")).to_vec();
        let mut units: Vec<&str> = own.iter().map(String::as_str).collect();
        let names: &[&str] = match lower.as_str() {
            "values" => &["label"],
            "u" | "inputdata" => &["inputname", "uname"],
            "y" | "outputdata" => &["outputname", "yname"],
            _ => &[],
        };
        match lower.as_str() {
            "u" | "inputdata" => units.push("inputunit"),
            "y" | "outputdata" => units.push("outputunit"),
            _ => {}
        }
        if is_only_array || lower == "values" {
            units.extend(["unit", "units", "einheit"]);
        }
        let comment = if lower == "values" { texts(&["blockname"]).concat() } else { String::new() };
        let names = if member.is_whole() { texts(names) } else { Vec::new() };
        Self { names, units: texts(&units), comment }
    }
}

/// Returns true if a text describes others beside it, and is no loss where it is not taken over.
pub(super) fn describes(members: &Members, name: &str, has_one_array: bool) -> bool {
    let lower = name.to_lowercase();
    let has = |names: &[&str]| members.named(names).is_some();
    match lower.as_str() {
        "unit" | "units" | "einheit" => has_one_array || has(&["values"]),
        "label" | "blockname" | "title" | "plotstyle" | "dimensions" => has(&["values"]),
        "inputname" | "inputunit" | "uname" => has(&["u", "inputdata"]),
        "outputname" | "outputunit" | "yname" => has(&["y", "outputdata"]),
        "timeunit" | "time_unit" | "time_units" if members.list.iter().any(|m| clock_unit(&m.name).is_some()) => true,
        "timeunit" | "ts" | "tstart" => sample_time(members).is_some(),
        _ => ["_unit", "_units"].iter().any(|end| lower.strip_suffix(end).is_some_and(|stem| has(&[stem]))),
    }
}

/// First time stamp and step, s, of data with a sample time: a struct or file with `Ts` and `u` or `y`.
pub(super) fn sample_time(members: &Members) -> Option<(f64, f64)> {
    members.named(&["u", "y", "inputdata", "outputdata"])?;
    let unit = match members.named(&["timeunit"]) {
        None => (1.0, 1.0),
        Some(unit) => long_unit(unit.value.text()?)?,
    };
    let step = members.number("ts").filter(|ts| *ts > 0.0)?;
    let start = members.number("tstart").unwrap_or(0.0);
    Some((start * unit.0 / unit.1, step * unit.0 / unit.1))
}

/// Time from sample to sample, s, that a number in the scope states, and the number's name.
pub(super) fn stated_period(members: &Members) -> Option<(String, f64)> {
    let rates = ["fs", "f_s", "samplerate", "sample_rate"];
    let periods = ["ts", "t_s", "dt", "sampletime", "sample_time"];
    rates.into_iter().chain(periods).find_map(|name| {
        let number = members.number(name).filter(|n| *n > 0.0)?;
        let period_s = if rates.contains(&name) { 1.0 / number } else { number };
        Some((members.named(&[name])?.path.clone(), period_s))
    })
}
