//! What logs suffice for: networks, and effects that a diagnosis would show.

use maud::html;

use crate::document::{Section, open_table};
use crate::words;
use mindgap_diagnosis::excitation::Detectable;
use mindgap_diagnosis::scope::of_sensor;
use mindgap_diagnosis::survey::Survey;
use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_models::effects::CATALOGUE;

const HEADER: [&str; 3] = ["effect", "smallest departure that shows", "its usual strength shows"];

/// The section.
pub fn section(survey: &Survey) -> Section {
    let rows: Vec<[String; 3]> = survey.holds.detectable.iter().map(|of| row(of, survey)).collect();
    let body = html! {
        @if survey.missing_networks.is_empty() {
            p { "The logs suffice for all networks of a simulator." }
        } @else {
            p { "The logs do not suffice for these networks:" }
            ul { @for missing in &survey.missing_networks { li { (missing.network) ": " (missing.reason) } } }
        }
        @if rows.is_empty() {
            p { "No effect can be identified in these logs." }
        } @else {
            p {
                "Whether a diagnosis of these logs could show each effect, and the smallest departure of its parameter from neutral "
                "that nine of ten such logs would show. What is not excited cannot be ruled out."
            }
            (open_table(HEADER, &rows))
        }
        @if !survey.drive_more.is_empty() {
            h3 { "What to drive next" }
            ul { @for sentence in &survey.drive_more { li { (sentence) } } }
        }
    };
    Section { id: "identified", title: "What the logs can identify", body }
}

fn row(of: &Detectable, survey: &Survey) -> [String; 3] {
    let smallest = of.smallest.map(|smallest| format!("{} by {}", of.parameter, three_digits(smallest)));
    let is_of_further = survey.holds.sensors.iter().any(|heard| Some(&heard.sensor) == of.sensor.as_ref());
    let usual = match survey.untestable.contains(&of.id) {
        _ if is_of_further => "–",
        true => "no",
        false => "yes",
    };
    [
        of_sensor(words::name(of.id, CATALOGUE), of.sensor.as_deref()),
        smallest.unwrap_or_else(|| "none: not excited".into()),
        usual.into(),
    ]
}
