//! The diagnosis of a fleet as text for one screen.

use super::table;
use mindgap_applications::fleet::Fleet;
use mindgap_applications::fleet::answer::Group;
use mindgap_applications::fleet::frequency::Frequency;

/// Maximum number of robots named in a list.
const MOST: usize = 8;

/// Returns the diagnosis of a fleet as text.
pub fn text(fleet: &Fleet) -> String {
    let mut lines = vec![match fleet.refused.len() {
        0 => format!("{} robots diagnosed.", fleet.diagnosed),
        refused => format!("{} of {} robots diagnosed, {refused} failed.", fleet.diagnosed, fleet.count()),
    }];
    let verdicts = fleet.verdicts.iter().map(|(verdict, count)| format!("{count} {}", verdict.replace('_', " ")));
    lines.push(format!("Verdicts: {}", verdicts.collect::<Vec<String>>().join(", ")));
    if !fleet.effects.is_empty() {
        let rows: Vec<[String; 4]> = fleet.effects.iter().map(row).collect();
        let header = ["Effect", "prevalence, % (95 %)", "named in", "median strength"];
        lines.extend(table::text(header, &rows).lines().map(String::from));
    }
    if !fleet.common.is_empty() {
        lines.push("Common to nearly all robots, so an error of the simulator (train it again, or add the effect with --apply):".into());
        lines.extend(fleet.common.iter().map(|common| format!("  {}: {}", common.effect.effect, common.because)));
    }
    lines.push("Groups of robots with similar gaps:".into());
    lines.extend(fleet.groups.iter().map(group));
    if !fleet.stands_out.is_empty() {
        lines.push("Outliers:".into());
        lines.extend(fleet.stands_out.iter().take(MOST).map(|o| {
            format!("  {}: {} {}, fleet median {} ({:.1} deviations)", o.robot, o.what, o.value, o.median, o.deviations)
        }));
        lines.extend(more(fleet.stands_out.len()));
    }
    lines.join("\n") + "\n"
}

fn row(of: &Frequency) -> [String; 4] {
    let [low, high] = of.ci95.map(|share| 100.0 * share);
    let strengths = of.strengths.iter().map(|s| format!("{} {}", s.parameter, s.spread.median));
    [
        of.id.into(),
        format!("{:.0} ({low:.0} to {high:.0})", 100.0 * of.frequency),
        format!("{} of {}", of.named, of.testable),
        strengths.collect::<Vec<String>>().join(", "),
    ]
}

fn group(group: &Group) -> String {
    let parts: Vec<String> = group.budget.iter().map(|s| format!("{} {:.0} %", s.id, 100.0 * s.share)).collect();
    let made_of = if parts.is_empty() { "no gap".into() } else { parts.join(", ") };
    let names: Vec<&str> = group.robots.iter().take(MOST).map(String::as_str).collect();
    let others = group.robots.len().saturating_sub(MOST);
    let others = if others > 0 { format!(" and {others} more") } else { String::new() };
    format!("  {}: {made_of} ({}{others})", group.robots.len(), names.join(", "))
}

fn more(all: usize) -> Option<String> {
    let others = all.saturating_sub(MOST);
    (others > 0).then(|| format!("  and {others} more: see fleet.json"))
}
