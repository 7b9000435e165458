//! The app as a browser meets it, and as an attacker does.

#![allow(clippy::unwrap_used)]

mod attacks;
mod browser;
mod edits;
mod recordings;
mod stretches;
mod tries;
