//! How large may an excitation be if its peak is limited? Phases decide: the same power with a third of the peak.
#![allow(clippy::print_stdout, reason = "an example prints")]

use signal::SignalError;
use signal::excitation::{Multisine, Phases, Timing, crest_factor};

fn main() -> Result<(), SignalError> {
    let timing = Timing { sample_time_s: 1e-3, length: 1000 };
    let phases = [
        ("random", Phases::Random { seed: 1 }),
        ("Schroeder", Phases::Schroeder),
        ("optimised", Phases::LowCrest { iterations: 200 }),
    ];
    let mut crests = Vec::new();
    for (name, phases) in phases {
        let multisine = Multisine::flat(1000, (1..=40).collect(), 1.0, phases).generate(timing)?;
        let crest = crest_factor(&multisine.samples)?;
        println!("{name:<10} phases: peak {crest:.2} times the root mean square");
        crests.push(crest);
    }
    assert!(crests[2] < 1.5 && crests[0] > crests[1] && crests[1] > crests[2]);
    Ok(())
}
