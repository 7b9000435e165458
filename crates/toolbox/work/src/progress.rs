//! Progress: a tree of steps, of which a listener hears when they begin, advance and end.

use std::collections::BTreeMap;

/// News of a step.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Progress {
    /// The step, counted from 1 in the order of their beginning.
    pub step: u64,
    /// The step that it is a part of; none of the outermost ones.
    pub parent: Option<u64>,
    /// The step in words, such as `estimating: shaft`.
    pub what: String,
    /// Parts that are done.
    pub done: u64,
    /// Parts in all, as known from the beginning; 0 where it has none.
    pub total: u64,
    /// Where the step stands.
    pub state: State,
}

/// Where a step stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// It begins.
    Begun,
    /// Some of its parts are done.
    Advanced,
    /// All of it is done, and with it a part of its parent.
    Ended,
    /// It ended before all of it was done: the work failed or was cancelled.
    Abandoned,
}

/// The steps under way, from what a listener heard.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    under_way: BTreeMap<u64, Progress>,
    /// Outermost steps that ended.
    ended: u64,
}

impl Tree {
    /// Takes in what a listener heard.
    pub fn hear(&mut self, heard: &Progress) {
        match heard.state {
            State::Begun | State::Advanced => {
                self.under_way.insert(heard.step, heard.clone());
            }
            State::Ended | State::Abandoned => self.end(heard),
        }
    }

    fn end(&mut self, heard: &Progress) {
        self.under_way.remove(&heard.step);
        match heard.parent.map(|parent| self.under_way.get_mut(&parent)) {
            None => self.ended += 1,
            Some(Some(parent)) if heard.state == State::Ended => parent.done += 1,
            Some(_) => {}
        }
    }

    /// Part of the outermost step that is done, from 0 to 1: its own parts, and what is done of those under way.
    pub fn fraction(&self) -> f64 {
        let outermost = self.under_way.values().find(|step| step.parent.is_none());
        outermost.map_or(if self.ended > 0 { 1.0 } else { 0.0 }, |step| self.done_of(step))
    }

    fn done_of(&self, step: &Progress) -> f64 {
        if step.total == 0 {
            return 0.0;
        }
        let parts = self.under_way.values().filter(|part| part.parent == Some(step.step));
        let done = step.done as f64 + parts.map(|part| self.done_of(part)).sum::<f64>();
        (done / step.total as f64).min(1.0)
    }

    /// The step that began last of those under way, in words.
    pub fn current(&self) -> Option<&str> {
        self.under_way.values().next_back().map(|step| step.what.as_str())
    }
}
