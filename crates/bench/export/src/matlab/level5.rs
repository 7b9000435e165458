//! Variables of MATLAB as a MAT-file of level 5, uncompressed.
//!
//! Source: MathWorks, *MAT-File Format*, level 5.

const CELL: u32 = 1;
const STRUCT: u32 = 2;
const TEXT: u32 = 4;
const DOUBLE: u32 = 6;
/// Elements: 8-bit and 32-bit integers, flags, doubles, matrices, UTF-16.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLES: u32 = 9;
const MATRIX: u32 = 14;
const UTF16: u32 = 17;
/// Bytes for each name of a field, the zero at its end included.
const FIELD_NAME: usize = 32;

/// A value of MATLAB.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// A matrix: rows, columns, and its numbers column by column.
    Matrix(usize, usize, Vec<f64>),
    /// A row of letters.
    Text(String),
    /// A column of values.
    Cells(Vec<Value>),
    /// One struct. Names have at most 31 letters.
    Struct(Vec<(&'static str, Value)>),
}

impl Value {
    /// A number.
    pub(super) fn number(value: f64) -> Self {
        Value::Matrix(1, 1, vec![value])
    }

    /// A matrix by its entries.
    pub(super) fn matrix(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let entry = &entry;
        Value::Matrix(rows, columns, (0..columns).flat_map(|j| (0..rows).map(move |i| entry(i, j))).collect())
    }

    /// A matrix by its rows.
    pub(super) fn of_rows(rows: &[Vec<f64>]) -> Self {
        Value::matrix(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
    }

    /// A row of numbers.
    pub(super) fn row(values: &[f64]) -> Self {
        Value::Matrix(usize::from(!values.is_empty()), values.len(), values.to_vec())
    }

    /// A column of texts.
    pub(super) fn texts<T: AsRef<str>>(texts: impl IntoIterator<Item = T>) -> Self {
        Value::Cells(texts.into_iter().map(|text| Value::Text(text.as_ref().to_owned())).collect())
    }

    /// Class, size and content, as an element.
    fn element(&self, name: &str) -> Vec<u8> {
        let (class, size, content) = match self {
            Value::Matrix(rows, columns, values) => (
                DOUBLE,
                [*rows, *columns],
                element(DOUBLES, &values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>()),
            ),
            Value::Text(text) => {
                let units: Vec<u16> = text.encode_utf16().collect();
                let bytes: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
                (TEXT, [usize::from(!units.is_empty()), units.len()], element(UTF16, &bytes))
            }
            Value::Cells(values) => (CELL, [values.len(), 1], values.iter().flat_map(|v| v.element("")).collect()),
            Value::Struct(fields) => (STRUCT, [1, 1], fields_of(fields)),
        };
        let mut matrix = element(UINT32, &[class.to_le_bytes(), [0; 4]].concat());
        let size: Vec<u8> = size.iter().flat_map(|n| (*n as i32).to_le_bytes()).collect();
        matrix.extend(element(INT32, &size));
        matrix.extend(element(INT8, name.as_bytes()));
        matrix.extend(content);
        element(MATRIX, &matrix)
    }
}

fn fields_of(fields: &[(&'static str, Value)]) -> Vec<u8> {
    let mut names = Vec::new();
    for (name, _) in fields {
        names.extend_from_slice(name.as_bytes());
        names.resize(names.len().next_multiple_of(FIELD_NAME), 0);
    }
    let mut content = element(INT32, &(FIELD_NAME as i32).to_le_bytes());
    content.extend(element(INT8, &names));
    content.extend(fields.iter().flat_map(|(_, value)| value.element("")));
    content
}

/// Type, size and content, filled up to eight bytes; short content stands within the tag.
fn element(kind: u32, content: &[u8]) -> Vec<u8> {
    let size = content.len() as u32;
    let mut out = match size {
        1..=4 => (kind | size << 16).to_le_bytes().to_vec(),
        _ => [kind.to_le_bytes(), size.to_le_bytes()].concat(),
    };
    out.extend_from_slice(content);
    out.resize(out.len().next_multiple_of(8), 0);
    out
}

/// A MAT-file of one variable; `writer` names the program.
pub(super) fn file(writer: &str, variable: &str, value: &Value) -> Vec<u8> {
    let mut out = format!("MATLAB 5.0 MAT-file, Platform: any, Created by: {writer}").into_bytes();
    out.resize(116, b' ');
    out.extend_from_slice(&[0; 8]);
    out.extend_from_slice(&[0, 1, b'I', b'M']);
    out.extend(value.element(variable));
    out
}
