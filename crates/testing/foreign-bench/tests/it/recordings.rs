//! Runs as recordings.

use foreign_bench::campaign::{NAMES, campaign};
use foreign_bench::draw;

use crate::support::RPM;

#[test]
fn exact_recordings_survive_a_file() {
    let mut bench = draw(3);
    (bench.clocks.engine_speed_ms, bench.clocks.torque_ms) = (2, 4);
    let recorded = campaign(&bench, 1500.0 * RPM, 1.0, 1);
    assert_eq!(recorded.len(), 4);
    for (name, recording) in recorded {
        let bytes = recording::encode_mdf4(&recording).unwrap();
        let read = recording::decode(&name, &bytes, &recording::Selection::All).unwrap();
        for (_, channel) in NAMES {
            let (read, made) = (read.channel(channel).unwrap(), recording.channel(channel).unwrap());
            assert_eq!(read.samples, made.samples, "{name} {channel}");
        }
        let count = |channel: &str| read.channel(channel).unwrap().samples.len();
        assert_eq!([count("SpeedDyno"), count("SpeedEngine"), count("TorqueCell")], [1000, 500, 250]);
    }
}

#[test]
fn exact_equal_seeds_give_equal_recordings() {
    let of = |seed: u64| campaign(&draw(4), 1500.0 * RPM, 0.3, seed);
    assert_eq!(of(5), of(5));
    assert_ne!(of(5), of(6));
}
