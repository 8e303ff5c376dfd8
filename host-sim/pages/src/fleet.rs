//! The page of a fleet: frequencies of effects, effects that the simulator lacks, groups of similar robots, and outliers.

use maud::{Markup, html};

use super::document::{Document, Script, Section, chart, open_table};
use super::glossary;
use super::words::{self, number, percent, percent_within};
use mindgap_applications::fleet::answer::{Fleet, Group, Row, Share};
use mindgap_applications::fleet::frequency::{Frequency, Strength};
use mindgap_applications::fleet::{ANSWER, DIAGNOSES};
use mindgap_figures::report::Figure;
use mindgap_figures::report::segments::{self, Segment, SegmentChart};
use mindgap_figures::report::shares::{self, ShareChart};
use mindgap_figures::report::style::{KINDS, VERMILION};
use mindgap_models::effects::Effect;
use mindgap_models::effects::applied::AppliedEffect;

/// The contents of a page.
pub struct Subject<'a> {
    /// What was found.
    pub fleet: &'a Fleet,
    /// Among these effects.
    pub catalogue: &'a [&'static Effect],
    /// Where the logs lie, and the simulator's file or the word for the textbook.
    pub names: [&'a str; 2],
    /// Seed of the draws.
    pub seed: u64,
}

/// Most robots that are listed.
const MOST_ROBOTS: usize = 500;
/// Most robots that are named per group.
const MOST_NAMES: usize = 12;
/// Most parts of a robot's gap that are named.
const MOST_PARTS: usize = 3;
const SCRIPT: &str = include_str!("../assets/page/sort.js");

/// Returns the page, whole in one file.
pub fn page(subject: &Subject) -> String {
    let Subject { fleet, catalogue, names: [logs, simulator], .. } = subject;
    let mut sections = vec![
        Section { id: "common", title: "What the simulator lacks", body: common(subject) },
        Section { id: "effects", title: "How frequent effects are", body: frequencies(&fleet.effects, catalogue) },
        Section { id: "groups", title: "Robots with similar gaps", body: groups(fleet, catalogue) },
        Section { id: "out", title: "Outliers", body: outliers(fleet, catalogue) },
        Section { id: "robots", title: "The robots", body: robots(fleet, catalogue) },
    ];
    if !fleet.refused.is_empty() || !fleet.left_out.is_empty() {
        sections.push(Section { id: "refused", title: "What could not be diagnosed", body: refused(fleet) });
    }
    sections.push(glossary::section());
    Document {
        kind: "Fleet",
        headline: &headline(fleet, catalogue),
        subject: &format!("{logs} against {simulator}"),
        lead: lead(subject),
        sections,
        script: Some(Script::without_data(SCRIPT)),
    }
    .html()
}

/// What the robots have, in one sentence.
fn headline(fleet: &Fleet, catalogue: &[&'static Effect]) -> String {
    let robots = match fleet.diagnosed {
        1 => "One robot".into(),
        count => format!("{count} robots"),
    };
    let common: Vec<&str> = fleet.common.iter().map(|c| words::name(&c.effect.effect, catalogue)).collect();
    match (common.is_empty(), fleet.effects.first()) {
        (false, _) => format!("{robots}: nearly all have {} alike, which the simulator lacks.", words::list(&common)),
        (true, Some(Frequency { id, frequency, .. })) => {
            let name = words::name(id, catalogue);
            format!("{robots}: the most frequent effect is {name}, in {} of them.", percent(*frequency))
        }
        (true, None) => format!("{robots}: no effect is named in any of them."),
    }
}

fn lead(subject: &Subject) -> Markup {
    let Subject { fleet, seed, .. } = subject;
    let verdicts: Vec<String> =
        fleet.verdicts.iter().map(|(verdict, count)| format!("{count} {}", verdict.replace('_', " "))).collect();
    html! {
        p { "Verdicts: " (words::list(&verdicts.iter().map(String::as_str).collect::<Vec<_>>())) "." }
        @if let Some(gap) = &fleet.gap_nats {
            p {
                "Where there is a gap, it is " strong { (number(gap.median, 3)) " nats per step" } " in the middle"
                @if gap.quartiles[0] < gap.quartiles[1] {
                    "; half of the robots have between " (number(gap.quartiles[0], 3)) " and "
                    (number(gap.quartiles[1], 3))
                }
                ". The " a href="#words" { "glossary" } " explains nats."
            }
        }
        @if !fleet.refused.is_empty() {
            p.bad {
                (fleet.refused.len()) " of " (fleet.count()) " robots could not be diagnosed: "
                a href="#refused" { "why" } "."
            }
        }
        p.quiet { "The same facts for programs: " a href=(ANSWER) { (ANSWER) } ". Seed " (seed) "." }
    }
}

fn common(subject: &Subject) -> Markup {
    let Subject { fleet, catalogue, .. } = subject;
    html! {
        @if fleet.common.is_empty() {
            p {
                "No effect is in nearly all robots at the same strength. Each robot has its own: see below which to repair."
            }
        } @else {
            p {
                "An effect that nearly all robots share is not wear: the simulator lacks it. Train the simulator again with logs "
                "of several of these robots; or add it: the same command with " code { "--apply better.json" } " writes a "
                "simulator that has it."
            }
            ul {
                @for common in &fleet.common {
                    li {
                        strong { (words::name(&common.effect.effect, catalogue)) } ", " (parameters(&common.effect)) ": "
                        (common.because) "."
                    }
                }
            }
        }
    }
}

fn parameters(effect: &AppliedEffect) -> String {
    effect.parameters.iter().map(|(name, value)| format!("{name} {value}")).collect::<Vec<String>>().join(", ")
}

fn frequencies(effects: &[Frequency], catalogue: &[&'static Effect]) -> Markup {
    if effects.is_empty() {
        return html! { p { "No effect is named in any robot." } };
    }
    let said: Vec<String> =
        effects.iter().map(|f| format!("{} {}", words::name(f.id, catalogue), percent(f.frequency))).collect();
    let rows: Vec<[String; 4]> = effects.iter().map(|f| row(f, catalogue)).collect();
    let share = |f: &Frequency| shares::Share {
        name: words::name(f.id, catalogue).into(),
        share: f.frequency,
        interval: f.ci95,
        colour: VERMILION,
    };
    let axis = "robots that have it (%)".into();
    let shares = effects.iter().map(share).collect();
    let drawn = ShareChart { axis, rows: shares, points: true, ..ShareChart::default() }.draw();
    html! {
        (chart("frequencies", &drawn, &format!("Share of the robots that have an effect: {}", said.join(", ")), html! {
            "The share of the robots that have an effect, each weighted by the probability in its diagnosis, among those whose "
            "logs could show it. The lines are 95 % intervals, which are wide for few robots."
        }))
        (open_table(["effect", "frequency (95 %)", "named in", "strength: median (quartiles)"], &rows))
    }
}

fn row(of: &Frequency, catalogue: &[&'static Effect]) -> [String; 4] {
    let strength = |s: &Strength| {
        let unit = if s.unit.is_empty() { String::new() } else { format!(" {}", s.unit) };
        let [low, high] = s.spread.quartiles;
        format!("{} {}{unit} ({low} to {high})", s.parameter, s.spread.median)
    };
    let strengths: Vec<String> = of.strengths.iter().map(strength).collect();
    [
        words::name(of.id, catalogue).into(),
        percent_within(of.frequency, of.ci95),
        format!("{} of {}", of.named, of.testable),
        if strengths.is_empty() { "–".into() } else { strengths.join(", ") },
    ]
}

fn group_name(number: usize) -> String {
    format!("group {number}")
}

/// The mean gaps of the groups, one colour per effect in the order in which they appear.
fn drawn_groups(fleet: &Fleet, catalogue: &[&'static Effect]) -> Figure {
    let mut ids: Vec<&str> = Vec::new();
    for share in fleet.groups.iter().flat_map(|group| &group.budget) {
        if !ids.contains(&share.id) {
            ids.push(share.id);
        }
    }
    let row = |(i, group): (usize, &Group)| {
        let mut from = 0.0;
        let segment = |share: &Share| {
            let name = words::name(share.id, catalogue);
            let to = from + 100.0 * share.share;
            let kind = ids.iter().position(|id| *id == share.id).unwrap_or_default();
            let segment = Segment { from, to, kind, title: format!("{name} {}", percent(share.share)) };
            from = to;
            segment
        };
        segments::Row { name: group_name(i + 1), segments: group.budget.iter().map(segment).collect() }
    };
    let kind = |(id, colour)| (words::name(id, catalogue).to_owned(), colour);
    SegmentChart {
        axis: "mean share of the gap (%)".into(),
        range: 0.0..100.0,
        names_px: 64.0,
        row_px: 42.0,
        kinds: ids.iter().copied().zip(KINDS.into_iter().cycle()).map(kind).collect(),
        rows: fleet.groups.iter().enumerate().map(row).collect(),
    }
    .draw()
}

fn groups(fleet: &Fleet, catalogue: &[&'static Effect]) -> Markup {
    let rows: Vec<[String; 4]> = fleet
        .groups
        .iter()
        .enumerate()
        .map(|(i, group)| {
            let names = group.robots.iter().take(MOST_NAMES).map(String::as_str).collect::<Vec<&str>>().join(", ");
            let more = group.robots.len().saturating_sub(MOST_NAMES);
            [
                group_name(i + 1),
                group.robots.len().to_string(),
                in_words(&group.budget, catalogue),
                if more > 0 { format!("{names} and {more} more") } else { names },
            ]
        })
        .collect();
    html! {
        @if fleet.groups.len() == 1 {
            p { "As far as these logs show, all robots' gaps consist of the same effects." }
        } @else {
            p {
                "Robots in one group can be repaired alike: their gaps consist of the same effects in similar shares."
            }
        }
        (chart("groups", &drawn_groups(fleet, catalogue), "Mean shares of the gap in each group, as in the table below", html! {
            "What the gaps of each group are made of. A bar is short where many robots of the group have no gap."
        }))
        (open_table(["group", "robots", "their gap", "who"], &rows))
    }
}

fn outliers(fleet: &Fleet, catalogue: &[&'static Effect]) -> Markup {
    let what = |what: &str| match what.split_once('.') {
        Some((id, parameter)) => format!("{}: {parameter}", words::name(id, catalogue)),
        None => "size of the gap, nats per step".into(),
    };
    let rows: Vec<[String; 5]> = fleet
        .stands_out
        .iter()
        .take(MOST_ROBOTS)
        .map(|o| {
            let value = |value: f64| value.to_string().replace('-', "−");
            [o.robot.clone(), what(&o.what), value(o.value), value(o.median), number(o.deviations, 1)]
        })
        .collect();
    html! {
        @if rows.is_empty() {
            p { "No robot is further from the others than chance explains." }
        } @else {
            p {
                "These are further from the middle of the fleet than any robot would be by chance in 19 of 20 fleets. Look at "
                "them first, or check whether their logs are of another robot."
            }
            (open_table(["robot", "in what", "it has", "the fleet has", "deviations away"], &rows))
        }
    }
}

/// Parts of a gap in words.
fn in_words(budget: &[Share], catalogue: &[&'static Effect]) -> String {
    let parts: Vec<String> = budget
        .iter()
        .take(MOST_PARTS)
        .map(|part| format!("{} {}", words::name(part.id, catalogue), percent(part.share)))
        .collect();
    if parts.is_empty() { "no gap".into() } else { parts.join(", ") }
}

fn robots(fleet: &Fleet, catalogue: &[&'static Effect]) -> Markup {
    // Outliers are among them.
    let is_out = |row: &&Row| fleet.stands_out.iter().take(MOST_ROBOTS).any(|outlier| outlier.robot == row.name);
    let spaced = fleet.robots.len().div_ceil(MOST_ROBOTS).max(1);
    let shown: Vec<&Row> =
        fleet.robots.iter().enumerate().filter(|(i, row)| i % spaced == 0 || is_out(row)).map(|(_, row)| row).collect();
    let header = ["robot", "verdict", "gap (nats per step)", "made of", "group"];
    html! {
        p {
            "Each name links to the robot's diagnosis as JSON. Click on a column's name to sort by it."
            @if shown.len() < fleet.robots.len() {
                " These are " (shown.len()) " of " (fleet.robots.len()) ", evenly spread, and all outliers; the files next to "
                "this page have all of them."
            }
        }
        div.wide tabindex="0" role="region" aria-label="Table: the robots" {
            table {
                thead { tr { @for name in header { th scope="col" { button type="button" { (name) } } } } }
                tbody {
                    @for row in shown {
                        tr {
                            th scope="row" { a href={ (DIAGNOSES) "/" (encoded(&row.name)) ".json" } { (row.name) } }
                            td { (row.verdict.id().replace('_', " ")) }
                            td.n data-value=(row.gap_nats.unwrap_or(0.0)) {
                                (row.gap_nats.map_or("–".into(), |gap| number(gap, 3)))
                            }
                            td { (in_words(&row.budget, catalogue)) }
                            td.n { (row.group) }
                        }
                    }
                }
            }
        }
    }
}

/// A file's name as a part of an address.
fn encoded(name: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte);
    name.bytes().map(|b| if is_plain(b) { char::from(b).to_string() } else { format!("%{b:02X}") }).collect()
}

fn refused(fleet: &Fleet) -> Markup {
    let rows: Vec<[String; 2]> =
        fleet.refused.iter().take(MOST_ROBOTS).map(|r| [r.robot.clone(), r.reason.clone()]).collect();
    html! {
        @if !rows.is_empty() { (open_table(["robot", "why not"], &rows)) }
        @if !fleet.left_out.is_empty() {
            p { "No folders, and so no robots: " (words::list(&fleet.left_out.iter().map(String::as_str).collect::<Vec<_>>())) "." }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_addresses() {
        assert_eq!(encoded("robot-3"), "robot-3");
        assert_eq!(encoded("a b#?%/ü"), "a%20b%23%3F%25%2F%C3%BC");
    }
}
