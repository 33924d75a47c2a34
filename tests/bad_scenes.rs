//! Every kind of bad scene ends in faults that say where and what to do: one file of `tests/bad_scenes` per kind.
//!
//! A file begins with two comment lines for each fault it has: `# expect: LINE:COLUMN part of the message`, then
//! `# help: part of the remedy`. A scene has these faults and no others.

use std::fs;
use std::path::{Path, PathBuf};

use cotillion::scene::{ClipFolders, Rendering, load};
use libtest_mimic::{Arguments, Failed, Trial};

fn main() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes");
    let mut scenes: Vec<PathBuf> = fs::read_dir(&folder)
        .expect("the folder of bad scenes is beside this file")
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    scenes.sort();
    let trials = scenes
        .into_iter()
        .map(|path| {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            Trial::test(name, move || has_the_expected_faults(&path))
        })
        .collect();
    libtest_mimic::run(&Arguments::from_args(), trials).exit();
}

/// A fault as the head of a scene file announces it.
struct Expected {
    line: usize,
    column: usize,
    message: String,
    help: String,
}

fn has_the_expected_faults(path: &Path) -> Result<(), Failed> {
    let text = fs::read_to_string(path)?;
    let expected =
        expected_of(&text).ok_or("the head of the file announces no fault, or in the wrong form")?;
    let found = load(path, &ClipFolders::default()).err().ok_or("the scene loads")?;
    let shown = found.render(Rendering::Graphical);
    if found.faults.len() != expected.len() {
        return Err(format!("{} faults in place of {}:\n{shown}", found.faults.len(), expected.len()).into());
    }
    for (fault, expected) in found.faults.iter().zip(&expected) {
        let Expected { line, column, message, help } = expected;
        let remedy = fault.help.as_deref().unwrap_or_default();
        let as_expected = (fault.line, fault.column) == (*line, *column)
            && fault.message.contains(message.as_str())
            && remedy.contains(help.as_str());
        if !as_expected {
            return Err(format!("expected {line}:{column} {message} | {help}, found:\n{shown}").into());
        }
        if fault.message.is_empty() || remedy.is_empty() {
            return Err("a fault needs a message and a remedy".into());
        }
    }
    Ok(())
}

fn expected_of(text: &str) -> Option<Vec<Expected>> {
    let mut lines = text.lines();
    let mut expected = Vec::new();
    while let Some(fault) = lines.next().and_then(|line| line.strip_prefix("# expect: ")) {
        let (place, message) = fault.split_once(' ')?;
        let (line, column) = place.split_once(':')?;
        let help = lines.next()?.strip_prefix("# help: ")?;
        expected.push(Expected {
            line: line.parse().ok()?,
            column: column.parse().ok()?,
            message: message.to_owned(),
            help: help.to_owned(),
        });
    }
    (!expected.is_empty()).then_some(expected)
}
