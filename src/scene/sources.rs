//! The one place that calls clip readers: a source in, a clip out, or why not.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::clip::file::{FileError, read_file};
use crate::clip::note::ReadNote;
use crate::clip::read::ReadOptions;
use crate::clip::{Clip, builtin};
use crate::scene::suggest;

/// Where a clip comes from, and how to read it.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A capture in a file.
    File {
        /// Where it is.
        path: PathBuf,
        /// Where its skeleton is, where one is named.
        skeleton: Option<PathBuf>,
        /// How to read it.
        options: ReadOptions,
    },
    /// A clip the program generates.
    Builtin {
        /// Which.
        name: String,
        /// Its parameters.
        parameters: BTreeMap<String, f64>,
    },
}

/// A clip, and what its reader had to guess.
#[derive(Clone, Debug)]
pub struct Read {
    /// The clip.
    pub clip: Arc<Clip>,
    /// For people.
    pub notes: Vec<ReadNote>,
}

/// Why a source gives no clip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable {
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: String,
}

impl Source {
    /// The same for two sources that give the same clip.
    pub fn key(&self) -> String {
        format!("{self:?}")
    }
}

/// Names of files at least so alike are offered in place of a missing one.
const LEAST_LIKENESS: f64 = 0.5;

/// So many besides the most similar.
const MOST_SIMILAR: usize = 3;

/// Reads or generates the clip of `source`.
pub fn read_source(source: &Source) -> Result<Read, Unreadable> {
    match source {
        Source::File { path, skeleton, options } => file(path, skeleton.as_deref(), options),
        Source::Builtin { name, parameters } => match builtin::generate(name, parameters) {
            Ok(clip) => Ok(Read { clip: Arc::new(clip), notes: Vec::new() }),
            Err(error) => Err(Unreadable {
                message: error.to_string(),
                help: "`cotillion clips` lists the generated clips and their parameters".to_owned(),
            }),
        },
    }
}

fn file(path: &Path, skeleton: Option<&Path>, options: &ReadOptions) -> Result<Read, Unreadable> {
    match read_file(path, skeleton, options) {
        Ok(read) => Ok(Read { clip: Arc::new(read.clip), notes: read.notes }),
        Err(FileError::Missing { path }) => Err(missing(&path)),
        Err(error) => Err(Unreadable { message: error.to_string(), help: error.help().to_owned() }),
    }
}

fn missing(path: &Path) -> Unreadable {
    let message = format!("no file {}", path.display());
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let Ok(entries) = fs::read_dir(folder) else {
        let folder = folder.display();
        let help = format!("there is no folder {folder} either: paths start at the folder of the scene file");
        return Unreadable { message, help };
    };
    let mut names: Vec<_> =
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort_unstable();
    let wanted = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let similar = suggest::similar(&wanted, names.iter().map(String::as_str), LEAST_LIKENESS);
    let help = match similar.as_slice() {
        [] => "put the file there, or correct the path: it starts at the folder of the scene file".to_owned(),
        [only] => format!("did you mean \"{only}\"? It is in the same folder"),
        [first, others @ ..] => {
            let others = suggest::list(&others[..others.len().min(MOST_SIMILAR)]);
            format!("did you mean \"{first}\"? Also in the same folder: {others}")
        }
    };
    Unreadable { message, help }
}
