//! What each range sensor read, against the distance to the wall and the incidence angle.

use std::collections::BTreeMap;

use glam::DVec2;
use maud::{Markup, html};

use super::drawn::{Drawn, MARKED};
use crate::document::{Section, chart};
use mindgap_figures::report::scatter::{Kind, ScatterChart};
use mindgap_figures::report::style::{BLUE, Colour, VERMILION};
use mindgap_logs::Logs;
use mindgap_logs::heard::Heard;
use mindgap_logs::samples::{self, SonarSample};

/// Rows that are drawn in a chart.
const MOST_ROWS: usize = 1500;
/// Distances beyond this multiple of the sensor's range are drawn at the edge,
const MOST_DISTANCE: f64 = 1.5;
/// and so are readings beyond this one.
const MOST_READING: f64 = 1.1;
/// Readings that are off by more than this share of the range are drawn at the edge.
const MOST_OFF: f64 = 0.5;
/// Step to which ranges of axes are rounded, cm.
const ROUND_CM: f64 = 20.0;

/// The section; `None` for a robot without a range sensor.
pub fn section(runs: &[Drawn], corrected: &Logs) -> Option<Section> {
    corrected.robot.ultrasonic?;
    let sensors = if corrected.sensors().are_several() { corrected.by_sensor() } else { Vec::new() };
    let body = html! {
        @if sensors.is_empty() { (sensor(runs, corrected)) }
        @for Heard { sensor: name, logs } in &sensors {
            h3 { "Sensor " (name) }
            (sensor(runs, logs))
        }
    };
    Some(Section { id: "readings", title: "Readings of the range sensor", body })
}

/// The charts of one sensor.
fn sensor(runs: &[Drawn], logs: &Logs) -> Markup {
    let Some(max_cm) = logs.robot.ultrasonic.map(|sensor| sensor.max_cm) else { return html! {} };
    let all = samples::readings(logs).count();
    let every = all.div_ceil(MOST_ROWS).max(1);
    let shown: Vec<SonarSample> = samples::readings(logs).step_by(every).collect();
    if shown.is_empty() {
        return html! { p { "In no row the pose is known and a wall is ahead, so readings cannot be compared with distances." } };
    }
    let by_name: BTreeMap<&str, &Drawn> = runs.iter().map(|drawn| (drawn.run.name.as_str(), drawn)).collect();
    let is_marked = |sample: &SonarSample| {
        by_name.get(logs.runs[sample.run].name.as_str()).is_some_and(|drawn| drawn.is_marked(sample.row))
    };
    let kinds = |place: &dyn Fn(&SonarSample) -> Option<DVec2>| {
        let of = |name: &str, colour: Colour, marked: bool| Kind {
            name: name.into(),
            colour,
            hollow: false,
            points: shown.iter().filter(|s| is_marked(s) == marked).filter_map(place).collect(),
        };
        vec![of("reading", BLUE, false), of(MARKED, VERMILION, true)]
    };
    let farthest = shown.iter().map(|s| s.distance_cm).fold(0.0, f64::max).min(MOST_DISTANCE * max_cm);
    let along = 0.0..rounded_up(farthest);
    let upwards = 0.0..rounded_up(MOST_READING * max_cm);
    let end = along.end.min(upwards.end);
    let by_distance = ScatterChart {
        x_name: "distance D to the wall (cm)".into(),
        y_name: "reading (cm)".into(),
        x_range: along.clone(),
        y_range: upwards,
        guide: Some([DVec2::ZERO, DVec2::splat(end)]),
        kinds: kinds(&|s| Some(DVec2::new(s.distance_cm, s.echo_cm?))),
    };
    let off = |s: &SonarSample| Some(s.echo_cm? - s.distance_cm);
    let most_off = shown.iter().filter_map(off).map(f64::abs).fold(0.0, f64::max).min(MOST_OFF * max_cm);
    let most_off = rounded_up(most_off);
    let by_angle = ScatterChart {
        x_name: "incidence angle α (degrees)".into(),
        y_name: "reading − D (cm)".into(),
        x_range: 0.0..90.0,
        y_range: -most_off..most_off,
        guide: Some([DVec2::ZERO, DVec2::new(90.0, 0.0)]),
        kinds: kinds(&|s| Some(DVec2::new(s.alpha_deg(), off(s)?))),
    };
    let heard = |is_heard: bool| shown.iter().filter(move |s| s.echo_cm.is_some() == is_heard);
    let places =
        |is_heard: bool| -> Vec<DVec2> { heard(is_heard).map(|s| DVec2::new(s.distance_cm, s.alpha_deg())).collect() };
    let in_both = ScatterChart {
        x_name: "distance D to the wall (cm)".into(),
        y_name: "incidence angle α (degrees)".into(),
        x_range: along,
        y_range: 0.0..90.0,
        guide: None,
        kinds: vec![
            Kind { name: "reading".into(), colour: BLUE, hollow: false, points: places(true) },
            Kind { name: "no reading".into(), colour: VERMILION, hollow: true, points: places(false) },
        ],
    };
    let counts = format!("{} rows with a reading and {} without one", heard(true).count(), heard(false).count());
    html! {
        p {
            (shown.len()) " of " (all) " rows in which the pose is known and a wall is ahead"
            @if every > 1 { ", evenly spread" }
            ": " (counts) ". Arrowheads at an edge are values beyond it."
        }
        div.pairs {
            (chart("by-distance", &by_distance.draw(), &format!("Readings against distances: {counts}."), html! {
                "On the grey line the sensor reads the distance to what is straight ahead of it."
            }))
            (chart("by-angle", &by_angle.draw(), &format!("Readings minus distances against incidence angles: {counts}."), html! {
                "At 0 degrees the sensor faces the wall squarely."
            }))
            (chart("covered", &in_both.draw(), &format!("Distances and incidence angles that occur: {counts}."), html! {
                "Where there are rings, the sensor faced a wall and read nothing. What is empty here, a simulator cannot learn."
            }))
        }
    }
}

fn rounded_up(cm: f64) -> f64 {
    libm::ceil(cm / ROUND_CM).max(1.0) * ROUND_CM
}
