//! Integration tests of the exports. A name's prefix says what it proves.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![allow(clippy::disallowed_methods)] // other programs read the exports from a folder

mod draws;
mod model;
mod names;
