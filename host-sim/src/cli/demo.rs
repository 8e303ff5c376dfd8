//! `mindgap demo`

use std::path::PathBuf;

use clap::Args;

use super::table::{self, number};
use super::{Run, kinds, progress, trials};
use crate::demo::repair::Repair;
use crate::demo::{self, Stage, Summary};
use crate::error::Result;
use crate::evolve::robust;
use crate::files;
use crate::files::places::Places;
use crate::page::demo::page;

/// Do the whole job on the built-in robot: record, train, evolve, try, export, draw; then weaken a motor, and let the loop
/// find out and repair it.
#[derive(Args)]
pub struct Demo {
    /// Where to leave everything.
    #[arg(long, default_value = "mindgap-out")]
    out: PathBuf,
    /// Fixes every draw.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Also write a page for a browser here.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

impl Run for Demo {
    fn places(&self) -> Places {
        Places::default().writing(&self.html, kinds::PAGE).filling([&self.out])
    }

    fn run(&self) -> Result<String> {
        let line = progress::spinner();
        let watch = |stage: Stage| {
            line.set_message(match stage {
                Stage::Recording => "recording logs of the built-in robot".into(),
                Stage::Training(p) => progress::training(&p),
                Stage::Evolving { start, generation } => {
                    format!("evolving for start {start}: generation {generation} of {}", robust::GENERATIONS)
                }
                Stage::Drawing => "drawing".into(),
                Stage::Repairing { trial } => format!("a motor got weak: trial {trial} on the robot"),
            });
            line.tick();
        };
        let summary = demo::run(&self.out, self.seed, watch)?;
        line.finish_and_clear();
        if let Some(path) = &self.html {
            files::write(path, page(&summary, &self.out.display().to_string(), self.seed)?)?;
        }
        let out = self.out.display();
        Ok(format!(
            "{}\n{}\nlogs, simulator, controllers, NXC programs and pictures are in {out}\n",
            told(&summary),
            repaired(&summary.repair)
        ))
    }
}

fn told(summary: &Summary) -> String {
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
    format!(
        "{}\n{}of {} controllers a start, that which did best in one trial on the robot\n",
        super::evaluate::accuracy(&summary.evaluation.networks),
        table::text(header, &rows),
        robust::RESTARTS
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
