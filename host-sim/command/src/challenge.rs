//! `mindgap challenge`: the blind test of `mindgap diagnose`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::facts::FactsOption;
use super::lasting::{KeepOption, Kept};
use super::{Run, kinds, progress};
use mindgap_applications::challenge::Folder;
use mindgap_applications::challenge::answer::answer;
use mindgap_applications::challenge::calibrate::calibrate;
use mindgap_applications::challenge::cases::{Echoes, Outside, Setting, Size};
use mindgap_applications::challenge::make::make;
use mindgap_applications::challenge::score::{Score, Share, score};
use mindgap_applications::challenge::sensitivity::{Row, sensitivity};
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;

/// The blind test of a diagnosis: make cases with withheld effects, answer them, score the answers.
#[derive(Args)]
pub struct Challenge {
    #[command(subcommand)]
    part: Part,
}

#[derive(Subcommand)]
enum Part {
    /// Write cases of the built-in robot, and sealed what is different in each.
    Make {
        /// Number of cases.
        #[arg(long, value_name = "N", default_value_t = 400, value_parser = clap::value_parser!(u32).range(1..))]
        cases: u32,
        /// Seed of all that is random.
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u64,
        /// What the effects that no diagnosis knows are drawn from.
        #[arg(long, value_enum, default_value_t = Outside::Usual)]
        outside: Outside,
        /// Give all robots sensors whose echoes are decided by the place more than by chance, other in every room.
        #[arg(long)]
        place_bound: bool,
        #[command(flatten)]
        size: SizeOption,
        /// Folder for the challenge.
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
        #[command(flatten)]
        keep: KeepOption,
    },
    /// Settle the diagnosis's thresholds on cases of other seeds whose answers are known.
    Calibrate {
        /// Number of cases.
        #[arg(long, value_name = "N", default_value_t = 200)]
        cases: u32,
        /// Seed of all that is random; none that a challenge has.
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u64,
        /// Write the thresholds here: diagnoses use those in host-sim/diagnosis/src/calibration.toml when they are compiled.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Also write what was measured in every case here.
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
        #[command(flatten)]
        size: SizeOption,
        #[command(flatten)]
        keep: KeepOption,
    },
    /// Print how much each threshold decides: halved and doubled, on cases whose answers are known.
    Sensitivity {
        /// Number of cases.
        #[arg(long, value_name = "N", default_value_t = 60)]
        cases: u32,
        /// Seed of all that is random; none that a challenge has.
        #[arg(long, value_name = "N", default_value_t = 1)]
        seed: u64,
        /// Also write the table here.
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
    },
    /// Diagnose every case.
    Answer {
        /// Folder of the challenge.
        folder: PathBuf,
        #[command(flatten)]
        keep: KeepOption,
    },
    /// Open the seal and score the answers.
    Score {
        /// Folder of the challenge.
        folder: PathBuf,
        #[command(flatten)]
        facts: FactsOption,
        /// Also write what happened in every case here.
        #[arg(long, value_name = "FILE")]
        csv: Option<PathBuf>,
    },
}

/// How much is logged.
#[derive(Args)]
struct SizeOption {
    /// Log little, to try the command: six short runs a case, and eight that a robot's simulator is learned from. What
    /// such cases say of the diagnosis counts for nothing.
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
        let keep = self.keep().and_then(|(keep, _)| keep.asked().as_ref());
        let places = Places::default().writing(keep, kinds::CHECKPOINT);
        match &self.part {
            Part::Make { out, .. } => places.filling([out]),
            Part::Calibrate { out, csv, .. } => places.writing([out], kinds::CALIBRATION).writing(csv, kinds::UNSIGNED),
            Part::Sensitivity { csv, .. } => places.writing(csv, kinds::UNSIGNED),
            Part::Answer { folder, .. } => places.reading([folder]).filling([&Folder(folder).answers()]),
            Part::Score { folder, facts, csv } => {
                places.reading([folder]).writing(facts.asked(), kinds::REPORT).writing(csv, kinds::UNSIGNED)
            }
        }
    }

    fn run(&self) -> Result<String> {
        match &self.part {
            Part::Make { cases, seed, outside, place_bound, size, out, .. } => {
                let echoes = if *place_bound { Echoes::PlaceBound } else { Echoes::Fresh };
                let bar = progress::bar(u64::from(*cases));
                let setting = Setting { outside: *outside, echoes, size: size.size() };
                make(out, *cases as usize, *seed, setting, progress::counting(&bar))?;
                bar.finish_and_clear();
                Ok(format!("{}: {cases} cases; sealed.json says what is different in each\n", out.display()))
            }
            Part::Calibrate { cases, seed, out, csv, size, .. } => {
                let bar = progress::bar(u64::from(*cases));
                let (calibration, measured) = calibrate(*cases as usize, *seed, size.size(), progress::counting(&bar))?;
                bar.finish_and_clear();
                let quick = if size.quick { " --quick" } else { "" };
                let command =
                    format!("mindgap challenge calibrate --cases {cases} --seed {seed}{quick} --out {}", out.display());
                files::write(out, calibration.to_text(&command))?;
                if let Some(path) = csv {
                    files::write_csv(path, &measured)?;
                }
                Ok(format!("{}: thresholds from {cases} cases\n", out.display()))
            }
            Part::Sensitivity { cases, seed, csv } => {
                let bar = progress::bar(0);
                let rows = sensitivity(*cases as usize, *seed, progress::counting(&bar))?;
                bar.finish_and_clear();
                if let Some(path) = csv {
                    files::write_csv(path, &rows)?;
                }
                Ok(table(&rows))
            }
            Part::Answer { folder, .. } => {
                let bar = progress::bar(0);
                let count = answer(folder, progress::counting(&bar))?;
                bar.finish_and_clear();
                Ok(format!("{}: {count} cases diagnosed\n", folder.display()))
            }
            Part::Score { folder, facts, csv } => {
                let bar = progress::bar(0);
                let score = score(folder, progress::counting(&bar))?;
                bar.finish_and_clear();
                if let Some(path) = csv {
                    files::write_csv(path, &score.cases)?;
                }
                facts.told(&score, text(&score))
            }
        }
    }

    fn kept(&self) -> Option<Kept> {
        self.keep().and_then(|(keep, out)| keep.beside(&out))
    }

    fn is_shared(&self) -> bool {
        !matches!(self.part, Part::Score { .. })
    }
}

impl Challenge {
    /// The parts that keep what they have done, and for which output.
    fn keep(&self) -> Option<(&KeepOption, PathBuf)> {
        match &self.part {
            Part::Make { keep, out, .. } | Part::Calibrate { keep, out, .. } => Some((keep, out.clone())),
            Part::Answer { keep, folder } => Some((keep, Folder(folder).answers())),
            Part::Sensitivity { .. } | Part::Score { .. } => None,
        }
    }
}

/// The table of sensitivity, the calibration as it is first.
fn table(rows: &[Row]) -> String {
    let head = ["threshold", "value", "false alarms", "named", "called unknown", "unknowns", "wrong"];
    let line = |cells: [String; 7]| {
        let [name, others @ ..] = cells;
        others.iter().fold(format!("{name:<28}"), |line, cell| line + &format!("{cell:>15}"))
    };
    let row = |row: &Row| {
        let Row { threshold, value, false_alarms, named, false_unknowns, unknowns, wrong } = row;
        let (name, value) = match threshold.as_str() {
            "" => ("as it is".to_string(), String::new()),
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
        0 => format!("{what:<48}     -    there was none"),
        _ => format!("{what:<48} {:>5.1} %  {count} of {of}", 100.0 * *count as f64 / *of as f64),
    };
    let mut lines = vec![
        line("false alarms where nothing is different", &score.false_alarms),
        line("gaps detected", &score.detected),
        line("single effects: named first", &score.top_1),
        line("single effects: first or among three rivals", &score.top_set),
        line("known answers whose set holds the effect", &score.covered),
        format!("{:<48} {:>5.2}", "effects in such a set", score.set_size),
        line("pairs: both named", &score.pairs),
        line("effects outside the table called unknown", &score.unknowns),
        line("effects of the table called unknown", &score.false_unknowns),
        line("wrong with a probability above 0.9", &score.confidently_wrong),
    ];
    lines.extend(
        score.closed_error.map(|error| format!("{:<48} {:>5.3}", "median error of the share of the gap closed", error)),
    );
    lines.extend(
        score.calibration.iter().map(|(bin, share)| line(&format!("right with a probability of {bin}"), share)),
    );
    lines.extend(score.confusions.iter().map(|(truth, answer, n)| {
        let truth = if truth.is_empty() { "nothing" } else { truth };
        format!("  {n} x {truth} was called {answer}")
    }));
    lines.join("\n") + "\n"
}
