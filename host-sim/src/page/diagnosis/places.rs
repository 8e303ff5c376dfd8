//! Where the gap lies: by channel, by circumstances, and on the floor.

use maud::html;

use super::ChannelBar;
use crate::gap::account::ChannelReduction;
use crate::gap::diagnosis::Diagnosis;
use crate::gap::explain::strata::Stratum;
use crate::page::document::{Section, chart, open_table, table};
use crate::page::words;

const CIRCUMSTANCES: [&str; 4] =
    ["channel", "circumstances that carry most of it", "share of its gap", "nats a step (95 % interval)"];
const MAP: &str = "Map of the room: squares coloured by how much the logs differ from the simulator there.";

/// The gap of every channel that has one.
pub fn channels(diagnosis: &Diagnosis) -> Vec<ChannelBar> {
    let all = diagnosis.reduction.as_ref().map_or(&[][..], |reduction| &reduction.channels);
    let bar = |of: &ChannelReduction| ChannelBar {
        name: words::channel(of.channel),
        before: of.reduction.before,
        after: of.reduction.after,
    };
    all.iter().map(bar).collect()
}

/// None where there is no gap.
pub fn section(diagnosis: &Diagnosis, mapped: bool) -> Option<Section> {
    let channels = channels(diagnosis);
    if channels.is_empty() && diagnosis.strata.is_empty() {
        return None;
    }
    let told: Vec<String> =
        channels.iter().map(|c| format!("{} {:.2} before and {:.2} after", c.name, c.before, c.after)).collect();
    let rows: Vec<[String; 3]> =
        channels.iter().map(|c| [c.name.into(), words::number(c.before, 3), words::number(c.after, 3)]).collect();
    let circumstances: Vec<[String; 4]> = diagnosis.strata.iter().map(circumstance).collect();
    let body = html! {
        @if !channels.is_empty() {
            h3 { "In which channels" }
            (chart("channels", 0, &format!("The gap in nats a step: {}.", told.join("; ")), html! {
                "The gap of each thing that the simulator predicts, as it is and " (words::with(diagnosis)) ". At zero "
                "nothing is left that follows rules. The " a href="#words" { "glossary" } " says what a nat is."
            }))
            (table("The same in numbers", ["channel", "without", "with"], &rows))
        }
        @if !circumstances.is_empty() {
            h3 { "In which circumstances" }
            (open_table(CIRCUMSTANCES, &circumstances))
        }
        @if mapped {
            h3 { "Where in the room" }
            (chart("map", 0, MAP, html! {
                "The brighter a square, the more the logs differ there from the simulator without the effects. "
                "Squares in which the robot never was are empty."
            }))
        }
    };
    Some(Section { id: "where", title: "Where it lies", body })
}

fn circumstance(stratum: &Stratum) -> [String; 4] {
    let [low, high] = stratum.ci95.map(|end| words::number(end, 2));
    [
        words::channel(stratum.channel).into(),
        stratum.context.into(),
        words::percent(stratum.share),
        format!("{} ({low} to {high})", words::number(stratum.gap, 2)),
    ]
}
