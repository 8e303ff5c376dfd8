//! Pages for a browser: what a command found, whole in one file that opens from disk, on a phone, in the dark and in print.
//!
//! There is one module a page. Words and tables are made here, and everything that is put into them is escaped; charts are
//! drawn in the browser by libraries that the page carries (`assets/vendor`), from data that it carries too.

pub mod demo;
pub mod diagnosis;
pub mod evaluation;
pub mod fleet;
pub mod simulation;
pub mod trials;
pub mod words;

mod document;
mod glossary;
mod replay;
mod room;
