//! Recordings replayed on the assembled model.

use bench::Study;
use bench::study::{Replay, Validation};

use super::parts::{stretch, table};
use super::plots::{difference, figure, thinned, trace_layer};
use super::typeset::{prose, symbol};
use crate::wording::{capitalised, experiment, mode, number};
use page::markup;
use page::markup::Markup;
use page::{Axis, Figure, Panel, Style};

/// The section on replays.
pub(crate) fn section(study: &Study) -> Markup {
    let what = "The whole model is driven with the recorded demand and with the engine torque reconstructed from N_e and \
                T_shaft; what it answers is compared with what was measured.";
    if study.replays.is_empty() {
        return markup!(
            "<p class=\"lead\">{}</p>\n<div class=\"missing\"><p><strong>No recording was replayed.</strong> \
             The model as a whole has not been held against a measurement.</p></div>\n",
            prose(what)
        );
    }
    let replays: Markup = study.replays.iter().map(replay).collect();
    markup!("<p class=\"lead\">{}</p>\n{}{}", prose(what), overview(&study.replays), replays)
}

fn overview(replays: &[Replay]) -> Markup {
    let rows = replays.iter().map(|replay| {
        let fits: Vec<Markup> = replay
            .signals
            .iter()
            .map(|s| markup!("<span class=\"n pairing\">{} {}</span>", symbol(&s.quantity), number::fit(s.fit_percent)))
            .collect();
        vec![
            markup!("<strong>{}</strong><br><span class=\"file\">{}</span>", replay.label, replay.stretch.file),
            seen(replay.seen_in_estimation),
            fits.into_iter().collect(),
        ]
    });
    table("overview", &["Recording", "Used in estimation?", "Fit"], rows)
}

fn seen(seen_in_estimation: bool) -> Markup {
    if seen_in_estimation {
        markup!("<span class=\"tag seen\">seen</span> part of the model comes from this recording")
    } else {
        markup!("<span class=\"tag unseen\">unseen</span> no part of the model has seen it")
    }
}

fn replay(replay: &Replay) -> Markup {
    let described = experiment(&replay.label).map(|words| format!("{words}. ")).unwrap_or_default();
    markup!(
        "<h3>{}</h3>\n<p>{}{}. {}. {}.</p>\n{}",
        replay.label,
        prose(&capitalised(&described)),
        capitalised(mode(replay.mode)),
        stretch(&replay.stretch),
        seen(replay.seen_in_estimation),
        figure(&signals(replay)),
    )
}

/// All signals below each other on one time axis, each with its fit.
fn signals(replay: &Replay) -> Figure {
    let panels = replay.signals.iter().map(signal).chain(worst_residual(replay)).collect();
    let thinned = replay.signals.iter().map(|signal| thinned(&signal.measured)).find(|text| !text.is_empty());
    Figure {
        equal_axes: false,
        symbols: true,
        title: "Measured and modelled".to_owned(),
        caption: format!(
            "{} {}",
            if replay.seen_in_estimation {
                "Part of the model was estimated from this recording."
            } else {
                "No part of the model was estimated from this recording."
            },
            thinned.unwrap_or_default()
        )
        .trim_end()
        .to_owned(),
        x: Axis::time(),
        panels,
    }
}

fn signal(signal: &Validation) -> Panel {
    let measured = trace_layer("measured", Style::Measured, &signal.measured);
    let modelled = trace_layer("modelled", Style::Modelled, &signal.modelled);
    Panel::new(Axis::linear(&signal.quantity, &signal.unit), 120, vec![measured, modelled])
        .noted(format!("fit {}", number::fit(signal.fit_percent)))
}

/// What is left of the signal the model explains least.
fn worst_residual(replay: &Replay) -> Option<Panel> {
    let worst = replay.signals.iter().min_by(|a, b| a.fit_percent.total_cmp(&b.fit_percent))?;
    let left_over = vec![trace_layer("residual", Style::Residual, &difference(worst))];
    let panel = Panel::new(Axis::linear(&format!("{} − model", worst.quantity), &worst.unit), 80, left_over);
    Some(panel.noted("of the signal with the lowest fit".to_owned()))
}
