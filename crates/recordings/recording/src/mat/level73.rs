//! Level 7.3: an HDF5 file in which MATLAB notes the class of each variable, and other HDF5 files.

use std::collections::HashMap;

use hdf5_pure::{
    AttrValue, Chunk, ChunkIndex, DType, Dataset, Datatype, DatatypeByteOrder, File, FormatError, Group, Object,
};

use super::listed;
use super::objects::{self, Objects};
use super::scope::joined;
use super::value::{MAX_DEPTH, MAX_NUMBERS, MAX_PARTS, MAX_TEXT, Struct, Value, text_rows};
use super::variables::Variables;
use super::wanted::{IN_CELL, Need, Wanted};
use crate::RecordingError;
use crate::error::{guarded, of_content};
use crate::source::{self, Shared};

/// The most numbers of each byte of a larger file: as many as doubles can be deflated.
const MAX_PER_BYTE: usize = 1032 / 8;

/// Numbers read at once.
const PIECE: usize = 1 << 20;

/// Attributes of a dataset that give its unit.
const UNIT: [&str; 8] = ["unit", "units", "Unit", "Units", "UNIT", "UNITS", "einheit", "Einheit"];

type Attributes = HashMap<String, AttrValue>;

/// The variables of a file with their names.
pub(super) fn variables(file: &str, source: &Shared, wanted: Wanted<'_>) -> Result<Variables, RecordingError> {
    let damaged = |detail: String| match detail.contains(SOFT_LINK) {
        true => RecordingError::SoftLink { file: file.into() },
        false => of_content(file, None, detail),
    };
    let size = source::size(file, &**source)?;
    let most = usize::try_from(size).unwrap_or(usize::MAX).saturating_mul(MAX_PER_BYTE);
    guarded(file, || {
        let bytes = Bytes { source: source.clone(), size };
        let root = File::from_source(bytes).map_err(|error| damaged(error.to_string()))?.root();
        // Where the file lists its channels by other names, all of them are.
        let is_listed = root.group(listed::NAME).is_ok();
        let wanted = if is_listed { wanted.of_all() } else { wanted };
        let mut reader = Reader { parts: MAX_PARTS, numbers: MAX_NUMBERS.max(most), size, wanted: &wanted };
        let mut list = reader.members(&root, "", 0).map_err(damaged)?;
        let start_time = objects::resolve(&mut list, &wanted, || hidden(&root, reader));
        Ok(Variables { list, start_time })
    })
}

/// The content of the objects of a file: references, of which the first leads to what connects the others.
fn hidden<'a>(root: &Group, mut reader: Reader<'a>) -> Result<Objects<'a>, String> {
    let contents = root.group("#subsystem#").and_then(|group| group.dataset("MCOS"));
    let contents = contents.map_err(|_| "the file does not hold its content")?;
    reader.count(&contents)?;
    let contents = contents.dereference().map_err(text)?;
    let Some(Object::Dataset(metadata)) = contents.first() else { return Err("it has no objects".into()) };
    reader.count(metadata)?;
    let metadata = metadata.read_u8().map_err(text)?;
    Objects::new(metadata, false, move |index| reader.object(contents.get(index).ok_or("a property is missing")?, 0))
}

/// The address of what is nowhere in the file, which the links of groups before HDF5 1.8 give: their library takes them
/// for datasets, and reads there.
const UNDEFINED: u64 = u64::MAX;
const SOFT_LINK: &str = "a soft link in a group of the oldest layout of HDF5";

/// A file as its library takes it.
struct Bytes {
    source: Shared,
    size: u64,
}

impl hdf5_pure::Source for Bytes {
    fn len(&self) -> u64 {
        self.size
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> Result<(), FormatError> {
        if offset == UNDEFINED {
            return Err(FormatError::Source(SOFT_LINK.into()));
        }
        self.source.read_at(offset, buffer).map_err(|error| FormatError::Source(error.to_string()))
    }
}

/// Reader with limits on further reading, so that a small file cannot fill the memory.
struct Reader<'a> {
    parts: usize,
    numbers: usize,
    /// Bytes of the file.
    size: u64,
    wanted: &'a Wanted<'a>,
}

impl Reader<'_> {
    /// The datasets and groups in a group, with the units that are noted on them.
    fn members(&mut self, group: &Group, path: &str, depth: usize) -> Result<Vec<(String, Value)>, String> {
        let mut found = Vec::new();
        for (name, dataset) in group.iter_datasets().map_err(text)? {
            let attributes = dataset.attrs().map_err(text)?;
            let value = self.dataset(&dataset, &attributes, &joined(path, &name), depth);
            let value = value.map_err(|detail| format!("\"{name}\": {detail}"))?;
            if let Some(unit) = UNIT.iter().find_map(|key| attributes.get(*key)?.as_str()) {
                found.push((format!("{name}_unit"), Value::Text(vec![unit.to_owned()])));
            }
            found.push((name, value));
        }
        for (name, group) in group.iter_groups().map_err(text)? {
            // Where cells and the objects of the file are kept.
            if !name.starts_with('#') {
                let path = joined(path, &name);
                let value = self.group(&group, &path, depth).map_err(|detail| format!("\"{name}\": {detail}"))?;
                found.push((name, value));
            }
        }
        Ok(found)
    }

    /// Counts another part, and checks that it may be read.
    fn take_part(&mut self, depth: usize) -> Result<(), String> {
        self.parts = self.parts.checked_sub(1).ok_or("it has too many cells and fields")?;
        if depth > MAX_DEPTH {
            Err(format!("more than {MAX_DEPTH} structs or cells within each other"))
        } else {
            Ok(())
        }
    }

    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<Value, String> {
        self.take_part(depth)?;
        let attributes = group.attrs().map_err(text)?;
        if attributes.contains_key("MATLAB_sparse") {
            return Ok(Value::unsupported("a sparse matrix; save it as a full one"));
        }
        if let Some(class) = class_of_object(&attributes) {
            return Ok(Value::object(class));
        }
        let datasets: Vec<(String, Dataset)> = group.iter_datasets().map_err(text)?.collect();
        let references: Vec<&Dataset> = datasets.iter().map(|(_, d)| d).filter(|d| is_unclassed_reference(d)).collect();
        if !datasets.is_empty() && references.len() == datasets.len() {
            return self.structs(&datasets, depth);
        }
        let (fields, values) = self.members(group, path, depth + 1)?.into_iter().unzip();
        Ok(Value::Struct(Struct { fields, elements: vec![values] }))
    }

    /// An array of structs: each field refers to the values of all elements.
    fn structs(&mut self, datasets: &[(String, Dataset)], depth: usize) -> Result<Value, String> {
        let mut elements: Vec<Vec<Value>> = Vec::new();
        for (index, (_, dataset)) in datasets.iter().enumerate() {
            let values = self.cells(dataset, depth)?;
            if index == 0 {
                elements = values.into_iter().map(|value| vec![value]).collect();
            } else if values.len() == elements.len() {
                elements.iter_mut().zip(values).for_each(|(element, value)| element.push(value));
            } else {
                return Err("the fields of a struct array have different lengths".into());
            }
        }
        let fields = datasets.iter().map(|(name, _)| name.clone()).collect();
        Ok(Value::Struct(Struct { fields, elements }))
    }

    /// Values that the references in a dataset lead to.
    fn cells(&mut self, dataset: &Dataset, depth: usize) -> Result<Vec<Value>, String> {
        self.count(dataset)?;
        let mut values = Vec::new();
        for object in dataset.dereference().map_err(text)? {
            self.take_part(depth + 1)?;
            values.push(self.object(&object, depth + 1)?);
        }
        Ok(values)
    }

    /// Value that a reference leads to.
    fn object(&mut self, object: &Object, depth: usize) -> Result<Value, String> {
        match object {
            Object::Group(group) => self.group(group, IN_CELL, depth),
            Object::Dataset(dataset) => {
                let attributes = dataset.attrs().map_err(text)?;
                self.dataset(dataset, &attributes, IN_CELL, depth)
            }
            _ => Ok(Value::unsupported("a reference to what is neither a group nor a dataset")),
        }
    }

    /// The sizes of a dataset, if so many elements may still be read, and all of its chunks are there: room for a chunk
    /// is made before it is read, of the size that the file says it has.
    fn count(&mut self, dataset: &Dataset) -> Result<Vec<usize>, String> {
        let sizes = sizes(dataset)?;
        let chunks = match dataset.chunk_index().map_err(text)? {
            None => Vec::new(),
            Some(_) => dataset.chunks().map_err(text)?,
        };
        let is_there = |chunk: &Chunk| chunk.address.saturating_add(chunk.storage_size) <= self.size;
        if !chunks.iter().all(is_there) {
            return Err("a part of it lies beyond the end of the file".into());
        }
        let count = sizes.iter().try_fold(1_usize, |product, &d| product.checked_mul(d));
        let left = count.and_then(|count| self.numbers.checked_sub(count));
        self.numbers = left.ok_or("more numbers than its size makes plausible")?;
        Ok(sizes)
    }

    fn dataset(
        &mut self,
        dataset: &Dataset,
        attributes: &Attributes,
        path: &str,
        depth: usize,
    ) -> Result<Value, String> {
        self.take_part(depth)?;
        match class_of_object(attributes) {
            Some(class) if objects::is_read(class) => {
                let reference = self.array(dataset, IN_CELL)?;
                return Ok(Value::reference(class.to_owned(), &reference));
            }
            Some(class) => return Ok(Value::object(class)),
            None => {}
        }
        if let Err(hdf5_pure::Error::Format(FormatError::InvalidLayoutVersion(NEWER_LAYOUT))) = dataset.layout() {
            return Ok(Value::unsupported(
                "chunks of HDF5 2.0; write the file with libver=\"v110\", or convert it with h5repack",
            ));
        }
        if matches!(dataset.chunk_index(), Ok(Some(ChunkIndex::BTreeV2))) {
            return Ok(Value::unsupported(
                "data that may grow along several axes, in the way of HDF5 1.10; write the file with libver=\"earliest\"",
            ));
        }
        let class = attributes.get("MATLAB_class").and_then(|class| class.as_str()).unwrap_or_default();
        if let Some(filter) = dataset.filters().into_iter().find(|filter| !FILTERS.contains(filter)) {
            return Ok(Value::unsupported(format!("a compression other than deflate (filter {filter})")));
        }
        let is_empty = attributes.get("MATLAB_empty").is_some_and(|flag| flag.as_i64() != Some(0));
        match (class, dataset.dtype().map_err(text)?) {
            ("cell" | "struct" | "char", _) if is_empty => Ok(Value::Text(Vec::new())),
            ("cell", DType::ObjectReference) => Ok(Value::Cell(self.cells(dataset, depth)?)),
            ("function_handle", _) => Ok(Value::not_numeric("a function")),
            (_, _) if is_empty => Ok(Value::empty()),
            ("char", DType::U16 | DType::U8 | DType::U32) => self.characters(dataset),
            (_, DType::String | DType::VariableLengthString) => self.strings(dataset),
            (_, DType::Compound(members)) if is_complex(&members) => Ok(Value::not_numeric("complex numbers")),
            (_, kind) if is_numeric(&kind) || is_boolean(dataset) || is_half(dataset) => self.array(dataset, path),
            (_, kind) => Ok(Value::unsupported(format!("data of type {kind}"))),
        }
    }

    fn array(&mut self, dataset: &Dataset, path: &str) -> Result<Value, String> {
        // MATLAB's arrays are stored column by column, and HDF5 names the slowest dimension first.
        let mut dimensions = sizes(dataset)?;
        dimensions.reverse();
        match self.wanted.need(path, &dimensions) {
            Need::Values => {}
            Need::Shape => return Ok(Value::shape(&dimensions)),
            Need::Nothing => return Ok(Value::Unread),
        }
        let values = numbers(dataset, &self.count(dataset)?)?;
        if values.len() != dimensions.iter().product::<usize>() {
            return Err(format!("{} numbers for dimensions {dimensions:?}", values.len()));
        }
        let is_wide = matches!(dataset.dtype(), Ok(DType::I64 | DType::U64));
        Ok(Value::array(&dimensions, values, is_wide))
    }

    /// Text stored as the codes of its characters.
    fn characters(&mut self, dataset: &Dataset) -> Result<Value, String> {
        let shape = self.count(dataset)?;
        if shape.iter().product::<usize>() > MAX_TEXT {
            return Ok(Value::not_numeric("text"));
        }
        let units: Vec<u16> = dataset.read_u16().map_err(text)?;
        let characters = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
        Ok(text_rows(shape.last().copied().unwrap_or(1), &characters.collect::<Vec<_>>()))
    }

    fn strings(&mut self, dataset: &Dataset) -> Result<Value, String> {
        let count: usize = self.count(dataset)?.iter().product();
        if count > MAX_PARTS {
            return Ok(Value::not_numeric("text"));
        }
        let strings = dataset.read_string().map_err(text)?;
        let is_short = strings.iter().map(String::len).sum::<usize>() <= MAX_TEXT;
        Ok(if is_short { Value::Text(strings) } else { Value::not_numeric("text") })
    }
}

/// The sizes of a dataset, the slowest dimension first.
fn sizes(dataset: &Dataset) -> Result<Vec<usize>, String> {
    let too_large = |_| "more numbers than its size makes plausible".to_owned();
    dataset.shape().map_err(text)?.into_iter().map(|size| usize::try_from(size).map_err(too_large)).collect()
}

/// The numbers of a dataset, read some rows of the slowest dimension at a time.
fn numbers(dataset: &Dataset, sizes: &[usize]) -> Result<Vec<f64>, String> {
    let (is_half, is_double) = (is_half(dataset), is_double(dataset));
    let read = |first: usize, count: usize| {
        let raw = || dataset.read_raw_rows(first as u64, count as u64).map_err(text);
        match (is_half, is_double) {
            (true, _) => Ok(halves(&raw()?)),
            (_, true) => doubles(raw()?, PIECE),
            _ => dataset.read_f64_rows(first as u64, count as u64).map_err(text),
        }
    };
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

/// The version of layouts that came with HDF5 2.0.
const NEWER_LAYOUT: u8 = 5;
/// Deflate, shuffle, checksum, szip is none of them, bit packing, scaling, LZF.
const FILTERS: [u16; 6] = [1, 2, 3, 5, 6, 32000];

fn text(error: hdf5_pure::Error) -> String {
    error.to_string()
}

/// The class of an object, whose content is in a form of its own.
fn class_of_object(attributes: &Attributes) -> Option<&str> {
    attributes.get("MATLAB_object_decode").filter(|flag| flag.as_i64() != Some(0))?;
    Some(attributes.get("MATLAB_class").and_then(|class| class.as_str()).unwrap_or("unknown"))
}

fn is_unclassed_reference(dataset: &Dataset) -> bool {
    let is_reference = matches!(dataset.dtype(), Ok(DType::ObjectReference));
    is_reference && dataset.attrs().is_ok_and(|attributes| !attributes.contains_key("MATLAB_class"))
}

fn is_complex(members: &[(String, DType)]) -> bool {
    let names: Vec<&str> = members.iter().map(|(name, _)| name.as_str()).collect();
    matches!(names.as_slice(), ["real", "imag"] | ["r", "i"])
}

/// Returns true if a dataset holds truth values as h5py and PyTables write them: an enumeration of bytes.
fn is_boolean(dataset: &Dataset) -> bool {
    let Ok(Datatype::Enumeration { members, .. }) = dataset.datatype() else { return false };
    let members: Vec<_> = members.iter().map(|member| (member.name.as_str(), member.value.as_slice())).collect();
    members == [("FALSE", &[0_u8][..]), ("TRUE", &[1])]
}

/// Returns true if a dataset holds floats of 16 bits (IEEE 754 binary16), the low byte first.
fn is_half(dataset: &Dataset) -> bool {
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

fn is_numeric(kind: &DType) -> bool {
    use DType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    matches!(kind, F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64)
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
