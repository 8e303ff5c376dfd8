//! The page of an evaluation: how well each network predicts logs that it was not trained on.

use std::borrow::Cow;

use maud::{Markup, html};

use super::document::{Document, Section, chart, open_table, table};
use super::words::{self, number};
use mindgap_figures::pictures;
use mindgap_figures::report::expected_against_predicted::{Panel, Samples};
use mindgap_figures::report::sonar_surfaces::Surface;
use mindgap_learning::evaluation::accuracy::{Evaluation, Networks, Probability, Value};
use mindgap_logs::Logs;
use mindgap_models::simulator::Simulator;

/// The contents of a page.
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

/// Least coefficients of determination of a good and of a usable network.
const GOOD: f64 = 0.9;
const USABLE: f64 = 0.5;

/// A network's name and unit with its figures.
type Judged<'a> = (Cow<'a, str>, &'static str, &'a Value);

/// Returns the page, whole in one file.
pub fn page(subject: &Subject) -> String {
    let Subject { evaluation, simulator, logs, names: [sim, folder] } = subject;
    let networks = &evaluation.networks;
    let values = values(networks);
    let surfaces = pictures::surfaces(simulator, logs);
    let panels = pictures::panels(networks);
    let (events, pairs): (Vec<Panel>, Vec<Panel>) =
        panels.into_iter().partition(|panel| matches!(panel.samples, Samples::Events(_)));
    let body = scatters(&values, &pairs);
    let mut sections = vec![Section { id: "values", title: "Predicted against logged", body }];
    if let (Some(probability), Some(panel)) = (&networks.echo_probability, events.first()) {
        sections.push(Section { id: "echo", title: "Is there an echo?", body: reliability(probability, panel) });
    }
    if !surfaces.is_empty() {
        let body = responses(&surfaces);
        sections.push(Section { id: "surfaces", title: "What the sonar networks predict", body });
    }
    sections.push(Section { id: "compared", title: "What was compared", body: compared(subject) });
    Document {
        kind: "Evaluation",
        headline: &headline(&values),
        subject: &format!("{sim} on {folder}"),
        lead: html! {
            p {
                "“Well” means an R² of " (GOOD) " or more, “roughly” " (USABLE) " or more. If it predicts these logs less well than "
                "those that it was trained on, the robot has changed or drives differently: "
                code { "mindgap diagnose " (sim) " " (folder) } " says why."
            }
        },
        sections,
        script: None,
    }
    .html()
}

fn values(networks: &Networks) -> Vec<Judged<'_>> {
    let Networks { turn, forward, lateral, .. } = networks;
    let [forward, lateral, turn] = [forward, lateral, turn].map(Option::as_ref);
    let values = [
        ("forward motion", "cm", forward),
        ("sideways motion", "cm", lateral),
        ("turn", "degrees", turn),
        ("sonar reading", "cm", networks.unnamed_value()),
    ];
    let values = values.into_iter().filter_map(|(name, unit, value)| Some((Cow::Borrowed(name), unit, value?)));
    let named =
        networks.named_values().map(|(name, value)| (format!("sonar reading of {}", sensor(name)).into(), "cm", value));
    values.chain(named).collect()
}

/// Returns the sensor of a network `echo_value_NAME`.
fn sensor(network: &str) -> &str {
    network.strip_prefix("echo_value_").unwrap_or(network)
}

/// Which networks are good, usable and poor, in one sentence.
fn headline(values: &[Judged]) -> String {
    let among = |low: f64, high: f64| {
        let r2 = |v: &Value| v.r2.unwrap_or(0.0);
        let names: Vec<&str> =
            values.iter().filter(|(.., v)| (low..high).contains(&r2(v))).map(|v| v.0.as_ref()).collect();
        words::list(&names)
    };
    let parts = [
        (among(GOOD, f64::INFINITY), "well"),
        (among(USABLE, GOOD), "roughly"),
        (among(f64::NEG_INFINITY, USABLE), "hardly"),
    ];
    let said: Vec<String> =
        parts.iter().filter(|p| !p.0.is_empty()).map(|(what, how)| format!("{what} {how}")).collect();
    match said.as_slice() {
        [] => "The simulator predicts whether there is an echo, and nothing else.".into(),
        said => format!("The simulator predicts {}.", said.join(", ")),
    }
}

/// Returns a table of how well each network predicts.
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
        p { "R² is the share of the variance that the simulator predicts: 1 is all of it, 0 is no better than the mean." }
        (open_table(["network", "R²", "typical error (RMS)", "samples"], &rows))
    }
}

/// Values and panels are of the same networks, each in its own order.
fn scatters(values: &[Judged], panels: &[Panel]) -> Markup {
    let r2 = |value: &Value| value.r2.map_or_else(|| "undefined".into(), |r2| number(r2, 3));
    let said: Vec<String> = values.iter().map(|(name, _, value)| format!("{name} {}", r2(value))).collect();
    html! {
        (judged(values))
        p {
            "Each dot is a sample of the logs. On the grey diagonal the prediction is right; the orange line is the trend. "
            "Arrowheads at the edge are predictions beyond the frame."
        }
        div.pairs {
            @for panel in panels {
                (chart("scatter", &panel.draw(), &format!("Predicted against logged values. R²: {}", said.join(", ")), html! {}))
            }
        }
    }
}

fn reliability(of: &Probability, panel: &Panel) -> Markup {
    let rows: Vec<[String; 3]> =
        of.reliability.iter().map(|b| [number(b.predicted, 3), number(b.observed, 3), b.n.to_string()]).collect();
    let drawn = panel.draw();
    html! {
        (chart("reliability", &drawn, "How often there was an echo against its predicted probability", html! {
            "Where the simulator predicts 80 %, there should be an echo 80 times out of 100: on the diagonal. The numbers below "
            "the dots are samples, the vertical lines 95 % intervals. Brier score " (number(of.brier, 4)) ", log loss "
            (number(of.log_loss, 4))
            @if let Some(auc) = of.auc { ", area under the ROC curve " (number(auc, 4)) } "."
        }))
        (table("The same in numbers", ["predicted", "observed", "samples"], &rows))
    }
}

fn responses(surfaces: &[Surface]) -> Markup {
    html! {
        p {
            "What the networks predict at a distance D and an incidence angle α. Where the logs have no sample nearby the map "
            "is hatched and the sheet in space is open: there a prediction would be a guess."
        }
        @for surface in surfaces {
            h3 { (surface.title) }
            div.pairs {
                (chart("surface", &surface.from_above(), &format!("{} over distance and incidence angle, from above", surface.title),
                    html! { "From above." }))
                (chart("sheet", &surface.in_space(), &format!("{} over distance and incidence angle, in space", surface.title),
                    html! { "In space." }))
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
