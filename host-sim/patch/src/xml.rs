//! XML with the place of every number.

use std::path::Path;

use roxmltree::{Document, Node};

use super::edit::{Change, Edit, Numbers};
use mindgap_foundations::error::{Error, Result};

/// An XML text and its tree.
pub struct Xml<'a> {
    /// The text.
    pub text: &'a str,
    /// The tree.
    pub tree: Document<'a>,
}

impl<'a> Xml<'a> {
    /// Parses a text; `path` is for messages.
    ///
    /// # Errors
    /// If it is not XML; the error names the line.
    pub fn parse(path: &Path, text: &'a str) -> Result<Self> {
        let tree = Document::parse(text).map_err(|e| Error::at_line(path, u64::from(e.pos().row), e.to_string()))?;
        Ok(Xml { text, tree })
    }

    /// Returns the line of a node, from 1.
    pub fn line(&self, node: Node) -> u64 {
        u64::from(self.tree.text_pos_at(node.range().start).row)
    }

    /// Returns all elements of a name.
    pub fn all<'t>(&'t self, name: &'t str) -> impl Iterator<Item = Node<'t, 'a>> {
        self.tree.descendants().filter(move |node| node.has_tag_name(name))
    }

    /// Returns the numbers of an attribute, or `None` if it is missing.
    ///
    /// # Errors
    /// In words, if it holds something else.
    pub fn attribute(&self, node: Node, name: &str) -> std::result::Result<Option<Numbers>, String> {
        let attribute = node.attribute_node(name);
        let numbers = |at| Numbers::parse(self.text, at, format!("{}/@{name}", xpath(node)));
        attribute.map(|attribute| numbers(attribute.range_value())).transpose()
    }

    /// Returns the numbers that an element contains.
    ///
    /// # Errors
    /// In words, if it contains something else.
    pub fn content(&self, node: Node) -> std::result::Result<Numbers, String> {
        let text = node.children().find(|child| child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty()));
        let text = text.ok_or_else(|| format!("{} is empty", xpath(node)))?;
        Numbers::parse(self.text, text.range(), xpath(node))
    }

    /// Returns the edit that adds attributes to an element, after its others.
    pub fn add_attributes(&self, node: Node, attributes: &str) -> Edit {
        let last = node.attributes().map(|attribute| attribute.range().end).max();
        let at = last.unwrap_or_else(|| self.name_end(node));
        Edit { at: at..at, text: format!(" {attributes}") }
    }

    /// Returns the change that adds an attribute to an element.
    pub fn added_attribute(&self, node: Node, name: &str, value: &str, unit: &'static str, reason: String) -> Change {
        Change {
            tag: format!("{}/@{name}", xpath(node)),
            old: String::new(),
            new: value.into(),
            unit,
            ci95: None,
            edits: vec![self.add_attributes(node, &format!("{name}=\"{value}\""))],
            reason,
        }
    }

    /// Returns the edit that adds elements to an element, before its others.
    pub fn add_elements(&self, node: Node, elements: &str) -> Edit {
        let range = node.range();
        if self.text[range.clone()].ends_with("/>") && node.first_child().is_none() {
            return Edit { at: range.end - 2..range.end, text: format!(">{elements}</{}>", self.name(node)) };
        }
        let first = node.first_child().map(|child| child.range().start);
        let at = first.unwrap_or_else(|| range.end - self.name(node).len() - "</>".len());
        Edit { at: at..at, text: elements.into() }
    }

    /// Returns the edits that give an element another name.
    pub fn rename(&self, node: Node, name: &str) -> Vec<Edit> {
        let (range, end) = (node.range(), self.name_end(node));
        let mut edits = vec![Edit { at: range.start + 1..end, text: name.into() }];
        let closing = format!("</{}", self.name(node));
        if let Some(at) = self.text[range.clone()].rfind(&closing) {
            let at = range.start + at + 2;
            edits.push(Edit { at: at..at + self.name(node).len(), text: name.into() });
        }
        edits
    }

    /// Returns the name of an element as it is written, with its prefix.
    fn name(&self, node: Node) -> &'a str {
        &self.text[node.range().start + 1..self.name_end(node)]
    }

    fn name_end(&self, node: Node) -> usize {
        let start = node.range().start + 1;
        let length = self.text[start..].find(|c: char| c.is_whitespace() || c == '/' || c == '>');
        start + length.unwrap_or_default()
    }
}

/// Returns the child element of a name.
pub fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// Returns the text of the first child element that has one of these names.
pub fn child_text<'a>(node: Node<'a, '_>, names: &[&str]) -> Option<&'a str> {
    names.iter().find_map(|name| child(node, name)?.text()).map(str::trim)
}

/// Returns an XPath that leads to an element and to no other.
pub fn xpath(node: Node) -> String {
    let steps: Vec<String> = node.ancestors().filter(Node::is_element).map(step).collect();
    steps.iter().rev().map(|step| format!("/{step}")).collect()
}

/// Returns the last step of an element's XPath: by its name among others of its kind, or else by its number.
fn step(node: Node) -> String {
    let tag = node.tag_name().name();
    let same = |other: &Node| other.is_element() && other.tag_name().name() == tag;
    let before = node.prev_siblings().skip(1).filter(same).count();
    let after = node.next_siblings().skip(1).filter(same).count();
    if before + after == 0 {
        return tag.into();
    }
    let name = node.attribute("name").filter(|name| {
        let siblings = node.prev_siblings().skip(1).chain(node.next_siblings().skip(1)).filter(same);
        !name.contains(['\'', '&']) && siblings.filter(|other| other.attribute("name") == Some(name)).count() == 0
    });
    name.map_or_else(|| format!("{tag}[{}]", before + 1), |name| format!("{tag}[@name='{name}']"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edit::applied;

    fn xml(text: &str) -> Xml<'_> {
        Xml::parse(Path::new("a.xml"), text).expect("XML")
    }

    #[test]
    fn elements_have_an_xpath_of_their_own() {
        let xml = xml("<a><b name='x'><c/></b><b name='y'><c/><c/></b><d/></a>");
        let paths: Vec<String> = xml.all("c").chain(xml.all("d")).map(xpath).collect();
        assert_eq!(paths, ["/a/b[@name='x']/c", "/a/b[@name='y']/c[1]", "/a/b[@name='y']/c[2]", "/a/d"]);
    }

    #[test]
    fn attributes_elements_and_names_are_added_in_place() {
        let text = "<a>\r\n <b  x=\"1\" /><b></b><b>t</b></a>";
        let xml = xml(text);
        let nodes: Vec<Node> = xml.all("b").collect();
        assert_eq!(
            applied(text, &[xml.add_attributes(nodes[0], "y=\"2\"")]),
            text.replace("x=\"1\"", "x=\"1\" y=\"2\"")
        );
        let with = |i: usize| applied(text, &[xml.add_elements(nodes[i], "<c/>")]);
        assert_eq!(with(0), text.replace(" />", " ><c/></b>"));
        assert_eq!(with(1), text.replace("<b></b>", "<b><c/></b>"));
        assert_eq!(with(2), text.replace("<b>t", "<b><c/>t"));
        assert_eq!(applied(text, &xml.rename(nodes[2], "e")), text.replace("<b>t</b>", "<e>t</e>"));
        assert_eq!(applied(text, &xml.rename(nodes[0], "e")), text.replace("<b  x", "<e  x"));
    }

    #[test]
    fn broken_xml_is_reported_with_its_line() {
        let error = Xml::parse(Path::new("a.xml"), "<a>\n<b>\n</a>").err().expect("broken").to_string();
        assert!(error.starts_with("a.xml:3: "), "{error}");
    }
}
