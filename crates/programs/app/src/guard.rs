//! The gate: who may ask, and what a browser may do with the answers.
//!
//! Any page that a browser shows can send requests to this computer. So the gate takes only requests to its own
//! address (a foreign name that leads here is DNS rebinding), none that another page sends, and only those with the
//! cookie that the address in the terminal gives once.
//!
//! # Source
//! OWASP cheat sheets on cross-site request forgery and HTTP headers; W3C, *Content Security Policy Level 3*; W3C,
//! *Fetch Metadata Request Headers*.

use std::sync::{Arc, Mutex, PoisonError};

use axum::extract::{Query, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use serde::Deserialize;

use crate::answer::Fault;

/// Policy for pages of the app: they load what comes from the app, and pictures that they drew themselves.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
                      connect-src 'self'; frame-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

/// Policy for reports in the frame of a page: they run their own scripts, as pages of no origin, which can ask for
/// nothing.
pub(crate) const REPORT_POLICY: &str = "sandbox allow-scripts allow-popups; default-src 'none'; \
                                        script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                                        font-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";

/// Keeper of the gate.
#[derive(Debug)]
pub(crate) struct Gate {
    port: u16,
    /// Valid until it is used.
    token: Mutex<Option<String>>,
    cookie: String,
}

impl Gate {
    /// A gate of the app at this port, with a new token and a new cookie.
    pub(crate) fn new(port: u16) -> Result<Self, getrandom::Error> {
        Ok(Gate { port, token: Mutex::new(Some(secret()?)), cookie: secret()? })
    }

    /// The address that lets one browser in.
    pub(crate) fn address(&self) -> String {
        let token = self.token.lock().unwrap_or_else(PoisonError::into_inner);
        format!("http://127.0.0.1:{}/enter?token={}", self.port, token.as_deref().unwrap_or_default())
    }

    /// The port is in the name, since cookies of all ports of a computer share one jar.
    fn cookie(&self) -> String {
        format!("dynoid-{}={}", self.port, self.cookie)
    }

    fn is_own_host(&self, host: &str) -> bool {
        [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)].iter().any(|own| own == host)
    }

    fn is_own_origin(&self, origin: &str) -> bool {
        origin.strip_prefix("http://").is_some_and(|host| self.is_own_host(host))
    }

    fn check(&self, request: &Request) -> Result<(), Fault> {
        let headers = request.headers();
        let refuse = |status, text: &str| Err(Fault::with_status(status, text));
        if !self.is_own_host(only(headers, header::HOST).unwrap_or_default()) {
            return refuse(StatusCode::MISDIRECTED_REQUEST, "this address is not that of the app");
        }
        match headers.get(header::ORIGIN).map(|origin| origin.to_str().unwrap_or_default()) {
            Some(origin) if !self.is_own_origin(origin) => {
                return refuse(StatusCode::FORBIDDEN, "another page asks; the app answers its own pages alone");
            }
            None if !matches!(*request.method(), Method::GET | Method::HEAD) => {
                return refuse(StatusCode::FORBIDDEN, "a request that changes something does not say who sends it");
            }
            _ => {}
        }
        let is_entering = request.uri().path() == "/enter";
        match is_entering || self.is_known(headers) {
            true => Ok(()),
            false => {
                refuse(StatusCode::UNAUTHORIZED, "open the address that `dynoid app` printed; it lets you in once")
            }
        }
    }

    /// Tells whether a request has the cookie.
    fn is_known(&self, headers: &HeaderMap) -> bool {
        let (own, all) = (self.cookie(), headers.get_all(header::COOKIE));
        let mut cookies = all.iter().flat_map(|cookies| cookies.to_str().unwrap_or_default().split(';'));
        cookies.any(|cookie| is_same(cookie.trim(), &own))
    }

    /// Takes the token, if it is this one.
    fn takes(&self, given: &str) -> bool {
        let mut token = self.token.lock().unwrap_or_else(PoisonError::into_inner);
        let is_right = token.as_deref().is_some_and(|token| is_same(token, given));
        if is_right {
            *token = None;
        }
        is_right
    }
}

/// Lets requests through that may come in, and notes on the answers what a browser may do with them.
pub(crate) async fn guard(State(gate): State<Arc<Gate>>, request: Request, next: Next) -> Response {
    let mut response = match gate.check(&request) {
        Ok(()) => next.run(request).await,
        Err(fault) => fault.into_response(),
    };
    let headers = response.headers_mut();
    let mut note = |name: HeaderName, value: &'static str| {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    };
    note(header::CONTENT_SECURITY_POLICY, POLICY);
    note(HeaderName::from_static("cross-origin-opener-policy"), "same-origin");
    note(HeaderName::from_static("cross-origin-resource-policy"), "same-origin");
    note(header::X_CONTENT_TYPE_OPTIONS, "nosniff");
    note(header::REFERRER_POLICY, "no-referrer");
    note(header::CACHE_CONTROL, "no-store");
    response
}

/// Token of a browser that comes from the terminal.
#[derive(Deserialize)]
pub(crate) struct Entry {
    #[serde(default)]
    token: String,
}

/// Gives the cookie for the token, once.
pub(crate) async fn enter(State(gate): State<Arc<Gate>>, headers: HeaderMap, Query(entry): Query<Entry>) -> Response {
    if !gate.takes(&entry.token) {
        // A page that is loaded again has the cookie.
        return match gate.is_known(&headers) {
            true => Redirect::to("/").into_response(),
            false => Fault::with_status(StatusCode::UNAUTHORIZED, "this address was used; start `dynoid app` again")
                .into_response(),
        };
    }
    let cookie = format!("{}; HttpOnly; SameSite=Strict; Path=/", gate.cookie());
    ([(header::SET_COOKIE, cookie)], Redirect::to("/")).into_response()
}

/// A header that is there once.
fn only(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut all = headers.get_all(name).iter();
    match (all.next(), all.next()) {
        (Some(value), None) => value.to_str().ok(),
        _ => None,
    }
}

/// 128 bits that nobody can guess, in hexadecimal digits.
fn secret() -> Result<String, getrandom::Error> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Compares in a time that does not depend on how much of it is right.
fn is_same(one: &str, other: &str) -> bool {
    let differs = one.bytes().zip(other.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b));
    one.len() == other.len() && differs == 0
}
