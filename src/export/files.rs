//! Result files: all of them or none, never half of one.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// One file of a result.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputFile {
    /// Name within the result's folder.
    pub name: String,
    /// What is in it.
    pub bytes: Vec<u8>,
}

/// A result that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct WriteError {
    /// File or folder at fault.
    pub path: PathBuf,
    /// What the system says.
    #[source]
    pub source: io::Error,
}

/// Writes `files` into `folder`, which is made if need be.
///
/// All are written beside their final names first and flushed to disk; only then are they renamed, so that neither a
/// crash nor a full disk leaves half a file under a final name or damages an earlier result.
///
/// # Errors
/// [`WriteError`]; then nothing has been renamed unless the renaming itself failed, and a folder made here is gone again.
pub fn write_all(folder: &Path, files: &[OutputFile]) -> Result<(), WriteError> {
    if folder.is_file() {
        return Err(failed(folder)(io::Error::new(
            io::ErrorKind::NotADirectory,
            "it is a file, not a folder",
        )));
    }
    let fresh = first_missing(folder);
    let written = fs::create_dir_all(folder).map_err(failed(folder)).and_then(|()| write_into(folder, files));
    if let (Err(_), Some(fresh)) = (&written, &fresh) {
        // The folders are ours and empty; one that is not stays, which is right.
        remove_empty(folder, fresh);
    }
    written
}

fn write_into(folder: &Path, files: &[OutputFile]) -> Result<(), WriteError> {
    let mut prepared = Vec::with_capacity(files.len());
    for file in files {
        let path = folder.join(&file.name);
        if path.is_dir() {
            return Err(failed(&path)(io::Error::new(io::ErrorKind::IsADirectory, "a folder has this name")));
        }
        prepared.push((prepare(folder, &file.bytes).map_err(failed(&path))?, path));
    }
    for (temporary, path) in prepared {
        temporary.persist(&path).map_err(|error| failed(&path)(error.error))?;
    }
    sync_folder(folder).map_err(failed(folder))
}

/// Writes one file beside its final name and renames it.
///
/// # Errors
/// [`WriteError`]; then whatever had the name before is unharmed.
pub fn write_one(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let temporary = prepare(folder, bytes).map_err(failed(path))?;
    temporary.persist(path).map_err(|error| failed(path)(error.error))?;
    sync_folder(folder).map_err(failed(folder))
}

fn prepare(folder: &Path, bytes: &[u8]) -> io::Result<NamedTempFile> {
    let mut file = tempfile::Builder::new().prefix(".cotillion-").tempfile_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    make_readable(file.path())?;
    Ok(file)
}

/// Temporary files are private; results are not.
#[cfg(unix)]
fn make_readable(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    fs::File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

fn failed(path: &Path) -> impl FnOnce(io::Error) -> WriteError {
    let path = path.to_owned();
    move |source| WriteError { path, source }
}

/// The outermost folder on the way to `folder` that does not exist yet.
fn first_missing(folder: &Path) -> Option<PathBuf> {
    folder
        .ancestors()
        .take_while(|ancestor| !ancestor.as_os_str().is_empty() && !ancestor.exists())
        .last()
        .map(Path::to_owned)
}

fn remove_empty(folder: &Path, outermost: &Path) {
    for ancestor in folder.ancestors() {
        if fs::remove_dir(ancestor).is_err() || ancestor == outermost {
            return;
        }
    }
}

/// A file name for each of `names`, unique also where case does not count, without characters that file systems refuse.
pub fn file_names(names: &[&str]) -> Vec<String> {
    let mut taken: Vec<String> = Vec::with_capacity(names.len());
    for name in names {
        let allowed = |c: char| if c.is_alphanumeric() || "-_ ".contains(c) { c } else { '_' };
        let plain: String = name.trim().chars().map(allowed).take(80).collect();
        let plain = if plain.is_empty() { "character".to_owned() } else { plain };
        let clash =
            |candidate: &str| taken.iter().any(|known| known.to_lowercase() == candidate.to_lowercase());
        let mut candidate = plain.clone();
        let mut number = 2;
        while clash(&candidate) {
            candidate = format!("{plain}-{number}");
            number += 1;
        }
        taken.push(candidate);
    }
    taken
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str) -> OutputFile {
        OutputFile { name: name.to_owned(), bytes: name.as_bytes().to_vec() }
    }

    #[test]
    fn a_failed_result_leaves_the_old_one_and_no_new_file() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let folder = home.path().join("result");
        write_all(&folder, &[file("a"), file("b")]).expect("an empty folder takes files");
        fs::create_dir(folder.join("c")).expect("a folder in the way");
        let changed = [OutputFile { name: "a".to_owned(), bytes: b"new".to_vec() }, file("c")];
        assert!(write_all(&folder, &changed).is_err());
        assert_eq!(fs::read(folder.join("a")).expect("still there"), b"a");
        assert_eq!(fs::read_dir(&folder).expect("readable").count(), 3);
    }

    #[test]
    fn folders_made_for_a_failed_result_are_gone_again() {
        let home = tempfile::tempdir().expect("a temporary folder");
        fs::write(home.path().join("plain"), b"x").expect("a file");
        assert!(write_all(&home.path().join("plain/result"), &[file("a")]).is_err());
        let deep = home.path().join("deep/result");
        let clash = [file("a/b")];
        assert!(write_all(&deep, &clash).is_err());
        assert!(!home.path().join("deep").exists());
    }

    #[test]
    fn file_names_are_safe_and_unique() {
        let names = file_names(&["Ann", "ann", "../x", "", "näh"]);
        assert_eq!(names, ["Ann", "ann-2", "___x", "character", "näh"]);
    }
}
