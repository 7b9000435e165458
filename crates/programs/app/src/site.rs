//! The pages, styles and scripts of the app, which are in the program.

use axum::extract::Path;
use axum::response::{IntoResponse, Response};

use crate::answer::{Fault, of_type};

/// A file of the site with its kind.
struct Asset {
    name: &'static str,
    kind: &'static str,
    bytes: &'static [u8],
}

const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! assets {
    ($($name:literal: $kind:expr),* $(,)?) => {
        &[$(Asset { name: $name, kind: $kind, bytes: include_bytes!(concat!("../web/", $name)) }),*]
    };
}

const ASSETS: &[Asset] = assets! {
    "index.html": "text/html; charset=utf-8",
    "app.css": "text/css; charset=utf-8",
    "icon.svg": "image/svg+xml",
    "app.js": SCRIPT,
    "api.js": SCRIPT,
    "dom.js": SCRIPT,
    "edit.js": SCRIPT,
    "place.js": SCRIPT,
    "save.js": SCRIPT,
    "work.js": SCRIPT,
    "chart/axes.js": SCRIPT,
    "chart/bands.js": SCRIPT,
    "chart/canvas.js": SCRIPT,
    "chart/correlations.js": SCRIPT,
    "chart/curve.js": SCRIPT,
    "chart/curves.js": SCRIPT,
    "chart/image.js": SCRIPT,
    "chart/intervals.js": SCRIPT,
    "chart/panels.js": SCRIPT,
    "chart/scale.js": SCRIPT,
    "chart/thumbnail.js": SCRIPT,
    "views/bench.js": SCRIPT,
    "views/campbell.js": SCRIPT,
    "views/can.js": SCRIPT,
    "views/command.js": SCRIPT,
    "views/compare.js": SCRIPT,
    "views/dynamics.js": SCRIPT,
    "views/jobs.js": SCRIPT,
    "views/labels.js": SCRIPT,
    "views/look.js": SCRIPT,
    "views/marks.js": SCRIPT,
    "views/model.js": SCRIPT,
    "views/next.js": SCRIPT,
    "views/report.js": SCRIPT,
    "views/roles.js": SCRIPT,
    "views/start.js": SCRIPT,
    "views/stretch.js": SCRIPT,
    "views/study.js": SCRIPT,
};

/// The page of the app, whatever its view is.
pub(crate) async fn index() -> Response {
    asset("index.html")
}

/// Another file of the site.
pub(crate) async fn file(Path(name): Path<String>) -> Response {
    asset(&name)
}

fn asset(name: &str) -> Response {
    match ASSETS.iter().find(|asset| asset.name == name) {
        Some(asset) => of_type(asset.kind, asset.bytes),
        None => Fault::missing(name).into_response(),
    }
}
