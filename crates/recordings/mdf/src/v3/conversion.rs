//! Conversions of MDF 2 and 3.

use std::sync::Arc;

use super::block::{Block, Walk};
use crate::conversion::{Conversion, Formula, NumberTable, Outcome, RangeTable};
use crate::{MdfError, Source};

/// Where the parameters begin.
const PARAMETERS: usize = 46;

/// A conversion as the file describes it.
pub(super) struct Converted {
    pub(super) code: u16,
    pub(super) unit: Arc<str>,
    /// The conversion, or a description of the part that is not understood.
    pub(super) conversion: Result<Conversion, String>,
}

impl<S: Source + ?Sized> Walk<'_, S> {
    /// The conversion at `offset`, the identity at 0.
    pub(super) fn conversion(&mut self, offset: u64, integers: bool) -> Result<Converted, MdfError> {
        if offset == 0 {
            return Ok(Converted { code: u16::MAX, unit: Arc::from(""), conversion: Ok(Conversion::Identity) });
        }
        let block = self.block(offset, b"CC", PARAMETERS as u64)?;
        let code = block.u16(42);
        let conversion = match code {
            12 => Ok(self.ranges(&block, integers)?),
            10 => formula(&block.text(PARAMETERS, 256)),
            _ => parsed(&block, code).ok_or_else(|| format!("type {code}")),
        };
        Ok(Converted { code, unit: block.text(22, 20).into(), conversion })
    }

    /// Ranges to text; the first entry is what counts where none of the others does.
    fn ranges(&mut self, block: &Block, integers: bool) -> Result<Conversion, MdfError> {
        let mut entries = Vec::new();
        for i in 0..entries_of(block, 20) {
            let at = PARAMETERS + 20 * i;
            let text = Outcome::Text(self.text(block.link(at + 16))?);
            entries.push((block.f64(at), block.f64(at + 8), text));
        }
        let otherwise = match entries.is_empty() {
            true => Outcome::None,
            false => entries.remove(0).2,
        };
        Ok(Conversion::Texts(RangeTable::new(entries, integers), otherwise))
    }
}

/// The entries of a table that a block holds.
fn entries_of(block: &Block, size: usize) -> usize {
    usize::from(block.u16(44)).min(block.len().saturating_sub(PARAMETERS) / size)
}

fn formula(text: &str) -> Result<Conversion, String> {
    Formula::parse(text).map(Conversion::Formula).ok_or_else(|| Formula::refused(text))
}

fn parsed(block: &Block, code: u16) -> Option<Conversion> {
    let parameters = entries_of(block, 8);
    let parameter = |i: usize| block.f64(PARAMETERS + 8 * i);
    let pairs = || (0..entries_of(block, 16)).map(|i| (parameter(2 * i), parameter(2 * i + 1))).collect();
    match code {
        0 if parameters >= 2 => Some(Conversion::Linear { a: parameter(0), b: parameter(1) }),
        1 => NumberTable::new(pairs()).map(Conversion::Interpolated),
        2 => NumberTable::new(pairs()).map(Conversion::Closest),
        6 if parameters >= 6 => Some(Conversion::Polynomial(std::array::from_fn(parameter))),
        7 | 8 if parameters >= 7 => Some(Conversion::Exponential { p: std::array::from_fn(parameter), log: code == 8 }),
        9 if parameters >= 6 => Some(Conversion::Rational(std::array::from_fn(parameter))),
        11 => {
            let entry = |i: usize| {
                let at = PARAMETERS + 40 * i;
                (block.f64(at), block.f64(at), Outcome::Text(block.text(at + 8, 32).into()))
            };
            let entries = (0..entries_of(block, 40)).map(entry).collect();
            Some(Conversion::Texts(RangeTable::new(entries, true), Outcome::None))
        }
        132 | 133 | u16::MAX => Some(Conversion::Identity),
        _ => None,
    }
}
