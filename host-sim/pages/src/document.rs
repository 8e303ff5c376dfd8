//! The frame of a page: head, navigation, sections and script.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::Serialize;
use serde_json::Value;

use mindgap_figures::report::Figure;
use mindgap_foundations::error::{Error, Result};

/// A page.
pub struct Document<'a> {
    /// What kind of page it is; shown above the headline.
    pub kind: &'a str,
    /// The result in one sentence.
    pub headline: &'a str,
    /// The files that it is about.
    pub subject: &'a str,
    /// The text under the headline.
    pub lead: Markup,
    /// Its parts.
    pub sections: Vec<Section>,
    /// What moves on it, if anything does.
    pub script: Option<Script>,
}

/// A part of a page.
pub struct Section {
    /// Its anchor.
    pub id: &'static str,
    /// Its title.
    pub title: &'static str,
    /// Its content.
    pub body: Markup,
}

/// A script with its data.
pub struct Script {
    text: &'static str,
    data: Value,
}

/// Nothing is fetched: a page that tried to would show an error.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'";
const STYLE: &str = include_str!("../assets/page/style.css");

impl Script {
    /// A script that reads its data from the element `data`.
    ///
    /// # Errors
    /// When the data have no form in JSON.
    pub fn new(text: &'static str, data: &impl Serialize) -> Result<Self> {
        let data = serde_json::to_value(data).map_err(|e| Error::new(format!("the page's data: {e}")))?;
        Ok(Script { text, data })
    }

    /// A script without data.
    pub fn without_data(text: &'static str) -> Self {
        Script { text, data: Value::Null }
    }
}

impl Document<'_> {
    /// Returns the page as text.
    pub fn html(&self) -> String {
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
                        @for section in &self.sections {
                            section #(section.id) aria-labelledby={ (section.id) "-title" } {
                                h2 #{ (section.id) "-title" } { (section.title) }
                                (section.body)
                            }
                        }
                    }
                    footer { p { "Written by mindgap " (env!("CARGO_PKG_VERSION")) "." } }
                    @if let Some(Script { text, data }) = &self.script {
                        @if !data.is_null() { script #data type="application/json" { (embedded(data)) } }
                        script { (PreEscaped(text)) }
                    }
                }
            }
        };
        page.into_string() + "\n"
    }
}

/// A chart with its caption; `alternative` describes it in words.
pub fn chart(name: &str, figure: &Figure, alternative: &str, caption: Markup) -> Markup {
    html! {
        figure {
            div.chart data-chart=(name) role="img" aria-label=(alternative) { (PreEscaped(figure.in_page())) }
            figcaption { (caption) }
        }
    }
}

/// A table of numbers that opens on a click; the first column names its rows.
pub fn table<const N: usize>(summary: &str, header: [&str; N], rows: &[[String; N]]) -> Markup {
    html! {
        details {
            summary { (summary) }
            (open_table(header, rows))
        }
    }
}

/// A table that is always visible.
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

/// Whether a column has numbers, which are aligned to the right; a dash is a missing number.
fn are_numbers<'a>(mut column: impl Iterator<Item = &'a str> + Clone) -> bool {
    let is_number = |cell: &str| cell.starts_with(|first: char| first.is_ascii_digit() || first == '−');
    column.clone().any(is_number) && column.all(|cell| cell == "–" || is_number(cell))
}

/// JSON inside a page: characters that would end its element, or begin a comment in it, are written as escapes.
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
    fn embedded_data_end_no_element_and_stay_the_same() {
        let data = json!({ "name": "</script><!-- <b> & \u{2028} \"" });
        let PreEscaped(text) = embedded(&data);
        assert!(!text.contains('<') && !text.contains('\u{2028}'), "{text}");
        assert_eq!(serde_json::from_str::<Value>(&text).expect("still JSON"), data);
    }

    #[test]
    fn columns_of_numbers_are_aligned_to_the_right_and_words_are_not() {
        assert!(are_numbers(["−2 to 3", "–", "41 %"].into_iter()));
        assert!(!are_numbers(["–", "weaker motor"].into_iter()), "a dash among words");
        assert!(!are_numbers(["–"].into_iter()) && !are_numbers([].into_iter()));
    }

    #[test]
    fn drawings_change_their_colours_in_the_dark() {
        use mindgap_figures::report::style::{BLUE, FAINT, GREEN, GREY, INK, SOLID, VERMILION, WHITE};
        for colour in [INK, GREY, FAINT, SOLID, WHITE, BLUE, VERMILION, GREEN] {
            for attribute in ["fill", "stroke"] {
                let rule = format!(".chart [{attribute}=\"{colour}\"] {{\n  {attribute}: var(--");
                assert!(STYLE.contains(&rule), "{rule}");
            }
        }
    }
}
