//! Values that are kept for later readings.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes that are kept.
const MOST_BYTES: usize = 1 << 28;

/// Values by what they were made for. The oldest are given up where all of them take too much memory.
pub(crate) struct Kept<K, V> {
    values: Mutex<VecDeque<Entry<K, V>>>,
}

struct Entry<K, V> {
    key: K,
    value: Arc<V>,
    bytes: usize,
}

impl<K, V> Default for Kept<K, V> {
    fn default() -> Self {
        Self { values: Mutex::default() }
    }
}

impl<K: PartialEq, V> Kept<K, V> {
    pub(crate) fn get(&self, key: &K) -> Option<Arc<V>> {
        let values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        values.iter().find(|entry| entry.key == *key).map(|entry| entry.value.clone())
    }

    /// Keeps a value of so many bytes, if it is not too large.
    pub(crate) fn keep(&self, key: K, value: V, bytes: usize) -> Arc<V> {
        let value = Arc::new(value);
        let mut values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        values.push_back(Entry { key, value: value.clone(), bytes });
        while values.iter().map(|entry| entry.bytes).sum::<usize>() > MOST_BYTES {
            values.pop_front();
        }
        value
    }
}
