//! Where motion graphs are kept between runs.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;

/// Where motion graphs are kept.
#[derive(Clone, Debug, Args)]
pub(super) struct CacheArgs {
    /// Folder in which motion graphs are kept between runs; left out, that of the system for such files.
    #[arg(long, value_name = "DIR", help_heading = "Motion graph")]
    cache: Option<PathBuf>,
    /// Neither look for motion graphs of earlier runs nor keep any.
    #[arg(long, conflicts_with = "cache", help_heading = "Motion graph")]
    no_cache: bool,
}

impl CacheArgs {
    /// The folder, where graphs are to be kept and there is one.
    pub(super) fn folder(&self) -> Option<PathBuf> {
        match &self.cache {
            _ if self.no_cache => None,
            Some(folder) => Some(folder.clone()),
            None => default_folder(|name| std::env::var_os(name)),
        }
    }
}

/// `$XDG_CACHE_HOME`, else where the system keeps what programs can make again; `None` where nobody says who is at home.
fn default_folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    // A relative path would depend on where the program was started: the XDG Base Directory Specification has it ignored.
    let absolute = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let of_system = || match std::env::consts::OS {
        "windows" => absolute("LOCALAPPDATA"),
        "macos" => Some(absolute("HOME")?.join("Library/Caches")),
        _ => Some(absolute("HOME")?.join(".cache")),
    };
    Some(absolute("XDG_CACHE_HOME").or_else(of_system)?.join("cotillion"))
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_cache_lies_where_the_system_has_it() {
        let with = |xdg: Option<&str>, home: Option<&str>| {
            default_folder(|name| match name {
                "XDG_CACHE_HOME" => xdg.map(OsString::from),
                "HOME" => home.map(OsString::from),
                _ => None,
            })
        };
        assert_eq!(with(Some("/x"), Some("/h")), Some(PathBuf::from("/x/cotillion")));
        assert_eq!(with(Some("x"), Some("/h")), Some(PathBuf::from("/h/.cache/cotillion")));
        assert_eq!(with(None, None), None);
    }
}
