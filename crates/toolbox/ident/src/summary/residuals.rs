//! [`ResidualReport`] in print.

use std::fmt;

use lti::text::number;

use crate::validate::{JointTest, ResidualReport};

/// Results below this probability are marked.
const REMARKABLE: f64 = 0.01;

impl fmt::Display for ResidualReport {
    /// [`ResidualReport::text`] with the channels' places, u1 and y1.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let inputs = self.independence.first().map_or(0, Vec::len);
        let places = |letter: char, count: usize| (1..=count).map(|n| format!("{letter}{n}")).collect::<Vec<_>>();
        f.write_str(&self.text(&places('u', inputs), &places('y', self.whiteness.len())))
    }
}

impl ResidualReport {
    /// One line a test with its p-value, and one where only a part of the data was tested. A value below 0.01 speaks
    /// against the model, and is marked.
    #[must_use]
    pub fn text(&self, inputs: &[String], outputs: &[String]) -> String {
        let mut lines = String::new();
        for (whiteness, output) in self.whiteness.iter().zip(outputs) {
            lines += &line(&format!("residuals of {output} are white"), &whiteness.joint);
        }
        for (row, output) in self.independence.iter().zip(outputs) {
            for (test, input) in row.iter().zip(inputs) {
                lines += &line(&format!("dynamics from {input} to {output} are complete"), &test.dynamics);
                lines += &line(&format!("no feedback to {input} shows in {output}"), &test.feedback);
            }
        }
        if self.samples < self.samples_given {
            lines += &format!("tested on {} of {} samples\n", self.samples, self.samples_given);
        }
        lines
    }
}

fn line(claim: &str, test: &JointTest) -> String {
    let mark = if test.p_value < REMARKABLE { "  (rejected)" } else { "" };
    format!("{claim:<36} p = {}{mark}\n", number(test.p_value))
}
