//! A survey of logs as text for one screen.

use super::diagnosis::would_show;
use crate::words::count;
use mindgap_diagnosis::survey::{Heard, Holdings, Range, Survey, Witness};

/// Returns a survey as text for one screen.
pub fn text(survey: &Survey) -> String {
    let mut lines = vec![amounts(&survey.holds)];
    lines.extend(holdings(&survey.holds).into_iter().map(|(what, text)| format!("  {what:<9} {text}")));
    if survey.findings.is_empty() {
        lines.push("No defects found.".into());
    } else {
        lines.push("Defects:".into());
        lines.extend(survey.findings.iter().map(|found| format!("  {}", found.line())));
    }
    if survey.refused.is_some() {
        lines.push("The logs cannot be used until this is fixed.".into());
    }
    if survey.missing_networks.is_empty() {
        let all = if survey.holds.sensors.is_empty() { "all five" } else { "all" };
        lines.push(format!("The logs suffice for {all} networks."));
    } else {
        lines.push("The logs do not suffice for these networks:".into());
        lines
            .extend(survey.missing_networks.iter().map(|missing| format!("  {}: {}", missing.network, missing.reason)));
    }
    if survey.untestable.is_empty() {
        lines.push("Every known effect is testable with these logs.".into());
    } else {
        lines.push(format!("Untestable effects (not excited): {}", survey.untestable.join(", ")));
    }
    lines.extend(would_show(&survey.holds.detectable));
    if !survey.drive_more.is_empty() {
        lines.push("Missing excitation:".into());
        lines.extend(survey.drive_more.iter().map(|sentence| format!("  {sentence}")));
    }
    lines.join("\n") + "\n"
}

/// Returns the amounts that logs hold.
pub fn amounts(Holdings { runs, rows, steps, duration_s, .. }: &Holdings) -> String {
    format!("{}, {rows} rows, {steps} steps with poses at both ends, {:.1} min", count(*runs, "run"), duration_s / 60.0)
}

/// Returns what logs hold, each with a word for what it is.
pub fn holdings(holds: &Holdings) -> Vec<(&'static str, String)> {
    let Holdings { step_ms, jitter_ms, .. } = holds;
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    vec![
        ("rows", format!("{step_ms:.0} ms apart, 95 % of them within {jitter_ms:.0} ms")),
        (
            "coverage",
            format!("{} of rows have a pose, {} a reading", percent(holds.with_pose), percent(holds.with_reading)),
        ),
        (
            "commands",
            format!(
                "left {}, right {}; {} of all pairs covered; held for {:.0} steps (median), at most {}",
                range(holds.left),
                range(holds.right),
                percent(holds.command_coverage),
                holds.held_steps,
                holds.longest_held_steps
            ),
        ),
        ("speeds", format!("forward {} cm/s, turn rate {} deg/s", range(holds.forward_cm_s), range(holds.turn_deg_s))),
        ("sensor", sensor(holds)),
    ]
    .into_iter()
    .chain(holds.sensors.iter().map(|heard| ("sensor", further(heard))))
    .chain(holds.witnesses.iter().filter(|witness| witness.rows > 0.0).map(|of| ("witness", witness(of))))
    .collect()
}

fn witness(Witness { columns, rows, adds }: &Witness) -> String {
    format!("{:.0} % of rows have {columns}: {adds}", 100.0 * rows)
}

/// Returns what a further range sensor measures.
fn further(heard: &Heard) -> String {
    let Heard { sensor, reading_cm, distance_cm, alpha_deg, sensor_coverage, .. } = heard;
    if reading_cm.is_none() {
        return format!("{sensor}: no readings");
    }
    format!(
        "{sensor}: reads {} cm; D {} cm, alpha {} deg: {:.0} % of the possible (D, alpha) covered",
        range(*reading_cm),
        range(*distance_cm),
        range(*alpha_deg),
        100.0 * sensor_coverage
    )
}

fn sensor(holds: &Holdings) -> String {
    if holds.reading_cm.is_none() && holds.distance_cm.is_none() {
        return "no readings, and no wall in view".into();
    }
    format!(
        "reads {} cm; distance D {} cm, incidence angle alpha {} deg: {:.0} % of the possible (D, alpha) covered",
        range(holds.reading_cm),
        range(holds.distance_cm),
        range(holds.alpha_deg),
        100.0 * holds.sensor_coverage
    )
}

fn range(range: Option<Range>) -> String {
    range.map_or("none".into(), |Range { low, high }| format!("{low:.0} to {high:.0}"))
}
