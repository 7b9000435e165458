//! Streams with records of several groups, each with the identifier of its group: read in one pass.

use std::collections::HashMap;
use std::ops::Range;

use super::column::{Block, Column, Invalid, Task};
use super::cursor::Cursor;
use super::varying::Varying;
use crate::bytes::u32_at;
use crate::error::damaged;
use crate::parts::{Index, Mark};
use crate::stream::{Stream, View};
use crate::{MdfError, Source};

/// Bytes of records gathered before they are decoded.
const GATHERED: usize = 1 << 17;

/// A group in a stream, and what is gathered of it.
#[derive(Debug, Default)]
pub(crate) struct Member {
    pub id: u64,
    pub data_bytes: usize,
    pub record_bytes: usize,
    pub is_varying: bool,
    /// Its values of varying length are wanted.
    pub keep_values: bool,
    pub tasks: Vec<Task>,
    pub columns: Vec<Column>,
    /// Records that were passed.
    pub rows: u64,
    /// Records that are wanted; all of them where it is none.
    pub kept: Option<Range<u64>>,
    /// Number of the record after the last that was gathered.
    pub next: u64,
    pub values: Varying,
    pub gathered: Vec<u8>,
}

/// The last mark before which none of the wanted records is.
pub(crate) fn before<'i>(index: &'i Index, members: &[Member]) -> Option<&'i Mark> {
    let wanted: Vec<(usize, u64)> = members.iter().enumerate().filter_map(|(i, m)| Some((i, m.first()?))).collect();
    let is_before = |mark: &Mark| wanted.iter().all(|&(i, first)| mark.rows.get(i).is_none_or(|&r| r <= first));
    index.marks.partition_point(is_before).checked_sub(1).and_then(|last| index.marks.get(last))
}

/// How the records of a stream are set apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Framing {
    /// Bytes of the identifier before a record.
    pub id_bytes: usize,
    /// Bytes of the identifier after a record.
    pub trailing: usize,
    /// Stop at an identifier that is not known, as at the end of a file that was not closed.
    pub stops: bool,
}

impl Member {
    /// The first record that is wanted.
    pub(super) fn first(&self) -> Option<u64> {
        let kept = self.kept.as_ref().filter(|_| !self.tasks.is_empty())?;
        (kept.start < kept.end).then_some(kept.start)
    }

    /// Tells whether no further record is wanted.
    fn is_done(&self) -> bool {
        self.tasks.is_empty() || self.kept.as_ref().is_some_and(|kept| self.rows >= kept.end)
    }

    fn flush(&mut self, scratch: &mut Vec<u8>) {
        let count = self.gathered.len() / self.record_bytes.max(1);
        let block = Block {
            view: View::Rows(&self.gathered),
            stride: self.record_bytes,
            shift: 0,
            first: self.next - count as u64,
            invalid: Invalid::After(self.data_bytes),
        };
        let mut cells: Vec<_> = self.columns.iter_mut().map(|c| c.grow(count)).collect();
        block.fill(count, &self.tasks, &mut cells, scratch);
        self.gathered.clear();
    }

    fn take(&mut self, record: &[u8], scratch: &mut Vec<u8>) {
        let row = self.rows;
        self.rows += 1;
        if self.tasks.is_empty() || self.kept.as_ref().is_some_and(|kept| !kept.contains(&row)) {
            return;
        }
        self.next = self.rows;
        if self.record_bytes == 0 {
            // Nothing but indices of records.
            self.gathered.clear();
            let block =
                Block { view: View::Rows(&[]), stride: 0, shift: 0, first: self.rows - 1, invalid: Invalid::After(0) };
            let mut cells: Vec<_> = self.columns.iter_mut().map(|c| c.grow(1)).collect();
            block.fill(1, &self.tasks, &mut cells, scratch);
            return;
        }
        self.gathered.extend_from_slice(record);
        if self.gathered.len() >= GATHERED {
            self.flush(scratch);
        }
    }
}

/// The member that an identifier stands for.
enum Identifiers {
    Small(Box<[Option<usize>; 256]>),
    Large(HashMap<u64, usize>),
}

impl Identifiers {
    fn new(members: &[Member], id_bytes: usize) -> Self {
        if id_bytes > 1 {
            return Self::Large(members.iter().enumerate().map(|(i, m)| (m.id, i)).collect());
        }
        let mut table = Box::new([None; 256]);
        for (i, member) in members.iter().enumerate() {
            if let Some(entry) = usize::try_from(member.id).ok().and_then(|id| table.get_mut(id)) {
                *entry = Some(i);
            }
        }
        Self::Small(table)
    }

    fn member(&self, id: &[u8]) -> Option<usize> {
        match self {
            Self::Small(table) => table[usize::from(id.first().copied().unwrap_or(0))],
            Self::Large(map) => {
                let mut wide = [0; 8];
                wide[..id.len()].copy_from_slice(id);
                map.get(&u64::from_le_bytes(wide)).copied()
            }
        }
    }
}

/// Goes through the stream once, or from a mark on to the last of the wanted records. `passed` hears of each place that
/// was come to, and of the members there.
pub(crate) fn read<S: Source + ?Sized>(
    source: &S,
    stream: &Stream,
    framing: Framing,
    members: &mut [Member],
    from: Option<&Mark>,
    passed: &mut dyn FnMut(u64, &mut [Member]),
) -> Result<(), MdfError> {
    let index = Identifiers::new(members, framing.id_bytes);
    let mut cursor = Cursor::from(source, stream, from.map_or(0, |mark| mark.place));
    for (member, rows) in members.iter_mut().zip(from.iter().flat_map(|mark| &mark.rows)) {
        member.rows = *rows;
    }
    let is_part = members.iter().any(|member| member.kept.is_some());
    let mut scratch = Vec::new();
    let mut is_more = true;
    while is_more && cursor.extend()? {
        let mut at = 0;
        while is_more {
            let left = stream.length - cursor.start() - at as u64;
            match step(cursor.window(), at, left, framing, &index, members, &mut scratch) {
                Step::Record(next) => at = next,
                Step::Short => break,
                Step::Cut => is_more = false,
                Step::Unknown if framing.stops => is_more = false,
                Step::Unknown => {
                    let place = cursor.start() + at as u64;
                    return Err(damaged(
                        position(stream, place),
                        "a record begins with an identifier that is not known",
                    ));
                }
            }
        }
        cursor.consume(at);
        is_more &= !(is_part && members.iter().all(Member::is_done));
        passed(cursor.start(), members);
    }
    members.iter_mut().filter(|m| !m.tasks.is_empty()).for_each(|m| m.flush(&mut scratch));
    passed(cursor.start(), members);
    Ok(())
}

enum Step {
    /// The next record begins here.
    Record(usize),
    /// The window ends within the record.
    Short,
    /// The stream ends within the record.
    Cut,
    Unknown,
}

/// Takes the record that begins `at` bytes into the window; `left` bytes of the stream are left from there.
fn step(
    window: &[u8],
    at: usize,
    left: u64,
    framing: Framing,
    index: &Identifiers,
    members: &mut [Member],
    scratch: &mut Vec<u8>,
) -> Step {
    let body = at + framing.id_bytes;
    let Some(id) = window.get(at..body) else { return Step::Short };
    if id.is_empty() && body >= window.len() {
        return Step::Short;
    }
    let Some(member) = index.member(id).and_then(|i| members.get_mut(i)) else { return Step::Unknown };
    let (start, length) = match member.is_varying {
        true if window.len() < body + 4 => return Step::Short,
        true => (body + 4, u32_at(window, body) as usize),
        false => (body, member.record_bytes),
    };
    if (start - at) as u64 + length as u64 > left {
        return Step::Cut;
    }
    let Some(record) = start.checked_add(length).and_then(|end| window.get(start..end)) else { return Step::Short };
    let next = start + length + framing.trailing;
    if next > window.len() {
        return Step::Short;
    }
    match member.is_varying {
        true => {
            member.rows += 1;
            if member.keep_values {
                member.values.push(record);
            }
        }
        false => member.take(record, scratch),
    }
    if next == at { Step::Unknown } else { Step::Record(next) }
}

/// Where in the file a place of a stream is, or its fragment begins.
fn position(stream: &Stream, place: u64) -> u64 {
    let fragment = stream.at(place).map(|i| stream.fragments[i]);
    fragment.map_or(0, |f| match f.packing {
        crate::stream::Packing::Plain => f.offset + (place - f.start),
        _ => f.offset,
    })
}
