//! Folders in which results are made before they get their names, and what is left of them by programs that were killed.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::TempDir;

/// Names of such folders begin so.
const PREFIX: &str = ".cotillion-";

/// The file in such a folder that is locked as long as somebody makes a result there.
const LOCK: &str = ".lock";

/// A folder of our own within another, removed when this is dropped. Others see that it is in use: [`sweep`] leaves it alone.
#[derive(Debug)]
pub struct Aside {
    // In this order: some systems remove no folder with an open file.
    lock: File,
    folder: TempDir,
}

impl Aside {
    /// A new one in `folder`.
    ///
    /// # Errors
    /// What the system says.
    pub fn within(folder: &Path) -> io::Result<Self> {
        let made = tempfile::Builder::new().prefix(PREFIX).tempdir_in(folder)?;
        // It is locked before it has its name: whoever finds it under this name and not locked knows that nobody is there.
        let unnamed = made.path().join(".unlocked");
        let lock = File::create_new(&unnamed)?;
        // Where a file system knows no locks, nobody sweeps either.
        if lock.try_lock().is_ok() {
            fs::rename(&unnamed, made.path().join(LOCK))?;
        }
        Ok(Self { lock, folder: made })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Removes it, and what somebody may just be putting into it: one file at most, as the next finds the result given up.
    pub fn remove(self) {
        drop(self.lock);
        remove(&self.folder.keep());
    }

    /// Leaves it in `folder`, on the same disk, for [`sweep`]; where that cannot be, where it is. Returns where that is to look.
    /// Takes no longer for many files than for one.
    pub fn leave_in(self, folder: &Path) -> PathBuf {
        drop(self.lock);
        let path = self.folder.keep();
        let moved = path.file_name().is_some_and(|name| fs::rename(&path, folder.join(name)).is_ok());
        let stays = path.parent().unwrap_or(folder);
        if moved { folder.to_owned() } else { stays.to_owned() }
    }
}

/// Removes all folders of results in `folder` that nobody makes any more. What cannot be removed stays.
pub fn sweep(folder: &Path) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let ours = entries.filter(|entry| {
        OsStr::to_string_lossy(&entry.file_name()).starts_with(PREFIX)
            && entry.file_type().is_ok_and(|kind| kind.is_dir())
    });
    for entry in ours {
        let lock = File::open(entry.path().join(LOCK));
        // The lock is given back before: some systems remove no folder with an open file.
        if lock.is_ok_and(|lock| lock.try_lock().is_ok()) {
            remove(&entry.path());
        }
    }
}

fn remove(path: &Path) {
    /// So often a folder is removed that is still being written to.
    const REMOVALS: u32 = 50;
    for _ in 0..REMOVALS {
        if fs::remove_dir_all(path).is_ok() || !path.exists() {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(folder: &Path) -> usize {
        fs::read_dir(folder).expect("a folder").count()
    }

    #[test]
    fn what_nobody_makes_any_more_is_swept_and_what_somebody_makes_is_not() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let (alive, dead) = (Aside::within(home.path()), Aside::within(home.path()));
        let (alive, dead) = (alive.expect("room"), dead.expect("room"));
        fs::write(dead.path().join("half"), b"x").expect("room");
        fs::create_dir(home.path().join(".cotillion-of-somebody")).expect("room");
        dead.leave_in(home.path());
        assert_eq!(count(home.path()), 3);
        sweep(home.path());
        assert!(alive.path().exists() && count(home.path()) == 2);
        drop(alive);
        assert_eq!(count(home.path()), 1);
    }

    #[test]
    fn what_is_left_elsewhere_is_out_of_the_way_at_once() {
        let home = tempfile::tempdir().expect("a temporary folder");
        let inner = home.path().join("result");
        fs::create_dir(&inner).expect("room");
        let aside = Aside::within(&inner).expect("room");
        assert_eq!(aside.leave_in(home.path()), home.path());
        assert_eq!(count(&inner), 0);
        sweep(home.path());
        assert_eq!(count(home.path()), 1);
    }
}
