//! Arrays as numbers.

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Decimal32Type, Decimal64Type, Decimal128Type, Decimal256Type, DecimalType,
    DurationMicrosecondType, DurationMillisecondType, DurationNanosecondType, DurationSecondType, Float16Type,
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, Time32MillisecondType, Time32SecondType,
    Time64MicrosecondType, Time64NanosecondType, TimestampMicrosecondType, TimestampMillisecondType,
    TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, PrimitiveArray};
use arrow_schema::{DataType, TimeUnit};

/// Checks that a column of this type holds numbers; the error names its content otherwise.
pub(super) fn is_numeric(kind: &DataType) -> Result<(), &'static str> {
    match kind {
        DataType::Dictionary(_, values) => is_numeric(values),
        _ if kind.is_numeric() || matches!(kind, DataType::Boolean | DataType::Duration(_)) => Ok(()),
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => Err("text"),
        DataType::Null => Err("nothing"),
        _ if kind.is_temporal() => Err("dates"),
        DataType::Binary | DataType::LargeBinary | DataType::BinaryView | DataType::FixedSizeBinary(_) => Err("bytes"),
        _ => Err("lists or structs"),
    }
}

/// Returns true if a column of this type holds integers of more bits than a double keeps.
pub(super) fn is_wide(kind: &DataType) -> bool {
    match kind {
        DataType::Dictionary(_, values) => is_wide(values),
        _ => matches!(kind, DataType::Int64 | DataType::UInt64),
    }
}

/// The numbers of an array, NaN where there is none; `None` for another type. Durations are in seconds.
pub(super) fn numbers(array: &dyn Array) -> Option<Vec<f64>> {
    Some(match array.data_type() {
        DataType::Float64 => plain::<Float64Type>(array, |v| v),
        DataType::Float32 => plain::<Float32Type>(array, f64::from),
        DataType::Float16 => plain::<Float16Type>(array, f64::from),
        DataType::Int8 => plain::<Int8Type>(array, f64::from),
        DataType::Int16 => plain::<Int16Type>(array, f64::from),
        DataType::Int32 => plain::<Int32Type>(array, f64::from),
        // Numbers of 64 bits above 2^53 are rounded, which is said.
        DataType::Int64 => plain::<Int64Type>(array, |v| v as f64),
        DataType::UInt8 => plain::<UInt8Type>(array, f64::from),
        DataType::UInt16 => plain::<UInt16Type>(array, f64::from),
        DataType::UInt32 => plain::<UInt32Type>(array, f64::from),
        DataType::UInt64 => plain::<UInt64Type>(array, |v| v as f64),
        DataType::Boolean => {
            let flags = array.as_boolean();
            flags.iter().map(|flag| flag.map_or(f64::NAN, |flag| f64::from(u8::from(flag)))).collect()
        }
        DataType::Decimal32(..) => decimals::<Decimal32Type>(array),
        DataType::Decimal64(..) => decimals::<Decimal64Type>(array),
        DataType::Decimal128(..) => decimals::<Decimal128Type>(array),
        DataType::Decimal256(..) => decimals::<Decimal256Type>(array),
        DataType::Duration(unit) => {
            let per_second = per_second(*unit) as f64;
            ticks(array)?.into_iter().map(|t| t.map_or(f64::NAN, |t| t as f64 / per_second)).collect()
        }
        DataType::Dictionary(..) => dictionary(array)?,
        _ => return None,
    })
}

fn plain<T: ArrowPrimitiveType>(array: &dyn Array, number: impl Fn(T::Native) -> f64) -> Vec<f64> {
    let array: &PrimitiveArray<T> = array.as_primitive();
    if array.null_count() == 0 {
        return array.values().iter().map(|&value| number(value)).collect();
    }
    array.iter().map(|value| value.map_or(f64::NAN, &number)).collect()
}

/// Decimals, rounded once: through their digits.
fn decimals<T: DecimalType>(array: &dyn Array) -> Vec<f64> {
    let array: &PrimitiveArray<T> = array.as_primitive();
    let number = |row| match array.is_null(row) {
        true => f64::NAN,
        false => array.value_as_string(row).parse().unwrap_or(f64::NAN),
    };
    (0..array.len()).map(number).collect()
}

fn dictionary(array: &dyn Array) -> Option<Vec<f64>> {
    let array = array.as_any_dictionary_opt()?;
    let values = numbers(array.values().as_ref())?;
    if values.is_empty() {
        return Some(vec![f64::NAN; array.len()]);
    }
    let keys = array.normalized_keys();
    let number = |(row, key): (usize, usize)| match array.keys().is_null(row) {
        true => f64::NAN,
        false => values.get(key).copied().unwrap_or(f64::NAN),
    };
    Some(keys.into_iter().enumerate().map(number).collect())
}

/// Whole units of a time stamp, duration or time of day.
pub(super) fn ticks(array: &dyn Array) -> Option<Vec<Option<i64>>> {
    use TimeUnit::{Microsecond, Millisecond, Nanosecond, Second};
    Some(match array.data_type() {
        DataType::Timestamp(Second, _) => whole::<TimestampSecondType>(array),
        DataType::Timestamp(Millisecond, _) => whole::<TimestampMillisecondType>(array),
        DataType::Timestamp(Microsecond, _) => whole::<TimestampMicrosecondType>(array),
        DataType::Timestamp(Nanosecond, _) => whole::<TimestampNanosecondType>(array),
        DataType::Duration(Second) => whole::<DurationSecondType>(array),
        DataType::Duration(Millisecond) => whole::<DurationMillisecondType>(array),
        DataType::Duration(Microsecond) => whole::<DurationMicrosecondType>(array),
        DataType::Duration(Nanosecond) => whole::<DurationNanosecondType>(array),
        DataType::Time32(Second) => whole::<Time32SecondType>(array),
        DataType::Time32(Millisecond) => whole::<Time32MillisecondType>(array),
        DataType::Time64(Microsecond) => whole::<Time64MicrosecondType>(array),
        DataType::Time64(Nanosecond) => whole::<Time64NanosecondType>(array),
        _ => return None,
    })
}

fn whole<T: ArrowPrimitiveType<Native: Into<i64>>>(array: &dyn Array) -> Vec<Option<i64>> {
    array.as_primitive::<T>().iter().map(|value| value.map(Into::into)).collect()
}

/// Units in a second.
pub(super) fn per_second(unit: TimeUnit) -> i64 {
    match unit {
        TimeUnit::Second => 1,
        TimeUnit::Millisecond => 1_000,
        TimeUnit::Microsecond => 1_000_000,
        TimeUnit::Nanosecond => 1_000_000_000,
    }
}
