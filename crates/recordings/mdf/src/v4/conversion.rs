//! Conversions of MDF 4.

use std::sync::Arc;

use super::block::{Block, Walk};
use super::converted::Converted;
use crate::bytes::{f64_at, u8_at, u16_at, u64_at};
use crate::conversion::{Conversion, Formula, NumberTable, Outcome, Part, RangeTable, Yields};
use crate::{MdfError, Obstacle, Source};

/// Deeper nesting of conversions is not followed.
const DEEPEST: usize = 16;

impl<S: Source + ?Sized> Walk<'_, S> {
    /// The conversion at `offset`, the identity at 0.
    pub(super) fn conversion(&mut self, offset: u64, integers: bool) -> Result<Converted, MdfError> {
        self.nested(offset, integers, 0)
    }

    fn nested(&mut self, offset: u64, integers: bool, depth: usize) -> Result<Converted, MdfError> {
        let nothing = self.text(0)?;
        let without = |conversion| Converted { name: nothing.clone(), unit: nothing.clone(), conversion };
        if offset == 0 {
            return Ok(without(Ok(Arc::new(Conversion::Identity))));
        }
        let known = self.conversions.get(&(offset, integers)).cloned();
        let refused = || without(Err(Obstacle::Conversion { detail: "it refers to itself".into() }));
        match known {
            Some(known) => return Ok(known.unwrap_or_else(refused)),
            None if depth > DEEPEST => return Ok(refused()),
            None => {}
        }
        self.conversions.insert((offset, integers), None);
        let block = self.block(offset, &[b"##CC"])?;
        let unit = self.text(block.link(1))?;
        let name = self.text(block.link(0))?;
        let converted = match self.read_conversion(&block, integers, depth)? {
            Some(conversion) => Ok(Arc::new(conversion)),
            None => Err(Obstacle::Conversion { detail: self.refused(&block)? }),
        };
        let converted = Converted { name, unit, conversion: converted };
        self.conversions.insert((offset, integers), Some(converted.clone()));
        Ok(converted)
    }

    /// Description of the part of a conversion that is not understood.
    fn refused(&mut self, block: &Block) -> Result<String, MdfError> {
        Ok(match u8_at(block.data(), 0) {
            3 => Formula::refused(&self.text(block.link(4))?),
            code => format!("type {code}"),
        })
    }

    /// `None` where the conversion is not understood.
    fn read_conversion(&mut self, block: &Block, integers: bool, depth: usize) -> Result<Option<Conversion>, MdfError> {
        let data = block.data();
        let count = usize::from(u16_at(data, 6)).min(data.len().saturating_sub(24) / 8);
        let values: Vec<f64> = (0..count).map(|i| f64_at(data, 24 + 8 * i)).collect();
        let value = |i: usize| values.get(i).copied().unwrap_or(f64::NAN);
        Ok(match u8_at(data, 0) {
            0 => Some(Conversion::Identity),
            1 if count >= 2 => Some(Conversion::Linear { a: value(0), b: value(1) }),
            2 if count >= 6 => Some(Conversion::Rational(std::array::from_fn(value))),
            3 => Formula::parse(&self.text(block.link(4))?).map(Conversion::Formula),
            4 => NumberTable::new(pairs(&values)).map(Conversion::Interpolated),
            5 => NumberTable::new(pairs(&values)).map(Conversion::Closest),
            6 => {
                let entries = values.chunks_exact(3).map(|c| (c[0], c[1], c[2])).collect();
                Some(Conversion::Ranges(RangeTable::new(entries, integers), value(count / 3 * 3)))
            }
            7 => {
                let ranges: Vec<_> = values.iter().map(|&v| (v, v)).collect();
                Some(self.texts(block, &ranges, integers, depth)?)
            }
            8 => {
                let ranges: Vec<_> = values.chunks_exact(2).map(|c| (c[0], c[1])).collect();
                Some(self.texts(block, &ranges, integers, depth)?)
            }
            9 => Some(self.text_to_number(block, &values)?),
            10 => Some(self.text_to_text(block)?),
            11 => Some(self.bits(block, count, depth)?),
            _ => None,
        })
    }

    fn texts(
        &mut self,
        block: &Block,
        ranges: &[(f64, f64)],
        integers: bool,
        depth: usize,
    ) -> Result<Conversion, MdfError> {
        let mut entries = Vec::with_capacity(ranges.len());
        for (i, &(lower, upper)) in ranges.iter().enumerate() {
            entries.push((lower, upper, self.outcome(block.link(4 + i), integers, depth)?));
        }
        let otherwise = self.outcome(block.link(4 + ranges.len()), integers, depth)?;
        let outcomes = || entries.iter().map(|e| &e.2).chain([&otherwise]);
        if outcomes().all(|o| number(o).is_some()) || outcomes().any(is_scaled) {
            // A text among numbers, such as "not available", is a number that is missing.
            let missing = Arc::new(Conversion::Linear { a: f64::NAN, b: 0.0 });
            let of = |outcome: &Outcome| number(outcome).unwrap_or(missing.clone());
            let pieces = entries.iter().map(|(lower, upper, outcome)| (*lower, *upper, of(outcome))).collect();
            return Ok(Conversion::Pieces(RangeTable::new(pieces, integers), of(&otherwise)));
        }
        Ok(Conversion::Texts(RangeTable::new(entries, integers), otherwise))
    }

    /// A text, or a conversion to be applied instead.
    fn outcome(&mut self, link: u64, integers: bool, depth: usize) -> Result<Outcome, MdfError> {
        if link == 0 {
            return Ok(Outcome::None);
        }
        if self.header(link)?.0 != *b"##CC" {
            return Ok(Outcome::Text(self.text(link)?));
        }
        let nested = self.nested(link, integers, depth + 1)?;
        Ok(nested.conversion.map_or(Outcome::None, Outcome::Number))
    }

    fn text_to_number(&mut self, block: &Block, values: &[f64]) -> Result<Conversion, MdfError> {
        let references = block.links().saturating_sub(4);
        let mut pairs = Vec::new();
        for (i, &value) in values.iter().enumerate().take(references) {
            pairs.push((self.text(block.link(4 + i))?, value));
        }
        let otherwise = values.get(references).copied().unwrap_or(f64::NAN);
        Ok(Conversion::TextToNumber { pairs, otherwise })
    }

    fn text_to_text(&mut self, block: &Block) -> Result<Conversion, MdfError> {
        let references = block.links().saturating_sub(4);
        let mut pairs = Vec::new();
        for i in 0..references / 2 {
            pairs.push((self.text(block.link(4 + 2 * i))?, self.text(block.link(5 + 2 * i))?));
        }
        let otherwise = match references % 2 == 1 && block.link(3 + references) != 0 {
            true => Some(self.text(block.link(3 + references))?),
            false => None,
        };
        Ok(Conversion::TextToText { pairs, otherwise })
    }

    fn bits(&mut self, block: &Block, count: usize, depth: usize) -> Result<Conversion, MdfError> {
        let mut parts = Vec::new();
        for i in 0..count.min(block.links().saturating_sub(4)) {
            let mask = u64_at(block.data(), 24 + 8 * i);
            let nested = self.nested(block.link(4 + i), true, depth + 1)?;
            if let Ok(conversion) = nested.conversion {
                parts.push((mask, Part { name: nested.name, conversion }));
            }
        }
        Ok(Conversion::Bits(parts))
    }
}

fn pairs(values: &[f64]) -> Vec<(f64, f64)> {
    values.chunks_exact(2).map(|c| (c[0], c[1])).collect()
}

/// The conversion of an outcome that is a number.
fn number(outcome: &Outcome) -> Option<Arc<Conversion>> {
    match outcome {
        Outcome::Number(conversion) if conversion.of_numbers() == Yields::Numbers => Some(conversion.clone()),
        _ => None,
    }
}

/// Returns true if an outcome is a physical value, and not just the number stored for want of a text.
fn is_scaled(outcome: &Outcome) -> bool {
    number(outcome).is_some_and(|conversion| !matches!(*conversion, Conversion::Identity))
}
