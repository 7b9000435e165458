//! Estimates from measurements of others, against the results that they published.
#![allow(clippy::disallowed_methods, reason = "measurements are files")]

mod drivetrain;
mod flexible_drive;
mod flexible_joint;
mod flexible_link;
mod motor_bench;
mod positioning;
mod run_down;
mod servo;
mod wheel;

use testdata::shared;

/// Named channels of a recording of the shared folder; `None`, with a word about it, where it is absent.
fn channels<const N: usize>(path: &str, names: [&str; N]) -> Option<[Vec<f64>; N]> {
    let bytes = std::fs::read(shared(&format!("reference/{path}"))?).unwrap();
    let recording = recording::decode_untimed(path, &bytes, 1.0).unwrap();
    Some(names.map(|name| recording.channel(name).expect(name).samples.clone()))
}

/// A text of the shared folder.
fn text(path: &str) -> Option<String> {
    Some(std::fs::read_to_string(shared(&format!("reference/{path}"))?).unwrap())
}

fn centred(x: &[f64]) -> Vec<f64> {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|v| v - mean).collect()
}
