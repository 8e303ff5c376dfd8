//! What the page in a browser asks for: the work of some subcommands of `mindgap`, with files that the page holds.
//!
//! A [`Request`](request::Request) is answered by [`request::answer`], which reports progress and warnings on the way. On
//! WebAssembly, `exports` connects both with JavaScript. There is one module per kind of request; each gives the same texts and
//! bytes as the subcommand of its name.

pub mod archive;
pub mod check;
pub mod diagnose;
pub mod drive;
pub mod import;
pub mod record;
pub mod report;
pub mod request;
pub mod train;

#[cfg(target_family = "wasm")]
mod exports;
