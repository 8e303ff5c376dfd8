//! `mindgap crosscheck`

use std::path::PathBuf;

use clap::{Args, value_parser};

use super::json_output::JsonOption;
use super::{Run, kinds, progress, table, textbook};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_learning::crosscheck::{self, Divergence, NetworkCheck, Networks, RunState, Runs, Trials};
use mindgap_logs::controller_file::ControllerFile;

/// Compare fixed point, as on a board without floating point, with float on every sample.
#[derive(Args)]
pub struct Crosscheck {
    /// The simulator file.
    sim: PathBuf,
    /// Folder of logs.
    logs: PathBuf,
    /// Controller to run (default: random controllers).
    #[arg(long)]
    controller: Option<PathBuf>,
    /// Number of runs.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = value_parser!(u32).range(1..=1_000_000))]
    runs: u32,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    json: JsonOption,
}

impl Run for Crosscheck {
    fn places(&self) -> Places {
        let inputs = [&self.sim, &self.logs].into_iter().chain(&self.controller);
        Places::default().reading(inputs).writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let simulator = textbook::simulator(&self.sim)?;
        let read = |path: &PathBuf| ControllerFile::read_for(path, &simulator.robot);
        let file = self.controller.as_ref().map(read).transpose()?;
        if let (Some(file), Some(path)) = (&file, &self.controller) {
            file.check_asks(simulator.first_sensor()).map_err(|error| error.or_in_file(path))?;
        }
        let controller = file.map(|file| file.controller);
        let logs = super::read_logs_of(&simulator, &self.logs)?;
        let trials = Trials { runs: self.runs as usize, seed: self.seed };
        let bar = progress::bar(self.runs.into());
        let found = crosscheck::crosscheck(&simulator, &logs, controller.as_ref(), trials, progress::counting(&bar));
        bar.finish_and_clear();
        let found = found.map_err(|error| error.or_in_file(&self.sim))?;
        self.json.emit(&found, networks(&found.networks) + "\n" + &runs(&found.runs))
    }
}

/// Returns the differences between fixed point and float as a table.
fn networks(networks: &Networks) -> String {
    let Networks { turn, forward, lateral, echo_probability, echo_value } = networks;
    let named = [
        ("turn (deg)", turn),
        ("forward (cm)", forward),
        ("lateral (cm)", lateral),
        ("echo probability", echo_probability),
        ("echo value (cm)", echo_value),
    ];
    let rows = named.map(|(name, NetworkCheck { error_bound, samples, grid })| {
        let number = |x: f64| format!("{x:.6}");
        let [worst, mean, grid_worst, grid_mean, bound] =
            [samples.worst, samples.mean, grid.worst, grid.mean, *error_bound].map(number);
        [name.into(), samples.n.to_string(), worst, mean, grid_worst, grid_mean, bound]
    });
    let header = ["fixed - float", "samples", "worst", "mean", "grid worst", "grid mean", "bound"];
    let clamped = named.iter().filter(|(_, check)| check.samples.clamped > 0);
    let clamped = clamped.map(|(name, NetworkCheck { samples, .. })| {
        format!("{name}: {} of {} samples are outside the trained range\n", samples.clamped, samples.n)
    });
    let bound = "bound: upper limit of the fixed-point error; float32 error not included\n";
    table::text(header, &rows) + bound + &clamped.collect::<String>()
}

/// Returns how far the runs in fixed point follow those in float.
fn runs(runs: &Runs) -> String {
    let share = 100.0 * runs.same_share();
    let largest = &runs.largest_difference;
    let diverged = match &runs.first_divergence {
        None => "No run diverges.\n".into(),
        Some(Divergence { run, step, float, fixed }) => format!(
            "{} runs diverge; the first is run {run}, at step {step}:\n  float {}\n  fixed {}\n",
            runs.diverged,
            state(float),
            state(fixed)
        ),
    };
    format!(
        "{} runs, {} steps: the same decision in {share:.3} % of the steps.\n\
         Until they diverge, runs differ by at most {:.4} cm and {:.4} degrees.\n{diverged}",
        runs.n, runs.steps, largest.position_cm, largest.heading_deg
    )
}

fn state(state: &RunState) -> String {
    let reading = state.echo_cm.map_or("no reading".into(), |cm| format!("reading {cm:.3} cm"));
    let end = if state.crashed { ", crashed" } else { "" };
    format!(
        "({:.3}, {:.3}) cm, {:.3} degrees, {reading}, tuple {}{end}",
        state.x_cm, state.y_cm, state.heading_deg, state.tuple
    )
}
