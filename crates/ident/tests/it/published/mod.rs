//! Estimates from measurements of others, against the results that they published.
#![allow(clippy::print_stdout, reason = "a skipped test says so")]

mod flexible_joint;
mod flexible_link;
mod motor_bench;
mod positioning;
mod run_down;
mod servo;
mod wheel;

use crate::shared::shared;

/// Named channels of a recording of the shared folder; `None`, with a word about it, where it is absent.
fn channels<const N: usize>(path: &str, names: [&str; N]) -> Option<[Vec<f64>; N]> {
    let path = shared(&format!("reference/{path}"))?;
    let bytes = std::fs::read(&path).unwrap();
    let recording = recording::decode_untimed(&path.to_string_lossy(), &bytes, 1.0).unwrap();
    Some(names.map(|name| recording.channel(name).unwrap_or_else(|| panic!("no {name}")).samples.clone()))
}

fn centred(x: &[f64]) -> Vec<f64> {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|v| v - mean).collect()
}
