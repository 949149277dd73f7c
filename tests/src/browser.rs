//! A page in Debian's Chromium without a screen, driven through its DevTools pipe.
//!
//! Chromium reads commands on descriptor 3 and answers on descriptor 4, each a JSON object that ends in a zero byte; a
//! shell puts our pipes there. That takes no port and no library.

use std::collections::VecDeque;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

use crate::skipped;

/// What Chromium needs to be quiet, and to start where there is no screen.
const FLAGS: [&str; 9] = [
    "--headless",
    "--disable-gpu",
    "--disable-quic",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--remote-debugging-pipe",
];

/// A browser with one page.
#[derive(Debug)]
pub struct Browser {
    child: Child,
    commands: ChildStdin,
    answers: BufReader<ChildStdout>,
    profile: PathBuf,
    session: Option<String>,
    n_sent: u64,
    /// What the page has reported since it was opened, in order.
    pub events: VecDeque<Value>,
}

/// The size of a screen, and whether fingers touch it.
#[derive(Clone, Copy, Debug)]
pub struct Screen {
    /// In CSS pixels.
    pub width: u32,
    /// In CSS pixels.
    pub height: u32,
    /// Whether it is a phone's.
    pub is_phone: bool,
    /// Whether the device asks for dark pages.
    pub is_dark: bool,
}

impl Browser {
    /// Starts a browser whose profile is an empty folder at `profile`; nothing, and a word on standard error, where
    /// there is no Chromium.
    ///
    /// # Errors
    /// When it starts but does not answer.
    pub fn start(profile: &Path) -> io::Result<Option<Self>> {
        let is_unix = cfg!(unix);
        let Some(program) = find_chromium().filter(|_| is_unix) else {
            skipped::say("the report in a browser", "no chromium; on Debian: apt-get install chromium");
            return Ok(None);
        };
        if profile.exists() {
            fs::remove_dir_all(profile)?;
        }
        fs::create_dir_all(profile)?;
        let mut command = Command::new("sh");
        command
            .args(["-c", "exec \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>/dev/null", "sh"])
            .arg(program)
            .args(FLAGS);
        if is_root() {
            command.arg("--no-sandbox"); // Chromium refuses to sandbox root's pages
        }
        command.arg(format!("--user-data-dir={}", profile.display()));
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let (Some(commands), Some(answers)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(io::Error::other("chromium has no pipes"));
        };
        let mut browser = Self {
            child,
            commands,
            answers: BufReader::new(answers),
            profile: profile.into(),
            session: None,
            n_sent: 0,
            events: VecDeque::new(),
        };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}))?;
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", attach)?;
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}))?;
        }
        Ok(Some(browser))
    }

    /// Opens the file at `path` on `screen` and waits until it has loaded.
    ///
    /// # Errors
    /// When the browser refuses or ends.
    pub fn open(&mut self, path: &Path, screen: Screen) -> io::Result<()> {
        let Screen { width, height, is_phone, is_dark } = screen;
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": is_phone});
        self.call("Emulation.setDeviceMetricsOverride", metrics)?;
        self.call("Emulation.setTouchEmulationEnabled", json!({"enabled": is_phone}))?;
        let scheme = if is_dark { "dark" } else { "light" };
        let media = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        self.call("Emulation.setEmulatedMedia", media)?;
        self.events.clear();
        let url = format!("file://{}", path.canonicalize()?.display());
        self.call("Page.navigate", json!({"url": url}))?;
        while !self.events.iter().any(|event| event["method"] == "Page.loadEventFired") {
            let event = self.receive()?;
            self.events.push_back(event);
        }
        Ok(())
    }

    /// What `expression` is in the page; promises are waited for.
    ///
    /// # Errors
    /// When it throws.
    pub fn evaluate(&mut self, expression: &str) -> io::Result<Value> {
        let request = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let mut answer = self.call("Runtime.evaluate", request)?;
        match answer.get("exceptionDetails") {
            Some(exception) => Err(io::Error::other(format!("{expression}: {exception}"))),
            None => Ok(answer["result"]["value"].take()),
        }
    }

    /// Presses and releases a key, by its DOM name.
    ///
    /// # Errors
    /// When the browser ends.
    pub fn press(&mut self, key: &str) -> io::Result<()> {
        let text = if key.chars().count() == 1 { key } else { "" };
        self.call("Input.dispatchKeyEvent", json!({"type": "keyDown", "key": key, "text": text}))?;
        self.call("Input.dispatchKeyEvent", json!({"type": "keyUp", "key": key}))?;
        self.frame()
    }

    /// Touches the page with fingers at `points`; none lifts them.
    ///
    /// # Errors
    /// When the browser ends.
    pub fn touch(&mut self, kind: &str, points: &[[f64; 2]]) -> io::Result<()> {
        let points: Vec<Value> = points.iter().map(|[x, y]| json!({"x": x, "y": y})).collect();
        self.call("Input.dispatchTouchEvent", json!({"type": kind, "touchPoints": points}))?;
        self.frame()
    }

    /// Waits until what has changed is drawn.
    ///
    /// # Errors
    /// When the browser ends.
    pub fn frame(&mut self) -> io::Result<()> {
        let frames =
            "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))";
        self.evaluate(frames).map(|_| ())
    }

    /// Writes what the screen shows to `file`, a PNG.
    ///
    /// # Errors
    /// When the browser ends or the file cannot be written.
    pub fn screenshot(&mut self, file: &Path) -> io::Result<()> {
        let shot = self.call("Page.captureScreenshot", json!({"format": "png"}))?;
        let bytes = STANDARD.decode(shot["data"].as_str().unwrap_or_default()).map_err(io::Error::other)?;
        fs::write(file, bytes)
    }

    /// What went wrong in the page, or left it: exceptions, messages on the console, requests but for its own file.
    pub fn complaints(&self) -> Vec<String> {
        let is_complaint = |event: &&Value| match event["method"].as_str().unwrap_or_default() {
            "Runtime.exceptionThrown" | "Runtime.consoleAPICalled" | "Log.entryAdded" => true,
            "Network.requestWillBeSent" => {
                let url = event["params"]["request"]["url"].as_str().unwrap_or_default();
                event["params"]["type"] != "Document" && !url.starts_with("data:")
            }
            _ => false,
        };
        self.events.iter().filter(is_complaint).map(Value::to_string).collect()
    }

    fn call(&mut self, method: &str, params: Value) -> io::Result<Value> {
        self.n_sent += 1;
        let mut request = json!({"id": self.n_sent, "method": method, "params": params});
        if let Some(session) = &self.session {
            request["sessionId"] = session.as_str().into();
        }
        self.commands.write_all(format!("{request}\0").as_bytes())?;
        self.commands.flush()?;
        loop {
            let mut answer = self.receive()?;
            if answer["id"] == self.n_sent {
                return match answer.get("error") {
                    Some(error) => Err(io::Error::other(format!("{method}: {error}"))),
                    None => Ok(answer["result"].take()),
                };
            }
            self.events.push_back(answer);
        }
    }

    fn receive(&mut self) -> io::Result<Value> {
        let mut bytes = Vec::new();
        self.answers.read_until(0, &mut bytes)?;
        match bytes.pop() {
            Some(0) => serde_json::from_slice(&bytes).map_err(io::Error::other),
            _ => Err(io::Error::other(
                "chromium has ended; try by hand: chromium --headless --dump-dom about:blank",
            )),
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = fs::remove_dir_all(&self.profile);
    }
}

fn find_chromium() -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join("chromium")).find(|program| program.is_file())
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}
