//! Headless Chromium, driven through the DevTools protocol: zero-terminated JSON texts over two pipes.
//! The browser reads and writes them as file descriptors 3 and 4. Named pipes and a shell set these up without a crate or a port.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::{channel, Receiver};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;

use serde_json::{json, Value};

use crate::installed::{left_out, runs};

/// The installed browser: `CHROMIUM`, or a usual name; prints a line if there is no browser.
pub(crate) fn program() -> Option<&'static str> {
    static FOUND: OnceLock<Option<String>> = OnceLock::new();
    let found = FOUND.get_or_init(|| {
        let named = std::env::var("CHROMIUM").ok();
        let mut names = named.iter().map(String::as_str).chain(["chromium", "chromium-browser", "google-chrome"]);
        names.find(|name| runs(name, &["--version"])).map(str::to_owned).filter(|_| cfg!(unix))
    });
    if found.is_none() {
        left_out("no `chromium` here (Debian: chromium); CHROMIUM names another browser of its kind");
    }
    found.as_deref()
}

/// Idle browsers: a new browser starts only if all others have a page open. They end with the tests, when their pipes close.
static IDLE: Mutex<Vec<Browser>> = Mutex::new(Vec::new());

/// Time limit for a page: any action takes a few seconds on a shared processor, but a script may wait for ever.
const LIMIT: Duration = Duration::from_secs(120);

/// A running browser.
struct Browser {
    child: Child,
    to: File,
    /// The browser's messages; the channel closes when the browser ends.
    from: Receiver<Vec<u8>>,
    sent: u64,
    events: Vec<Value>,
}

/// An open page, with exclusive use of a browser.
pub(crate) struct Tab {
    browser: Browser,
    session: String,
    target: String,
    address: String,
}

impl Browser {
    /// Starts a browser with an empty profile.
    fn start(program: &str) -> Browser {
        static STARTED: AtomicU32 = AtomicU32::new(0);
        let folder = folder(&format!("browser-{}", STARTED.fetch_add(1, Ordering::Relaxed)));
        std::fs::remove_dir_all(&folder).expect("an old profile goes");
        std::fs::create_dir_all(&folder).expect("a folder for the browser");
        let [to, from] = ["to", "from"].map(|name| folder.join(name));
        let made = Command::new("mkfifo").args([&to, &from]).status().expect("mkfifo runs");
        assert!(made.success(), "named pipes");
        let child = Command::new("sh")
            .args(["-c", "to=$1 from=$2; shift 2; exec \"$0\" \"$@\" 3<\"$to\" 4>\"$from\"", program])
            .args([&to, &from])
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
                "--no-first-run",
                "--disable-background-networking",
            ])
            .args(["--disable-component-update", "--disable-sync", "--remote-debugging-pipe"])
            .arg(format!("--user-data-dir={}", folder.join("profile").display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let to = OpenOptions::new().write(true).open(to).expect("the pipe to the browser");
        let mut pipe = BufReader::new(File::open(from).expect("the pipe from the browser"));
        let (texts, from) = channel();
        std::thread::spawn(move || loop {
            let mut text = Vec::new();
            let read = pipe.read_until(0, &mut text);
            if read.is_err() || text.pop() != Some(0) || texts.send(text).is_err() {
                return;
            }
        });
        Browser { child, to, from, sent: 0, events: Vec::new() }
    }

    /// Calls a method and returns its result; keeps the events that arrive before it.
    #[track_caller]
    fn call(&mut self, session: Option<&str>, method: &str, parameters: Value) -> Value {
        self.sent += 1;
        let mut message = json!({"id": self.sent, "method": method, "params": parameters});
        if let Some(session) = session {
            message["sessionId"] = json!(session);
        }
        self.to.write_all(format!("{message}\0").as_bytes()).expect("the browser listens");
        loop {
            let text = self.from.recv_timeout(LIMIT);
            let text = text.unwrap_or_else(|fault| panic!("no answer of the browser, {fault}: {method} {}", message["params"]));
            let mut message: Value = serde_json::from_slice(&text).expect("JSON");
            if message["id"] == self.sent {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].take();
            }
            self.events.push(message);
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Tab {
    /// Opens a file with a window width and a theme, and waits for the drawing; `None` without a browser.
    #[track_caller]
    pub(crate) fn open(file: &Path, width: u32, theme: &str) -> Option<Tab> {
        let program = program()?;
        let idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut browser = idle.unwrap_or_else(|| Browser::start(program));
        browser.events.clear();
        let target = browser.call(None, "Target.createTarget", json!({"url": "about:blank"}))["targetId"].take();
        let session =
            browser.call(None, "Target.attachToTarget", json!({"targetId": target, "flatten": true}))["sessionId"].take();
        let text = |value: Value| value.as_str().expect("an identifier").to_owned();
        let address = format!("file://{}", file.display());
        let mut tab = Tab { session: text(session), target: text(target), browser, address: address.clone() };
        for domain in ["Runtime", "Log", "Network", "Page"] {
            tab.call(&format!("{domain}.enable"), json!({}));
        }
        tab.resize(width, 1000, 1.0);
        let theme = json!({"features": [{"name": "prefers-color-scheme", "value": theme}]});
        tab.call("Emulation.setEmulatedMedia", theme);
        tab.call("Page.navigate", json!({"url": address}));
        for _ in 0..500 {
            if tab.run("document.documentElement?.dataset.ready ?? ''") != "" {
                return Some(tab);
            }
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        panic!("{address} is never drawn: {:?}", tab.messages());
    }

    #[track_caller]
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        let session = self.session.clone();
        self.browser.call(Some(&session), method, parameters)
    }

    /// The value of an expression, after its promise resolves.
    #[track_caller]
    pub(crate) fn run(&mut self, expression: &str) -> Value {
        let parameters = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let mut result = self.call("Runtime.evaluate", parameters);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {}", result["exceptionDetails"]);
        result["result"]["value"].take()
    }

    /// All console messages, exceptions and browser reports.
    pub(crate) fn messages(&self) -> Vec<String> {
        let spoken = ["Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"];
        let events = self.browser.events.iter().filter(|event| spoken.iter().any(|method| event["method"] == *method));
        events.map(|event| event["params"].to_string()).collect()
    }

    /// All requests, except data URLs of the page.
    pub(crate) fn requests(&self) -> Vec<String> {
        let events = self.browser.events.iter().filter(|event| event["method"] == "Network.requestWillBeSent");
        let addresses = events.filter_map(|event| event["params"]["request"]["url"].as_str());
        addresses.filter(|address| !address.starts_with("data:")).map(str::to_owned).collect()
    }

    /// Resizes the window; `scale` is the ratio of screenshot pixels to window pixels.
    pub(crate) fn resize(&mut self, width: u32, height: u32, scale: f64) {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": scale, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", size);
    }

    /// Presses the Tab key.
    pub(crate) fn press_tab(&mut self) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({"type": kind, "key": "Tab", "code": "Tab", "windowsVirtualKeyCode": 9}));
        }
    }

    /// Clicks into the middle of an element.
    pub(crate) fn click(&mut self, selector: &str) {
        self.click_for(selector, 0);
    }

    /// Clicks into the middle of an element, and holds the button for at least this time.
    pub(crate) fn click_for(&mut self, selector: &str, milliseconds: u64) {
        let at = self.run(&format!(
            "(() => {{ const e = document.querySelector('{selector}'); e.scrollIntoView({{ block: 'center' }}); const box = e.getBoundingClientRect(); \
             return [box.x + box.width / 2, box.y + box.height / 2]; }})()"
        ));
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({"type": kind, "x": at[0], "y": at[1], "button": "left", "clickCount": 1});
            self.call("Input.dispatchMouseEvent", event);
            std::thread::sleep(std::time::Duration::from_millis(milliseconds));
        }
    }

    /// Types a text into the focused element, key by key.
    pub(crate) fn type_text(&mut self, text: &str) {
        for key in text.chars().map(String::from) {
            self.call("Input.dispatchKeyEvent", json!({"type": "keyDown", "key": key, "text": key}));
            self.call("Input.dispatchKeyEvent", json!({"type": "keyUp", "key": key}));
        }
    }

    /// Presses Enter or Escape.
    pub(crate) fn press(&mut self, key: &str) {
        let (code, text) = if key == "Enter" { (13, "\r") } else { (27, "") };
        let down = json!({"type": "keyDown", "key": key, "code": key, "windowsVirtualKeyCode": code, "text": text});
        self.call("Input.dispatchKeyEvent", down);
        self.call("Input.dispatchKeyEvent", json!({"type": "keyUp", "key": key, "code": key, "windowsVirtualKeyCode": code}));
    }

    /// Prints the page to PDF; returns the size of its base64 text.
    pub(crate) fn print(&mut self) -> usize {
        self.call("Page.printToPDF", json!({}))["data"].as_str().map_or(0, str::len)
    }

    /// A screenshot of the window, in base64.
    pub(crate) fn picture(&mut self) -> String {
        self.call("Page.captureScreenshot", json!({"format": "png"}))["data"].as_str().unwrap_or_default().to_owned()
    }

    /// Closes the page; fails on any message, and on any request besides the file.
    #[track_caller]
    pub(crate) fn close(mut self) {
        // Collect late messages, too.
        self.run("new Promise((done) => setTimeout(done, 20)).then(() => 0)");
        assert_eq!(self.messages(), Vec::<String>::new(), "{}", self.address);
        assert_eq!(self.requests(), [self.address.as_str()]);
        self.browser.call(None, "Target.closeTarget", json!({"targetId": self.target}));
        IDLE.lock().unwrap_or_else(PoisonError::into_inner).push(self.browser);
    }
}

/// A folder for the files of a test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}
