//! Captures on disk: which format a file is in, which skeleton belongs to it.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::clip::read::{Capture, ReadClip, ReadError, ReadOptions, read};

/// Why a file gives no clip.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "`path` is the file at fault, the other fields stand in the message")]
pub enum FileError {
    /// There is no such file.
    #[error("no file {}", .path.display())]
    Missing { path: PathBuf },
    /// It is there, but cannot be read.
    #[error("cannot read {}: {reason}", .path.display())]
    Unreadable { path: PathBuf, reason: String },
    /// Its name tells no format that is read.
    #[error("{} is no clip: its name ends in none of .bvh, .amc, .json and .txt", .path.display())]
    UnknownFormat { path: PathBuf },
    /// A skeleton where a motion belongs.
    #[error("{} is a skeleton without motion", .path.display())]
    SkeletonOnly { path: PathBuf },
    /// An AMC file, and no skeleton for it.
    #[error("{} needs a skeleton, and no .asf beside it has a name that it starts with", .path.display())]
    NoSkeleton { path: PathBuf },
    /// A skeleton for a file that brings its own.
    #[error("{} brings its own skeleton", .path.display())]
    SkeletonNotNeeded { path: PathBuf },
    /// Its text is at fault.
    #[error("{}: {error}", .path.display())]
    Read { path: PathBuf, error: ReadError },
}

impl FileError {
    /// The file at fault.
    pub fn path(&self) -> &Path {
        match self {
            Self::Missing { path }
            | Self::Unreadable { path, .. }
            | Self::UnknownFormat { path }
            | Self::SkeletonOnly { path }
            | Self::NoSkeleton { path }
            | Self::SkeletonNotNeeded { path }
            | Self::Read { path, .. } => path,
        }
    }

    /// What to do about it.
    pub const fn help(&self) -> &'static str {
        match self {
            Self::Missing { .. } => "check the name; paths start where the command runs",
            Self::Unreadable { .. } => "name a file that can be read",
            Self::UnknownFormat { .. } => {
                "name a BVH file, an AMC file, or a DeepMimic motion; convert other formats to BVH"
            }
            Self::SkeletonOnly { .. } => "name the .amc, and this file as its skeleton",
            Self::NoSkeleton { .. } => "name the .asf of the same performer as its skeleton",
            Self::SkeletonNotNeeded { .. } => "leave the skeleton out: only an .amc needs one",
            Self::Read { error: ReadError::Strict { .. }, .. } => {
                "settle what is named, or read it without being strict"
            }
            Self::Read { .. } => "mend the file, or name another one",
        }
    }
}

/// Reads the clip in the file `path`, with the skeleton `skeleton` if it is an AMC file; where none is named, the `.asf`
/// beside it with the longest name that its own starts with. The clip goes by the file's name without its ending.
///
/// Formats go by the name's ending: `.bvh`, `.amc`, and `.json` or `.txt` for DeepMimic's.
///
/// # Errors
/// [`FileError`], which names the file at fault.
pub fn read_file(path: &Path, skeleton: Option<&Path>, options: &ReadOptions) -> Result<ReadClip, FileError> {
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let own = || path.to_owned();
    let format = ending(path);
    if skeleton.is_some() && format != "amc" {
        return Err(FileError::SkeletonNotNeeded { path: own() });
    }
    match format.as_str() {
        "bvh" => attempt(path, read(Capture::Bvh(&bytes_of(path)?), &name, options)),
        "json" | "txt" => attempt(path, read(Capture::DeepMimic(&bytes_of(path)?), &name, options)),
        "amc" => {
            let motion = bytes_of(path)?;
            let skeleton = match skeleton {
                Some(given) => given.to_owned(),
                None => skeleton_beside(path).ok_or_else(|| FileError::NoSkeleton { path: own() })?,
            };
            let capture = Capture::Acclaim { skeleton: &bytes_of(&skeleton)?, motion: &motion };
            let read = read(capture, &name, options);
            let is_in_skeleton = read.as_ref().is_err_and(ReadError::is_in_skeleton);
            attempt(if is_in_skeleton { &skeleton } else { path }, read)
        }
        "asf" => Err(FileError::SkeletonOnly { path: own() }),
        _ => Err(FileError::UnknownFormat { path: own() }),
    }
}

fn attempt(path: &Path, read: Result<ReadClip, ReadError>) -> Result<ReadClip, FileError> {
    read.map_err(|error| FileError::Read { path: path.to_owned(), error })
}

/// What follows the last dot of the name, in lower case.
fn ending(path: &Path) -> String {
    path.extension().map_or_else(String::new, |ending| ending.to_string_lossy().to_ascii_lowercase())
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, FileError> {
    let unreadable = |reason: String| FileError::Unreadable { path: path.to_owned(), reason };
    match fs::metadata(path) {
        // Pipes and devices may never end.
        Ok(kind) if kind.is_file() => fs::read(path).map_err(|error| unreadable(error.to_string())),
        Ok(_) => Err(unreadable("it is not a file".to_owned())),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            Err(FileError::Missing { path: path.to_owned() })
        }
        Err(error) => Err(unreadable(error.to_string())),
    }
}

/// The `.asf` in the same folder with the longest name that the name of `motion` starts with.
fn skeleton_beside(motion: &Path) -> Option<PathBuf> {
    let folder = motion.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = motion.file_stem()?.to_string_lossy().into_owned();
    let candidates = fs::read_dir(folder).ok()?.flatten().map(|entry| entry.path());
    candidates
        .filter(|path| ending(path) == "asf")
        .filter_map(|path| Some((path.file_stem()?.to_string_lossy().into_owned(), path)))
        .filter(|(stem, _)| name.starts_with(stem.as_str()))
        .max_by_key(|(stem, path)| (stem.len(), path.clone()))
        .map(|(_, path)| path)
}
