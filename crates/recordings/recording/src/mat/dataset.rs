//! Numbers of the datasets of HDF5.

use std::ops::Range;

pub(super) use hdf5_pure::Dataset;
use hdf5_pure::{Datatype, DatatypeByteOrder};

use crate::RecordingError;
use crate::error::{check_room, guarded, of_content};

/// Numbers read at once.
const PIECE: usize = 1 << 20;

/// The numbers of some rows of the slowest dimension of a dataset.
fn some_numbers(dataset: &Dataset, first: usize, count: usize) -> Result<Vec<f64>, String> {
    check_room(needed(dataset, count)?)?;
    let raw = || dataset.read_raw_rows(first as u64, count as u64).map_err(text);
    if is_half(dataset) {
        Ok(halves(&raw()?))
    } else if is_double(dataset) {
        doubles(raw()?, PIECE)
    } else {
        dataset.read_f64_rows(first as u64, count as u64).map_err(text)
    }
}

/// Bytes that some rows take while they are read: as they are stored, as numbers, and one chunk before and after it is
/// unpacked.
fn needed(dataset: &Dataset, rows: usize) -> Result<usize, String> {
    let product = |sizes: &[u64]| sizes.iter().fold(1_u64, |product, size| product.saturating_mul(*size));
    let width = product(dataset.shape().map_err(text)?.get(1..).unwrap_or_default());
    let chunk = dataset.chunk_shape().map_err(text)?.map_or(0, |sizes| product(&sizes));
    let (own, stored) = ((rows as u64).saturating_mul(width), dataset.element_size().map_err(text)?);
    let bytes = own.saturating_mul(stored.saturating_add(size_of::<f64>() as u64));
    let bytes = bytes.saturating_add(chunk.saturating_mul(stored).saturating_mul(2));
    Ok(usize::try_from(bytes).unwrap_or(usize::MAX))
}

/// Reads some rows of the slowest dimension of a dataset that was left to be read later.
pub(super) fn rows(file: &str, dataset: &Dataset, rows: Range<usize>) -> Result<Vec<f64>, RecordingError> {
    guarded(file, || some_numbers(dataset, rows.start, rows.len()).map_err(|detail| of_content(file, None, detail)))
}

/// The numbers of a dataset, read some rows of the slowest dimension at a time.
pub(super) fn numbers(dataset: &Dataset, sizes: &[usize]) -> Result<Vec<f64>, String> {
    let read = |first: usize, count: usize| some_numbers(dataset, first, count);
    let [rows, rest @ ..] = sizes else { return read(0, 1) };
    if *rows == 0 || rest.contains(&0) {
        return Ok(Vec::new());
    }
    let width: usize = rest.iter().product();
    let chunk = dataset.chunk_shape().map_err(text)?.and_then(|shape| shape.first().copied()).unwrap_or(1).max(1);
    // Chunks that are begun are read to their end.
    let step = usize::try_from(chunk).unwrap_or(*rows).max(1);
    let step = (PIECE / width).max(1).checked_next_multiple_of(step).unwrap_or(*rows);
    if step >= *rows {
        return read(0, *rows);
    }
    let mut values = Vec::new();
    values.try_reserve_exact(rows * width).map_err(|error| error.to_string())?;
    for first in (0..*rows).step_by(step) {
        let count = step.min(rows - first);
        values.extend(read(first, count)?);
    }
    Ok(values)
}

pub(super) fn text(error: hdf5_pure::Error) -> String {
    error.to_string()
}

/// Returns true if a dataset holds floats of 16 bits (IEEE 754 binary16), the low byte first.
pub(super) fn is_half(dataset: &Dataset) -> bool {
    is_float(dataset, 2, (10, 5, 15))
}

/// Returns true if a dataset holds floats of 64 bits (IEEE 754 binary64), the low byte first.
fn is_double(dataset: &Dataset) -> bool {
    is_float(dataset, 8, (52, 11, 1023))
}

/// Returns true if a dataset holds floats of so many bytes, the low one first. The exponent above the mantissa has this
/// place, size and bias.
fn is_float(dataset: &Dataset, bytes: u32, exponent: (u8, u8, u32)) -> bool {
    let Ok(Datatype::FloatingPoint { size, byte_order: DatatypeByteOrder::LittleEndian, layout }) = dataset.datatype()
    else {
        return false;
    };
    let found = (layout.exponent_location, layout.exponent_size, layout.exponent_bias);
    size == bytes && found == exponent && (layout.mantissa_location, layout.mantissa_size) == (0, exponent.0)
}

/// Numbers from their bytes, which are given back piece by piece from the end, so that a long vector is not in memory
/// twice.
fn doubles(mut bytes: Vec<u8>, piece: usize) -> Result<Vec<f64>, String> {
    let count = bytes.len() / size_of::<f64>();
    Vec::<f64>::new().try_reserve_exact(count).map_err(|error| error.to_string())?;
    let mut values = vec![0.0; count];
    while !bytes.is_empty() {
        let left = bytes.len() / size_of::<f64>();
        let first = left.saturating_sub(1) / piece * piece;
        let last = bytes[first * size_of::<f64>()..].as_chunks().0;
        values[first..].iter_mut().zip(last).for_each(|(value, bytes)| *value = f64::from_le_bytes(*bytes));
        bytes.truncate(first * size_of::<f64>());
        bytes.shrink_to_fit();
    }
    Ok(values)
}

fn halves(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|bytes| half(u16::from_le_bytes(*bytes))).collect()
}

/// The number that a sign, five bits of exponent and ten of mantissa are.
fn half(bits: u16) -> f64 {
    let (exponent, mantissa) = (i32::from(bits >> 10 & 0x1F), f64::from(bits & 0x3FF));
    let magnitude = match exponent {
        0 => mantissa * 2_f64.powi(-24),
        31 if mantissa == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (mantissa + 1024.0) * 2_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::{doubles, half};

    #[test]
    fn exact_doubles_in_pieces() {
        let numbers: Vec<f64> = (0..10).map(|i| 1.5 * f64::from(i) - 4.0).collect();
        for (count, piece) in [(0, 3), (1, 3), (3, 3), (4, 3), (10, 3), (10, 10), (10, 100)] {
            let bytes = numbers[..count].iter().flat_map(|number| number.to_le_bytes()).collect();
            assert_eq!(doubles(bytes, piece).unwrap(), numbers[..count], "{count} in pieces of {piece}");
        }
    }

    /// The examples of IEEE 754 binary16: one, its neighbour, the largest, the smallest normal and subnormal ones.
    #[test]
    fn exact_floats_of_16_bits() {
        let examples = [
            (0x3C00, 1.0),
            (0x3C01, 1.0 + 2_f64.powi(-10)),
            (0xC000, -2.0),
            (0x7BFF, 65504.0),
            (0x0400, 2_f64.powi(-14)),
            (0x0001, 2_f64.powi(-24)),
            (0xFC00, f64::NEG_INFINITY),
        ];
        for (bits, number) in examples {
            assert_eq!(half(bits), number, "{bits:x}");
        }
        assert!(half(0x7E00).is_nan() && half(0x8000).is_sign_negative());
    }
}
