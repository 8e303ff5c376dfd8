//! Progress on a terminal; nothing in a pipe.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::learn::train::Progress;

/// A line that tells what is being done, with a spinner and the time gone by.
pub fn spinner() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    bar.set_style(ProgressStyle::with_template("{spinner} [{elapsed}] {msg}").expect("the template is right"));
    bar
}

/// A bar for so many steps of known number.
pub fn bar(steps: u64) -> ProgressBar {
    let bar = ProgressBar::new(steps);
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} [{elapsed}] {msg}").expect("the template is right");
    bar.set_style(style);
    bar
}

/// A bar for work of which the share is known that is done, with the time left.
pub fn shares() -> ProgressBar {
    let bar = ProgressBar::new(100);
    let template = "{bar:30} {pos} % [{elapsed}, about {eta} left] {msg}";
    bar.set_style(ProgressStyle::with_template(template).expect("the template is right"));
    bar.enable_steady_tick(Duration::from_secs(1));
    bar
}

/// What training is at.
pub fn training(progress: &Progress) -> String {
    match progress.evaluations {
        0 => format!("training {}", progress.network),
        evaluations => format!("training {}: {evaluations} networks evaluated", progress.network),
    }
}
