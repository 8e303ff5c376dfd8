//! What logs hold, in numbers.

use maud::html;

use crate::document::Section;
use crate::text::{amounts, holdings};
use mindgap_diagnosis::survey::Survey;

/// The section.
pub fn section(survey: &Survey) -> Section {
    let body = html! {
        p { (amounts(&survey.holds)) "." }
        dl { @for (what, text) in holdings(&survey.holds) { dt { (what) } dd { (text) } } }
    };
    Section { id: "holds", title: "What the logs hold", body }
}
