//! Numbers in records: where they are, and how their bytes are read.

use jiff::civil::Date;

/// Where a number is in a record, and how it is coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Field {
    /// First byte.
    pub byte: usize,
    /// First bit, from the least significant one of the bytes it is in.
    pub bit: u32,
    /// Number of bits, 1 to 64.
    pub bits: u32,
    pub coding: Coding,
    pub big_endian: bool,
}

/// How a number is coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Coding {
    Unsigned,
    Signed,
    /// IEEE 754 of 16, 32 or 64 bits.
    Float,
    /// The floats of VAX computers: F (32 bits), D and G (64 bits).
    VaxF,
    VaxD,
    VaxG,
    /// Seven bytes: milliseconds, minute, hour, day, month, year. As seconds since 1970-01-01.
    CanopenDate,
    /// Six bytes: milliseconds, days since 1984-01-01. As seconds since 1970-01-01.
    CanopenTime,
}

/// Records in memory: one begins every `stride` bytes, `shift` bytes in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub bytes: &'a [u8],
    pub stride: usize,
    pub shift: usize,
}

impl<'a> Rows<'a> {
    /// The record parts that begin `at` bytes into each record.
    fn from(self, at: usize) -> impl Iterator<Item = &'a [u8]> {
        let skip = self.shift.saturating_add(at);
        self.bytes.chunks_exact(self.stride.max(1)).map(move |row| row.get(skip..).unwrap_or_default())
    }

    /// `width` bytes that begin `at` bytes into each record; fewer at the end of a record that is too short.
    pub(crate) fn parts(self, at: usize, width: usize) -> impl Iterator<Item = &'a [u8]> {
        self.from(at).map(move |rest| &rest[..rest.len().min(width)])
    }
}

/// Transposed records in memory: the first byte of all, their second byte, ….
#[derive(Debug, Clone, Copy)]
pub(crate) struct Planes<'a> {
    pub bytes: &'a [u8],
    /// How many records there are.
    pub total: usize,
    /// The first that is read.
    pub first: usize,
}

/// Records that are brought together at once.
const LANES: usize = 64;

impl Planes<'_> {
    /// Reads the number that begins at byte `at` of as many records as `out` has room for.
    fn each<const N: usize>(self, at: usize, out: &mut [f64], number: impl Fn([u8; N]) -> f64) {
        let plane = |k: usize| {
            let start = (at + k) * self.total + self.first;
            self.bytes.get(start..start + out.len()).unwrap_or_default()
        };
        let planes: [&[u8]; N] = std::array::from_fn(plane);
        if planes.iter().any(|plane| plane.len() < out.len()) {
            return;
        }
        let (chunks, _) = out.as_chunks_mut::<LANES>();
        // Of up to eight bytes.
        let joined = if N <= 8 { chunks.len() } else { 0 };
        let whole = planes.map(|plane| plane.as_chunks::<LANES>().0);
        for (index, chunk) in chunks.iter_mut().enumerate().take(joined) {
            let words = joined_bytes(whole.map(|plane| &plane[index]));
            for (out, word) in chunk.iter_mut().zip(words) {
                let bytes = word.to_le_bytes();
                *out = number(std::array::from_fn(|k| bytes[k % 8]));
            }
        }
        for (row, out) in out.iter_mut().enumerate().skip(joined * LANES) {
            *out = number(planes.map(|plane| plane[row]));
        }
    }
}

/// The bytes of each record as a word, its first the lowest: joined to pairs, these to fours, these to eights, so that
/// many records are worked on by one instruction.
#[inline(always)]
fn joined_bytes<const N: usize>(planes: [&[u8; LANES]; N]) -> [u64; LANES] {
    const NONE: [u8; LANES] = [0; LANES];
    let plane = |k: usize| if k < N { planes[k] } else { &NONE };
    let mut pairs = [[0_u16; LANES]; 4];
    for (k, pair) in pairs.iter_mut().enumerate().take(N.div_ceil(2)) {
        let (low, high) = (plane(2 * k), plane(2 * k + 1));
        for i in 0..LANES {
            pair[i] = u16::from(low[i]) | u16::from(high[i]) << 8;
        }
    }
    let mut fours = [[0_u32; LANES]; 2];
    for (k, four) in fours.iter_mut().enumerate().take(N.div_ceil(4)) {
        for i in 0..LANES {
            four[i] = u32::from(pairs[2 * k][i]) | u32::from(pairs[2 * k + 1][i]) << 16;
        }
    }
    std::array::from_fn(|i| u64::from(fours[0][i]) | u64::from(fours[1][i]) << 32)
}

/// Records in memory, in either order of their bytes.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Records<'a> {
    Rows(Rows<'a>),
    Planes(Planes<'a>),
}

impl Field {
    /// An unsigned number of whole bytes.
    pub(crate) fn unsigned(byte: usize, bytes: u32) -> Self {
        Self { byte, bit: 0, bits: bytes * 8, coding: Coding::Unsigned, big_endian: false }
    }

    /// How many bytes it touches.
    pub(crate) fn width(&self) -> usize {
        (self.bit + self.bits).div_ceil(8) as usize
    }

    /// Returns true if its bits are a number of its coding.
    pub(crate) fn is_valid(&self) -> bool {
        match self.coding {
            Coding::Unsigned | Coding::Signed => self.bit < 64 && (1..=64).contains(&self.bits) && self.width() <= 9,
            Coding::Float => self.bit == 0 && matches!(self.bits, 16 | 32 | 64),
            Coding::VaxF => self.bit == 0 && self.bits == 32,
            Coding::VaxD | Coding::VaxG => self.bit == 0 && self.bits == 64,
            Coding::CanopenDate => self.bit == 0 && self.bits == 56,
            Coding::CanopenTime => self.bit == 0 && self.bits == 48,
        }
    }

    /// Reads the number of each record into `out`.
    pub(crate) fn read(&self, rows: Records<'_>, out: &mut [f64]) {
        let is_whole = self.bit == 0 && matches!(self.bits, 8 | 16 | 32 | 64);
        match self.coding {
            Coding::Float => self.floats(rows, out),
            Coding::Unsigned | Coding::Signed if is_whole => self.integers(rows, out),
            Coding::Unsigned | Coding::Signed => self.bit_fields(rows, out),
            Coding::VaxF => each(rows, self.byte, out, vax_f),
            Coding::VaxD => each(rows, self.byte, out, |b| vax_long(b, 8, 129)),
            Coding::VaxG => each(rows, self.byte, out, |b| vax_long(b, 11, 1025)),
            Coding::CanopenDate => each(rows, self.byte, out, canopen_date),
            Coding::CanopenTime => each(rows, self.byte, out, canopen_time),
        }
    }

    fn floats(&self, rows: Records<'_>, out: &mut [f64]) {
        match (self.bits, self.big_endian) {
            (64, false) => each(rows, self.byte, out, f64::from_le_bytes),
            (64, true) => each(rows, self.byte, out, f64::from_be_bytes),
            (32, false) => each(rows, self.byte, out, |b| f64::from(f32::from_le_bytes(b))),
            (32, true) => each(rows, self.byte, out, |b| f64::from(f32::from_be_bytes(b))),
            (_, false) => each(rows, self.byte, out, |b| half(u16::from_le_bytes(b))),
            (_, true) => each(rows, self.byte, out, |b| half(u16::from_be_bytes(b))),
        }
    }

    fn integers(&self, rows: Records<'_>, out: &mut [f64]) {
        let at = self.byte;
        let signed = self.coding == Coding::Signed;
        match (self.bits, signed, self.big_endian) {
            (8, false, _) => each(rows, at, out, |[b]| f64::from(b)),
            (8, true, _) => each(rows, at, out, |b| f64::from(i8::from_le_bytes(b))),
            (16, false, false) => each(rows, at, out, |b| f64::from(u16::from_le_bytes(b))),
            (16, false, true) => each(rows, at, out, |b| f64::from(u16::from_be_bytes(b))),
            (16, true, false) => each(rows, at, out, |b| f64::from(i16::from_le_bytes(b))),
            (16, true, true) => each(rows, at, out, |b| f64::from(i16::from_be_bytes(b))),
            (32, false, false) => each(rows, at, out, |b| f64::from(u32::from_le_bytes(b))),
            (32, false, true) => each(rows, at, out, |b| f64::from(u32::from_be_bytes(b))),
            (32, true, false) => each(rows, at, out, |b| f64::from(i32::from_le_bytes(b))),
            (32, true, true) => each(rows, at, out, |b| f64::from(i32::from_be_bytes(b))),
            (_, false, false) => each(rows, at, out, |b| u64::from_le_bytes(b) as f64),
            (_, false, true) => each(rows, at, out, |b| u64::from_be_bytes(b) as f64),
            (_, true, false) => each(rows, at, out, |b| i64::from_le_bytes(b) as f64),
            (_, true, true) => each(rows, at, out, |b| i64::from_be_bytes(b) as f64),
        }
    }

    fn bit_fields(&self, rows: Records<'_>, out: &mut [f64]) {
        match self.width() {
            1 => self.bit_fields_of::<1>(rows, out),
            2 => self.bit_fields_of::<2>(rows, out),
            3 => self.bit_fields_of::<3>(rows, out),
            4 => self.bit_fields_of::<4>(rows, out),
            5 => self.bit_fields_of::<5>(rows, out),
            6 => self.bit_fields_of::<6>(rows, out),
            7 => self.bit_fields_of::<7>(rows, out),
            8 => self.bit_fields_of::<8>(rows, out),
            _ => self.bit_fields_of::<9>(rows, out),
        }
    }

    fn bit_fields_of<const N: usize>(&self, rows: Records<'_>, out: &mut [f64]) {
        let (bit, unused) = (self.bit, 64 - self.bits);
        let signed = self.coding == Coding::Signed;
        let number = |raw: u64| match signed {
            // The topmost bit of the field becomes the sign.
            true => ((raw << unused).cast_signed() >> unused) as f64,
            false => ((raw << unused) >> unused) as f64,
        };
        match self.big_endian {
            false => each(rows, self.byte, out, |b: [u8; N]| number((little(b) >> bit) as u64)),
            true => each(rows, self.byte, out, |mut b: [u8; N]| {
                b.reverse();
                number((little(b) >> bit) as u64)
            }),
        }
    }
}

fn each<const N: usize>(records: Records<'_>, at: usize, out: &mut [f64], number: impl Fn([u8; N]) -> f64) {
    let rows = match records {
        Records::Rows(rows) => rows,
        Records::Planes(planes) => return planes.each(at, out, number),
    };
    for (rest, out) in rows.from(at).zip(out) {
        if let Some(bytes) = rest.first_chunk::<N>() {
            *out = number(*bytes);
        }
    }
}

fn little<const N: usize>(bytes: [u8; N]) -> u128 {
    let mut wide = [0; 16];
    wide[..N].copy_from_slice(&bytes);
    u128::from_le_bytes(wide)
}

/// IEEE 754 of 16 bits: 1 sign, 5 exponent, 10 fraction.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1F), f64::from(bits & 0x3FF));
    let magnitude = match exponent {
        0 => fraction * 2.0_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2.0_f64.powi(exponent - 25),
    };
    if bits & 0x8000 == 0 { magnitude } else { -magnitude }
}

/// VAX F: words of 16 bits, the most significant first; 8 bits of exponent, excess 128, fraction 0.1f.
fn vax_f(bytes: [u8; 4]) -> f64 {
    let [a, b, c, d] = bytes;
    let bits = u64::from(u32::from_le_bytes([c, d, a, b])) << 32;
    vax(bits, 8, 129)
}

/// VAX D (8 bits of exponent) and G (11 bits).
fn vax_long(bytes: [u8; 8], exponent_bits: u32, excess: i32) -> f64 {
    let [a, b, c, d, e, f, g, h] = bytes;
    vax(u64::from_le_bytes([g, h, e, f, c, d, a, b]), exponent_bits, excess)
}

fn vax(bits: u64, exponent_bits: u32, excess: i32) -> f64 {
    let fraction_bits = 63 - exponent_bits;
    let exponent = (bits >> fraction_bits & ((1 << exponent_bits) - 1)) as i32;
    let fraction = (bits & ((1 << fraction_bits) - 1)) as f64 / (1_u64 << fraction_bits) as f64;
    let is_negative = bits >> 63 != 0;
    match (exponent, is_negative) {
        (0, false) => 0.0,
        // A reserved operand.
        (0, true) => f64::NAN,
        _ => {
            let magnitude = (1.0 + fraction) * 2.0_f64.powi(exponent - excess);
            if is_negative { -magnitude } else { magnitude }
        }
    }
}

/// Origin of times.
const EPOCH: Date = Date::constant(1970, 1, 1);

fn canopen_date(bytes: [u8; 7]) -> f64 {
    let [ms_low, ms_high, minute, hour, day, month, year] = bytes;
    let milliseconds = f64::from(u16::from_le_bytes([ms_low, ms_high]));
    let (minute, hour, day) = (i64::from(minute & 0x3F), i64::from(hour & 0x1F), i64::from(day & 0x1F));
    let (month, year) = ((month & 0x3F).cast_signed(), i16::from(year & 0x7F));
    let year = if year < 84 { 2000 + year } else { 1900 + year };
    // A day beyond the end of its month counts on from it.
    let of_month = Date::constant(year, month.clamp(1, 12), 1).duration_since(EPOCH).as_secs();
    (of_month + (day - 1) * 86_400 + hour * 3600 + minute * 60) as f64 + milliseconds / 1000.0
}

fn canopen_time(bytes: [u8; 6]) -> f64 {
    let [a, b, c, d, e, f] = bytes;
    // The upper four bits of the milliseconds are reserved.
    let milliseconds = f64::from(u32::from_le_bytes([a, b, c, d]) & 0x0FFF_FFFF);
    let since_1984 = i64::from(u16::from_le_bytes([e, f])) * 86_400;
    (Date::constant(1984, 1, 1).duration_since(EPOCH).as_secs() + since_1984) as f64 + milliseconds / 1000.0
}

/// Returns true if the numbers that a field can hold are only integers.
pub(crate) fn is_integer(field: &Field) -> bool {
    matches!(field.coding, Coding::Unsigned | Coding::Signed)
}
