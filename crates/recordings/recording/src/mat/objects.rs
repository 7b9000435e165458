//! Tables, timetables, and clocks that are durations or dates: objects, of which a variable holds a number only, while
//! what they consist of is in a hidden part of the file.
//!
//! MATLAB does not publish that part. This follows what the documentation of MatFileHandler
//! (<https://github.com/mahalex/MatFileHandler>, `Objects.md`) and of mat-io (<https://github.com/foreverallama/matio>,
//! `docs`) have in common: a list of contents, the first of which are bytes that connect objects with their classes,
//! properties and contents. What does not fit that is not read, and said.

use super::labels::{Factor, clock_unit, is_plain_time};
use super::scope::{element, joined};
use super::value::{Reference, Struct, Value, referred};
use super::wanted::Wanted;
use crate::{SkipReason, StartTime};

/// Contents before those that properties refer to.
const FIRST: usize = 2;

/// Returns true if objects of this class are read, times only as clocks.
pub(super) fn is_read(class: &str) -> bool {
    matches!(class, "table" | "timetable") || is_time(class)
}

fn is_time(class: &str) -> bool {
    matches!(class, "duration" | "datetime")
}

/// Puts tables in the place of what refers to them, and says of others why they are not read. Where time stamps have a
/// date, returns what they count from.
pub(super) fn resolve<'a>(
    variables: &mut [(String, Value)],
    wanted: &Wanted<'_>,
    open: impl FnOnce() -> Result<Objects<'a>, String>,
) -> Option<StartTime> {
    let mut found = Vec::new();
    for (name, value) in variables {
        find(name, value, &mut found);
    }
    if found.is_empty() {
        return None;
    }
    let mut open = Some(open);
    let mut objects = None;
    for (path, value) in found {
        let Value::Object(Reference { class, number }) = value else { continue };
        let name = path.rsplit('.').next().unwrap_or_default();
        let unit = clock_unit(name).filter(|_| is_time(class));
        if is_time(class) && unit.is_none() {
            *value = Value::object(class);
            continue;
        }
        if unit.is_none() && !wanted.reaches_into(&path) {
            *value = Value::Unread;
            continue;
        }
        if let Some(open) = open.take() {
            objects = Some(open());
        }
        let read = match (&mut objects, unit) {
            (Some(Ok(objects)), Some(unit)) => objects.clock(*number, unit),
            (Some(Ok(objects)), None) => objects.table(*number),
            (Some(Err(detail)), _) => Err(detail.clone()),
            (None, _) => continue,
        };
        *value = read.unwrap_or_else(|detail| unreadable(class, &detail));
    }
    objects?.ok()?.origin?.start_time()
}

/// The objects in a value, with their paths.
fn find<'v>(path: &str, value: &'v mut Value, found: &mut Vec<(String, &'v mut Value)>) {
    match value {
        Value::Object(_) => found.push((path.to_owned(), value)),
        Value::Cell(items) => {
            items.iter_mut().enumerate().for_each(|(i, item)| find(&format!("{path}{{{}}}", i + 1), item, found));
        }
        Value::Struct(Struct { fields, elements }) => {
            let count = elements.len();
            for (index, values) in elements.iter_mut().enumerate() {
                let path = element(path, index, count);
                fields.iter().zip(values).for_each(|(field, value)| find(&joined(&path, field), value, found));
            }
        }
        _ => {}
    }
}

fn unreadable(class: &str, detail: &str) -> Value {
    match Value::object(class) {
        Value::Skip(SkipReason::Unsupported { detail: remedy }) => {
            Value::unsupported(format!("{remedy} (it cannot be read: {detail})"))
        }
        other => other,
    }
}

/// The objects of a file.
pub(super) struct Objects<'a> {
    links: Links,
    /// The content of this number.
    content: Box<dyn FnMut(usize) -> Result<Value, String> + 'a>,
    /// Origin of time stamps with a date.
    origin: Option<Origin>,
}

/// A date and time that others count from.
#[derive(Debug, Clone, Copy)]
struct Origin {
    /// Milliseconds since 1970, of Greenwich or on a clock nothing is said of.
    milliseconds: f64,
    is_local: bool,
}

impl Origin {
    fn start_time(self) -> Option<StartTime> {
        // Whole ones by themselves: a number holds no nanoseconds since 1970.
        let whole = self.milliseconds.floor();
        let rest = ((self.milliseconds - whole) * 1e6).round();
        let nanoseconds = (whole as i64).checked_mul(1_000_000)?.checked_add(rest as i64)?;
        Some(StartTime { nanoseconds, is_local: self.is_local, utc_offset_min: None })
    }
}

/// The columns of a table, as fields of a struct with their units.
#[derive(Default)]
struct Columns {
    fields: Vec<String>,
    values: Vec<Value>,
}

impl Columns {
    fn push(&mut self, name: &str, value: Value) {
        self.fields.push(name.to_owned());
        self.values.push(value);
    }
}

type Properties = Vec<(String, usize)>;

impl<'a> Objects<'a> {
    /// The objects that `links` connects with contents, in this order of bytes.
    pub(super) fn new(
        links: Vec<u8>,
        big: bool,
        content: impl FnMut(usize) -> Result<Value, String> + 'a,
    ) -> Result<Self, String> {
        Ok(Self { links: Links::new(links, big)?, content: Box::new(content), origin: None })
    }

    fn table(&mut self, number: usize) -> Result<Value, String> {
        let (class, properties) = self.links.object(number)?;
        match class.as_str() {
            "timetable" => {
                let mut content = self.property(&properties, "any")?;
                let data = take(&mut content, "data")?;
                let times = self.row_times(field(&content, "rowTimes")?, field(&content, "numRows")?)?;
                let longer = longer_names(&content, "useVarNames2048", "varNames2048");
                let names = longer.map_or_else(|| field(&content, "varNames"), Ok)?;
                self.columns(Some(times), names, field(&content, "varUnits").ok(), data)
            }
            "table" => {
                let about = self.property(&properties, "props")?;
                let longer = longer_names(&about, "useVariableNames2048", "VariableNames2048").cloned();
                let names = longer.map_or_else(|| self.property(&properties, "varnames"), Ok)?;
                let data = self.property(&properties, "data")?;
                self.columns(None, &names, field(&about, "VariableUnits").ok(), data)
            }
            other => Err(format!("it is an object of class \"{}\"", other.escape_debug())),
        }
    }

    fn property(&mut self, properties: &Properties, name: &str) -> Result<Value, String> {
        let found = properties.iter().find(|(property, _)| property == name);
        let (_, content) = found.ok_or_else(|| format!("it has no \"{name}\""))?;
        (self.content)(content.saturating_add(FIRST))
    }

    /// A struct of the columns, which the scope that it becomes finds its clock in.
    fn columns(
        &mut self,
        times: Option<Vec<f64>>,
        names: &Value,
        units: Option<&Value>,
        data: Value,
    ) -> Result<Value, String> {
        let Value::Cell(data) = data else { return Err("its columns are in no cell".into()) };
        let names = names.texts().filter(|names| names.len() == data.len()).ok_or("its columns have no names")?;
        let units = units.and_then(Value::texts).unwrap_or_default();
        let mut columns = Columns::default();
        let mut dated = Vec::new();
        if let Some(times) = times {
            columns.push("Time", in_unit(times, (1.0, 1.0)));
        }
        for (place, (name, value)) in names.iter().zip(data).enumerate() {
            let value = match self.times(&value)? {
                None => value,
                Some(Err(class)) => Value::object(&class),
                Some(Ok(times)) => {
                    dated.push(columns.fields.len());
                    in_unit(times, clock_unit(name).unwrap_or((1.0, 1.0)))
                }
            };
            columns.push(name, value);
            if let Some(unit) = units.get(place).filter(|unit| !unit.is_empty()) {
                columns.push(&format!("{name}_unit"), Value::Text(vec![(*unit).to_owned()]));
            }
        }
        // The only column of times is the clock, whatever its name.
        if let (&[clock], false) = (dated.as_slice(), columns.fields.iter().any(|name| is_plain_time(name)))
            && clock_unit(&columns.fields[clock]).is_none()
        {
            columns.fields[clock] = "Time".into();
        }
        Ok(Value::Struct(Struct { fields: columns.fields, elements: vec![columns.values] }))
    }

    /// The time stamps of a timetable, s: times, or what they are counted from and by.
    fn row_times(&mut self, value: &Value, rows: &Value) -> Result<Vec<f64>, String> {
        if let Some(times) = self.times(value)? {
            return times.map_err(|class| format!("its times are objects of class \"{}\"", class.escape_debug()));
        }
        let part = |name: &str| field(value, name);
        let number = |value: &Value| value.scalar().ok_or("its times are not understood");
        let mut one = |value: &Value| match self.times(value)? {
            Some(Ok(times)) if times.len() == 1 => Ok(times[0]),
            _ => Err("its times are not counted in equal steps".to_owned()),
        };
        let start_s = one(part("origin")?)?;
        let is_rate = number(part("specifiedAsRate")?)? != 0.0;
        let rows = number(rows)?;
        if !(0.0..1e10).contains(&rows) {
            return Err(format!("it has {rows} rows"));
        }
        let rows = 0..rows as usize;
        if is_rate {
            let rate_hz = number(part("sampleRate")?)?;
            return Ok(rows.map(|row| start_s + row as f64 / rate_hz).collect());
        }
        let step_s = one(part("stepSize")?)?;
        Ok(rows.map(|row| start_s + row as f64 * step_s).collect())
    }

    /// Durations or dates in s, where a value refers to such; the class, where it refers to something else.
    fn times(&mut self, value: &Value) -> Result<Option<Result<Vec<f64>, String>>, String> {
        referred(value).map(|number| self.times_of(number)).transpose()
    }

    fn clock(&mut self, number: usize, unit: Factor) -> Result<Value, String> {
        let times = self.times_of(number)?;
        Ok(in_unit(times.map_err(|class| format!("it is an object of class \"{}\"", class.escape_debug()))?, unit))
    }

    /// Durations or dates in s; the class, where the object is something else.
    fn times_of(&mut self, number: usize) -> Result<Result<Vec<f64>, String>, String> {
        let (class, properties) = self.links.object(number)?;
        let name = match class.as_str() {
            "duration" => "millis",
            "datetime" => "data",
            _ => return Ok(Err(class)),
        };
        let Value::Numbers(array) = self.property(&properties, name)? else {
            return Err("its times are finer than milliseconds".into());
        };
        let mut milliseconds = array.values;
        if class == "datetime" {
            let zone = self.property(&properties, "tz").ok();
            let is_local = zone.as_ref().and_then(Value::text).is_none_or(str::is_empty);
            let first = milliseconds.iter().copied().find(|t| t.is_finite());
            let from = *self.origin.get_or_insert(Origin { milliseconds: first.unwrap_or(0.0), is_local });
            if from.is_local != is_local {
                return Err("its times have a time zone, and those of another table have none".into());
            }
            milliseconds.iter_mut().for_each(|t| *t -= from.milliseconds);
        }
        Ok(Ok(milliseconds.into_iter().map(|t| t / 1e3).collect()))
    }
}

/// Times, s, in the unit that they will be read in: that which the name of their clock gives.
fn in_unit(mut times: Vec<f64>, (numerator, denominator): Factor) -> Value {
    times.iter_mut().for_each(|t| *t = *t * denominator / numerator);
    Value::array(&[times.len(), 1], times, false)
}

/// A field of a single struct.
fn field<'v>(value: &'v Value, name: &str) -> Result<&'v Value, String> {
    let found = match value {
        Value::Struct(structs) => structs.get(0, name),
        _ => None,
    };
    found.ok_or_else(|| format!("it has no \"{name}\""))
}

/// Takes a field out of a single struct.
fn take(value: &mut Value, name: &str) -> Result<Value, String> {
    let place = match value {
        Value::Struct(Struct { fields, elements }) => {
            let place = fields.iter().position(|field| field == name);
            elements.first_mut().zip(place).and_then(|(values, place)| values.get_mut(place))
        }
        _ => None,
    };
    place.map(|place| std::mem::replace(place, Value::Unread)).ok_or_else(|| format!("it has no \"{name}\""))
}

/// The names of columns where a newer MATLAB keeps those that older ones find too long.
fn longer_names<'v>(value: &'v Value, flag: &str, names: &str) -> Option<&'v Value> {
    let is_used = field(value, flag).ok()?.scalar()? != 0.0;
    field(value, names).ok().filter(|_| is_used)
}

/// Connections of objects with their classes, properties and contents: a header, names, and four tables. Entries of all
/// tables are counted from 1, after one that is empty.
struct Links {
    bytes: Vec<u8>,
    big: bool,
    names: Vec<String>,
    /// Where classes, properties of one kind, objects, and properties of the other kind begin, and where these end.
    tables: [usize; 5],
}

impl Links {
    fn new(bytes: Vec<u8>, big: bool) -> Result<Self, String> {
        const HEADER: usize = 40;
        let mut links = Self { bytes, big, names: Vec::new(), tables: [0; 5] };
        let version = links.number(0)?;
        if !(2..=4).contains(&version) {
            return Err(format!("its form has the version {version}"));
        }
        for place in 0..links.tables.len() {
            links.tables[place] = links.number(8 + 4 * place)?;
        }
        let names = links.bytes.get(HEADER..links.tables[0]).ok_or("its names are missing")?;
        let name = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        links.names = names.split(|byte| *byte == 0).map(name).collect();
        Ok(links)
    }

    /// The number at a place.
    fn number(&self, place: usize) -> Result<usize, String> {
        let bytes = self.bytes.get(place..).and_then(|rest| rest.first_chunk::<4>());
        let bytes = *bytes.ok_or("what connects its parts ends too early")?;
        Ok(if self.big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) } as usize)
    }

    /// The number at a place in an entry of a table whose entries have so many numbers.
    fn entry(&self, table: usize, entry: usize, numbers: usize, place: usize) -> Result<usize, String> {
        let at = self.tables[table] + 4 * (entry.saturating_mul(numbers).saturating_add(place));
        if entry == 0 || at >= self.tables[table + 1] {
            return Err("what connects its parts ends too early".into());
        }
        self.number(at)
    }

    /// The name of this number; names are counted from 1.
    fn name(&self, number: usize) -> Result<String, String> {
        let name = number.checked_sub(1).and_then(|place| self.names.get(place));
        name.cloned().ok_or_else(|| "it has a part without a name".into())
    }

    /// Class and properties of an object.
    fn object(&self, number: usize) -> Result<(String, Properties), String> {
        let [class, as_saved, plain] = [0, 3, 4].map(|place| self.entry(2, number, 6, place));
        let class = self.name(self.entry(0, class?, 4, 1)?)?;
        let properties = match (as_saved?, plain?) {
            (0, plain) => self.properties(3, plain)?,
            // What the class makes of itself to be saved.
            (as_saved, _) => self.properties(1, as_saved)?,
        };
        Ok((class, properties))
    }

    /// The properties with content: entries of how many there are, and of each its name, what it is, and the content.
    fn properties(&self, table: usize, entry: usize) -> Result<Properties, String> {
        const WITH_CONTENT: usize = 1;
        let mut at = self.tables[table];
        for _ in 0..entry {
            let numbers = 1 + 3 * self.number(at)?;
            at += (4 * numbers).next_multiple_of(8);
        }
        if at >= self.tables[table + 1] {
            return Err("what connects its parts ends too early".into());
        }
        let mut properties = Vec::new();
        for property in 0..self.number(at)? {
            let [name, kind, content] = [4, 8, 12].map(|place| self.number(at + 12 * property + place));
            if kind? == WITH_CONTENT {
                properties.push((self.name(name?)?, content?));
            }
        }
        Ok(properties)
    }
}
