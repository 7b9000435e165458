//! The measured and modelled series of a study as one table.

use recording::{Channel, Format, Raster, Recording};
use rig::results::{Outcome, Trace, Validation};

use crate::Study;

/// Every series of a study: what was measured and what the model gives, of each part and each replay.
///
/// A channel has the name of its place below `study` in the JSON document, e.g. `replays/0/signals/2/measured`, and the
/// file and the quantity as its comment. Times are those of each recording, s. `None` where nothing was estimated.
pub fn series(study: &Study) -> Option<Recording> {
    let mut table = Table::default();
    for (place, validation) in validations(study) {
        table.add(&place, validation);
    }
    table.recording()
}

/// Every comparison that has traces, with its place in the JSON document.
fn validations(study: &Study) -> Vec<(String, &Validation)> {
    let mut all = Vec::new();
    let mut add = |place: &str, validation| all.push((place.to_owned(), validation));
    if let Some(controller) = study.speed_controller.estimated() {
        add("speed_controller/validation", &controller.validation);
        add("speed_controller/without_delay", &controller.without_delay);
    }
    if let Some(feed_forward) = study.feed_forward.estimated() {
        add("feed_forward/validation", &feed_forward.validation);
        add("feed_forward/pi_alone", &feed_forward.pi_alone);
    }
    if let Some(control) = study.torque_control.estimated() {
        add("torque_control/pure_delay_validation", &control.pure_delay_validation);
        add("torque_control/delay_and_lag_validation", &control.delay_and_lag_validation);
    }
    if let Some(shaft) = study.shaft.estimated() {
        add("shaft/validation", &shaft.validation);
    }
    for (number, replay) in study.replays.iter().enumerate() {
        for (place, signal) in replay.signals.iter().enumerate() {
            add(&format!("replays/{number}/signals/{place}"), signal);
        }
    }
    all
}

impl Study {
    /// Tells whether it has traces whose values are not known, since their table was not read.
    #[must_use]
    pub fn lacks_series(&self) -> bool {
        let is_unread = |trace: &Trace| !trace.values.is_empty() && trace.values.iter().all(|value| value.is_nan());
        validations(self).iter().any(|(_, validation)| is_unread(&validation.measured))
    }

    /// Fills in the values of the traces that a table of [`series`] holds. A trace that the table does not have, or has
    /// with another number of samples, stays as it is.
    pub fn take_series(&mut self, table: &Recording) {
        self.each_series(|place, validation| {
            for (what, trace) in [("measured", &mut validation.measured), ("modelled", &mut validation.modelled)] {
                let name = format!("{place}/{what}");
                let channel = table.channels.iter().find(|channel| channel.name == name);
                if let Some(channel) = channel.filter(|channel| channel.samples.len() == trace.values.len()) {
                    trace.values.clone_from(&channel.samples);
                }
            }
        });
    }

    /// Hands over every comparison of [`validations`], to be changed.
    fn each_series(&mut self, mut take: impl FnMut(&str, &mut Validation)) {
        if let Outcome::Estimated(controller) = &mut self.speed_controller {
            take("speed_controller/validation", &mut controller.validation);
            take("speed_controller/without_delay", &mut controller.without_delay);
        }
        if let Outcome::Estimated(feed_forward) = &mut self.feed_forward {
            take("feed_forward/validation", &mut feed_forward.validation);
            take("feed_forward/pi_alone", &mut feed_forward.pi_alone);
        }
        if let Outcome::Estimated(control) = &mut self.torque_control {
            take("torque_control/pure_delay_validation", &mut control.pure_delay_validation);
            take("torque_control/delay_and_lag_validation", &mut control.delay_and_lag_validation);
        }
        if let Outcome::Estimated(shaft) = &mut self.shaft {
            take("shaft/validation", &mut shaft.validation);
        }
        for (number, replay) in self.replays.iter_mut().enumerate() {
            for (place, signal) in replay.signals.iter_mut().enumerate() {
                take(&format!("replays/{number}/signals/{place}"), signal);
            }
        }
    }
}

/// Start in s, sample time in s, and number of samples: traces that agree in them share a clock.
type Clock = (u64, u64, usize);

#[derive(Default)]
struct Table {
    clocks: Vec<Clock>,
    rasters: Vec<Raster>,
    channels: Vec<Channel>,
}

impl Table {
    fn add(&mut self, place: &str, validation: &Validation) {
        for (what, trace) in [("measured", &validation.measured), ("modelled", &validation.modelled)] {
            let raster = self.raster(trace);
            self.channels.push(Channel {
                name: format!("{place}/{what}"),
                unit: validation.unit.clone(),
                comment: format!("{}: {}, {what}", validation.stretch.file, validation.quantity),
                raster,
                samples: trace.values.clone(),
            });
        }
    }

    fn raster(&mut self, trace: &Trace) -> usize {
        let clock = (trace.start_s.to_bits(), trace.sample_time_s.to_bits(), trace.values.len());
        if let Some(known) = self.clocks.iter().position(|one| *one == clock) {
            return known;
        }
        let time_s = (0..trace.values.len()).map(|k| trace.start_s + k as f64 * trace.sample_time_s).collect();
        self.clocks.push(clock);
        self.rasters.push(Raster { time_s, name: None });
        self.rasters.len() - 1
    }

    fn recording(self) -> Option<Recording> {
        (!self.channels.is_empty()).then(|| Recording {
            format: Format::Parquet,
            comment: Some(
                "dynoid study: each column is a series at the place below `study` in study.json that its name says"
                    .to_owned(),
            ),
            start_time: None,
            rasters: self.rasters,
            channels: self.channels,
            findings: Vec::new(),
        })
    }
}
