//! Axes: mapping of numbers to pixels, ticks and their labels. The same rules as `assets/scale.js`.

use crate::figure::Scale;

/// A mapping from data to pixels.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mapping {
    pub(crate) kind: Scale,
    pub(crate) low: f64,
    pub(crate) high: f64,
    from: f64,
    slope: f64,
}

impl Mapping {
    /// Maps `low ..= high` to the pixels `from ..= to`.
    pub(crate) fn new(kind: Scale, (low, high): (f64, f64), from: f64, to: f64) -> Self {
        let span = position(kind, high) - position(kind, low);
        let slope = (to - from) / if span == 0.0 { 1.0 } else { span };
        Mapping { kind, low, high, from, slope }
    }

    /// The mapping as the page's script reads it: kind, and the values at both ends.
    pub(crate) fn attribute(&self) -> String {
        let kind = match self.kind {
            Scale::Linear => "linear",
            Scale::Log => "log",
            Scale::Angle => "angle",
        };
        format!("{kind} {} {}", self.low, self.high)
    }

    /// Where a value is drawn; not finite where it has no place.
    pub(crate) fn pixel(&self, value: f64) -> f64 {
        self.from + (position(self.kind, value) - position(self.kind, self.low)) * self.slope
    }

    /// Ticks and their labels, about `count` of them.
    pub(crate) fn ticks(&self, count: f64) -> Vec<(f64, String)> {
        match self.kind {
            Scale::Linear => linear_ticks(self.low, self.high, count),
            Scale::Angle => angle_ticks(self.low, self.high, count),
            Scale::Log => log_ticks(self.low, self.high, count),
        }
    }
}

fn position(kind: Scale, value: f64) -> f64 {
    match kind {
        Scale::Linear | Scale::Angle => value,
        Scale::Log => value.log10(),
    }
}

/// Round steps of 1, 2 or 5 so that at most about `count` ticks fit; a few more where there would be only one.
fn linear_ticks(low: f64, high: f64, count: f64) -> Vec<(f64, String)> {
    let mut wanted = count.max(1.0);
    loop {
        let ticks = ticks_by_step(low, high, wanted);
        if ticks.len() >= 2 || wanted > 3.0 * count.max(1.0) {
            return ticks;
        }
        wanted *= 1.4;
    }
}

fn ticks_by_step(low: f64, high: f64, count: f64) -> Vec<(f64, String)> {
    let raw = (high - low) / count;
    if !(raw.is_finite() && raw > 0.0) {
        return Vec::new();
    }
    let power = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= raw * 0.999).unwrap_or(10.0 * power);
    let decimals = (-(step * 1.0001).log10().floor()).max(0.0) as usize;
    let first = (low / step - 1e-9).ceil();
    let last = (high / step + 1e-9).floor();
    // At most a few dozen by construction; the limit guards against rounding at absurd magnitudes.
    (0..(last - first + 1.0).clamp(0.0, 100.0) as usize)
        .map(|n| (first + n as f64) * step)
        .map(|value| (value, fixed(value, decimals)))
        .collect()
}

/// Steps that are parts of a turn, or turns; of small ranges the round steps of other numbers.
fn angle_ticks(low: f64, high: f64, count: f64) -> Vec<(f64, String)> {
    let raw = (high - low) / count.max(1.0);
    let turns = [15.0, 30.0, 45.0, 90.0, 180.0, 360.0, 720.0, 1800.0, 3600.0];
    match turns.into_iter().find(|step| *step >= raw * 0.999) {
        Some(step) if raw > 5.0 => {
            let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
            (first..=last).map(|n| n as f64 * step).map(|value| (value, fixed(value, 0))).collect()
        }
        _ => linear_ticks(low, high, count),
    }
}

/// 1, 2 and 5 of each decade; whole decades only where there is no room for more.
fn log_ticks(low: f64, high: f64, count: f64) -> Vec<(f64, String)> {
    let decades = (high / low).log10();
    if !decades.is_finite() || decades > 600.0 {
        return Vec::new();
    }
    let digits: &[f64] = if decades * 3.0 > count { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let range = low.log10().floor() as i32..=high.log10().floor() as i32;
    let every = (decades / count).ceil().max(1.0) as i32;
    let ticks: Vec<(f64, String)> = range
        .filter(|decade| decade % every == 0)
        .flat_map(|decade| digits.iter().map(move |digit| digit * 10f64.powi(decade)))
        .filter(|value| *value >= low * 0.9999 && *value <= high * 1.0001)
        .map(|value| (value, plain(value)))
        .collect();
    if ticks.len() > 1 { ticks } else { linear_ticks(low, high, count) }
}

/// A number with a fixed number of decimals, a true minus sign, and no minus zero.
fn fixed(value: f64, decimals: usize) -> String {
    let text = if value.abs() >= 1e6 || decimals > 6 { format!("{value:.1e}") } else { format!("{value:.decimals$}") };
    let is_zero = text.parse::<f64>().is_ok_and(|v| v == 0.0);
    if is_zero { text.replace('-', "") } else { text.replace('-', "−") }
}

fn plain(value: f64) -> String {
    let is_usual = (1e-4..1e6).contains(&value.abs());
    let text = if is_usual { format!("{}", (value * 1e6).round() / 1e6) } else { format!("{value:.0e}") };
    text.replace('-', "−")
}
