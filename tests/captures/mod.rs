//! Where captures are, and tests on them.
//!
//! They are looked for in `$COTILLION_MOCAP`, else in `../shared/mocap` beside the checkout.

use std::path::{Path, PathBuf};

use cotillion::clip::Clip;
use cotillion::clip::file::read_file;
use cotillion::clip::read::ReadOptions;
use libtest_mimic::{Failed, Trial};

/// `None` where there are none.
pub(crate) fn mocap_folder() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let set = std::env::var_os("COTILLION_MOCAP").map(PathBuf::from);
    [set, Some(beside)].into_iter().flatten().find(|folder| folder.is_dir())
}

/// What a test does with a file below the folder.
pub(crate) type Run = fn(&Path, &str) -> Result<(), Failed>;

/// `run` on `file` below `folder`; ignored, by name, where there is no folder.
pub(crate) fn trial(folder: Option<&Path>, name: String, run: Run, file: &'static str) -> Trial {
    let folder = folder.map(Path::to_owned);
    let is_missing = folder.is_none();
    let trial = Trial::test(name, move || match folder {
        Some(folder) => run(&folder, file),
        None => Err("no captures found".into()),
    });
    trial.with_ignored_flag(is_missing)
}

/// Headers of these say 24 frames a second, and are wrong: played so, bodies fall slower than they do.
const WRONG_RATE: &str = "snu_";
/// What they were captured at.
const RIGHT_RATE: f64 = 30.0;

/// The clip of a file at the rate it was captured at.
#[allow(dead_code, reason = "shared with tests that read files as they say")]
pub(crate) fn read_at_own_rate(folder: &Path, file: &str) -> Result<Clip, Failed> {
    let path = folder.join(file);
    let read = read_file(&path, None, &ReadOptions::default())?;
    let is_wrong = file.contains(WRONG_RATE) && (read.header_fps - 24.0).abs() < 0.01;
    if !is_wrong {
        return Ok(read.clip);
    }
    let options = ReadOptions { fps: Some(RIGHT_RATE), ..ReadOptions::default() };
    Ok(read_file(&path, None, &options)?.clip)
}
