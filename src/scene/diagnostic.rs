//! What is wrong with a scene file, where, and what to do about it.

use std::fmt;
use std::ops::Range;

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, SourceCode};
use serde::Serialize;

/// One fault, or one warning, of a scene file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Scene file, as it was given.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Bytes of the file it is about.
    #[serde(skip)]
    pub span: Range<usize>,
    /// The key at fault, with everything above it: `character[1].track[0]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field: Option<String>,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
    /// Whether the scene can be used all the same.
    #[serde(skip)]
    pub severity: Severity,
}

/// Whether a scene can be used in spite of a diagnostic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// It cannot.
    Fault,
    /// It can.
    Warning,
}

/// Everything that keeps a scene file from being used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFaults {
    /// At least one, in the order of the file.
    pub faults: Vec<Diagnostic>,
    /// What the file says.
    pub text: String,
    /// Scene file, as it was given.
    pub file: String,
}

/// How diagnostics are shown to people.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rendering {
    /// With the lines of the file, the place underlined, in colours: for terminals.
    Colours,
    /// With the lines of the file, the place underlined.
    Graphical,
    /// `file:line:column: what`, a line each and one for the remedy: for pipes and editors.
    Plain,
}

impl SceneFaults {
    /// All faults for people, in the order of the file.
    pub fn render(&self, rendering: Rendering) -> String {
        render(&self.faults, &self.text, rendering)
    }
}

impl fmt::Display for SceneFaults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(Rendering::Plain))
    }
}

impl std::error::Error for SceneFaults {}

/// Longest line that is shown underlined; a longer one is of no use to the eye.
const LONGEST_SHOWN_LINE: usize = 400;

/// So many are underlined; the rest take their line each.
const MOST_UNDERLINED: usize = 50;

/// Diagnostics of one file for people. `text`: what that file says.
pub fn render(diagnostics: &[Diagnostic], text: &str, rendering: Rendering) -> String {
    let theme = match rendering {
        _ if text.is_empty() => return diagnostics.iter().map(plain).collect(),
        Rendering::Plain => return diagnostics.iter().map(plain).collect(),
        Rendering::Colours => GraphicalTheme::unicode(),
        Rendering::Graphical => GraphicalTheme::unicode_nocolor(),
    };
    let handler = GraphicalReportHandler::new_themed(theme).with_width(110);
    let file = diagnostics.first().map_or("", |diagnostic| diagnostic.file.as_str());
    let source = NamedSource::new(file, text.to_owned());
    let mut shown = String::new();
    for (index, diagnostic) in diagnostics.iter().enumerate() {
        let underlined = Underlined { diagnostic, source: &source };
        if index >= MOST_UNDERLINED
            || !fits(diagnostic, text)
            || handler.render_report(&mut shown, &underlined).is_err()
        {
            shown += &plain(diagnostic);
        }
    }
    shown
}

fn plain(diagnostic: &Diagnostic) -> String {
    let Diagnostic { file, line, column, message, .. } = diagnostic;
    let kind = match diagnostic.severity {
        Severity::Fault => "error",
        Severity::Warning => "warning",
    };
    let field = diagnostic.field.as_ref().map_or(String::new(), |field| format!("{field}: "));
    let help = diagnostic.help.as_ref().map_or(String::new(), |help| format!("  help: {help}\n"));
    format!("{file}:{line}:{column}: {kind}: {field}{message}\n{help}")
}

/// Whether the line of `diagnostic` and its neighbours are short enough to be shown.
fn fits(diagnostic: &Diagnostic, text: &str) -> bool {
    text.lines().skip(diagnostic.line.saturating_sub(2)).take(3).all(|line| line.len() <= LONGEST_SHOWN_LINE)
}

/// A diagnostic beside the text it is about.
#[derive(Debug)]
struct Underlined<'a> {
    diagnostic: &'a Diagnostic,
    source: &'a NamedSource<String>,
}

impl fmt::Display for Underlined<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(field) = &self.diagnostic.field {
            write!(f, "{field}: ")?;
        }
        f.write_str(&self.diagnostic.message)
    }
}

impl std::error::Error for Underlined<'_> {}

impl miette::Diagnostic for Underlined<'_> {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.diagnostic.severity {
            Severity::Fault => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let help = self.diagnostic.help.as_ref()?;
        Some(Box::new(help))
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = LabeledSpan::new_with_span(None, self.diagnostic.span.clone());
        Some(Box::new(std::iter::once(label)))
    }
}
