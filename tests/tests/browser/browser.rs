//! A page that is open in Chromium, and what is expected of every page.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

use headless_chrome::protocol::cdp::types::Event;
use headless_chrome::protocol::cdp::{Emulation, Page as Cdp, Runtime};
use headless_chrome::{Browser, LaunchOptions, Tab};
use mindgap_tests::command::workspace;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// A page in a window.
pub struct Page {
    tab: Arc<Tab>,
    said: Arc<Mutex<Vec<String>>>,
}

/// A window: its width in px, and whether the reader likes the dark.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    pub width: u32,
    pub dark: bool,
}

pub const PHONE: Window = Window { width: 380, dark: false };
pub const LAPTOP: Window = Window { width: 1280, dark: false };
pub const DARK_PHONE: Window = Window { width: 380, dark: true };
pub const DARK_LAPTOP: Window = Window { width: 1280, dark: true };

/// Machines that do other things besides may take this long.
const PATIENCE: Duration = Duration::from_secs(120);

/// One browser for all tests.
static BROWSER: LazyLock<Browser> = LazyLock::new(|| {
    let options = LaunchOptions {
        // Tests run as root in containers, where Chromium has no sandbox.
        sandbox: false,
        path: ["/usr/bin/chromium", "/usr/bin/chromium-browser"].iter().map(PathBuf::from).find(|path| path.exists()),
        idle_browser_timeout: PATIENCE,
        args: vec![OsStr::new("--hide-scrollbars"), OsStr::new("--disable-dev-shm-usage")],
        ..LaunchOptions::default()
    };
    Browser::new(options).expect("Chromium is missing: apt-get install chromium")
});

impl Page {
    /// Opens a file and waits until its charts are drawn.
    pub fn open(path: &Path, window: Window) -> Self {
        let tab = BROWSER.new_tab().expect("a tab");
        tab.set_default_timeout(PATIENCE);
        let said = Arc::new(Mutex::new(Vec::new()));
        let heard = said.clone();
        let listen = move |event: &Event| {
            let words = match event {
                Event::LogEntryAdded(event) => format!("{event:?}"),
                Event::RuntimeExceptionThrown(event) => format!("{event:?}"),
                Event::RuntimeConsoleAPICalled(event) => format!("{event:?}"),
                _ => return,
            };
            heard.lock().expect("no listener panics").push(words);
        };
        tab.add_event_listener(Arc::new(listen)).expect("a tab that tells its events");
        tab.enable_log().and_then(|tab| tab.enable_runtime()).expect("a tab that tells its events");
        let page = Page { tab, said };
        page.show_in(window);
        page.tab.navigate_to(&format!("file://{}", path.display())).expect("a page");
        page.tab.wait_until_navigated().expect("a page that ends loading");
        page.wait_for("[...document.querySelectorAll('[data-chart]')].every(place => place.querySelector('svg'))");
        page
    }

    fn show_in(&self, Window { width, dark }: Window) {
        let metrics = Emulation::SetDeviceMetricsOverride {
            width,
            height: 800,
            device_scale_factor: 1.0,
            mobile: width < 600,
            scale: None,
            screen_width: None,
            screen_height: None,
            position_x: None,
            position_y: None,
            dont_set_visible_size: None,
            screen_orientation: None,
            viewport: None,
            display_feature: None,
            device_posture: None,
            scrollbar_type: None,
            screen_orientation_lock_emulation: None,
        };
        self.tab.call_method(metrics).expect("a window of another size");
        let scheme = String::from(if dark { "dark" } else { "light" });
        let features = vec![Emulation::MediaFeature { name: "prefers-color-scheme".into(), value: scheme }];
        self.tab
            .call_method(Emulation::SetEmulatedMedia { media: None, features: Some(features) })
            .expect("a window in another light");
    }

    /// The value of an expression in the page.
    #[track_caller]
    pub fn evaluate<T: DeserializeOwned>(&self, expression: &str) -> T {
        let asked = Runtime::Evaluate {
            expression: expression.into(),
            return_by_value: Some(true),
            await_promise: Some(true),
            user_gesture: Some(true),
            object_group: None,
            include_command_line_api: None,
            silent: None,
            context_id: None,
            generate_preview: None,
            throw_on_side_effect: None,
            timeout: None,
            disable_breaks: None,
            repl_mode: None,
            allow_unsafe_eval_blocked_by_csp: None,
            unique_context_id: None,
            serialization_options: None,
        };
        let answer = self.tab.call_method(asked).expect("an answer");
        assert!(answer.exception_details.is_none(), "{expression}: {:?}", answer.exception_details);
        serde_json::from_value(answer.result.value.unwrap_or(Value::Null)).expect("a value of the expected type")
    }

    /// Waits until a condition holds.
    #[track_caller]
    pub fn wait_for(&self, condition: &str) {
        let begin = Instant::now();
        while !self.evaluate::<bool>(condition) {
            assert!(begin.elapsed() < PATIENCE, "{condition} does not come; {:?}", self.console());
            sleep(Duration::from_millis(100));
        }
    }

    /// What the page wrote to the console, and what went wrong in it.
    pub fn console(&self) -> Vec<String> {
        self.said.lock().expect("no listener panics").clone()
    }

    /// Text of the first element of a selector.
    #[track_caller]
    pub fn text(&self, selector: &str) -> String {
        self.evaluate(&format!("document.querySelector({selector:?}).textContent"))
    }

    /// Sets a control and tells the page, as a hand would.
    #[track_caller]
    pub fn set(&self, selector: &str, value: &str, event: &str) {
        let script = format!(
            "(() => {{ const e = document.querySelector({selector:?}); e.value = {value:?}; \
             e.dispatchEvent(new Event({event:?}, {{ bubbles: true }})); }})()"
        );
        self.evaluate::<Value>(&script);
    }

    /// Presses a key.
    pub fn press(&self, key: &str) {
        self.tab.press_key(key).expect("a key");
    }

    /// Leaves a picture of the whole page for people.
    pub fn picture(&self, name: &str) {
        let height: f64 = self.evaluate("document.documentElement.scrollHeight");
        let width: f64 = self.evaluate("document.documentElement.clientWidth");
        let whole = Cdp::Viewport { x: 0.0, y: 0.0, width, height, scale: 1.0 };
        let png = self.tab.capture_screenshot(Cdp::CaptureScreenshotFormatOption::Png, None, Some(whole), true);
        let folder = workspace().join("target/pages");
        fs::create_dir_all(&folder).expect("a folder for pictures");
        fs::write(folder.join(format!("{name}.png")), png.expect("a picture")).expect("a picture on disk");
    }

    /// The page as it is printed.
    pub fn pdf(&self) -> Vec<u8> {
        self.tab.print_to_pdf(None).expect("a print")
    }

    /// What every page has to be: silent, no wider than its window, accessible.
    #[track_caller]
    pub fn assert_sound(&self) {
        assert_eq!(self.console(), [""; 0], "nothing is said in the console");
        let [wide, window]: [f64; 2] =
            self.evaluate("[document.documentElement.scrollWidth, document.documentElement.clientWidth]");
        assert!(wide <= window, "the page is {wide} px wide in a window of {window} px");
        self.evaluate::<Value>(&format!("{}; null", *AXE));
        let found: Vec<String> = self.evaluate(
            "axe.run().then(found => found.violations.filter(v => ['serious', 'critical'].includes(v.impact))
                .map(v => `${v.id}: ${v.help}: ${v.nodes.map(n => n.html).slice(0, 3).join(' | ')}`))",
        );
        assert_eq!(found, [""; 0], "what keeps people from reading the page");
    }
}

/// The accessibility checker, which `tests/run.sh` installs.
static AXE: LazyLock<String> = LazyLock::new(|| {
    let path = workspace().join("target/npm/node_modules/axe-core/axe.min.js");
    fs::read_to_string(&path)
        .unwrap_or_else(|e| panic!("{}: {e}: npm install --prefix target/npm axe-core", path.display()))
});
