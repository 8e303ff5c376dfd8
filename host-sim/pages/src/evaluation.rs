//! The page of an evaluation: how well each network does on logs that it was not trained on.

use maud::{Markup, html};
use serde::Serialize;

use super::document::{Document, Script, Section, chart, open_table, table};
use super::words::{self, number};
use mindgap_foundations::error::Result;
use mindgap_foundations::statistics::agreement::ReliabilityBin;
use mindgap_learning::evaluation::accuracy::{Evaluation, Networks, Probability, Value};
use mindgap_learning::evaluation::support::{COLUMNS, ROWS, Support};
use mindgap_learning::learn::dataset::Datasets;
use mindgap_logs::Logs;
use mindgap_models::simulator::{Learned, Simulator};

/// What a page is made of.
pub struct Subject<'a> {
    /// The figures.
    pub evaluation: &'a Evaluation,
    /// Of this simulator,
    pub simulator: &'a Simulator,
    /// on these logs.
    pub logs: &'a Logs,
    /// Names of both.
    pub names: [&'a str; 2],
}

#[derive(Serialize)]
struct Data<'a> {
    scatter: Vec<Scatter>,
    reliability: &'a [ReliabilityBin],
    surfaces: Vec<Surface>,
}

#[derive(Serialize)]
struct Scatter {
    name: &'static str,
    unit: &'static str,
    points: Vec<[f64; 2]>,
}

/// The response of a sonar network, cell by cell, with the samples in it.
#[derive(Serialize)]
struct Surface {
    name: &'static str,
    unit: &'static str,
    range: [f64; 2],
    size: [f64; 2],
    cells: Vec<Cell>,
}

#[derive(Serialize)]
struct Cell {
    distance: f64,
    alpha: f64,
    value: f64,
    known: bool,
}

/// As many samples of a network are drawn; more lie upon each other.
const MOST_SAMPLES: usize = 1200;
/// Coefficients of determination from which a network counts as good, and as usable.
const GOOD: f64 = 0.9;
const USABLE: f64 = 0.5;

/// A network's name and unit with its figures.
type Judged<'a> = (&'static str, &'static str, &'a Value);

/// The page, whole in one file.
///
/// # Errors
/// When a number in it has no form in JSON.
pub fn page(subject: &Subject) -> Result<String> {
    let Subject { evaluation, simulator, logs, names: [sim, folder] } = subject;
    let networks = &evaluation.networks;
    let values = values(networks);
    let surfaces = surfaces(simulator, logs);
    let mut sections = vec![Section { id: "values", title: "Predicted against logged", body: scatters(&values) }];
    if let Some(probability) = &networks.echo_probability {
        sections.push(Section { id: "echo", title: "Is there an echo?", body: reliability(probability) });
    }
    if !surfaces.is_empty() {
        sections.push(Section { id: "surfaces", title: "What the sonar networks answer", body: turnable(&surfaces) });
    }
    sections.push(Section { id: "compared", title: "What was compared", body: compared(subject) });
    let data = Data {
        scatter: values.iter().map(scatter).collect(),
        reliability: networks.echo_probability.as_ref().map_or(&[], |p| &p.reliability),
        surfaces,
    };
    Document {
        kind: "Evaluation",
        headline: &headline(&values),
        subject: &format!("{sim} on {folder}"),
        lead: html! {
            p {
                "Well is an R² of " (GOOD) " or more, roughly of " (USABLE) ". Where it predicts less well on these logs than on those "
                "that it learned from, the robot has changed or drives otherwise: " code { "mindgap diagnose " (sim) " " (folder) }
                " says why."
            }
        },
        sections,
        scripts: &[Script::Evaluation],
    }
    .html(&data)
}

fn values(networks: &Networks) -> Vec<Judged<'_>> {
    let Networks { turn, forward, lateral, echo_value, .. } = networks;
    [
        ("forward motion", "cm", forward),
        ("sideways motion", "cm", lateral),
        ("turn", "degrees", turn),
        ("sonar reading", "cm", echo_value),
    ]
    .into_iter()
    .filter_map(|(name, unit, value)| Some((name, unit, value.as_ref()?)))
    .collect()
}

/// Which networks are good, usable and poor, in one sentence.
fn headline(values: &[Judged]) -> String {
    let among = |low: f64, high: f64| {
        let r2 = |v: &Value| v.r2.unwrap_or(0.0);
        let names: Vec<&str> = values.iter().filter(|(.., v)| (low..high).contains(&r2(v))).map(|v| v.0).collect();
        words::list(&names)
    };
    let parts = [
        (among(GOOD, f64::INFINITY), "well"),
        (among(USABLE, GOOD), "roughly"),
        (among(f64::NEG_INFINITY, USABLE), "hardly"),
    ];
    let told: Vec<String> =
        parts.iter().filter(|p| !p.0.is_empty()).map(|(what, how)| format!("{what} {how}")).collect();
    match told.as_slice() {
        [] => "The simulator predicts whether there is an echo, and nothing else.".into(),
        told => format!("The simulator predicts {}.", told.join(", ")),
    }
}

fn scatter((name, unit, value): &Judged) -> Scatter {
    let every = value.points.len().div_ceil(MOST_SAMPLES).max(1);
    let rounded = |p: &[f64; 2]| p.map(|v| libm::round(v * 100.0) / 100.0);
    Scatter { name, unit, points: value.points.iter().step_by(every).map(rounded).collect() }
}

/// How well each network does, as a table.
pub fn accuracy(networks: &Networks) -> Markup {
    judged(&values(networks))
}

fn judged(values: &[Judged]) -> Markup {
    let rows: Vec<[String; 4]> = values
        .iter()
        .map(|(name, unit, v)| {
            let r2 = v.r2.map_or("–".into(), |r2| number(r2, 3));
            [format!("{name} ({unit})"), r2, number(v.mse.sqrt(), 2), v.n.to_string()]
        })
        .collect();
    html! {
        p { "R² is the share of what happened that the simulator foretells: 1 is all, 0 is no more than the mean." }
        (open_table(["network", "R²", "typical error (RMS)", "samples"], &rows))
    }
}

fn scatters(values: &[Judged]) -> Markup {
    html! {
        (judged(values))
        p { "Each dot is a sample of the logs. On the diagonal the prediction is right." }
        div.pairs {
            @for (i, (name, unit, v)) in values.iter().enumerate() {
                @let r2 = v.r2.map_or_else(|| "undefined".into(), |r2| number(r2, 3));
                (chart("scatter", i, &format!("Predicted against logged {name} in {unit}, R² {r2}"), html! {
                    (name) ": R² " (r2)
                    @if let Some(trend) = &v.trend {
                        @let sign = if trend.intercept < 0.0 { " − " } else { " + " };
                        "; on the whole " (number(trend.slope, 3)) " × logged" (sign) (number(trend.intercept.abs(), 2))
                    }
                    @if v.n > MOST_SAMPLES {
                        "; " (v.n.div_ceil(v.n.div_ceil(MOST_SAMPLES))) " of " (v.n) " samples are drawn"
                    }
                    "."
                }))
            }
        }
    }
}

fn reliability(of: &Probability) -> Markup {
    let rows: Vec<[String; 3]> =
        of.reliability.iter().map(|b| [number(b.predicted, 3), number(b.observed, 3), b.n.to_string()]).collect();
    html! {
        (chart("reliability", 0, "How often there was an echo against how probable the simulator called it", html! {
            "Where the simulator says 80 %, there should be an echo 80 times of 100: on the diagonal. Larger dots "
            "have more samples. Brier score " (number(of.brier, 4)) ", log loss " (number(of.log_loss, 4))
            @if let Some(auc) = of.auc { ", area under the ROC curve " (number(auc, 4)) } "."
        }))
        (table("The same in numbers", ["predicted", "observed", "samples"], &rows))
    }
}

fn surfaces(simulator: &Simulator, logs: &Logs) -> Vec<Surface> {
    let Some(sensor) = simulator.robot.ultrasonic else { return Vec::new() };
    let max_cm = sensor.max_cm;
    let data = Datasets::from_logs(logs);
    let size = [max_cm / COLUMNS as f64, 90.0 / ROWS as f64];
    let surface = |name, unit, learned: &Option<Learned<2>>, samples, range: [f64; 2]| {
        let network = &learned.as_ref()?.network;
        let support = Support::of(samples, max_cm);
        let cell = |i: usize| {
            let (distance, alpha) = ((i % COLUMNS) as f64 * size[0], (i / COLUMNS) as f64 * size[1]);
            let middle = [distance + 0.5 * size[0], alpha + 0.5 * size[1]];
            let value = f64::from(network.evaluate(middle.map(|v| v as f32))).clamp(range[0], range[1]);
            Cell {
                distance,
                alpha,
                value: libm::round(value * 1000.0) / 1000.0,
                known: support.has(middle[0], middle[1]),
            }
        };
        Some(Surface { name, unit, range, size, cells: (0..COLUMNS * ROWS).map(cell).collect() })
    };
    let echo = surface("Probability of an echo", "", &simulator.echo_probability, &data.echo_probability, [0.0, 1.0]);
    let reading = surface("Reading", "cm", &simulator.echo_value, &data.echo_value, [0.0, max_cm]);
    echo.into_iter().chain(reading).collect()
}

fn turnable(surfaces: &[Surface]) -> Markup {
    html! {
        p {
            "What the networks answer to a distance D and an incidence angle α. Where the logs have no sample nearby "
            "the map is hatched and the sheet in space is open: there the answer is a guess."
        }
        @for (i, surface) in surfaces.iter().enumerate() {
            h3 { (surface.name) @if !surface.unit.is_empty() { " (" (surface.unit) ")" } }
            (chart("surface", i, &format!("{} over distance and incidence angle, from above", surface.name),
                html! { "From above." }))
            figure {
                div.turnable data-surface=(i) role="img"
                    aria-label={ (surface.name) " over distance and incidence angle, as a sheet in space" } {}
                figcaption { "In space: drag it, or turn it with the sliders." }
            }
            div.controls {
                label { "Turn" input type="range" min="-180" max="180" value="50" data-turn=(i); }
                label { "Tilt" input type="range" min="5" max="90" value="25" data-tilt=(i); }
            }
        }
    }
}

fn compared(subject: &Subject) -> Markup {
    let Subject { simulator, logs, names: [sim, folder], .. } = subject;
    let origin = &simulator.origin;
    html! {
        dl {
            dt { "Simulator" }
            dd { (sim) ", trained (" (origin.trainer) ") on " (origin.runs) " runs by mindgap " (origin.version)
            ", seed " (origin.seed) }
            @if !simulator.added.is_empty() {
                dt { "With effects" }
                dd { (words::list(&simulator.added.iter().map(|effect| effect.effect.as_str()).collect::<Vec<_>>())) }
            }
            dt { "Logs" } dd { (folder) ": " (logs.runs.len()) " runs, " (logs.rows()) " rows" }
            @for missing in &simulator.missing {
                dt { "No network for " (missing.network) } dd { (missing.reason) }
            }
        }
    }
}
