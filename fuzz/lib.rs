//! Checks that every fuzz target makes.

use std::sync::Once;

use recording::{Selection, catalogue, decode, decode_untimed};

static QUIET: Once = Once::new();

/// Lists content, and decodes it whole, by name, and with a row distance; each channel that is listed has a raster,
/// each that is decoded has a sample for each time stamp, and a selected channel is what it is without selection.
///
/// # Panics
///
/// Where it is not so.
pub fn decode_all(name: &str, bytes: &[u8]) {
    // The fuzzer's own hook ends the program on any panic. Those within decoders of others are caught and become
    // errors; the rest still end it.
    QUIET.call_once(|| std::panic::set_hook(Box::new(|panic| eprintln!("{panic}"))));
    list(name, bytes);
    let _ = decode_untimed(name, bytes, 0.1);
    let Ok(recording) = decode(name, bytes, &Selection::All) else { return };
    for channel in &recording.channels {
        assert_eq!(recording.time_s(channel).map(<[f64]>::len), Some(channel.samples.len()));
    }
    let Some(first) = recording.channels.first() else { return };
    let Ok(selected) = decode(name, bytes, &Selection::names([first.name.as_str()])) else { return };
    let bits = |samples: &[f64]| samples.iter().map(|s| s.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&selected.channels[0].samples), bits(&first.samples));
}

/// Lists content; each channel has a raster.
///
/// # Panics
///
/// Where it is not so.
pub fn list(name: &str, bytes: &[u8]) {
    let Ok(list) = catalogue(name, bytes) else { return };
    assert!(list.channels.iter().all(|channel| channel.raster < list.rasters.len()));
}
