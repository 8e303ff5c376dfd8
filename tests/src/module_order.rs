//! The order of modules as a document states it, and who breaks it.

use crate::modules::Edge;

/// A list of modules, each of which may know only those before it.
pub struct Order(Vec<Line>);

/// A line of the list.
struct Line {
    /// Its modules, in their order.
    modules: Vec<String>,
    /// Who alone may know them, where that is said.
    known_only_to: Option<Vec<String>>,
}

impl Order {
    /// Reads the list below a heading: lines as ``- `a`, `b`: what they are; known only to `c`, `d` ``.
    ///
    /// # Panics
    /// When there is no such heading, or a line of the list has no colon.
    pub fn parse(document: &str, heading: &str) -> Self {
        let mut lines = document.lines().skip_while(|line| *line != heading).skip(1).peekable();
        assert!(lines.peek().is_some(), "{heading:?} is missing");
        let list = lines.take_while(|line| !line.starts_with('#')).filter(|line| line.starts_with("- "));
        let line = |line: &str| {
            let (modules, meaning) = line.split_once(':').unwrap_or_else(|| panic!("no colon in {line:?}"));
            let known_only_to = meaning.split_once("known only to").map(|(_, those)| quoted(those));
            Line { modules: quoted(modules), known_only_to }
        };
        Order(list.map(line).collect())
    }

    /// All modules in their order.
    pub fn modules(&self) -> Vec<&str> {
        self.0.iter().flat_map(|line| &line.modules).map(String::as_str).collect()
    }

    /// The edges to a module that does not come before the importing one, or that is not for it to know.
    pub fn broken_by(&self, edges: &[Edge]) -> Vec<Edge> {
        let modules = self.modules();
        let place = |name: &str| modules.iter().position(|module| *module == name);
        let closed = |edge: &Edge| {
            let line = self.0.iter().find(|line| line.modules.contains(&edge.to));
            line.and_then(|line| line.known_only_to.as_ref()).is_some_and(|those| !those.contains(&edge.from))
        };
        edges.iter().filter(|edge| place(&edge.to) >= place(&edge.from) || closed(edge)).cloned().collect()
    }
}

/// The words in backticks.
pub fn quoted(text: &str) -> Vec<String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOCUMENT: &str = "\
- `before`: in another list

## Order

A module knows those `above` it.

- `low`, `middle`: the ground
- `secret`: known only to `top`
- `high`, `top`: the rest

## Next

- `after`: in another list
";

    /// Which of these edges, as `from>to`, break the order.
    fn broken<'e>(edges: &[&'e str]) -> Vec<&'e str> {
        let edge = |text: &&str| {
            let (from, to) = text.split_once('>').expect("two ends");
            Edge { from: from.into(), to: to.into(), witness: String::new() }
        };
        let order = Order::parse(DOCUMENT, "## Order");
        edges.iter().filter(|text| !order.broken_by(&[edge(text)]).is_empty()).copied().collect()
    }

    #[test]
    fn the_list_below_the_heading_counts() {
        assert_eq!(Order::parse(DOCUMENT, "## Order").modules(), ["low", "middle", "secret", "high", "top"]);
    }

    #[test]
    fn an_upward_import_breaks_the_order() {
        assert_eq!(broken(&["low>middle", "middle>low", "low>high", "high>low"]), ["low>middle", "low>high"]);
    }

    #[test]
    fn a_module_that_is_not_listed_breaks_the_order() {
        assert_eq!(broken(&["new>low", "low>new"]), ["new>low"]);
    }

    #[test]
    fn only_those_named_know_a_closed_module() {
        assert_eq!(broken(&["high>secret", "top>secret"]), ["high>secret"]);
    }
}
