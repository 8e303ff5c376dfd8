//! `mindgap demo`

use std::path::PathBuf;

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use super::checkpoint_args::{Checkpoint, CheckpointOption};
use super::json_output::JsonOption;
use super::table::{self, number};
use super::{Run, closed_loop, kinds, progress};
use mindgap_applications::demo::repair::Repair;
use mindgap_applications::demo::{self, Size, Stage, StartSummary, Summary};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_learning::evaluation::accuracy::Networks;
use mindgap_learning::evolve::fitness::Success;
use mindgap_pages::demo::page;

/// File name of the page in the output folder.
const PAGE: &str = "demo.html";

/// Run the whole pipeline on the built-in robot: record, train, evolve, test, export, plot.
///
/// Then weaken a motor, and let the loop diagnose and compensate for it. `demo.html` in the folder shows the results.
#[derive(Args)]
pub struct Demo {
    /// Output folder.
    #[arg(long, default_value = "mindgap-out")]
    out: PathBuf,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Run a short version: fewer logs, one start, a single run of the genetic algorithm as in the paper, one trial of
    /// the loop.
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    json: JsonOption,
    /// Write an HTML page.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    #[command(flatten)]
    checkpoint: CheckpointOption,
}

/// Results of `mindgap demo`.
#[derive(Serialize, JsonSchema)]
pub struct DemoResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// Accuracy of the networks on held-out logs.
    networks: &'a Networks,
    /// Success of each start's controller.
    starts: &'a [StartSummary],
    /// How the loop corrected a fault.
    repair: RepairResults,
}

/// What the loop did about a fault of the robot.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Repair")]
struct RepairResults {
    /// The injected fault, as ID=STRENGTH.
    changed: String,
    /// Number of the start, from 1.
    start: usize,
    /// Success of the original controller on the changed robot.
    before: Success,
    /// Number of trials on the changed robot.
    trials: usize,
    /// Success of the loop's final controller on the changed robot.
    after: Success,
}

impl Run for Demo {
    fn places(&self) -> Places {
        let places = Places::default().filling([&self.out]).writing(self.json.path(), kinds::REPORT);
        places.writing(&self.html, kinds::PAGE).writing(self.checkpoint.path(), kinds::CHECKPOINT)
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        let size = if self.quick { Size::QUICK } else { Size::USUAL };
        let bar = progress::shares();
        let watch = |stage: Stage| {
            let words = match stage {
                Stage::Recording => "recording logs of the built-in robot".into(),
                Stage::Training(ref p) => progress::training_words(&p.network, p.evaluations),
                Stage::Evolving { start, generation, generations } => {
                    format!("evolving for start {start}: generation {} of {generations}", generation + 1)
                }
                Stage::Drawing => "drawing".into(),
                Stage::Repairing { trial } => format!("weak motor: trial {trial} on the robot"),
            };
            progress::at(&bar, share_before(&stage, size), words);
        };
        let summary = demo::run(executor, &self.out, self.seed, size, watch)?;
        bar.finish_and_clear();
        let page = page(&summary, &self.out.display().to_string(), self.seed);
        let in_folder = self.out.join(PAGE);
        for path in self.html.iter().chain([&in_folder]) {
            files::write(path, &page)?;
        }
        let text = format!(
            "{}\n{}\nlogs, simulator, controllers, NXC programs and figures are in {}; open {} for an overview\n",
            describe(&summary, size),
            repaired(&summary.repair),
            self.out.display(),
            in_folder.display()
        );
        self.json.emit_sorted(&results(&summary), text)
    }

    fn checkpoint(&self) -> Option<Checkpoint> {
        self.checkpoint.for_output(&self.out)
    }
}

/// Returns the approximate share of the run time that is over at a stage.
fn share_before(stage: &Stage, size: Size) -> f64 {
    match stage {
        Stage::Recording => 0.0,
        Stage::Training(_) => 0.05,
        Stage::Evolving { start, generation, generations } => {
            0.15 + 0.6 * ((start - 1) as f64 + *generation as f64 / *generations as f64) / size.starts as f64
        }
        Stage::Drawing => 0.75,
        Stage::Repairing { trial } => 0.8 + 0.2 * (trial - 1) as f64 / size.trials as f64,
    }
}

fn results(summary: &Summary) -> DemoResults<'_> {
    let Repair { changed, start, before, state, after } = &summary.repair;
    let (changed, trials) = (changed.to_string(), state.trials.len());
    DemoResults {
        schema: SchemaNumber,
        networks: &summary.evaluation.networks,
        starts: &summary.starts,
        repair: RepairResults { changed, start: *start, before: *before, trials, after: *after },
    }
}

fn describe(summary: &Summary, size: Size) -> String {
    let percent = |rate: f64| format!("{:.0} %", 100.0 * rate);
    let rows: Vec<[String; 5]> = summary
        .starts
        .iter()
        .enumerate()
        .map(|(i, s)| {
            [
                format!("start {}", i + 1),
                percent(s.simulated.rate),
                number(Some(s.simulated.median_cm), 1),
                percent(s.real.rate),
                number(Some(s.real.median_cm), 1),
            ]
        })
        .collect();
    let header = ["controller for", "simulated: reached", "median (cm)", "robot: reached", "median (cm)"];
    let chosen = format!("best of {} controllers per start, chosen by one trial each on the robot\n", demo::TRIED);
    format!(
        "{}\n{}{}",
        super::evaluate::accuracy(&summary.evaluation.networks),
        table::text(header, &rows),
        if size.paper { "" } else { &chosen }
    )
}

/// Returns what the loop did about the changed robot.
fn repaired(repair: &Repair) -> String {
    let percent = |rate: f64| format!("{:.0} %", 100.0 * rate);
    let trials: String = repair.state.trials.iter().map(|trial| format!("  {}\n", closed_loop::line(trial))).collect();
    format!(
        "with {} injected, the controller of start {} reaches the target in {} of its runs\n{trials}the loop's controller \
         reaches it in {} (loop/paths.png)\n",
        repair.changed,
        repair.start,
        percent(repair.before.rate),
        percent(repair.after.rate)
    )
}
