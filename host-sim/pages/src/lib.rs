//! Pages for a browser: the results of a command in one file that opens from disk, on a phone, in the dark and in print. Module
//! [`text`] has results for one screen of a terminal.
//!
//! There is one module per page. Words, tables and charts are made here, and all words are escaped; scripts only move what
//! moves, the replay and sorted tables.

pub mod demo;
pub mod diagnosis;
pub mod evaluation;
pub mod fleet;
pub mod logs;
pub mod simulation;
pub mod text;
pub mod trials;
pub mod words;

mod document;
mod glossary;
#[cfg(test)]
mod made_up;
mod rates;
mod replay;
