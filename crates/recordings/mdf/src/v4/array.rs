//! Arrays: where their elements are.

use super::block::Walk;
use crate::bytes::{array, u8_at, u16_at, u32_at, u64_at};
use crate::{MdfError, Source};

/// An element of an array.
#[derive(Debug)]
pub(super) struct Element {
    /// Its place, as in `[1][0]`.
    pub(super) suffix: String,
    /// Bytes from the first element.
    pub(super) bytes: usize,
    /// Invalidation bits from that of the first element.
    pub(super) invalid_bits: u32,
}

/// More elements are no array that one would look at channel by channel.
const MOST: u64 = 1 << 16;
/// Cost of an element, in bytes of memory.
const COST: u64 = 512;
/// The elements are stored with the first index running fastest.
const IS_INVERSE: u32 = 1 << 6;

impl<S: Source + ?Sized> Walk<'_, S> {
    /// The elements of the array described at `link`; `None` where they are stored apart, too many, or composed.
    pub(super) fn elements(&mut self, link: u64, owner: u64) -> Result<Option<Vec<Element>>, MdfError> {
        let block = self.own_block(link, &[b"##CA"])?;
        let data = block.data();
        let dimensions = usize::from(u16_at(data, 2));
        let sizes: Vec<u64> = (0..dimensions.min(16)).map(|i| u64_at(data, 16 + 8 * i)).collect();
        let total = sizes.iter().try_fold(1_u64, |total, size| total.checked_mul(*size)).filter(|t| *t <= MOST);
        let base = i32::from_le_bytes(array(data, 8));
        let (Some(total), 0, Ok(base)) = (total, u8_at(data, 1), usize::try_from(base)) else { return Ok(None) };
        if block.link(0) != 0 || dimensions > 16 || dimensions == 0 {
            return Ok(None);
        }
        self.spend(total * COST, owner)?;
        let is_inverse = u32_at(data, 4) & IS_INVERSE != 0;
        let invalid_base = u32_at(data, 12);
        let element = |index: u64| {
            let places = places(&sizes, index);
            let number = if is_inverse { number(places.iter().rev(), sizes.iter().rev()) } else { index };
            Element {
                suffix: places.iter().map(|p| format!("[{p}]")).collect(),
                bytes: (number as usize).saturating_mul(base),
                invalid_bits: (number as u32).saturating_mul(invalid_base),
            }
        };
        Ok(Some((0..total).map(element).collect()))
    }
}

/// The place of an element along each dimension, the last running fastest.
fn places(sizes: &[u64], index: u64) -> Vec<u64> {
    let mut rest = index;
    let mut places: Vec<u64> = sizes
        .iter()
        .rev()
        .map(|size| {
            let place = rest % size;
            rest /= size;
            place
        })
        .collect();
    places.reverse();
    places
}

/// The number of an element from its places, the last running fastest.
fn number<'p>(places: impl Iterator<Item = &'p u64>, sizes: impl Iterator<Item = &'p u64>) -> u64 {
    places.zip(sizes).fold(0, |number, (place, size)| number * size + place)
}
