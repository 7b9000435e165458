//! The samples of a channel.

use std::collections::HashMap;

use crate::Address;

/// The samples of a channel, one for each record of its group.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers; NaN where marked invalid. Integers of 2^53 and more are rounded ([`crate::Mdf::rounded`]).
    Numbers(Vec<f64>),
    /// Text; empty where marked invalid.
    Text(Texts),
    /// Bytes.
    Bytes(Blobs),
}

impl Values {
    /// How many samples there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Text(texts) => texts.len(),
            Self::Bytes(blobs) => blobs.len(),
        }
    }

    /// Returns true if there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Numbers of channels, in the order in which these were asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Numbers {
    /// The numbers of each channel.
    pub columns: Vec<Vec<f64>>,
    /// The channels among whose integers were some of 2^53 and more, which are rounded.
    pub rounded: Vec<Address>,
}

/// Strings of bytes, one after the other in memory; equal ones may share their place.
#[derive(Debug, Clone, Default)]
pub struct Blobs {
    spans: Vec<(usize, usize)>,
    bytes: Vec<u8>,
    last: (usize, usize),
}

impl PartialEq for Blobs {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len() && (0..self.len()).all(|i| self.get(i) == other.get(i))
    }
}

impl Blobs {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// Returns true if there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// One of them; empty beyond the end.
    #[must_use]
    pub fn get(&self, index: usize) -> &[u8] {
        let (start, end) = self.spans.get(index).copied().unwrap_or((0, 0));
        self.bytes.get(start..end).unwrap_or_default()
    }

    pub(crate) fn set(&mut self, row: usize, value: &[u8]) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(value);
        self.last = (start, self.bytes.len());
        self.set_again(row);
    }

    /// The value set last.
    pub(crate) fn set_again(&mut self, row: usize) {
        self.extend_to(row + 1);
        self.spans[row] = self.last;
    }

    /// Empty ones, until there are so many.
    pub(crate) fn extend_to(&mut self, rows: usize) {
        if self.spans.len() < rows {
            self.spans.resize(rows, (0, 0));
        }
    }

    pub(crate) fn into_texts(self) -> Texts {
        Texts { blobs: self }
    }
}

/// Texts, one after the other in memory; equal ones may share their place.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Texts {
    blobs: Blobs,
}

impl Texts {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.blobs.len()
    }

    /// Returns true if there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.blobs.is_empty()
    }

    /// One of them; empty beyond the end.
    #[must_use]
    pub fn get(&self, index: usize) -> &str {
        // Only whole texts are ever put in.
        std::str::from_utf8(self.blobs.get(index)).unwrap_or_default()
    }

    /// All of them in order.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        (0..self.len()).map(|i| self.get(i))
    }

    /// The texts that `keys` become; each key is translated once.
    pub(crate) fn translated<K: std::hash::Hash + Eq>(
        keys: impl Iterator<Item = K>,
        text: impl Fn(&K) -> String,
    ) -> Self {
        let mut known: HashMap<K, (usize, usize)> = HashMap::new();
        let mut blobs = Blobs::default();
        for (row, key) in keys.enumerate() {
            match known.get(&key) {
                Some(span) => {
                    blobs.last = *span;
                    blobs.set_again(row);
                }
                None => {
                    blobs.set(row, text(&key).as_bytes());
                    // Numbers that never repeat are not worth remembering.
                    if known.len() < 1 << 12 {
                        known.insert(key, blobs.last);
                    }
                }
            }
        }
        Self { blobs }
    }
}
