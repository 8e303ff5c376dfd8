//! Pages in a real browser: they draw, move, print, fit phones and laptops, and say nothing in the console.
//!
//! Needs Chromium and axe-core, which `tests/run.sh` installs. Screenshots of every page are left in `target/pages`.

mod browser;
mod diagnosis;
mod others;
