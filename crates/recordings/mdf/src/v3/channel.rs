//! Channels of MDF 2 and 3.

use std::sync::Arc;

use super::block::{Block, Walk};
use super::conversion::Converted;
use crate::conversion::Conversion;
use crate::field::{Coding, Field};
use crate::model::{Channel, Encoding, Obstacle, Records, Storage};
use crate::v4::samples;
use crate::{MdfError, Source};

/// How numbers are stored whose data type does not say it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Defaults {
    pub(super) big_endian: bool,
    /// 0 IEEE 754, 1 VAX G, 2 VAX D.
    pub(super) float_format: u8,
}

/// Conversions to a date and a time, of bytes.
const DATE: u16 = 132;
const TIME: u16 = 133;

impl<S: Source + ?Sized> Walk<'_, S> {
    /// The channels of a group, and which of them is its master.
    pub(super) fn channels(
        &mut self,
        first: u64,
        records: &Records,
        defaults: Defaults,
    ) -> Result<(Vec<Channel>, Option<usize>), MdfError> {
        let mut channels = Vec::new();
        let mut next = first;
        while next != 0 {
            let block = self.own_block(next, b"CN", 218)?;
            channels.push(self.channel(&block, records, defaults)?);
            next = block.link(4);
        }
        let master = channels.iter().position(|c| c.is_master);
        Ok((channels, master))
    }

    fn channel(&mut self, block: &Block, records: &Records, defaults: Defaults) -> Result<Channel, MdfError> {
        let code = block.u16(190);
        let integers = matches!(code, 0 | 1 | 9 | 10 | 13 | 14);
        let Converted { code: converted, unit, conversion } = self.conversion(block.link(8), integers)?;
        let (conversion, obstacle) = match conversion {
            Ok(conversion) => (conversion, None),
            Err(detail) => (Conversion::Identity, Some(Obstacle::Conversion { detail })),
        };
        let (storage, unfit) = storage(block, converted, records, defaults);
        Ok(Channel {
            name: self.name(block)?,
            unit,
            comment: self.comment(block)?,
            is_master: block.u16(24) == 1,
            is_element: false,
            kind: samples(&storage, &conversion),
            obstacle: obstacle.or(unfit),
            storage,
            conversion: Arc::new(conversion),
            invalid_bit: None,
            all_invalid: false,
        })
    }

    fn name(&mut self, block: &Block) -> Result<Arc<str>, MdfError> {
        let long = self.text(if block.len() >= 222 { block.link(218) } else { 0 })?;
        Ok(if long.is_empty() { block.text(26, 32).into() } else { long })
    }

    fn comment(&mut self, block: &Block) -> Result<Arc<str>, MdfError> {
        let comment = self.text(block.link(20))?;
        Ok(if comment.is_empty() { block.text(58, 128).into() } else { comment })
    }
}

/// Where the samples are, and what speaks against reading them.
fn storage(block: &Block, conversion: u16, records: &Records, defaults: Defaults) -> (Storage, Option<Obstacle>) {
    let (code, bits) = (block.u16(190), u32::from(block.u16(188)));
    let additional = if block.len() >= 228 { usize::from(block.u16(226)) } else { 0 };
    let start = u32::from(block.u16(186));
    let (byte, bit) = (start as usize / 8 + additional, start % 8);
    let number = |coding, big_endian| Storage::Number(Field { byte, bit, bits, coding, big_endian });
    let bytes = |encoding| Storage::Bytes { byte, width: (bits / 8) as usize, encoding };
    let storage = match (code, conversion) {
        (8, DATE) => number(Coding::CanopenDate, false),
        (8, TIME) => number(Coding::CanopenTime, false),
        (0, _) => number(Coding::Unsigned, defaults.big_endian),
        (1, _) => number(Coding::Signed, defaults.big_endian),
        (2 | 3, _) => match (defaults.float_format, bits) {
            (0, _) => number(Coding::Float, defaults.big_endian),
            (_, 32) => number(Coding::VaxF, false),
            (1, _) => number(Coding::VaxG, false),
            _ => number(Coding::VaxD, false),
        },
        (4, _) => number(Coding::VaxF, false),
        (5, _) => number(Coding::VaxG, false),
        (6, _) => number(Coding::VaxD, false),
        (7, _) => bytes(Some(Encoding::Latin1)),
        (8, _) => bytes(None),
        (9 | 13, _) => number(Coding::Unsigned, code == 9),
        (10 | 14, _) => number(Coding::Signed, code == 10),
        (11 | 12 | 15 | 16, _) => number(Coding::Float, code < 13),
        _ => Storage::None,
    };
    let within = |byte: usize, width: usize| {
        byte.checked_add(width).is_none_or(|end| end > records.data_bytes).then_some(Obstacle::OutsideRecord)
    };
    match storage {
        Storage::Number(field) if field.is_valid() => (storage, within(byte, field.width())),
        Storage::Bytes { width, .. } if width > 0 => (storage, within(byte, width)),
        _ => (Storage::None, Some(Obstacle::DataType { code, bits })),
    }
}
