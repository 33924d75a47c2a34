//! All printing of the program, and its progress bar.

use std::io::{ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::time::Duration;

use cotillion::export::files::write_one;
use cotillion::scene::{Diagnostic, Rendering, SceneFaults, render};
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use super::{Failure, Manner};

/// Why something that was to be printed is not.
static UNPRINTED: OnceLock<std::io::Error> = OnceLock::new();

/// Where and how a command prints.
pub(crate) struct Output {
    manner: Manner,
}

/// An error that is not about a place in a scene file.
#[derive(Debug, Serialize)]
pub(crate) struct PlainError {
    pub(crate) file: String,
    pub(crate) line: usize,
    pub(crate) column: usize,
    pub(crate) message: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) help: Option<String>,
}

impl Output {
    pub(crate) fn new(manner: Manner) -> Self {
        Self { manner }
    }

    /// Prints a result. A reader that has gone away is no fault of ours; any other is told in the end.
    pub(crate) fn print(&self, text: &str) {
        let mut stdout = std::io::stdout().lock();
        match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => drop(UNPRINTED.set(error)),
            _ => {}
        }
    }

    /// Whether all that was to be printed is; tells why not.
    pub(crate) fn all_printed() -> Result<(), Failure> {
        let Some(error) = UNPRINTED.get() else { return Ok(()) };
        let help = Some("print to where there is room; files that were asked for are written".to_owned());
        let message = format!("cannot be written: {error}");
        let error = PlainError { file: "standard output".to_owned(), line: 0, column: 0, message, help };
        Err(Self::new(Manner { json: false, quiet: false }).fail(error))
    }

    /// Prints what only people read.
    pub(crate) fn say(&self, text: &str) {
        if !self.manner.json && !self.manner.quiet {
            self.print(text);
        }
    }

    /// Prints a machine-readable result, where asked for.
    pub(crate) fn print_json(&self, value: &impl Serialize) {
        if self.manner.json
            && let Ok(text) = serde_json::to_string_pretty(value)
        {
            self.print(&format!("{text}\n"));
        }
    }

    pub(crate) fn print_error(&self, text: &str) {
        let mut stderr = std::io::stderr().lock();
        let _ = stderr.write_all(text.as_bytes()).and_then(|()| stderr.flush());
    }

    fn rendering(&self) -> Rendering {
        if std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() {
            Rendering::Colours
        } else {
            Rendering::Graphical
        }
    }

    /// Tells what is wrong with scene files, all in one go.
    pub(crate) fn faults(&self, faults: &[SceneFaults]) {
        if self.manner.json {
            let all: Vec<&Diagnostic> = faults.iter().flat_map(|faults| &faults.faults).collect();
            self.errors_json(&all);
            return;
        }
        for faults in faults {
            self.print_error(&faults.render(self.rendering()));
        }
    }

    /// Tells what is wrong at places of a scene file; the first says it all, the others show where else.
    pub(crate) fn diagnostics(&self, diagnostics: &[Diagnostic], text: &str) {
        match (self.manner.json, diagnostics.first()) {
            (true, Some(first)) => self.errors_json(&[first]),
            (true, None) => {}
            (false, Some(first)) if first.line == 0 => self.errors(&[PlainError {
                file: first.file.clone(),
                line: 0,
                column: 0,
                message: first.message.clone(),
                help: first.help.clone(),
            }]),
            (false, _) => self.print_error(&render(diagnostics, text, self.rendering())),
        }
    }

    /// Tells what the author of a scene should know.
    pub(crate) fn warnings(&self, warnings: &[Diagnostic], text: &str) {
        if !self.manner.json && !self.manner.quiet && !warnings.is_empty() {
            self.print_error(&render(warnings, text, self.rendering()));
        }
    }

    /// Tells people of something that went another way than planned and did no harm.
    pub(crate) fn note(&self, text: &str) {
        if !self.manner.json && !self.manner.quiet {
            self.print_error(&format!("note: {text}\n"));
        }
    }

    /// Tells of errors that are not about a place in a scene file.
    pub(crate) fn errors(&self, errors: &[PlainError]) {
        if self.manner.json {
            self.errors_json(errors);
            return;
        }
        for error in errors {
            let place = match error.line {
                0 => error.file.clone(),
                line => format!("{}:{line}:{}", error.file, error.column),
            };
            let help = error.help.as_ref().map_or(String::new(), |help| format!("  help: {help}\n"));
            self.print_error(&format!("{place}: error: {}\n{help}", error.message));
        }
    }

    fn errors_json(&self, errors: &(impl Serialize + ?Sized)) {
        if let Ok(text) = serde_json::to_string_pretty(errors) {
            self.print_error(&format!("{text}\n"));
        }
    }

    /// Writes one file, whole or not at all.
    pub(crate) fn write_file(&self, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
        write_one(path, bytes).map_err(|error| self.unwritable(&error.path, &error.source))
    }

    /// Tells of one error; what the command returns then.
    pub(crate) fn fail(&self, error: PlainError) -> Failure {
        self.errors(&[error]);
        Failure::BadInput
    }

    /// Tells that a file could not be written, unless that is because the result was given up.
    pub(crate) fn unwritable(&self, path: &Path, error: &std::io::Error) -> Failure {
        if error.kind() == std::io::ErrorKind::Interrupted {
            return Failure::Interrupted;
        }
        self.errors(&[PlainError {
            file: path.display().to_string(),
            line: 0,
            column: 0,
            message: format!("cannot be written: {error}"),
            help: Some("name a folder with room that you may write to; nothing was changed there".to_owned()),
        }]);
        Failure::BadInput
    }

    /// A bar over many of `what`, with their rate and the time that remains; none in a pipe.
    pub(crate) fn progress_of(&self, what: &str) -> ProgressBar {
        let bar = self.progress(0);
        let template = format!("{{bar:30}} {{pos}}/{{len}} {what}, {{per_sec}}, {{eta}} left");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        bar
    }

    /// A bar over `steps` steps on a terminal; none in a pipe.
    pub(crate) fn progress(&self, steps: u64) -> ProgressBar {
        if self.manner.quiet || self.manner.json || !std::io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::new(steps);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg} ({elapsed})") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }
}
