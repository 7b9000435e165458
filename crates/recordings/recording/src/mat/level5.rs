//! Level 5: tagged elements, nested, each variable deflated or not.

mod content;
mod element;

use std::collections::HashSet;
use std::ops::Range;

use super::listed;
use super::objects::{self, Objects};
use super::scope::{element, joined};
use super::value::{MAX_DEPTH, MAX_NUMBERS, MAX_PARTS, MAX_TEXT, Struct, Value, text_rows};
use super::variables::Variables;
use super::wanted::{IN_CELL, Need, Wanted};
use crate::error::of_content;
use crate::source::{self, Shared};
use crate::{RecordingError, Selection, Source};
use content::Content;
use element::{Fault, MAX_EXPANSION, broken, uint4};
use work::Context;

/// Bytes before the first element.
pub(super) const HEADER: usize = 128;
/// The longest name; MATLAB's limit is 63.
const MAX_NAME: usize = 128;

/// The most numbers of each byte of a larger file: as many as doubles can be deflated.
const MAX_PER_BYTE: usize = MAX_EXPANSION / 8;

/// The most numbers in the list of a file, which holds texts.
const LISTED: usize = 1 << 16;

/// Returns true if the numbers of a file with this header are stored with the high byte first; `None` for another
/// format.
pub(super) fn is_big_endian(header: &[u8]) -> Option<bool> {
    match header.get(126..HEADER)? {
        b"IM" => Some(false),
        b"MI" => Some(true),
        _ => None,
    }
}

/// An element of a file: its type, and where its content is.
#[derive(Clone, Copy)]
struct Place {
    at: u64,
    kind: u32,
    size: usize,
}

/// The variables in the order of the file, with their names.
pub(super) fn variables(
    file: &str,
    source: &Shared,
    mut wanted: Wanted<'_>,
    context: &Context,
) -> Result<Variables, RecordingError> {
    let header = source::bytes(file, &**source, 0, HEADER as u64)?;
    let big = is_big_endian(&header).unwrap_or(false);
    let hidden = header.get(116..124).and_then(|b| b.try_into().ok()).map(|b| uint(b, big));
    let (size, places) = places(file, &**source, big)?;
    let most = usize::try_from(size).unwrap_or(usize::MAX).saturating_mul(MAX_PER_BYTE);
    let mut budget = Budget { parts: MAX_PARTS, numbers: MAX_NUMBERS.max(most) };
    if *wanted.selection != Selection::All {
        wanted.listed = listed(source, &places, big, wanted.selection);
    }
    let mut found = Vec::new();
    // Where the objects of the file are kept, in a form of their own.
    for place in places.iter().filter(|place| hidden != Some(place.at)) {
        let variable = variable(place, source, big, &mut budget, &wanted);
        found.extend(variable.map_err(|detail| damaged(file, place.at, detail))?);
        context.reach(place.at, size);
    }
    let place = places.into_iter().find(|place| hidden == Some(place.at));
    let start_time = objects::resolve(&mut found, &wanted, || {
        let place = place.ok_or("the file does not hold its content")?;
        let hidden = Hidden::open(&place, source, big, &budget)?;
        let metadata = hidden.metadata()?;
        Objects::new(metadata, hidden.big, move |index| hidden.content(index, &mut budget))
    });
    Ok(Variables { list: found, start_time, datasets: Vec::new() })
}

/// The size of a file and its elements.
fn places(file: &str, source: &dyn Source, big: bool) -> Result<(u64, Vec<Place>), RecordingError> {
    let length = source::size(file, source)?;
    let mut places = Vec::new();
    let mut at = HEADER as u64;
    // A file without any variable has been cut off.
    while at < length || at == HEADER as u64 {
        let available = length.saturating_sub(at);
        let truncated =
            |expected: u64| RecordingError::Truncated { file: file.into(), offset: at, expected, available };
        if available < 8 {
            return Err(truncated(8));
        }
        let tag = source::bytes(file, source, at, 8)?;
        let (kind, size) = (uint4(&tag[..4], big), uint4(&tag[4..], big));
        if u64::from(size) > available - 8 {
            return Err(truncated(8 + u64::from(size)));
        }
        places.push(Place { at, kind, size: size as usize });
        at += 8 + u64::from(size);
    }
    Ok((length, places))
}

/// The variables for the selected channels, and all that there are, as the file's list has them.
fn listed(
    source: &Shared,
    places: &[Place],
    big: bool,
    selection: &Selection,
) -> Option<(HashSet<String>, HashSet<String>)> {
    let mut budget = Budget { parts: MAX_PARTS, numbers: LISTED };
    let name = |place: &&Place| name_of(place, source, big).is_some_and(|name| name == listed::NAME);
    let place = places.iter().find(name)?;
    let (_, value) = variable(place, source, big, &mut budget, &Wanted::ALL).ok()??;
    listed::variables(&value, selection)
}

/// The name of a struct.
fn name_of(place: &Place, source: &Shared, big: bool) -> Option<String> {
    let mut content = Content::open(place.kind, source, place.at + 8, place.size, big).ok()?;
    let (_, flags) = content.next().ok()?;
    let is_struct = flags.len() == 8 && uint4(&flags, big) & 0xFF == 2;
    dimensions(&mut content).ok().filter(|_| is_struct)?;
    name(&content.next().ok()?.1).ok()
}

fn damaged(file: &str, at: u64, detail: String) -> RecordingError {
    of_content(file, Some(at), detail)
}

/// A variable with its name; none for one without a name.
fn variable(
    place: &Place,
    source: &Shared,
    big: bool,
    budget: &mut Budget,
    wanted: &Wanted<'_>,
) -> Result<Option<(String, Value)>, String> {
    let mut content = Content::open(place.kind, source, place.at + 8, place.size, big)?;
    let mut parser = Parser { content: &mut content, budget, wanted };
    match parser.matrix(None, 0) {
        Ok((name, value)) => {
            // What was left out is not read to come upon the sum over it.
            if content.left() == 0 {
                content.finish()?;
            }
            Ok((!name.is_empty()).then_some((name, value)))
        }
        Err(Fault::Damaged(detail)) => Err(detail),
        Err(Fault::Unsupported(name, detail)) => Ok(Some((name, Value::unsupported(detail)))),
    }
}

/// An unsigned number of up to 8 bytes.
fn uint(bytes: [u8; 8], big: bool) -> u64 {
    if big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) }
}

/// The next element as the sizes along each dimension, and how many places there are.
fn dimensions(content: &mut Content<'_>) -> Result<(Vec<usize>, usize), Fault> {
    let (kind, bytes) = content.next()?;
    if kind != 5 || !(8..=128).contains(&bytes.len()) || bytes.len() % 4 != 0 {
        return broken("the dimensions of a variable");
    }
    let sizes: Vec<u32> = bytes.chunks_exact(4).map(|c| uint4(c, content.big)).collect();
    let count = sizes.iter().try_fold(1_usize, |product, &d| product.checked_mul(d as usize));
    match count {
        Some(count) if sizes.iter().all(|&d| i32::try_from(d).is_ok()) => {
            Ok((sizes.iter().map(|&d| d as usize).collect(), count))
        }
        _ => broken(format!("dimensions {sizes:?}")),
    }
}

/// Text up to the first NUL.
fn name(content: &[u8]) -> Result<String, Fault> {
    let name: Vec<u8> = content.iter().copied().take_while(|&b| b != 0).take(MAX_NAME + 1).collect();
    if name.len() > MAX_NAME {
        return broken("the name of a variable or field is too long");
    }
    Ok(String::from_utf8(name).unwrap_or_else(|e| e.into_bytes().iter().map(|&b| char::from(b)).collect()))
}

/// Returns true if this is the type of integers of 64 bits.
fn is_wide(kind: u32) -> bool {
    matches!(kind, 12 | 13)
}

/// The characters of a character array.
fn characters(kind: u32, content: &[u8], big: bool) -> Result<Vec<char>, Fault> {
    Ok(match kind {
        1 | 2 | 16 => match std::str::from_utf8(content) {
            Ok(text) => text.chars().collect(),
            Err(_) => content.iter().map(|&b| char::from(b)).collect(),
        },
        3 | 4 | 17 => {
            let units = content.chunks_exact(2).map(|c| match big {
                true => u16::from_be_bytes([c[0], c[1]]),
                false => u16::from_le_bytes([c[0], c[1]]),
            });
            char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
        }
        18 => content
            .chunks_exact(4)
            .map(|c| char::from_u32(uint4(c, big)).unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect(),
        _ => return broken(format!("text of type {kind}")),
    })
}

/// Limits on further reading of a file, so that a small one cannot fill the memory.
struct Budget {
    /// Cells, fields and lines of text.
    parts: usize,
    numbers: usize,
}

impl Budget {
    fn take_parts(&mut self, parts: usize) -> Result<(), Fault> {
        let beyond = || format!("it brings the file to more than {MAX_PARTS} cells, fields and lines of text");
        let left = self.parts.checked_sub(parts);
        self.parts = left.ok_or_else(|| Fault::Unsupported(String::new(), beyond()))?;
        Ok(())
    }
}

/// Reads a variable; of arrays that are not asked for, no number is converted or kept.
struct Parser<'a, 'b> {
    content: &'a mut Content<'b>,
    budget: &'a mut Budget,
    wanted: &'a Wanted<'a>,
}

impl Parser<'_, '_> {
    /// Name and value of a matrix, the format's word for anything that a variable, cell or field can hold. Its `path`
    /// is none for a variable, whose name it has.
    fn matrix(&mut self, path: Option<&str>, depth: usize) -> Result<(String, Value), Fault> {
        if self.content.left() == 0 {
            return Ok((String::new(), Value::empty()));
        }
        let (kind, flags) = self.content.next()?;
        if kind != 6 || flags.len() != 8 {
            return broken("the flags of a variable");
        }
        let flags = uint4(&flags, self.content.big);
        let (class, is_complex) = (flags & 0xFF, flags & 0x0800 != 0);
        if class == 17 {
            return self.object(depth);
        }
        let (dimensions, count) = dimensions(self.content)?;
        let name = self.name()?;
        let path = path.unwrap_or(&name);
        let value = match class {
            1 => self.cell(count, depth),
            2 => self.structs(path, count, depth),
            3 => self.name().and_then(|_| self.structs(path, count, depth)),
            4 => self.budget.take_parts(dimensions[0].min(count)).and_then(|()| self.text(&dimensions)),
            5 => Ok(Value::unsupported("a sparse matrix; save it as a full one")),
            6..=15 if is_complex => Ok(Value::not_numeric("complex numbers")),
            6..=15 => self.array(path, &dimensions, count),
            16 => Ok(Value::not_numeric("a function")),
            other => broken(format!("a variable of class {other}")),
        };
        match value {
            Ok(value) => Ok((name, value)),
            Err(Fault::Damaged(detail)) if depth == 0 => {
                broken(format!("variable \"{}\": {detail}", name.escape_debug()))
            }
            Err(Fault::Unsupported(_, detail)) => Err(Fault::Unsupported(name, detail)),
            Err(fault) => Err(fault),
        }
    }

    fn name(&mut self) -> Result<String, Fault> {
        name(&self.content.next()?.1)
    }

    /// An object: its class, and where its content is.
    fn object(&mut self, depth: usize) -> Result<(String, Value), Fault> {
        let (name, _, class) = (self.name()?, self.name()?, self.name()?);
        if !objects::is_read(&class) {
            return Ok((name, Value::object(&class)));
        }
        let reference = self.part(IN_CELL, depth)?;
        Ok((name, Value::reference(class, &reference)))
    }

    /// The next cell or field.
    fn part(&mut self, path: &str, depth: usize) -> Result<Value, Fault> {
        self.budget.take_parts(1)?;
        if depth >= MAX_DEPTH {
            let detail = format!("more than {MAX_DEPTH} structs or cells within each other");
            return Err(Fault::Unsupported(String::new(), detail));
        }
        let outer = self.content.enter()?;
        let (_, value) = self.matrix(Some(path), depth + 1)?;
        self.content.leave(outer)?;
        Ok(value)
    }

    fn cell(&mut self, count: usize, depth: usize) -> Result<Value, Fault> {
        let mut items = Vec::new();
        for _ in 0..count {
            items.push(self.part(IN_CELL, depth)?);
        }
        Ok(Value::Cell(items))
    }

    fn structs(&mut self, path: &str, count: usize, depth: usize) -> Result<Value, Fault> {
        let width = match self.content.numbers(1, &[1])?.1.as_slice() {
            // Not above 4096, so exact.
            [width] if (1.0..=4096.0).contains(width) => *width as usize,
            other => return broken(format!("field names of length {other:?}")),
        };
        let (_, names) = self.content.next()?;
        if names.len() % width != 0 {
            return broken("the field names of a struct");
        }
        self.budget.take_parts(names.len() / width)?;
        let fields = names.chunks_exact(width).map(name).collect::<Result<Vec<_>, _>>()?;
        let mut structs = Vec::new();
        // A struct without fields takes no space in the file, whatever number of them is announced.
        for index in 0..if fields.is_empty() { 0 } else { count } {
            let path = element(path, index, count);
            let values = fields.iter().map(|field| self.part(&joined(&path, field), depth));
            structs.push(values.collect::<Result<Vec<_>, _>>()?);
        }
        Ok(Value::Struct(Struct { fields, elements: structs }))
    }

    fn array(&mut self, path: &str, dimensions: &[usize], count: usize) -> Result<Value, Fault> {
        match self.wanted.need(path, dimensions) {
            Need::Values | Need::Place => {}
            Need::Shape => return Ok(Value::shape(dimensions)),
            Need::Nothing => return Ok(Value::Unread),
        }
        let Some(left) = self.budget.numbers.checked_sub(count) else {
            return Ok(Value::unsupported("it brings the file to more numbers than its size makes plausible"));
        };
        let (kind, values) = self.content.numbers(count, dimensions)?;
        self.budget.numbers = left;
        Ok(Value::array(dimensions, values, is_wide(kind)))
    }

    fn text(&mut self, dimensions: &[usize]) -> Result<Value, Fault> {
        if self.content.left() == 0 {
            return Ok(text_rows(dimensions[0], &[]));
        }
        let tag = self.content.tag()?;
        if tag.size > 4 * MAX_TEXT {
            return Ok(Value::not_numeric("text"));
        }
        let bytes = self.content.bytes(tag)?;
        Ok(text_rows(dimensions[0], &characters(tag.kind, &bytes, self.content.big)?))
    }
}

/// The content of the objects of a file: a file within the file, of which a cell array is read.
struct Hidden {
    bytes: Vec<u8>,
    big: bool,
    /// Where the content of each cell is.
    cells: Vec<Range<usize>>,
}

impl Hidden {
    fn open(place: &Place, source: &Shared, big: bool, budget: &Budget) -> Result<Self, String> {
        let outer = Content::open(place.kind, source, place.at + 8, place.size, big)?;
        if outer.left() / size_of::<f64>() > budget.numbers {
            return Err("it is larger than the size of the file makes plausible".into());
        }
        Self::within(outer).map_err(Fault::detail)
    }

    fn within(mut outer: Content<'_>) -> Result<Self, Fault> {
        outer.next()?;
        dimensions(&mut outer)?;
        outer.next()?;
        let (_, bytes) = outer.next()?;
        outer.finish().map_err(Fault::Damaged)?;
        // Level, order of bytes, padding.
        let big = match bytes.get(2..4) {
            Some(b"IM") => false,
            Some(b"MI") => true,
            _ => return broken("the part with the objects has no header"),
        };
        let mut hidden = Self { bytes, big, cells: Vec::new() };
        hidden.cells = hidden.find_cells()?;
        Ok(hidden)
    }

    /// The places of the cells in `struct("MCOS", object of class FileWrapper__ of a cell array)`.
    fn find_cells(&self) -> Result<Vec<Range<usize>>, Fault> {
        const HEADER: usize = 8;
        let bytes = &self.bytes[HEADER.min(self.bytes.len())..];
        let mut content = Content::of(Box::new(bytes), bytes.len(), self.big, false);
        content.enter()?;
        let (_, _, _) = (content.next()?, dimensions(&mut content)?, content.next()?);
        let (_, names) = (content.next()?, content.next()?);
        if !names.1.starts_with(b"MCOS\0") {
            return broken("the part with the objects does not begin with them");
        }
        content.enter()?;
        for _ in ["flags", "name", "kind", "class"] {
            content.next()?;
        }
        content.enter()?;
        content.next()?;
        let (_, count) = dimensions(&mut content)?;
        content.next()?;
        let mut cells = Vec::new();
        for _ in 0..count {
            let outer = content.enter()?;
            let begin = HEADER + content.at();
            cells.push(begin..begin + content.left());
            content.leave(outer)?;
        }
        Ok(cells)
    }

    /// The bytes that connect objects and contents: the only numbers of the first cell.
    fn metadata(&self) -> Result<Vec<u8>, String> {
        let mut content = self.cell(0).ok_or("the part with the objects is empty")?;
        let mut read = || {
            let (_, _, _) = (content.next()?, dimensions(&mut content)?, content.next()?);
            Ok(content.next()?.1)
        };
        read().map_err(Fault::detail)
    }

    fn cell(&self, index: usize) -> Option<Content<'_>> {
        let bytes = self.bytes.get(self.cells.get(index)?.clone())?;
        Some(Content::of(Box::new(bytes), bytes.len(), self.big, false))
    }

    fn content(&self, index: usize, budget: &mut Budget) -> Result<Value, String> {
        let mut content = self.cell(index).ok_or("a property is missing")?;
        let mut parser = Parser { content: &mut content, budget, wanted: &Wanted::ALL };
        parser.matrix(Some(IN_CELL), 0).map(|(_, value)| value).map_err(Fault::detail)
    }
}
