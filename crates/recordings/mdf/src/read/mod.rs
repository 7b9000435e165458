//! Reading samples.

mod column;
mod cursor;
mod fixed;
mod mixed;
mod part;
mod shape;
mod varying;

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError};

use work::Context;

use crate::conversion::{Conversion, Yields};
use crate::error::damaged;
use crate::field::is_integer;
use crate::model::{Channel, Place, Storage};
use crate::values::{Blobs, Texts, Values};
use crate::{Address, Mdf, MdfError, Numbers, Source};
use column::{Column, Take, Task, columns};
use fixed::Job;
use mixed::{Framing, Member};
pub(crate) use shape::{Progress, Shape};
use varying::Collector;

/// A channel to be read, and the columns that its samples are made of.
struct Wanted<'a> {
    /// Its place in the answer.
    answer: usize,
    channel: &'a Channel,
    raw: bool,
    /// True if integers were met that are not exact as numbers.
    rounds: Arc<AtomicBool>,
}

impl Wanted<'_> {
    /// Conversion of numbers as they are read; none where they stay as they are.
    fn early(&self) -> Option<Arc<Conversion>> {
        let conversion = &self.channel.conversion;
        let is_early = !self.raw && conversion.of_numbers() == Yields::Numbers;
        (is_early && !matches!(**conversion, Conversion::Identity)).then(|| conversion.clone())
    }

    fn tasks(&self) -> Vec<Task> {
        let invalid_bit = self.channel.invalid_bit;
        let plain = |take| Task { take, conversion: None, invalid_bit, rounds: None };
        match &self.channel.storage {
            Storage::Number(field) => {
                let rounds = (is_integer(field) && field.bits > 53).then(|| self.rounds.clone());
                vec![Task { conversion: self.early(), rounds, ..plain(Take::Number(*field)) }]
            }
            Storage::Index => vec![Task { conversion: self.early(), ..plain(Take::Index) }],
            Storage::Bytes { byte, width, .. } => vec![plain(Take::Bytes { byte: *byte, width: *width })],
            Storage::Sized { byte, width, size, .. } => {
                vec![plain(Take::Bytes { byte: *byte, width: *width }), plain(Take::Number(*size))]
            }
            Storage::Elsewhere { place, .. } => vec![plain(Take::Number(*place))],
            Storage::None => vec![],
        }
    }
}

impl<S: Source> Mdf<S> {
    /// Reads the samples of channels, conversion applied, one answer for each address.
    ///
    /// Only the data of their groups are read, each stream once, whatever the order of addresses. `context` is the
    /// step of reading; its parts are bytes of samples.
    ///
    /// # Errors
    ///
    /// [`MdfError`] where a channel is not there or cannot be read, and where its data are damaged.
    ///
    /// # Example
    ///
    /// ```no_run
    /// let file = mdf::Mdf::open(std::fs::File::open("run.mf4")?)?;
    /// let first = mdf::Address { group: 0, channel: 1 };
    /// let samples = file.read(&[first], &work::Context::new())?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(&self, addresses: &[Address], context: &Context) -> Result<Vec<Values>, MdfError> {
        self.read_as(addresses, false, context).map(|(values, _)| values)
    }

    /// Reads as [`Mdf::read`] does, of channels that hold numbers. A channel without numbers gives none.
    ///
    /// # Errors
    ///
    /// As [`Mdf::read`].
    pub fn numbers(&self, addresses: &[Address], context: &Context) -> Result<Numbers, MdfError> {
        let (values, rounded) = self.read_as(addresses, false, context)?;
        let numbers = |values| match values {
            Values::Numbers(numbers) => numbers,
            _ => Vec::new(),
        };
        Ok(Numbers { columns: values.into_iter().map(numbers).collect(), rounded })
    }

    /// Reads as [`Mdf::read`] does, without applying conversions: the numbers and texts as they are stored.
    ///
    /// # Errors
    ///
    /// As [`Mdf::read`].
    pub fn read_raw(&self, addresses: &[Address], context: &Context) -> Result<Vec<Values>, MdfError> {
        self.read_as(addresses, true, context).map(|(values, _)| values)
    }

    /// The values of channels, and the channels whose integers were rounded.
    fn read_as(
        &self,
        addresses: &[Address],
        raw: bool,
        context: &Context,
    ) -> Result<(Vec<Values>, Vec<Address>), MdfError> {
        // Data group, group, channels.
        let mut wanted: BTreeMap<usize, BTreeMap<usize, Vec<Wanted<'_>>>> = BTreeMap::new();
        for (answer, address) in addresses.iter().enumerate() {
            let channel = self.channel(*address)?;
            if let Some(obstacle) = &channel.obstacle {
                return Err(MdfError::Unreadable { name: channel.name.to_string(), obstacle: obstacle.clone() });
            }
            let data = self.parts.groups[address.group].records.data;
            let groups = wanted.entry(data).or_default();
            groups.entry(address.group).or_default().push(Wanted { answer, channel, raw, rounds: Arc::default() });
        }
        let total = wanted.keys().map(|&data| self.parts.data[data].stream.length).sum();
        let mut progress = Progress { context, before: 0, total };
        let mut answers: Vec<Option<Values>> = vec![None; addresses.len()];
        let mut all_rounded = Vec::new();
        for (data, groups) in wanted {
            for (answer, values) in self.read_data(data, &groups, &progress)? {
                answers[answer] = Some(values);
            }
            let rounded = groups.values().flatten().filter(|wanted| wanted.rounds.load(Ordering::Relaxed));
            all_rounded.extend(rounded.map(|wanted| addresses[wanted.answer]));
            progress.before += self.parts.data[data].stream.length;
        }
        self.rounded.lock().unwrap_or_else(PoisonError::into_inner).extend(&all_rounded);
        Ok((answers.into_iter().flatten().collect(), all_rounded))
    }

    fn channel(&self, address: Address) -> Result<&Channel, MdfError> {
        let channel = self.parts.groups.get(address.group).and_then(|g| g.channels.get(address.channel));
        channel.ok_or(MdfError::NoSuchChannel { group: address.group, channel: address.channel })
    }

    fn read_data(
        &self,
        data: usize,
        groups: &BTreeMap<usize, Vec<Wanted<'_>>>,
        progress: &Progress<'_>,
    ) -> Result<Vec<(usize, Values)>, MdfError> {
        let mut answers = Vec::new();
        if !self.parts.data[data].is_mixed {
            for (&group, wanted) in groups {
                let tasks: Vec<Task> = wanted.iter().flat_map(Wanted::tasks).collect();
                let rows = self.parts.groups[group].found.unwrap_or(0);
                let shape = self.shape(group);
                let job = Job { source: &self.source, shape, tasks: &tasks, progress, each: None };
                let columns = job.read(0..rows)?;
                answers.extend(self.finish(wanted, columns, &[])?);
            }
            return Ok(answers);
        }
        let mut members = self.members(data, Some(groups));
        let framing = self.framing(data);
        let mut passed = |place, _: &mut [Member]| progress.report(place);
        mixed::read(&self.source, &self.parts.data[data].stream, framing, &mut members, None, &mut passed)?;
        for (&group, wanted) in groups {
            let place = self.parts.data[data].groups.iter().position(|&g| g == group).unwrap_or(0);
            let columns = std::mem::take(&mut members[place].columns);
            answers.extend(self.finish(wanted, columns, &members)?);
        }
        Ok(answers)
    }

    fn shape(&self, group: usize) -> Shape<'_> {
        let records = &self.parts.groups[group].records;
        let data = &self.parts.data[records.data];
        Shape {
            stream: &data.stream,
            invalid: data.invalid.as_ref(),
            id: records.id,
            id_bytes: data.id_bytes,
            trailing: data.trailing,
            data_bytes: records.data_bytes,
            invalid_bytes: records.invalid_bytes,
        }
    }

    fn framing(&self, data: usize) -> Framing {
        let data = &self.parts.data[data];
        Framing { id_bytes: data.id_bytes, trailing: data.trailing, stops: self.parts.is_open }
    }

    /// All groups of a stream, with the work to be done on them.
    fn members(&self, data: usize, wanted: Option<&BTreeMap<usize, Vec<Wanted<'_>>>>) -> Vec<Member> {
        let wanted_of = |group: &usize| wanted.and_then(|w| w.get(group)).map(Vec::as_slice).unwrap_or_default();
        let kept: Vec<u64> = wanted.iter().flat_map(|w| w.values().flatten()).filter_map(values_id).collect();
        let member = |group: &usize| {
            let records = &self.parts.groups[*group].records;
            let tasks: Vec<Task> = wanted_of(group).iter().flat_map(Wanted::tasks).collect();
            // Columns of no rows always fit.
            let columns = columns(&tasks, 0).unwrap_or_default();
            Member {
                id: records.id,
                data_bytes: records.data_bytes,
                record_bytes: records.record_bytes(),
                is_varying: records.is_varying,
                keep_values: kept.contains(&records.id),
                tasks,
                columns,
                ..Member::default()
            }
        };
        self.parts.data[data].groups.iter().map(member).collect()
    }

    /// Counts the records of a group by reading them, where [`crate::Group::found`] does not state their number.
    ///
    /// # Errors
    ///
    /// [`MdfError`] where there is no such group, and where its data are damaged.
    pub fn count(&self, group: usize) -> Result<u64, MdfError> {
        let missing = MdfError::NoSuchChannel { group, channel: 0 };
        let info = self.parts.groups.get(group).ok_or(missing)?;
        if let Some(found) = info.found {
            return Ok(found);
        }
        let data = info.records.data;
        let index = self.index(data, &Context::new())?;
        let place = self.parts.data[data].groups.iter().position(|&g| g == group);
        Ok(place.and_then(|p| index.counts.get(p)).copied().unwrap_or(0))
    }

    fn finish(
        &self,
        wanted: &[Wanted<'_>],
        columns: Vec<Column>,
        members: &[Member],
    ) -> Result<Vec<(usize, Values)>, MdfError> {
        let mut columns = columns.into_iter();
        let mut answers = Vec::with_capacity(wanted.len());
        for wanted in wanted {
            let values = self.values(wanted, &mut columns, members)?;
            answers.push((wanted.answer, wanted.converted(values)));
        }
        Ok(answers)
    }

    /// The raw values of a channel from its columns.
    fn values(
        &self,
        wanted: &Wanted<'_>,
        columns: &mut impl Iterator<Item = Column>,
        members: &[Member],
    ) -> Result<Values, MdfError> {
        let numbers = |column: Option<Column>| match column {
            Some(Column::Numbers(numbers)) => numbers,
            _ => Vec::new(),
        };
        let first = columns.next();
        match (&wanted.channel.storage, first) {
            (Storage::Elsewhere { values, encoding, .. }, first) => {
                let places = numbers(first);
                match values {
                    Place::Stream(stream) => {
                        varying::gather(&self.source, &self.parts.signals[*stream], &places, *encoding)
                    }
                    Place::Records(id) => match members.iter().find(|m| m.id == *id) {
                        Some(member) => member.values.gather(&places, *encoding),
                        None => Err(damaged(0, "values of varying length are missing")),
                    },
                }
            }
            (Storage::Bytes { encoding, .. }, Some(Column::Bytes { width, bytes })) => {
                Ok(texts(*encoding, width, &bytes, None))
            }
            (Storage::Sized { encoding, .. }, Some(Column::Bytes { width, bytes })) => {
                let sizes = numbers(columns.next());
                Ok(texts(*encoding, width, &bytes, Some(&sizes)))
            }
            (_, first) => Ok(Values::Numbers(numbers(first))),
        }
    }
}

/// The identifier of the records that hold a channel's values.
fn values_id(wanted: &Wanted<'_>) -> Option<u64> {
    match &wanted.channel.storage {
        Storage::Elsewhere { values: Place::Records(id), .. } => Some(*id),
        _ => None,
    }
}

fn texts(encoding: Option<crate::model::Encoding>, width: usize, bytes: &[u8], sizes: Option<&[f64]>) -> Values {
    let mut out = Collector::new(encoding);
    let rows = bytes.len() / width.max(1);
    for (row, cell) in bytes.chunks_exact(width.max(1)).enumerate() {
        let size = sizes.and_then(|s| s.get(row)).map_or(width, |&s| (s as usize).min(width));
        out.put(row, &cell[..size]);
    }
    out.finish(rows)
}

impl Wanted<'_> {
    /// The conversions that are not applied to numbers as they are read.
    fn converted(&self, values: Values) -> Values {
        let conversion = &*self.channel.conversion;
        let values = if self.channel.all_invalid { invalid(values) } else { values };
        match values {
            _ if self.raw => values,
            Values::Numbers(numbers) if conversion.of_numbers() == Yields::Text => {
                let text = |bits: &u64| match f64::from_bits(*bits) {
                    x if x.is_nan() => String::new(),
                    x => conversion.text_of_number(x),
                };
                Values::Text(Texts::translated(numbers.iter().map(|n| n.to_bits()), text))
            }
            Values::Text(texts) if conversion.of_text() == Yields::Numbers => {
                Values::Numbers(texts.iter().map(|t| conversion.number_of_text(t)).collect())
            }
            Values::Text(texts) if matches!(conversion, Conversion::TextToText { .. }) => {
                Values::Text(Texts::translated(texts.iter(), |t| conversion.text_of_text((*t).to_owned())))
            }
            other => other,
        }
    }
}

/// As many samples, all of them invalid.
fn invalid(values: Values) -> Values {
    let none = |rows: usize| {
        let mut blobs = Blobs::default();
        blobs.extend_to(rows);
        blobs
    };
    match values {
        Values::Numbers(mut numbers) => {
            numbers.fill(f64::NAN);
            Values::Numbers(numbers)
        }
        Values::Text(texts) => Values::Text(none(texts.len()).into_texts()),
        Values::Bytes(blobs) => Values::Bytes(none(blobs.len())),
    }
}
