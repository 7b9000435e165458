//! Answers to a browser: JSON, bytes, or a fault in words.

use axum::body::Body;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;

/// An answer, or why there is none.
pub(crate) type Answer = Result<Response, Fault>;

/// A fault that a page shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Fault {
    status: StatusCode,
    text: String,
}

impl Fault {
    /// A request that cannot be done.
    pub(crate) fn refused(text: impl ToString) -> Self {
        Fault { status: StatusCode::UNPROCESSABLE_ENTITY, text: text.to_string() }
    }

    pub(crate) fn missing(name: &str) -> Self {
        Fault { status: StatusCode::NOT_FOUND, text: format!("{name}: there is no such file; load the page again") }
    }

    pub(crate) fn outside(name: &str) -> Self {
        let text = format!("{name}: it is not in the folder that is open; start the app on a folder with all files");
        Fault { status: StatusCode::FORBIDDEN, text }
    }

    /// A file is not the one that was read.
    pub(crate) fn changed(name: &str) -> Self {
        let text = format!("{name}: it was changed elsewhere; load it again, or save yours under another name");
        Fault { status: StatusCode::PRECONDITION_FAILED, text }
    }

    pub(crate) fn with_status(status: StatusCode, text: impl ToString) -> Self {
        Fault { status, text: text.to_string() }
    }
}

impl IntoResponse for Fault {
    fn into_response(self) -> Response {
        (self.status, [(header::CONTENT_TYPE, "application/json")], in_json(&Said { error: &self.text }))
            .into_response()
    }
}

#[derive(Serialize)]
struct Said<'a> {
    error: &'a str,
}

/// An answer in JSON.
pub(crate) fn json(value: &impl Serialize) -> Answer {
    Ok(of_type("application/json", in_json(value)))
}

/// An answer of bytes of this kind.
pub(crate) fn of_type(kind: &'static str, bytes: impl Into<Body>) -> Response {
    let mut response = Response::new(bytes.into());
    response.headers_mut().insert(header::CONTENT_TYPE, HeaderValue::from_static(kind));
    response
}

fn in_json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_else(|error| format!("{{\"error\":\"{error}\"}}"))
}
