//! The syntax of Webots' worlds and PROTO files, a dialect of VRML, with the place of every number.

use std::ops::Range;

/// A parsed file: all nodes, outer ones first.
#[derive(Debug, Default)]
pub struct File {
    /// The nodes.
    pub nodes: Vec<Node>,
    /// Default values of the fields of a PROTO, by name.
    pub interface: Vec<(String, Value)>,
}

/// A node.
#[derive(Debug)]
pub struct Node {
    /// Its type, such as `HingeJoint`.
    pub kind: String,
    /// Its name, if it has one by DEF.
    pub def: Option<String>,
    /// Its dotted path.
    pub path: String,
    /// Byte after its opening brace.
    pub open: usize,
    /// Its fields, by name.
    pub fields: Vec<(String, Value)>,
}

/// The value of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Numbers, at these bytes.
    Numbers(Range<usize>),
    /// A string.
    Text(String),
    /// Nodes, by index.
    Nodes(Vec<usize>),
    /// Another node, by its name.
    Use(String),
    /// A field of the PROTO.
    Is(String),
    /// Anything else.
    Other,
}

/// Deepest nesting that is read.
const DEEPEST: usize = 200;

struct Token<'a> {
    text: &'a str,
    at: Range<usize>,
}

struct Parser<'a> {
    tokens: Vec<Token<'a>>,
    next: usize,
    file: File,
}

impl File {
    /// Parses a file.
    ///
    /// # Errors
    /// With the byte and a reason in words, if braces do not match, or if the file is a template.
    pub fn parse(text: &str) -> Result<Self, (usize, String)> {
        if let Some(at) = text.find("%<").or_else(|| text.find("%{")) {
            return Err((at, "is a template: expand it in Webots and patch the result".into()));
        }
        let mut parser = Parser { tokens: tokens(text)?, next: 0, file: File::default() };
        parser.top()?;
        Ok(parser.file)
    }

    /// Returns a field of a node.
    pub fn field(&self, node: usize, name: &str) -> Option<&Value> {
        self.nodes[node].fields.iter().find(|(own, _)| own == name).map(|(_, value)| value)
    }

    /// Returns the nodes that a field holds, by itself or by another node's name.
    pub fn nodes_of(&self, node: usize, name: &str) -> Vec<usize> {
        match self.field(node, name) {
            Some(Value::Nodes(nodes)) => nodes.clone(),
            Some(Value::Use(def)) => self.defined(def).into_iter().collect(),
            _ => Vec::new(),
        }
    }

    /// Returns the node of a name.
    pub fn defined(&self, def: &str) -> Option<usize> {
        self.nodes.iter().position(|node| node.def.as_deref() == Some(def))
    }

    /// Returns all nodes of a type.
    pub fn all<'t>(&'t self, kind: &'t str) -> impl Iterator<Item = usize> + 't {
        (0..self.nodes.len()).filter(move |node| self.nodes[*node].kind == kind)
    }
}

impl<'a> Parser<'a> {
    fn peek(&self) -> Option<&'a str> {
        self.tokens.get(self.next).map(|token| token.text)
    }

    fn take(&mut self) -> Option<&'a str> {
        let text = self.peek();
        self.next += usize::from(text.is_some());
        text
    }

    fn error<T>(&self, what: &str) -> Result<T, (usize, String)> {
        let last = self.tokens.get(self.next.min(self.tokens.len().saturating_sub(1)));
        Err((last.map_or(0, |token| token.at.start), what.into()))
    }

    fn top(&mut self) -> Result<(), (usize, String)> {
        let mut count = 0;
        while let Some(word) = self.peek() {
            match word {
                "PROTO" => {
                    self.next += 2;
                    self.interface()?;
                    if self.take() != Some("{") {
                        return self.error("expected {");
                    }
                    while self.peek().is_some_and(|word| word != "}") {
                        self.node(String::new(), 0)?;
                    }
                    self.next += 1;
                }
                "EXTERNPROTO" | "IMPORTABLE" => self.next += if word == "IMPORTABLE" { 1 } else { 2 },
                _ => {
                    self.node(format!("[{count}]"), 0)?;
                    count += 1;
                }
            }
        }
        Ok(())
    }

    /// Reads `[ field SFFloat name 1 ... ]`.
    fn interface(&mut self) -> Result<(), (usize, String)> {
        if self.take() != Some("[") {
            return self.error("expected [");
        }
        while let Some(word) = self.take() {
            if word == "]" {
                return Ok(());
            }
            // The type, which may list what it accepts.
            self.next += 1;
            let mut open = 0;
            while self.peek() == Some("{") || open > 0 {
                match self.take() {
                    Some("{") => open += 1,
                    Some("}") => open -= 1,
                    Some(_) => {}
                    None => return self.error("{ is not closed"),
                }
            }
            let Some(name) = self.take() else { break };
            let value = self.value(&format!("fields.{name}"), 0)?;
            self.file.interface.push((name.into(), value));
        }
        self.error("[ is not closed")
    }

    /// Reads a node and returns its index.
    fn node(&mut self, place: String, depth: usize) -> Result<usize, (usize, String)> {
        if depth > DEEPEST {
            return self.error("is nested too deeply");
        }
        let mut def = None;
        if self.peek() == Some("DEF") {
            self.next += 1;
            def = self.take().map(str::to_owned);
        }
        let kind = self.take().unwrap_or_default().to_owned();
        let open = self.tokens.get(self.next).map_or(0, |token| token.at.end);
        if self.take() != Some("{") {
            self.next = self.next.saturating_sub(1);
            return self.error(&format!("expected {{ after {kind}"));
        }
        let path = if place.is_empty() || place.starts_with('[') { format!("{kind}{place}") } else { place };
        let index = self.file.nodes.len();
        self.file.nodes.push(Node { kind, def, path: path.clone(), open, fields: Vec::new() });
        loop {
            match self.take() {
                Some("}") => return Ok(index),
                None => return self.error("{ is not closed"),
                Some(name) => {
                    let value = self.value(&format!("{path}.{name}"), depth)?;
                    self.file.nodes[index].fields.push((name.into(), value));
                }
            }
        }
    }

    fn value(&mut self, path: &str, depth: usize) -> Result<Value, (usize, String)> {
        match self.peek() {
            Some("[") => {
                self.next += 1;
                self.list(path, depth)
            }
            Some("USE") => {
                self.next += 1;
                Ok(Value::Use(self.take().unwrap_or_default().into()))
            }
            Some("IS") => {
                self.next += 1;
                Ok(Value::Is(self.take().unwrap_or_default().into()))
            }
            Some(word) if is_number(word) => Ok(Value::Numbers(self.numbers())),
            Some(word) if word.starts_with('"') => {
                self.next += 1;
                Ok(Value::Text(word.trim_matches('"').into()))
            }
            Some("TRUE" | "FALSE" | "NULL") => {
                self.next += 1;
                Ok(Value::Other)
            }
            Some("}" | "]") | None => self.error(&format!("{path} has no value")),
            Some(_) => Ok(Value::Nodes(vec![self.node(path.into(), depth + 1)?])),
        }
    }

    fn list(&mut self, path: &str, depth: usize) -> Result<Value, (usize, String)> {
        if self.peek().is_some_and(is_number) {
            let at = self.numbers();
            return if self.take() == Some("]") { Ok(Value::Numbers(at)) } else { self.error("expected ]") };
        }
        let mut nodes = Vec::new();
        loop {
            match self.peek() {
                Some("]") => {
                    self.next += 1;
                    return Ok(Value::Nodes(nodes));
                }
                None => return self.error("[ is not closed"),
                Some("USE") => {
                    self.next += 1;
                    let def = self.take().unwrap_or_default();
                    nodes.extend(self.file.defined(def));
                }
                Some("TRUE" | "FALSE" | "NULL") => self.next += 1,
                Some(word) if word.starts_with('"') => self.next += 1,
                Some(_) => nodes.push(self.node(format!("{path}[{}]", nodes.len()), depth + 1)?),
            }
        }
    }

    fn numbers(&mut self) -> Range<usize> {
        let start = self.tokens[self.next].at.start;
        while self.peek().is_some_and(is_number) {
            self.next += 1;
        }
        start..self.tokens[self.next - 1].at.end
    }
}

fn is_number(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) && word.parse::<f64>().is_ok()
}

fn tokens(text: &str) -> Result<Vec<Token<'_>>, (usize, String)> {
    let (bytes, mut at, mut tokens) = (text.as_bytes(), 0, Vec::new());
    while at < bytes.len() {
        let start = at;
        match bytes[at] {
            b'#' => at = text[at..].find('\n').map_or(bytes.len(), |end| at + end),
            b'{' | b'}' | b'[' | b']' => {
                at += 1;
                tokens.push(Token { text: &text[start..at], at: start..at });
            }
            b'"' => {
                at += 1;
                while at < bytes.len() && bytes[at] != b'"' {
                    at += if bytes[at] == b'\\' { 2 } else { 1 };
                }
                if at >= bytes.len() {
                    return Err((start, "a string is not closed".into()));
                }
                at += 1;
                tokens.push(Token { text: &text[start..at], at: start..at });
            }
            c if c.is_ascii_whitespace() || c == b',' => at += 1,
            _ => {
                let ends = |b: &u8| b.is_ascii_whitespace() || b",{}[]\"#".contains(b);
                at = bytes[at..].iter().position(ends).map_or(bytes.len(), |length| at + length);
                tokens.push(Token { text: &text[start..at], at: start..at });
            }
        }
    }
    Ok(tokens)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"#VRML_SIM R2025a utf8
EXTERNPROTO "https://example.org/Floor.proto"
Robot { children [ DEF W Solid { translation 0 0.1, 0 name "w {" } USE W ] # }
  controller "c" }"#;

    #[test]
    fn nodes_have_paths_fields_and_places() {
        let file = File::parse(TEXT).expect("a world");
        assert_eq!(
            file.nodes.iter().map(|node| node.path.as_str()).collect::<Vec<_>>(),
            ["Robot[0]", "Robot[0].children[0]"]
        );
        assert_eq!(file.nodes_of(0, "children"), [1, 1]);
        let Some(Value::Numbers(at)) = file.field(1, "translation") else { panic!("numbers") };
        assert_eq!(&TEXT[at.clone()], "0 0.1, 0");
        assert_eq!(file.field(1, "name"), Some(&Value::Text("w {".into())));
    }

    #[test]
    fn interfaces_of_protos_are_read() {
        let text = "PROTO R [ field SFFloat r 0.03 field MFNode{Solid{}} s [] ] { Robot { radius IS r } }";
        let file = File::parse(text).expect("a PROTO");
        assert!(matches!(&file.interface[0], (name, Value::Numbers(at)) if name == "r" && &text[at.clone()] == "0.03"));
        assert_eq!(file.field(0, "radius"), Some(&Value::Is("r".into())));
    }

    #[test]
    fn broken_files_are_refused_and_never_panic() {
        for end in 0..TEXT.len() {
            let _ = File::parse(&TEXT[..end]);
        }
        assert!(File::parse("Robot { children [").is_err());
        assert!(File::parse("Robot { a %< b >% }").is_err());
        assert!(File::parse(&"A { b ".repeat(10_000)).is_err());
        assert!(File::parse("\"\\").is_err());
    }
}
