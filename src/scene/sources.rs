//! The one place that calls clip readers: a source in, a clip out, or why not.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::clip::{Clip, builtin, bvh};
use crate::clip::bvh::ReadNote;
use crate::scene::suggest;
use crate::scene::values::Up;

/// Where a clip comes from, and how to read it.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A BVH file.
    File {
        /// Where it is.
        path: PathBuf,
        /// How to read it.
        options: FileOptions,
    },
    /// A clip the program generates.
    Builtin {
        /// Which.
        name: String,
        /// Its parameters.
        parameters: BTreeMap<String, f64>,
    },
}

/// What the scene says about a file that is silent or wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FileOptions {
    /// Frames per second.
    pub fps: Option<f64>,
    /// Metres per unit of the file.
    pub unit_to_m: Option<f64>,
    /// The axis that points up.
    pub up: Option<Up>,
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
pub fn read(source: &Source) -> Result<Read, Unreadable> {
    match source {
        Source::File { path, options } => read_file(path, *options),
        Source::Builtin { name, parameters } => match builtin::generate(name, parameters) {
            Ok(clip) => Ok(Read { clip: Arc::new(clip), notes: Vec::new() }),
            Err(error) => Err(Unreadable {
                message: error.to_string(),
                help: "`cotillion clips` lists the generated clips and their parameters".to_owned(),
            }),
        },
    }
}

fn read_file(path: &Path, options: FileOptions) -> Result<Read, Unreadable> {
    let bytes = bytes_of(path)?;
    let options = bvh::ReadOptions {
        fps: options.fps,
        unit_to_m: options.unit_to_m,
        up: options.up.map(|up| match up {
            Up::Y => bvh::Up::Y,
            Up::Z => bvh::Up::Z,
        }),
    };
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    match bvh::read(&bytes, &name, &options) {
        Ok(read) => Ok(Read {
            clip: Arc::new(read.clip),
            notes: read.notes,
        }),
        Err(error) => Err(Unreadable {
            message: format!("{}: {error}", path.display()),
            help: "mend the file, or name another one".to_owned(),
        }),
    }
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, Unreadable> {
    let kind = fs::metadata(path);
    match kind {
        Ok(kind) if kind.is_file() => fs::read(path).map_err(|error| unreadable(path, &error.to_string())),
        Ok(_) => Err(unreadable(path, "it is not a file")),
        Err(error) if error.kind() == ErrorKind::NotFound => Err(missing(path)),
        Err(error) => Err(unreadable(path, &error.to_string())),
    }
}

fn unreadable(path: &Path, reason: &str) -> Unreadable {
    Unreadable {
        message: format!("cannot read {}: {reason}", path.display()),
        help: "name a BVH file that can be read".to_owned(),
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
