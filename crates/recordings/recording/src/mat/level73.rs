//! Level 7.3: an HDF5 file in which MATLAB notes the class of each variable, and other HDF5 files.

use std::collections::HashMap;

use hdf5_pure::{AttrValue, Chunk, ChunkIndex, DType, Datatype, File, FormatError, Group, Object};

use super::dataset::{Dataset, is_half, numbers, text};
use super::listed;
use super::objects::{self, Objects};
use super::scope::joined;
use super::value::{MAX_DEPTH, MAX_NUMBERS, MAX_PARTS, MAX_TEXT, Struct, Value, text_rows};
use super::variables::Variables;
use super::wanted::{IN_CELL, Need, Wanted};
use crate::RecordingError;
use crate::error::{IMPLAUSIBLE, guarded, of_content};
use crate::source::{self, Shared};

/// The most numbers of each byte of a larger file: as many as doubles can be deflated.
const MAX_PER_BYTE: usize = 1032 / 8;

/// Attributes of a dataset that give its unit.
const UNIT: [&str; 8] = ["unit", "units", "Unit", "Units", "UNIT", "UNITS", "einheit", "Einheit"];

type Attributes = HashMap<String, AttrValue>;

/// The variables of a file with their names.
pub(super) fn variables(file: &str, source: &Shared, wanted: Wanted<'_>) -> Result<Variables, RecordingError> {
    let damaged = |detail: String| match detail.contains(SOFT_LINK) {
        true => RecordingError::SoftLink { file: file.into() },
        false if detail.ends_with(IMPLAUSIBLE) => RecordingError::Implausible { file: file.into(), what: detail },
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
        let numbers = MAX_NUMBERS.max(most);
        let mut reader = Reader { parts: MAX_PARTS, numbers, size, wanted: &wanted, datasets: Vec::new() };
        let mut list = reader.members(&root, "", 0).map_err(damaged)?;
        let datasets = std::mem::take(&mut reader.datasets);
        let start_time = objects::resolve(&mut list, &wanted, || hidden(&root, reader));
        Ok(Variables { list, start_time, datasets })
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
    /// Datasets that are read later.
    datasets: Vec<Dataset>,
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
        self.numbers = left.ok_or(IMPLAUSIBLE)?;
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
            Need::Place if dimensions.last().is_some_and(|rows| *rows > 1) && !is_wide(dataset) => {
                self.count(dataset)?;
                self.datasets.push(dataset.clone());
                return Ok(Value::place(&dimensions, self.datasets.len() - 1));
            }
            Need::Values | Need::Place => {}
            Need::Shape => return Ok(Value::shape(&dimensions)),
            Need::Nothing => return Ok(Value::Unread),
        }
        let values = numbers(dataset, &self.count(dataset)?)?;
        if values.len() != dimensions.iter().product::<usize>() {
            return Err(format!("{} numbers for dimensions {dimensions:?}", values.len()));
        }
        Ok(Value::array(&dimensions, values, is_wide(dataset)))
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
    let too_large = |_| IMPLAUSIBLE.to_owned();
    dataset.shape().map_err(text)?.into_iter().map(|size| usize::try_from(size).map_err(too_large)).collect()
}

fn is_wide(dataset: &Dataset) -> bool {
    matches!(dataset.dtype(), Ok(DType::I64 | DType::U64))
}

/// The version of layouts that came with HDF5 2.0.
const NEWER_LAYOUT: u8 = 5;
/// Deflate, shuffle, checksum, szip is none of them, bit packing, scaling, LZF.
const FILTERS: [u16; 6] = [1, 2, 3, 5, 6, 32000];

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

fn is_numeric(kind: &DType) -> bool {
    use DType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    matches!(kind, F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64)
}
