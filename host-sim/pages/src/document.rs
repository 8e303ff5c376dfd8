//! The frame of a page: head, navigation, sections, data and scripts.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::Serialize;
use serde_json::Value;

use mindgap_foundations::error::{Error, Result};

/// A page.
pub struct Document<'a> {
    /// What kind of page it is, over the headline.
    pub kind: &'a str,
    /// What it says, in one sentence.
    pub headline: &'a str,
    /// What it speaks of: files.
    pub subject: &'a str,
    /// What stands under the headline.
    pub lead: Markup,
    /// Its parts.
    pub sections: Vec<Section>,
    /// Scripts that draw its charts.
    pub scripts: &'a [Script],
}

/// A part of a page.
pub struct Section {
    /// Its anchor.
    pub id: &'static str,
    /// Its title.
    pub title: &'static str,
    /// What is in it.
    pub body: Markup,
}

/// Scripts for charts of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Script {
    /// The charts of a diagnosis.
    Diagnosis,
    /// Robots that move on a map.
    Replay,
    /// The charts of an evaluation.
    Evaluation,
    /// The charts of a controller's runs.
    Simulation,
    /// The charts of a loop.
    Trials,
    /// The charts of a fleet, and its table.
    Fleet,
}

/// Nothing is fetched: a page that tried to would show an error.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'";
const STYLE: &str = include_str!("../assets/page/style.css");
const CHARTS: &str = include_str!("../assets/page/charts.js");

/// A library that a page carries, with its licence.
struct Library {
    name: &'static str,
    text: &'static str,
    licence: &'static str,
}

const D3: Library = Library {
    name: "d3 7.9.2",
    text: include_str!("../assets/vendor/d3-7.9.2.min.js"),
    licence: include_str!("../assets/vendor/d3-LICENSE"),
};
const PLOT: Library = Library {
    name: "@observablehq/plot 0.6.17",
    text: include_str!("../assets/vendor/observable-plot-0.6.17.min.js"),
    licence: include_str!("../assets/vendor/observable-plot-LICENSE"),
};
const GRAPH3D: Library = Library {
    name: "vis-graph3d 7.0.3",
    text: include_str!("../assets/vendor/vis-graph3d-7.0.3.min.js"),
    licence: include_str!("../assets/vendor/vis-graph3d-LICENSE"),
};

impl Script {
    fn text(self) -> &'static str {
        match self {
            Script::Diagnosis => include_str!("../assets/page/diagnosis.js"),
            Script::Replay => include_str!("../assets/page/replay.js"),
            Script::Evaluation => include_str!("../assets/page/evaluation.js"),
            Script::Simulation => include_str!("../assets/page/simulation.js"),
            Script::Trials => include_str!("../assets/page/trials.js"),
            Script::Fleet => include_str!("../assets/page/fleet.js"),
        }
    }
}

impl Document<'_> {
    /// The page as text; its charts draw `data`.
    ///
    /// # Errors
    /// When the data have no form in JSON.
    pub fn html(&self, data: &impl Serialize) -> Result<String> {
        let data = serde_json::to_value(data).map_err(|e| Error::new(format!("the page's data: {e}")))?;
        let libraries: &[Library] =
            if self.scripts.contains(&Script::Evaluation) { &[D3, PLOT, GRAPH3D] } else { &[D3, PLOT] };
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="generator" content="mindgap";
                    meta http-equiv="Content-Security-Policy" content=(POLICY);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    title { (self.kind) ": " (self.headline) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    header {
                        a.skip href="#main" { "To the content" }
                        p.kind { (self.kind) " · " (self.subject) }
                        h1 { (self.headline) }
                        (self.lead)
                    }
                    nav aria-label="Parts of this page" {
                        ul { @for section in &self.sections { li { a href={ "#" (section.id) } { (section.title) } } } }
                    }
                    main #main {
                        noscript { p.bad { "Without scripts this page has its words and tables, and no charts." } }
                        @for section in &self.sections {
                            section #(section.id) aria-labelledby={ (section.id) "-title" } {
                                h2 #{ (section.id) "-title" } { (section.title) }
                                (section.body)
                            }
                        }
                    }
                    footer {
                        p { "Written by mindgap " (env!("CARGO_PKG_VERSION")) "." }
                        details {
                            summary { "Licences of what this page carries" }
                            @for library in libraries { h3 { (library.name) } pre { (library.licence) } }
                        }
                    }
                    script #data type="application/json" { (embedded(&data)) }
                    @for library in libraries { script { (PreEscaped(library.text)) } }
                    script { (PreEscaped(CHARTS)) }
                    @for script in self.scripts { script { (PreEscaped(script.text())) } }
                }
            }
        };
        Ok(page.into_string() + "\n")
    }
}

/// A chart with its caption; `alternative` says in words what the eye sees.
pub fn chart(name: &str, number: usize, alternative: &str, caption: Markup) -> Markup {
    html! {
        figure {
            div.chart data-chart=(name) data-number=(number) role="img" aria-label=(alternative) {}
            figcaption { (caption) }
        }
    }
}

/// A table of numbers behind a click; the first column names its rows.
pub fn table<const N: usize>(summary: &str, header: [&str; N], rows: &[[String; N]]) -> Markup {
    html! {
        details {
            summary { (summary) }
            (open_table(header, rows))
        }
    }
}

/// The same in plain sight.
pub fn open_table<const N: usize>(header: [&str; N], rows: &[[String; N]]) -> Markup {
    let numbers: [bool; N] = std::array::from_fn(|i| are_numbers(rows.iter().map(|row| row[i].as_str())));
    html! {
        div.wide tabindex="0" role="region" aria-label={ "Table: " (header.join(", ")) } {
            table {
                thead {
                    tr {
                        @for (i, name) in header.iter().enumerate() {
                            th.n[numbers[i]] scope="col" { (name) }
                        }
                    }
                }
                tbody {
                    @for row in rows {
                        tr {
                            th.n[numbers[0]] scope="row" { (row[0]) }
                            @for (i, cell) in row.iter().enumerate().skip(1) { td.n[numbers[i]] { (cell) } }
                        }
                    }
                }
            }
        }
    }
}

/// Columns of numbers stand to the right; a dash is a number that is not there.
fn are_numbers<'a>(mut column: impl Iterator<Item = &'a str> + Clone) -> bool {
    let is_number = |cell: &str| cell.starts_with(|first: char| first.is_ascii_digit() || first == '−');
    column.clone().any(is_number) && column.all(|cell| cell == "–" || is_number(cell))
}

/// JSON inside a page: what would end its element, or begin a comment in it, is written as an escape.
fn embedded(data: &Value) -> PreEscaped<String> {
    let escaped =
        data.to_string().replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029");
    PreEscaped(escaped)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn embedded_data_ends_no_element_and_stays_the_same() {
        let data = json!({ "name": "</script><!-- <b> & \u{2028} \"" });
        let PreEscaped(text) = embedded(&data);
        assert!(!text.contains('<') && !text.contains('\u{2028}'), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).expect("still JSON"), data);
    }

    #[test]
    fn columns_of_numbers_stand_to_the_right_and_words_do_not() {
        assert!(are_numbers(["−2 to 3", "–", "41 %"].into_iter()));
        assert!(!are_numbers(["–", "weaker motor"].into_iter()), "a dash among words");
        assert!(!are_numbers(["–"].into_iter()) && !are_numbers([].into_iter()));
    }

    #[test]
    fn what_a_page_carries_ends_no_script() {
        for library in [&D3, &PLOT, &GRAPH3D] {
            assert!(!library.text.contains("</script") && !library.text.contains("<!--"), "{}", library.name);
        }
    }
}
