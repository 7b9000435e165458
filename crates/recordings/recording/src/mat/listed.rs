//! The variable in which [`super::write`] lists what a MAT-file has no place for: names that are not valid in MATLAB,
//! units, comments, and which clock a channel has.

use std::collections::{HashMap, HashSet};

use super::scope::Plan;
use super::stored::{Numbers, Stored};
use super::value::{Array, Struct, Value};
use crate::{Channel, Finding, Raster, RecordingError, Selection, StartTime};

/// Its name.
pub(super) const NAME: &str = "recording_info";

/// Takes the variables that the list names out of `variables`, and the list too. Returns comment and start time.
pub(super) fn take(
    file: &str,
    variables: &mut Vec<(String, Value)>,
    plan: &mut Plan,
    selection: &Selection,
) -> Result<(Option<String>, Option<StartTime>), RecordingError> {
    let place = variables.iter().position(|(name, value)| name == NAME && List::read(value).is_some());
    let Some(place) = place else { return Ok((None, None)) };
    let (_, info) = variables.remove(place);
    let Some(list) = List::read(&info) else { return Ok((None, None)) };
    let mut pool: HashMap<String, Array> = HashMap::new();
    let named: HashSet<&str> = list.rasters.iter().map(|r| r.0).chain(list.channels.iter().map(|c| c[0])).collect();
    variables.retain_mut(|(name, value)| match value {
        Value::Numbers(array) if named.contains(name.as_str()) && !pool.contains_key(name) => {
            let empty = Array { rows: 0, columns: 0, values: Vec::new(), is_wide: false, dataset: None };
            pool.insert(name.clone(), std::mem::replace(array, empty));
            false
        }
        Value::Unread => !named.contains(name.as_str()),
        _ => true,
    });
    list.place(file, pool, plan, selection)?;
    Ok((list.comment, list.start_time))
}

/// The variables of the selected channels, and of all, if this is the list.
pub(super) fn variables(value: &Value, selection: &Selection) -> Option<(HashSet<String>, HashSet<String>)> {
    let list = List::read(value)?;
    let selected = list.channels.iter().filter(|channel| selection.takes(channel[1]));
    let wanted = selected.map(|channel| channel[0].to_owned()).collect();
    Some((wanted, list.channels.iter().map(|channel| channel[0].to_owned()).collect()))
}

/// The list: texts of the file.
struct List<'a> {
    comment: Option<String>,
    start_time: Option<StartTime>,
    /// Variable and name.
    rasters: Vec<(&'a str, &'a str)>,
    /// Variable, name, unit, comment, variable of the clock.
    channels: Vec<[&'a str; 5]>,
}

impl<'a> List<'a> {
    fn read(value: &'a Value) -> Option<Self> {
        let Value::Struct(info) = value else { return None };
        let (Value::Struct(rasters), Value::Struct(channels)) = (info.get(0, "rasters")?, info.get(0, "channels")?)
        else {
            return None;
        };
        let raster = |i| Some((text(rasters, i, "variable")?, text(rasters, i, "name")?));
        let channel = |i| {
            let field = |name| text(channels, i, name);
            Some([field("variable")?, field("name")?, field("unit")?, field("comment")?, field("time")?])
        };
        let comment = text(info, 0, "comment").filter(|comment| !comment.is_empty());
        Some(Self {
            comment: comment.map(str::to_owned),
            start_time: text(info, 0, "start_time").and_then(start_time),
            rasters: (0..rasters.elements.len()).map(raster).collect::<Option<_>>()?,
            channels: (0..channels.elements.len()).map(channel).collect::<Option<_>>()?,
        })
    }

    /// Hands the listed clocks and channels over to the plan.
    fn place(
        &self,
        file: &str,
        mut pool: HashMap<String, Array>,
        plan: &mut Plan,
        selection: &Selection,
    ) -> Result<(), RecordingError> {
        let mut rasters = HashMap::new();
        for (variable, name) in &self.rasters {
            let Some(array) = pool.remove(*variable) else {
                plan.findings.push(Finding::MissingVariable { variable: (*variable).to_owned() });
                continue;
            };
            let raster = Raster { time_s: array.values, name: (!name.is_empty()).then(|| (*name).to_owned()) };
            rasters.insert(*variable, plan.listed_clock(variable, raster));
        }
        for [variable, name, unit, comment, clock] in &self.channels {
            if !selection.takes(name) {
                plan.unread.push((*name).to_owned());
                continue;
            }
            let (Some(array), Some(&raster)) = (pool.remove(*variable), rasters.get(clock)) else {
                plan.findings.push(Finding::MissingVariable { variable: (*variable).to_owned() });
                continue;
            };
            let (samples, times) = (array.len(), plan.rasters[raster].time_s.len());
            if samples != times {
                let detail = format!("it has {samples} samples, its clock {times}");
                return Err(RecordingError::DamagedChannel { file: file.into(), channel: (*name).to_owned(), detail });
            }
            let [name, unit, comment] = [name, unit, comment].map(|text| (*text).to_owned());
            plan.stored.push(array.dataset.map(|dataset| Stored { dataset, part: Numbers::Vector }));
            plan.channels.push(Channel { name, unit, comment, raster, samples: array.values });
        }
        Ok(())
    }
}

/// Text of one row, as it is stored.
fn text<'a>(structs: &'a Struct, index: usize, field: &str) -> Option<&'a str> {
    match structs.get(index, field)? {
        Value::Text(rows) => rows.first().map(String::as_str),
        _ => None,
    }
}

/// `NANOSECONDS utc|local [MINUTES]`, as [`start_text`] writes it.
pub(crate) fn start_time(text: &str) -> Option<StartTime> {
    let mut words = text.split(' ');
    let nanoseconds = words.next()?.parse().ok()?;
    let is_local = words.next()? == "local";
    Some(StartTime { nanoseconds, is_local, utc_offset_min: words.next().and_then(|minutes| minutes.parse().ok()) })
}

/// Nanoseconds since 1970, on which clock, and how many minutes that is ahead of UTC where known.
pub(crate) fn start_text(start: Option<StartTime>) -> String {
    let Some(start) = start else { return String::new() };
    let clock = if start.is_local { "local" } else { "utc" };
    let offset = start.utc_offset_min.map(|minutes| format!(" {minutes}")).unwrap_or_default();
    format!("{} {clock}{offset}", start.nanoseconds)
}
