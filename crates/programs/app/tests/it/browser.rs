//! A browser that says what a test wants it to say.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::path::Path;

use dynoid_app::{App, Program};

/// An app that answers, and how to reach it.
pub(crate) struct Running {
    pub(crate) port: u16,
    /// Path of the address that lets in.
    pub(crate) entry: String,
}

/// An answer, its heads in lower case.
pub(crate) struct Answered {
    pub(crate) status: u16,
    pub(crate) heads: String,
    pub(crate) body: Vec<u8>,
}

impl Answered {
    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub(crate) fn head(&self, name: &str) -> Option<&str> {
        self.heads.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(": "))
    }
}

/// Starts the app on a folder.
pub(crate) fn app_on(folder: &Path) -> Running {
    let app = App::open(
        folder,
        0,
        Program {
            path: "dynoid".into(),
            before: Vec::new(),
            commands: serde_json::json!([{ "words": ["inspect"] }, { "words": ["study"] }]),
        },
    )
    .unwrap();
    let address = app.address();
    std::thread::spawn(move || app.serve());
    let (host, entry) = address.strip_prefix("http://").unwrap().split_once('/').unwrap();
    let port = host.rsplit_once(':').unwrap().1.parse().unwrap();
    Running { port, entry: format!("/{entry}") }
}

impl Running {
    /// Sends these lines as they are, and reads the answer.
    pub(crate) fn send(&self, first: &str, heads: &[&str], body: &str) -> Answered {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
        let heads: String = heads.iter().map(|head| format!("{head}\r\n")).collect();
        let length = body.len();
        let request = format!("{first} HTTP/1.1\r\n{heads}content-length: {length}\r\nconnection: close\r\n\r\n{body}");
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let heads = String::from_utf8_lossy(&answer[..end]).to_lowercase();
        let status = heads.split(' ').nth(1).unwrap().parse().unwrap();
        Answered { status, heads, body: answer[end + 4..].to_vec() }
    }

    pub(crate) fn host(&self) -> String {
        format!("host: 127.0.0.1:{}", self.port)
    }

    pub(crate) fn origin(&self) -> String {
        format!("origin: http://127.0.0.1:{}", self.port)
    }

    /// Uses the address, and gives the line with the cookie.
    pub(crate) fn enter(&self) -> String {
        let answer = self.send(&format!("GET {}", self.entry), &[&self.host()], "");
        assert_eq!(answer.status, 303);
        let cookie = answer.head("set-cookie").unwrap().split(';').next().unwrap().to_owned();
        format!("cookie: {cookie}")
    }

    /// Asks as a page of the app does.
    pub(crate) fn ask(&self, cookie: &str, first: &str, body: &str) -> Answered {
        let json = "content-type: application/json";
        self.send(first, &[&self.host(), &self.origin(), cookie, json], body)
    }
}
