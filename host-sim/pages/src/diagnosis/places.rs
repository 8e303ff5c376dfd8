//! Where the gap lies: by channel, by circumstances, and on the floor.

use glam::DVec2;
use maud::html;

use crate::document::{Section, chart, open_table, table};
use crate::words;
use mindgap_diagnosis::Findings;
use mindgap_diagnosis::account::ChannelReduction;
use mindgap_diagnosis::explain::room_map;
use mindgap_diagnosis::explain::strata::Stratum;
use mindgap_diagnosis::scope::of_sensor;
use mindgap_figures::report::Figure;
use mindgap_figures::report::before_and_after::BeforeAndAfter;
use mindgap_figures::report::room::Room;
use mindgap_figures::report::room_map::RoomMap;

const CIRCUMSTANCES: [&str; 4] =
    ["channel", "circumstances that carry most of it", "share of its gap", "nats per step (95 % interval)"];
const MAP: &str = "Map of the room: squares coloured by how much the logs differ from the simulator there.";
/// Share of the squares that the colours of the map tell apart: one wild square must not darken all others.
const COLOURED: f64 = 0.95;
/// Least end of the map's scale, nats.
const LEAST_NATS: f64 = 0.01;

/// The section; `None` where there is no gap.
pub fn section(findings: &Findings, room: &Room) -> Option<Section> {
    let diagnosis = &findings.diagnosis;
    let channels = diagnosis.reduction.as_ref().map_or(&[][..], |reduction| &reduction.channels);
    if channels.is_empty() && diagnosis.strata.is_empty() {
        return None;
    }
    let ends = |of: &ChannelReduction| {
        let name = of_sensor(words::channel(of.channel), of.sensor.as_deref());
        (name, [of.reduction.before, of.reduction.after])
    };
    let channels: Vec<(String, [f64; 2])> = channels.iter().map(ends).collect();
    let named: Vec<String> = channels
        .iter()
        .map(|(name, [before, after])| format!("{name} {before:.2} before and {after:.2} after"))
        .collect();
    let rows: Vec<[String; 3]> = channels
        .iter()
        .map(|(name, [before, after])| [name.clone(), words::number(*before, 3), words::number(*after, 3)])
        .collect();
    let circumstances: Vec<[String; 4]> = diagnosis.strata.iter().map(circumstance).collect();
    let drawn = BeforeAndAfter {
        axis: "gap (nats per step)".into(),
        kinds: ["without the effects".into(), "with the effects".into()],
        rows: channels.iter().map(|(name, ends)| (name.clone(), *ends)).collect(),
    };
    let body = html! {
        @if !channels.is_empty() {
            h3 { "In which channels" }
            (chart("channels", &drawn.draw(), &format!("The gap in nats per step: {}.", named.join("; ")), html! {
                "The gap of each quantity that the simulator predicts, as it is and " (words::with(diagnosis)) ". At zero "
                "only scatter is left. The " a href="#words" { "glossary" } " explains nats."
            }))
            (table("The same in numbers", ["channel", "without", "with"], &rows))
        }
        @if !circumstances.is_empty() {
            h3 { "In which circumstances" }
            (open_table(CIRCUMSTANCES, &circumstances))
        }
        @if let Some(map) = &findings.room_map {
            h3 { "Where in the room" }
            (chart("map", &drawn_map(map, room), MAP, html! {
                "The brighter a square, the more the logs differ there from the simulator without the effects. "
                "Squares in which the robot never was are empty."
            }))
        }
    };
    Some(Section { id: "where", title: "Where it lies", body })
}

fn drawn_map(map: &room_map::RoomMap, room: &Room) -> Figure {
    let mut nats: Vec<f64> = map.squares.iter().map(|square| square.nats).collect();
    nats.sort_by(f64::total_cmp);
    let most = nats.get((COLOURED * nats.len() as f64) as usize).or(nats.last()).copied().unwrap_or(0.0);
    let title =
        |square: &room_map::Square| format!("{} nats per row, {} rows", words::number(square.nats, 2), square.rows);
    RoomMap {
        room: room.clone(),
        value_name: "gap (nats per row)".into(),
        values: 0.0..most.max(LEAST_NATS),
        side_cm: map.side_cm,
        squares: map.squares.iter().map(|s| (DVec2::new(s.x_cm, s.y_cm), s.nats, title(s))).collect(),
    }
    .draw()
}

fn circumstance(stratum: &Stratum) -> [String; 4] {
    let [low, high] = stratum.ci95.map(|end| words::number(end, 2));
    [
        of_sensor(words::channel(stratum.channel), stratum.sensor.as_deref()),
        stratum.context.into(),
        words::percent(stratum.share),
        format!("{} ({low} to {high})", words::number(stratum.gap, 2)),
    ]
}
