//! From variables to clocks and channels.
//!
//! A scope is the file itself or one struct. A vector named like a clock is the clock of the arrays of its length in
//! its scope and in the structs inside.

use std::collections::BTreeMap;

use super::labels::{
    Factor, Labels, Member, Members, clock_unit, describes, is_plain_time, sample_time, stated_period, stated_unit,
};
use super::stored::{Numbers, Stored};
use super::value::{Array, Struct, Value, object_reason};
use crate::heading::time_word;
use crate::required::require_names;
use crate::{Channel, Finding, Format, Raster, Recording, RecordingError, Selection, SkipReason};

/// The most channels of a file.
pub(super) const MAX_CHANNELS: usize = 1 << 17;

/// For lengths, the clock that arrays of this length have: an index into the rasters, or why there is none.
type Clocks = BTreeMap<usize, Result<usize, SkipReason>>;

/// Clocks and channels under construction.
pub(super) struct Plan {
    row_distance_s: Option<f64>,
    pub(super) rasters: Vec<Raster>,
    /// The clocks of the scope that is read and of those around it, the outermost first.
    clocks: Vec<Clocks>,
    /// The rasters that are vectors of the file, with the paths of those.
    vectors: Vec<(usize, String)>,
    /// The rasters of rows so far apart, by length.
    counted: BTreeMap<usize, usize>,
    pub(super) channels: Vec<Channel>,
    /// For each channel where its samples are, if they are not read yet.
    pub(super) stored: Vec<Option<Stored>>,
    skipped: Vec<(String, SkipReason)>,
    /// Names that were not asked for.
    pub(super) unread: Vec<String>,
    pub(super) findings: Vec<Finding>,
}

impl Plan {
    pub(super) fn new(row_distance_s: Option<f64>) -> Self {
        Self {
            row_distance_s,
            rasters: Vec::new(),
            clocks: Vec::new(),
            vectors: Vec::new(),
            counted: BTreeMap::new(),
            channels: Vec::new(),
            stored: Vec::new(),
            skipped: Vec::new(),
            unread: Vec::new(),
            findings: Vec::new(),
        }
    }

    /// Takes over the variables of the file.
    pub(super) fn top(&mut self, variables: Vec<(String, Value)>) {
        self.scope("", variables);
    }

    fn scope(&mut self, path: &str, values: Vec<(String, Value)>) {
        let mut members = Vec::new();
        for (name, value) in values {
            flatten(joined(path, &name), &name, value, &mut members);
        }
        let mut members = Members::new(members);
        let (clocks, taken) = self.find_clocks(path, &mut members);
        self.clocks.push(clocks);
        let arrays = members.list.iter().zip(&taken).filter(|(m, taken)| !**taken && is_array(&m.value)).count();
        for index in (0..members.list.len()).filter(|&index| !taken[index]) {
            // One at a time: many arrays may share long lists of labels.
            let labels = Labels::find(&members, index, arrays == 1);
            let describes = describes(&members, &members.list[index].name, arrays == 1);
            let member = members.take(index);
            self.member(path, member, &labels, describes);
        }
        self.clocks.pop();
    }

    /// Takes over what a scope holds apart from its clocks; `describes` where it may say something about the others.
    fn member(&mut self, scope: &str, member: Member, labels: &Labels, describes: bool) {
        let Member { path, name, value } = member;
        match value {
            Value::Text(_) | Value::Cell(_) if describes => {}
            Value::Numbers(array) if describes && array.len() <= 2 => {}
            Value::Numbers(array) => {
                let base = if name == "values" { without_signals(scope) } else { scope };
                self.array(&path, base, labels, array);
            }
            Value::Struct(structs) => self.structs(&path, structs),
            Value::Unread => self.unread.push(path),
            // Cells of anything else have been taken apart.
            Value::Text(_) | Value::Cell(_) => self.skip(path, SkipReason::NotNumeric { kind: "text".into() }),
            Value::Skip(reason) => self.skip(path, reason),
            Value::Object(object) => self.skip(path, object_reason(&object.class)),
        }
    }

    fn structs(&mut self, name: &str, structs: Struct) {
        let count = structs.elements.len();
        for (index, values) in structs.elements.into_iter().enumerate() {
            let path = element(name, index, count);
            self.scope(&path, structs.fields.iter().cloned().zip(values).collect());
        }
    }

    /// The clocks that a scope brings along, and which of its members they are.
    fn find_clocks(&mut self, path: &str, members: &mut Members) -> (Clocks, Vec<bool>) {
        let stated = stated_period(members);
        let mut by_length: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, member) in members.list.iter().enumerate() {
            if let Some(samples) = clock_length(member).filter(|_| !is_belied(members, member, stated.as_ref())) {
                by_length.entry(samples).or_default().push(index);
            }
        }
        let mut taken = vec![false; members.list.len()];
        let mut clocks = Clocks::new();
        for (samples, mut found) in by_length {
            let is_plain = |&i: &usize| is_plain_time(&members.list[i].name);
            if found.iter().any(is_plain) {
                found.retain(is_plain);
            }
            match agreed(members, &found) {
                Ok(unit) => {
                    found.iter().for_each(|&i| taken[i] = true);
                    let Member { path: own, value, .. } = members.take(found[0]);
                    if let Value::Numbers(array) = value {
                        clocks.insert(samples, Ok(self.clock(path, own, array, unit, stated.as_ref())));
                    }
                }
                Err(reason) => {
                    clocks.insert(samples, Err(reason));
                }
            }
        }
        if let Some(start_and_step) = sample_time(members) {
            self.sampled(path, members, start_and_step, &mut clocks);
        }
        (clocks, taken)
    }

    /// The clock that a member is, in seconds. Without a unit, a period that is stated beside it may betray a smaller
    /// one.
    fn clock(
        &mut self,
        scope: &str,
        path: String,
        array: Array,
        unit: Option<Factor>,
        stated: Option<&(String, f64)>,
    ) -> usize {
        if array.is_rounded() {
            self.findings.push(Finding::RoundedIntegers { channel: path.clone() });
        }
        let mut factor = unit.unwrap_or((1.0, 1.0));
        if let Some((number, period_s)) = stated.filter(|_| unit.is_none()) {
            let smaller = unit_by_period(&array, *period_s).filter(|(_, per_second)| *per_second > 1.0);
            if let Some((unit, per_second)) = smaller {
                factor.1 = per_second;
                let (clock, unit, stated_by) = (path.clone(), unit.to_owned(), number.clone());
                self.findings.push(Finding::AssumedTimeUnit { clock, unit, stated_by });
            }
        }
        let mut time_s = array.values;
        time_s.iter_mut().for_each(|t| *t = *t * factor.0 / factor.1);
        let raster = self.raster(scope, time_s);
        self.vectors.push((raster, path));
        raster
    }

    /// A clock that the file lists; also of arrays of its length that are not listed.
    pub(super) fn listed_clock(&mut self, variable: &str, raster: Raster) -> usize {
        let samples = raster.time_s.len();
        self.rasters.push(raster);
        let index = self.rasters.len() - 1;
        if self.clocks.is_empty() {
            self.clocks.push(Clocks::new());
        }
        let candidates = format!("{variable} and others");
        let several = |clock: &mut Result<usize, SkipReason>| *clock = Err(SkipReason::AmbiguousTime { candidates });
        if samples > 1 {
            self.clocks[0].entry(samples).and_modify(several).or_insert(Ok(index));
        }
        index
    }

    fn raster(&mut self, path: &str, time_s: Vec<f64>) -> usize {
        self.rasters.push(Raster { time_s, name: (!path.is_empty()).then(|| path.to_owned()) });
        self.rasters.len() - 1
    }

    /// Clocks from a sample time for the lengths of inputs and outputs that have no time vector.
    fn sampled(&mut self, path: &str, members: &Members, (start_s, step_s): (f64, f64), clocks: &mut Clocks) {
        for member in &members.list {
            let Value::Numbers(array) = &member.value else { continue };
            let is_data = matches!(member.name.to_lowercase().as_str(), "u" | "y" | "inputdata" | "outputdata");
            let samples = if array.is_vector() { array.len() } else { array.rows };
            if is_data && samples > 0 && !clocks.contains_key(&samples) {
                let time_s = (0..samples).map(|i| start_s + i as f64 * step_s).collect();
                clocks.insert(samples, Ok(self.raster(path, time_s)));
            }
        }
    }

    /// The clock of arrays of this length.
    fn clock_of(&self, samples: usize) -> Option<&Result<usize, SkipReason>> {
        self.clocks.iter().rev().find_map(|clocks| clocks.get(&samples))
    }

    fn skip(&mut self, name: String, reason: SkipReason) {
        self.skipped.push((name, reason));
    }

    /// Takes over an array: a vector as one channel, a matrix as one for each column, or for each row where only the
    /// number of columns is that of a clock.
    fn array(&mut self, name: &str, base: &str, labels: &Labels, array: Array) {
        if array.len() == 0 {
            return self.skip(name.to_owned(), SkipReason::NotNumeric { kind: "nothing".into() });
        }
        if let ([number], None) = (array.values.as_slice(), self.clock_of(1)) {
            return self.skip(name.to_owned(), SkipReason::SingleNumber { number: number.to_string() });
        }
        let (raster, by_rows) = match self.raster_of(&array) {
            Ok(found) => found,
            Err(reason) => return self.skip(name.to_owned(), reason),
        };
        let width = array.len() / self.rasters[raster].time_s.len().max(1);
        if self.channels.len().saturating_add(width) > MAX_CHANNELS {
            let detail = format!("its {width} columns bring the file to more than {MAX_CHANNELS} channels");
            return self.skip(name.to_owned(), SkipReason::Unsupported { detail });
        }
        if array.is_rounded() {
            self.findings.push(Finding::RoundedIntegers { channel: name.to_owned() });
        }
        let (dataset, is_vector, width) = (array.dataset, array.is_vector(), array.rows);
        let parts = if by_rows { array.into_rows() } else { array.into_columns() };
        let names = channel_names(name, base, labels, parts.len(), by_rows);
        for (index, (samples, name)) in parts.into_iter().zip(names).enumerate() {
            let part = match (is_vector, by_rows) {
                (true, _) => Numbers::Vector,
                (_, true) => Numbers::Across { index, width },
                (_, false) => Numbers::Row(index),
            };
            self.stored.push(dataset.map(|dataset| Stored { dataset, part }));
            let (unit, comment) = (labels.unit(index), labels.comment.clone());
            self.channels.push(Channel { name, unit, comment, raster, samples });
        }
    }

    /// The raster of an array, and whether its rows are the channels.
    fn raster_of(&mut self, array: &Array) -> Result<(usize, bool), SkipReason> {
        let is_vector = array.is_vector();
        let samples = if is_vector { array.len() } else { array.rows };
        let down = self.clock_of(samples).map(|clock| (clock, false));
        let across = || self.clock_of(array.columns).filter(|_| !is_vector).map(|clock| (clock, true));
        match down.or_else(across) {
            Some((Ok(raster), by_rows)) => Ok((*raster, by_rows)),
            Some((Err(reason), _)) if self.row_distance_s.is_none() => Err(reason.clone()),
            _ => Ok((self.counted(samples).ok_or(SkipReason::NoTimeVector { samples })?, false)),
        }
    }

    /// The clock of rows that are a known time apart.
    fn counted(&mut self, samples: usize) -> Option<usize> {
        let distance_s = self.row_distance_s?;
        if let Some(raster) = self.counted.get(&samples) {
            return Some(*raster);
        }
        let raster = self.raster("", (0..samples).map(|row| row as f64 * distance_s).collect());
        self.counted.insert(samples, raster);
        Some(raster)
    }

    /// The recording of the selected channels, with the rasters in the order of their first channels, and where their
    /// samples are that are not read yet.
    pub(super) fn finish(
        mut self,
        file: &str,
        selection: &Selection,
        format: Format,
    ) -> Result<(Recording, Vec<Option<Stored>>), RecordingError> {
        let known = self.channels.iter().map(|c| c.name.as_str());
        let others = self.skipped.iter().map(|(name, _)| name.as_str()).chain(self.unread.iter().map(String::as_str));
        require_names(file, selection, known.chain(others))?;
        if let Some((name, reason)) = self.skipped.iter().find(|(name, _)| selection.insists_on(name)) {
            let (channel, reason) = (name.clone(), reason.clone());
            return Err(RecordingError::UnusableChannel { file: file.into(), channel, reason });
        }
        let taken = self.channels.iter().map(|c| selection.takes(&c.name));
        let stored = taken.zip(self.stored).filter_map(|(is_taken, stored)| is_taken.then_some(stored)).collect();
        self.channels.retain(|c| selection.takes(&c.name));
        let mut places = vec![None; self.rasters.len()];
        let mut rasters = Vec::new();
        for channel in &mut self.channels {
            let old = channel.raster;
            channel.raster = *places[old].get_or_insert_with(|| {
                let empty = Raster { time_s: Vec::new(), name: None };
                rasters.push(std::mem::replace(&mut self.rasters[old], empty));
                rasters.len() - 1
            });
        }
        let mut findings = self.findings;
        if *selection == Selection::All {
            let unused = self.vectors.into_iter().filter(|(raster, _)| places[*raster].is_none());
            let unused = unused
                .map(|(raster, name)| (name, SkipReason::UnusedTime { samples: self.rasters[raster].time_s.len() }));
            let skipped = self.skipped.into_iter().chain(unused);
            findings.extend(skipped.map(|(channel, reason)| Finding::SkippedChannel { channel, reason }));
        }
        let channels = self.channels;
        Ok((Recording { format, comment: None, start_time: None, rasters, channels, findings }, stored))
    }
}

/// The path of one of the structs in an array of them.
pub(super) fn element(path: &str, index: usize, count: usize) -> String {
    if count == 1 { path.to_owned() } else { format!("{path}({})", index + 1) }
}

pub(super) fn joined(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

/// The path of Simulink's structure with time that holds the signal at `path`.
fn without_signals(path: &str) -> &str {
    let name = path.rfind('.').map_or(0, |dot| dot + 1);
    if path[name..].starts_with("signals") { &path[..name.saturating_sub(1)] } else { path }
}

/// The values in cells one by one; a cell of texts stays whole.
fn flatten(path: String, name: &str, value: Value, members: &mut Vec<Member>) {
    match value {
        Value::Cell(items) if items.iter().any(|item| item.text().is_none()) => {
            for (index, item) in items.into_iter().enumerate() {
                flatten(format!("{path}{{{}}}", index + 1), name, item, members);
            }
        }
        value => members.push(Member { path, name: name.to_owned(), value }),
    }
}

fn is_array(value: &Value) -> bool {
    matches!(value, Value::Numbers(array) if array.len() > 1) || *value == Value::Unread
}

/// The length of a member that is a clock: a vector of numbers that do not decrease, named like time.
fn clock_length(member: &Member) -> Option<usize> {
    let Value::Numbers(array) = &member.value else { return None };
    let (first, last) = (array.values.first()?, array.values.last()?);
    let named = clock_unit(&member.name).is_some() && member.is_whole();
    let finite = first.is_finite() && last.is_finite();
    (named && array.is_vector() && finite && first < last && array.values.is_sorted()).then_some(array.values.len())
}

/// Returns true if a clock by name is none by its numbers. `t1` may be a temperature. It is one if its steps are not
/// the period stated beside it, in whatever unit.
fn is_belied(members: &Members, member: &Member, stated: Option<&(String, f64)>) -> bool {
    let (Value::Numbers(array), Some((_, period_s))) = (&member.value, stated) else { return false };
    let is_sure = is_plain_time(&member.name) || time_word(&member.name) != Some("t");
    !is_sure && stated_unit(members, member) == Ok(None) && unit_by_period(array, *period_s).is_none()
}

/// The unit, and how many of it are a second, in which the steps of a clock are such a period on average.
fn unit_by_period(clock: &Array, period_s: f64) -> Option<(&'static str, f64)> {
    let steps = clock.values.len().checked_sub(1)?;
    let step = (clock.values[steps] - clock.values[0]) / steps as f64;
    let fits = |per_second: f64| (step / per_second / period_s - 1.0).abs() < 1e-3;
    [("s", 1.0), ("ms", 1e3), ("us", 1e6), ("ns", 1e9)].into_iter().find(|(_, per_second)| fits(*per_second))
}

/// The unit that the vectors named as time, at least one, agree on, if they agree on their numbers too.
fn agreed(members: &Members, found: &[usize]) -> Result<Option<Factor>, SkipReason> {
    let named: Vec<&Member> = found.iter().map(|&i| &members.list[i]).collect();
    let units = named.iter().map(|member| stated_unit(members, member)).collect::<Result<Vec<_>, _>>()?;
    let mut stated = units.into_iter().flatten();
    let unit = stated.next();
    match &named[0].value {
        Value::Numbers(_) if named.iter().all(|m| m.value == named[0].value) && stated.all(|u| Some(u) == unit) => {
            Ok(unit)
        }
        _ => {
            let candidates = named.iter().take(3).map(|m| m.path.as_str()).collect::<Vec<_>>().join(", ");
            Err(SkipReason::AmbiguousTime { candidates })
        }
    }
}

/// Names for `count` channels of the array `name`.
fn channel_names(name: &str, base: &str, labels: &Labels, count: usize, by_rows: bool) -> Vec<String> {
    let all_named = |labels: &Labels| labels.names.iter().all(|n| !n.is_empty());
    if labels.names.len() == count && all_named(labels) {
        return labels.names.iter().map(|label| joined(base, label)).collect();
    }
    let name = match labels.names.as_slice() {
        [label] if !label.is_empty() => joined(base, label),
        _ => name.to_owned(),
    };
    match (count, by_rows) {
        (1, _) => vec![name],
        (_, true) => (1..=count).map(|row| format!("{name}({row},:)")).collect(),
        (_, false) => (1..=count).map(|column| format!("{name}(:,{column})")).collect(),
    }
}
