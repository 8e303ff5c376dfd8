//! `mindgap serve`

use std::net::Ipv4Addr;
use std::path::PathBuf;

use clap::Args;
use tiny_http::{Header, Method, Response, Server};

use super::{Run, logging};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;

/// Serve the page that checks and diagnoses logs in a browser, to this computer only.
#[derive(Args)]
pub struct Serve {
    /// The page, as host-sim/browser/build.sh makes it (default: the one in this program, which releases have).
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Port of the page's address.
    #[arg(long, value_name = "N", default_value_t = 8000)]
    port: u16,
}

/// The page in this program; empty if it was built without one.
const BUILT_IN: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/page.html"));
/// Largest page.
const MAX_BYTES: u64 = 16 << 20;

impl Run for Serve {
    fn places(&self) -> Places {
        Places::default().reading(&self.page)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let page = match &self.page {
            Some(path) => files::read_bytes(path, MAX_BYTES)?,
            None if BUILT_IN.is_empty() => {
                let what = "this program was built without the page: make it with host-sim/browser/build.sh, then give it with --page";
                return Err(Error::new(what));
            }
            None => BUILT_IN.to_owned(),
        };
        let failed = |why: &dyn std::fmt::Display| Error::new(format!("port {}: {why}", self.port));
        let server = Server::http((Ipv4Addr::LOCALHOST, self.port)).map_err(|e| failed(&e))?;
        logging::status(&format!("http://{} is open until Ctrl-C ends it", server.server_addr()));
        let html = Header::from_bytes("Content-Type", "text/html; charset=utf-8").expect("a valid header");
        loop {
            let request = server.recv().map_err(|e| failed(&e))?;
            let response = match (request.method(), request.url()) {
                (Method::Get, "/") => Response::from_data(page.as_slice()).with_header(html.clone()),
                _ => Response::from_data(Vec::new()).with_status_code(404),
            };
            if let Err(why) = request.respond(response) {
                log::info!("a browser ended its request: {why}");
            }
        }
    }
}
