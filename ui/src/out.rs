//! What the program says: results on standard output, progress and errors on standard
//! error. A closed pipe is the reader's choice, never a panic.
//!
//! This is the door to the terminal: every line goes through [`visible`], for it may hold
//! what a file says. JSON has escapes of its own and goes out as it is.

use std::borrow::Cow;
use std::io::{IsTerminal, Write};
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use pickglass::job::Job;
use pickglass::text::{visible, with_causes};

/// What is said, line by line.
pub trait Lines {
    /// The lines.
    fn lines(&self) -> impl Iterator<Item = &str>;
}

/// Each text is one line, whatever it holds.
impl Lines for Vec<String> {
    fn lines(&self) -> impl Iterator<Item = &str> {
        self.iter().map(String::as_str)
    }
}

/// A text of the program's own: its line breaks are meant.
impl Lines for String {
    fn lines(&self) -> impl Iterator<Item = &str> {
        self.split('\n')
    }
}

/// Writes lines to standard output.
pub fn say(said: &impl Lines) -> anyhow::Result<()> {
    let shown: Vec<_> = said.lines().map(visible).collect();
    write_out(&shown.join("\n"))
}

/// Writes a text of the program's own to standard output as it is.
pub fn say_text(text: &str) -> anyhow::Result<()> {
    write_out(text.trim_end())
}

/// Writes `text` to standard output. A broken pipe ends the writing in silence.
fn write_out(text: &str) -> anyhow::Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.write_all(b"\n"))
        .and_then(|()| stdout.flush())
    {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(anyhow::anyhow!(
            "standard output could not be written ({error}): send it elsewhere"
        )),
        _ => Ok(()),
    }
}

/// A path on one line.
pub fn shown(path: &Path) -> String {
    visible(&path.display().to_string()).into_owned()
}

/// Writes one JSON object to standard output.
pub fn say_json(value: &serde_json::Value) -> anyhow::Result<()> {
    write_out(&value.to_string())
}

/// Writes a remark of one line to standard error; a closed standard error is nobody's
/// concern.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", visible(text));
}

/// Writes the one line of an error: the thing, the place, the remedy.
pub fn error_line(error: &anyhow::Error) {
    note(&format!("pickglass: {}", with_causes(error.as_ref())));
}

/// Ends the program on wrong usage, or after help: the argument that is quoted may be the
/// name of a stranger's file.
pub fn usage(error: &clap::Error) -> ! {
    let text = error.to_string();
    let mut lines = text.trim_end().split('\n');
    if !error.use_stderr()
        || lines
            .clone()
            .all(|line| matches!(visible(line), Cow::Borrowed(_)))
    {
        error.exit();
    }
    lines.by_ref().for_each(note);
    std::process::exit(error.exit_code());
}

/// A log that writes to standard error, a line a record.
pub fn start_log() {
    // Unset and empty are the same: nothing is logged.
    let wanted = std::env::var("RUST_LOG").ok();
    let wanted = wanted.filter(|wanted| !wanted.trim().is_empty());
    env_logger::Builder::new()
        .parse_filters(wanted.as_deref().unwrap_or("off"))
        .format(|out, record| {
            let (level, target) = (record.level(), record.target());
            let said = record.args().to_string();
            writeln!(out, "[{level} {target}] {}", visible(&said))
        })
        .init();
}

/// A single line on standard error that is rewritten in place; silent when standard
/// error is not a terminal.
#[derive(Clone)]
pub struct Progress(Option<Arc<Mutex<Line>>>);

struct Line {
    width: usize,
    last: Option<Instant>,
}

/// The line is rewritten at most this often.
const PROGRESS_PERIOD: Duration = Duration::from_millis(80);

impl Progress {
    pub fn new() -> Self {
        let line = Line {
            width: 0,
            last: None,
        };
        Self(
            std::io::stderr()
                .is_terminal()
                .then(|| Arc::new(Mutex::new(line))),
        )
    }

    /// A job that reports to this line.
    pub fn job(&self) -> Job {
        let line = self.clone();
        if line.0.is_none() {
            return Job::new();
        }
        Job::new().with_listener(move |stage, fraction| line.stage(stage, fraction))
    }

    /// As [`Progress::job`], with a listener that is told as well.
    pub fn job_with(&self, also: impl Fn(&str, f32) + Send + Sync + 'static) -> Job {
        let line = self.clone();
        Job::new().with_listener(move |stage, fraction| {
            line.stage(stage, fraction);
            also(stage, fraction);
        })
    }

    fn stage(&self, stage: &str, fraction: f32) {
        if self.0.is_some() {
            let percent = (fraction.clamp(0.0, 1.0) * 100.0).round();
            self.show(&format!("{stage} {percent} %"));
        }
    }

    /// Rewrites the line, unless it was just rewritten.
    pub fn show(&self, text: &str) {
        let Some(Ok(mut line)) = self.0.as_ref().map(|line| line.lock()) else {
            return;
        };
        if line
            .last
            .is_some_and(|last| last.elapsed() < PROGRESS_PERIOD)
        {
            return;
        }
        line.last = Some(Instant::now());
        let text = visible(text);
        let width = text.chars().count();
        let blank = " ".repeat(line.width.saturating_sub(width));
        line.width = width;
        let mut stderr = std::io::stderr().lock();
        let _ = write!(stderr, "\r{text}{blank}").and_then(|()| stderr.flush());
    }

    /// Clears the line.
    pub fn finish(&self) {
        let Some(Ok(mut line)) = self.0.as_ref().map(|line| line.lock()) else {
            return;
        };
        let mut stderr = std::io::stderr().lock();
        let _ = write!(stderr, "\r{}\r", " ".repeat(line.width)).and_then(|()| stderr.flush());
        line.width = 0;
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        if self.width > 0 {
            note("");
        }
    }
}
