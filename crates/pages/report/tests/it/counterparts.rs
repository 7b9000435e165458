//! Every figure and table of the thesis that shows a result has its counterpart in the report. Those that need an
//! analysis of the recordings stand in the report of `dynoid study --full`, and are looked for by the program's own
//! tests.

use crate::fixture;

/// Figure or table of the thesis, the section that has its counterpart, and words of it.
const COUNTERPARTS: [(&str, &str, &str); 16] = [
    ("figures 6.1, 6.2: delays of the torque signals", "timing", "Behind the bend of N_d"),
    ("figure 3.3: the system’s moving average", "timing", "is reproduced by a moving average over"),
    ("figures 6.3, 6.4: block diagram", "diagram", "Speed control"),
    ("figure 6.5, left: residuals without delay", "speed-control", "Without the delay"),
    ("figure 6.5, right: residuals with delay", "speed-control", "With the delay"),
    ("figure 6.6: PI on validation data", "speed-control", "Speed control on the held-out stretch"),
    ("figure 6.7: zero of PI", "speed-control", "zero of (K_p s + K_i)/s"),
    ("figure 6.8: PI alone on ramps", "feed-forward", "PI alone"),
    ("figure 6.10: PI and feed-forward", "feed-forward", "PI with feed-forward, and PI alone, on the held-out stretch"),
    ("figure 6.11: delayed demand", "torque-control", "Torque control on the held-out stretch"),
    ("figures 6.16, 6.17: shaft torque", "shaft", "Shaft torque on the held-out stretch"),
    ("figure 7.4: speed control", "whole", "From N_d* to N_d"),
    ("figure 7.5: torque control", "whole", "From T_e to T_shaft"),
    ("figure 7.6: gains of sine tests", "whole", "Gain from T_d to T_shaft, sine by sine"),
    ("figure 7.7: replay in speed control", "replays", "Speed control (NT)"),
    ("figure 7.8: replay in torque control", "replays", "Torque control (TN)"),
];

/// The text of a section, symbols as in `T_d*`.
fn section(page: &str, id: &str) -> String {
    let from = page.split(&format!("<section id=\"{id}\">")).nth(1).unwrap_or_default();
    let own = from.split("</section>").next().unwrap_or_default().replace("<sub>", "_");
    let mut pieces = own.split('<');
    let first = pieces.next().unwrap_or_default().to_owned();
    let text = pieces.filter_map(|piece| piece.split_once('>')).map(|(_, text)| text);
    text.fold(first, |all, text| all + text).replace('\u{a0}', " ")
}

#[test]
fn exact_every_figure_has_its_counterpart() {
    let page = fixture::html(&fixture::complete());
    for (figure, id, words) in COUNTERPARTS {
        assert!(
            section(&page, id).contains(words),
            "{figure}: `{words}` is not in section {id}:\n{}",
            section(&page, id)
        );
    }
}
