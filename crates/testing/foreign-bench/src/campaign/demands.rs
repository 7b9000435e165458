//! Demands in the experiments of a campaign.

use crate::bench::RPM;
use crate::demand::{Demand, Mode};
use crate::random::Random;

/// Torque of the engine, Nm.
const TORQUE_NM: f64 = 60.0;
/// Torque demands of the automation system hold so long, ms.
const HOLD_MS: usize = 10;
/// The engine's torque is switched no sooner, ms.
const SWITCH_MS: usize = 80;

/// Every experiment with its label.
pub(super) fn all(speed_rad_s: f64, duration_s: f64, seed: u64) -> Vec<(&'static str, Demand)> {
    let count = (1e3 * duration_s) as usize;
    let mut random = Random::new(seed ^ 0xca4_9a16);
    let steady = vec![speed_rad_s; count];
    let mut switched = held(count, SWITCH_MS, || random.one_of([35.0, 55.0]));
    switched[..SWITCH_MS.min(count)].fill(55.0);
    let mut random = Random::new(seed ^ 0xca4_9a17);
    let mut noisy = held(count, HOLD_MS, || TORQUE_NM + 12.0 * random.normal());
    noisy[..HOLD_MS.min(count)].fill(TORQUE_NM);
    let torque = vec![TORQUE_NM; count];
    let demand = |mode, speed_rad_s, torque_nm| Demand { mode, speed_rad_s, torque_nm };
    vec![
        ("BS_T_NT", demand(Mode::SpeedByIgnition, steady.clone(), switched)),
        ("WhiteNoise_T_TN", demand(Mode::Torque, steady, noisy)),
        ("Levels_N_NT", demand(Mode::Speed, levels(speed_rad_s, count, seed), torque.clone())),
        ("Ramp_N_NT", demand(Mode::Speed, ramps(speed_rad_s, count), torque)),
    ]
}

/// Values that are drawn anew again and again.
fn held(count: usize, hold: usize, mut drawn: impl FnMut() -> f64) -> Vec<f64> {
    let values: Vec<f64> = (0..count.div_ceil(hold)).map(|_| drawn()).collect();
    (0..count).map(|k| values[k / hold]).collect()
}

/// Every 3 s towards another level up to 1800 rpm higher, with 100 to 1000 rpm/s.
fn levels(low_rad_s: f64, count: usize, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed ^ 0xca4_9a18);
    let (mut now, mut towards, mut slope) = (low_rad_s, low_rad_s, 0.0);
    let next = |k: usize| {
        if k % 3000 == 1000 {
            towards = low_rad_s + 1800.0 * RPM * random.between(0.0, 1.0);
            slope = 1e-3 * RPM * random.between(100.0, 1000.0);
        }
        now += (towards - now).clamp(-slope, slope);
        now
    };
    (0..count).map(next).collect()
}

/// Up by 800 rpm and down again in 3 s each, with 5 s of rest in between, after 2 s.
fn ramps(low_rad_s: f64, count: usize) -> Vec<f64> {
    let share = |k: usize| {
        let into = (k.saturating_sub(2000)) as f64 / 1000.0 % 16.0;
        if into < 8.0 { (into / 3.0).min(1.0) } else { 1.0 - ((into - 8.0) / 3.0).min(1.0) }
    };
    (0..count).map(|k| low_rad_s + 800.0 * RPM * share(k)).collect()
}
