//! Value of a variable.

use crate::SkipReason;
use crate::finding::are_rounded;

/// A variable of a file, or a part of one.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Numbers(Array),
    /// The rows of an array of characters.
    Text(Vec<String>),
    Cell(Vec<Value>),
    Struct(Struct),
    /// An object whose content is in the hidden part of the file.
    Object(Reference),
    /// Numbers that were not asked for.
    Unread,
    /// Something that is no channel.
    Skip(SkipReason),
}

impl Value {
    pub(super) fn not_numeric(kind: &str) -> Self {
        Self::Skip(SkipReason::NotNumeric { kind: kind.into() })
    }

    pub(super) fn unsupported(detail: impl Into<String>) -> Self {
        Self::Skip(SkipReason::Unsupported { detail: detail.into() })
    }

    /// An array of these dimensions; `is_wide` where integers of 64 bits were stored.
    pub(super) fn array(dimensions: &[usize], values: Vec<f64>, is_wide: bool) -> Self {
        let array = Array::new(dimensions, values, is_wide).map(Self::Numbers);
        array.unwrap_or_else(|| Self::unsupported(format!("an array of {} dimensions", dimensions.len())))
    }

    /// The shape of an array that is not read.
    pub(super) fn shape(dimensions: &[usize]) -> Self {
        Self::array(dimensions, Vec::new(), false)
    }

    /// The shape of an array whose values are those of a dataset, by number.
    #[cfg(feature = "hdf5")]
    pub(super) fn place(dimensions: &[usize], dataset: usize) -> Self {
        match Self::shape(dimensions) {
            Self::Numbers(array) => Self::Numbers(Array { dataset: Some(dataset), ..array }),
            other => other,
        }
    }

    /// No numbers.
    pub(super) fn empty() -> Self {
        Self::array(&[0, 0], Vec::new(), false)
    }

    /// An object of MATLAB, of which the file keeps more than its numbers, in a form of its own.
    pub(super) fn object(class: &str) -> Self {
        Self::Skip(object_reason(class))
    }

    /// An object that this value of a variable refers to.
    pub(super) fn reference(class: String, value: &Self) -> Self {
        match referred(value) {
            Some(number) => Self::Object(Reference { class, number }),
            None => Self::object(&class),
        }
    }

    /// The only text here, blanks at its ends removed.
    pub(super) fn text(&self) -> Option<&str> {
        match self {
            Self::Text(rows) if rows.is_empty() => Some(""),
            Self::Text(rows) if rows.len() == 1 => Some(rows[0].trim()),
            Self::Cell(items) if items.len() == 1 => items[0].text(),
            _ => None,
        }
    }

    /// Text, one for each row or cell.
    pub(super) fn texts(&self) -> Option<Vec<&str>> {
        match self {
            Self::Text(rows) => Some(rows.iter().map(|row| row.trim()).collect()),
            Self::Cell(items) => items.iter().map(Self::text).collect(),
            _ => None,
        }
    }

    pub(super) fn scalar(&self) -> Option<f64> {
        match self {
            Self::Numbers(array) if array.values.len() == 1 => Some(array.values[0]),
            Self::Cell(items) if items.len() == 1 => items[0].scalar(),
            _ => None,
        }
    }
}

/// An object: its class, and its number among those of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reference {
    pub(super) class: String,
    pub(super) number: usize,
}

/// Real numbers, column by column.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Array {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// None where only the shape was asked for.
    pub(super) values: Vec<f64>,
    /// They were integers of 64 bits.
    pub(super) is_wide: bool,
    /// Where the values are that are not read yet: the number of a dataset.
    pub(super) dataset: Option<usize>,
}

impl Array {
    /// An array of these dimensions; `None` where more than two of them are not 1.
    fn new(dimensions: &[usize], values: Vec<f64>, is_wide: bool) -> Option<Self> {
        let (rows, columns) = match dimensions {
            [rows, columns] => (*rows, *columns),
            _ => {
                let long: Vec<usize> = dimensions.iter().copied().filter(|&d| d != 1).collect();
                match long.as_slice() {
                    [] => (1, 1),
                    [rows] => (*rows, 1),
                    [rows, columns] => (*rows, *columns),
                    _ => return None,
                }
            }
        };
        Some(Self { rows, columns, values, is_wide, dataset: None })
    }

    /// Returns true if integers in it were too large to be exact.
    pub(super) fn is_rounded(&self) -> bool {
        self.is_wide && are_rounded(&self.values)
    }

    /// How many numbers it has.
    pub(super) fn len(&self) -> usize {
        self.rows.saturating_mul(self.columns)
    }

    pub(super) fn is_vector(&self) -> bool {
        self.rows == 1 || self.columns == 1
    }

    /// Takes the columns off from the last to the first, and gives their memory back as it goes.
    pub(super) fn into_columns(self) -> Vec<Vec<f64>> {
        if self.is_vector() {
            return vec![self.values];
        }
        let mut rest = self.values;
        let column = |column: usize| {
            let last = rest.split_off((column * self.rows).min(rest.len()));
            rest.shrink_to_fit();
            last
        };
        let mut columns: Vec<Vec<f64>> = (0..self.columns).rev().map(column).collect();
        columns.reverse();
        columns
    }

    pub(super) fn into_rows(self) -> Vec<Vec<f64>> {
        (0..self.rows).map(|row| self.values.iter().skip(row).step_by(self.rows).copied().collect()).collect()
    }
}

/// An array of structs that have the same fields.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Struct {
    pub(super) fields: Vec<String>,
    /// For each struct the values of its fields.
    pub(super) elements: Vec<Vec<Value>>,
}

impl Struct {
    /// The field of the struct at `index`.
    pub(super) fn get(&self, index: usize, field: &str) -> Option<&Value> {
        let place = self.fields.iter().position(|f| f == field)?;
        self.elements.get(index)?.get(place)
    }
}

/// Why an object is no channel, and what to do.
pub(super) fn object_reason(class: &str) -> SkipReason {
    let remedy = match class {
        "timeseries" => "save t = ts.Time and y = ts.Data",
        "timetable" => "save t = seconds(tt.Properties.RowTimes - tt.Properties.RowTimes(1)) and y = tt.Variables",
        "Simulink.SimulationData.Dataset" => "save t = ds{1}.Values.Time and y = ds{1}.Values.Data of each signal",
        "Simulink.SimulationOutput" => "log as \"Structure with time\", and save what is logged",
        "table" => "save s = table2struct(tbl, 'ToScalar', true)",
        "iddata" => "save u = z.InputData, y = z.OutputData and Ts = z.Ts",
        "string" => "save it as char(s)",
        "datetime" => "save seconds(d - d(1))",
        "duration" => "save seconds(d)",
        "categorical" => "save double(c)",
        _ => "save its arrays, or a struct of them",
    };
    let detail = format!("an object of class \"{}\"; {remedy}", class.escape_debug());
    SkipReason::Unsupported { detail }
}

/// The most structs and cells within each other.
pub(super) const MAX_DEPTH: usize = 20;
/// The most variables, cells, fields and lines of text in a file.
pub(super) const MAX_PARTS: usize = 1 << 18;
/// The most numbers of a file.
pub(super) const MAX_NUMBERS: usize = 1 << 26;
/// The most characters of text that are kept; longer text is no name, unit or comment.
pub(super) const MAX_TEXT: usize = 1 << 16;

/// The rows of a character array of `rows` rows, which is stored column by column.
pub(super) fn text_rows(rows: usize, characters: &[char]) -> Value {
    if characters.len() > MAX_TEXT {
        return Value::not_numeric("text");
    }
    if rows <= 1 {
        return Value::Text(vec![characters.iter().collect()]);
    }
    let row = |r: usize| characters.iter().skip(r).step_by(rows).collect::<String>().trim_end().to_owned();
    Value::Text((0..rows.min(characters.len())).map(row).collect())
}

/// The number that numbers of objects follow.
const MARK: f64 = 0xDD00_0000_u32 as f64;
/// The number of the one object that an array refers to: the mark, how many dimensions and which, the numbers of the
/// objects, and that of their class.
pub(super) fn referred(value: &Value) -> Option<usize> {
    let Value::Numbers(array) = value else { return None };
    match array.values.as_slice() {
        [MARK, 2.0, 1.0, 1.0, object, _] => Some(*object as usize),
        _ => None,
    }
}
