//! A diagnosis as a page for a browser: the words, the evidence, and the plots.

use std::fmt::Write;

use glam::DVec2;

use super::diagnosis_text;
use crate::evaluation::paths::PathError;
use crate::gap::Diagnosis;
use crate::gap::account::GapReduction;
use crate::gap::explain::profile::ResidualProfile;
use crate::report::curves;
use crate::report::curves::Curve;
use crate::report::figure::Figure;

/// The page, whole in one file.
pub fn page(diagnosis: &Diagnosis, title: &str) -> String {
    let mut body = format!("<h1>{}</h1>\n<pre>{}</pre>\n", escaped(title), escaped(&diagnosis_text::text(diagnosis)));
    if !diagnosis.strata.is_empty() {
        body += "<h2>Where the gap lies</h2>\n";
        body += &places(diagnosis);
    }
    if let Some(reduction) = diagnosis.reduction().filter(|s| !s.paths.is_empty()) {
        body += "<h2>How far paths end from logged ones</h2>\n";
        body += paths(reduction).svg();
    }
    if !diagnosis.profiles().is_empty() {
        body += "<h2>What is unexplained</h2>\n";
        diagnosis.profiles().iter().for_each(|part| body += shape(part).svg());
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>{}</title>\n<style>{STYLE}</style>\n\
         {body}</html>\n",
        escaped(title)
    )
}

const STYLE: &str = "body { font-family: 'Noto Sans', Helvetica, Arial, sans-serif; max-width: 60em; margin: 2em auto } \
                     td, th { padding: 0.1em 0.8em; text-align: right } td:nth-child(-n+2) { text-align: left }";

fn places(diagnosis: &Diagnosis) -> String {
    let head = "<table>\n<tr><th>channel<th>context<th>nats a step<th>95 %<th>share\n".to_string();
    let rows = diagnosis.strata.iter().fold(head, |mut table, place| {
        let ([low, high], share) = (place.ci95, 100.0 * place.share);
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "<tr><td>{}<td>{}<td>{:.2}<td>{low:.2} to {high:.2}<td>{share:.0} %",
            place.channel.name(),
            escaped(place.context),
            place.gap,
        );
        table
    });
    rows + "</table>\n"
}

fn paths(found: &GapReduction) -> Figure {
    let curve = |name: &str, of: fn(&PathError) -> f64| Curve {
        name: name.into(),
        points: found.paths.iter().map(|p| DVec2::new(p.steps as f64, of(p))).collect(),
        reach: Vec::new(),
    };
    let all = [
        curve("the simulator as it is", |p| p.before_cm),
        curve("with the effects", |p| p.after_cm),
        curve("scatter alone", |p| p.floor_cm),
    ];
    curves("Median distance of predicted from logged ends", "steps", "cm", &all)
}

fn shape(part: &ResidualProfile) -> Figure {
    let middle = |from: f64, to: f64| 0.5 * (from + to);
    let curve = Curve {
        name: "logged minus predicted, 95 %".into(),
        points: part.bins.iter().map(|b| DVec2::new(middle(b.from, b.to), b.off)).collect(),
        reach: part.bins.iter().map(|b| 1.96 * b.error).collect(),
    };
    let name = part.channel.name();
    curves(&format!("{name} by {}", part.depends_on), part.depends_on, part.unit, &[curve])
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
