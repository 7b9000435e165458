//! Rules for every reader of measurement files, whatever the format: [`conform`] runs the whole list.
//!
//! A reader is given as a function from bytes to [`Content`], so that the suite knows no reader's types. The functions
//! panic (as assertions do) with the input that broke the rule.

/// Content of the input as a reader gives it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Content {
    /// The time stamps of each clock.
    pub clocks: Vec<Vec<f64>>,
    /// The channels in order.
    pub channels: Vec<Signal>,
    /// True if the reader said that samples are or may be missing.
    pub reports_loss: bool,
}

/// A channel as a reader gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Its name.
    pub name: String,
    /// Index into [`Content::clocks`].
    pub clock: usize,
    /// Its samples.
    pub samples: Vec<f64>,
}

impl Content {
    /// Equal in every time stamp and sample; NaN equals NaN.
    #[must_use]
    pub fn same_data(&self, other: &Self) -> bool {
        let equal = |a: &[f64], b: &[f64]| {
            a.len() == b.len() && a.iter().zip(b).all(|(x, y)| x == y || (x.is_nan() && y.is_nan()))
        };
        self.clocks.len() == other.clocks.len()
            && self.channels.len() == other.channels.len()
            && self.clocks.iter().zip(&other.clocks).all(|(a, b)| equal(a, b))
            && self
                .channels
                .iter()
                .zip(&other.channels)
                .all(|(a, b)| a.name == b.name && a.clock == b.clock && equal(&a.samples, &b.samples))
    }

    /// Numbers held in memory.
    #[must_use]
    pub fn numbers(&self) -> usize {
        let clocks: usize = self.clocks.iter().map(Vec::len).sum();
        clocks + self.channels.iter().map(|c| c.samples.len()).sum::<usize>()
    }

    /// Every channel has a clock, and one sample for each of its time stamps.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        self.channels.iter().all(|c| {
            let clock = self.clocks.get(c.clock);
            clock.is_some_and(|clock| clock.len() == c.samples.len())
        })
    }
}

/// A reader with files of its format. The small files are read thousands of times: a few kilobytes at most.
pub struct Case<'a, Read> {
    /// The reader under test: content, or the text of its error.
    pub read: Read,
    /// A small file.
    pub small: &'a [u8],
    /// A small file with two channels of the same name and different samples.
    pub duplicates: &'a [u8],
    /// A small file with two channels on clocks of different length.
    pub mixed_rates: &'a [u8],
    /// Lengths of `small` at which a cut cannot be recognised from the content, as after a line of a text file.
    pub unrecognisable_cuts: Vec<usize>,
    /// Most numbers that a byte of input may turn into.
    pub numbers_per_byte: usize,
}

/// Runs every rule.
///
/// # Panics
///
/// Where the reader breaks one.
pub fn conform<Read: Fn(&[u8]) -> Result<Content, String>>(case: &Case<'_, Read>) {
    reads_the_samples(case);
    refuses_empty_input(case);
    refuses_a_wrong_magic(case);
    reports_every_truncation(case);
    survives_every_corrupted_byte(case);
    keeps_duplicate_names(case);
    keeps_mixed_rates(case);
}

/// The undamaged file is read, consistent, and without a report of loss.
///
/// # Panics
///
/// Where it is not.
pub fn reads_the_samples<Read: Fn(&[u8]) -> Result<Content, String>>(case: &Case<'_, Read>) {
    let content = (case.read)(case.small);
    let good = |c: &Content| c.is_consistent() && c.numbers() > 0 && !c.reports_loss;
    assert!(content.as_ref().is_ok_and(good), "undamaged file: {content:?}");
}

/// No bytes are an error, with a text.
///
/// # Panics
///
/// Where they are not.
pub fn refuses_empty_input<Read: Fn(&[u8]) -> Result<Content, String>>(case: &Case<'_, Read>) {
    let content = (case.read)(&[]);
    assert!(content.as_ref().is_err_and(|e| !e.is_empty()), "empty input: {content:?}");
}

/// Bytes of no known format are an error.
///
/// # Panics
///
/// Where they are not.
pub fn refuses_a_wrong_magic<Read: Fn(&[u8]) -> Result<Content, String>>(case: &Case<'_, Read>) {
    for magic in [&b"\x00\x01\x02\x03"[..], b"\x89HDF\r\n\x1a\n", b"PAR1\x15\x04", b"\x7fELF"] {
        let mut bytes = magic.to_vec();
        bytes.extend_from_slice(case.small);
        let content = (case.read)(&bytes);
        assert!(content.is_err(), "wrong magic {magic:?}: {content:?}");
    }
}

/// A file cut at any length is an error, has lost no sample, or says that samples are missing.
///
/// # Panics
///
/// Where samples are missing silently.
pub fn reports_every_truncation<Read: Fn(&[u8]) -> Result<Content, String>>(case: &Case<'_, Read>) {
    let Ok(whole) = (case.read)(case.small) else {
        return;
    };
    for length in 0..case.small.len() {
        let Ok(content) = (case.read)(&case.small[..length]) else {
            continue;
        };
        assert!(content.is_consistent(), "cut at {length}: {content:?}");
        let silent = !content.reports_loss && !content.same_data(&whole);
        let excused = case.unrecognisable_cuts.contains(&length);
        assert!(!silent || excused, "cut at {length} of {}: samples missing silently", case.small.len());
    }
}

/// No corrupted byte makes the reader panic, return inconsistent data, or more data than the bytes can hold.
///
/// # Panics
///
/// Where one does.
pub fn survives_every_corrupted_byte<Read: Fn(&[u8]) -> Result<Content, String>>(case: &Case<'_, Read>) {
    let most = case.small.len() * case.numbers_per_byte;
    let mut bytes = case.small.to_vec();
    for at in 0..bytes.len() {
        let original = bytes[at];
        for value in [0x00, 0x01, 0x7F, 0x80, 0xFF, original ^ 0x01, original ^ 0x20, original.wrapping_add(8)] {
            bytes[at] = value;
            let Ok(content) = (case.read)(&bytes) else {
                continue;
            };
            assert!(content.is_consistent(), "byte {at} set to {value:#x}: {content:?}");
            assert!(content.numbers() <= most, "byte {at} set to {value:#x}: {} numbers", content.numbers());
        }
        bytes[at] = original;
    }
}

/// Channels of the same name stay apart.
///
/// # Panics
///
/// Where they do not.
pub fn keeps_duplicate_names<Read: Fn(&[u8]) -> Result<Content, String>>(case: &Case<'_, Read>) {
    let content = (case.read)(case.duplicates);
    let kept = |c: &Content| match c.channels.as_slice() {
        [a, b] => a.name == b.name && a.samples != b.samples,
        _ => false,
    };
    assert!(content.as_ref().is_ok_and(kept), "two channels of one name: {content:?}");
}

/// Channels keep clocks of their own.
///
/// # Panics
///
/// Where they do not.
pub fn keeps_mixed_rates<Read: Fn(&[u8]) -> Result<Content, String>>(case: &Case<'_, Read>) {
    let content = (case.read)(case.mixed_rates);
    let kept = |c: &Content| match c.channels.as_slice() {
        [a, b] => a.clock != b.clock && a.samples.len() != b.samples.len() && c.is_consistent(),
        _ => false,
    };
    assert!(content.as_ref().is_ok_and(kept), "two clocks: {content:?}");
}
