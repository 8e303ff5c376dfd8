//! Visits of pages in Chromium, by `tests/browser/visit.mjs`, and what is expected of every page.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use mindgap_tests::command::workspace;
use serde::Deserialize;
use serde_json::{Value, json};

/// A window: its width in px, and whether the reader likes the dark.
#[derive(Clone, Copy)]
pub struct Window {
    width: u32,
    dark: bool,
}

pub const PHONE: Window = Window { width: 380, dark: false };
pub const LAPTOP: Window = Window { width: 1280, dark: false };
const DARK_PHONE: Window = Window { width: 380, dark: true };
const DARK_LAPTOP: Window = Window { width: 1280, dark: true };

/// Returns visits that look in the same way in every window; pictures have the window's name behind `picture`.
pub fn in_all_windows(picture: &str, look: impl Fn(Visit) -> Visit) -> [Visit; 4] {
    [(PHONE, "phone"), (LAPTOP, "laptop"), (DARK_PHONE, "phone-dark"), (DARK_LAPTOP, "laptop-dark")]
        .map(|(window, name)| look(Visit::new(window, format!("{picture}-{name}"))))
}

/// One visit.
pub struct Visit {
    window: Window,
    picture: String,
    steps: Vec<Value>,
}

/// What was seen.
#[derive(Deserialize)]
pub struct Seen {
    console: Vec<String>,
    overflow: f64,
    violations: Vec<String>,
    answers: Vec<Value>,
    printed: Printed,
}

#[derive(Deserialize)]
struct Printed {
    bytes: usize,
    sheets: usize,
}

impl Visit {
    /// A visit that leaves a picture of this name.
    pub fn new(window: Window, picture: impl Into<String>) -> Self {
        Visit { window, picture: picture.into(), steps: Vec::new() }
    }

    /// Then evaluates an expression.
    pub fn ask(mut self, expression: impl Into<String>) -> Self {
        self.steps.push(Value::String(expression.into()));
        self
    }

    /// Then asks for the text of an element.
    pub fn text(self, selector: &str) -> Self {
        self.ask(format!("document.querySelector({selector:?}).textContent"))
    }

    /// Then sets a control, as a hand would.
    pub fn set(self, selector: &str, value: &str) -> Self {
        self.ask(format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.value = {value:?}; \
             ['input', 'change'].forEach((name) => e.dispatchEvent(new Event(name, {{ bubbles: true }}))); }})()"
        ))
    }

    /// Then presses a key.
    pub fn press(mut self, key: &str) -> Self {
        self.steps.push(json!({ "key": key }));
        self
    }
}

impl Seen {
    /// The answer of a step, from 0.
    #[track_caller]
    pub fn answer(&self, step: usize) -> &Value {
        &self.answers[step]
    }

    /// The same as text.
    #[track_caller]
    pub fn word(&self, step: usize) -> &str {
        self.answers[step].as_str().expect("a text")
    }
}

/// Visits a page, and checks what every page has to be: silent, no wider than its window, accessible, printable.
#[track_caller]
pub fn visit(page: &Path, visits: &[Visit]) -> Vec<Seen> {
    let pictures = workspace().join("target/pages");
    fs::create_dir_all(&pictures).expect("a folder for pictures");
    let asked: Vec<Value> = visits
        .iter()
        .map(|Visit { window, picture, steps }| {
            let picture = pictures.join(format!("{picture}.png"));
            json!({ "file": page, "width": window.width, "dark": window.dark, "picture": picture, "steps": steps })
        })
        .collect();
    let mut node = Command::new("node")
        .args([workspace().join("tests/browser/visit.mjs"), workspace().join("target/npm")])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("node is missing: tests/run.sh installs what the tests need");
    let mut stdin = node.stdin.take().expect("a pipe");
    stdin.write_all(Value::Array(asked).to_string().as_bytes()).expect("a browser that listens");
    drop(stdin);
    let output = node.wait_with_output().expect("a browser that ends");
    assert!(output.status.success(), "the visit failed; tests/run.sh installs what it needs");
    let seen: Vec<Seen> = serde_json::from_slice(&output.stdout).expect("what was seen, as JSON");
    for (seen, Visit { picture, .. }) in seen.iter().zip(visits) {
        assert_eq!(seen.console, [""; 0], "{picture}: something is said in the console");
        assert!(seen.overflow <= 0.0, "{picture} is {} px wider than its window", seen.overflow);
        assert_eq!(seen.violations, [""; 0], "{picture}: what keeps people from reading it");
        assert!(seen.printed.sheets >= 1 && seen.printed.bytes > 10_000, "{picture} prints");
    }
    let bytes = fs::metadata(page).expect("a page").len();
    assert!(bytes < 2_000_000, "{bytes} bytes");
    seen
}
