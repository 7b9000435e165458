//! Level 5: tagged elements, nested, each variable deflated or not.

mod content;

use std::collections::HashSet;

use super::listed;
use super::value::{MAX_TEXT, Struct, Value, text_rows};
use super::wanted::{Need, Wanted};
use crate::source::{self, Shared};
use crate::{RecordingError, Selection, Source};
use content::Content;

/// Bytes before the first element.
pub(super) const HEADER: usize = 128;
/// Deflate cannot expand more than this.
const MAX_EXPANSION: usize = 1032;
/// The most structs and cells within each other.
const MAX_DEPTH: usize = 20;
/// The most cells, fields and lines of text in a file.
const MAX_PARTS: usize = 1 << 18;
/// The longest name; MATLAB's limit is 63.
const MAX_NAME: usize = 128;

/// The most numbers of a file, and of each byte of a larger file: as many as doubles can be deflated.
const MAX_NUMBERS: usize = 1 << 26;
const MAX_PER_BYTE: usize = MAX_EXPANSION / 8;

/// The most numbers in the list of a file, which holds texts.
const LISTED: usize = 1 << 16;

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Whether the numbers of a file with this header are stored with the high byte first; `None` for another format.
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
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Vec<(String, Value)>, RecordingError> {
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
        progress(place.at, size);
    }
    Ok(found)
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
    let content = Content::open(place.kind, source, (place.at + 8, place.size), big).ok()?;
    content.name_of_struct(big)
}

fn damaged(file: &str, at: u64, detail: String) -> RecordingError {
    RecordingError::Damaged { file: file.into(), offset: Some(at), detail }
}

/// A variable with its name; none for one without a name.
fn variable(
    place: &Place,
    source: &Shared,
    big: bool,
    budget: &mut Budget,
    wanted: &Wanted<'_>,
) -> Result<Option<(String, Value)>, String> {
    let content = Content::open(place.kind, source, (place.at + 8, place.size), big)?;
    if let Some(large) = content.large(big) {
        match wanted.need(&large.name, &large.dimensions) {
            Need::Values => {}
            Need::Shape => return Ok(Some((large.name, Value::shape(&large.dimensions)))),
            Need::Nothing => return Ok(Some((large.name, Value::Unread))),
        }
        if let Some(left) = budget.numbers.checked_sub(large.count) {
            budget.numbers = left;
            let named = |detail: String| format!("variable \"{}\": {detail}", large.name.escape_debug());
            let array = content.numbers(&large, big).map_err(named)?;
            return Ok(Some((large.name, array)));
        }
    }
    let data = content.whole()?;
    let mut parser = Parser { big, budget };
    match parser.matrix(&data, 0) {
        Ok((name, value)) => Ok((!name.is_empty()).then_some((name, value))),
        Err(Fault::Damaged(detail)) => Err(detail),
        Err(Fault::Unsupported(name, detail)) => Ok(Some((name, Value::unsupported(detail)))),
    }
}

/// An unsigned number of up to 8 bytes.
fn uint(bytes: [u8; 8], big: bool) -> u64 {
    if big { u64::from_be_bytes(bytes) } else { u64::from_le_bytes(bytes) }
}

/// An unsigned number of 4 bytes.
fn uint4(bytes: &[u8], big: bool) -> u32 {
    let bytes = bytes.first_chunk().copied().unwrap_or_default();
    if big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
}

/// Why a variable is not read.
enum Fault {
    Damaged(String),
    /// The name as far as known, and what is not supported about it.
    Unsupported(String, String),
}

fn broken<T>(detail: impl Into<String>) -> Result<T, Fault> {
    Err(Fault::Damaged(detail.into()))
}

/// The elements of a matrix, one after the other.
struct Elements<'a> {
    rest: &'a [u8],
    big: bool,
}

impl<'a> Elements<'a> {
    /// Type and content of the next element; short ones have their size and content in the tag.
    fn next(&mut self) -> Result<(u32, &'a [u8]), Fault> {
        let Some((tag, body)) = self.rest.split_at_checked(8) else {
            return broken("a variable ends too early");
        };
        let (first, second) = (uint4(tag, self.big), uint4(&tag[4..], self.big));
        let short = (first >> 16) as usize;
        if short > 4 {
            return broken(format!("an element of type {first:#x}"));
        }
        if short > 0 {
            self.rest = body;
            return Ok((first & 0xFFFF, &tag[4..4 + short]));
        }
        let size = second as usize;
        let Some(content) = body.get(..size) else {
            return broken(format!("an element of {size} bytes in the {} of its variable", body.len()));
        };
        self.rest = body.get(size.next_multiple_of(8)..).unwrap_or_default();
        Ok((first, content))
    }

    fn numbers(&mut self) -> Result<Vec<f64>, Fault> {
        let (kind, content) = self.next()?;
        numbers(kind, content, self.big)
    }

    fn name(&mut self) -> Result<String, Fault> {
        let (_, content) = self.next()?;
        name(content)
    }

    /// The sizes along each dimension, and how many places there are.
    fn dimensions(&mut self) -> Result<(Vec<usize>, usize), Fault> {
        let (kind, content) = self.next()?;
        if kind != 5 || !(8..=128).contains(&content.len()) || content.len() % 4 != 0 {
            return broken("the dimensions of a variable");
        }
        let sizes: Vec<u32> = content.chunks_exact(4).map(|c| uint4(c, self.big)).collect();
        let count = sizes.iter().try_fold(1_usize, |product, &d| product.checked_mul(d as usize));
        match count {
            Some(count) if sizes.iter().all(|&d| i32::try_from(d).is_ok()) => {
                Ok((sizes.iter().map(|&d| d as usize).collect(), count))
            }
            _ => broken(format!("dimensions {sizes:?}")),
        }
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

/// Numbers of the type that the tag states.
fn numbers(kind: u32, content: &[u8], big: bool) -> Result<Vec<f64>, Fault> {
    let mut numbers = Vec::new();
    converted_all(kind, content, big, &mut numbers)?;
    Ok(numbers)
}

/// Whether this is the type of integers of 64 bits.
fn is_wide(kind: u32) -> bool {
    matches!(kind, 12 | 13)
}

/// Appends numbers of the type that the tag states.
fn converted_all(kind: u32, content: &[u8], big: bool, out: &mut Vec<f64>) -> Result<(), Fault> {
    // Numbers of 64 bits above 2^53 are rounded, which is said.
    match kind {
        1 => converted(content, big, out, |b| f64::from(i8::from_le_bytes(b))),
        2 => converted(content, big, out, |b| f64::from(u8::from_le_bytes(b))),
        3 => converted(content, big, out, |b| f64::from(i16::from_le_bytes(b))),
        4 => converted(content, big, out, |b| f64::from(u16::from_le_bytes(b))),
        5 => converted(content, big, out, |b| f64::from(i32::from_le_bytes(b))),
        6 => converted(content, big, out, |b| f64::from(u32::from_le_bytes(b))),
        7 => converted(content, big, out, |b| f64::from(f32::from_le_bytes(b))),
        9 => converted(content, big, out, f64::from_le_bytes),
        12 => converted(content, big, out, |b| i64::from_le_bytes(b) as f64),
        13 => converted(content, big, out, |b| u64::from_le_bytes(b) as f64),
        other => broken(format!("numbers of type {other}")),
    }
}

fn converted<const N: usize>(
    content: &[u8],
    big: bool,
    out: &mut Vec<f64>,
    number: fn([u8; N]) -> f64,
) -> Result<(), Fault> {
    let (chunks, rest) = content.as_chunks::<N>();
    if !rest.is_empty() {
        return broken(format!("{} bytes of numbers of {N} bytes", content.len()));
    }
    out.extend(chunks.iter().map(|&(mut chunk)| {
        if big {
            chunk.reverse();
        }
        number(chunk)
    }));
    Ok(())
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

/// What may still be read of a file, so that a small one cannot fill the memory.
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

struct Parser<'a> {
    big: bool,
    budget: &'a mut Budget,
}

impl Parser<'_> {
    /// Name and value of a matrix, the format's word for anything that a variable, cell or field can hold.
    fn matrix(&mut self, content: &[u8], depth: usize) -> Result<(String, Value), Fault> {
        if content.is_empty() {
            return Ok((String::new(), Value::empty()));
        }
        let mut elements = Elements { rest: content, big: self.big };
        let (kind, flags) = elements.next()?;
        if kind != 6 || flags.len() != 8 {
            return broken("the flags of a variable");
        }
        let flags = uint4(flags, self.big);
        let (class, is_complex) = (flags & 0xFF, flags & 0x0800 != 0);
        if class == 17 {
            let (name, _, class) = (elements.name()?, elements.name()?, elements.name()?);
            return Ok((name, Value::object(&class)));
        }
        let (dimensions, count) = elements.dimensions()?;
        let name = elements.name()?;
        let value = match class {
            1 => self.cell(&mut elements, count, depth),
            2 => self.structs(&mut elements, count, depth),
            3 => elements.name().and_then(|_| self.structs(&mut elements, count, depth)),
            4 => self.budget.take_parts(dimensions[0].min(count)).and_then(|()| text(&mut elements, &dimensions)),
            5 => Ok(Value::unsupported("a sparse matrix; save it as a full one")),
            6..=15 if is_complex => Ok(Value::not_numeric("complex numbers")),
            6..=15 => self.array(&mut elements, &dimensions, count),
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

    /// The next cell or field.
    fn part(&mut self, elements: &mut Elements<'_>, depth: usize) -> Result<Value, Fault> {
        self.budget.take_parts(1)?;
        if depth >= MAX_DEPTH {
            let detail = format!("more than {MAX_DEPTH} structs or cells within each other");
            return Err(Fault::Unsupported(String::new(), detail));
        }
        match elements.next()? {
            (MATRIX, content) => Ok(self.matrix(content, depth + 1)?.1),
            (other, _) => broken(format!("an element of type {other} in a struct or cell")),
        }
    }

    fn cell(&mut self, elements: &mut Elements<'_>, count: usize, depth: usize) -> Result<Value, Fault> {
        let mut items = Vec::new();
        for _ in 0..count {
            items.push(self.part(elements, depth)?);
        }
        Ok(Value::Cell(items))
    }

    fn structs(&mut self, elements: &mut Elements<'_>, count: usize, depth: usize) -> Result<Value, Fault> {
        let width = match elements.numbers()?.as_slice() {
            // Not above 4096, so exact.
            [width] if (1.0..=4096.0).contains(width) => *width as usize,
            other => return broken(format!("field names of length {other:?}")),
        };
        let (_, names) = elements.next()?;
        if names.len() % width != 0 {
            return broken("the field names of a struct");
        }
        self.budget.take_parts(names.len() / width)?;
        let fields = names.chunks_exact(width).map(name).collect::<Result<Vec<_>, _>>()?;
        let mut structs = Vec::new();
        // A struct without fields takes no space in the file, whatever number of them is announced.
        for _ in 0..if fields.is_empty() { 0 } else { count } {
            let values = fields.iter().map(|_| self.part(elements, depth));
            structs.push(values.collect::<Result<Vec<_>, _>>()?);
        }
        Ok(Value::Struct(Struct { fields, elements: structs }))
    }

    fn array(&mut self, elements: &mut Elements<'_>, dimensions: &[usize], count: usize) -> Result<Value, Fault> {
        let Some(left) = self.budget.numbers.checked_sub(count) else {
            return Ok(Value::unsupported("it brings the file to more numbers than its size makes plausible"));
        };
        let (kind, content) = elements.next()?;
        let values = numbers(kind, content, self.big)?;
        if values.len() != count {
            return broken(format!("{} numbers for dimensions {dimensions:?}", values.len()));
        }
        self.budget.numbers = left;
        Ok(Value::array(dimensions, values, is_wide(kind)))
    }
}

fn text(elements: &mut Elements<'_>, dimensions: &[usize]) -> Result<Value, Fault> {
    let (kind, content) = match elements.rest.is_empty() {
        true => (16, &[][..]),
        false => elements.next()?,
    };
    if content.len() > 4 * MAX_TEXT {
        return Ok(Value::not_numeric("text"));
    }
    Ok(text_rows(dimensions[0], &characters(kind, content, elements.big)?))
}
