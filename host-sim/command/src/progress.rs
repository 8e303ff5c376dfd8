//! Progress bars on a terminal; none in a pipe or with `--quiet`.

use std::ops::Range;
use std::sync::LazyLock;
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use log::LevelFilter;

use mindgap_learning::learn::train::{NETWORKS, Progress};

/// All bars of this process, so that other lines can be written without crossing them.
static BARS: LazyLock<MultiProgress> = LazyLock::new(|| {
    let target = if is_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    MultiProgress::with_draw_target(target)
});
/// Shown while the amount of work is unknown, until a bar replaces it.
static SPINNER: LazyLock<ProgressBar> = LazyLock::new(ProgressBar::new_spinner);

/// Returns whether only errors are printed.
pub fn is_quiet() -> bool {
    log::max_level() < LevelFilter::Warn
}

/// Shows a spinner with the name of a command and the elapsed time.
pub fn begin(command: String) {
    // A bar must join `BARS` before it is changed, or it would be drawn even if hidden.
    add(&SPINNER, "{spinner} {msg} [{elapsed}]");
    SPINNER.set_message(command);
}

/// Removes the spinner of [`begin`].
pub fn end() {
    SPINNER.finish_and_clear();
}

/// Returns a bar for `steps` steps, with the estimated time left.
pub fn bar(steps: u64) -> ProgressBar {
    shown(steps, "{bar:30} {pos}/{len} [{elapsed}, about {eta} left] {msg}")
}

/// Returns a bar in percent, with the estimated time left.
pub fn shares() -> ProgressBar {
    shown(100, "{bar:30} {pos} % [{elapsed}, about {eta} left] {msg}")
}

/// Returns a callback `(done, total)` that moves the bar.
pub fn counting(bar: &ProgressBar) -> impl Fn(usize, usize) + Sync + '_ {
    |done, of| {
        bar.set_length(of as u64);
        bar.set_position(done as u64);
    }
}

/// Returns a callback `(done, total)` that moves a bar of [`shares`] through `part`, in percent.
pub fn part<'b>(bar: &'b ProgressBar, part: Range<u64>, what: &'static str) -> impl Fn(usize, usize) + Sync + 'b {
    bar.set_message(what);
    move |done, of| bar.set_position(part.start + (part.end - part.start) * done as u64 / of.max(1) as u64)
}

/// Moves a bar of [`shares`] to a share of the work, 0..=1, and shows the current activity.
pub fn at(bar: &ProgressBar, share: f64, what: String) {
    bar.set_position((100.0 * share) as u64);
    bar.set_message(what);
}

/// Calls `write` while all bars are hidden.
pub fn suspended(write: impl FnOnce()) {
    BARS.suspend(write);
}

/// Moves a bar over the networks, which are trained in sequence.
pub fn training(bar: &ProgressBar, Progress { network, evaluations }: Progress) {
    match NETWORKS.iter().position(|name| *name == network) {
        Some(place) => bar.set_position(place as u64),
        // The networks of further range sensors come last.
        None if evaluations == 0 => bar.set_position((bar.position() + 1).max(NETWORKS.len() as u64)),
        None => {}
    }
    bar.set_message(training_words(&network, evaluations));
}

/// Returns a description of the current state of training.
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
    bar.set_style(ProgressStyle::with_template(template).expect("the template is valid"));
    // Ticking takes a thread, so hidden bars do without.
    if !BARS.is_hidden() {
        bar.enable_steady_tick(Duration::from_secs(1));
    }
}
