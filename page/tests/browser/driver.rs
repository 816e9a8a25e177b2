//! Chromium without a window, driven through its DevTools protocol: JSON texts, each closed by a zero byte, over two pipes that the browser
//! has as file descriptors 3 and 4. Named pipes and a shell give it these; no crate and no port is needed.

use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use serde_json::{json, Value};

/// The browser of this machine: `CHROMIUM`, or one of the usual names; none is said in a line.
pub(crate) fn program() -> Option<String> {
    let named = std::env::var("CHROMIUM").ok();
    let names = named.iter().map(String::as_str).chain(["chromium", "chromium-browser", "google-chrome"]);
    let there = |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success());
    let found = names.into_iter().find(there).map(str::to_owned);
    if found.is_none() || !cfg!(unix) {
        println!("skipped: no `chromium` here (Debian: chromium); CHROMIUM names another browser of its kind");
        return None;
    }
    found
}

/// A running browser.
pub(crate) struct Browser {
    child: Child,
    to: File,
    from: BufReader<File>,
    sent: u64,
    events: Vec<Value>,
}

/// An open page.
pub(crate) struct Tab<'b> {
    browser: &'b mut Browser,
    session: String,
    target: String,
}

impl Browser {
    /// Starts a browser with an empty profile in `folder`, which is made anew.
    pub(crate) fn start(program: &str, folder: &Path) -> Browser {
        let _ = std::fs::remove_dir_all(folder);
        std::fs::create_dir_all(folder).expect("a folder for the browser");
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
        let from = BufReader::new(File::open(from).expect("the pipe from the browser"));
        Browser { child, to, from, sent: 0, events: Vec::new() }
    }

    /// Calls a method and gives its result; what happens until then is kept.
    #[track_caller]
    fn call(&mut self, session: Option<&str>, method: &str, parameters: Value) -> Value {
        self.sent += 1;
        let mut message = json!({"id": self.sent, "method": method, "params": parameters});
        if let Some(session) = session {
            message["sessionId"] = json!(session);
        }
        self.to.write_all(format!("{message}\0").as_bytes()).expect("the browser listens");
        loop {
            let mut text = Vec::new();
            self.from.read_until(0, &mut text).expect("the browser answers");
            assert_eq!(text.pop(), Some(0), "the browser ended");
            let mut message: Value = serde_json::from_slice(&text).expect("JSON");
            if message["id"] == self.sent {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].take();
            }
            self.events.push(message);
        }
    }

    /// Opens a file in a window of a width, in a theme, and waits until the page is drawn.
    #[track_caller]
    pub(crate) fn open(&mut self, file: &Path, width: u32, theme: &str) -> Tab<'_> {
        self.events.clear();
        let target = self.call(None, "Target.createTarget", json!({"url": "about:blank"}))["targetId"].take();
        let session = self.call(None, "Target.attachToTarget", json!({"targetId": target, "flatten": true}))["sessionId"].take();
        let text = |value: Value| value.as_str().expect("an identifier").to_owned();
        let mut tab = Tab { session: text(session), target: text(target), browser: self };
        for domain in ["Runtime", "Log", "Network", "Page"] {
            tab.call(&format!("{domain}.enable"), json!({}));
        }
        let size = json!({"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": false});
        tab.call("Emulation.setDeviceMetricsOverride", size);
        let theme = json!({"features": [{"name": "prefers-color-scheme", "value": theme}]});
        tab.call("Emulation.setEmulatedMedia", theme);
        tab.call("Page.navigate", json!({"url": format!("file://{}", file.display())}));
        for _ in 0..500 {
            if tab.run("document.documentElement?.dataset.ready ?? ''") != "" {
                return tab;
            }
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        panic!("{} is never drawn: {:?}", file.display(), tab.messages());
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Tab<'_> {
    #[track_caller]
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        let session = self.session.clone();
        self.browser.call(Some(&session), method, parameters)
    }

    /// What an expression gives, waited for.
    #[track_caller]
    pub(crate) fn run(&mut self, expression: &str) -> Value {
        let parameters = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let mut result = self.call("Runtime.evaluate", parameters);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {}", result["exceptionDetails"]);
        result["result"]["value"].take()
    }

    /// What was said on the console, exceptions and reports of the browser included.
    pub(crate) fn messages(&self) -> Vec<String> {
        let spoken = ["Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded"];
        let events = self.browser.events.iter().filter(|event| spoken.iter().any(|method| event["method"] == *method));
        events.map(|event| event["params"].to_string()).collect()
    }

    /// What was asked for, data of the page itself left out.
    pub(crate) fn requests(&self) -> Vec<String> {
        let events = self.browser.events.iter().filter(|event| event["method"] == "Network.requestWillBeSent");
        let addresses = events.filter_map(|event| event["params"]["request"]["url"].as_str());
        addresses.filter(|address| !address.starts_with("data:")).map(str::to_owned).collect()
    }

    /// Presses the key of tabulators.
    pub(crate) fn press_tab(&mut self) {
        for kind in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({"type": kind, "key": "Tab", "code": "Tab", "windowsVirtualKeyCode": 9}));
        }
    }

    /// The page as it is printed.
    pub(crate) fn print(&mut self) -> usize {
        self.call("Page.printToPDF", json!({}))["data"].as_str().map_or(0, str::len)
    }

    /// A picture of the window, in Base64.
    pub(crate) fn picture(&mut self) -> String {
        self.call("Page.captureScreenshot", json!({"format": "png"}))["data"].as_str().unwrap_or_default().to_owned()
    }

    /// Closes the page; nothing may have been said and nothing asked for but the file.
    #[track_caller]
    pub(crate) fn close(mut self, file: &Path) {
        // What is said late is said until then.
        self.run("new Promise((done) => setTimeout(done, 20)).then(() => 0)");
        assert_eq!(self.messages(), Vec::<String>::new(), "{}", file.display());
        assert_eq!(self.requests(), [format!("file://{}", file.display())]);
        let target = self.target.clone();
        self.browser.call(None, "Target.closeTarget", json!({"targetId": target}));
    }
}

/// A folder for the files of a test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}
