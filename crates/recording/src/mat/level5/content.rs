//! The content of a variable, inflated where it is deflated, without more of it in memory than is asked for.

use std::io::{BufReader, Read};

use flate2::read::ZlibDecoder;

use super::{COMPRESSED, Elements, MATRIX, MAX_EXPANSION, converted_all, is_wide, uint4};
use crate::mat::value::Value;
use crate::source::{Shared, Stretch};

/// Bytes of a variable in which its flags, dimensions and name are.
const HEAD: usize = 1 << 10;
/// Arrays of fewer numbers are read with all their variable.
const LARGE: usize = 1 << 12;
/// Deflated bytes read at once: of a variable that is skipped, only so many.
const BUFFER: usize = 1 << 13;
/// Bytes of numbers converted at once; a multiple of every width.
const PIECE: usize = 1 << 16;

/// A variable that is about to be read.
pub(super) struct Content {
    head: Vec<u8>,
    rest: Box<dyn Read>,
    /// Bytes after the head.
    left: usize,
    is_deflated: bool,
}

/// A large array of real numbers.
pub(super) struct Large {
    pub(super) name: String,
    pub(super) dimensions: Vec<usize>,
    pub(super) count: usize,
    /// Where the numbers begin in the head.
    at: usize,
}

impl Content {
    /// Opens the element of this type and size.
    pub(super) fn open(kind: u32, source: &Shared, (at, size): (u64, usize), big: bool) -> Result<Self, String> {
        let stored = Stretch::new(source, at, at + size as u64);
        let (mut rest, size): (Box<dyn Read>, usize) = match kind {
            MATRIX => (Box::new(BufReader::new(stored)), size),
            COMPRESSED => {
                let mut inflated = ZlibDecoder::new_with_buf(stored, vec![0; BUFFER]);
                let content = inflated_size(&mut inflated, size, big)?;
                (Box::new(inflated), content)
            }
            other => return Err(format!("an element of type {other} where a variable should be")),
        };
        let mut head = vec![0; size.min(HEAD)];
        rest.read_exact(&mut head).map_err(failure)?;
        Ok(Self { left: size - head.len(), head, rest, is_deflated: kind == COMPRESSED })
    }

    /// What the variable is, if it is a large array of real numbers.
    pub(super) fn large(&self, big: bool) -> Option<Large> {
        let mut elements = Elements { rest: &self.head, big };
        let (kind, flags) = elements.next().ok()?;
        let flags = (kind == 6 && flags.len() == 8).then(|| uint4(flags, big))?;
        let is_real = (6..=15).contains(&(flags & 0xFF)) && flags & 0x0800 == 0;
        let (dimensions, count) = elements.dimensions().ok().filter(|(_, count)| is_real && *count > LARGE)?;
        let name = elements.name().ok()?;
        let at = self.head.len() - elements.rest.len();
        (!name.is_empty() && elements.rest.len() >= 8).then_some(Large { name, dimensions, count, at })
    }

    /// The name of the variable, if it is a struct.
    pub(super) fn name_of_struct(&self, big: bool) -> Option<String> {
        let mut elements = Elements { rest: &self.head, big };
        let (_, flags) = elements.next().ok()?;
        let is_struct = flags.len() == 8 && uint4(flags, big) & 0xFF == 2;
        elements.dimensions().ok().filter(|_| is_struct)?;
        elements.name().ok()
    }

    /// The numbers of a large array.
    pub(super) fn numbers(mut self, large: &Large, big: bool) -> Result<Value, String> {
        let (tag, begun) = self.head[large.at..].split_at(8);
        let (kind, size) = (uint4(tag, big), uint4(&tag[4..], big) as usize);
        let begun = begun.to_vec();
        if size > begun.len() + self.left {
            return Err(format!("an element of {size} bytes in the {} of its variable", begun.len() + self.left));
        }
        let mut bytes = begun.as_slice().chain(&mut self.rest).take(size as u64);
        let mut values = Vec::new();
        // All of it is announced, by no more than deflate can hold, so the memory is taken once.
        if size <= 8 * large.count {
            values.try_reserve_exact(large.count).map_err(|error| error.to_string())?;
        }
        let mut piece = Vec::with_capacity(PIECE);
        loop {
            piece.clear();
            bytes.by_ref().take(PIECE as u64).read_to_end(&mut piece).map_err(failure)?;
            // More numbers than announced are not put into memory to be counted.
            if piece.is_empty() || values.len() > large.count {
                break;
            }
            converted_all(kind, &piece, big, &mut values).map_err(|_| format!("numbers of type {kind}"))?;
        }
        if values.len() != large.count {
            return Err(format!("{} numbers for dimensions {:?}", values.len(), large.dimensions));
        }
        self.left -= size.saturating_sub(begun.len());
        self.finish()?;
        values.shrink_to_fit();
        Ok(Value::array(&large.dimensions, values, is_wide(kind)))
    }

    /// All of the content.
    pub(super) fn whole(mut self) -> Result<Vec<u8>, String> {
        let mut content = std::mem::take(&mut self.head);
        let announced = content.len() + self.left;
        self.rest.by_ref().take(self.left as u64).read_to_end(&mut content).map_err(failure)?;
        if content.len() < announced {
            return Err(format!("a variable announces {announced} bytes and has {}", content.len()));
        }
        self.left = 0;
        self.finish()?;
        Ok(content)
    }

    /// Reads what is left of a deflated variable, which checks the sum over it.
    fn finish(self) -> Result<(), String> {
        if !self.is_deflated {
            return Ok(());
        }
        let mut sink = std::io::sink();
        let left = std::io::copy(&mut self.rest.take(self.left as u64 + 9), &mut sink).map_err(failure)?;
        let padding = left.checked_sub(self.left as u64);
        match padding {
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

fn failure(error: std::io::Error) -> String {
    format!("a variable cannot be read ({error})")
}
