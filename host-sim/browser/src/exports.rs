//! The functions by which JavaScript calls this module, and those of JavaScript that it calls.
//!
//! JavaScript asks for [`room`], writes a [`Call`] as JSON into it, and calls [`run`], which reads files with `read_at` and
//! hands over each message with `report`. An instance serves one call.

#![expect(unsafe_code, reason = "memory is shared with JavaScript")]

use std::cell::RefCell;
use std::panic;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use mindgap_files::source::{Held, hold};
use rayon::ThreadPoolBuilder;
use serde::Deserialize;

use crate::report::Report;
use crate::request::{Request, answer};

/// A request and the files that it may read.
#[derive(Deserialize)]
struct Call {
    files: Vec<File>,
    request: Request,
}

/// A file that JavaScript reads when it is asked to.
#[derive(Deserialize)]
struct File {
    path: PathBuf,
    size: u64,
    /// When it was last modified, ms since 1970.
    modified_ms: u64,
}

/// Functions of JavaScript. Offsets are numbers, because JavaScript has no other cheap type for them.
mod outside {
    #[link(wasm_import_module = "page")]
    unsafe extern "C" {
        /// Copies at most `count` bytes of a file from `offset` on to memory, and returns their number.
        pub fn read_at(file: usize, offset: f64, to: *mut u8, count: usize) -> usize;
        /// Takes a message as JSON.
        pub fn report(text: *const u8, length: usize);
    }
}

thread_local! {
    static ROOM: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// Returns the address of `length` bytes, into which a call is to be written.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: usize) -> *mut u8 {
    ROOM.with_borrow_mut(|room| {
        room.resize(length, 0);
        room.as_mut_ptr()
    })
}

/// Answers the call in the room.
#[unsafe(no_mangle)]
pub extern "C" fn run() {
    panic::set_hook(Box::new(|defect| report(Report::Error(format!("a defect of mindgap ended this: {defect}")))));
    // There are no further threads; without this, work would wait for them.
    let threads = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    threads.expect("an instance serves one call");
    let call = ROOM.with_borrow(|room| serde_json::from_slice::<Call>(room));
    let Call { files, request } = call.expect("the page makes valid calls");
    let held = |File { path, size, modified_ms }| {
        let modified = Some(SystemTime::UNIX_EPOCH + Duration::from_millis(modified_ms));
        Held { path, size, modified }
    };
    hold(files.into_iter().map(held).collect(), read_at);
    report(answer(&request, &report).map_or_else(|error| Report::Error(error.to_string()), Report::Answer));
}

fn read_at(file: usize, offset: u64, buffer: &mut [u8]) -> usize {
    // SAFETY: JavaScript writes at most this number of bytes, and returns how many it wrote.
    unsafe { outside::read_at(file, offset as f64, buffer.as_mut_ptr(), buffer.len()) }
}

fn report(report: Report) {
    let text = serde_json::to_string(&report).expect("messages are texts and numbers");
    // SAFETY: JavaScript copies the bytes before it returns.
    unsafe { outside::report(text.as_ptr(), text.len()) }
}
