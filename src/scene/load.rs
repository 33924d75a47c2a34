//! Reads scene files: syntax, then structure, then meaning; each only if the one before is right.

use std::fs;
use std::path::Path;

use toml::de::{DeTable, DeValue};

use crate::scene::check;
use crate::scene::clips::ClipFolders;
use crate::scene::diagnostic::{Diagnostic, SceneFaults};
use crate::scene::raw;
use crate::scene::report::{Lines, Place, Report};
use crate::scene::tree::{Node, Read};
use crate::scene::Scene;

/// A scene, and what its author should know about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// In the order of the file.
    pub warnings: Vec<Diagnostic>,
    /// What the file says.
    pub text: String,
}

/// Reads the scene file at `path` and all its clips.
///
/// # Errors
/// [`SceneFaults`] with everything that is wrong with the file.
pub fn load(path: &Path, folders: &ClipFolders) -> Result<Loaded, SceneFaults> {
    let is_file = fs::metadata(path).map(|kind| kind.is_file());
    let text = match is_file {
        Ok(false) => Err("it is not a file".to_owned()),
        Ok(true) => fs::read(path).map_err(|error| error.to_string()),
        Err(error) => Err(error.to_string()),
    };
    let mut report = Report::default();
    match text.map(String::from_utf8) {
        Ok(Ok(text)) => return load_text(&text, path, folders),
        Ok(Err(error)) => {
            let at = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            let place = Place { span: at..at + 1, field: String::new() };
            report.fault(&place, "the file is not UTF-8 from here on", "save it as UTF-8 text");
            Err(faults(report, path, &text))
        }
        Err(reason) => {
            let message = format!("cannot read the scene file: {reason}");
            report.fault(&Place::default(), message, "name a scene file that can be read");
            Err(faults(report, path, ""))
        }
    }
}

/// Reads the scene that `text` describes; clip files are looked for beside `path`.
///
/// # Errors
/// [`SceneFaults`] with everything that is wrong with the text.
pub fn load_text(text: &str, path: &Path, folders: &ClipFolders) -> Result<Loaded, SceneFaults> {
    let mut report = Report::default();
    let (table, errors) = DeTable::parse_recoverable(text);
    // Later syntax errors are mostly echoes of the first.
    if let Some(error) = errors.first() {
        let span = error.span().unwrap_or(0..0);
        let message = format!("not TOML: {}", error.message());
        let help = "mend this first; everything else is checked once the file is TOML";
        report.fault(&Place { span, field: String::new() }, message, help);
        return Err(faults(report, path, text));
    }
    let table = DeValue::Table(table.into_inner());
    let node = Node { value: &table, place: Place::default() };
    let raw = raw::Scene::read(&node, &mut report).expect("a document is a table");
    let scene = check::check(&raw, (path, &Lines::of(text)), folders, &mut report);
    if report.has_faults() {
        return Err(faults(report, path, text));
    }
    let (_, warnings) = report.finish(&path.display().to_string(), text);
    Ok(Loaded { scene, warnings, text: text.to_owned() })
}

fn faults(report: Report, path: &Path, text: &str) -> SceneFaults {
    let file = path.display().to_string();
    let (faults, _) = report.finish(&file, text);
    SceneFaults { faults, text: text.to_owned(), file }
}
