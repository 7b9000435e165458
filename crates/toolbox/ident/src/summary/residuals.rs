//! [`ResidualReport`] in print.

use std::fmt;

use lti::ChannelPair;
use lti::text::number;

use crate::validate::{JointTest, ResidualReport};

/// Results below this probability are marked.
const REMARKABLE: f64 = 0.01;

impl fmt::Display for ResidualReport {
    /// One line a test with its p-value, and one where only a part of the data was tested. A value below 0.01 speaks
    /// against the model, and is marked.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (output, whiteness) in self.whiteness.iter().enumerate() {
            line(f, &format!("residuals of y{} are white", output + 1), &whiteness.joint)?;
        }
        for (output, row) in self.independence.iter().enumerate() {
            for (input, test) in row.iter().enumerate() {
                let pair = ChannelPair { output, input };
                line(f, &format!("dynamics from {pair} are complete"), &test.dynamics)?;
                line(f, &format!("no feedback to u{} shows in y{}", input + 1, output + 1), &test.feedback)?;
            }
        }
        if self.samples < self.samples_given {
            writeln!(f, "tested on {} of {} samples", self.samples, self.samples_given)?;
        }
        Ok(())
    }
}

fn line(f: &mut fmt::Formatter<'_>, claim: &str, test: &JointTest) -> fmt::Result {
    let mark = if test.p_value < REMARKABLE { "  (rejected)" } else { "" };
    writeln!(f, "{claim:<36} p = {}{mark}", number(test.p_value))
}
