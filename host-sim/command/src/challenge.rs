//! `mindgap challenge`: a blind test of `mindgap diagnose`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::checkpoint_args::{Checkpoint, CheckpointOption};
use super::choices::{OUTSIDE, one_of};
use super::json_output::JsonOption;
use super::{Run, kinds, progress};
use mindgap_applications::challenge::Folder;
use mindgap_applications::challenge::answer::answer;
use mindgap_applications::challenge::calibrate::calibrate;
use mindgap_applications::challenge::cases::{Echoes, Outside, Setting, Size};
use mindgap_applications::challenge::coverage::form_errors;
use mindgap_applications::challenge::make::make;
use mindgap_applications::challenge::score::{Score, score};
use mindgap_applications::challenge::sensitivity::{Row, sensitivity};
use mindgap_applications::challenge::share::Share;
use mindgap_diagnosis::interval::FormErrors;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;

/// Blind-test the diagnosis: generate cases with hidden faults, diagnose them, score the answers.
#[derive(Args)]
pub struct Challenge {
    #[command(subcommand)]
    part: Part,
}

#[derive(Subcommand)]
enum Part {
    /// Generate cases of the built-in robot, with the injected faults sealed.
    Make {
        /// Number of cases.
        #[arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..))]
        cases: u32,
        /// Random seed.
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u64,
        /// Set of unknown effects: effects outside the catalogue are drawn from it.
        #[arg(long, value_parser = one_of::<Outside>(OUTSIDE), default_value = "usual")]
        outside: Outside,
        /// Give all robots a sensor whose echo strength depends more on location than on random noise, with a different pattern in each room.
        #[arg(long)]
        place_bound: bool,
        #[command(flatten)]
        size: SizeOption,
        /// Folder to write the challenge to.
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        #[command(flatten)]
        checkpoint: CheckpointOption,
    },
    /// Fit the thresholds of the diagnosis to cases of other seeds whose faults are known.
    Calibrate {
        /// Number of cases.
        #[arg(long, value_name = "N", default_value_t = 200)]
        cases: u32,
        /// Random seed; use another than the challenge's.
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u64,
        /// File to write the thresholds to; builds use host-sim/diagnosis/src/calibration.toml.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Also write the measurements of every case as CSV.
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
        /// Also write how much a better form of each effect could gain; builds use host-sim/diagnosis/src/further_shares.toml.
        #[arg(long, value_name = "FILE")]
        further_shares: Option<PathBuf>,
        #[command(flatten)]
        size: SizeOption,
        #[command(flatten)]
        checkpoint: CheckpointOption,
    },
    /// Print the sensitivity to each threshold: halved and doubled, on cases whose faults are known.
    Sensitivity {
        /// Number of cases.
        #[arg(long, value_name = "N", default_value_t = 60)]
        cases: u32,
        /// Random seed; use another than the challenge's.
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u64,
        /// Also write the table as CSV.
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
    },
    /// Diagnose every case.
    Answer {
        /// Folder of the challenge.
        folder: PathBuf,
        #[command(flatten)]
        checkpoint: CheckpointOption,
    },
    /// Break the seal and score the answers.
    Score {
        /// Folder of the challenge.
        folder: PathBuf,
        #[command(flatten)]
        json: JsonOption,
        /// Also write the outcome of every case as CSV.
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
        /// Also write the form errors that would give 95 % intervals their nominal coverage; builds use host-sim/diagnosis/src/form_errors.toml.
        #[arg(long, value_name = "FILE")]
        form_errors: Option<PathBuf>,
    },
}

/// Amount of data per case.
#[derive(Args)]
struct SizeOption {
    /// Use little data, to try the command: six short runs per case, and eight to train each robot's simulator. The
    /// scores of such cases mean nothing.
    #[arg(long)]
    quick: bool,
}

impl SizeOption {
    fn size(&self) -> Size {
        if self.quick { Size::QUICK } else { Size::USUAL }
    }
}

impl Run for Challenge {
    fn places(&self) -> Places {
        let checkpoint = self.checkpoint_option().and_then(|(checkpoint, _)| checkpoint.path().as_ref());
        let places = Places::default().writing(checkpoint, kinds::CHECKPOINT);
        match &self.part {
            Part::Make { out, .. } => places.filling([out]),
            Part::Calibrate { out, csv, further_shares, .. } => places
                .writing([out], kinds::CALIBRATION)
                .writing(further_shares, kinds::CALIBRATION)
                .writing(csv, kinds::UNSIGNED),
            Part::Sensitivity { csv, .. } => places.writing(csv, kinds::UNSIGNED),
            Part::Answer { folder, .. } => places.reading([folder]).filling([&Folder(folder).answers()]),
            Part::Score { folder, json, csv, form_errors } => places
                .reading([folder])
                .writing(json.path(), kinds::REPORT)
                .writing(csv, kinds::UNSIGNED)
                .writing(form_errors, kinds::FORM_ERRORS),
        }
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        match &self.part {
            Part::Make { cases, seed, outside, place_bound, size, out, .. } => {
                let echoes = if *place_bound { Echoes::PlaceBound } else { Echoes::Fresh };
                let bar = progress::bar(u64::from(*cases));
                let setting = Setting { outside: *outside, echoes, size: size.size() };
                make(executor, out, *cases as usize, *seed, setting, progress::counting(&bar))?;
                bar.finish_and_clear();
                Ok(format!("{}: {cases} cases; sealed.json holds the injected faults\n", out.display()))
            }
            Part::Calibrate { cases, seed, out, csv, further_shares: shares, size, .. } => {
                let bar = progress::bar(u64::from(*cases));
                let (calibration, further_shares, measured) =
                    calibrate(executor, *cases as usize, *seed, size.size(), progress::counting(&bar))?;
                bar.finish_and_clear();
                let quick = if size.quick { " --quick" } else { "" };
                let command =
                    format!("mindgap challenge calibrate --cases {cases} --seed {seed}{quick} --out {}", out.display());
                files::write(out, calibration.to_text(&command))?;
                if let Some(path) = shares {
                    files::write(path, further_shares.to_text(&command))?;
                }
                if let Some(path) = csv {
                    files::write_csv(path, &measured)?;
                }
                Ok(format!("{}: thresholds from {cases} cases\n", out.display()))
            }
            Part::Sensitivity { cases, seed, csv } => {
                let bar = progress::bar(0);
                let rows = sensitivity(executor, *cases as usize, *seed, progress::counting(&bar))?;
                bar.finish_and_clear();
                if let Some(path) = csv {
                    files::write_csv(path, &rows)?;
                }
                Ok(table(&rows))
            }
            Part::Answer { folder, .. } => {
                let bar = progress::bar(0);
                let count = answer(executor, folder, progress::counting(&bar))?;
                bar.finish_and_clear();
                Ok(format!("{}: {count} cases diagnosed\n", folder.display()))
            }
            Part::Score { folder, json, csv, form_errors: errors } => {
                let bar = progress::bar(0);
                let score = score(folder, progress::counting(&bar))?;
                bar.finish_and_clear();
                if let Some(path) = csv {
                    files::write_csv(path, &score.cases)?;
                }
                if let Some(path) = errors {
                    files::write(path, form_errors(&score.measured, FormErrors::shipped()).to_text())?;
                }
                json.emit(&score, text(&score))
            }
        }
    }

    fn checkpoint(&self) -> Option<Checkpoint> {
        self.checkpoint_option().and_then(|(checkpoint, out)| checkpoint.for_output(&out))
    }

    fn is_shared(&self) -> bool {
        !matches!(self.part, Part::Score { .. })
    }
}

impl Challenge {
    /// Returns the checkpoint option and the output of the parts that have one.
    fn checkpoint_option(&self) -> Option<(&CheckpointOption, PathBuf)> {
        match &self.part {
            Part::Make { checkpoint, out, .. } | Part::Calibrate { checkpoint, out, .. } => {
                Some((checkpoint, out.clone()))
            }
            Part::Answer { checkpoint, folder } => Some((checkpoint, Folder(folder).answers())),
            Part::Sensitivity { .. } | Part::Score { .. } => None,
        }
    }
}

/// Returns the sensitivity table, which begins with the unchanged calibration.
fn table(rows: &[Row]) -> String {
    let head = ["threshold", "value", "false alarms", "named", "called unknown", "unknowns", "wrong"];
    let line = |cells: [String; 7]| {
        let [name, others @ ..] = cells;
        others.iter().fold(format!("{name:<28}"), |line, cell| line + &format!("{cell:>15}"))
    };
    let row = |row: &Row| {
        let Row { threshold, value, false_alarms, named, false_unknowns, unknowns, wrong } = row;
        let (name, value) = match threshold.as_str() {
            "" => ("unchanged".to_string(), String::new()),
            name => (name.to_string(), format!("{value:.3}")),
        };
        let counts = [false_alarms, named, false_unknowns, unknowns, wrong].map(|count| count.to_string());
        let [alarms, named, called, unknowns, wrong] = counts;
        line([name, value, alarms, named, called, unknowns, wrong])
    };
    std::iter::once(line(head.map(String::from))).chain(rows.iter().map(row)).collect::<Vec<String>>().join("\n") + "\n"
}

fn text(score: &Score) -> String {
    let line = |what: &str, Share { count, of }: &Share| match of {
        0 => format!("{what:<48}     -    no such case"),
        _ => format!("{what:<48} {:>5.1} %  {count} of {of}", 100.0 * *count as f64 / *of as f64),
    };
    let mut lines = vec![
        line("false alarms without a fault", &score.false_alarms),
        line("gaps detected", &score.detected),
        line("single faults: named first", &score.top_1),
        line("single faults: first or among three rivals", &score.top_set),
        line("known verdicts whose set includes the fault", &score.covered),
        format!("{:<48} {:>5.2}", "mean size of such a set", score.set_size),
        line("pairs: both named", &score.pairs),
        line("unknown effects called unknown", &score.unknowns),
        line("known effects called unknown", &score.false_unknowns),
        line("wrong with probability above 0.9", &score.confidently_wrong),
        line("false further effects with probability above 0.5", &score.false_seconds),
        line("95 % intervals that hold the true value", &score.intervals.all),
    ];
    lines.extend(
        score.closed_error.map(|error| format!("{:<48} {:>5.3}", "median error of the closed share of the gap", error)),
    );
    lines.extend(score.calibration.iter().map(|(bin, share)| line(&format!("right with probability {bin}"), share)));
    lines.extend(score.confusions.iter().map(|(truth, answer, n)| {
        let truth = if truth.is_empty() { "nothing" } else { truth };
        format!("  {n} x {truth} was called {answer}")
    }));
    lines.join("\n") + "\n"
}
