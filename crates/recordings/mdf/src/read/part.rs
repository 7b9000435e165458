//! Parts of channels that hold numbers: some of their records, or all of them without keeping any.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::Ordering;

use work::Context;

use super::column::{Column, Task};
use super::fixed::{Each, Job};
use super::mixed::{self, Member};
use super::{Progress, Wanted};
use crate::conversion::Yields;
use crate::model::{Channel, Place, Storage};
use crate::parts::{Index, Mark};
use crate::stream::Packing;
use crate::values::Values;
use crate::{Address, Mdf, MdfError, Numbers, Source};

/// Bytes of records that are read at once anyway.
const GRAIN: u64 = 1 << 18;

/// Group, channels, for each data group.
type ByData<'a> = BTreeMap<usize, BTreeMap<usize, Vec<Wanted<'a>>>>;

impl<S: Source> Mdf<S> {
    /// Reads the numbers of some records of channels, conversion applied. `rows` gives the records of a group.
    ///
    /// Of groups that have their data for themselves only these records are read, and compressed blocks whole. Where
    /// records of several groups are mixed, the first call goes through all of them once and takes down where they are.
    /// Texts that become numbers are read whole. A channel without numbers gives none.
    ///
    /// # Errors
    ///
    /// As [`Mdf::read`].
    pub fn read_rows(
        &self,
        addresses: &[Address],
        rows: &dyn Fn(usize) -> Range<u64>,
        context: &Context,
    ) -> Result<Numbers, MdfError> {
        let mut numbers = Numbers { columns: vec![Vec::new(); addresses.len()], rounded: Vec::new() };
        let (plain, others) = self.by_data(addresses)?;
        for &answer in &others {
            let address = addresses[answer];
            numbers.columns[answer] = part(self.whole(address, context)?, rows(address.group));
        }
        let mut progress = Progress { context, before: 0, total: self.bytes_of(&plain, rows) };
        for (&data, groups) in &plain {
            for (answer, column) in self.rows_of(data, groups, rows, &progress)? {
                numbers.columns[answer] = column;
            }
            let rounded = groups.values().flatten().filter(|wanted| wanted.rounds.load(Ordering::Relaxed));
            numbers.rounded.extend(rounded.map(|wanted| addresses[wanted.answer]));
            progress.before += groups.keys().map(|&group| self.bytes_in(group, &rows(group))).sum::<u64>();
        }
        Ok(numbers)
    }

    /// Goes through all numbers of channels once, without keeping them: `each` gets the place of a channel among
    /// `addresses`, the number of a record, and the numbers from it on. Any thread calls it, in any order.
    ///
    /// # Errors
    ///
    /// As [`Mdf::read`].
    pub fn visit(
        &self,
        addresses: &[Address],
        context: &Context,
        each: &(dyn Fn(usize, u64, &[f64]) + Sync),
    ) -> Result<(), MdfError> {
        let (plain, others) = self.by_data(addresses)?;
        for &answer in &others {
            each(answer, 0, &self.whole(addresses[answer], context)?);
        }
        let total = plain.keys().map(|&data| self.parts.data[data].stream.length).sum();
        let mut progress = Progress { context, before: 0, total };
        for (&data, groups) in &plain {
            match self.parts.data[data].is_mixed {
                false => self.visit_alone(groups, &progress, each)?,
                true => self.visit_mixed(data, groups, &progress, each)?,
            }
            progress.before += self.parts.data[data].stream.length;
        }
        Ok(())
    }

    /// Records of a group that are best read at once: where they are compressed, those of a block.
    #[must_use]
    pub fn grain(&self, group: usize) -> u64 {
        let Some(info) = self.parts.groups.get(group) else { return 1 };
        let data = &self.parts.data[info.records.data];
        let stride = self.shape(group).stride().max(1) as u64;
        let packed = data.stream.fragments.iter().filter(|fragment| fragment.packing != Packing::Plain);
        let largest = packed.map(|fragment| fragment.length).max().unwrap_or(0);
        (largest.max(GRAIN) / stride).max(1)
    }

    /// Where the records of mixed groups are: goes through them the first time.
    pub(super) fn index(&self, data: usize, context: &Context) -> Result<&Index, MdfError> {
        let index = self.parts.data[data].index.get_or_init(|| {
            let stream = &self.parts.data[data].stream;
            let mut members = self.members(data, None);
            let mut marks = vec![Mark { place: 0, rows: vec![0; members.len()] }];
            let mut passed = |place, members: &mut [Member]| {
                context.reach(place, stream.length);
                marks.push(Mark { place, rows: members.iter().map(|member| member.rows).collect() });
            };
            mixed::read(&self.source, stream, self.framing(data), &mut members, None, &mut passed)?;
            Ok(Index { counts: members.iter().map(|member| member.rows).collect(), marks })
        });
        index.as_ref().map_err(Clone::clone)
    }

    /// The channels whose numbers are in the records, by their place, and the places of the others.
    fn by_data(&self, addresses: &[Address]) -> Result<(ByData<'_>, Vec<usize>), MdfError> {
        let (mut plain, mut others) = (ByData::new(), Vec::new());
        for (answer, address) in addresses.iter().enumerate() {
            let channel = self.channel(*address)?;
            if let Some(obstacle) = &channel.obstacle {
                return Err(MdfError::Unreadable { name: channel.name.to_string(), obstacle: obstacle.clone() });
            }
            if !is_plain(channel) {
                others.push(answer);
                continue;
            }
            let wanted = Wanted { answer, channel, raw: false, rounds: Default::default() };
            let groups = plain.entry(self.parts.groups[address.group].records.data).or_default();
            groups.entry(address.group).or_default().push(wanted);
        }
        Ok((plain, others))
    }

    /// All numbers of a channel.
    fn whole(&self, address: Address, context: &Context) -> Result<Vec<f64>, MdfError> {
        match self.read(&[address], context)?.pop() {
            Some(Values::Numbers(numbers)) => Ok(numbers),
            _ => Ok(Vec::new()),
        }
    }

    fn rows_of(
        &self,
        data: usize,
        groups: &BTreeMap<usize, Vec<Wanted<'_>>>,
        rows: &dyn Fn(usize) -> Range<u64>,
        progress: &Progress<'_>,
    ) -> Result<Vec<(usize, Vec<f64>)>, MdfError> {
        if self.parts.data[data].is_mixed {
            return self.mixed_rows(data, groups, rows, progress);
        }
        let mut answers = Vec::new();
        for (&group, wanted) in groups {
            let tasks: Vec<Task> = wanted.iter().flat_map(Wanted::tasks).collect();
            let job = Job { source: &self.source, shape: self.shape(group), tasks: &tasks, progress, each: None };
            let columns = job.read(within(rows(group), self.parts.groups[group].found.unwrap_or(0)))?;
            answers.extend(numbers(wanted, columns));
        }
        Ok(answers)
    }

    fn mixed_rows(
        &self,
        data: usize,
        groups: &BTreeMap<usize, Vec<Wanted<'_>>>,
        rows: &dyn Fn(usize) -> Range<u64>,
        progress: &Progress<'_>,
    ) -> Result<Vec<(usize, Vec<f64>)>, MdfError> {
        let index = self.index(data, progress.context)?;
        let mut members = self.members(data, Some(groups));
        for ((member, group), count) in members.iter_mut().zip(&self.parts.data[data].groups).zip(&index.counts) {
            member.kept = Some(within(rows(*group), *count));
        }
        let mark = mixed::before(index, &members);
        let begin = mark.map_or(0, |mark| mark.place);
        let mut passed = |place: u64, _: &mut [Member]| progress.report(place.saturating_sub(begin));
        if mark.is_some() && members.iter().any(|member| member.first().is_some()) {
            let stream = &self.parts.data[data].stream;
            mixed::read(&self.source, stream, self.framing(data), &mut members, mark, &mut passed)?;
        }
        let mut answers = Vec::new();
        for (member, group) in members.into_iter().zip(&self.parts.data[data].groups) {
            if let Some(wanted) = groups.get(group) {
                answers.extend(numbers(wanted, member.columns));
            }
        }
        Ok(answers)
    }

    fn visit_alone(
        &self,
        groups: &BTreeMap<usize, Vec<Wanted<'_>>>,
        progress: &Progress<'_>,
        each: Each<'_>,
    ) -> Result<(), MdfError> {
        for (&group, wanted) in groups {
            let tasks: Vec<Task> = wanted.iter().flat_map(Wanted::tasks).collect();
            let take = |task: usize, first: u64, numbers: &[f64]| hand_on(&wanted[task], first, numbers, each);
            let (shape, each) = (self.shape(group), Some(&take as Each<'_>));
            let job = Job { source: &self.source, shape, tasks: &tasks, progress, each };
            job.visit(0..self.parts.groups[group].found.unwrap_or(0))?;
        }
        Ok(())
    }

    fn visit_mixed(
        &self,
        data: usize,
        groups: &BTreeMap<usize, Vec<Wanted<'_>>>,
        progress: &Progress<'_>,
        each: Each<'_>,
    ) -> Result<(), MdfError> {
        let mut members = self.members(data, Some(groups));
        let of_members: Vec<_> = self.parts.data[data].groups.iter().map(|group| groups.get(group)).collect();
        let mut passed = |place, members: &mut [Member]| {
            progress.report(place);
            for (member, wanted) in members.iter_mut().zip(&of_members) {
                drain(member, wanted.map(Vec::as_slice).unwrap_or_default(), each);
            }
        };
        let stream = &self.parts.data[data].stream;
        mixed::read(&self.source, stream, self.framing(data), &mut members, None, &mut passed)
    }

    /// Bytes of the records that are wanted.
    fn bytes_of(&self, plain: &ByData<'_>, rows: &dyn Fn(usize) -> Range<u64>) -> u64 {
        plain.values().flat_map(BTreeMap::keys).map(|&group| self.bytes_in(group, &rows(group))).sum()
    }

    fn bytes_in(&self, group: usize, rows: &Range<u64>) -> u64 {
        let count = rows.end.min(self.parts.groups[group].at_most).saturating_sub(rows.start);
        count.saturating_mul(self.shape(group).stride() as u64)
    }
}

/// Hands on what a member of a stream has gathered.
fn drain(member: &mut Member, wanted: &[Wanted<'_>], each: Each<'_>) {
    let gathered = (member.gathered.len() / member.record_bytes.max(1)) as u64;
    for (wanted, column) in wanted.iter().zip(&mut member.columns) {
        if let Column::Numbers(numbers) = column
            && !numbers.is_empty()
        {
            hand_on(wanted, member.next - gathered - numbers.len() as u64, numbers, each);
        }
        column.clear();
    }
}

fn hand_on(wanted: &Wanted<'_>, first: u64, numbers: &[f64], each: Each<'_>) {
    match wanted.channel.all_invalid {
        true => each(wanted.answer, first, &vec![f64::NAN; numbers.len()]),
        false => each(wanted.answer, first, numbers),
    }
}

/// Tells whether the numbers of a channel are in its records, and stay numbers.
fn is_plain(channel: &Channel) -> bool {
    match &channel.storage {
        Storage::Number(_) | Storage::Index => channel.conversion.of_numbers() == Yields::Numbers,
        Storage::Elsewhere { values: Place::Stream(_) | Place::Records(_), .. } => false,
        Storage::Bytes { .. } | Storage::Sized { .. } | Storage::None => false,
    }
}

/// The numbers of channels that have one column each.
fn numbers<'w>(wanted: &'w [Wanted<'_>], columns: Vec<Column>) -> impl Iterator<Item = (usize, Vec<f64>)> + use<'w> {
    wanted.iter().zip(columns).map(|(wanted, column)| {
        let Column::Numbers(mut numbers) = column else { return (wanted.answer, Vec::new()) };
        if wanted.channel.all_invalid {
            numbers.fill(f64::NAN);
        }
        (wanted.answer, numbers)
    })
}

fn within(rows: Range<u64>, count: u64) -> Range<u64> {
    let end = rows.end.min(count);
    rows.start.min(end)..end
}

fn part(numbers: Vec<f64>, rows: Range<u64>) -> Vec<f64> {
    let rows = within(rows, numbers.len() as u64);
    numbers[rows.start as usize..rows.end as usize].to_vec()
}
