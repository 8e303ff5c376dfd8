//! `mindgap check`

use std::path::PathBuf;

use clap::Args;

use super::facts::FactsOption;
use super::table::count;
use super::{Run, kinds};
use mindgap_diagnosis::survey::{Holdings, Range, Survey};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;

/// Say what logs hold, what is wrong with them, what they suffice for, and what to drive more.
#[derive(Args)]
pub struct Check {
    /// Folder with robot.toml, scene.toml and run-*.csv.
    logs: PathBuf,
    #[command(flatten)]
    facts: FactsOption,
}

impl Run for Check {
    fn places(&self) -> Places {
        Places::default().reading([&self.logs]).writing(self.facts.asked(), kinds::REPORT)
    }

    fn run(&self) -> Result<String> {
        let survey = Survey::of(super::read_logs(&self.logs)?);
        self.facts.told(&survey, text(&survey))
    }
}

/// A survey in words, on one screen.
fn text(survey: &Survey) -> String {
    let mut lines = holdings(&survey.holds);
    if survey.findings.is_empty() {
        lines.push("Nothing is wrong with them.".into());
    } else {
        lines.push("What is wrong with them:".into());
        lines.extend(survey.findings.iter().map(|found| format!("  {}", found.line())));
    }
    if survey.refused.is_some() {
        lines.push("Nothing is learned from them before that is mended.".into());
    }
    if survey.missing_networks.is_empty() {
        lines.push("They suffice for all five networks.".into());
    } else {
        lines.push("They do not suffice for these networks:".into());
        lines
            .extend(survey.missing_networks.iter().map(|missing| format!("  {}: {}", missing.network, missing.reason)));
    }
    if survey.untestable.is_empty() {
        lines.push("They would show every known effect.".into());
    } else {
        lines.push(format!("Effects that they would not show: {}", survey.untestable.join(", ")));
    }
    if !survey.drive_more.is_empty() {
        lines.push("What is missing:".into());
        lines.extend(survey.drive_more.iter().map(|sentence| format!("  {sentence}")));
    }
    lines.join("\n") + "\n"
}

fn holdings(holds: &Holdings) -> Vec<String> {
    let Holdings { runs, rows, steps, duration_s, step_ms, jitter_ms, .. } = holds;
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    vec![
        format!(
            "{}, {rows} rows, {steps} steps with a pose at both ends, {:.1} min",
            count(*runs, "run"),
            duration_s / 60.0
        ),
        format!("  rows      {step_ms:.0} ms apart, 95 % of them within {jitter_ms:.0} ms"),
        format!(
            "  present   pose in {} and reading in {} of the rows",
            percent(holds.with_pose),
            percent(holds.with_reading)
        ),
        format!(
            "  commands  left {}, right {}; {} of the pairs of them; held for {:.0} steps (median), {} at most",
            range(holds.left),
            range(holds.right),
            percent(holds.command_coverage),
            holds.held_steps,
            holds.longest_held_steps
        ),
        format!("  speeds    ahead {} cm/s, turning {} deg/s", range(holds.forward_cm_s), range(holds.turn_deg_s)),
        sensor(holds),
    ]
}

fn sensor(holds: &Holdings) -> String {
    if holds.reading_cm.is_none() && holds.distance_cm.is_none() {
        return "  sensor    no reading, and no wall that it could face".into();
    }
    format!(
        "  sensor    reads {} cm; faces walls {} cm away (D) at {} deg to their normal (alpha): {:.0} % of what it could face",
        range(holds.reading_cm),
        range(holds.distance_cm),
        range(holds.alpha_deg),
        100.0 * holds.sensor_coverage
    )
}

fn range(range: Option<Range>) -> String {
    range.map_or("none".into(), |Range { low, high }| format!("{low:.0} to {high:.0}"))
}
