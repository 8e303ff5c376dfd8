//! `mindgap demo`

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::facts::FactsOption;
use super::lasting::{KeepOption, Kept};
use super::table::{self, number};
use super::{Run, kinds, progress, trials};
use mindgap_applications::demo::repair::Repair;
use mindgap_applications::demo::{self, Size, Stage, StartSummary, Summary};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_learning::evolve::fitness::Success;
use mindgap_pages::demo::page;

/// The page among what the demo leaves.
const PAGE: &str = "demo.html";

/// Do the whole job on the built-in robot: record, train, evolve, try, export, draw.
///
/// Then weaken a motor, and let the loop find out and repair it. `demo.html` in the folder is a page of all of it.
#[derive(Args)]
pub struct Demo {
    /// Where to leave everything.
    #[arg(long, default_value = "mindgap-out")]
    out: PathBuf,
    /// Fixes every draw.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Do little of everything, to see what comes of it: fewer logs, one start, the paper's one run of the genetic
    /// algorithm, one run of the loop.
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    facts: FactsOption,
    /// Also write a page for a browser here.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    #[command(flatten)]
    keep: KeepOption,
}

impl Run for Demo {
    fn places(&self) -> Places {
        let places = Places::default().filling([&self.out]).writing(self.facts.asked(), kinds::REPORT);
        places.writing(&self.html, kinds::PAGE).writing(self.keep.asked(), kinds::CHECKPOINT)
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        let size = if self.quick { Size::QUICK } else { Size::USUAL };
        let bar = progress::shares();
        let watch = |stage: Stage| {
            let words = match stage {
                Stage::Recording => "recording logs of the built-in robot".into(),
                Stage::Training(p) => progress::training_words(p.network, p.evaluations),
                Stage::Evolving { start, generation, generations } => {
                    format!("evolving for start {start}: round {} of {generations}", generation + 1)
                }
                Stage::Drawing => "drawing".into(),
                Stage::Repairing { trial } => format!("a motor got weak: trial {trial} on the robot"),
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
            "{}\n{}\nlogs, simulator, controllers, NXC programs and pictures are in {}, and a page of it all is {}\n",
            told(&summary, size),
            repaired(&summary.repair),
            self.out.display(),
            in_folder.display()
        );
        self.facts.told(&facts(&summary), text)
    }

    fn kept(&self) -> Option<Kept> {
        self.keep.beside(&self.out)
    }
}

/// The share of the time that has gone by at a stage, roughly.
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

fn facts(summary: &Summary) -> Value {
    let success = |of: &Success| json!({"success": of.rate, "crashed": of.crashed, "median_cm": of.median_cm});
    let start = |of: &StartSummary| json!({"simulated": success(&of.simulated), "real": success(&of.real)});
    let starts: Vec<Value> = summary.starts.iter().map(start).collect();
    let Repair { changed, start, before, state, after } = &summary.repair;
    let repair = json!({
        "changed": changed.to_string(), "start": start, "before": success(before), "trials": state.trials.len(),
        "after": success(after),
    });
    json!({"schema": 1, "networks": summary.evaluation.networks, "starts": starts, "repair": repair})
}

fn told(summary: &Summary, size: Size) -> String {
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
    let chosen = format!("of {} controllers a start, that which did best in one trial on the robot\n", demo::TRIED);
    format!(
        "{}\n{}{}",
        super::evaluate::accuracy(&summary.evaluation.networks),
        table::text(header, &rows),
        if size.paper { "" } else { &chosen }
    )
}

/// What the loop did about a change of the robot.
fn repaired(repair: &Repair) -> String {
    let percent = |rate: f64| format!("{:.0} %", 100.0 * rate);
    let trials: String = repair.state.trials.iter().map(|trial| format!("  {}\n", trials::line(trial))).collect();
    format!(
        "then {} changes the robot: the controller of start {} reaches the target in {} of its runs\n{trials}the loop's \
         controller reaches it in {} (loop/paths.png)\n",
        repair.changed,
        repair.start,
        percent(repair.before.rate),
        percent(repair.after.rate)
    )
}
