//! Pages in a real browser: they draw, move, print, fit phones and laptops, keep people out who write markup into names,
//! and say nothing in the console.
//!
//! Needs Chromium, and puppeteer and axe-core, which `tests/run.sh` installs. Pictures of every page are left in
//! `target/pages`.

mod diagnosis;
mod fleet;
mod logs;
mod others;
mod trials;
mod visit;
