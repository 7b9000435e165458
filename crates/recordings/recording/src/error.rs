//! Why a file cannot be read or written.

use thiserror::Error;

use crate::SkipReason;

/// Why a file cannot be read or written. `file` is the name that was passed in.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// There are no bytes.
    #[error("{file}: the file is empty; copy it again from the measurement computer")]
    Empty {
        /// The file.
        file: String,
    },
    /// The content is no format that can be read.
    #[error(
        "{file}: not a format that can be read (it starts with \"{start}\"); export the measurement as MDF 4 or CSV"
    )]
    UnknownFormat {
        /// The file.
        file: String,
        /// Its first bytes.
        start: String,
    },
    /// The bytes of the file cannot be had.
    #[error("{file}: byte {offset} cannot be read: {detail}")]
    Unreadable {
        /// The file.
        file: String,
        /// Where.
        offset: u64,
        /// Message of the system.
        detail: String,
    },
    /// The output cannot be written: a disk is full, a connection closed.
    #[error("it cannot be written: {detail}")]
    Unwritable {
        /// Kind of the system's error.
        kind: std::io::ErrorKind,
        /// And in words.
        detail: String,
    },
    /// The time between rows that was passed in is none.
    #[error("a sample time of {given} s was given; it has to be a positive number")]
    RowDistance {
        /// Value that was given, s.
        given: String,
    },
    /// The MDF version is not known.
    #[error("{file}: MDF version {version} is not supported; export the measurement as MDF 4.10")]
    UnsupportedVersion {
        /// The file.
        file: String,
        /// The version as stored.
        version: String,
    },
    /// The file ends too early.
    #[error(
        "{file}: the file ends too early: {expected} bytes are needed at byte {offset}, {available} are there; \
         copy the file again, or open it in the recording software and save it anew"
    )]
    Truncated {
        /// The file.
        file: String,
        /// Where the missing part begins.
        offset: u64,
        /// Bytes that should be there.
        expected: u64,
        /// Bytes that are there.
        available: u64,
    },
    /// The structure contradicts itself.
    #[error(
        "{file}: the file is damaged{}: {detail}; copy the file again, or open it in the recording software and save it anew",
        offset.map(|o| format!(" at byte {o}")).unwrap_or_default()
    )]
    Damaged {
        /// The file.
        file: String,
        /// Where, if known.
        offset: Option<u64>,
        /// Description of the damage.
        detail: String,
    },
    /// The file is whole, as far as it is known, and larger than the memory.
    #[error(
        "{file}: {what} do not fit in the memory of this computer; choose fewer channels, take a computer with more memory, or record \
         in shorter files"
    )]
    TooLarge {
        /// The file.
        file: String,
        /// How much it holds.
        what: String,
    },
    /// The file says that it holds more numbers than are read of one of its size.
    #[error(
        "{file}: it announces {what}; it is damaged, or it holds little but repeated values: copy the file again, or \
         save the stretch that matters as a file of its own"
    )]
    Implausible {
        /// The file.
        file: String,
        /// How much it announces.
        what: String,
    },
    /// A group of HDF5 holds a soft link, in the layout in which it looks like a dataset.
    #[error(
        "{file}: a soft link of HDF5 in the layout before version 1.8 cannot be read; write the file with libver=\"v110\", \
         or without soft links"
    )]
    SoftLink {
        /// The file.
        file: String,
    },
    /// The samples of one channel cannot be decoded.
    #[error("{file}: channel \"{channel}\" cannot be decoded: {detail}; copy the file again, or leave the channel out")]
    DamagedChannel {
        /// The file.
        file: String,
        /// The channel.
        channel: String,
        /// Description of the damage.
        detail: String,
    },
    /// The file uses a feature of its format that cannot be read.
    #[error("{file}: {feature} cannot be read; open the file in the recording software and save it as MDF 4.10")]
    Unsupported {
        /// The file.
        file: String,
        /// The feature.
        feature: String,
    },
    /// The reader of the format is left out of this build.
    #[error(
        "{file}: this build of dynoid reads no {format}; build it with the feature `{feature}`, or save the file as MDF 4 or CSV"
    )]
    LeftOut {
        /// The file.
        file: String,
        /// The format.
        format: String,
        /// The feature of the build that has the reader.
        feature: &'static str,
    },
    /// A channel that was asked for is not in the file.
    #[error("{file}: there is no channel \"{channel}\"{}", the_closest(similar))]
    NoSuchChannel {
        /// The file.
        file: String,
        /// The name that was asked for.
        channel: String,
        /// The names in the file that are closest to it.
        similar: Vec<String>,
    },
    /// A channel that was asked for cannot be had as numbers over time.
    #[error("{file}: channel \"{channel}\" cannot be used: {reason}")]
    UnusableChannel {
        /// The file.
        file: String,
        /// The channel.
        channel: String,
        /// Why.
        reason: SkipReason,
    },
    /// A text file is not understood.
    #[error("{file}, line {line}{}: {problem}", column.map(|c| format!(", column {c}")).unwrap_or_default())]
    Csv {
        /// The file.
        file: String,
        /// Line number, from 1.
        line: u64,
        /// Column number, from 1.
        column: Option<usize>,
        /// Problem of the line.
        problem: CsvProblem,
    },
    /// No column of a table is time.
    #[error(
        "{file}: no column is recognised as time (the first is \"{first}\"); name one \"time\", or make the index a column \
         of time stamps"
    )]
    NoTimeColumn {
        /// The file.
        file: String,
        /// Its first column.
        first: String,
    },
    /// A recording to be written names a raster it does not have.
    #[error("channel \"{channel}\" refers to raster {raster}, the recording has {rasters}")]
    NoSuchRaster {
        /// The channel.
        channel: String,
        /// Its raster.
        raster: usize,
        /// How many there are.
        rasters: usize,
    },
    /// A channel to be written does not have one sample per time stamp.
    #[error("channel \"{channel}\" has {samples} samples on {times} time stamps")]
    LengthMismatch {
        /// The channel.
        channel: String,
        /// Its samples.
        samples: usize,
        /// Time stamps of its raster.
        times: usize,
    },
    /// The format to be written cannot express this.
    #[error("{what} of \"{name}\" cannot be written to {format}")]
    CannotExpress {
        /// The format.
        format: String,
        /// Name of the channel or raster.
        name: String,
        /// Property that cannot be expressed.
        what: String,
    },
}

/// Problem in a line of a text file.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum CsvProblem {
    /// Not a table.
    #[error("no commas, semicolons or tabs that would separate columns")]
    NoDelimiter,
    /// No line of numbers.
    #[error("no line of numbers follows; the file holds no samples")]
    NoData,
    /// The first line is numbers.
    #[error("the columns have no names; add a first line such as \"time [s];speed [rpm]\"")]
    NoHeader,
    /// No column is time.
    #[error(
        "no column is recognised as time (the first is \"{name}\"); name one \"time\" and give its unit, as in \"time [s]\"",
        name = beginning(.name)
    )]
    NoTime {
        /// The first name.
        name: String,
    },
    /// A time column in a unit that is not known.
    #[error("time in \"{unit}\" is not understood; use s, ms, us, ns, min, h or d", unit = beginning(.unit))]
    TimeUnit {
        /// The unit.
        unit: String,
    },
    /// A column that is named as time and is not clearly a clock or a channel.
    #[error(
        "\"{name}\" may be the clock of columns that follow it, or a channel on the clock \"{clock}\"; if it is a clock, call \
         it \"{clock}\" too and put its columns right behind it, if it is a channel, add \"_channel\" to its \
         name",
        name = beginning(.name), clock = beginning(.clock)
    )]
    ClockOrChannel {
        /// Its heading.
        name: String,
        /// The heading of the clock.
        clock: String,
    },
    /// A time column whose name and unit row say different units.
    #[error(
        "the name says that time is in \"{name}\", the row of units says \"{below}\"; correct the one that is wrong, or leave \
         it out",
        name = beginning(.name), below = beginning(.below)
    )]
    TwoTimeUnits {
        /// The unit in the name.
        name: String,
        /// The unit below it.
        below: String,
    },
    /// A column holds values but has no name.
    #[error("the column has no name, and does not just count the rows; name it in the heading")]
    NoName,
    /// A cell is not a number.
    #[error("\"{text}\" is not a number", text = beginning(.text))]
    NotANumber {
        /// The cell.
        text: String,
    },
    /// A number is larger than a double can be.
    #[error(
        "\"{text}\" is beyond the numbers that a double holds, up to 1.8e308; correct it, or leave the cell empty",
        text = beginning(.text)
    )]
    TooLarge {
        /// The cell.
        text: String,
    },
    /// Decimal commas and points in one file.
    #[error("\"{text}\" has another decimal sign than the numbers before it", text = beginning(.text))]
    MixedDecimalSigns {
        /// The cell.
        text: String,
    },
    /// Digits are grouped in thousands.
    #[error(
        "\"{text}\" has its digits grouped in thousands; export the numbers without a separator of thousands",
        text = beginning(.text)
    )]
    GroupedDigits {
        /// The cell.
        text: String,
    },
    /// Every number with a decimal sign may be one with its digits grouped in thousands.
    #[error(
        "\"{text}\" may be a number with three decimals, or a number with a separator of thousands; export the numbers \
         with another number of decimals",
        text = beginning(.text)
    )]
    AmbiguousSign {
        /// The first such cell.
        text: String,
    },
    /// A time stamp is not understood.
    #[error(
        "\"{text}\" is not understood as time; write seconds as a number, or stamps as h:mm:ss.fff or \
         2026-11-21T12:34:56.789, all of a file alike",
        text = beginning(.text)
    )]
    NotATime {
        /// The cell.
        text: String,
    },
    /// A date that has two readings.
    #[error(
        "it is unknown which number of the date \"{text}\" is the day; write it as 2026-11-21",
        text = beginning(.text)
    )]
    AmbiguousDate {
        /// The cell.
        text: String,
    },
    /// A line is too short or too long.
    #[error(
        "the line has {found} columns, the header has {expected}; if commas are decimal signs too, export with semicolons \
         between the columns"
    )]
    ColumnCount {
        /// Columns of this line.
        found: usize,
        /// Columns of the header.
        expected: usize,
    },
    /// Values without a time stamp.
    #[error("there are values but no time stamp")]
    NoTimeStamp,
    /// A raster goes on after empty lines.
    #[error("values follow after empty cells; a shorter block of columns may only be empty to its end")]
    Gap,
}

/// The beginning of what a file says, which may be as long as the file.
fn beginning(text: &str) -> String {
    const MOST: usize = 80;
    let end = text.char_indices().nth(MOST).map(|(at, _)| at);
    end.map_or_else(|| text.to_owned(), |end| format!("{}…", &text[..end]))
}

fn the_closest(similar: &[String]) -> String {
    match similar {
        [] => String::from("; list the file's channels and correct the name"),
        [one] => format!("; did you mean \"{one}\"?"),
        several => {
            let names: Vec<_> = several.iter().map(|n| format!("\"{n}\"")).collect();
            format!("; the closest names are {}", names.join(", "))
        }
    }
}

/// End of what is said of a file that holds more numbers than are read of one of its size.
#[cfg(any(feature = "hdf5", feature = "parquet", test))]
pub(crate) const IMPLAUSIBLE: &str = "more numbers than its size makes plausible";

/// Fails where the memory has no room for so many bytes: a decoder of another library would end the program there.
#[cfg(any(feature = "hdf5", feature = "parquet"))]
pub(crate) fn check_room(bytes: usize) -> Result<(), String> {
    Vec::<u8>::new().try_reserve_exact(bytes).map_err(|error| error.to_string())
}

/// A fault in the content of a file, which is none where it only takes more memory than there is.
pub(crate) fn of_content(file: &str, offset: Option<u64>, detail: String) -> RecordingError {
    let file = file.to_owned();
    match lacks_memory(&detail) {
        true => RecordingError::TooLarge { file, what: "its numbers".to_owned() },
        false => RecordingError::Damaged { file, offset, detail },
    }
}

/// Tells whether a fault is that there is no more memory, as the standard library says it of a vector that cannot grow.
fn lacks_memory(detail: &str) -> bool {
    detail.contains("memory allocation failed")
}

/// A fault in the samples of a channel, which is none where they only take more memory than there is.
#[cfg(feature = "parquet")]
pub(crate) fn of_channel(file: &str, channel: String, detail: String) -> RecordingError {
    let file = file.to_owned();
    match lacks_memory(&detail) {
        true => RecordingError::TooLarge { file, what: format!("the numbers of \"{channel}\"") },
        false => RecordingError::DamagedChannel { file, channel, detail },
    }
}

/// Runs a decoder of another library. Where it panics, the file is to blame: the panic ends here, as an error.
#[cfg(any(feature = "hdf5", feature = "parquet", test))]
pub(crate) fn guarded<T>(file: &str, decode: impl FnOnce() -> Result<T, RecordingError>) -> Result<T, RecordingError> {
    work::guarded(decode).unwrap_or_else(|| {
        let detail = "its content contradicts itself".into();
        Err(RecordingError::Damaged { file: file.into(), offset: None, detail })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_what_does_not_fit_in_memory_is_not_called_damaged() {
        let no_memory = Vec::<f64>::new().try_reserve_exact(usize::MAX / 16).unwrap_err();
        let said = of_content("run.mat", Some(128), no_memory.to_string()).to_string();
        assert!(said.contains("run.mat") && said.contains("do not fit in the memory"), "{said}");
        assert!(of_content("run.mat", Some(128), "a tag".into()).to_string().contains("damaged at byte 128"));
    }

    #[test]
    fn regress_messages_show_the_beginning_of_a_long_cell() {
        let said = CsvProblem::NotANumber { text: "9x".repeat(500_000) }.to_string();
        assert!(
            said.starts_with("\"9x9x") && said.ends_with("…\" is not a number") && said.len() < 120,
            "{}",
            said.len()
        );
        assert_eq!(CsvProblem::NotANumber { text: "9x".into() }.to_string(), "\"9x\" is not a number");
    }

    /// The hook of the process is that of the program: what it reports is not for a library to decide.
    #[test]
    fn regress_a_panic_of_a_decoder_is_an_error() {
        let error = guarded::<()>("a", || panic!("of a library")).unwrap_err();
        assert!(matches!(error, RecordingError::Damaged { .. }), "{error}");
        assert_eq!(guarded("a", || Ok(1)), Ok(1));
    }
}
