//! Result files: all of them or none, never half of one.

use std::collections::HashSet;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use sha2::{Digest, Sha256};

use super::aside::{Aside, sweep};

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

/// Writes `files` into `folder`, which is made if need be: see [`Staging`].
///
/// # Errors
/// [`WriteError`]; then nothing has been renamed unless the renaming itself failed, and a folder made here is gone again.
pub fn write_all(folder: &Path, files: &[OutputFile]) -> Result<(), WriteError> {
    let staging = Staging::begin(folder)?;
    files.iter().try_for_each(|file| staging.add(file))?;
    staging.commit()
}

/// A result in the making.
///
/// All its files are written into a folder of their own beside their final names first and flushed to disk; only then are they
/// renamed, so that neither a crash nor a full disk leaves half a file under a final name or damages an earlier result. A
/// result that is dropped or abandoned before leaves nothing; what a program that was killed left is removed by the next result
/// in the same folder.
pub struct Staging {
    folder: PathBuf,
    pending: Pending,
}

/// A handle by which a result in the making can be given up from elsewhere.
#[derive(Clone)]
pub struct Pending(Arc<Mutex<Option<Prepared>>>);

/// What has been written so far.
struct Prepared {
    /// Where files are until they get their names.
    aside: Aside,
    /// The outermost folder that was made for the result.
    fresh: Option<PathBuf>,
    names: Vec<String>,
}

impl Staging {
    /// Begins a result in `folder`, which is made if need be.
    ///
    /// # Errors
    /// [`WriteError`] where the folder cannot be made.
    pub fn begin(folder: &Path) -> Result<Self, WriteError> {
        if folder.is_file() {
            return Err(failed(folder)(io::Error::new(
                io::ErrorKind::NotADirectory,
                "it is a file, not a folder",
            )));
        }
        let fresh = first_missing(folder);
        sweep(fresh.as_deref().map_or(folder, parent_of));
        let made = fs::create_dir_all(folder).and_then(|()| Aside::within(folder));
        match made {
            Ok(aside) => {
                let prepared = Prepared { aside, fresh, names: Vec::new() };
                Ok(Self { folder: folder.to_owned(), pending: Pending(Arc::new(Mutex::new(Some(prepared)))) })
            }
            Err(error) => {
                fresh.inspect(|fresh| remove_empty(folder, fresh));
                Err(failed(folder)(error))
            }
        }
    }

    /// By what the result can be given up from elsewhere.
    pub fn pending(&self) -> (PathBuf, Pending) {
        (self.folder.clone(), self.pending.clone())
    }

    /// Writes one file of the result, not yet under its name.
    ///
    /// # Errors
    /// [`WriteError`] where it cannot be written, or a folder has its name.
    pub fn add(&self, file: &OutputFile) -> Result<(), WriteError> {
        let aside = self.aside(&file.name)?;
        self.keep(&file.name, write_new(&aside, &file.bytes))
    }

    /// Adds a file that lies elsewhere already: linked where both places are on one disk, else copied.
    ///
    /// # Errors
    /// [`WriteError`] where it cannot be read, or not be written.
    pub fn copy(&self, from: &Path, name: &str) -> Result<(), WriteError> {
        let aside = self.aside(name)?;
        let copied = fs::hard_link(from, &aside).or_else(|_| fs::copy(from, &aside).map(|_| ()));
        self.keep(name, copied)
    }

    /// Bytes of a file of the result that has been added.
    ///
    /// # Errors
    /// [`WriteError`] where it was not, or is no longer there.
    pub fn size(&self, name: &str) -> Result<u64, WriteError> {
        let aside = self.aside(name)?;
        fs::metadata(&aside).map(|facts| facts.len()).map_err(failed(&aside))
    }

    /// [`digest`] of a file of the result that has been added.
    ///
    /// # Errors
    /// As [`Self::size`].
    pub fn digest(&self, name: &str) -> Result<String, WriteError> {
        let aside = self.aside(name)?;
        digest(&aside).map_err(failed(&aside))
    }

    /// Where a file of this name is put until it gets its name.
    fn aside(&self, name: &str) -> Result<PathBuf, WriteError> {
        let path = self.folder.join(name);
        if path.is_dir() {
            return Err(failed(&path)(io::Error::new(io::ErrorKind::IsADirectory, "a folder has this name")));
        }
        let aside = self.pending.lock().as_ref().map(|prepared| prepared.aside.path().join(name));
        aside.ok_or_else(|| failed(&path)(given_up()))
    }

    /// Takes note of a file that was written, unless it was not, or the result was given up meanwhile.
    fn keep(&self, name: &str, written: io::Result<()>) -> Result<(), WriteError> {
        let path = self.folder.join(name);
        let mut pending = self.pending.lock();
        let prepared = pending.as_mut().ok_or_else(|| failed(&path)(given_up()))?;
        written.map_err(failed(&path))?;
        prepared.names.push(name.to_owned());
        Ok(())
    }

    /// Gives all files their names.
    ///
    /// # Errors
    /// [`WriteError`] where one cannot be renamed: those before it are.
    pub fn commit(self) -> Result<(), WriteError> {
        let mut pending = self.pending.lock();
        let Some(prepared) = pending.as_mut() else {
            return Err(failed(&self.folder)(given_up()));
        };
        for name in &prepared.names {
            let path = self.folder.join(name);
            fs::rename(prepared.aside.path().join(name), &path).map_err(failed(&path))?;
        }
        prepared.fresh = None;
        *pending = None;
        sync_folder(&self.folder).map_err(failed(&self.folder))
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        self.pending.abandon(&self.folder);
    }
}

impl Pending {
    fn lock(&self) -> MutexGuard<'_, Option<Prepared>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Removes all that was written for the result in `folder` and the folders that were made for it, unless it is complete.
    pub fn abandon(&self, folder: &Path) {
        if let Some(Prepared { aside, fresh, .. }) = self.lock().take() {
            aside.remove();
            // The folders are ours and empty; one that is not stays, which is right.
            fresh.inspect(|fresh| remove_empty(folder, fresh));
        }
    }

    /// The same in no time, however much was written: it is out of the result's folder if that was made for it, and in the folder
    /// returned there is something left to [`sweep`]. `None` where the result was complete or given up before.
    pub fn give_up(&self, folder: &Path) -> Option<PathBuf> {
        let Prepared { aside, fresh, .. } = self.lock().take()?;
        let left = aside.leave_in(fresh.as_deref().map_or(folder, parent_of));
        fresh.inspect(|fresh| remove_empty(folder, fresh));
        Some(left)
    }
}

/// Two digits a byte.
pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256 of a file, in hexadecimal digits. Cost: one pass over it.
///
/// # Errors
/// Where it cannot be read.
pub fn digest(path: &Path) -> io::Result<String> {
    let mut file = fs::File::open(path)?;
    let (mut digest, mut some) = (Sha256::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut some)? {
            0 => return Ok(hexadecimal(&digest.finalize())),
            count => digest.update(&some[..count]),
        }
    }
}

/// No other error is of this kind, as interrupted calls go on.
fn given_up() -> io::Error {
    io::Error::new(io::ErrorKind::Interrupted, "the result is given up")
}

/// Writes one file beside its final name and renames it.
///
/// # Errors
/// [`WriteError`]; then whatever had the name before is unharmed.
pub fn write_one(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    // What a link points to is written, the link stays.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if target.exists() && !target.is_file() {
        let error = io::Error::new(io::ErrorKind::InvalidInput, "it is there, and is no file");
        return Err(failed(path)(error));
    }
    let path = target.as_path();
    let folder = parent_of(path);
    sweep(folder);
    // Removed again with what is in it, whatever happens.
    let aside = Aside::within(folder).map_err(failed(path))?;
    let made = aside.path().join("file");
    write_new(&made, bytes).and_then(|()| fs::rename(&made, path)).map_err(failed(path))?;
    sync_folder(folder).map_err(failed(folder))
}

fn write_new(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = fs::File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// The folder that something is in.
fn parent_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
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
    let (mut taken, mut found) = (HashSet::with_capacity(names.len()), Vec::with_capacity(names.len()));
    for name in names {
        let allowed = |c: char| if c.is_alphanumeric() || "-_ ".contains(c) { c } else { '_' };
        let plain: String = name.trim().chars().map(allowed).take(80).collect();
        let plain = if plain.is_empty() { "character".to_owned() } else { plain };
        let mut candidate = plain.clone();
        let mut number = 2;
        while !taken.insert(candidate.to_lowercase()) {
            candidate = format!("{plain}-{number}");
            number += 1;
        }
        found.push(candidate);
    }
    found
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
    fn digests_are_those_of_the_standard() {
        let home = tempfile::tempdir().expect("a temporary folder");
        fs::write(home.path().join("abc"), "abc").expect("a file");
        // FIPS 180-2, appendix B.1.
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(digest(&home.path().join("abc")).expect("a file"), expected);
    }

    #[test]
    fn file_names_are_safe_and_unique() {
        let names = file_names(&["Ann", "ann", "../x", "", "näh"]);
        assert_eq!(names, ["Ann", "ann-2", "___x", "character", "näh"]);
    }
}
