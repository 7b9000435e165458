//! The server: what a browser may ask for, and who answers.

use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use axum::extract::{DefaultBodyLimit, State};
use axum::routing::{get, post};
use axum::{Router, middleware};

use crate::answer::{Answer, json};
use crate::folder::Folder;
use crate::guard::{Gate, enter, guard};
use crate::handles::Handles;
use crate::shared::{Inner, Program, Shared};
use crate::tries::Tries;
use crate::{campbell, can, jobs, labels, models, next, recordings, session, site, stretches, studies, texts};

/// The most bytes of a text that a page may send.
const MOST_SENT: usize = 4 << 20;

/// Why the app does not start.
#[derive(Debug, thiserror::Error)]
pub enum AppError {
    /// The folder cannot be opened.
    #[error("{}: it cannot be opened: {source}; name a folder with recordings or a bench file", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The port cannot be had.
    #[error("port {port} cannot be had: {source}; choose another one, or none")]
    Port {
        /// The port; 0 for any.
        port: u16,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The system has no random numbers.
    #[error("the system gives no random numbers, which keep others out: {reason}")]
    NoSecrets {
        /// The system's reason.
        reason: String,
    },
    /// The server stopped.
    #[error("the app stopped: {source}")]
    Stopped {
        /// The system's reason.
        source: std::io::Error,
    },
}

/// The app on a folder, at a port of this computer that nobody else can reach.
#[derive(Debug)]
pub struct App {
    listener: TcpListener,
    gate: Arc<Gate>,
    shared: Shared,
}

impl App {
    /// Opens a folder, and a port; 0 for any that is free. The program runs the jobs.
    ///
    /// # Errors
    /// A folder or a port that cannot be had.
    pub fn open(folder: &Path, port: u16, program: Program) -> Result<Self, AppError> {
        let folder = Folder::open(folder).map_err(|source| AppError::Folder { folder: folder.to_owned(), source })?;
        let no_port = |source| AppError::Port { port, source };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(no_port)?;
        let own = listener.local_addr().map_err(no_port)?.port();
        let gate = Gate::new(own).map_err(|reason| AppError::NoSecrets { reason: reason.to_string() })?;
        let shared = Inner {
            folder,
            program,
            handles: Handles::default(),
            predictions: Tries::default(),
            proposals: Tries::default(),
        };
        Ok(App { listener, gate: Arc::new(gate), shared: Arc::new(shared) })
    }

    /// The address that lets one browser in, once.
    #[must_use]
    pub fn address(&self) -> String {
        self.gate.address()
    }

    /// Answers until the program ends.
    ///
    /// # Errors
    /// A server that stops.
    pub fn serve(self) -> Result<(), AppError> {
        let stopped = |source| AppError::Stopped { source };
        self.listener.set_nonblocking(true).map_err(stopped)?;
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(stopped)?;
        runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(self.listener).map_err(stopped)?;
            axum::serve(listener, routes(self.gate, self.shared)).await.map_err(stopped)
        })
    }
}

/// The commands of the program, from which pages make forms.
async fn commands(State(shared): State<Shared>) -> Answer {
    json(&shared.program.commands)
}

fn routes(gate: Arc<Gate>, shared: Shared) -> Router {
    let api = Router::new()
        .route("/state", get(recordings::state))
        .route("/commands", get(commands))
        .route("/channels", get(recordings::channels))
        .route("/view", get(recordings::view))
        .route("/stretch", get(stretches::figures))
        .route("/histogram", get(stretches::histogram))
        .route("/spectrum", get(stretches::spectrum))
        .route("/spectrogram", get(stretches::spectrogram))
        .route("/pairs", get(stretches::pairs))
        .route("/text", get(texts::read).put(texts::write))
        .route("/check", post(texts::check))
        .route("/change", post(texts::change))
        .route("/keys", get(texts::keys))
        .route("/roles", get(texts::roles))
        .route("/uses", post(labels::uses))
        .route("/label", post(labels::seen))
        .route("/draft", get(texts::draft).put(texts::keep_draft).delete(texts::drop_draft))
        .route("/report", get(texts::report))
        .route("/study", get(studies::read))
        .route("/models", get(models::list))
        .route("/pair", get(models::pair))
        .route("/dynamics", get(models::dynamics_of))
        .route("/campbell", get(campbell::maps))
        .route("/folded", get(campbell::folded))
        .route("/meet", get(models::meet))
        .route("/session", get(session::list).delete(session::begin))
        .route("/session/{kind}", get(session::file))
        .route("/jobs", get(jobs::list).post(jobs::start))
        .route("/jobs/{id}", get(jobs::show).delete(jobs::cancel))
        .route("/jobs/{id}/printed", get(jobs::printed))
        .route("/can", post(can::start))
        .route("/can/tests", get(can::tests))
        .route("/can/{key}", get(can::show).delete(can::forget))
        .route("/can/{key}/answer", get(can::answer))
        .route("/can/{key}/judged", get(can::judged))
        .route("/can/{key}/course", get(can::course))
        .route("/next", post(next::start))
        .route("/next/{key}", get(next::show).delete(next::forget))
        .route("/next/{key}/answer", get(next::answer))
        .with_state(shared);
    Router::new()
        .route("/", get(site::index))
        .route("/site/{*name}", get(site::file))
        .nest("/api", api)
        .route("/enter", get(enter).with_state(gate.clone()))
        .layer(DefaultBodyLimit::max(MOST_SENT))
        .layer(middleware::from_fn_with_state(gate, guard))
}
