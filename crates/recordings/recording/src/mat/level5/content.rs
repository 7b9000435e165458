//! The content of a variable, read from front to back, and inflated where it is deflated.

use std::io::{self, BufReader, Read};

use flate2::read::ZlibDecoder;

use super::element::{COMPRESSED, Fault, MATRIX, MAX_EXPANSION, broken, convert, uint4, width};
use crate::source::{Shared, Stretch};

/// Deflated bytes read at once: of a variable that is skipped, only so many.
const BUFFER: usize = 1 << 13;
/// Bytes of numbers converted at once; a multiple of every width.
const PIECE: usize = 1 << 16;

/// A variable that is being read.
pub(super) struct Content<'a> {
    rest: Box<dyn Rest + 'a>,
    pub(super) big: bool,
    /// Bytes that have been read.
    at: usize,
    /// Where the matrix that is being read ends.
    end: usize,
    is_deflated: bool,
}

/// Rest of a content.
pub(super) trait Rest: Read {
    /// Passes over bytes, and says over how many.
    fn pass(&mut self, count: usize) -> io::Result<usize>;
}

impl Rest for &[u8] {
    fn pass(&mut self, count: usize) -> io::Result<usize> {
        let count = count.min(self.len());
        *self = &self[count..];
        Ok(count)
    }
}

impl Rest for BufReader<Stretch> {
    /// All of the element is there.
    fn pass(&mut self, count: usize) -> io::Result<usize> {
        self.seek_relative(count as i64).map(|()| count)
    }
}

impl<R: Read> Rest for ZlibDecoder<R> {
    fn pass(&mut self, count: usize) -> io::Result<usize> {
        io::copy(&mut self.take(count as u64), &mut io::sink()).map(|passed| passed as usize)
    }
}

/// Tag before the content of an element.
#[derive(Clone, Copy)]
pub(super) struct Tag {
    pub(super) kind: u32,
    pub(super) size: usize,
    /// The content, where it is in the tag itself.
    short: Option<[u8; 4]>,
}

impl<'a> Content<'a> {
    /// Opens the element of this type and size.
    pub(super) fn open(kind: u32, source: &Shared, at: u64, size: usize, big: bool) -> Result<Self, String> {
        let stored = Stretch::new(source, at, at + size as u64);
        match kind {
            MATRIX => Ok(Self::of(Box::new(BufReader::new(stored)), size, big, false)),
            COMPRESSED => {
                let mut inflated = ZlibDecoder::new_with_buf(stored, vec![0; BUFFER]);
                let content = inflated_size(&mut inflated, size, big)?;
                Ok(Self::of(Box::new(inflated), content, big, true))
            }
            other => Err(format!("an element of type {other} where a variable should be")),
        }
    }

    /// The content of a matrix of `size` bytes.
    pub(super) fn of(rest: Box<dyn Rest + 'a>, size: usize, big: bool, is_deflated: bool) -> Self {
        Self { rest, big, at: 0, end: size, is_deflated }
    }

    /// Bytes that have been read.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// Bytes of the matrix that are still to be read.
    pub(super) fn left(&self) -> usize {
        self.end - self.at
    }

    /// The tag of the next element, all of which has to be there; short ones have their size and content in it.
    pub(super) fn tag(&mut self) -> Result<Tag, Fault> {
        if self.left() < 8 {
            return broken("a variable ends too early");
        }
        let mut tag = [0; 8];
        self.rest.read_exact(&mut tag).map_err(|error| Fault::Damaged(failure(error)))?;
        self.at += tag.len();
        let [_, _, _, _, content @ ..] = tag;
        let (first, second) = (uint4(&tag, self.big), uint4(&content, self.big));
        let size = (first >> 16) as usize;
        match size {
            0 if second as usize > self.left() => {
                broken(format!("an element of {second} bytes in the {} of its variable", self.left()))
            }
            0 => Ok(Tag { kind: first, size: second as usize, short: None }),
            1..=4 => Ok(Tag { kind: first & 0xFFFF, size, short: Some(content) }),
            _ => broken(format!("an element of type {first:#x}")),
        }
    }

    /// The content of the element with this tag.
    pub(super) fn bytes(&mut self, tag: Tag) -> Result<Vec<u8>, Fault> {
        if let Some(content) = tag.short {
            return Ok(content[..tag.size].to_vec());
        }
        let mut bytes = Vec::new();
        self.append(tag.size, &mut bytes)?;
        self.align()?;
        Ok(bytes)
    }

    /// Type and content of the next element.
    pub(super) fn next(&mut self) -> Result<(u32, Vec<u8>), Fault> {
        let tag = self.tag()?;
        Ok((tag.kind, self.bytes(tag)?))
    }

    /// The next element as `count` numbers, and its type.
    pub(super) fn numbers(&mut self, count: usize, dimensions: &[usize]) -> Result<(u32, Vec<f64>), Fault> {
        let tag = self.tag()?;
        let width = width(tag.kind)?;
        if tag.size % width != 0 {
            return broken(format!("{} bytes of numbers of {width} bytes", tag.size));
        }
        if tag.size / width != count {
            return broken(format!("{} numbers for dimensions {dimensions:?}", tag.size / width));
        }
        let mut values = Vec::new();
        // All of it is announced, by no more than deflate can hold, so the memory is taken once.
        values.try_reserve_exact(count).map_err(|error| Fault::Damaged(error.to_string()))?;
        if tag.short.is_some() {
            convert(tag.kind, &self.bytes(tag)?, self.big, &mut values);
            return Ok((tag.kind, values));
        }
        let mut piece = Vec::with_capacity(PIECE.min(tag.size));
        let mut left = tag.size;
        while left > 0 {
            piece.clear();
            self.append(left.min(PIECE), &mut piece)?;
            convert(tag.kind, &piece, self.big, &mut values);
            left -= piece.len();
        }
        self.align()?;
        Ok((tag.kind, values))
    }

    /// Goes into the next element, which has to be a matrix; what is returned leads out of it again.
    pub(super) fn enter(&mut self) -> Result<usize, Fault> {
        match self.tag()? {
            Tag { kind: MATRIX, size, short: None } => Ok(std::mem::replace(&mut self.end, self.at + size)),
            Tag { kind, .. } => broken(format!("an element of type {kind} in a struct or cell")),
        }
    }

    /// Leaves the matrix, whatever is left of it.
    pub(super) fn leave(&mut self, outer: usize) -> Result<(), Fault> {
        self.skip(self.left())?;
        self.end = outer;
        self.align()
    }

    /// Passes over bytes.
    fn skip(&mut self, count: usize) -> Result<(), Fault> {
        let passed = self.rest.pass(count);
        self.advance(count, passed)
    }

    /// Passes over what fills an element up to a multiple of eight bytes.
    fn align(&mut self) -> Result<(), Fault> {
        self.skip((self.at.next_multiple_of(8) - self.at).min(self.left()))
    }

    fn append(&mut self, count: usize, bytes: &mut Vec<u8>) -> Result<(), Fault> {
        let read = self.rest.by_ref().take(count as u64).read_to_end(bytes);
        self.advance(count, read)
    }

    fn advance(&mut self, wanted: usize, passed: io::Result<usize>) -> Result<(), Fault> {
        match passed {
            Ok(passed) if passed == wanted => {
                self.at += passed;
                Ok(())
            }
            Ok(passed) => {
                let has = self.at + passed;
                broken(format!("a variable announces {} bytes and has {has}", self.at + self.left()))
            }
            Err(error) => Err(Fault::Damaged(failure(error))),
        }
    }

    /// Reads to the end of a deflated variable, which checks the sum over it.
    pub(super) fn finish(self) -> Result<(), String> {
        if !self.is_deflated {
            return Ok(());
        }
        let announced = self.left() as u64;
        let mut sink = io::sink();
        let left = io::copy(&mut self.rest.take(announced + 9), &mut sink).map_err(failure)?;
        match left.checked_sub(announced) {
            Some(0..=8) => Ok(()),
            _ => Err("a variable has more or less bytes than it announces".into()),
        }
    }
}

/// The size that the variable deflated to `size` bytes announces.
fn inflated_size(inflated: &mut impl Read, size: usize, big: bool) -> Result<usize, String> {
    let mut tag = [0; 8];
    inflated.read_exact(&mut tag).map_err(failure)?;
    let (kind, content) = (uint4(&tag[..4], big), uint4(&tag[4..], big) as usize);
    if kind != MATRIX || content > size.saturating_mul(MAX_EXPANSION) {
        return Err(format!("an element of type {kind} and {content} bytes is deflated to {size} bytes"));
    }
    Ok(content)
}

fn failure(error: io::Error) -> String {
    format!("a variable cannot be read ({error})")
}
