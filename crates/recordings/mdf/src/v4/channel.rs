//! Channels: from a chain of blocks to [`Channel`]s, elements of structures and arrays included.

use std::collections::HashMap;
use std::sync::Arc;

use super::array::Element;
use super::block::{Block, Walk};
use crate::bytes::{u8_at, u32_at};
use crate::conversion::{Conversion, Yields};
use crate::field::{Coding, Field, is_integer};
use crate::model::{Channel, Encoding, Kind, Obstacle, Place, Quantity, Records, Storage};
use crate::stream::Stream;
use crate::{MdfError, Source};

/// Data that the channels of a group share.
pub(super) struct Context<'c> {
    pub(super) records: &'c Records,
    /// Identifiers of the records of the data group, by the place of their channel group.
    pub(super) ids: &'c HashMap<u64, u64>,
    pub(super) signals: &'c mut Vec<Stream>,
    /// The file was not closed.
    pub(super) open: bool,
}

/// A channel that is not yet connected with others.
pub(super) struct Draft {
    pub(super) channel: Channel,
    pub(super) offset: u64,
    /// Where its size or its values are.
    link: u64,
    quantity: Option<Quantity>,
}

/// Content of a channel in a record.
#[derive(Debug, Clone, Copy)]
pub(super) enum Raw {
    Number(Field),
    Bytes { byte: usize, width: usize, encoding: Option<Encoding> },
    Unknown,
}

/// Deeper structures are not followed.
const DEEPEST: usize = 32;
/// Compositions of MDF 4.30 whose parts change from record to record: lists, variants, unions and streams within a
/// channel.
const DYNAMIC: [&[u8; 4]; 4] = [b"##CL", b"##CV", b"##CU", b"##DS"];

mod kind {
    pub(super) const VARYING: u8 = 1;
    pub(super) const MASTER: u8 = 2;
    pub(super) const VIRTUAL_MASTER: u8 = 3;
    pub(super) const SIZED: u8 = 5;
    pub(super) const VIRTUAL: u8 = 6;
}

type Channels = (Vec<Channel>, Option<(usize, Quantity)>);

impl<S: Source + ?Sized> Walk<'_, S> {
    /// The channels of a group, and which of them is its master.
    pub(super) fn channels(&mut self, first: u64, context: &mut Context<'_>) -> Result<Channels, MdfError> {
        let mut drafts = Vec::new();
        self.chain(first, context, &mut drafts, 0)?;
        let sizes: HashMap<u64, Storage> = drafts.iter().map(|d| (d.offset, d.channel.storage.clone())).collect();
        let mut streams = HashMap::new();
        for draft in &mut drafts {
            self.join(draft, context, &sizes, &mut streams)?;
        }
        let master = drafts.iter().position(|d| d.channel.is_master);
        let master = master.and_then(|i| Some((i, drafts[i].quantity?)));
        Ok((drafts.into_iter().map(|d| d.channel).collect(), master))
    }

    fn chain(
        &mut self,
        first: u64,
        context: &Context<'_>,
        drafts: &mut Vec<Draft>,
        depth: usize,
    ) -> Result<(), MdfError> {
        let mut next = first;
        while next != 0 {
            let block = self.own_block(next, &[b"##CN"])?;
            self.channel(&block, context, drafts, depth)?;
            next = block.link(0);
        }
        Ok(())
    }

    fn channel(
        &mut self,
        block: &Block,
        context: &Context<'_>,
        drafts: &mut Vec<Draft>,
        depth: usize,
    ) -> Result<(), MdfError> {
        let name = self.text(block.link(2))?;
        let composition = block.link(1);
        let composed = if composition == 0 { [0; 4] } else { self.header(composition)?.0 };
        if composed == *b"##CA" {
            return match self.elements(composition, block.offset)? {
                Some(elements) => {
                    elements.iter().try_for_each(|e| self.element(block, &name, Some(e), context, drafts))
                }
                None => {
                    self.element(block, &name, None, context, drafts)?;
                    drafts.iter_mut().rev().take(1).for_each(|d| d.channel.obstacle = Some(Obstacle::Array));
                    Ok(())
                }
            };
        }
        self.element(block, &name, None, context, drafts)?;
        match depth < DEEPEST && !DYNAMIC.contains(&&composed) {
            true => self.chain(composition, context, drafts, depth + 1),
            false => Ok(()),
        }
    }

    /// A channel, or an element of an array; two of them for complex numbers.
    fn element(
        &mut self,
        block: &Block,
        name: &Arc<str>,
        element: Option<&Element>,
        context: &Context<'_>,
        drafts: &mut Vec<Draft>,
    ) -> Result<(), MdfError> {
        let name = element.map_or(name.clone(), |e| format!("{name}{}", e.suffix).into());
        let code = u8_at(block.data(), 2);
        if !matches!(code, 15 | 16) {
            let raw = raw(block, code, element);
            return self.draft(block, name, raw, element, context, drafts);
        }
        let bits = u32_at(block.data(), 8) / 2;
        for (part, suffix) in [".re", ".im"].into_iter().enumerate() {
            let mut raw = raw(block, code, element);
            if let Raw::Number(field) = &mut raw {
                field.bits = bits;
                field.byte += part * (bits / 8) as usize;
            }
            self.draft(block, format!("{name}{suffix}").into(), raw, element, context, drafts)?;
        }
        Ok(())
    }

    fn draft(
        &mut self,
        block: &Block,
        name: Arc<str>,
        raw: Raw,
        element: Option<&Element>,
        context: &Context<'_>,
        drafts: &mut Vec<Draft>,
    ) -> Result<(), MdfError> {
        let data = block.data();
        let (code, flags) = (u8_at(data, 0), u32_at(data, 12));
        let integers = matches!(raw, Raw::Number(field) if is_integer(&field));
        let converted = self.conversion(block.link(4), integers)?;
        let unit = self.text(block.link(6))?;
        let (conversion, obstacle) = match converted.conversion {
            Ok(conversion) => (conversion, None),
            Err(obstacle) => (Arc::new(Conversion::Identity), Some(obstacle)),
        };
        let (storage, unfit) = storage(block, code, raw, context.records);
        let kind = samples(&storage, &conversion);
        // Text has no unit, whatever its table says.
        let unit = if kind == Kind::Text { unit } else { either(unit, &converted.unit) };
        let invalid_bit = u32_at(data, 16).saturating_add(element.map_or(0, |e| e.invalid_bits));
        let has_bit = flags & 2 != 0 && u64::from(invalid_bit) < context.records.invalid_bytes as u64 * 8;
        drafts.push(Draft {
            channel: Channel {
                name,
                unit,
                comment: self.text(block.link(7))?,
                is_master: matches!(code, kind::MASTER | kind::VIRTUAL_MASTER),
                is_element: element.is_some(),
                kind,
                obstacle: obstacle.or(unfit),
                storage,
                conversion,
                invalid_bit: has_bit.then_some(invalid_bit),
                all_invalid: flags & 1 != 0,
            },
            offset: block.offset,
            link: block.link(5),
            quantity: quantity(u8_at(data, 1)),
        });
        Ok(())
    }

    /// Connects a channel with the values or sizes it refers to.
    fn join(
        &mut self,
        draft: &mut Draft,
        context: &mut Context<'_>,
        sizes: &HashMap<u64, Storage>,
        streams: &mut HashMap<u64, usize>,
    ) -> Result<(), MdfError> {
        match &mut draft.channel.storage {
            Storage::Sized { size, .. } => match sizes.get(&draft.link) {
                Some(Storage::Number(field)) => *size = *field,
                _ => draft.channel.obstacle = Some(Obstacle::NoData),
            },
            Storage::Elsewhere { values, .. } => {
                *values = match (context.ids.get(&draft.link), streams.get(&draft.link)) {
                    (Some(id), _) => Place::Records(*id),
                    (None, Some(stream)) => Place::Stream(*stream),
                    (None, None) => {
                        let stream = self.data(draft.link, context.open)?.stream;
                        context.signals.push(stream);
                        streams.insert(draft.link, context.signals.len() - 1);
                        Place::Stream(context.signals.len() - 1)
                    }
                };
            }
            _ => {}
        }
        Ok(())
    }
}

/// Where and how the samples are, from the data type.
fn raw(block: &Block, code: u8, element: Option<&Element>) -> Raw {
    let data = block.data();
    let byte = (u32_at(data, 4) as usize).saturating_add(element.map_or(0, |e| e.bytes));
    let (bit, bits) = (u32::from(u8_at(data, 3)), u32_at(data, 8));
    let number = |coding, big_endian| Raw::Number(Field { byte, bit, bits, coding, big_endian });
    let bytes = |encoding| Raw::Bytes { byte, width: (bits / 8) as usize, encoding };
    match code {
        0 | 1 => number(Coding::Unsigned, code == 1),
        2 | 3 => number(Coding::Signed, code == 3),
        4 | 5 => number(Coding::Float, code == 5),
        6 => bytes(Some(Encoding::Latin1)),
        7 => bytes(Some(Encoding::Utf8)),
        8 => bytes(Some(Encoding::Utf16Le)),
        9 => bytes(Some(Encoding::Utf16Be)),
        10..=12 => bytes(None),
        13 => number(Coding::CanopenDate, false),
        14 => number(Coding::CanopenTime, false),
        15 | 16 => number(Coding::Float, code == 16),
        _ => Raw::Unknown,
    }
}

/// Where the samples are, and what speaks against reading them.
fn storage(block: &Block, code: u8, raw: Raw, records: &Records) -> (Storage, Option<Obstacle>) {
    let unknown = || {
        let (code, bits) = (u16::from(u8_at(block.data(), 2)), u32_at(block.data(), 8));
        (Storage::None, Some(Obstacle::DataType { code, bits }))
    };
    let within = |byte: usize, width: usize| {
        byte.checked_add(width).is_none_or(|end| end > records.data_bytes).then_some(Obstacle::OutsideRecord)
    };
    match (code, raw) {
        (kind::VIRTUAL_MASTER | kind::VIRTUAL, _) => (Storage::Index, None),
        (kind::VARYING, raw) => {
            let (byte, bits) = (u32_at(block.data(), 4) as usize, u32_at(block.data(), 8));
            let place = Field::unsigned(byte, if bits == 32 { 4 } else { 8 });
            let encoding = match raw {
                Raw::Bytes { encoding, .. } => encoding,
                _ => None,
            };
            (Storage::Elsewhere { place, values: Place::Stream(0), encoding }, within(byte, place.width()))
        }
        (kind::SIZED, Raw::Bytes { byte, width, encoding }) if width > 0 => {
            (Storage::Sized { byte, width, size: Field::unsigned(0, 1), encoding }, within(byte, width))
        }
        (0 | 2 | 4, Raw::Bytes { byte, width, encoding }) if width > 0 => {
            (Storage::Bytes { byte, width, encoding }, within(byte, width))
        }
        (0 | 2 | 4, Raw::Number(field)) if field.is_valid() => {
            (Storage::Number(field), within(field.byte, field.width()))
        }
        (0..=6, _) => unknown(),
        (code, _) => (Storage::None, Some(Obstacle::ChannelType { code: u16::from(code) })),
    }
}

/// Kind of the samples once they are converted.
pub(crate) fn samples(storage: &Storage, conversion: &Conversion) -> Kind {
    match storage {
        Storage::Number(_) | Storage::Index | Storage::None => match conversion.of_numbers() {
            Yields::Numbers => Kind::Number,
            Yields::Text => Kind::Text,
        },
        Storage::Bytes { encoding, .. } | Storage::Sized { encoding, .. } | Storage::Elsewhere { encoding, .. } => {
            match (encoding, conversion.of_text()) {
                (None, _) => Kind::Bytes,
                (_, Yields::Numbers) => Kind::Number,
                (_, Yields::Text) => Kind::Text,
            }
        }
    }
}

/// Quantity that a master counts, from the type of its synchronisation.
pub(super) fn quantity(sync: u8) -> Option<Quantity> {
    match sync {
        1 => Some(Quantity::Time),
        2 => Some(Quantity::Angle),
        3 => Some(Quantity::Distance),
        4 => Some(Quantity::Index),
        _ => None,
    }
}

/// The first text that says something.
fn either(first: Arc<str>, second: &Arc<str>) -> Arc<str> {
    if first.is_empty() { second.clone() } else { first }
}
