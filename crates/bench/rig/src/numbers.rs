//! Numbers that a document has in the unit people read.

/// Units in the last place by which a number that was scaled and scaled back may be away.
const ROUNDED: usize = 8;

/// The number that a scaling made into this one. Of those that give the same after rounding, it is one near the
/// quotient, so that a document that is read and written again has the same digits.
pub fn unscaled(written: f64, scales: &[f64]) -> f64 {
    let scaled = |si: f64| scales.iter().fold(si, |value, scale| value * scale);
    let near = scales.iter().fold(written, |value, scale| value / scale);
    let upwards = std::iter::successors(Some(near), |value| Some(value.next_up())).take(ROUNDED);
    let downwards = std::iter::successors(Some(near), |value| Some(value.next_down())).take(ROUNDED);
    upwards.chain(downwards).find(|si| scaled(*si) == written).unwrap_or(near)
}
