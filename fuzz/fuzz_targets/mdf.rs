//! Any bytes may be opened, listed and read as an MDF file: `cargo +nightly fuzz run mdf`.
#![no_main]

use work::Context;
use libfuzzer_sys::fuzz_target;
use mdf::{Address, Mdf};

/// Samples that are read of a group at most; a file of zeros deflates a thousandfold.
const MOST: u64 = 1 << 20;

fuzz_target!(|bytes: &[u8]| {
    fuzz::list("run.mf4", bytes);
    let _ = recording::extras_from("run.mf4", &bytes.to_vec());
    let Ok(file) = Mdf::open(bytes) else { return };
    for (group, info) in file.groups().iter().enumerate() {
        let _ = file.count(group);
        if info.at_most > MOST {
            continue;
        }
        for channel in 0..info.channels.len().min(64) {
            let values = file.read(&[Address { group, channel }], &Context::new());
            if let (Ok(values), Some(found)) = (values, info.found) {
                assert_eq!(values[0].len() as u64, found);
            }
        }
    }
});
