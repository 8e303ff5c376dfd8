//! Progress on a terminal; nothing in a pipe, nor with `--quiet`.

use std::ops::Range;
use std::sync::LazyLock;
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use log::LevelFilter;

use mindgap_learning::learn::train::{NETWORKS, Progress};

/// All bars of this process, so that other lines can be written beside them.
static BARS: LazyLock<MultiProgress> = LazyLock::new(|| {
    let target = if is_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    MultiProgress::with_draw_target(target)
});
/// Stands where the length of the work is not known, until a bar does.
static SPINNER: LazyLock<ProgressBar> = LazyLock::new(ProgressBar::new_spinner);

/// Whether nothing but errors is said.
pub fn is_quiet() -> bool {
    log::max_level() < LevelFilter::Warn
}

/// Shows that a command is at work, and for how long already.
pub fn begin(command: String) {
    // What is said before it is one of all would be drawn even when nothing is to be.
    add(&SPINNER, "{spinner} {msg} [{elapsed}]");
    SPINNER.set_message(command);
}

/// Takes away what [`begin`] shows.
pub fn end() {
    SPINNER.finish_and_clear();
}

/// A bar for so many steps, with the time left.
pub fn bar(steps: u64) -> ProgressBar {
    shown(steps, "{bar:30} {pos}/{len} [{elapsed}, about {eta} left] {msg}")
}

/// A bar for work of which the share in percent is known that is done, with the time left.
pub fn shares() -> ProgressBar {
    shown(100, "{bar:30} {pos} % [{elapsed}, about {eta} left] {msg}")
}

/// Moves a bar as so many of so many are done.
pub fn counting(bar: &ProgressBar) -> impl Fn(usize, usize) + Sync + '_ {
    |done, of| {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    }
}

/// Moves a bar of [`shares`] through the part of the work in percent that is this, as so many of so many are done.
pub fn part<'b>(bar: &'b ProgressBar, part: Range<u64>, what: &'static str) -> impl Fn(usize, usize) + Sync + 'b {
    bar.set_message(what);
    move |done, of| bar.set_position(part.start + (part.end - part.start) * done as u64 / of.max(1) as u64)
}

/// Moves a bar of [`shares`] to a share of the work, 0..=1, and says what is being done.
pub fn at(bar: &ProgressBar, share: f64, what: String) {
    bar.set_position((100.0 * share) as u64);
    bar.set_message(what);
}

/// Writes something that a bar must not cross.
pub fn beside(write: impl FnOnce()) {
    BARS.suspend(write);
}

/// Moves a bar of networks that are trained one after the other.
pub fn training(bar: &ProgressBar, Progress { network, evaluations }: Progress) {
    let place = NETWORKS.iter().position(|name| *name == network);
    bar.set_position(place.unwrap_or_default() as u64);
    bar.set_message(training_words(network, evaluations));
}

/// What training is at.
pub fn training_words(network: &str, evaluations: usize) -> String {
    match evaluations {
        0 => format!("training {network}"),
        evaluations => format!("training {network}: {evaluations} networks evaluated"),
    }
}

fn shown(length: u64, template: &str) -> ProgressBar {
    end();
    let bar = ProgressBar::new(length);
    add(&bar, template);
    bar
}

fn add(bar: &ProgressBar, template: &str) {
    let bar = BARS.add(bar.clone());
    bar.set_style(ProgressStyle::with_template(template).expect("the template is right"));
    // It takes a thread, and there may be none left: not where nobody sees it.
    if !BARS.is_hidden() {
        bar.enable_steady_tick(Duration::from_secs(1));
    }
}
